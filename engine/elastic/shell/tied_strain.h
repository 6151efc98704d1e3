#pragma once
// The constant strain of a triangle that stretches its edges as they are stretched on average (shell.h says why); private to the
// shell's source files.

#include "surface/loop_surface.h"

#include <array>

namespace seldinger {

struct ShellPoint;

namespace shell_detail {

/// A point of an edge: tangent x_,s, the surface's unit normal, and what each control vertex weighs in x_,s; s runs from 0 to 1.
struct EdgePoint {
    Vec3 tangent = Vec3::Zero(), normal = Vec3::Zero();  // [m], [-]
    std::array<double, LoopStencil::capacity> n_s{};
};

struct TiedStrain {
    /// @param q  a point of the triangle, in whose frame the strain is
    TiedStrain(const LoopSurface& surface, const ShellPoint& q);

    /// Strain (11, 22, 2 12) per displacement of the stencil's k-th control vertex [1/m].
    [[nodiscard]] Mat3 weight(std::size_t k) const;
    /// How much the mean strain counts beside this one: a of shell.h.
    [[nodiscard]] double share_of_mean(double thickness) const;

    std::array<std::array<EdgePoint, 2>, 3> points;  // Gauss points of each edge
    Mat3 of_stretch = Mat3::Zero();                  // strain per sum of t . u_,s over an edge's two points [1/m]
    double bow = 0;                                  // l^2/R of the edge that bows most [m]
};

}  // namespace shell_detail
}  // namespace seldinger

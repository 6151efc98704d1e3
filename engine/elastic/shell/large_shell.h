#pragma once
// The shell of shell/shell.h under displacements of any size: the same surface, points and weights, total Lagrangian.
//
//   E(u) = 1/2 int C H^abcd E_ab E_cd + D H^abcd R_ab R_cd dA + (p/3) int u . (u_,1 x u_,2) dA                              [J]
//
//   E_ab = (x_,a . x_,b - X_,a . X_,b) / 2           Green-Lagrange strain; X at rest, x = X + u
//   R_ab = x_|ab . x_3 - B_ab - (B_a^c E_cb + B_b^c E_ca) / 2,    x_3 = x_,1 x x_,2 / |x_,1 x x_,2|
//
// St. Venant-Kirchhoff; A_ab of the rest shape throughout [Koiter66, doi:10.1007/978-3-662-29364-5; Kiendl09,
// doi:10.1016/j.cma.2009.08.013 for the variations]. x_|ab is the covariant second derivative at rest: what it differs in from
// x_,ab is tangential. No term is linearised, so a rigid motion of any size has no strain; for small u the strains are those of
// shell.h. A triangle's membrane strain has the same two parts: the mean of E over its points, and the strain that changes
// |x_,s|^2 of its edges as it is changed on average.
//
// The mean pressure's part of third order is the last one (the mesh faces the lumen): with K_pressure it follows the wall
// wherever it goes. What carries it, N^ab E_ab, has no terms beyond K_pressure. Tissue stays linear in u.
//
// Strains must be small, for the material's law as for thin shells at all; displacements and rotations need not.

#include "shell/shell.h"

#include <array>
#include <span>
#include <vector>

namespace seldinger {

class LargeShell {
public:
    /// The shell must outlive it.
    explicit LargeShell(const Shell& shell);

    struct Energy {
        double membrane = 0, bending = 0, pressure = 0;  // the pressure's third order alone [J]
        [[nodiscard]] double sum() const { return membrane + bending + pressure; }
    };
    /// @param displacement  [3V] [m]
    [[nodiscard]] Energy energy(std::span<const double> displacement) const;
    /// force += dE/du - K_elastic u: what linear theory leaves out [N].
    /// @param still  triangles count whose control vertices have moved against each other by more than this share of an edge
    void add_excess(std::span<const double> displacement, std::span<double> force, double still = 0) const;
    /// Strains at the four points of a triangle, of which `first` is the first of Shell::points().
    /// @param excess  to which the triangle's energy is added that linear theory leaves out [J]
    /// @return the triangle's membrane strain, in the frame of the last one
    Vec3 strains_of(std::size_t first, std::span<const double> displacement, std::span<ShellStrain, 4> at,
                    double* excess = nullptr) const;

private:
    friend struct LargeShellTangent;  // tests/wall/large_shell_tangent.h
    static constexpr std::size_t per_triangle = 4, edge_points = 6;

    /// Constants of a triangle.
    struct Triangle {
        std::array<Mat3, per_triangle> of_point;                 // its membrane strain per strain of a point [-]
        std::array<Vec3, edge_points> of_edge;                   // per (|x_,s|^2 - |X_,s|^2) / 2 of a point of an edge [1/m^2]
        std::array<Vec3, edge_points> edge;                      // X_,s [m]
        std::array<std::array<Vec3, 3>, per_triangle> second;    // X_|ab: 11, 22, 12 [1/m]
    };
    /// A point of a moved triangle.
    struct Point {
        Vec3 u, u_1, u_2;         // [m], [-]
        Vec3 x_1, x_2, normal;    // tangents, unit normal
        std::array<Vec3, 3> x_s;  // x_|ab: 11, 22, 12 [1/m]
        double stretch;           // |x_,1 x x_,2|
        ShellStrain strain, linear;
        /// x_|ab along the surface over the stretch: d x_3 . x_|ab = tilt . d(x_,1 x x_,2).
        [[nodiscard]] Vec3 tilt(const Vec3& x_ab) const { return (x_ab - normal.dot(x_ab) * normal) / stretch; }
    };
    struct Moved {
        std::array<Point, per_triangle> at;
        std::array<Vec3, edge_points> u_s;  // of the edges' points [m]
        Vec3 strain, linear;                // of the membrane
        double area;
    };

    struct Local;
    /// @param moves2  [V] squares of the control vertices' displacements [m^2]
    [[nodiscard]] bool is_still(std::size_t triangle, std::span<const double> displacement, std::span<const double> moves2,
                                double share) const;
    [[nodiscard]] Moved move(std::size_t triangle, std::span<const double> displacement) const;
    [[nodiscard]] Energy energy_of(std::size_t triangle, const Moved& now) const;
    [[nodiscard]] double linear_energy_of(std::size_t triangle, const Moved& now) const;
    [[nodiscard]] Point move_point(std::size_t triangle, std::size_t k, const Local& local) const;
    [[nodiscard]] std::span<const double> edge_weights(std::size_t triangle, std::size_t point) const;

    const Shell& shell_;
    std::vector<Triangle> triangles_;   // [T]
    std::vector<double> edge_weights_;  // [T][6][stencil] of control vertices in x_,s
    std::vector<std::int32_t> vertices_;  // [T][stencil]
};

}  // namespace seldinger

#pragma once
// Description of a wire by its user: every property is a function of the material coordinate s [m] from the tip.

#include "math/vec3.h"

#include <optional>
#include <string>
#include <vector>

namespace seldinger {

/// Properties of a stretch of wire. Units SI.
struct WireSection {
    double radius = 0;                                         // outer radius r [m], > 0
    double density = 0;                                        // rho [kg/m^3], > 0
    double bend_stiffness = 0;                                 // B = EI [N m^2], > 0
    double twist_stiffness = 0;                                // C = GJ [N m^2], > 0
    double stretch_stiffness = 0;                              // EA [N], > 0
    double youngs = 0;                                         // E [Pa]; 0: not given, the wire is rigid in (D10)
    double poisson = 0.3;                                      // [-]
    double mu_static = 0.12;                                   // [-]
    double mu_sliding = 0.10;                                  // [-]
    Vec2 rest_curvature = Vec2::Zero();  // about the two directors [1/m]

    [[nodiscard]] bool operator==(const WireSection&) const = default;
};

struct WireSectionRange {
    double begin = 0, end = 0;  // [m] from the tip, begin < end
    WireSection section;
};

enum class PlaceShape { Straight, Arc, Ring, Points, Centreline };

/// Where a wire that is not fed starts (scene file, [wire] place).
struct WirePlacement {
    PlaceShape shape = PlaceShape::Straight;
    Vec3 base = Vec3::Zero();        // [m]
    Vec3 direction = Vec3::UnitX();  // from base towards the tip
    Vec3 normal = Vec3::UnitZ();     // first material director; the side that an arc bends to
    double bend_radius = 0;          // Arc [m]
    double twist = 0;                // Ring: inserted before closing [rad]
    double from = 0;                 // Centreline: base this far from the vessel's start [m]
    std::vector<Vec3> points;        // Points: from base to tip [m]
    bool stretched = false;          // Points: their length is that of the wire under tension, which fills them evenly
    bool rest_is_placed = false;     // stress-free shape is the placed one
    Vec3 velocity = Vec3::Zero();    // initial [m/s]
    double spin_rate = 0;            // initial, right-handed about the direction of insertion [rad/s]
};

/// Integrated curvature of a node whose edges turn by phi (rod/curvature.h): phi itself, or 2 tan(phi/2) as published.
enum class CurvatureMeasure { Angle, Tangent };

struct WireSpec {
    double length = 0;                          // whole wire [m]
    double lumen_radius = 0;                    // of a catheter or a sheath, below the shaft's radius [m]; 0: solid
    int nodes = 0;                              // number over the whole length; 0 = adaptive
    double min_edge = 0.001, max_edge = 0.010;  // adaptive only [m]
    CurvatureMeasure curvature = CurvatureMeasure::Angle;
    double edge_error = 2e-6;  // adaptive only: tip displacement that one edge's error may cause (nodes/adapt.h) [m]
    WireSection shaft;                       // where no section says otherwise
    std::vector<WireSectionRange> sections;  // later ones win
    WirePlacement place;                     // ignored for a fed wire

    /// Section at material coordinate s [m]; s is clamped to [0, length].
    [[nodiscard]] const WireSection& at(double s) const;
    /// visit(s) for each place where a section begins or ends, in the order of the sections [m].
    template <class Visit>
    void for_each_end(Visit visit) const
    {
        for (const WireSectionRange& range : sections) visit(range.begin), visit(range.end);
    }
    [[nodiscard]] double least_radius() const;    // outer, of all sections [m]
    [[nodiscard]] double largest_radius() const;  // the same
};

}  // namespace seldinger

#pragma once
// Error bands of a run's forces and tip (D17): the shares of the edges' lengths and of the wall's facets, from the run's state at
// one moment.
//
// In a lumen the wall prescribes the wire's shape, so that forces are derivatives of its bending energy. D17 has the formula of
// each share: energy, work of the normal forces over the distance from a smooth wall, push along the wire, creases, places of
// loads, patch, weight, and the tip on its two nearest regions of contact.
//
// The smooth wall goes through the mesh's vertices with the normals there (means over their triangles by angle). Each contact is
// borne by the spans beside it, up to the next regions of contact, and by passes_span (nodes/adapt.h) of those behind them.
//
// Elastic walls: their facets move, and the mesh has bands of its own (wall/wall_resolution.h); none here.

#include "bands/error_band.h"
#include "engine.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace seldinger {

/// Errors by the length of edges and by facets.
struct GridShare {
    double nodes = 0, facets = 0;
};

/// Errors of forces at one moment.
struct GridErrors {
    GridShare energy;              // relative: of what pushes the wire back, by the energy of all of it
    GridShare missed;              // of that energy itself [J]
    GridShare pressed, patch;      // relative: of the sum of normal forces; of those of the region with the largest load
    GridShare placed;              // relative: of the force on a patch, by where along the wire the largest load lies; bounds
    double axial = 0;              // by normals of facets, along the wire, relative to the sum of normal forces
    double normal = 0;             // that sum [N]
    double rise = 0;               // mean distance of facet and smooth wall, weighted by normal forces [m]
    double tip = 0;                // by facets, of the tip's position [m]
    double split = 0;              // of the force on a patch: F_2/F_1 beside the place with the largest load
    std::vector<double> hands;     // by nodes, at the hand of each instrument besides (node_errors.h); bounds [N]
    /// The larger of each.
    void widen(const GridErrors& other);
};

[[nodiscard]] GridShare times(const GridShare& share, double force);
/// Of a hand force of which `friction` is friction and the rest what pushes the wire back.
[[nodiscard]] GridShare of_hand(const GridErrors& errors, double hand, double friction);
/// What nodes do to the hand of an instrument besides.
[[nodiscard]] double of_hand_at(const GridErrors& errors, std::size_t instrument);
/// Where along the wire the load on a patch lies, and whether that of the next node lies on the same patch: the band holds all of
/// it. These are bounds and no expected errors, and so no reason for a warning.
void add_places(ErrorBand& band, const GridErrors& errors);

/// Samples of one region of contact: sums of their normal forces, and with these as weights.
struct TouchedRegion {
    int wire = 0;
    double load = 0, along = 0, inwards = 0, sideways = 0;  // [N]; distance from the tip, and what facets move it by [N m]
    double half_edge = 0, lengthways = 0;  // how far along the wire it may lie by edges, and lies by facets [N m]
    [[nodiscard]] double at() const { return along / load; }
    [[nodiscard]] double by() const { return std::hypot(inwards, sideways) / load; }
};

class GridErrorGauge {
public:
    /// Errors of the instruments of a system, at the accepted state.
    [[nodiscard]] GridErrors of(const World& run, int system = 0);

private:
    void find_normals(const WallMesh& mesh);
    void find_regions(const World& run, int first, int end, GridErrors& errors);
    /// Of the forces of region k of a wire, relative.
    [[nodiscard]] GridShare beside(const World& run, int wire, std::size_t k) const;
    /// Of the forces of region k of a wire by where along it they lie, relative.
    [[nodiscard]] GridShare placed(const World& run, int wire, std::size_t k) const;
    void add_spans(const World& run, int first, int end, const BendingError& whole, GridErrors& errors);
    /// How far a normal that is off by `off` moves the place of a load across the wire: over the wall's curvature there, and no
    /// farther than the triangle is wide [m].
    [[nodiscard]] double sideways(const WallMesh& mesh, const std::array<std::int32_t, 3>& triangle, const Vec3& off,
                                  const Vec3& across) const;
    std::vector<Vec3> normals_;  // of the mesh's vertices; made when first needed
    // of the moment that is looked at
    std::vector<TouchedRegion> regions_;  // by wire, from the tip on
    double creases_ = 0;                  // relative to the sum of normal forces
    GridShare places_;                    // of that sum, by where along the wire the loads lie
};

}  // namespace seldinger

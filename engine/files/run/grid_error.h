#pragma once
// Estimate of what the lengths of edges and the facets of the wall do to a run's forces, from its state at one moment.
//
// In a lumen the wall prescribes the wire's shape, so that forces are derivatives of the bending energy U, which is quadratic in the
// deflections d of the wire: U = K d^2/2, F = K d.
//
//     edges     energy wrong by dU in the same shape: a stiffness wrong by dU/U, so   dF/F = dU/U       (nodes/adapt.h)
//     facets    a wall that lies o nearer to the axis than a smooth one gives U back as the work of the normal forces F_i on it,
//               dU = sum F_i o_i, of a deflection that is wrong by dd/d = dU/(2 U), so  dF/F = sum F_i o_i/(2 U)
//     facets    a normal n_i that differs from the smooth wall's m_i pushes along the wire's tangent t_i:  dF = sum F_i (n_i - m_i).t_i
//
// These are errors of what pushes the wire back along its path, dU/ds. Each contact is borne by the spans beside it, up to the next regions of
// contact, and by passes_span (nodes/adapt.h) of those behind them: the error of its normal force is that of their energy, and of the work of the normal forces there. Friction goes by the normal forces, the force on a patch by its region's.
//
//     creases   a wire in the crease of two facets is borne by both. With the angle a between each facet's normal and the direction in which
//               they push together, the sum of their forces is 1/cos a of the force of a smooth wall (contact_law.h reports the sum)
//
// The smooth wall goes through the mesh's vertices with the normals there (means over their triangles by angle). At a point x
// with barycentric coordinates b_k it has the normal sum b_k m_k, and lies at o = sum b_k (x - v_k).m_k/2, the sagitta L^2/(8 R) in the middle
// of a facet of length L across a radius R: tangent planes at the vertices are twice as far away as the surface that touches them.
//
//     place     a load lies on the wire's samples, and an edge is straight: where along the wire it lies is known to d = h/2 of the edge h there, and
//               to what facets move it by (lengthways, as sideways below)
//
// A beam over supports at l_1 and l_2 from a contact, tangent to the wall there, has the force F = 3 B (l_1 + l_2) w/(l_1 l_2)^2 (w: its deflection). Where the
// place moves by d, w grows by d w (l_2 - l_1)/(l_1 l_2), which leaves dF/F = (1/l_2 - 1/l_1) d; 1.5 times that for ends that are held. A support that moves
// by d has dF/F = d (l_1 + 2 l_2)/(2 l_1 (l_1 + l_2)). Taken is dF/F = d (1/l_1 + 1/l_2), about the root of the sum of squares of the three. It is of first order in h where errors by
// energy are of second. Loads within 1.5 edges may be the same one and are no supports. That is a bound of the force on a patch, of one place. A hand and
// friction have the sum of all, whose places are independent: the root of the sum of squares of F dF/F, over sqrt(3), the root mean square of a place that is as
// likely anywhere within d. Weight is borne wherever it lies, and has none of it; nor have instruments that bend together.
//
// The equilibrium of that push changes normal forces and friction by the same share of themselves, sum F_i (n_i - m_i).t_i/sum F_i.
//
//     patch     a load between two nodes is borne by both. Where an edge is longer than the patch that a force is read on, the loads of two
//               places of contact beside each other may be one patch's: the larger one, F_1, may be F_1 + F_2.
//
// Weight on the floor of a lumen is borne whatever the wire's stiffness: the errors by energy are those of the part of the normal forces
// beyond the weight. The rest is off by what the nodes of the span l between hub and nearest contact share out wrongly: 1/(2 n^2) of the weight w l of its n = l/h
// edges, as of a cantilever, and w h/2 where an edge is longer than the span. Of the sum N of normal forces that is w h^2/(2 l N).
// A wire that touches nothing is bent by its weight alone. Its moment at the hub, w L^2/2, is read off half an edge: it errs by h/L besides.
//
// The tip stands on the regions of contact nearest to it, at s_1 and s_2 from it. Facets move their places by d_1, d_2:
//
//     inwards   o, as above
//     sideways  in a lumen of radius R across the wire, a load rests where the wall's normal opposes it. A normal that is off by
//               (n - m).(t x m) moves that place by R times as much, as a pendulum's
//
// A beam over two supports has a slope of up to 3/2 (d_1 + d_2)/(s_2 - s_1) at the first (the next span held; 1 where it turns freely), so that the tip moves by
// a_1 = 1 + 3/2 s_1/(s_2 - s_1) times d_1, and a_1 - 1 times d_2. Along the wall it moves by the mean of o times the angle that the wire turns by,
// the difference in length of two parallel curves. The three are independent: root of the sum of squares.
//
// Elastic walls: their facets move, and the mesh has bands of its own (wall/wall_resolution.h); none here.

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

/// Samples of one region of contact: sums of their normal forces, and with these as weights.
struct TouchedRegion {
    int wire = 0;
    double load = 0, along = 0, inwards = 0, sideways = 0;  // [N]; distance from the tip, and what facets move it by [N m]
    double half_edge = 0, lengthways = 0;                   // how far along the wire it may lie by edges, and lies by facets [N m]
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
    /// How far a normal that is off by `off` moves the place of a load across the wire: over the wall's curvature there, and no farther than the
    /// triangle is wide [m].
    [[nodiscard]] double sideways(const WallMesh& mesh, const std::array<std::int32_t, 3>& triangle, const Vec3& off, const Vec3& across) const;
    std::vector<Vec3> normals_;  // of the mesh's vertices; made when first needed
    // of the moment that is looked at
    std::vector<TouchedRegion> regions_;  // by wire, from the tip on
    double creases_ = 0;                  // relative to the sum of normal forces
    GridShare places_;                    // of that sum, by where along the wire the loads lie
};

}  // namespace seldinger

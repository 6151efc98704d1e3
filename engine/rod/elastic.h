#pragma once
// Stretch, bend and twist of one wire (D1-D3): energy, force, Hessian; and the time-parallel frames they live in.
// [Bergou08], [Bergou10], [Jawed18]; symbols in engine/README.md.
//
// A trial configuration (x, theta) is always described relative to the accepted one in RodView: trial tangents follow from
// trial positions, trial reference directors by parallel transport of the accepted ones from accepted to trial tangent,
// reference twist by continuity from the accepted value.

#include "rod/rod_arrays.h"
#include "solve/band_matrix.h"

namespace seldinger {

/// Positions and angles being tried, spans of length n (theta: n-1 used).
struct RodTrial {
    std::span<const double> x, y, z, theta;
};

/// A clamp ("half-Voronoi"): the tangent at `node` is prescribed, to second order in the edge length. It acts on the edge(s)
/// that meet there through bending (and, if `spin`, twist) springs over half the edge's rest length:
/// E = B |kappa - rest_kappa/2|^2 / (2 (rest_length/2)), kappa from (clamp tangent, edge), and likewise twist.
struct RodClamp {
    int node = 0;
    bool direction = true;          // else only spin is held
    bool spin = false;
    Vec3 tangent = Vec3::UnitX();   // unit, oriented tip -> hub like the edges' tangents
    Vec3 director = Vec3::UnitZ();  // first MATERIAL director of the clamp, unit, normal to tangent
    double turns = 0;               // continuous angle that the director was turned by [rad], to count full turns
};

/// Scratch of one wire at a trial configuration; allocated once for the capacity.
struct RodFrames {
    explicit RodFrames(int capacity = 0);
    std::vector<Vec3> tangent, d1, m1, m2, kb;  // [n-1] tangents, reference director, material directors; [n] kb
    std::vector<double> edge_length, ref_twist, kappa1, kappa2, twist;
    // clamps: reference twist between clamp director and the edge's reference director, kept continuous (two sides)
    std::vector<double> clamp_ref_twist;        // [2 * clamps]
};

enum class HessianMode { None, Exact, Safe };  // Safe: positive semidefinite per stencil, never indefinite

/// Frames, curvature and twist at `trial`. O(n), no allocation. Edge length 0 or a fold of exactly pi gives non-finite
/// values, which the caller must treat as inadmissible. @return false if anything is not finite
[[nodiscard]] bool update_frames(const RodView& rod, const RodTrial& trial, std::span<const RodClamp> clamps, RodFrames& frames);

/// Elastic energy [J] at the configuration of `frames`.
[[nodiscard]] double elastic_energy(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames);

/// Adds +dE/dq to `gradient` [4n] (x, y, z, theta per node; theta of the last node unused) and d2E/dq2 to `hessian`.
void add_elastic(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames,
                 std::span<double> gradient, BandMatrix* hessian, HessianMode mode);

/// Makes the trial configuration the accepted one: positions, theta, tangents, directors, reference twist.
void accept_frames(const RodView& rod, const RodTrial& trial, const RodFrames& frames);

/// Sets tangents and reference directors of a wire from its positions: director of the HUB edge is `normal` made
/// orthogonal, the rest by parallel transport along the wire towards the tip (so ref_twist = 0); theta = 0.
void initialise_frames(const RodView& rod, const Vec3& normal);

/// Rest shape, stiffness, mass of all nodes and edges from the spec and the nodes' material_s (rest lengths are its
/// differences). If rest_is_placed, rest_kappa and rest_twist come from the present shape (frames must be set).
void set_rest_shape(const RodView& rod, const WireSpec& spec, bool rest_is_placed);

/// dE/d(rest length of the base edge) at fixed positions = axial hand force + bending/twist configurational terms [N],
/// + when the hand pushes (design section 1; [Bosi14]). Clamps at the hub included.
[[nodiscard]] double feed_force(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames);

/// Torque that the clamp at `node` exerts on the wire about its tangent [N m] (+ = in the sense of increasing theta).
[[nodiscard]] double clamp_torque(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, int clamp);
/// Force needed at the clamped node: see solve (reaction = residual at prescribed unknowns).

}  // namespace seldinger

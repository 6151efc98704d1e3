#pragma once
// Stretch, bend and twist of one wire (D1-D3): energy, force, Hessian; and the time-parallel frames they live in.
// [Bergou08], [Bergou10], [Jawed18]; symbols in engine/README.md.
//
// A trial configuration (x, theta) is always described relative to the accepted one in RodView. Trial tangents follow from trial
// positions, trial reference directors by parallel transport of the accepted ones from accepted to trial tangent, reference twist
// by continuity from the accepted value.

#include "rod/rod_arrays.h"
#include "math/band_matrix.h"

namespace seldinger {

/// Positions and angles being tried, spans of length n (theta: n-1 used).
struct RodTrial {
    std::span<const double> x, y, z, theta;
};

/// A clamp ("half-Voronoi"): the tangent at `node` is prescribed, to second order in the edge length. It acts on the edge(s)
/// that meet there through bending (and, if `spin`, twist) springs over half the edge's rest length, a = rest_length/2:
/// E = B |kappa - share rest_kappa|^2 / (2 a), kappa from (clamp tangent, edge), share = a / voronoi_length (1 at tip and hub);
/// twist in the same way. At an inner node these take the place of the node's own energy: `direction` of its bending,
/// `spin` of its twist.
struct RodClamp {
    int node = 0;
    bool direction = true;  // else only spin is held
    bool spin = false;
    Vec3 tangent = Vec3::UnitX();   // unit, oriented tip -> hub like the edges' tangents
    Vec3 director = Vec3::UnitZ();  // first MATERIAL director of the clamp, unit, normal to tangent
    // Continuous angle by which the director was turned [rad], so that full turns count, in the gauge of the edges' theta. Twist
    // between clamp and edge is theta - turns + (angle of the unturned director from the edge's ref_d1).
    double turns = 0;
};

/// Arrays that are read and written in whole vectors have this many entries beyond their last: the most that math/lanes.h has.
inline constexpr int lane_padding = 8;

/// A vector per node or edge, kept as three arrays; read as one.
class Vec3Array {
public:
    explicit Vec3Array(int size = 0) : size_(size), all_(3 * static_cast<std::size_t>(size)) {}
    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] Vec3 operator[](int i) const { return {all_[i], all_[size_ + i], all_[2 * size_ + i]}; }
    void set(int i, const Vec3& v)
    {
        for (int c = 0; c < 3; ++c) all_[c * size_ + i] = v[c];
    }
    /// All x, y or z.
    [[nodiscard]] double* component(int c) { return all_.data() + c * size_; }
    [[nodiscard]] const double* component(int c) const { return all_.data() + c * size_; }

private:
    int size_;
    std::vector<double> all_;
};

/// Scratch of one wire at a trial configuration; allocated once for the capacity. Arrays are longer than that: whole vectors of
/// numbers are read and written at their ends (math/lanes.h).
struct RodFrames {
    explicit RodFrames(int nodes = 0, int clamp_capacity = 16);
    int capacity = 0;  // nodes
    // False: the wire is straight by nature and isotropic, and its spin angles do not change. Its gradient and Hessian need
    // neither directors nor twist, and update_frames() leaves out d1, m1, m2, ref_twist, kappa1, kappa2, twist and the clamps'.
    bool spins = true;
    bool material = true;  // False: the wire is straight by nature, and update_frames() leaves out m1, m2, kappa1 and kappa2.
    Vec3Array tangent, d1, m1, m2, kb;  // [n-1] tangents, reference director, material directors; [n] kb
    std::vector<double> edge_length;    // [n-1] [m]
    // [n], 0 at tip and hub; kappa in the frame midway between the edges' material frames (rod/pair.h), twist unbounded [rad]
    std::vector<double> chi, ref_twist, kappa1, kappa2, twist;  // chi = 1 + cos(turning angle)
    // clamps, side 0: edge on the tip side, side 1: on the hub side
    std::vector<int> clamp_node;          // [clamps]
    std::vector<double> clamp_ref_twist;  // [2 * clamps] between clamp director and the edge's d1, kept continuous
    std::vector<double> clamp_twist;      // [2 * clamps] that and the edge's theta; 0 without spin
    int clamp_count = 0;
};

/// Strain of edge j against its rest length [-].
[[nodiscard]] inline double stretch_strain(const RodView& rod, const RodFrames& frames, int j)
{
    return (frames.edge_length[j] - rod.rest_length[j]) / rod.rest_length[j];
}

/// Projected: to positive semidefinite, stencil by stencil (PSD projection); never indefinite.
enum class HessianMode { None, Exact, Projected };

/// Frames, curvature and twist at `trial`. O(n), no allocation. @return false where there is no such configuration: an edge of
/// length 0, two edges (or edge and clamp) folded to pi, an edge turned by pi since the accepted state, anything not finite.
/// `frames` is then meaningless and must not be used; the accepted state is untouched.
[[nodiscard]] bool update_frames(const RodView& rod, const RodTrial& trial, std::span<const RodClamp> clamps, RodFrames& frames);

/// Whether every node's natural curvature is 0.
[[nodiscard]] bool straight_by_nature(const RodView& rod);

/// Elastic energy [J] at the configuration of `frames`.
[[nodiscard]] double elastic_energy(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames);

/// Adds +dE/dq to `gradient` (laid out as RodDofs says; left out when empty) and d2E/dq2 to
/// `hessian` (may be null). O(n), no allocation.
///
/// dE/dx is the force for a change of shape in which no material frame spins about its own tangent. At the accepted state
/// that is the derivative of E(x, theta). At another trial state, moving edge j also spins its frame by (t x t0).dt/(1 + t0.t),
/// t0 the accepted tangent (holonomy). So the derivative of the function E(x, theta) is dE/dx + (dE/dtheta_j) (that)/dx. The
/// physical balance is the one without this term (all moments about t do the same extra work, inertia and contact included), and
/// both vanish together where theta is free. A line search on E with theta prescribed against a torque M sees a slope wrong by M
/// times half of the rotation since the accepted state. If that matters, accept the frames between iterations of a static solve,
/// or test the residual instead.
///
/// `Exact` is the symmetric part of the derivative of this gradient, = d2E/dq2 at the accepted state.
/// `Projected`: see rod/pair.h for bending and twist; stretch without the geometric term of a compressed edge.
void add_elastic(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, std::span<double> gradient,
                 BandRows* hessian, HessianMode mode);

/// Makes the trial configuration the accepted one: positions, theta, tangents, directors, reference twist.
void accept_frames(const RodView& rod, const RodTrial& trial, const RodFrames& frames);

/// Sets tangents and reference directors of a wire from its positions. The director of the HUB edge is `normal` made orthogonal,
/// the others follow by parallel transport along the wire towards the tip (so ref_twist = 0); theta = 0.
void initialise_frames(const RodView& rod, const Vec3& normal);

/// Rest shape, stiffness, mass of all nodes and edges from the spec and the nodes' material_s (rest lengths are its
/// differences). If rest_is_placed, rest_kappa and rest_twist come from the present shape (frames must be set).
void set_rest_shape(const RodView& rod, const WireSpec& spec, bool rest_is_placed);

/// Axial force with which the hand pushes the wire in [N], positive for a push, negative for a pull. It is the derivative of the
/// elastic energy with respect to the rest length of the base edge at fixed nodes. That is the axial force of that edge and the
/// configurational force of bending and twist [Bosi14]. The weight, along the wire, of the half edge at the inlet, whose
/// mass the hub carries, and the clamps at the hub are included.
/// @param spec  the wire: what is fed is its material at the hub
[[nodiscard]] double feed_force(const RodView& rod, const WireSpec& spec, std::span<const RodClamp> clamps,
                                const RodFrames& frames, const Vec3& gravity);

/// Torque that the clamp at `node` exerts on the wire about its tangent [N m] (+ = in the sense of increasing theta).
[[nodiscard]] double clamp_torque(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, int clamp);
/// Force needed at the clamped node: see solve (reaction = residual at prescribed unknowns).

}  // namespace seldinger

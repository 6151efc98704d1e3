// Decides when spin angles need no solution.
//
// In a wire that is straight by nature and isotropic nothing is fixed to the material frames but twist and spin inertia. Where no
// torque acts either, the spins' equations J theta'' + C (twist)'/l = torque hold without them, and 3/4 of the unknowns are left.
// This is exact in any plane motion, where parallel transport turns no frame. In space, where the frames follow the wire, it
// holds to the torsional inertia J theta'' (1e-4 of the bending forces and less). It is not taken on trust. After each step
// solved without them the spins' equations are evaluated, friction's torque included. A step in which they do not hold to the
// solver's tolerance is solved again with them (Solver::check_spins).
#include "rod/clamp.h"
#include "solve/wire_problem.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// Whether a clamp of the spin twists an edge by more than `moment` [N m] at the start of the step.
bool clamp_twists(const RodView& rod, const RodClamp& clamp, double moment)
{
    for (int side = 0; side < 2 && clamp.spin; ++side) {
        const int j = clamp_edge(rod, clamp.node, side);
        if (j < 0) continue;
        const double last = side == 0 ? rod.clamp_twist_a[clamp.node] : rod.clamp_twist_b[clamp.node];
        const double turn = (side == 0 ? 1 : -1) * (clamp.turns - rod.theta[j]);
        const double twist = turn + clamp_reference(clamp, side, rod.tangent(j), rod.ref_d1(j), last);
        if (std::abs(rod.twist_stiffness[clamp.node] / (0.5 * rod.rest_length[j]) * twist) > moment) return true;
    }
    return false;
}

}  // namespace

// To the tolerance of moments, nothing twists the wire at the start of the step, nor is meant to. Forces that follow the spins
// are evaluated with the angles as they are, so there these must not move by more than what a solve leaves open, a millionth of
// the radius.
bool WireProblem::may_leave(SpinAngles spins) const
{
    constexpr double still = 1e-6;  // [rad] in one step
    if (spins == SpinAngles::SolvedFor || role != WireRole::Alone || time.motion() != Motion::Implicit ||
        dead_loads_.unsymmetric())
        return false;
    for (const auto& [unknown, value] : constraints_->prescribed)
        if (RodDofs::is_spin(unknown)) return false;
    const double moment = tolerance * length_scale;
    for (int i = 0; i < rod.n; ++i) {
        if (rod.rest_kappa1[i] != 0 || rod.rest_kappa2[i] != 0 || rod.rest_twist[i] != 0) return false;
        if (i + 1 == rod.n) break;
        if (spins == SpinAngles::LeftIfStill && std::abs(time.start_velocity(RodDofs::spin(i))) * time.step() > still)
            return false;
        if (i == 0) continue;
        const double twist = rod.theta[i] - rod.theta[i - 1] + rod.ref_twist[i];
        if (std::abs(rod.twist_stiffness[i] / rod.voronoi_length(i) * twist) > moment) return false;
    }
    return std::none_of(clamps.begin(), clamps.end(), [&](const RodClamp& clamp) { return clamp_twists(rod, clamp, moment); });
}

bool WireProblem::spins_balanced() const
{
    for (int j = 0; j < rod.n - 1; ++j)
        if (!(std::abs(q.residual[RodDofs::spin(j)]) <= tolerance * length_scale)) return false;
    return true;
}

void WireProblem::untwist()
{
    const auto angle_of = [&](int j) -> double& { return q.trial[RodDofs::spin(j)]; };
    int from = -1;  // edge whose angle is known
    double angle = 0;
    for (int k = 0; k < static_cast<int>(clamps.size()) && from < 0; ++k)
        for (int side = 0; side < 2 && clamps[k].spin && from < 0; ++side) {
            from = clamp_edge(rod, clamps[k].node, side);
            if (from >= 0) angle = angle_of(from) + (side == 0 ? 1 : -1) * frames.clamp_twist[2 * k + side];
        }
    const bool held = from >= 0;
    if (!held) {
        from = 0;
        angle = angle_of(0);
    }
    angle_of(from) = angle;
    for (int j = from + 1; j < rod.n - 1; ++j) angle_of(j) = angle_of(j - 1) - frames.ref_twist[j];
    for (int j = from - 1; j >= 0; --j) angle_of(j) = angle_of(j + 1) + frames.ref_twist[j + 1];
    if (held) return;
    double rate = 0, sum = 0;  // of spin momentum, and its slope with all angles
    for (int j = 0; j < rod.n - 1; ++j) {
        const int k = RodDofs::spin(j);
        rate += q.inertia[k] * time.acceleration(q, k);
        sum += q.inertia[k] * time.acceleration_rate();
    }
    for (int j = 0; j < rod.n - 1; ++j) angle_of(j) -= rate / sum;
}

}  // namespace seldinger

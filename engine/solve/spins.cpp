// When spin angles need not be solved for.
//
// In a wire that is straight by nature and isotropic nothing is fixed to the material frames but twist and spin inertia. Where no
// torque acts either, the spins' equations J theta'' + C (twist)'/l = torque hold by themselves, and three quarters of the
// unknowns are left: exactly in any plane motion, where parallel transport turns no frame; to the torsional inertia J theta''
// (1e-4 of the bending forces and less) in space, where the frames follow the wire. It is not taken on trust: after each step
// solved without them the spins' equations are evaluated, friction's torque included, and a step in which they do not hold to the
// solver's tolerance is solved again with them.

#include "rod/clamp.h"
#include "solve/wire_problem.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

/// Whether nothing twists the wire at the start of the step, to the tolerance of moments, nor is meant to. Contact is evaluated
/// with the angles as they are, so in contact they must not move by more than what a solve leaves open, a millionth of the
/// radius.
bool WireProblem::may_leave(SpinAngles spins) const
{
    constexpr double still = 1e-6;  // [rad] in one step
    if (spins == SpinAngles::SolvedFor) return false;
    for (const auto& load : constraints_->loads)
        if (!load.moment.isZero()) return false;
    for (const auto& [unknown, value] : constraints_->prescribed)
        if (unknown % 4 == 3) return false;
    const double moment = tolerance * length_scale;
    for (int i = 0; i < rod.n; ++i) {
        if (rod.rest_kappa1[i] != 0 || rod.rest_kappa2[i] != 0 || rod.rest_twist[i] != 0) return false;
        if (i + 1 == rod.n) break;
        if (spins == SpinAngles::LeftIfStill && std::abs(start_velocity_[4 * i + 3]) * h > still) return false;
        if (i == 0) continue;
        const double twist = rod.theta[i] - rod.theta[i - 1] + rod.ref_twist[i];
        if (std::abs(rod.twist_stiffness[i] / rod.voronoi_length(i) * twist) > moment) return false;
    }
    for (const RodClamp& clamp : clamps)
        for (int side = 0; side < 2 && clamp.spin; ++side) {
            const int j = clamp_edge(rod, clamp.node, side);
            if (j < 0) continue;
            const double last = side == 0 ? rod.clamp_twist_a[clamp.node] : rod.clamp_twist_b[clamp.node];
            const double turn = (side == 0 ? 1 : -1) * (clamp.turns - rod.theta[j]);
            const double twist = turn + clamp_reference(clamp, side, rod.tangent(j), rod.ref_d1(j), last);
            if (std::abs(rod.twist_stiffness[clamp.node] / (0.5 * rod.rest_length[j]) * twist) > moment) return false;
        }
    return true;
}

void WireProblem::take_spins_in()
{
    frames.spins = start_frames_.spins = true;
    matrix.set_fourth(true);
    for (int j = 0; j < rod.n - 1; ++j) prescribed[4 * j + 3] = 0;
    if (!conserving_) return;
    std::swap(start, trial);  // frames of the start, of which only tangents were kept
    start_usable_ = update_frames(rod, trial_view(), clamps, start_frames_);
    std::swap(start, trial);
}

bool WireProblem::spins_hold(const ForceTerms& terms, int wire)
{
    take_spins_in();
    if (!terms.follows_spins() && update()) untwist();
    if (!update() || !evaluate_residual(terms, wire)) return false;
    for (int j = 0; j < rod.n - 1; ++j)
        if (!(std::abs(residual[4 * j + 3]) <= tolerance * length_scale)) return false;
    return true;
}

/// Angles that leave no twist, from a clamp of the spin on or else with the spins' momentum kept, which no torque changes.
void WireProblem::untwist()
{
    int from = -1;  // edge whose angle is known
    double angle = 0;
    for (int k = 0; k < static_cast<int>(clamps.size()) && from < 0; ++k)
        for (int side = 0; side < 2 && clamps[k].spin && from < 0; ++side) {
            from = clamp_edge(rod, clamps[k].node, side);
            if (from >= 0) angle = trial[4 * from + 3] + (side == 0 ? 1 : -1) * frames.clamp_twist[2 * k + side];
        }
    const bool held = from >= 0;
    if (!held) {
        from = 0;
        angle = trial[3];
    }
    trial[4 * from + 3] = angle;
    for (int j = from + 1; j < rod.n - 1; ++j) trial[4 * j + 3] = trial[4 * j - 1] - frames.ref_twist[j];
    for (int j = from - 1; j >= 0; --j) trial[4 * j + 3] = trial[4 * j + 7] + frames.ref_twist[j + 1];
    if (held) return;
    double rate = 0, sum = 0;  // of spin momentum, and its slope with all angles
    for (int j = 0; j < rod.n - 1; ++j) {
        rate += inertia[4 * j + 3] * acceleration(4 * j + 3);
        sum += inertia[4 * j + 3] * acceleration_rate_;
    }
    for (int j = 0; j < rod.n - 1; ++j) trial[4 * j + 3] -= rate / sum;
}

}  // namespace seldinger

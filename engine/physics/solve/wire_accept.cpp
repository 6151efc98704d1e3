// The reference configuration of a wire's trials, and its accepted state.
#include "solve/wire_problem.h"

#include <algorithm>

namespace seldinger {

// ---- reference --------------------------------------------------------------------------------------------------------------
// A trial is described relative to the accepted tangents, from which no edge may turn by pi. A static solve that turns farther
// moves that reference along; positions stay those of the start, which force terms measure from.

bool WireProblem::far_from_reference() const
{
    if (role == WireRole::Passenger) return false;
    for (int j = 0; j < rod.n - 1; ++j)
        if (frames.tangent[j].dot(rod.tangent(j)) < 0.5) return true;
    return false;
}

void WireProblem::move_reference()
{
    if (role == WireRole::Passenger) return;
    accept_frames(rod, trial_view(), frames);
    restore_positions();
}

void WireProblem::restore_positions()
{
    for (int i = 0; i < rod.n; ++i) {
        rod.set_pos(i, node_of(q.start, i));
        rod.theta[i] = q.start[RodDofs::spin(i)];
    }
}

void WireProblem::keep_reference()
{
    for (std::size_t k = 0; k < reference_arrays().size(); ++k)
        std::copy_n(reference_arrays()[k].begin(), rod.n, kept_reference_.begin() + k * rod.n);
}

void WireProblem::restore_reference()
{
    for (std::size_t k = 0; k < reference_arrays().size(); ++k)
        std::copy_n(kept_reference_.begin() + k * rod.n, rod.n, reference_arrays()[k].begin());
    restore_positions();
}

std::array<std::span<double>, WireProblem::reference_count> WireProblem::reference_arrays() const
{
    return {rod.tx, rod.ty, rod.tz, rod.d1x, rod.d1y, rod.d1z, rod.ref_twist, rod.clamp_twist_a, rod.clamp_twist_b};
}

// ---- accepted state ---------------------------------------------------------------------------------------------------------

void WireProblem::write_velocity(int i, const double* v)
{
    rod.set_vel(i, {v[0], v[1], v[2]});
    if (i < rod.n - 1) rod.spin_rate[i] = v[RodDofs::spin_place];
}

void WireProblem::write_acceleration(int i, const double* a)
{
    rod.ax[i] = a[0];
    rod.ay[i] = a[1];
    rod.az[i] = a[2];
    if (i < rod.n - 1) rod.spin_acc[i] = a[RodDofs::spin_place];
}

void WireProblem::commit(bool accelerations)
{
    double *v = q.scratch.data(), *a = q.velocities.data();
    if (time.motion() == Motion::Implicit) {
        time.velocities(q, v);
        if (accelerations) time.accelerations(q, a);
    } else {
        std::fill_n(v, size(), 0.0);
        std::fill_n(a, size(), 0.0);
    }
    for (int i = 0; i < rod.n; ++i) {
        write_velocity(i, v + RodDofs::position(i));
        if (accelerations) write_acceleration(i, a + RodDofs::position(i));
    }
    if (role != WireRole::Alone)
        for (int j = 0; j < rod.n; ++j) rod.theta[j] = q.trial[RodDofs::spin(j)];  // the last one is the clamp's
    if (role != WireRole::Passenger) accept_frames(rod, trial_view(), frames);
}

void WireProblem::take_from(const RodView& line)
{
    const std::span<double> to[] = {rod.x,  rod.y,  rod.z,  rod.vx,  rod.vy,  rod.vz,  rod.ax,        rod.ay,           rod.az,
                                    rod.tx, rod.ty, rod.tz, rod.d1x, rod.d1y, rod.d1z, rod.ref_twist, rod.clamp_twist_a};
    const std::span<double> from[] = {line.x,  line.y,  line.z,  line.vx,       line.vy,           line.vz,
                                      line.ax, line.ay, line.az, line.tx,       line.ty,           line.tz,
                                      line.d1x, line.d1y, line.d1z, line.ref_twist, line.clamp_twist_a};
    for (std::size_t k = 0; k < std::size(to); ++k) std::ranges::copy(from[k], to[k].begin());
}

void WireProblem::move_explicit()
{
    const double h = time.step();
    for (int i = 0; i < size(); ++i) {
        if (q.prescribed[i]) {
            q.trial[i] = q.prescribed_value[i];
            q.residual[i] += q.inertia[i] * (time.explicit_velocity(q, i) - time.start_velocity(i)) / h;
        } else {
            q.trial[i] += h * (time.velocity(q, i) - h * q.residual[i] / q.inertia[i]);
        }
    }
}

void WireProblem::commit_explicit()
{
    for (int i = 0; i < rod.n; ++i) {
        double v[RodDofs::per_node];
        for (int c = 0; c < RodDofs::per_node; ++c) v[c] = time.explicit_velocity(q, RodDofs::position(i, c));
        write_velocity(i, v);
    }
    accept_frames(rod, trial_view(), frames);
}

void WireProblem::set_acceleration_from_residual()
{
    for (int i = 0; i < rod.n; ++i) {
        double a[RodDofs::per_node];
        for (int c = 0; c < RodDofs::per_node; ++c) {
            const int k = RodDofs::position(i, c);
            a[c] = q.prescribed[k] || q.inertia[k] == 0 ? 0.0 : -q.residual[k] / q.inertia[k];
        }
        write_acceleration(i, a);
    }
}

}  // namespace seldinger

// Start of a step, residual and tangent of one wire.
#include "solve/wire_problem.h"

#include "core/prefetch.h"
#include "rod/discrete_gradient.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

WireProblem::WireProblem(int capacity, const IntegratorSpec& spec)
    : frames(capacity),
      time(capacity),
      tension(capacity),
      dead_loads_(capacity),
      damping_(spec.damping_stiffness > 0 ? RodDofs::count(capacity) : 0),
      start_frames_(spec.conserve ? capacity : 0),
      turned_(capacity),
      kept_reference_(reference_count * capacity),
      scratch_(2 * RodDofs::count(capacity))
{
}

// ---- start of a step --------------------------------------------------------------------------------------------------------

void WireProblem::begin(const RodView& view, const WireConstraints& constraints, const StepEquations& step)
{
    const auto& [spec, gravity, motion, h, spins] = step;
    rod = view;
    constraints_ = &constraints;
    clamps.assign(constraints.clamps.begin(), constraints.clamps.end());
    base_tension_excess = 0;
    const int n = rod.n;
    for (int i = 0; i < n; ++i) {
        const double x[RodDofs::per_node] = {rod.x[i], rod.y[i], rod.z[i], i < n - 1 ? rod.theta[i] : 0.0};
        const double m[RodDofs::per_node] = {rod.mass[i], rod.mass[i], rod.mass[i], i < n - 1 ? rod.spin_inertia[i] : 0.0};
        std::copy_n(x, RodDofs::per_node, &q.start[RodDofs::position(i)]);
        std::copy_n(m, RodDofs::per_node, &q.inertia[RodDofs::position(i)]);
    }
    std::copy_n(q.start.begin(), size(), q.trial.begin());
    std::fill_n(q.prescribed.begin(), size(), std::uint8_t{0});
    for (const auto& [unknown, value] : constraints.prescribed) {
        SEL_ASSERT(unknown >= 0 && unknown < RodDofs::unused(n));
        q.prescribed[unknown] = 1;
        q.prescribed_value[unknown] = value;
    }
    const int unused = RodDofs::unused(n);
    q.prescribed[unused] = 1;
    q.prescribed_value[unused] = q.start[unused];
    time.begin(rod, spec, motion, h, constraints.hub_flow);
    tension.begin(rod, [&, linearised = spec.scheme == Scheme::Linearised && motion == Motion::Implicit](int j) {
        return linearised ? tension_before(j) : tension_before_feed(j, (rod.pos(j + 1) - rod.pos(j)).norm());
    });
    dead_loads_.begin(rod, constraints, gravity);
    links_.begin(constraints, time.end_share());
    mass_damping_.begin(spec, motion);
    set_scales(spec, gravity);
}

void WireProblem::follow(const WireProblem& line)
{
    for (int i = 0; i < rod.n; ++i)
        for (int c = 0; c < RodDofs::coordinates; ++c) {
            q.prescribed[RodDofs::position(i, c)] = 1;
            q.inertia[RodDofs::position(i, c)] = 0;
        }
    length_scale = line.length_scale;
    force_scale = line.force_scale;
    tolerance = line.tolerance;
}

void WireProblem::begin_frames(const IntegratorSpec& spec, bool leave_spins)
{
    frames.spins = start_frames_.spins = !leave_spins;
    frames.material = time.conserving() || !straight_by_nature(rod);
    for (int j = 0; j < rod.n - 1 && leave_spins; ++j) {
        q.prescribed[RodDofs::spin(j)] = 1;
        q.prescribed_value[RodDofs::spin(j)] = q.start[RodDofs::spin(j)];
    }
    start_usable_ = !time.conserving() || update_frames(rod, trial_view(), clamps, start_frames_);
    set_stiffness_damping(spec);
}

/// Tension of an edge of that length, without the material fed since. That material pushes with EA h v/l, tens of newtons, until
/// this step has moved the wire on. Counted as stiffness against turning, it would buckle the base edge.
double WireProblem::tension_before_feed(int j, double length) const
{
    const double fed_in = j == rod.n - 2 ? constraints_->base_grown : 0.0;
    return rod.stretch_stiffness[j] * (length / (rod.rest_length[j] - fed_in) - 1);
}

/// Tension of an edge in the equations of the last step; one Newton step uses it against turning (the geometric stiffness of
/// stretching). At the start of the step that tension has changed by EA phi^2/2 where the edge turned by phi. No linear equation
/// has seen this change, it is gone one step later, and as stiffness it would hold the wire.
double WireProblem::tension_before(int j) const
{
    const Vec3 now = rod.pos(j + 1) - rod.pos(j);
    Vec3 move;
    for (int c = 0; c < RodDofs::coordinates; ++c)
        move[c] = time.known_move(RodDofs::position(j + 1, c)) - time.known_move(RodDofs::position(j, c));
    return tension_before_feed(j, now.dot((now - move).normalized()));
}

void WireProblem::set_stiffness_damping(const IntegratorSpec& spec)
{
    damping_stiffness_ = time.motion() == Motion::Static ? 0 : spec.damping_stiffness;
    if (damping_stiffness_ == 0) return;
    damping_.reset(size());
    if (!update()) return;  // a broken start is found out by the first evaluation
    add_elastic(rod, clamps, frames, {}, &damping_, HessianMode::Projected);
}

void WireProblem::take_spins_in()
{
    frames.spins = start_frames_.spins = true;
    for (int j = 0; j < rod.n - 1; ++j) q.prescribed[RodDofs::spin(j)] = 0;
    if (!time.conserving()) return;
    std::swap(q.start, q.trial);  // frames of the start, of which only tangents were kept
    start_usable_ = update_frames(rod, trial_view(), clamps, start_frames_);
    std::swap(q.start, q.trial);
}

void WireProblem::prefetch(SolveStage next) const
{
    const int n = rod.n;
    const auto nodes = [&](const auto&... arrays) { (seldinger::prefetch(arrays.data(), n * sizeof(double)), ...); };
    const auto vectors = [&](const auto&... arrays) {
        for (int c = 0; c < 3; ++c) (seldinger::prefetch(arrays.component(c), n * sizeof(double)), ...);
    };
    nodes(frames.ref_twist, rod.tx, rod.ty, rod.tz, rod.d1x, rod.d1y, rod.d1z, rod.ref_twist);
    vectors(frames.tangent, frames.d1);
    if (next != SolveStage::Commit) {
        dead_loads_.prefetch(size());
        tension.prefetch(n);
        nodes(frames.edge_length, frames.chi, frames.twist, rod.rest_length, rod.stretch_stiffness, rod.bend_stiffness,
              rod.twist_stiffness, rod.rest_kappa1, rod.rest_kappa2, rod.rest_twist);
        vectors(frames.kb);
    }
    if (next != SolveStage::Advance) nodes(rod.x, rod.y, rod.z, rod.theta, rod.vx, rod.vy, rod.vz, rod.spin_rate);
    if (next == SolveStage::Begin) nodes(rod.mass, rod.spin_inertia, rod.radius);
    time.prefetch(size(), next);
}

// ---- at a trial -------------------------------------------------------------------------------------------------------------

RodTrial WireProblem::trial_view() const
{
    const std::size_t n = rod.n;
    constexpr std::size_t per_node = RodDofs::per_node;
    double* s = q.split.data();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t c = 0; c < per_node; ++c) s[c * n + i] = q.trial[per_node * i + c];
    const auto part = [&](std::size_t c) { return std::span<const double>(s + c * n, n); };
    return {part(0), part(1), part(2), part(RodDofs::spin_place)};
}

// A discrete gradient is the mean force along the path from q_0 to q, of use only for short paths. A frame or a joint that turns
// by more in one step than this is refused, as is a fold.
constexpr double most_turned = 2.0;  // [rad]

bool WireProblem::update()
{
    if (role == WireRole::Passenger) return true;
    if (!start_usable_ || !update_frames(rod, trial_view(), clamps, frames)) return false;
    if (!time.conserving()) return true;
    for (int j = 0; j < rod.n - 1; ++j) {
        turned_[j] = q.trial[RodDofs::spin(j)] - q.start[RodDofs::spin(j)];
        if (!(std::abs(turned_[j]) < most_turned && std::abs(frames.twist[j] - start_frames_.twist[j]) < most_turned))
            return false;
    }
    return true;
}

// R = M (a + c_m v) - f_dead + c_k K_0 v + dE/dq - f_links - f_moments
void WireProblem::evaluate_residual()
{
    const int count = size();
    const std::span<double> r = q.residual;
    time.accelerations(q, r.data());
    mass_damping_.add_to_accelerations(time, q, r);
    const double *inertia = q.inertia.data(), *dead = dead_loads_.forces();
    for (int i = 0; i < count; ++i) r[i] = inertia[i] * r[i] - dead[i];
    if (damping_stiffness_ > 0) {
        for (int i = 0; i < count; ++i) q.velocities[i] = damping_stiffness_ * time.mean_velocity(q, i);
        damping_.multiply(q.velocities, q.scratch);
        for (int i = 0; i < count; ++i) r[i] += q.scratch[i];
    }
    if (role == WireRole::Passenger) return;  // what acts on it is put on the line, where it is not solve/coaxial_problem.h's
    if (time.conserving()) add_discrete_gradient(rod, clamps, start_frames_, frames, turned_, r, constraints_->base_grown);
    else if (role == WireRole::Alone) add_elastic(rod, clamps, frames, r, nullptr, HessianMode::None);
    links_.add_to_residual(q, r);
    dead_loads_.add_moments_to_residual(frames, r);
}

// dR/dq = share H + geometric stiffness of N_predicted + (rate_a + c_m rate_d) M + links + moments
void WireProblem::assemble_elastic(HessianMode mode, bool symmetric, BandRows& tangent) const
{
    if (role == WireRole::Alone) add_elastic(rod, clamps, frames, {}, &tangent, mode);
    if (time.conserving()) tangent.scale(time.end_share());
    if (role != WireRole::Passenger) tension.change_tangent(stretch(), mode, symmetric, tangent);
    const double rate = time.acceleration_rate() + mass_damping_.diagonal_rate(time);
    for (int i = 0; i < size(); ++i) tangent.add(i, i, rate * q.inertia[i]);
    links_.add_to_tangent(tangent);
    dead_loads_.add_moments_to_tangent(frames, tangent, symmetric);
}

void WireProblem::add_stiffness_damping(BandRows& tangent) const
{
    if (damping_stiffness_ > 0) tangent.add_scaled(damping_, damping_stiffness_ * time.damping_rate());
}

StepLosses WireProblem::losses() const
{
    StepLosses losses;
    const std::span<double> force = std::span(scratch_).first(static_cast<std::size_t>(size()));
    std::fill(force.begin(), force.end(), 0.0);
    if (role == WireRole::Alone) add_elastic(rod, clamps, frames, force, nullptr, HessianMode::None);
    for (int i = 0; i < size(); ++i) losses.strain_work += force[i] * (q.trial[i] - q.start[i]);
    for (int i = 0; i < size(); ++i) {
        const double change = time.velocity(q, i) - time.start_velocity(i);
        losses.inertia += 0.5 * q.inertia[i] * change * change;
    }
    losses.damping = mass_damping_.work(time, q);
    if (damping_stiffness_ == 0) return losses;
    const std::span<double> velocity = std::span(scratch_).subspan(force.size(), force.size());
    for (int i = 0; i < size(); ++i) velocity[i] = damping_stiffness_ * time.mean_velocity(q, i);
    damping_.multiply(velocity, force);
    for (int i = 0; i < size(); ++i) losses.damping += force[i] * (q.trial[i] - q.start[i]);
    return losses;
}

Vec3 WireProblem::load_force() const
{
    Vec3 sum = Vec3::Zero();
    dead_loads_.add_to_sum(sum);
    links_.add_to_sum(q, sum);
    mass_damping_.add_to_sum(time, q, sum);
    return sum;
}

}  // namespace seldinger

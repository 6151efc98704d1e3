// Rates and bases of the time schemes.
#include "solve/time_scheme.h"

#include "core/prefetch.h"

#include <algorithm>

namespace seldinger {

TimeScheme::TimeScheme(int capacity)
{
    for (auto* array : {&start_velocity_, &velocity_base_, &acceleration_base_}) array->resize(RodDofs::count(capacity));
}

void TimeScheme::begin(const RodView& rod, const IntegratorSpec& spec, Motion kind, double step, const Vec3& hub_flow)
{
    motion_ = kind;
    h_ = step;
    conserving_ = spec.conserve && kind == Motion::Implicit;
    euler_ = kind == Motion::Implicit && !conserving_ && !spec.newmark;
    unknowns_ = RodDofs::count(rod.n);
    hub_ = RodDofs::position(rod.n - 1);
    flow_ = hub_flow;
    fed_ = !hub_flow.isZero();
    for (int i = 0; i < rod.n; ++i) {
        const double v[RodDofs::per_node] = {rod.vx[i], rod.vy[i], rod.vz[i], i < rod.n - 1 ? rod.spin_rate[i] : 0.0};
        std::copy_n(v, RodDofs::per_node, &start_velocity_[RodDofs::position(i)]);
    }
    velocity_rate_ = acceleration_rate_ = damping_rate_ = 0;
    if (euler_) {
        damping_rate_ = velocity_rate_ = 1 / h_;
        acceleration_rate_ = 1 / (h_ * h_);
        return;
    }
    std::fill_n(velocity_base_.begin(), unknowns_, 0.0);
    std::fill_n(acceleration_base_.begin(), unknowns_, 0.0);
    if (kind == Motion::Explicit) std::copy_n(start_velocity_.begin(), unknowns_, velocity_base_.begin());
    if (kind != Motion::Implicit) return;
    if (conserving_) set_conserving(unknowns_);
    else set_newmark(rod);
}

// v+ = 2 (q - q_0)/h - v_0, a+ = (v+ - v_0)/h
void TimeScheme::set_conserving(int unknowns)
{
    damping_rate_ = 1 / h_;
    velocity_rate_ = 2 / h_;
    acceleration_rate_ = 2 / (h_ * h_);
    for (int i = 0; i < unknowns; ++i) {
        velocity_base_[i] = -start_velocity_[i];
        acceleration_base_[i] = -2 * start_velocity_[i] / h_;
    }
}

// D4 solved for a+ and v+
void TimeScheme::set_newmark(const RodView& rod)
{
    constexpr double beta = 0.25, gamma = 0.5;
    const double h = h_;
    acceleration_rate_ = 1 / (beta * h * h);
    velocity_rate_ = gamma * h * acceleration_rate_;
    damping_rate_ = velocity_rate_;
    for (int i = 0; i < rod.n; ++i) {
        const double a[RodDofs::per_node] = {rod.ax[i], rod.ay[i], rod.az[i], i < rod.n - 1 ? rod.spin_acc[i] : 0.0};
        for (int c = 0; c < RodDofs::per_node; ++c) {
            const int k = RodDofs::position(i, c);
            const double v = start_velocity_[k];
            const double base = -(h * v + h * h * (0.5 - beta) * a[c]) * acceleration_rate_;
            acceleration_base_[k] = base;
            velocity_base_[k] = v + h * ((1 - gamma) * a[c] + gamma * base);
        }
    }
}

double TimeScheme::velocity(const WireUnknowns& q, int i) const
{
    if (motion_ == Motion::Implicit && q.prescribed[i]) return (q.trial[i] - q.start[i]) / h_ + flow(i);
    return velocity_rate_ * (q.trial[i] - q.start[i]) + (euler_ ? 0.0 : velocity_base_[i]);
}

double TimeScheme::acceleration(const WireUnknowns& q, int i) const
{
    if (motion_ == Motion::Implicit && q.prescribed[i]) return (velocity(q, i) - start_velocity_[i]) / h_;
    return acceleration_rate_ * (q.trial[i] - q.start[i]) + (euler_ ? -start_velocity_[i] / h_ : acceleration_base_[i]);
}

double TimeScheme::mean_velocity(const WireUnknowns& q, int i) const
{
    return conserving_ ? (q.trial[i] - q.start[i]) / h_ : velocity(q, i);
}

double TimeScheme::explicit_velocity(const WireUnknowns& q, int i) const
{
    return (q.trial[i] - q.start[i]) / h_ + flow(i);
}

// There are few prescribed unknowns: they are set right afterwards.
void TimeScheme::velocities(const WireUnknowns& at, double* out) const
{
    const double *q = at.trial.data(), *q0 = at.start.data(), *base = velocity_base_.data(), rate = velocity_rate_;
    if (euler_)
        for (int i = 0; i < unknowns_; ++i) out[i] = rate * (q[i] - q0[i]) + 0.0;
    else
        for (int i = 0; i < unknowns_; ++i) out[i] = rate * (q[i] - q0[i]) + base[i];
    for (int i = 0; i < unknowns_; ++i)
        if (at.prescribed[i]) out[i] = velocity(at, i);
}

void TimeScheme::accelerations(const WireUnknowns& at, double* out) const
{
    const double *q = at.trial.data(), *q0 = at.start.data(), *v0 = start_velocity_.data(), *base = acceleration_base_.data();
    const double rate = acceleration_rate_, step = h_;
    if (euler_)
        for (int i = 0; i < unknowns_; ++i) out[i] = rate * (q[i] - q0[i]) + -v0[i] / step;
    else
        for (int i = 0; i < unknowns_; ++i) out[i] = rate * (q[i] - q0[i]) + base[i];
    for (int i = 0; i < unknowns_; ++i)
        if (at.prescribed[i]) out[i] = acceleration(at, i);
}

void TimeScheme::prefetch(int unknowns, SolveStage next) const
{
    if (next != SolveStage::Commit || !euler_) seldinger::prefetch(start_velocity_, unknowns);
    if (euler_) return;
    seldinger::prefetch(velocity_base_, unknowns);
    seldinger::prefetch(acceleration_base_, unknowns);
}

}  // namespace seldinger

// Weight, dead loads, links and damping by mass.
#include "solve/external_loads.h"

#include "core/prefetch.h"

#include <algorithm>

namespace seldinger {

void add_edge_block(BandRows& matrix, int j, const Mat3& k)
{
    constexpr int centre = BandRows::half_bandwidth, next = RodDofs::per_node;
    for (int c = 0; c < RodDofs::coordinates; ++c) {
        double* tip = matrix.row(RodDofs::position(j, c)) + centre - c;  // entries of node j, then of node j + 1
        double* hub = matrix.row(RodDofs::position(j + 1, c)) + centre - c - next;
        for (int d = 0; d < RodDofs::coordinates; ++d) {
            tip[d] += k(c, d);
            hub[next + d] += k(c, d);
            tip[next + d] -= k(c, d);
            hub[d] -= k(c, d);
        }
    }
}

// ---- weight and dead loads --------------------------------------------------------------------------------------------------

DeadLoads::DeadLoads(int capacity) : forces_(RodDofs::count(capacity)) {}

void DeadLoads::begin(const RodView& rod, const WireConstraints& constraints, const Vec3& gravity)
{
    constraints_ = &constraints;
    std::fill_n(forces_.begin(), RodDofs::count(rod.n), 0.0);
    for (int i = 0; i < rod.n; ++i) add_to_node(forces_, i, rod.mass[i] * gravity);
    for (const auto* loads : {&constraints.loads, &constraints.carried})
        for (const auto& load : *loads) {
            add_to_node(forces_, load.edge, (1 - load.bary) * load.force);
            add_to_node(forces_, load.edge + 1, load.bary * load.force);
        }
}

// A moment m turns the edge that it acts on: a couple of forces +-(m x t)/|e| on its ends does the work of m on the edge's
// rotation, and m.t that on its spin.
void DeadLoads::add_moments_to_residual(const RodFrames& frames, std::span<double> r) const
{
    for (const auto& load : constraints_->loads) {
        if (load.moment.isZero()) continue;
        const Vec3& t = frames.tangent[load.edge];
        const Vec3 couple = load.moment.cross(t) / frames.edge_length[load.edge];
        add_to_node(r, load.edge + 1, -couple);
        add_to_node(r, load.edge, couple);
        if (load.member == 0) r[RodDofs::spin(load.edge)] -= load.moment.dot(t);
    }
}

// d(m x t/|e|)/de = [m]x (1 - 2 t t^T)/|e|^2,  d(m.t)/de = (m - (m.t) t)/|e|.
void DeadLoads::add_moments_to_tangent(const RodFrames& frames, BandRows& tangent, bool symmetric) const
{
    for (const auto& load : constraints_->loads) {
        if (load.moment.isZero()) continue;
        const int j = load.edge, spin_unknown = RodDofs::spin(j);
        const double length = frames.edge_length[j];
        const Vec3 &t = frames.tangent[j], &m = load.moment;
        const Mat3 couple = skew(m) * (Mat3::Identity() - outer(2 * t, t)) / (length * length);
        const Vec3 spin = (m - m.dot(t) * t) / length;
        add_edge_block(tangent, j, symmetric ? Mat3(-0.5 * (couple + couple.transpose())) : Mat3(-couple));
        if (load.member != 0) continue;
        for (int c = 0; c < RodDofs::coordinates; ++c)
            for (int end : {0, 1}) {
                const double value = (end == 1 ? -spin[c] : spin[c]) * (symmetric ? 0.5 : 1.0);
                tangent.add(spin_unknown, RodDofs::position(j + end, c), value);
                if (symmetric) tangent.add(RodDofs::position(j + end, c), spin_unknown, value);
            }
    }
}

bool DeadLoads::unsymmetric() const
{
    return std::any_of(constraints_->loads.begin(), constraints_->loads.end(),
                       [](const WireConstraints::PointLoad& load) { return !load.moment.isZero(); });
}

void DeadLoads::add_to_sum(Vec3& sum) const
{
    for (const auto& load : constraints_->loads) sum += load.force;
    for (const auto& load : constraints_->carried) sum += load.force;
}

double DeadLoads::scale(double length) const
{
    double total = 0;
    for (const auto& load : constraints_->loads) total += load.force.norm() + load.moment.norm() / length;
    return total;
}

void DeadLoads::prefetch(int unknowns) const { seldinger::prefetch(forces_, unknowns); }

// ---- links ------------------------------------------------------------------------------------------------------------------

void Links::begin(const WireConstraints& constraints, double end_share)
{
    constraints_ = &constraints;
    end_share_ = end_share;
}

Vec3 Links::pull(const WireConstraints::Spring& spring, const WireUnknowns& q) const
{
    Vec3 at = (1 - spring.bary) * node_of(q.trial, spring.edge) + spring.bary * node_of(q.trial, spring.edge + 1);
    if (end_share_ < 1)
        at = 0.5 * (at + (1 - spring.bary) * node_of(q.start, spring.edge) + spring.bary * node_of(q.start, spring.edge + 1));
    return spring.stiffness * (spring.anchor - at);
}

void Links::add_to_residual(const WireUnknowns& q, std::span<double> r) const
{
    for (const auto& spring : constraints_->springs) {
        const Vec3 force = pull(spring, q);
        add_to_node(r, spring.edge, -(1 - spring.bary) * force);
        add_to_node(r, spring.edge + 1, -spring.bary * force);
    }
}

void Links::add_to_tangent(BandRows& tangent) const
{
    for (const auto& spring : constraints_->springs) {
        const double weight[2] = {1 - spring.bary, spring.bary};
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b)
                for (int c = 0; c < RodDofs::coordinates; ++c)
                    tangent.add(RodDofs::position(spring.edge + a, c), RodDofs::position(spring.edge + b, c),
                                end_share_ * spring.stiffness * weight[a] * weight[b]);
    }
}

void Links::add_to_sum(const WireUnknowns& q, Vec3& sum) const
{
    for (const auto& spring : constraints_->springs) sum += pull(spring, q);
}

double Links::scale(const RodView& rod) const
{
    double total = 0;
    for (const auto& spring : constraints_->springs) {
        const Vec3 at = (1 - spring.bary) * rod.pos(spring.edge) + spring.bary * rod.pos(spring.edge + 1);
        total += spring.stiffness * (at - spring.anchor).norm();
    }
    return total;
}

// ---- damping by mass --------------------------------------------------------------------------------------------------------

void MassDamping::add_to_accelerations(const TimeScheme& time, const WireUnknowns& q, std::span<double> a) const
{
    if (rate_ == 0) return;
    for (int i = 0; i < static_cast<int>(a.size()); ++i) a[i] += rate_ * time.mean_velocity(q, i);
}

void MassDamping::add_to_sum(const TimeScheme& time, const WireUnknowns& q, Vec3& sum) const
{
    if (rate_ == 0) return;
    for (int i = 0; i < static_cast<int>(q.trial.size()); ++i)
        if (!RodDofs::is_spin(i)) sum[RodDofs::place(i)] -= rate_ * q.inertia[i] * time.mean_velocity(q, i);
}

double MassDamping::work(const TimeScheme& time, const WireUnknowns& q) const
{
    double work = 0;
    for (int i = 0; i < static_cast<int>(q.trial.size()) && rate_ != 0; ++i)
        work += rate_ * q.inertia[i] * time.mean_velocity(q, i) * (q.trial[i] - q.start[i]);
    return work;
}

}  // namespace seldinger

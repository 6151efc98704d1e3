// Elastic forces and tangent of instruments that share a centreline, and the motion of their passengers along it.
#include "solve/coaxial_problem.h"

#include <algorithm>

namespace seldinger {

CoaxialProblem::CoaxialProblem(CoaxialGroup& group, std::vector<WireProblem*> wires)
    : group_(group),
      wires_(std::move(wires)),
      hessian_(line().frames.capacity, group.count()),
      gradient_(static_cast<std::size_t>(CoaxialDofs{group.count()}.count(line().frames.capacity))),
      trial_(gradient_.size())
{
    for (WireProblem* wire : wires_) wire->role = wire == &line() ? WireRole::Line : WireRole::Passenger;
}

void CoaxialProblem::begin()
{
    const int n = line().rod.n, clamped = RodDofs::unused(n);
    for (int k = 0; k < group_.count(); ++k) {
        WireUnknowns& q = wires_[k]->q;
        q.start[clamped] = q.trial[clamped] = wires_[k]->rod.theta[n - 1];
        const bool free = group_.base.behind[k] > 0;
        q.prescribed[clamped] = !free;
        q.prescribed_value[clamped] = free ? 0.0 : group_.clamp[k];
        q.inertia[clamped] = 0;
        for (int j = 0; j < n; ++j) {
            if (!coaxial_idle(group_.rod, j, k)) continue;
            q.prescribed[RodDofs::spin(j)] = 1;
            q.prescribed_value[RodDofs::spin(j)] = q.start[RodDofs::spin(j)];
        }
        if (k > 0) wires_[k]->follow(line());
    }
    mirror();
}

void CoaxialProblem::mirror()
{
    const WireUnknowns& from = line().q;
    for (int k = 1; k < group_.count(); ++k) {
        WireUnknowns& to = wires_[k]->q;
        for (int i = 0; i < line().rod.n; ++i)
            for (int c = 0; c < RodDofs::coordinates; ++c) {
                const int at = RodDofs::position(i, c);
                to.trial[at] = to.prescribed_value[at] = from.trial[at];
            }
    }
}

CoaxialTrial CoaxialProblem::trial() const
{
    const std::size_t n = static_cast<std::size_t>(line().rod.n);
    CoaxialTrial result;
    std::span<double> left(trial_);
    const auto split = [&](const WireProblem& wire, int place) {
        const std::span<double> part = left.first(n);
        left = left.subspan(n);
        for (std::size_t i = 0; i < n; ++i) part[i] = wire.q.trial[RodDofs::per_node * i + static_cast<std::size_t>(place)];
        return part;
    };
    result.x = split(line(), 0);
    result.y = split(line(), 1);
    result.z = split(line(), 2);
    for (int k = 0; k < group_.count(); ++k) result.theta[k] = split(*wires_[k], RodDofs::spin_place);
    return result;
}

/// The gradient at the trial.
void CoaxialProblem::evaluate()
{
    const std::size_t size = static_cast<std::size_t>(group_.rod.dofs().count(line().rod.n));
    std::fill_n(gradient_.begin(), size, 0.0);
    add_coaxial(shape(trial()), std::span(gradient_).first(size), nullptr, HessianMode::None);
}

void CoaxialProblem::add_residual()
{
    evaluate();
    const CoaxialDofs dofs = group_.rod.dofs();
    for (int i = 0; i < line().rod.n; ++i) {
        for (int c = 0; c < RodDofs::coordinates; ++c)
            line().q.residual[RodDofs::position(i, c)] += gradient_[dofs.position(i, c)];
        for (int k = 0; k < group_.count(); ++k) wires_[k]->q.residual[RodDofs::spin(i)] += gradient_[dofs.spin(i, k)];
    }
    for (const auto& load : line().constraints().loads)
        if (load.member != 0)
            wires_[load.member]->q.residual[RodDofs::spin(load.edge)] -= load.moment.dot(line().frames.tangent[load.edge]);
}

/// d(m.t)/de of dead moments on passengers, as DeadLoads has it of the line's own.
void CoaxialProblem::add_moments(bool symmetric, const double* all, FarEntries& far) const
{
    for (const auto& load : line().constraints().loads) {
        if (load.member == 0 || load.moment.isZero()) continue;
        const Vec3 t = line().frames.tangent[load.edge];
        const Vec3 spin = (load.moment - load.moment.dot(t) * t) / line().frames.edge_length[load.edge];
        const int row = static_cast<int>(wires_[load.member]->q.start.data() - all) + RodDofs::spin(load.edge);
        const int first = static_cast<int>(line().q.start.data() - all);
        for (int c = 0; c < RodDofs::coordinates; ++c)
            for (const int end : {0, 1}) {
                const double value = (end == 1 ? -spin[c] : spin[c]) * (symmetric ? 0.5 : 1.0);
                const int col = first + RodDofs::position(load.edge + end, c);
                far.add(row, col, value);
                if (symmetric) far.add(col, row, value);
            }
    }
}

void CoaxialProblem::fold_residual()
{
    const std::span<double> to = line().q.residual;
    for (int k = 1; k < group_.count(); ++k) {
        const std::span<double> from = wires_[k]->q.residual;
        for (int i = 0; i < line().rod.n; ++i)
            for (int c = 0; c < RodDofs::coordinates; ++c) {
                const int at = RodDofs::position(i, c);
                to[at] += from[at];
                from[at] = 0;
            }
    }
}

void CoaxialProblem::fold_rounding() const
{
    for (std::size_t k = 1; k < wires_.size(); ++k) {
        line().rounding += wires_[k]->rounding;
        line().rounding_most += wires_[k]->rounding_most;
    }
}

void CoaxialProblem::add_tangent(HessianMode mode, bool symmetric, const double* all, BandMatrix& band, FarEntries& far)
{
    const int n = line().rod.n, width = group_.rod.dofs().per_node();
    hessian_.reset(n);
    add_coaxial(shape(trial()), {}, &hessian_, mode);
    // unknown of the system that place p of a node is
    const auto unknown = [&](int node, int p) {
        const WireProblem& wire = *wires_[std::max(0, p - RodDofs::coordinates)];
        const int own = p < RodDofs::coordinates ? RodDofs::position(node, p) : RodDofs::spin(node);
        return static_cast<int>(wire.q.start.data() - all) + own;
    };
    const auto add = [&](int p, int q, int i, int j, double value) {
        const bool same_wire = std::max(0, p - RodDofs::coordinates) == std::max(0, q - RodDofs::coordinates);
        if (same_wire) band.add(i, j, value);
        else far.add(i, j, value);
    };
    for (int node = 0; node < n; ++node)
        for (int ahead = 0; ahead <= CoaxialDofs::reach && node + ahead < n; ++ahead) {
            const double* block = hessian_.block(node, ahead);
            for (int p = 0; p < width; ++p)
                for (int q = 0; q < width; ++q) {
                    // (a diagonal block has both halves; in its other ones entries are few)
                    const double value = block[p * width + q];
                    if (value == 0) continue;
                    const int i = unknown(node, p), j = unknown(node + ahead, q);
                    add(p, q, i, j, value);
                    if (ahead > 0) add(q, p, j, i, value);
                }
        }
    add_moments(symmetric, all, far);
}

void CoaxialProblem::fold_tangent(const BandMatrix& of_terms, const double* all, BandMatrix& band, FarEntries& far) const
{
    const int to_line = static_cast<int>(line().q.start.data() - all);
    for (int k = 1; k < group_.count(); ++k) {
        const int first = static_cast<int>(wires_[k]->q.start.data() - all), count = wires_[k]->size();
        const auto of_system = [&](int i) { return RodDofs::is_spin(i) ? first + i : to_line + i; };
        for (int i = 0; i < count; ++i)
            for (int j = std::max(0, i - BandRows::half_bandwidth); j <= std::min(count - 1, i + BandRows::half_bandwidth); ++j) {
                const double value = of_terms.at(first + i, first + j);
                if (value == 0) continue;
                if (RodDofs::is_spin(i) == RodDofs::is_spin(j)) band.add(of_system(i), of_system(j), value);
                else far.add(of_system(i), of_system(j), value);
            }
    }
}

void CoaxialProblem::fold_condensed(const double* all, Condensed& condensed) const
{
    const int to_line = static_cast<int>(line().q.start.data() - all);
    for (SparseRows* rows : {&condensed.e_transposed, &condensed.f})
        for (SparseRows::Entry& entry : rows->entries())
            for (int k = 1; k < group_.count(); ++k) {
                const int own = entry.unknown - static_cast<int>(wires_[k]->q.start.data() - all);
                if (own < 0 || own >= wires_[k]->size() || RodDofs::is_spin(own)) continue;
                entry.unknown = to_line + own;
                break;
            }
}

void CoaxialProblem::commit()
{
    const RodView from = line().rod;
    for (int k = 1; k < group_.count(); ++k) wires_[k]->take_from(from);
    // angles that nothing depends on keep level with the rest
    for (int k = 0; k < group_.count(); ++k) std::ranges::copy(wires_[k]->rod.theta, group_.rod.theta[k].begin());
    follow_idle(group_.rod, from);
    for (int k = 0; k < group_.count(); ++k) std::copy_n(group_.rod.theta[k].begin(), from.n, wires_[k]->rod.theta.begin());
}

double CoaxialProblem::energy() const { return coaxial_energy(shape(trial())); }

double CoaxialProblem::strain_work()
{
    evaluate();
    const CoaxialDofs dofs = group_.rod.dofs();
    double work = 0;
    for (int i = 0; i < line().rod.n; ++i) {
        for (int c = 0; c < RodDofs::coordinates; ++c) {
            const int at = RodDofs::position(i, c);
            work += gradient_[dofs.position(i, c)] * (line().q.trial[at] - line().q.start[at]);
        }
        for (int k = 0; k < group_.count(); ++k) {
            const int at = RodDofs::spin(i);
            if (i == line().rod.n - 1 && wires_[k]->q.prescribed[at]) continue;  // the hand's at the clamp: turning
            work += gradient_[dofs.spin(i, k)] * (wires_[k]->q.trial[at] - wires_[k]->q.start[at]);
        }
    }
    return work;
}

CoaxialHands CoaxialProblem::hands() const { return coaxial_hands(shape(trial())); }

}  // namespace seldinger

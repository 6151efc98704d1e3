// Matrices of one elastic wall, their factors by step length, and columns of the inverses.
#include "shell/wall_compliance.h"

#include "core/check.h"
#include "core/clock.h"
#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace seldinger {
namespace {

// A step, its nine halves, and equilibrium: a step in a narrow place goes up and down all of them. Fewer where they are large.
constexpr std::size_t factors_kept = 12, factors_least = 4;
constexpr std::size_t factor_bytes_kept = std::size_t{1} << 30;

/// A on each axis.
SparseMatrix on_three_axes(const SparseMatrix& a)
{
    SparseMatrix m(3 * a.rows(), 3 * a.cols());
    m.reserve(3 * a.nonZeros());
    for (Eigen::Index c = 0; c < a.cols(); ++c)
        for (int axis = 0; axis < 3; ++axis) {
            m.startVec(3 * c + axis);
            for (SparseMatrix::InnerIterator it(a, c); it; ++it) m.insertBack(3 * it.row() + axis, 3 * c + axis) = it.value();
        }
    m.finalize();
    return m;
}

/// Distance along edges from the vertices of the farthest rim, or from a farthest vertex of a closed wall [m].
std::vector<double> distance_from_end(const LoopSurface& surface)
{
    const LoopTopology& mesh = surface.topology();
    const auto n = static_cast<std::size_t>(mesh.vertex_count());
    std::array<std::int32_t, LoopTopology::max_valence + 1> around;
    const auto from = [&](const std::vector<std::int32_t>& starts) {
        std::vector<double> distance(n, std::numeric_limits<double>::infinity());
        std::priority_queue<std::pair<double, std::int32_t>, std::vector<std::pair<double, std::int32_t>>, std::greater<>> open;
        for (const std::int32_t v : starts) distance[static_cast<std::size_t>(v)] = 0, open.push({0, v});
        while (!open.empty()) {
            const auto [d, v] = open.top();
            open.pop();
            if (d > distance[static_cast<std::size_t>(v)]) continue;
            const int count = mesh.fan(v, -1, around);
            for (int k = 0; k < count; ++k) {
                const auto w = static_cast<std::size_t>(around[static_cast<std::size_t>(k)]);
                const double to =
                    d + (surface.control().vertices[w] - surface.control().vertices[static_cast<std::size_t>(v)]).norm();
                if (to < distance[w]) distance[w] = to, open.push({to, static_cast<std::int32_t>(w)});
            }
        }
        return distance;
    };
    const auto farthest = [](const std::vector<double>& distance) {
        std::size_t best = 0;
        for (std::size_t v = 0; v < distance.size(); ++v)
            if (std::isfinite(distance[v]) && distance[v] > distance[best]) best = v;
        return static_cast<std::int32_t>(best);
    };
    std::vector<std::int32_t> start = {farthest(from({0}))};
    if (const std::int32_t first = start.front(); mesh.kind[static_cast<std::size_t>(first)] != LoopVertex::Inner)
        for (std::int32_t v = mesh.to(mesh.first[static_cast<std::size_t>(first)]); v != first;
             v = mesh.to(mesh.first[static_cast<std::size_t>(v)]))
            start.push_back(v);
    std::vector<double> distance = from(start);
    for (double& d : distance)
        if (!std::isfinite(d)) d = 0;  // another piece
    return distance;
}

void drop_held(SparseMatrix& m, const std::vector<unsigned char>& held)
{
    m.prune([&](Eigen::Index row, Eigen::Index column, double) {
        return !held[static_cast<std::size_t>(row / 3)] && !held[static_cast<std::size_t>(column / 3)];
    });
}

}  // namespace

WallCompliance::WallCompliance(const Shell& shell, const PrestressAt& prestress) : matrices_(shell.assemble(prestress))
{
    const ShellSpec& spec = shell.spec();
    along_ = distance_from_end(shell.surface());
    const SparseMatrix area = on_three_axes(matrices_.area);
    stiffness_ = matrices_.elastic + matrices_.pressure + spec.support * area;
    damping_ = spec.relaxation * matrices_.elastic + spec.support_damping * area;
    drop_held(stiffness_, matrices_.held);
    drop_held(damping_, matrices_.held);
}

std::shared_ptr<const WallFactor> WallCompliance::factor(double h) const
{
    SEL_ASSERT(h >= 0);
    const std::lock_guard lock(guard_);
    for (std::size_t k = 0; k < kept_.size(); ++k)
        if (kept_[k]->step() == h) {
            std::rotate(kept_.begin() + static_cast<std::ptrdiff_t>(k), kept_.begin() + static_cast<std::ptrdiff_t>(k) + 1,
                        kept_.end());
            return kept_.back();
        }
    const double length = h > 0 ? h : std::numeric_limits<double>::max();  // [s]
    if (length >= no_step_) return nullptr;
    const auto start = Clock::now();
    auto made = std::make_shared<WallFactor>();
    made->h_ = h;
    const bool sound = h > 0 ? made->cholesky_.factor(stiffness_ + damping_ / h, matrices_.held, along_)
                             : made->cholesky_.factor(stiffness_, matrices_.held, along_);
    if (!sound) {
        no_step_ = length;
        return nullptr;
    }
    made->vertex_count_ = vertex_count();
    made->columns_.resize(static_cast<std::size_t>(vertex_count()));
    made->seconds_ = seconds_since(start);
    kept_.push_back(std::move(made));
    const auto bytes = [&] {
        std::size_t sum = 0;
        for (const auto& factor : kept_) sum += factor->bytes();
        return sum;
    };
    while (kept_.size() > factors_kept || (kept_.size() > factors_least && bytes() > factor_bytes_kept))
        kept_.erase(kept_.begin());
    return kept_.back();
}

void WallFactor::solve(std::span<double> rhs, WallSolveWork& work) const { cholesky_.solve(rhs, work.x); }

void WallFactor::solve(std::span<double> rhs_a, std::span<double> rhs_b, WallSolveWork& work) const
{
    cholesky_.solve(rhs_a, rhs_b, work.x);
}

std::size_t WallFactor::bytes() const
{
    return cholesky_.bytes() + sizeof(float) * static_cast<std::size_t>(3 * solved_columns() * vertex_count_);
}

long WallFactor::solved_columns() const
{
    const std::lock_guard lock(guard_);
    return 3 * static_cast<long>(std::count_if(columns_.begin(), columns_.end(), [](const auto& c) { return c != nullptr; }));
}

std::span<const float> WallFactor::columns(std::int32_t vertex) const
{
    const std::size_t n = static_cast<std::size_t>(3 * vertex_count_);
    SEL_ASSERT(vertex >= 0 && vertex < vertex_count_);
    const std::lock_guard lock(guard_);
    auto& kept = columns_[static_cast<std::size_t>(vertex)];
    if (!kept) {
        solved_.assign(3 * n, 0.0);
        const std::span<double> all(solved_);
        for (std::size_t axis = 0; axis < 3; ++axis) all[axis * n + static_cast<std::size_t>(3 * vertex) + axis] = 1;
        cholesky_.solve(all.first(n), all.subspan(n, n), all.last(n), work_);
        kept = std::make_unique_for_overwrite<float[]>(3 * n);
        std::copy(solved_.begin(), solved_.end(), kept.get());
    }
    return {kept.get(), 3 * n};
}

WallCounts WallCompliance::counts() const
{
    const std::lock_guard lock(guard_);
    WallCounts all;
    for (const auto& factor : kept_) {
        all.factor_seconds += factor->factor_seconds();
        all.columns += factor->solved_columns();
        all.bytes += factor->bytes();
    }
    return all;
}

}  // namespace seldinger

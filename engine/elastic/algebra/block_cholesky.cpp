// Multifrontal factor by panels [Duff & Reid 1983, doi:10.1145/356044.356047], and solves that stream through it.
#include "algebra/block_cholesky.h"

#include "core/check.h"
#include "math/dissection.h"
#include "algebra/elimination.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstring>
#include <numeric>

namespace seldinger {
namespace {

// Eigen sums products in blocks that fit the caches it finds, so that sums would round otherwise on another processor. These
// sizes are taken for all (level 1, 2 and 3).
[[maybe_unused]] const bool blocks_are_fixed = (Eigen::setCpuCacheSizes(32 << 10, 512 << 10, 32 << 20), true);

Graph block_graph(const Eigen::SparseMatrix<double>& matrix, const std::vector<std::int32_t>& free_index, std::int32_t free_count)
{
    std::vector<std::vector<std::int32_t>> near(static_cast<std::size_t>(free_count));
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
        const std::int32_t v = free_index[static_cast<std::size_t>(c / 3)];
        if (v < 0) continue;
        for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, c); it; ++it) {
            const std::int32_t w = free_index[static_cast<std::size_t>(it.row() / 3)];
            auto& list = near[static_cast<std::size_t>(v)];
            if (w >= 0 && w != v && (list.empty() || list.back() != w)) list.push_back(w);
        }
    }
    Graph graph{{0}, {}};
    for (auto& list : near) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
        graph.adjacent.insert(graph.adjacent.end(), list.begin(), list.end());
        graph.first.push_back(static_cast<std::int32_t>(graph.adjacent.size()));
    }
    return graph;
}

}  // namespace

std::vector<std::int32_t> BlockCholesky::take(Eigen::Index unknowns, std::span<const unsigned char> skip)
{
    SEL_ASSERT(unknowns % 3 == 0);
    blocks_ = static_cast<std::int32_t>(unknowns / 3);
    SEL_ASSERT(skip.empty() || skip.size() == static_cast<std::size_t>(blocks_));
    std::vector<std::int32_t> free_index(static_cast<std::size_t>(blocks_), -1);
    order_.clear(), skipped_.clear();
    for (std::int32_t b = 0; b < blocks_; ++b) {
        if (!skip.empty() && skip[static_cast<std::size_t>(b)]) {
            skipped_.push_back(b);
            continue;
        }
        free_index[static_cast<std::size_t>(b)] = static_cast<std::int32_t>(order_.size());
        order_.push_back(b);
    }
    return free_index;
}

bool BlockCholesky::factor(const Eigen::SparseMatrix<double>& matrix, std::span<const unsigned char> skip,
                           std::span<const double> along, std::size_t from)
{
    SEL_ASSERT(matrix.rows() == matrix.cols());
    const std::vector<std::int32_t> free_index = take(matrix.rows(), skip);
    const std::vector<std::int32_t> free_block = order_;
    const Graph graph = block_graph(matrix, free_index, static_cast<std::int32_t>(free_block.size()));

    std::vector<std::vector<std::int32_t>> orders = {nested_dissection(graph), minimum_degree(graph)};
    if (!along.empty()) {
        orders.emplace_back(free_block.size());
        std::iota(orders.back().begin(), orders.back().end(), 0);
        const auto at = [&](std::int32_t k) { return along[static_cast<std::size_t>(free_block[static_cast<std::size_t>(k)])]; };
        std::stable_sort(orders.back().begin(), orders.back().end(),
                         [&](std::int32_t a, std::int32_t b) { return at(a) > at(b); });
    }
    Elimination best;
    for (const std::vector<std::int32_t>& order : orders) {
        Elimination tried = eliminate(graph, order);
        if (best.order.empty() || tried.entries < best.entries) best = std::move(tried);
    }
    std::vector<std::int32_t> place(static_cast<std::size_t>(blocks_), -1);
    for (std::size_t k = 0; k < order_.size(); ++k) {
        order_[k] = free_block[static_cast<std::size_t>(best.order[k])];
        place[static_cast<std::size_t>(order_[k])] = static_cast<std::int32_t>(k);
    }
    if (!factor_panels(matrix, best, place)) return false;
    if (values_.size() >= from) round_if_accurate();
    place_ = std::move(place);
    panel_of_.resize(order_.size());
    for (std::size_t p = 0; p < panels_.size(); ++p)
        std::fill_n(panel_of_.begin() + panels_[p].first, panels_[p].columns, static_cast<std::int32_t>(p));
    return true;
}

/// As solves read it: three columns at a time, eight rows of each beside each other, one stream from end to end.
void BlockCholesky::keep(const Eigen::MatrixXd& front, std::int32_t first, std::int32_t columns,
                         std::span<const std::int32_t> below)
{
    const auto rows = static_cast<std::int32_t>(below.size());
    const std::int32_t stride = (3 * (columns + rows) + 7) / 8 * 8;
    panels_.push_back(
        {first, columns, static_cast<std::int32_t>(rows_.size()), rows, stride, static_cast<std::int64_t>(values_.size())});
    widest_ = std::max(widest_, stride);
    rows_.insert(rows_.end(), below.begin(), below.end());
    for (Eigen::Index k = 0; k < columns; ++k) {
        const Eigen::Matrix3d own = front.block(3 * k, 3 * k, 3, 3);
        Eigen::Map<Eigen::Matrix3d> inverse(inverse_.data() + 9 * (first + k));
        inverse = own.triangularView<Eigen::Lower>().solve(Eigen::Matrix3d::Identity());
        for (Eigen::Index i = 3 * k / 8 * 8; i < stride; i += 8)
            for (Eigen::Index j = 3 * k; j < 3 * k + 3; ++j)
                for (Eigen::Index r = i; r < i + 8; ++r)
                    values_.push_back(r < 3 * k + 3 || r >= 3 * (columns + rows) ? 0.0 : front(r, j));
    }
}

bool BlockCholesky::factor_panels(const Eigen::SparseMatrix<double>& matrix, const Elimination& symbolic,
                                  std::span<const std::int32_t> place)
{
    using Dense = Eigen::MatrixXd;
    const std::size_t count = symbolic.rows.size();
    panels_.clear(), rows_.clear(), values_.clear(), singles_.clear();
    inverse_.assign(9 * order_.size(), 0);
    widest_ = 0;
    std::vector<Dense> update(count);
    std::vector<std::vector<std::int32_t>> children(count);
    for (std::size_t p = 0; p < count; ++p)
        if (symbolic.parent[p] >= 0)
            children[static_cast<std::size_t>(symbolic.parent[p])].push_back(static_cast<std::int32_t>(p));
    std::vector<std::int32_t> local(order_.size(), -1);
    for (std::size_t p = 0; p < count; ++p) {
        const std::int32_t first = symbolic.first[p], columns = symbolic.first[p + 1] - first;
        const auto& below = symbolic.rows[p];
        const auto rows = static_cast<std::int32_t>(below.size());
        for (std::int32_t k = 0; k < columns; ++k) local[static_cast<std::size_t>(first + k)] = k;
        for (std::int32_t k = 0; k < rows; ++k) local[static_cast<std::size_t>(below[static_cast<std::size_t>(k)])] = columns + k;
        Dense front = Dense::Zero(3 * (columns + rows), 3 * (columns + rows));  // its lower half counts
        for (std::int32_t k = 0; k < columns; ++k)
            for (int j = 0; j < 3; ++j)
                for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, 3 * order_[static_cast<std::size_t>(first + k)] + j);
                     it; ++it) {
                    const std::int32_t row = place[static_cast<std::size_t>(it.row() / 3)];
                    if (row >= first + k) front(3 * local[static_cast<std::size_t>(row)] + it.row() % 3, 3 * k + j) = it.value();
                }
        const Eigen::VectorXd diagonal = front.diagonal().head(3 * columns);
        for (const std::int32_t child : children[p]) {
            const auto& from = symbolic.rows[static_cast<std::size_t>(child)];
            const Dense& add = update[static_cast<std::size_t>(child)];
            for (std::size_t j = 0; j < from.size(); ++j)
                for (std::size_t i = j; i < from.size(); ++i)
                    front.block<3, 3>(3 * local[static_cast<std::size_t>(from[i])],
                                      3 * local[static_cast<std::size_t>(from[j])]) +=
                        add.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j));
            update[static_cast<std::size_t>(child)].resize(0, 0);
        }
        auto square = front.topLeftCorner(3 * columns, 3 * columns);
        auto strip = front.bottomLeftCorner(3 * rows, 3 * columns);
        Eigen::LLT<Eigen::Ref<Dense>> llt(square);
        if (llt.info() != Eigen::Success) return false;
        for (Eigen::Index k = 0; k < 3 * columns; ++k)
            if (!(square(k, k) * square(k, k) > 1e-11 * diagonal[k])) return false;
        if (rows > 0) {
            square.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(strip);
            update[p] = front.bottomRightCorner(3 * rows, 3 * rows);
            update[p].selfadjointView<Eigen::Lower>().rankUpdate(strip, -1);
        }
        keep(front, first, columns, below);
    }
    return true;
}

namespace {

/// Eight numbers in two fours (wider vectors are taken apart badly where the processor has none): whatever its own width, sums
/// run in the same order.
typedef double Four __attribute__((vector_size(32)));
struct Eight {
    Four low, high;
};

inline Eight load(const double* p)
{
    Eight v;
    std::memcpy(&v.low, p, sizeof v.low), std::memcpy(&v.high, p + 4, sizeof v.high);
    return v;
}
inline Eight load(const float* p)
{
    typedef float FourSingle __attribute__((vector_size(16)));
    FourSingle low, high;
    std::memcpy(&low, p, sizeof low), std::memcpy(&high, p + 4, sizeof high);
    return {__builtin_convertvector(low, Four), __builtin_convertvector(high, Four)};
}
inline void store(double* p, const Eight& v) { std::memcpy(p, &v.low, sizeof v.low), std::memcpy(p + 4, &v.high, sizeof v.high); }
inline double sum(const Eight& v)
{
    const Four s = v.low + v.high;
    return (s[0] + s[2]) + (s[1] + s[3]);
}

}  // namespace

/// y = L^-1 y for a panel's unknowns; contributions to the rows below are subtracted there.
template <int sides, class Value>
void BlockCholesky::down(const Panel& panel, const Value* values, double* const* y, double* const* t) const
{
    const int stride = panel.stride, own = 3 * panel.columns;
    bool any = false;  // a force on a few blocks reaches their ancestors alone
    for (int s = 0; s < sides; ++s)
        any = any || std::any_of(y[s] + 3 * panel.first, y[s] + 3 * panel.first + own, [](double value) { return value != 0; });
    if (!any) return;
    for (int s = 0; s < sides; ++s) {
        std::memcpy(t[s], y[s] + 3 * panel.first, static_cast<std::size_t>(own) * sizeof(double));
        std::memset(t[s] + own, 0, static_cast<std::size_t>(stride - own) * sizeof(double));
    }
    const Value* value = values + panel.first_value;
    const double* d = inverse_.data() + 9 * panel.first;
    for (int k = 0; k < own; k += 3, d += 9) {
        double a[sides], b[sides], c[sides];
        for (int s = 0; s < sides; ++s) {
            double* z = t[s] + k;
            a[s] = d[0] * z[0], b[s] = d[1] * z[0] + d[4] * z[1], c[s] = d[2] * z[0] + d[5] * z[1] + d[8] * z[2];
            z[0] = a[s], z[1] = b[s], z[2] = c[s];
        }
        for (int i = k / 8 * 8; i < stride; i += 8, value += 24) {
            const Eight p = load(value), q = load(value + 8), r = load(value + 16);
            for (int s = 0; s < sides; ++s) {
                Eight z = load(t[s] + i);
                z.low -= p.low * a[s] + q.low * b[s] + r.low * c[s];
                z.high -= p.high * a[s] + q.high * b[s] + r.high * c[s];
                store(t[s] + i, z);
            }
        }
    }
    const std::int32_t* row = rows_.data() + panel.first_row;
    for (int s = 0; s < sides; ++s) {
        std::memcpy(y[s] + 3 * panel.first, t[s], static_cast<std::size_t>(own) * sizeof(double));
        const double* z = t[s] + own;
        for (std::int32_t k = 0; k < panel.rows; ++k, z += 3) {
            double* to = y[s] + 3 * row[k];
            to[0] += z[0], to[1] += z[1], to[2] += z[2];
        }
    }
}

/// y = L^-T y for a panel's unknowns, those of the rows below being known. @param end  of the panel's values
template <int sides, class Value>
void BlockCholesky::up(const Panel& panel, const Value* end, double* const* y, double* const* t) const
{
    const int stride = panel.stride, own = 3 * panel.columns;
    const std::int32_t* row = rows_.data() + panel.first_row;
    for (int s = 0; s < sides; ++s) {
        std::memcpy(t[s], y[s] + 3 * panel.first, static_cast<std::size_t>(own) * sizeof(double));
        double* z = t[s] + own;
        for (std::int32_t k = 0; k < panel.rows; ++k, z += 3) std::memcpy(z, y[s] + 3 * row[k], 3 * sizeof(double));
        std::memset(z, 0, static_cast<std::size_t>(stride - own - 3 * panel.rows) * sizeof(double));
    }
    const Value* value = end;
    const double* d = inverse_.data() + 9 * (panel.first + panel.columns - 1);
    for (int k = own - 3; k >= 0; k -= 3, d -= 9) {
        Eight u[sides][3] = {};
        value -= 3 * (stride - k / 8 * 8);
        const Value* group = value;
        for (int i = k / 8 * 8; i < stride; i += 8, group += 24) {
            const Eight p = load(group), q = load(group + 8), r = load(group + 16);
            for (int s = 0; s < sides; ++s) {
                const Eight z = load(t[s] + i);
                u[s][0].low += p.low * z.low, u[s][1].low += q.low * z.low, u[s][2].low += r.low * z.low;
                u[s][0].high += p.high * z.high, u[s][1].high += q.high * z.high, u[s][2].high += r.high * z.high;
            }
        }
        for (int s = 0; s < sides; ++s) {
            double* z = t[s] + k;
            const double a = z[0] - sum(u[s][0]), b = z[1] - sum(u[s][1]), c = z[2] - sum(u[s][2]);
            z[0] = d[0] * a + d[1] * b + d[2] * c, z[1] = d[4] * b + d[5] * c, z[2] = d[8] * c;
        }
    }
    for (int s = 0; s < sides; ++s) std::memcpy(y[s] + 3 * panel.first, t[s], static_cast<std::size_t>(own) * sizeof(double));
}

template <int sides, class Value>
void BlockCholesky::run(const Value* values, std::size_t count, double* const* x, std::vector<double>& work) const
{
    // right-hand sides in the new order, then one panel's unknowns
    const std::size_t n = 3 * order_.size(), wide = static_cast<std::size_t>(widest_);
    work.resize(sides * (n + wide));
    double *y[sides], *t[sides];
    for (int s = 0; s < sides; ++s) {
        y[s] = work.data() + static_cast<std::size_t>(s) * n;
        t[s] = work.data() + sides * n + static_cast<std::size_t>(s) * wide;
        for (std::size_t k = 0; k < order_.size(); ++k) std::memcpy(y[s] + 3 * k, x[s] + 3 * order_[k], 3 * sizeof(double));
    }
    for (const Panel& panel : panels_) down<sides>(panel, values, y, t);
    const Value* end = values + count;
    for (std::size_t k = panels_.size(); k-- > 0;) {
        up<sides>(panels_[k], end, y, t);
        end = values + panels_[k].first_value;
    }
    for (int s = 0; s < sides; ++s) {
        for (std::size_t k = 0; k < order_.size(); ++k) std::memcpy(x[s] + 3 * order_[k], y[s] + 3 * k, 3 * sizeof(double));
        for (const std::int32_t b : skipped_) std::memset(x[s] + 3 * b, 0, 3 * sizeof(double));
    }
}

/// Of the largest number: a solution of soft modes.
double BlockCholesky::error_of_singles() const
{
    std::vector<double> force(static_cast<std::size_t>(3 * blocks_)), work;
    for (std::size_t i = 0; i < force.size(); ++i)
        force[i] = 1 + 0.3 * static_cast<double>(i * 7 % 11) - static_cast<double>(i % 3);
    const auto solved = [&](const auto& values, std::vector<double> x) {
        double* sides[] = {x.data()};
        run<1>(values.data(), values.size(), sides, work);
        return x;
    };
    for (int rounds = 0; rounds < 3; ++rounds) {  // inverse iteration
        force = solved(values_, std::move(force));
        const double most =
            Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size())).lpNorm<Eigen::Infinity>();
        for (double& f : force) f /= most;
    }
    const std::vector<double> x = solved(values_, force), rounded = solved(singles_, force);
    double miss = 0, most = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        miss = std::max(miss, std::abs(rounded[i] - x[i])), most = std::max(most, std::abs(x[i]));
    return miss / most;
}

void BlockCholesky::round_if_accurate()
{
    singles_.assign(values_.begin(), values_.end());
    if (error_of_singles() < single_error) values_ = {};
    else singles_ = {};
}

void BlockCholesky::begin(std::span<const double> b, Partial& partial) const
{
    SEL_ASSERT(b.size() == static_cast<std::size_t>(3 * blocks_));
    partial.x.resize(3 * order_.size());
    partial.known.assign(panels_.size(), 0);
    partial.work.resize(static_cast<std::size_t>(widest_));
    for (std::size_t k = 0; k < order_.size(); ++k)
        std::memcpy(&partial.x[3 * k], &b[3 * static_cast<std::size_t>(order_[k])], 3 * sizeof(double));
    double *y[] = {partial.x.data()}, *t[] = {partial.work.data()};
    with_values([&](const auto* values, std::size_t) {
        for (const Panel& panel : panels_) down<1>(panel, values, y, t);
    });
}

void BlockCholesky::read(std::int32_t block, Partial& partial, double* to) const
{
    const std::int32_t place = place_[static_cast<std::size_t>(block)];
    if (place < 0) {
        std::fill_n(to, 3, 0.0);
        return;
    }
    thread_local std::vector<std::int32_t> way;  // up to a panel that is known, or the root
    way.clear();
    for (std::int32_t p = panel_of_[static_cast<std::size_t>(place)]; !partial.known[static_cast<std::size_t>(p)];) {
        way.push_back(p);
        const Panel& panel = panels_[static_cast<std::size_t>(p)];
        if (panel.rows == 0) break;
        p = panel_of_[static_cast<std::size_t>(
            rows_[static_cast<std::size_t>(panel.first_row)])];  // rows rise: the parent has the first
    }
    double *y[] = {partial.x.data()}, *t[] = {partial.work.data()};
    with_values([&](const auto* values, std::size_t count) {
        for (; !way.empty(); way.pop_back()) {
            const auto p = static_cast<std::size_t>(way.back());
            const bool last = p + 1 == panels_.size();
            up<1>(panels_[p], values + (last ? count : static_cast<std::size_t>(panels_[p + 1].first_value)), y, t);
            partial.known[p] = 1;
        }
    });
    std::memcpy(to, &partial.x[3 * static_cast<std::size_t>(place)], 3 * sizeof(double));
}

void BlockCholesky::solve(std::span<double> x, std::vector<double>& work) const
{
    SEL_ASSERT(x.size() == static_cast<std::size_t>(3 * blocks_));
    double* sides[] = {x.data()};
    solve_sides<1>(sides, work);
}

void BlockCholesky::solve(std::span<double> x, std::span<double> y, std::vector<double>& work) const
{
    SEL_ASSERT(x.size() == static_cast<std::size_t>(3 * blocks_) && y.size() == x.size());
    double* sides[] = {x.data(), y.data()};
    solve_sides<2>(sides, work);
}

void BlockCholesky::solve(std::span<double> x, std::span<double> y, std::span<double> z, std::vector<double>& work) const
{
    SEL_ASSERT(x.size() == static_cast<std::size_t>(3 * blocks_) && y.size() == x.size() && z.size() == x.size());
    double* sides[] = {x.data(), y.data(), z.data()};
    solve_sides<3>(sides, work);
}

}  // namespace seldinger

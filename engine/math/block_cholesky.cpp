// Multifrontal factor by panels [Duff & Reid 1983, doi:10.1145/356044.356047], and solves that stream through it.
#include "math/block_cholesky.h"

#include "core/check.h"
#include "math/dissection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstring>

namespace seldinger {

/// Order, and rows of L by panels, before any number is known.
struct BlockCholesky::Symbolic {
    std::vector<std::int32_t> order, place;       // old of new, new of old (-1: left out)
    std::vector<std::vector<std::int32_t>> rows;  // [panel] below its own square, increasing
    std::vector<std::int32_t> first;              // [panels + 1]
    std::vector<std::int32_t> parent;             // [panel], -1: a root
    double entries = 0;
};

namespace {

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

/// Rows of each column of L below the diagonal, in the new order.
std::vector<std::vector<std::int32_t>> column_rows(const Graph& graph, const std::vector<std::int32_t>& order)
{
    const auto n = static_cast<std::int32_t>(order.size());
    std::vector<std::int32_t> place(order.size());
    for (std::int32_t k = 0; k < n; ++k) place[static_cast<std::size_t>(order[static_cast<std::size_t>(k)])] = k;
    std::vector<std::vector<std::int32_t>> rows(order.size()), children(order.size());
    std::vector<std::int32_t> mark(order.size(), -1);
    for (std::int32_t k = 0; k < n; ++k) {
        auto& mine = rows[static_cast<std::size_t>(k)];
        const auto take = [&](std::int32_t row) {
            if (row <= k || mark[static_cast<std::size_t>(row)] == k) return;
            mark[static_cast<std::size_t>(row)] = k;
            mine.push_back(row);
        };
        const auto v = static_cast<std::size_t>(order[static_cast<std::size_t>(k)]);
        for (auto e = graph.first[v]; e < graph.first[v + 1]; ++e)
            take(place[static_cast<std::size_t>(graph.adjacent[static_cast<std::size_t>(e)])]);
        for (const std::int32_t child : children[static_cast<std::size_t>(k)])
            for (const std::int32_t row : rows[static_cast<std::size_t>(child)]) take(row);
        std::sort(mine.begin(), mine.end());
        if (!mine.empty()) children[static_cast<std::size_t>(mine.front())].push_back(k);
    }
    return rows;
}

/// The same elimination with children right before their parents.
std::vector<std::int32_t> postorder(const std::vector<std::vector<std::int32_t>>& rows)
{
    const auto n = static_cast<std::int32_t>(rows.size());
    std::vector<std::vector<std::int32_t>> children(rows.size());
    std::vector<std::int32_t> result, stack;
    for (std::int32_t k = n; k-- > 0;) {  // last child first, so that the stack gives them in order
        if (!rows[static_cast<std::size_t>(k)].empty())
            children[static_cast<std::size_t>(rows[static_cast<std::size_t>(k)].front())].push_back(k);
        else stack.push_back(k);
    }
    std::vector<unsigned char> open(rows.size(), 0);
    while (!stack.empty()) {
        const std::int32_t k = stack.back();
        if (open[static_cast<std::size_t>(k)]) {
            result.push_back(k);
            stack.pop_back();
            continue;
        }
        open[static_cast<std::size_t>(k)] = 1;
        for (const std::int32_t child : children[static_cast<std::size_t>(k)]) stack.push_back(child);
    }
    return result;
}

/// Whether a panel of so many columns and rows below is worth having for `needed` blocks of L: few zeros are read for it, and
/// wide panels are read faster.
bool worth_having(std::int64_t columns, std::int64_t rows, std::int64_t needed)
{
    const std::int64_t read = columns * (columns + 1) / 2 + columns * rows;
    return read * 100 <= needed * 106 || (columns <= 4 && read * 100 <= needed * 120);
}

}  // namespace

bool BlockCholesky::factor(const Eigen::SparseMatrix<double>& matrix, std::span<const unsigned char> skip,
                           std::span<const double> along)
{
    SEL_ASSERT(matrix.rows() == matrix.cols() && matrix.rows() % 3 == 0);
    blocks_ = static_cast<std::int32_t>(matrix.rows() / 3);
    SEL_ASSERT(skip.empty() || skip.size() == static_cast<std::size_t>(blocks_));
    std::vector<std::int32_t> free_index(static_cast<std::size_t>(blocks_), -1), free_block;
    skipped_.clear();
    for (std::int32_t b = 0; b < blocks_; ++b) {
        if (!skip.empty() && skip[static_cast<std::size_t>(b)]) {
            skipped_.push_back(b);
            continue;
        }
        free_index[static_cast<std::size_t>(b)] = static_cast<std::int32_t>(free_block.size());
        free_block.push_back(b);
    }
    const Graph graph = block_graph(matrix, free_index, static_cast<std::int32_t>(free_block.size()));

    Symbolic best;
    std::vector<std::vector<std::int32_t>> orders = {nested_dissection(graph), minimum_degree(graph)};
    if (!along.empty()) {
        orders.emplace_back(free_block.size());
        for (std::size_t k = 0; k < free_block.size(); ++k) orders.back()[k] = static_cast<std::int32_t>(k);
        const auto at = [&](std::int32_t k) { return along[static_cast<std::size_t>(free_block[static_cast<std::size_t>(k)])]; };
        std::stable_sort(orders.back().begin(), orders.back().end(),
                         [&](std::int32_t a, std::int32_t b) { return at(a) > at(b); });
    }
    for (const std::vector<std::int32_t>& order : orders) {
        std::vector<std::int32_t> post = postorder(column_rows(graph, order));
        for (std::int32_t& k : post) k = order[static_cast<std::size_t>(k)];
        const auto rows = column_rows(graph, post);
        double entries = 0;
        for (const auto& list : rows) entries += static_cast<double>(list.size());
        if (!best.order.empty() && entries >= best.entries) continue;
        best = {};
        best.entries = entries;
        best.order = post;
        // columns with the same rows below make a panel
        std::vector<std::int32_t> first;
        for (std::size_t k = 0; k < rows.size(); ++k)
            if (k == 0 || rows[k - 1].empty() || rows[k - 1].front() != static_cast<std::int32_t>(k) ||
                rows[k - 1].size() != rows[k].size() + 1)
                first.push_back(static_cast<std::int32_t>(k));
        first.push_back(static_cast<std::int32_t>(rows.size()));
        // and join the parent right behind where that costs little
        std::int64_t needed = 0;  // blocks of L in the last panel
        for (std::size_t p = 0; p + 1 < first.size(); ++p) {
            const std::int32_t end = first[p + 1];
            const auto& theirs = rows[static_cast<std::size_t>(end) - 1];
            std::int64_t own = 0;
            for (std::int32_t k = first[p]; k < end; ++k)
                own += 1 + static_cast<std::int64_t>(rows[static_cast<std::size_t>(k)].size());
            if (!best.first.empty()) {
                const auto& mine = rows[static_cast<std::size_t>(first[p]) - 1];
                const bool child = !mine.empty() && mine.front() < end;
                if (child && worth_having(end - best.first.back(), static_cast<std::int64_t>(theirs.size()), needed + own)) {
                    best.rows.back() = theirs;
                    needed += own;
                    continue;
                }
            }
            best.first.push_back(first[p]);
            best.rows.push_back(theirs);
            needed = own;
        }
        best.first.push_back(static_cast<std::int32_t>(rows.size()));
    }
    order_.clear();
    best.place.assign(static_cast<std::size_t>(blocks_), -1);
    for (const std::int32_t v : best.order) {
        best.place[static_cast<std::size_t>(free_block[static_cast<std::size_t>(v)])] = static_cast<std::int32_t>(order_.size());
        order_.push_back(free_block[static_cast<std::size_t>(v)]);
    }
    std::vector<std::int32_t> panel_of(order_.size());
    for (std::size_t p = 0; p + 1 < best.first.size(); ++p)
        for (std::int32_t k = best.first[p]; k < best.first[p + 1]; ++k)
            panel_of[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(p);
    for (const auto& list : best.rows)
        best.parent.push_back(list.empty() ? -1 : panel_of[static_cast<std::size_t>(list.front())]);
    return factor_panels(matrix, best);
}

bool BlockCholesky::factor_panels(const Eigen::SparseMatrix<double>& matrix, const Symbolic& symbolic)
{
    using Dense = Eigen::MatrixXd;
    const std::size_t count = symbolic.rows.size();
    panels_.clear(), rows_.clear(), values_.clear();
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
                    const std::int32_t row = symbolic.place[static_cast<std::size_t>(it.row() / 3)];
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
        // keep it as solves read it: three columns at a time, eight rows of each beside each other, one stream from end to end
        const std::int32_t stride = (3 * (columns + rows) + 7) / 8 * 8;
        panels_.push_back(
            {first, columns, static_cast<std::int32_t>(rows_.size()), rows, stride, static_cast<std::int64_t>(values_.size())});
        widest_ = std::max(widest_, stride);
        rows_.insert(rows_.end(), below.begin(), below.end());
        for (Eigen::Index k = 0; k < columns; ++k) {
            const Eigen::Matrix3d own = square.block(3 * k, 3 * k, 3, 3);
            Eigen::Map<Eigen::Matrix3d> inverse(inverse_.data() + 9 * (first + k));
            inverse = own.triangularView<Eigen::Lower>().solve(Eigen::Matrix3d::Identity());
            for (Eigen::Index i = 3 * k / 8 * 8; i < stride; i += 8)
                for (Eigen::Index j = 3 * k; j < 3 * k + 3; ++j)
                    for (Eigen::Index r = i; r < i + 8; ++r)
                        values_.push_back(r < 3 * k + 3 || r >= 3 * (columns + rows) ? 0.0 : front(r, j));
        }
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
inline void store(double* p, const Eight& v) { std::memcpy(p, &v.low, sizeof v.low), std::memcpy(p + 4, &v.high, sizeof v.high); }
inline double sum(const Eight& v)
{
    const Four s = v.low + v.high;
    return (s[0] + s[2]) + (s[1] + s[3]);
}

}  // namespace

template <int sides>
void BlockCholesky::solve_sides(double* const* x, std::vector<double>& work) const
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
    for (const Panel& panel : panels_) {
        const int stride = panel.stride, own = 3 * panel.columns;
        const std::int32_t* row = rows_.data() + panel.first_row;
        for (int s = 0; s < sides; ++s) {
            std::memcpy(t[s], y[s] + 3 * panel.first, static_cast<std::size_t>(own) * sizeof(double));
            std::memset(t[s] + own, 0, static_cast<std::size_t>(stride - own) * sizeof(double));
        }
        const double* value = values_.data() + panel.first_value;
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
        for (int s = 0; s < sides; ++s) {
            std::memcpy(y[s] + 3 * panel.first, t[s], static_cast<std::size_t>(own) * sizeof(double));
            const double* z = t[s] + own;
            for (std::int32_t k = 0; k < panel.rows; ++k, z += 3) {
                double* to = y[s] + 3 * row[k];
                to[0] += z[0], to[1] += z[1], to[2] += z[2];
            }
        }
    }
    for (std::size_t at = panels_.size(); at-- > 0;) {
        const Panel& panel = panels_[at];
        const int stride = panel.stride, own = 3 * panel.columns;
        const std::int32_t* row = rows_.data() + panel.first_row;
        for (int s = 0; s < sides; ++s) {
            std::memcpy(t[s], y[s] + 3 * panel.first, static_cast<std::size_t>(own) * sizeof(double));
            double* z = t[s] + own;
            for (std::int32_t k = 0; k < panel.rows; ++k, z += 3) std::memcpy(z, y[s] + 3 * row[k], 3 * sizeof(double));
            std::memset(z, 0, static_cast<std::size_t>(stride - own - 3 * panel.rows) * sizeof(double));
        }
        const double* value =
            at + 1 < panels_.size() ? values_.data() + panels_[at + 1].first_value : values_.data() + values_.size();
        const double* d = inverse_.data() + 9 * (panel.first + panel.columns - 1);
        for (int k = own - 3; k >= 0; k -= 3, d -= 9) {
            Eight u[sides][3] = {};
            value -= 3 * (stride - k / 8 * 8);
            const double* group = value;
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
    for (int s = 0; s < sides; ++s) {
        for (std::size_t k = 0; k < order_.size(); ++k) std::memcpy(x[s] + 3 * order_[k], y[s] + 3 * k, 3 * sizeof(double));
        for (const std::int32_t b : skipped_) std::memset(x[s] + 3 * b, 0, 3 * sizeof(double));
    }
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

}  // namespace seldinger

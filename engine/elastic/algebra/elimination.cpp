// Symbolic factorization: rows of each column, postorder, panels.
#include "algebra/elimination.h"

#include <algorithm>

namespace seldinger {
namespace {

using Rows = std::vector<std::vector<std::int32_t>>;

/// Rows of each column of L below the diagonal, in the new order.
Rows column_rows(const Graph& graph, const std::vector<std::int32_t>& order)
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
std::vector<std::int32_t> postorder(const Rows& rows)
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

/// Columns with the same rows below make a panel, and panels join the parent right behind where that costs little.
void make_panels(const Rows& rows, Elimination& to)
{
    std::vector<std::int32_t> first;
    for (std::size_t k = 0; k < rows.size(); ++k)
        if (k == 0 || rows[k - 1].empty() || rows[k - 1].front() != static_cast<std::int32_t>(k) ||
            rows[k - 1].size() != rows[k].size() + 1)
            first.push_back(static_cast<std::int32_t>(k));
    first.push_back(static_cast<std::int32_t>(rows.size()));
    std::int64_t needed = 0;  // entries in the last panel
    for (std::size_t p = 0; p + 1 < first.size(); ++p) {
        const std::int32_t end = first[p + 1];
        const auto& theirs = rows[static_cast<std::size_t>(end) - 1];
        std::int64_t own = 0;
        for (std::int32_t k = first[p]; k < end; ++k)
            own += 1 + static_cast<std::int64_t>(rows[static_cast<std::size_t>(k)].size());
        if (!to.first.empty()) {
            const auto& mine = rows[static_cast<std::size_t>(first[p]) - 1];
            const bool child = !mine.empty() && mine.front() < end;
            if (child && worth_having(end - to.first.back(), static_cast<std::int64_t>(theirs.size()), needed + own)) {
                to.rows.back() = theirs;
                needed += own;
                continue;
            }
        }
        to.first.push_back(first[p]);
        to.rows.push_back(theirs);
        needed = own;
    }
    to.first.push_back(static_cast<std::int32_t>(rows.size()));
}

}  // namespace

Elimination eliminate(const Graph& graph, const std::vector<std::int32_t>& order)
{
    Elimination made;
    made.order = postorder(column_rows(graph, order));
    for (std::int32_t& k : made.order) k = order[static_cast<std::size_t>(k)];
    const Rows rows = column_rows(graph, made.order);
    for (const auto& list : rows) made.entries += static_cast<double>(list.size());
    make_panels(rows, made);
    std::vector<std::int32_t> panel_of(rows.size());
    for (std::size_t p = 0; p + 1 < made.first.size(); ++p)
        for (std::int32_t k = made.first[p]; k < made.first[p + 1]; ++k)
            panel_of[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(p);
    for (const auto& list : made.rows)
        made.parent.push_back(list.empty() ? -1 : panel_of[static_cast<std::size_t>(list.front())]);
    return made;
}

}  // namespace seldinger

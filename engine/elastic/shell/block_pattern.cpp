// Pattern of the wall's matrices by columns of vertices, and how blocks become an Eigen matrix.
#include "shell/block_pattern.h"

#include "core/check.h"

#include <algorithm>

namespace seldinger {

BlockPattern::BlockPattern(std::int32_t vertices, std::span<const std::vector<std::int32_t>> stencils)
{
    std::vector<std::vector<std::int32_t>> rows(static_cast<std::size_t>(vertices));
    for (std::int32_t v = 0; v < vertices; ++v) rows[static_cast<std::size_t>(v)].push_back(v);
    for (const auto& stencil : stencils)
        for (const std::int32_t column : stencil)
            for (const std::int32_t row : stencil)
                if (row > column) rows[static_cast<std::size_t>(column)].push_back(row);
    first_.push_back(0);
    for (auto& column : rows) {
        std::sort(column.begin(), column.end());
        column.erase(std::unique(column.begin(), column.end()), column.end());
        row_.insert(row_.end(), column.begin(), column.end());
        first_.push_back(static_cast<std::int32_t>(row_.size()));
    }
}

std::size_t BlockPattern::find(std::int32_t row, std::int32_t column) const
{
    const auto begin = row_.begin() + first_[static_cast<std::size_t>(column)];
    const auto end = row_.begin() + first_[static_cast<std::size_t>(column) + 1];
    const auto found = std::lower_bound(begin, end, row);
    SEL_ASSERT(found != end && *found == row);
    return static_cast<std::size_t>(found - row_.begin());
}

Eigen::SparseMatrix<double> BlockPattern::matrix(std::span<const double> values, int size) const
{
    const std::int32_t vertices = vertex_count();
    std::vector<std::vector<std::pair<std::int32_t, std::size_t>>> above(static_cast<std::size_t>(vertices));  // (row, block)
    for (std::int32_t c = 0; c < vertices; ++c)
        for (auto k = static_cast<std::size_t>(first_[static_cast<std::size_t>(c)]) + 1;
             k < static_cast<std::size_t>(first_[static_cast<std::size_t>(c) + 1]); ++k)
            above[static_cast<std::size_t>(row_[k])].push_back({c, k});
    Eigen::SparseMatrix<double> m(vertices * size, vertices * size);
    m.reserve(static_cast<Eigen::Index>((2 * row_.size() - static_cast<std::size_t>(vertices)) *
                                        static_cast<std::size_t>(size * size)));
    const auto at = [&](std::size_t block, int i, int j) {
        return values[(block * static_cast<std::size_t>(size) + static_cast<std::size_t>(j)) * static_cast<std::size_t>(size) +
                      static_cast<std::size_t>(i)];
    };
    for (std::int32_t c = 0; c < vertices; ++c)
        for (int j = 0; j < size; ++j) {
            m.startVec(c * size + j);
            for (const auto& [row, block] : above[static_cast<std::size_t>(c)])
                for (int i = 0; i < size; ++i) m.insertBack(row * size + i, c * size + j) = at(block, j, i);
            for (auto k = static_cast<std::size_t>(first_[static_cast<std::size_t>(c)]);
                 k < static_cast<std::size_t>(first_[static_cast<std::size_t>(c) + 1]); ++k)
                for (int i = 0; i < size; ++i)  // the diagonal block by its lower half
                    m.insertBack(row_[k] * size + i, c * size + j) = row_[k] == c && i < j ? at(k, j, i) : at(k, i, j);
        }
    m.finalize();
    return m;
}

}  // namespace seldinger

// Matrices of an irregular corner, read off a round of subdivision of a small flat mesh about it.
#include "surface/loop_corner.h"

#include "core/check.h"

#include <Eigen/Core>

namespace seldinger {

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Three rings of triangles about vertex 0, in `sectors` sectors, closed or open along the rim.
LoopTopology rings_about(LoopVertex kind, int sectors)
{
    const bool closed = kind == LoopVertex::Inner;
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::int32_t begin[4] = {0, 1, 0, 0};  // first vertex of each ring
    const auto size = [&](int r) { return r == 0 ? 1 : r * sectors + (closed ? 0 : 1); };
    for (int r = 2; r <= 3; ++r) begin[r] = begin[r - 1] + size(r - 1);
    const auto at = [&](int r, int i) { return begin[r] + (closed || r == 0 ? i % size(r) : i); };
    for (int r = 1; r <= 3; ++r)
        for (int s = 0; s < sectors; ++s)
            for (int i = 0; i < r; ++i) {
                const int out = s * r + i, in = s * (r - 1) + i;
                triangles.push_back({at(r - 1, in), at(r, out), at(r, out + 1)});
                if (i < r - 1) triangles.push_back({at(r - 1, in), at(r, out + 1), at(r - 1, in + 1)});
            }
    std::vector<unsigned char> corner(static_cast<std::size_t>(begin[3] + size(3)), 0);
    corner[0] = kind == LoopVertex::Corner;
    return LoopTopology(std::move(triangles), corner);
}

/// Row of weights of a refined vertex on the coarse points; all that it needs must be among them.
void put_row(const LoopRefinement& fine, std::int32_t vertex, const std::vector<std::int32_t>& points, double scale,
             Eigen::Ref<Eigen::RowVectorXd> row)
{
    for (std::int32_t k = fine.first[static_cast<std::size_t>(vertex)]; k < fine.first[static_cast<std::size_t>(vertex) + 1];
         ++k) {
        const auto found = std::find(points.begin(), points.end(), fine.vertex[static_cast<std::size_t>(k)]);
        SEL_ASSERT(found != points.end());
        row[found - points.begin()] += scale * fine.weight[static_cast<std::size_t>(k)];
    }
}

/// Limits of the triangle's corners from its points.
Matrix limits(const LoopTopology& mesh, std::int32_t triangle, const std::vector<std::int32_t>& points)
{
    Matrix rows = Matrix::Zero(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t c = 0; c < 3; ++c) {
        const std::int32_t v = mesh.triangles[static_cast<std::size_t>(triangle)][c];
        const auto add = [&](std::int32_t vertex, double weight) {
            const auto found = std::find(points.begin(), points.end(), vertex);
            SEL_ASSERT(found != points.end());
            rows(static_cast<Eigen::Index>(c), found - points.begin()) += weight;
        };
        const LoopTopology::LimitMask mask = mesh.limit_mask(v);
        add(v, mask.own);
        for (int k = 0; k < mask.count; ++k) add(mask.neighbours[static_cast<std::size_t>(k)], mask.each);
    }
    return rows;
}

}  // namespace

LoopCorner make_loop_corner(LoopVertex kind, int triangles, int place)
{
    const LoopTopology coarse = rings_about(kind, triangles);
    const LoopRefinement fine = refine(coarse);
    const std::int32_t child = 4 * place;  // corner child of the triangle of the first ring in that sector
    int coarse_place, fine_place;
    const std::vector<std::int32_t> points = coarse.corner_patch(place, coarse_place);
    const std::vector<std::int32_t> next = fine.topology.corner_patch(child, fine_place);
    SEL_ASSERT(next.size() == points.size() && coarse_place == fine_place);
    const auto k = static_cast<Eigen::Index>(points.size());

    Matrix round = Matrix::Zero(k, k);
    for (Eigen::Index i = 0; i < k; ++i) put_row(fine, next[static_cast<std::size_t>(i)], points, 1, round.row(i));
    Matrix regular = Matrix::Zero(36, k);
    for (int c = 0; c < 3; ++c) {
        const auto patch = fine.topology.patch(child + c + 1);
        for (std::size_t i = 0; i < 12; ++i) {
            auto row = regular.row(c * 12 + static_cast<Eigen::Index>(i));
            put_row(fine, patch[i].a, points, 1, row);
            if (!patch[i].phantom()) continue;
            put_row(fine, patch[i].b, points, 1, row);
            put_row(fine, patch[i].c, points, -1, row);
        }
    }

    LoopCorner corner{kind, triangles, coarse_place, static_cast<int>(k), {}, {}};
    Matrix power = Matrix::Identity(k, k);
    for (int m = 0; m < LoopCorner::depth; ++m) {
        const Matrix at = regular * power;
        corner.patches.insert(corner.patches.end(), at.data(), at.data() + at.size());
        power = (round * power).eval();
    }
    const Matrix last = limits(coarse, place, points) * power;
    corner.last.assign(last.data(), last.data() + last.size());
    return corner;
}

}  // namespace seldinger

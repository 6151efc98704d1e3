// Tables of the quartic box spline and its derivatives as homogeneous polynomials of the barycentric weights.
#include "surface/loop_basis.h"

#include "core/check.h"

#include <Eigen/Core>

#include <array>

namespace seldinger {
namespace {

/// Polynomial of degree d in (p, q, r): coefficient of p^(d-b-c) q^b r^c at [b][c].
using Quartic = std::array<std::array<double, 5>, 5>;

/// place(a, b, c) with the exponents of three variables given in any order, `where` telling which variable each is.
struct Powers {
    int of[3];
};
constexpr void add(Quartic& f, std::array<int, 3> variables, Powers e, double coefficient)
{
    std::array<int, 3> power = {0, 0, 0};
    for (int k = 0; k < 3; ++k) power[variables[k]] += e.of[k];
    f[power[1]][power[2]] += coefficient / 12;
}

/// Functions of [Cirak00, app. A; Stam98]: of corner x; of the vertex across edge xy; of the outer vertex about x on y's side.
constexpr Quartic of_corner(int x, int y, int z)
{
    Quartic f{};
    const std::array<int, 3> v = {x, y, z};
    add(f, v, {{4, 0, 0}}, 6);
    add(f, v, {{3, 1, 0}}, 24), add(f, v, {{3, 0, 1}}, 24);
    add(f, v, {{2, 2, 0}}, 24), add(f, v, {{2, 1, 1}}, 60), add(f, v, {{2, 0, 2}}, 24);
    add(f, v, {{1, 3, 0}}, 8), add(f, v, {{1, 2, 1}}, 36), add(f, v, {{1, 1, 2}}, 36), add(f, v, {{1, 0, 3}}, 8);
    add(f, v, {{0, 4, 0}}, 1), add(f, v, {{0, 3, 1}}, 6), add(f, v, {{0, 2, 2}}, 12), add(f, v, {{0, 1, 3}}, 6);
    add(f, v, {{0, 0, 4}}, 1);
    return f;
}
constexpr Quartic of_across(int x, int y, int z)
{
    Quartic f{};
    const std::array<int, 3> v = {x, y, z};
    add(f, v, {{4, 0, 0}}, 1), add(f, v, {{3, 1, 0}}, 6), add(f, v, {{2, 2, 0}}, 12), add(f, v, {{1, 3, 0}}, 6);
    add(f, v, {{0, 4, 0}}, 1);
    add(f, v, {{3, 0, 1}}, 2), add(f, v, {{2, 1, 1}}, 6), add(f, v, {{1, 2, 1}}, 6), add(f, v, {{0, 3, 1}}, 2);
    return f;
}
constexpr Quartic of_outer(int x, int y)
{
    Quartic f{};
    const std::array<int, 3> v = {x, y, 3 - x - y};
    add(f, v, {{4, 0, 0}}, 1), add(f, v, {{3, 1, 0}}, 2);
    return f;
}

/// d/dq - d/dp (variable 1) or d/dr - d/dp (variable 2) of a polynomial of degree d.
constexpr Quartic derivative(const Quartic& f, int degree, int variable)
{
    Quartic g{};
    for (int b = 0; b <= degree; ++b)
        for (int c = 0; b + c <= degree; ++c) {
            const int a = degree - b - c;
            if (a > 0) g[b][c] -= a * f[b][c];
            if (variable == 1 && b > 0) g[b - 1][c] += b * f[b][c];
            if (variable == 2 && c > 0) g[b][c - 1] += c * f[b][c];
        }
    return g;
}

/// All twelve functions, monomial by monomial so that the sum runs over twelve neighbours in memory.
template <int degree>
struct Table {
    static constexpr int monomials = (degree + 1) * (degree + 2) / 2;
    alignas(64) double c[monomials][12];
    constexpr explicit Table(const std::array<Quartic, 12>& f) : c{}
    {
        for (int b = 0, m = 0; b <= degree; ++b)
            for (int k = 0; b + k <= degree; ++k, ++m)
                for (int i = 0; i < 12; ++i) c[m][i] = f[i][b][k];
    }
    void sum(const double* monomial, double* out) const
    {
        double s[12] = {};
        for (int m = 0; m < monomials; ++m)
            for (int i = 0; i < 12; ++i) s[i] += monomial[m] * c[m][i];
        for (int i = 0; i < 12; ++i) out[i] = s[i];
    }
};

constexpr std::array<Quartic, 12> functions = {of_corner(0, 1, 2), of_corner(1, 2, 0), of_corner(2, 0, 1), of_across(0, 1, 2),
                                               of_across(1, 2, 0), of_across(2, 0, 1), of_outer(0, 2),     of_outer(0, 1),
                                               of_outer(1, 0),     of_outer(1, 2),     of_outer(2, 1),     of_outer(2, 0)};

constexpr std::array<Quartic, 12> derivatives(const std::array<Quartic, 12>& f, int degree, int variable)
{
    std::array<Quartic, 12> g{};
    for (int i = 0; i < 12; ++i) g[i] = derivative(f[i], degree, variable);
    return g;
}

constexpr auto by_u = derivatives(functions, 4, 1), by_v = derivatives(functions, 4, 2);
constexpr Table<4> table(functions);
constexpr Table<3> table_u(by_u), table_v(by_v);
constexpr Table<2> table_uu(derivatives(by_u, 3, 1)), table_uv(derivatives(by_u, 3, 2)), table_vv(derivatives(by_v, 3, 2));

/// p^(d-b-c) q^b r^c in the tables' order.
template <int degree>
void monomials(double p, double q, double r, double* m)
{
    double pp[degree + 1] = {1}, rr[degree + 1] = {1};
    for (int k = 1; k <= degree; ++k) pp[k] = pp[k - 1] * p, rr[k] = rr[k - 1] * r;
    double qb = 1;
    for (int b = 0; b <= degree; ++b, qb *= q)
        for (int c = 0; b + c <= degree; ++c) *m++ = pp[degree - b - c] * qb * rr[c];
}

}  // namespace

void loop_basis(double u, double v, bool curved, LoopBasis& basis)
{
    double m[15];
    const double w = 1 - u - v;
    monomials<4>(w, u, v, m);
    table.sum(m, basis.n);
    monomials<3>(w, u, v, m);
    table_u.sum(m, basis.n_u);
    table_v.sum(m, basis.n_v);
    if (!curved) return;
    monomials<2>(w, u, v, m);
    table_uu.sum(m, basis.n_uu);
    table_uv.sum(m, basis.n_uv);
    table_vv.sum(m, basis.n_vv);
}

// Matrices of an irregular corner, read off a round of subdivision of a small flat mesh about it.

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

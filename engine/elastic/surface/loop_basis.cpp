// Tables of the quartic box spline and its derivatives as homogeneous polynomials of the barycentric weights.
#include "surface/loop_basis.h"

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

}  // namespace seldinger

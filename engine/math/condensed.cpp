// Elimination of a compliant foundation's unknowns.

#include "math/condensed.h"

#include "core/check.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

// Of a Newton direction: its own error is a thousand times larger until the last steps.
constexpr double direction_accuracy = 1e-5;
constexpr double own_accuracy = 1e-11;

using Vector = Eigen::Map<Eigen::VectorXd>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;
using Columns = Eigen::Map<Eigen::MatrixXd>;

ConstVector view(std::span<const double> x) { return {x.data(), static_cast<Eigen::Index>(x.size())}; }
Vector view(std::span<double> x) { return {x.data(), static_cast<Eigen::Index>(x.size())}; }

/// Memory of a solve; one per thread.
struct Krylov {
    std::vector<double> basis, hessenberg, rotation, rhs, y;
    Eigen::VectorXd along;
};

}  // namespace

int solve_gmres(std::span<double> u, double accuracy,
                const std::function<void(std::span<const double>, std::span<double>)>& product)
{
    thread_local Krylov work;
    const std::size_t m = u.size();
    const double size = view(u).norm();
    if (!(size > 0)) return 0;
    work.basis.resize((m + 1) * m);
    work.hessenberg.assign((m + 1) * m, 0.0);  // column k: h[0..k+1] at k (m + 1)
    work.rotation.resize(2 * m);
    work.rhs.assign(m + 1, 0.0);
    work.y.resize(m);
    const auto vector = [&](std::size_t k) { return std::span(work.basis).subspan(k * m, m); };
    for (std::size_t i = 0; i < m; ++i) vector(0)[i] = u[i] / size;
    work.rhs[0] = size;
    std::size_t taken = 0;
    for (std::size_t k = 0; k < m; ++k) {
        const std::span<double> next = vector(k + 1);
        product(vector(k), next);
        double* const h = &work.hessenberg[k * (m + 1)];
        const Columns before(work.basis.data(), static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(k + 1));
        for (int pass = 0; pass < 2; ++pass) {  // twice is enough: orthogonal to rounding
            work.along.noalias() = before.transpose() * view(next);
            view(next).noalias() -= before * work.along;
            for (std::size_t l = 0; l <= k; ++l) h[l] += work.along[static_cast<Eigen::Index>(l)];
        }
        h[k + 1] = view(next).norm();
        const bool last = !(h[k + 1] > 1e-14 * size) || k + 1 == m;
        if (!last)
            for (double& x : next) x /= h[k + 1];
        for (std::size_t l = 0; l < k; ++l) {
            const double c = work.rotation[2 * l], s = work.rotation[2 * l + 1], a = h[l], b = h[l + 1];
            h[l] = c * a + s * b;
            h[l + 1] = c * b - s * a;
        }
        const double r = std::hypot(h[k], h[k + 1]);
        const double c = r > 0 ? h[k] / r : 1, s = r > 0 ? h[k + 1] / r : 0;
        work.rotation[2 * k] = c;
        work.rotation[2 * k + 1] = s;
        h[k] = r;
        work.rhs[k + 1] = -s * work.rhs[k];
        work.rhs[k] *= c;
        taken = k + 1;
        if (last || std::abs(work.rhs[k + 1]) <= accuracy * size) break;
    }
    for (std::size_t k = taken; k-- > 0;) {
        double sum = work.rhs[k];
        for (std::size_t l = k + 1; l < taken; ++l) sum -= work.hessenberg[l * (m + 1) + k] * work.y[l];
        const double pivot = work.hessenberg[k * (m + 1) + k];
        work.y[k] = pivot != 0 ? sum / pivot : 0;
    }
    std::fill(u.begin(), u.end(), 0.0);
    for (std::size_t k = 0; k < taken; ++k)
        for (std::size_t i = 0; i < m; ++i) u[i] += work.y[k] * vector(k)[i];
    return static_cast<int>(taken);
}

void Condensed::reset(int size, std::span<const double> compliance)
{
    SEL_ASSERT(compliance.size() == static_cast<std::size_t>(size) * size);
    size_ = size;
    w_ = compliance;
    for (auto* columns : {&e, &f, &d}) {
        columns->resize(std::max(columns->size(), static_cast<std::size_t>(size)));
        for (Column& column : *columns) column.clear();
    }
}

void Condensed::times_w(std::span<const double> v, std::span<double> wv) const
{
    // W is symmetric: its rows are its columns
    const Eigen::Map<const Eigen::MatrixXd> w(w_.data(), size_, size_);
    view(wv).noalias() = w * view(v);
}

void Condensed::onto(const std::vector<Column>& rows, std::span<const double> x, std::span<double> out)
{
    for (std::size_t k = 0; k < out.size(); ++k) {
        out[k] = 0;
        for (const auto& [unknown, value] : rows[k]) out[k] += value * x[unknown];
    }
}

void Condensed::solve_own(std::span<double> u) const
{
    thread_local std::vector<double> dv;
    dv.resize(u.size());
    solve_gmres(u, own_accuracy, [&](std::span<const double> v, std::span<double> out) {
        onto(d, v, dv);
        times_w(dv, out);
        for (std::size_t k = 0; k < out.size(); ++k) out[k] += v[k];
    });
}

/// y -= E (I + W D)^-1 W (fx)
void Condensed::take_off(std::span<double> fx, std::span<double> y) const
{
    std::vector<double> u(fx.size());
    times_w(fx, u);
    solve_own(u);
    for (std::size_t k = 0; k < u.size(); ++k)
        for (const auto& [unknown, value] : e[k]) y[unknown] -= value * u[k];
}

void Condensed::add_product(std::span<const double> x, std::span<double> y) const
{
    if (empty()) return;
    std::vector<double> fx(static_cast<std::size_t>(size_));
    onto(f, x, fx);
    take_off(fx, y);
}

void Condensed::add_column(int j, double x_j, std::span<double> y) const
{
    if (empty()) return;
    std::vector<double> fx(static_cast<std::size_t>(size_));
    bool any = false;
    for (std::size_t k = 0; k < fx.size(); ++k)
        for (const auto& [unknown, value] : f[k])
            if (unknown == j) fx[k] += value * x_j, any = true;
    if (any) take_off(fx, y);
}

int Condensed::solve(std::span<double> r_to_x, std::span<const unsigned char> fixed,
                     const std::function<void(std::span<double>)>& band) const
{
    thread_local std::vector<double> along, fx, h;
    const std::size_t m = static_cast<std::size_t>(size_), n = r_to_x.size();
    for (auto* array : {&fx, &h}) array->resize(m);
    const auto off_fixed = [&](std::span<double> x) {
        for (std::size_t i = 0; i < n; ++i)
            if (fixed[i]) x[i] = 0;
    };
    // x of r, and what it does to u
    along.resize(n);
    band(r_to_x);
    std::copy(r_to_x.begin(), r_to_x.end(), along.begin());
    off_fixed(along);
    onto(f, along, fx);
    std::vector<double> u(m);
    times_w(fx, u);
    const auto spread = [&](std::span<const double> v) {
        std::fill(along.begin(), along.end(), 0.0);
        for (std::size_t k = 0; k < m; ++k)
            for (const auto& [unknown, value] : e[k]) along[unknown] += value * v[k];
        off_fixed(along);
        band(along);
        off_fixed(along);
    };
    const int iterations = solve_gmres(u, direction_accuracy, [&](std::span<const double> v, std::span<double> out) {
        spread(v);
        onto(f, along, fx);
        onto(d, v, h);
        for (std::size_t k = 0; k < m; ++k) h[k] -= fx[k];
        times_w(h, out);
        for (std::size_t k = 0; k < m; ++k) out[k] += v[k];
    });
    spread(u);
    for (std::size_t i = 0; i < n; ++i) r_to_x[i] += along[i];
    return iterations;
}

}  // namespace seldinger

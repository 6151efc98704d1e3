// The least of J by Newton's method on its banded equations.
#include "rod/lumen_press.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

using Complex = LumenPress::Complex;

// Stiffness of a lumen with a jacket of some 50 MPa [N/m^2]: instruments press with 1 to 100 N/m, which deforms it by a few
// micrometres.
constexpr double give = 2e7;
// Part of the lumen's stiffness for instruments supported only by the hub: negligible beside bending
constexpr double slack = 1e-6;

double scalar(Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); }

/// Second differences at place i, of i - 1, i, i + 1; at the last one, which is held, half of it counts.
double share_of(int i, int last) { return i == last ? 0.5 : 1.0; }

constexpr double weights[3] = {1, -2, 1};

}  // namespace

double LumenPress::energy(const std::vector<Complex>& at, double h) const
{
    const int last = free();
    const auto y = [&](int i) { return i < last ? at[static_cast<std::size_t>(i)] : Complex(0); };
    double sum = 0;
    for (int i = 1; i <= last; ++i) {
        const Complex bent = (y(i - 1) - 2.0 * y(i) + y(i + 1)) / (h * h);
        const Place& place = places[static_cast<std::size_t>(i)];
        sum += share_of(i, last) * h * (0.5 * place.stiffness * std::norm(bent) + scalar(place.moment, bent));
    }
    // the second differences at the first place and the one before it, of the instrument's extension beyond
    sum += (scalar(end.moment, y(1)) - scalar(end.moment + h * end.shear, y(0))) / h;
    for (int i = 0; i < last; ++i) {
        const Place& place = places[static_cast<std::size_t>(i)];
        sum -= (i == 0 ? 0.5 : 1.0) * h * scalar(place.lateral, y(i));
        const double deep = std::abs(y(i)) - place.clearance;
        if (deep > 0) sum += 0.5 * give * h * deep * deep;
    }
    return sum;
}

/// Stiffness of bending and its load, of all steps.
void LumenPress::set_bending(double h)
{
    const int last = free();
    bending_.assign(static_cast<std::size_t>(2 * last * width), 0.0);
    load_.assign(static_cast<std::size_t>(2 * last), 0.0);
    const auto load = [&](int i, Complex value) {
        if (i >= last) return;
        load_[static_cast<std::size_t>(2 * i)] += value.real();
        load_[static_cast<std::size_t>(2 * i + 1)] += value.imag();
    };
    for (int i = 1; i <= last; ++i) {
        const Place& place = places[static_cast<std::size_t>(i)];
        const double share = share_of(i, last) * h, stiff = share * place.stiffness / (h * h * h * h);
        for (int a = 0; a < 3; ++a) {
            load(i - 1 + a, share * weights[a] / (h * h) * place.moment);
            for (int b = 0; b <= a; ++b) {
                if (i - 1 + a >= last) continue;
                for (int c = 0; c < 2; ++c) {
                    const int row = 2 * (i - 1 + a) + c;
                    bending_[static_cast<std::size_t>(row * width + 2 * (a - b))] += stiff * weights[a] * weights[b];
                }
            }
        }
    }
    for (int i = 0; i < last; ++i) load(i, (i == 0 ? -0.5 : -1.0) * h * places[static_cast<std::size_t>(i)].lateral);
    load(0, -(end.moment + h * end.shear) / h);
    load(1, end.moment / h);
}

/// Gradient, with its sign changed, and Hessian at `off`.
void LumenPress::set_newton(double h)
{
    const int last = free();
    rows_ = bending_;
    rhs_.resize(load_.size());
    for (std::size_t r = 0; r < rhs_.size(); ++r) rhs_[r] = -load_[r];
    const auto y = [&](int r) {
        const Complex at = off[static_cast<std::size_t>(r / 2)];
        return r % 2 == 0 ? at.real() : at.imag();
    };
    for (int r = 0; r < 2 * last; ++r)
        for (int back = 0; back < width && back <= r; ++back) {
            const double value = bending_[static_cast<std::size_t>(r * width + back)];
            rhs_[static_cast<std::size_t>(r)] -= value * y(r - back);
            if (back > 0) rhs_[static_cast<std::size_t>(r - back)] -= value * y(r);
        }
    for (int i = 0; i < last; ++i) {
        double* rows = &rows_[static_cast<std::size_t>(2 * i * width)];
        rows[0] += slack * give * h;
        rows[width] += slack * give * h;
        const Complex at = off[static_cast<std::size_t>(i)];
        const double size = std::abs(at), deep = size - places[static_cast<std::size_t>(i)].clearance;
        if (!(deep > 0)) continue;
        const Complex out = at / size;
        const double across = give * h * deep / size, along = give * h - across;
        rhs_[static_cast<std::size_t>(2 * i)] -= give * h * deep * out.real();
        rhs_[static_cast<std::size_t>(2 * i + 1)] -= give * h * deep * out.imag();
        rows[0] += across + along * out.real() * out.real();
        rows[width] += across + along * out.imag() * out.imag();
        rows[width + 1] += along * out.real() * out.imag();
    }
}

/// LDL^T of rows_ in place, rhs_ becomes the solution.
void LumenPress::factor_and_solve()
{
    const int n = 2 * free();
    const auto at = [&](int r, int back) -> double& { return rows_[static_cast<std::size_t>(r * width + back)]; };
    for (int r = 0; r < n; ++r) {
        for (int back = std::min(width - 1, r); back > 0; --back) {
            const int c = r - back;
            double value = at(r, back);  // L(r, c) D(c), for now
            for (int k = std::max({0, r - width + 1, c - width + 1}); k < c; ++k) value -= at(r, r - k) * at(c, c - k);
            at(r, back) = value;
        }
        for (int back = std::min(width - 1, r); back > 0; --back) {
            const double scaled = at(r, back) / at(r - back, 0);
            at(r, 0) -= scaled * at(r, back);
            at(r, back) = scaled;
        }
    }
    for (int r = 0; r < n; ++r)
        for (int back = 1; back < width && back <= r; ++back)
            rhs_[static_cast<std::size_t>(r)] -= at(r, back) * rhs_[static_cast<std::size_t>(r - back)];
    for (int r = 0; r < n; ++r) rhs_[static_cast<std::size_t>(r)] /= at(r, 0);
    for (int r = n - 1; r >= 0; --r)
        for (int back = 1; back < width && back <= r; ++back)
            rhs_[static_cast<std::size_t>(r - back)] -= at(r, back) * rhs_[static_cast<std::size_t>(r)];
}

int LumenPress::solve(double h, int most)
{
    constexpr double still = 1e-3;  // of the clearance, in one step
    const int last = free();
    off.resize(places.size(), Complex(0));
    force.assign(places.size(), 0.0);
    if (last < 1) return 0;
    off.back() = 0;
    set_bending(h);
    int steps = 0;
    for (bool done = false; !done && steps < most; ++steps) {
        set_newton(h);
        const std::vector<double> descent = rhs_;
        factor_and_solve();
        double slope = 0;
        for (std::size_t r = 0; r < rhs_.size(); ++r) slope -= descent[r] * rhs_[r];
        const double start = energy(off, h);
        double part = 1;
        for (int cut = 0; cut < 12; ++cut, part *= 0.5) {
            tried_ = off;
            for (std::size_t i = 0; i + 1 < tried_.size(); ++i) tried_[i] += part * Complex(rhs_[2 * i], rhs_[2 * i + 1]);
            if (energy(tried_, h) <= start + 1e-4 * part * slope) break;
        }
        done = true;
        for (int i = 0; i < last; ++i) {
            const auto at = static_cast<std::size_t>(i);
            done = done && std::abs(tried_[at] - off[at]) <= still * places[at].clearance;
        }
        off.swap(tried_);
    }
    for (int i = 0; i < last; ++i) {
        const auto at = static_cast<std::size_t>(i);
        force[at] = give * h * std::max(0.0, std::abs(off[at]) - places[at].clearance);
    }
    return steps;
}

}  // namespace seldinger

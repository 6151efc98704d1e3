// Elimination of a compliant foundation's unknowns.
#include "math/condensed.h"

#include "core/check.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double guessed = 1e-6;  // accuracy of guess_own: less than Newton leaves
constexpr double single_from = 1e-8;  // own_accuracy from which W between rows may be rounded to 6e-8

using Vector = Eigen::Map<Eigen::VectorXd>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd>;

Eigen::Index index(std::size_t n) { return static_cast<Eigen::Index>(n); }
ConstVector view(std::span<const double> x) { return {x.data(), index(x.size())}; }
Vector view(std::span<double> x) { return {x.data(), index(x.size())}; }

/// Memory of a solve; one per thread.
struct Krylov {
    std::vector<double> basis, hessenberg, rotation, rhs, y;
};

/// Solves M u = b by GMRES without restarts; u holds b on entry. @param product  (v, M v)
/// @param accuracy  of the residual, relative to b. @return iterations taken
template <class Product>
int solve_gmres(std::span<double> u, double accuracy, const Product& product)
{
    thread_local Krylov work;
    const std::size_t m = u.size();
    const double size = view(u).norm();
    if (!(size > 0)) return 0;
    if (work.basis.size() < (m + 1) * m) {
        work.basis.resize((m + 1) * m);
        work.hessenberg.resize((m + 1) * m);  // column k: h[0..k+1] at k (m + 1)
        work.rotation.resize(2 * m);
        work.rhs.resize(m + 1);
        work.y.resize(m);
    }
    const auto vector = [&](std::size_t k) { return Vector(&work.basis[k * m], index(m)); };
    const auto values = [&](std::size_t k) { return std::span(&work.basis[k * m], m); };
    vector(0) = view(u) / size;
    work.rhs[0] = size;
    std::size_t taken = 0;
    while (taken < m) {
        const std::size_t k = taken++;
        product(std::span<const double>(values(k)), values(k + 1));
        Vector next = vector(k + 1);
        double* const h = &work.hessenberg[k * (m + 1)];
        const double whole = next.norm();
        for (std::size_t l = 0; l <= k; ++l) {  // modified Gram-Schmidt
            h[l] = vector(l).dot(next);
            next -= h[l] * vector(l);
        }
        h[k + 1] = next.norm();
        const bool last = !(h[k + 1] > 1e-14 * whole);  // nothing new: the solution is in the basis
        if (!last) next /= h[k + 1];
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
        if (last || std::abs(work.rhs[k + 1]) <= accuracy * size) break;
    }
    for (std::size_t k = taken; k-- > 0;) {
        double sum = work.rhs[k];
        for (std::size_t l = k + 1; l < taken; ++l) sum -= work.hessenberg[l * (m + 1) + k] * work.y[l];
        const double pivot = work.hessenberg[k * (m + 1) + k];
        work.y[k] = pivot != 0 ? sum / pivot : 0;
    }
    view(u).setZero();
    for (std::size_t k = 0; k < taken; ++k) view(u) += work.y[k] * vector(k);
    return static_cast<int>(taken);
}

}  // namespace

// ---- what is known ----

void KnownSolutions::combine(std::span<const double> b, std::span<double> u) const
{
    thread_local std::vector<double> left;
    left.assign(b.begin(), b.end());
    view(u).setZero();
    for (std::size_t k = 0; k < count_; ++k) {
        const ConstVector own = view(one(b_, k, b.size()));
        const double share = own.dot(view(std::span(left)));
        view(std::span(left)) -= share * own;
        view(u) += share * view(one(u_, k, b.size()));
    }
}

void KnownSolutions::add(std::span<const double> u, std::span<const double> b, double error)
{
    constexpr double rounding = 1e-13;  // of a product with some hundred rows and columns
    const double new_share = 10 * std::max(error, rounding);  // of b
    const std::size_t size = b.size();
    if (count_ == most) return;
    u_.resize(std::max(u_.size(), (count_ + 1) * size));
    b_.resize(u_.size());
    Vector own_u = view(one(u_, count_, size)), own_b = view(one(b_, count_, size));
    own_u = view(u);
    own_b = view(b);
    const double whole = own_b.norm();
    for (int pass = 0; pass < 2; ++pass)
        for (std::size_t k = 0; k < count_; ++k) {
            const ConstVector other = view(std::span<const double>(one(b_, k, size)));
            const double share = other.dot(own_b);
            own_b -= share * other;
            own_u -= share * view(std::span<const double>(one(u_, k, size)));
        }
    const double left = own_b.norm();
    if (!(left > new_share * whole)) return;
    own_b /= left;
    own_u /= left;
    ++count_;
}

// ---- made row by row ----

void Condensed::reset(int size, std::span<const double> compliance)
{
    SEL_ASSERT(compliance.size() == static_cast<std::size_t>(size) * size);
    size_ = size;
    w_ = compliance;
    factored_ = false;
    places_.clear();
    row_of_.assign(static_cast<std::size_t>(size), -1);
    for (SparseRows* rows : {&e_transposed, &f, &d}) rows->clear();
}

void Condensed::begin_row(int place)
{
    row_of_[static_cast<std::size_t>(place)] = static_cast<int>(places_.size());
    places_.push_back(place);
    for (SparseRows* rows : {&e_transposed, &f, &d}) rows->begin_row();
}

void Condensed::close()
{
    for (SparseRows::Entry& entry : d.entries()) {
        entry.unknown = row_of_[static_cast<std::size_t>(entry.unknown)];
        SEL_ASSERT(entry.unknown >= 0);
    }
    const std::size_t n = row_count();
    const bool single = n > most_direct && own_accuracy >= single_from;
    w_rows_.resize(single ? 0 : n * n);
    w_single_.resize(single ? n * n : 0);
    const auto gather = [&](auto* to) {
        for (std::size_t k = 0; k < n; ++k) {
            const double* from = &w_[static_cast<std::size_t>(places_[k]) * size_];
            for (std::size_t l = 0; l < n; ++l) to[k * n + l] = static_cast<std::decay_t<decltype(*to)>>(from[places_[l]]);
        }
    };
    if (single) gather(w_single_.data());
    else gather(w_rows_.data());
    if (n <= most_direct) known_.reset();
    else if (known_.use_count() == 1) known_->clear();
    else known_ = std::make_shared<KnownSolutions>();
}

void Condensed::take(const Condensed& other, int shift)
{
    const double own = accuracy;
    *this = other;
    accuracy = own;
    for (SparseRows* rows : {&e_transposed, &f})
        for (SparseRows::Entry& entry : rows->entries()) entry.unknown += shift;
}

// ---- parts ----

void Condensed::times_w(std::span<const double> v, std::span<double> wv) const
{
    view(wv).setZero();
    for (std::size_t k = 0; k < v.size(); ++k)  // W is symmetric: its rows are its columns
        if (v[k] != 0) view(wv) += v[k] * view(w_.subspan(k * v.size(), v.size()));
}

void Condensed::times_w_of_rows(std::span<const double> at_rows, std::span<double> wv) const
{
    view(wv).setZero();
    const std::size_t m = wv.size();
    for (std::size_t k = 0; k < row_count(); ++k)
        view(wv) += at_rows[k] * view(w_.subspan(static_cast<std::size_t>(places_[k]) * m, m));
}

void Condensed::at_rows(std::span<const double> all, std::span<double> rows) const
{
    for (std::size_t k = 0; k < row_count(); ++k) rows[k] = all[static_cast<std::size_t>(places_[k])];
}

void Condensed::factor_own() const
{
    const auto n = static_cast<int>(row_count());
    SmallMatrix matrix(n);
    for (int k = 0; k < n; ++k) matrix(k, k) = 1;
    for (int k = 0; k < n; ++k)
        for (const auto& [unknown, value] : d.row(static_cast<std::size_t>(k))) {
            const double* const w = &w_rows_[static_cast<std::size_t>(k) * row_count()];
            double* const to = &matrix(unknown, 0);
            for (int l = 0; l < n; ++l) to[l] += value * w[l];
        }
    own_.factor(matrix);
    factored_ = true;
}

void Condensed::times_w_rows(std::span<const double> v, std::span<double> out) const
{
    const std::size_t n = v.size();
    if (w_single_.empty()) {
        view(out).noalias() = ConstMatrix(w_rows_.data(), index(n), index(n)) * view(v);
        return;
    }
    view(out).setZero();
    const float* w = w_single_.data();  // symmetric: its rows are its columns
    std::size_t k = 0;
    double* const to = out.data();
    for (; k + 4 <= n; k += 4, w += 4 * n) {
        const double a = v[k], b = v[k + 1], c = v[k + 2], e = v[k + 3];
        for (std::size_t l = 0; l < n; ++l)
            to[l] += (a * double(w[l]) + b * double(w[n + l])) + (c * double(w[2 * n + l]) + e * double(w[3 * n + l]));
    }
    for (; k < n; ++k, w += n)
        for (std::size_t l = 0; l < n; ++l) to[l] += v[k] * double(w[l]);
}

/// (I + W D) u
void Condensed::own_product(std::span<const double> u, std::span<double> out) const
{
    thread_local std::vector<double> force;
    force.resize(u.size());
    d.times(u, force);
    times_w_rows(force, out);
    view(out) += view(u);
}

/// @param to  accuracy
void Condensed::solve_rows(std::span<double> u, double to) const
{
    if (u.size() <= most_direct) {
        if (!factored_) factor_own();
        own_.solve_transposed(u);
        return;
    }
    const auto product = [this](std::span<const double> v, std::span<double> out) { own_product(v, out); };
    thread_local std::vector<double> left, more;
    left.assign(u.begin(), u.end());
    more.resize(u.size());
    const double least = to * view(u).norm();
    view(u).setZero();
    if (!known_->empty()) {
        known_->combine(left, u);
        product(u, more);
        view(std::span(left)) -= view(std::span<const double>(more));
    }
    const double size = view(std::span(left)).norm();
    if (!(size > least)) return;
    more = left;
    solve_gmres(more, least / size, product);
    known_->add(more, left, least / size);
    view(u) += view(std::span<const double>(more));
}

void Condensed::guess_own(std::span<double> u) const
{
    thread_local std::vector<double> rows, force, given;
    rows.resize(row_count());
    force.resize(row_count());
    given.resize(u.size());
    at_rows(u, rows);
    solve_rows(rows, guessed);
    d.times(rows, force);
    times_w_of_rows(force, given);
    view(u) -= view(std::span<const double>(given));
    for (std::size_t k = 0; k < row_count(); ++k) u[static_cast<std::size_t>(places_[k])] = rows[k];
}

// ---- the whole ----

/// y -= E (I + W D)^-1 W (fx)
void Condensed::take_off(std::span<double> fx, std::span<double> y) const
{
    std::vector<double> u(fx.size());
    times_w_rows(fx, u);
    solve_rows(u);
    for (double& value : u) value = -value;
    e_transposed.add_transposed(u, y);
}

void Condensed::add_product(std::span<const double> x, std::span<double> y) const
{
    if (empty()) return;
    std::vector<double> fx(row_count());
    f.times(x, fx);
    take_off(fx, y);
}

void Condensed::add_column(int j, double x_j, std::span<double> y) const
{
    std::vector<double> fx(row_count());
    bool any = false;
    for (std::size_t k = 0; k < fx.size(); ++k)
        for (const auto& [unknown, value] : f.row(k))
            if (unknown == j) fx[k] += value * x_j, any = true;
    if (any) take_off(fx, y);
}

int Condensed::solve(std::span<double> r_to_x, std::span<const unsigned char> fixed,
                     const std::function<void(std::span<double>)>& band) const
{
    thread_local std::vector<double> along, fx, dv, u;
    const std::size_t m = row_count(), n = r_to_x.size();
    for (auto* array : {&fx, &dv, &u}) array->resize(m);
    along.resize(n);
    const auto off_fixed = [&] {
        for (std::size_t i = 0; i < n; ++i)
            if (fixed[i]) along[i] = 0;
    };
    // x of r, and its effect on u
    band(r_to_x);
    std::copy(r_to_x.begin(), r_to_x.end(), along.begin());
    off_fixed();
    f.times(along, fx);
    times_w_rows(fx, u);
    const auto spread = [&](std::span<const double> v) {
        std::fill(along.begin(), along.end(), 0.0);
        e_transposed.add_transposed(v, along);
        off_fixed();
        band(along);
        off_fixed();
    };
    const int iterations = solve_gmres(u, accuracy, [&](std::span<const double> v, std::span<double> out) {
        spread(v);
        f.times(along, fx);
        d.times(v, dv);
        view(std::span(dv)) -= view(std::span<const double>(fx));
        times_w_rows(dv, out);
        view(out) += view(v);
    });
    if (known_) {
        own_product(u, dv);
        known_->add(u, dv, 0);
    }
    spread(u);
    for (std::size_t i = 0; i < n; ++i) r_to_x[i] += along[i];
    return iterations;
}

}  // namespace seldinger

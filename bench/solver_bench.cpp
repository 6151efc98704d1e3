// Factorises and solves the Newton matrix of one wire: the engine's block-banded LDL^T and LU against Eigen's sparse
// SimplicialLDLT and LAPACK's band Cholesky dpbsv. One row of CSV per node count and solver, best of many repeats, with the slope
// of time against nodes.
//
//     solver_bench [most nodes] > solver.csv
//
// The matrix is that of a step of a millisecond of a bent guidewire (0.014 inch nitinol, edges of 3 mm), projected Hessian and
// inertia. Every solver gets it in its own storage before the clock starts; the clock has factorisation and one solve. Eigen's
// symbolic analysis is done once.

#include "rod/elastic.h"
#include "rod/rest_shape.h"
#include "math/band_matrix.h"

#include <fmt/format.h>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <vector>

#ifdef SEL_WITH_LAPACK
extern "C" void dpbsv_(const char* uplo, const int* n, const int* kd, const int* nrhs, double* ab, const int* ldab, double* b,
                       const int* ldb, int* info);
#endif

namespace {

using namespace seldinger;

constexpr int band = BandMatrix::half_bandwidth;

/// M/h^2 + d2E/dq2 of a wire of n nodes on an arc of 5 cm, the last node and the unused last angle held.
BandMatrix newton_matrix(int n)
{
    WireSpec spec;
    spec.length = 0.003 * (n - 1);
    spec.shaft = {
        .radius = 0.000178, .density = 6450, .bend_stiffness = 5.5e-5, .twist_stiffness = 4.2e-5, .stretch_stiffness = 6966};
    RodArrays arrays(std::vector<int>{n});
    arrays.set_node_count(0, n);
    const RodView rod = arrays.view(0);
    for (int i = 0; i < n; ++i) {
        const double s = 0.003 * i, radius = 0.05;
        rod.material_s[i] = s;
        rod.set_pos(i, {radius * std::sin(s / radius), radius * std::cos(s / radius), 0.1 * s});
    }
    initialise_frames(rod, Vec3::UnitZ());
    set_rest_shape(rod, spec, false);
    RodFrames frames(n);
    SEL_ASSERT(update_frames(rod, {rod.x, rod.y, rod.z, rod.theta}, {}, frames));
    BandMatrix matrix(4 * n);
    matrix.reset(4 * n);
    std::vector<double> gradient(4 * n);
    add_elastic(rod, {}, frames, gradient, &matrix, HessianMode::Projected);
    for (int i = 0; i < n; ++i) {
        for (int c = 0; c < 3; ++c) matrix.add(4 * i + c, 4 * i + c, rod.mass[i] / 1e-6);
        if (i < n - 1) matrix.add(4 * i + 3, 4 * i + 3, rod.spin_inertia[i] / 1e-6);
    }
    for (int c = 0; c < 4; ++c) matrix.fix(4 * (n - 1) + c);
    return matrix;
}

/// Shortest time of a call [s], of as many as fit into 0.3 s but at least five.
double best_time(const std::function<void()>& prepare, const std::function<void()>& call)
{
    using Clock = std::chrono::steady_clock;
    double best = 1e9, sum = 0;
    for (int k = 0; k < 5 || sum < 0.3; ++k) {
        prepare();
        const auto start = Clock::now();
        call();
        const double time = std::chrono::duration<double>(Clock::now() - start).count();
        best = std::min(best, time);
        sum += time;
    }
    return best;
}

/// |A x - b| / |b|
double residual(const BandMatrix& matrix, const std::vector<double>& x, const std::vector<double>& b)
{
    std::vector<double> y(b.size());
    matrix.multiply(x, y);
    double square = 0, scale = 0;
    for (std::size_t i = 0; i < b.size(); ++i) square += (y[i] - b[i]) * (y[i] - b[i]), scale += b[i] * b[i];
    return std::sqrt(square / scale);
}

struct Row {
    const char* solver;
    double time, residual;
};

std::vector<Row> time_all(int n)
{
    BandMatrix matrix = newton_matrix(n);
    const int size = matrix.size();
    std::vector<double> rhs(size), x(size);
    for (int i = 0; i < size; ++i) rhs[i] = i % 4 == 3 ? 1e-9 : 1e-5 * std::sin(0.1 * i);
    rhs[size - 1] = 0;
    const auto refill = [&] { x = rhs; };
    std::vector<Row> rows;
    double time = best_time(refill, [&] { matrix.factor_ldlt(), matrix.solve_ldlt(x); });
    rows.push_back({"own band LDL^T", time, residual(matrix, x, rhs)});
    bool regular = true;
    time = best_time(refill, [&] { regular = matrix.factor_lu() && regular, matrix.solve_lu(x); });
    rows.push_back({"own band LU", regular ? time : NAN, residual(matrix, x, rhs)});

    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < size; ++i)
        for (int j = std::max(0, i - band); j <= i; ++j)
            if (matrix.at(i, j) != 0) entries.emplace_back(i, j, matrix.at(i, j));
    Eigen::SparseMatrix<double> sparse(size, size);
    sparse.setFromTriplets(entries.begin(), entries.end());
    const Eigen::Map<const Eigen::VectorXd> b(rhs.data(), size);
    const auto time_sparse = [&](auto& solver, const char* name) {
        solver.analyzePattern(sparse);
        const double taken =
            best_time([] {}, [&] { solver.factorize(sparse), Eigen::Map<Eigen::VectorXd>(x.data(), size) = solver.solve(b); });
        rows.push_back({name, taken, residual(matrix, x, rhs)});
    };
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> natural;
    time_sparse(natural, "Eigen SimplicialLDLT, natural order");
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> ordered;
    time_sparse(ordered, "Eigen SimplicialLDLT, minimum degree");

#ifdef SEL_WITH_LAPACK
    std::vector<double> ab(static_cast<std::size_t>(band + 1) * size);
    const int width = band + 1, one = 1;
    int info = 0;
    const auto fill = [&] {
        x = rhs;
        for (int j = 0; j < size; ++j)  // lower half by columns
            for (int i = j; i <= std::min(size - 1, j + band); ++i)
                ab[static_cast<std::size_t>(width) * j + i - j] = matrix.at(i, j);
    };
    time = best_time(fill, [&] { dpbsv_("L", &size, &band, &one, ab.data(), &width, x.data(), &size, &info); });
    rows.push_back({"LAPACK dpbsv", info == 0 ? time : NAN, residual(matrix, x, rhs)});
#endif
    return rows;
}

}  // namespace

int main(int argc, char** argv)
{
    const int most = argc > 1 ? std::atoi(argv[1]) : 3200;
    fmt::print("nodes,solver,microseconds,microseconds_per_node,residual\n");
    for (int n = 100; n <= most; n *= 2)
        for (const Row& row : time_all(n))
            fmt::print("{},\"{}\",{:.2f},{:.4f},{:.1e}\n", n, row.solver, 1e6 * row.time, 1e6 * row.time / n, row.residual);
}

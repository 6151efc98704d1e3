#pragma once
// Compliance of an elastic wall under forces: factors of K + C/h, one per step length, and columns of their inverses. Constant
// matrices of one wall, shared by all systems.

#include "algebra/block_cholesky.h"
#include "shell/shell.h"

#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace seldinger {

/// Scratch of a solve; one per thread.
struct WallSolveWork {
    std::vector<double> x;
};

/// K + C/h, factored. const and safe to share between threads; the bits of every answer depend on the matrix alone.
class WallFactor {
public:
    /// In place: force [N] in, displacement [m] out, [3V]. Loads on held vertices are ignored, and they get 0.
    void solve(std::span<double> rhs, WallSolveWork& work) const;
    /// The same where it is asked for: see BlockCholesky::Partial.
    void begin(std::span<const double> force, BlockCholesky::Partial& partial) const { cholesky_.begin(force, partial); }
    void read(std::int32_t vertex, BlockCholesky::Partial& partial, double* to) const { cholesky_.read(vertex, partial, to); }
    /// Two at once, in one and a half times the time of one.
    void solve(std::span<double> rhs_a, std::span<double> rhs_b, WallSolveWork& work) const;
    /// Displacement [3V] under a unit force on a control vertex along x, y, z: [3][3V], one after the other. Solved for on first
    /// use, then kept in single precision: a wire comes to touch a thousand vertices. Zeros for a held vertex.
    [[nodiscard]] std::span<const float> columns(std::int32_t vertex) const;

    [[nodiscard]] double step() const { return h_; }
    [[nodiscard]] double factor_seconds() const { return seconds_; }
    [[nodiscard]] std::size_t entries() const { return cholesky_.entries(); }
    /// Known columns of the inverse, and the memory of columns and factor.
    [[nodiscard]] long solved_columns() const;
    [[nodiscard]] std::size_t bytes() const;

private:
    friend class WallCompliance;
    double h_ = 0, seconds_ = 0;
    BlockCholesky cholesky_;
    int vertex_count_ = 0;
    mutable std::mutex guard_;                                // of what follows
    mutable std::vector<double> work_, solved_;               // scratch of the columns' solves
    mutable std::vector<std::unique_ptr<float[]>> columns_;   // [V]
};

/// What the factors that are kept have taken.
struct WallCounts {
    double factor_seconds = 0;
    long columns = 0;       // of inverses
    std::size_t bytes = 0;  // of both
};

class WallCompliance {
public:
    WallCompliance(const Shell& shell, const PrestressAt& prestress = {});

    [[nodiscard]] int vertex_count() const { return static_cast<int>(matrices_.area.rows()); }
    [[nodiscard]] const ShellMatrices& matrices() const { return matrices_; }
    /// K and C [3V][3V], held rows and columns zero: for residuals, energies and losses.
    [[nodiscard]] const SparseMatrix& stiffness() const { return stiffness_; }
    [[nodiscard]] const SparseMatrix& damping() const { return damping_; }

    /// Factor of K + C/h; h = 0: K alone (equilibrium). The last few step lengths are kept, and as long as somebody holds them.
    /// Null when the matrix is not positive definite: the wall could fly away, or the pressure buckles it. A shorter step may
    /// have one, since C is not negative; a longer one has none.
    [[nodiscard]] std::shared_ptr<const WallFactor> factor(double h) const;
    [[nodiscard]] WallCounts counts() const;

private:
    ShellMatrices matrices_;
    SparseMatrix stiffness_, damping_;
    std::vector<double> along_;  // [V] distance from an end of the wall [m]
    mutable std::mutex guard_;
    mutable std::vector<std::shared_ptr<const WallFactor>> kept_;  // newest last
    mutable double no_step_ = std::numeric_limits<double>::infinity();  // known to have no factor, nor has a longer one [s]
};

}  // namespace seldinger

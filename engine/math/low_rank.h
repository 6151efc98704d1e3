#pragma once
// U C V^T: the part of a matrix that joins unknowns which its band does not. Columns of U and V are sparse, C is a sum of small
// dense blocks. A spring of stiffness K between nodes a and b: U = V = (e_a - e_b), three columns, C = K.

#include <Eigen/Dense>

#include <span>
#include <vector>

namespace seldinger {

class LowRank {
public:
    struct Entry {
        int unknown;
        double value;
    };

    /// Nothing is left of it; memory is kept.
    void clear();
    [[nodiscard]] bool empty() const { return rank_ == 0; }
    [[nodiscard]] int rank() const { return rank_; }

    /// A += U C U^T and A += U C V^T with U and V of one column for each row of C, given one after the other.
    void add(std::span<const std::vector<Entry>> u, const Eigen::MatrixXd& c) { add(u, c, u); }
    void add(std::span<const std::vector<Entry>> u, const Eigen::MatrixXd& c, std::span<const std::vector<Entry>> v);

    /// y += A x
    void add_product(std::span<const double> x, std::span<double> y) const;
    /// y += x_j times column j of A
    void add_column(int j, double x_j, std::span<double> y) const;

    /// V^T x, and U z into y (which is not cleared).
    [[nodiscard]] Eigen::VectorXd onto_v(std::span<const double> x) const;
    void from_u(const Eigen::VectorXd& z, std::span<double> y) const;
    [[nodiscard]] const Eigen::MatrixXd& c() const { return c_; }
    /// Rows i of U and V with drop[i] become 0: unknowns that are prescribed.
    void drop_rows(std::span<const unsigned char> drop);

private:
    int rank_ = 0;
    std::vector<std::vector<Entry>> u_, v_;  // [rank]
    Eigen::MatrixXd c_;                      // [rank][rank]
};

}  // namespace seldinger

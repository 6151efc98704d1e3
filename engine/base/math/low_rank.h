#pragma once
// U C V^T: the part of a matrix that joins unknowns which its band does not. Columns of U and V are sparse, C is a sum of small
// dense blocks. A spring of stiffness K between nodes a and b: U = V = (e_a - e_b), three columns, C = K.

#include <span>
#include <vector>

namespace seldinger {

class LowRank {
public:
    struct Entry {
        int unknown;
        double value;
    };
    using Column = std::vector<Entry>;

    /// Nothing is left of it.
    void clear();
    [[nodiscard]] bool empty() const { return u_.empty(); }
    [[nodiscard]] int rank() const { return static_cast<int>(u_.size()); }

    /// A += U C U^T and A += U C V^T.
    /// @param c  [columns][columns], row by row
    void add(std::span<const Column> u, std::span<const double> c);
    void add(std::span<const Column> u, std::span<const double> c, std::span<const Column> v);

    /// Whether V = U throughout.
    [[nodiscard]] bool same_sides() const { return same_sides_; }

    /// y += A x
    void add_product(std::span<const double> x, std::span<double> y) const;
    /// y += x_j times column j of A
    void add_column(int j, double x_j, std::span<double> y) const;

    /// z = V^T x, C z, and U z added to y; z and C z are [rank].
    void onto_v(std::span<const double> x, std::span<double> z) const;
    void times_c(std::span<const double> z, std::span<double> cz) const;
    void add_u(std::span<const double> z, std::span<double> y) const;
    [[nodiscard]] const Column& u(int k) const { return u_[k]; }
    [[nodiscard]] double c(int k, int l) const { return c_[static_cast<std::size_t>(k * rank() + l)]; }
    /// Rows i of U and V with drop[i] become 0: unknowns that are prescribed.
    void drop_rows(std::span<const unsigned char> drop);

private:
    std::vector<Column> u_, v_;  // [rank]
    std::vector<double> c_;      // [rank][rank]
    bool same_sides_ = true;
};

}  // namespace seldinger

// Products with U C V^T.

#include "math/low_rank.h"

#include "core/check.h"

namespace seldinger {

void LowRank::clear()
{
    rank_ = 0;
    u_.clear();
    v_.clear();
    c_.resize(0, 0);
}

void LowRank::add(std::span<const std::vector<Entry>> u, const Eigen::MatrixXd& c, std::span<const std::vector<Entry>> v)
{
    const int more = static_cast<int>(u.size());
    SEL_ASSERT(c.rows() == more && c.cols() == more && static_cast<int>(v.size()) == more);
    u_.insert(u_.end(), u.begin(), u.end());
    v_.insert(v_.end(), v.begin(), v.end());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rank_ + more, rank_ + more);
    all.topLeftCorner(rank_, rank_) = c_;
    all.bottomRightCorner(more, more) = c;
    c_ = all;
    rank_ += more;
}

Eigen::VectorXd LowRank::onto_v(std::span<const double> x) const
{
    Eigen::VectorXd z = Eigen::VectorXd::Zero(rank_);
    for (int k = 0; k < rank_; ++k)
        for (const auto& [unknown, value] : v_[k]) z[k] += value * x[unknown];
    return z;
}

void LowRank::from_u(const Eigen::VectorXd& z, std::span<double> y) const
{
    for (int k = 0; k < rank_; ++k)
        for (const auto& [unknown, value] : u_[k]) y[unknown] += value * z[k];
}

void LowRank::add_product(std::span<const double> x, std::span<double> y) const
{
    if (empty()) return;
    from_u(c_ * onto_v(x), y);
}

void LowRank::add_column(int j, double x_j, std::span<double> y) const
{
    Eigen::VectorXd z = Eigen::VectorXd::Zero(rank_);
    for (int k = 0; k < rank_; ++k)
        for (const auto& [unknown, value] : v_[k])
            if (unknown == j) z[k] += value * x_j;
    from_u(c_ * z, y);
}

void LowRank::drop_rows(std::span<const unsigned char> drop)
{
    for (auto* columns : {&u_, &v_})
        for (auto& column : *columns) std::erase_if(column, [&](const Entry& entry) { return drop[entry.unknown] != 0; });
}

}  // namespace seldinger

// Products with U C V^T.

#include "math/low_rank.h"

#include "core/check.h"

#include <algorithm>

namespace seldinger {

void LowRank::clear()
{
    u_.clear();
    v_.clear();
    c_.clear();
    same_sides_ = true;
}

void LowRank::add(std::span<const Column> u, std::span<const double> c)
{
    const bool same = same_sides_;
    add(u, c, u);
    same_sides_ = same;
}

void LowRank::add(std::span<const Column> u, std::span<const double> c, std::span<const Column> v)
{
    const std::size_t before = u_.size(), more = u.size(), all = before + more;
    SEL_ASSERT(c.size() == more * more && v.size() == more);
    std::vector<double> joined(all * all);
    for (std::size_t k = 0; k < before; ++k) std::copy_n(&c_[k * before], before, &joined[k * all]);
    for (std::size_t k = 0; k < more; ++k) std::copy_n(&c[k * more], more, &joined[(before + k) * all + before]);
    c_ = std::move(joined);
    u_.insert(u_.end(), u.begin(), u.end());
    v_.insert(v_.end(), v.begin(), v.end());
    same_sides_ = false;
}

void LowRank::onto_v(std::span<const double> x, std::span<double> z) const
{
    for (int k = 0; k < rank(); ++k) {
        z[k] = 0;
        for (const auto& [unknown, value] : v_[k]) z[k] += value * x[unknown];
    }
}

void LowRank::times_c(std::span<const double> z, std::span<double> cz) const
{
    for (int k = 0; k < rank(); ++k) {
        cz[k] = 0;
        for (int l = 0; l < rank(); ++l) cz[k] += c(k, l) * z[l];
    }
}

void LowRank::add_u(std::span<const double> z, std::span<double> y) const
{
    for (int k = 0; k < rank(); ++k)
        for (const auto& [unknown, value] : u_[k]) y[unknown] += value * z[k];
}

void LowRank::add_product(std::span<const double> x, std::span<double> y) const
{
    if (empty()) return;
    std::vector<double> z(u_.size()), cz(u_.size());
    onto_v(x, z);
    times_c(z, cz);
    add_u(cz, y);
}

void LowRank::add_column(int j, double x_j, std::span<double> y) const
{
    std::vector<double> z(u_.size()), cz(u_.size());
    for (int k = 0; k < rank(); ++k)
        for (const auto& [unknown, value] : v_[k])
            if (unknown == j) z[k] += value * x_j;
    times_c(z, cz);
    add_u(cz, y);
}

void LowRank::drop_rows(std::span<const unsigned char> drop)
{
    for (auto* columns : {&u_, &v_})
        for (Column& column : *columns) std::erase_if(column, [&](const Entry& entry) { return drop[entry.unknown] != 0; });
}

}  // namespace seldinger

#pragma once
// Vectors of space and of the plane, 3 x 3 matrices and boxes, in double precision.
//
// Plain values, so that a header that has a point in it costs nothing to read and a program that includes it needs no library.
// Methods have Eigen's names: a formula reads alike here and in the sources that use Eigen for linear algebra (math/eigen.h joins
// the two). Sums go from left to right, without fused operations, so that results do not depend on the processor.

#include <cmath>
#include <limits>

namespace seldinger {

/// Components in the plane.
class Vec2 {
public:
    Vec2() = default;
    Vec2(double x, double y) : v_{x, y} {}
    static Vec2 Zero() { return {0, 0}; }

    double& x() { return v_[0]; }
    double& y() { return v_[1]; }
    [[nodiscard]] double x() const { return v_[0]; }
    [[nodiscard]] double y() const { return v_[1]; }
    double& operator[](std::size_t i) { return v_[i]; }
    double operator[](std::size_t i) const { return v_[i]; }

    [[nodiscard]] double dot(const Vec2& b) const { return x() * b.x() + y() * b.y(); }
    [[nodiscard]] double squaredNorm() const { return dot(*this); }
    [[nodiscard]] double norm() const { return std::sqrt(squaredNorm()); }
    [[nodiscard]] bool isZero() const { return x() == 0 && y() == 0; }
    [[nodiscard]] bool allFinite() const { return std::isfinite(x()) && std::isfinite(y()); }

    Vec2& operator+=(const Vec2& b) { return *this = {x() + b.x(), y() + b.y()}; }
    Vec2& operator-=(const Vec2& b) { return *this = {x() - b.x(), y() - b.y()}; }
    Vec2& operator*=(double s) { return *this = {x() * s, y() * s}; }
    friend Vec2 operator+(Vec2 a, const Vec2& b) { return a += b; }
    friend Vec2 operator-(Vec2 a, const Vec2& b) { return a -= b; }
    friend Vec2 operator-(const Vec2& a) { return {-a.x(), -a.y()}; }
    friend Vec2 operator*(double s, Vec2 a) { return a *= s; }
    friend Vec2 operator*(Vec2 a, double s) { return a *= s; }
    friend Vec2 operator/(const Vec2& a, double s) { return {a.x() / s, a.y() / s}; }
    friend bool operator==(const Vec2&, const Vec2&) = default;

private:
    double v_[2];
};

/// A point or vector of space. Not set unless it is given.
class Vec3 {
public:
    Vec3() = default;
    Vec3(double x, double y, double z) : v_{x, y, z} {}
    /// The three numbers at `from`.
    explicit Vec3(const double* from) : v_{from[0], from[1], from[2]} {}
    static Vec3 Zero() { return {0, 0, 0}; }
    static Vec3 Constant(double c) { return {c, c, c}; }
    static Vec3 UnitX() { return {1, 0, 0}; }
    static Vec3 UnitY() { return {0, 1, 0}; }
    static Vec3 UnitZ() { return {0, 0, 1}; }
    static Vec3 Unit(int i) { return {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0}; }

    double& x() { return v_[0]; }
    double& y() { return v_[1]; }
    double& z() { return v_[2]; }
    [[nodiscard]] double x() const { return v_[0]; }
    [[nodiscard]] double y() const { return v_[1]; }
    [[nodiscard]] double z() const { return v_[2]; }
    double& operator[](std::size_t i) { return v_[i]; }
    double operator[](std::size_t i) const { return v_[i]; }
    [[nodiscard]] double* data() { return v_; }
    [[nodiscard]] const double* data() const { return v_; }
    [[nodiscard]] const double* begin() const { return v_; }
    [[nodiscard]] const double* end() const { return v_ + 3; }
    void store(double* to) const { to[0] = v_[0], to[1] = v_[1], to[2] = v_[2]; }

    [[nodiscard]] double dot(const Vec3& b) const { return x() * b.x() + y() * b.y() + z() * b.z(); }
    [[nodiscard]] Vec3 cross(const Vec3& b) const
    {
        return {y() * b.z() - z() * b.y(), z() * b.x() - x() * b.z(), x() * b.y() - y() * b.x()};
    }
    [[nodiscard]] double squaredNorm() const { return dot(*this); }
    [[nodiscard]] double norm() const { return std::sqrt(squaredNorm()); }
    /// Unit vector; a zero vector stays zero.
    [[nodiscard]] Vec3 normalized() const
    {
        const double square = squaredNorm();
        return square > 0 ? *this / std::sqrt(square) : *this;
    }
    void normalize() { *this = normalized(); }
    /// A unit vector across.
    [[nodiscard]] Vec3 unitOrthogonal() const
    {
        const double least = 1e-12 * std::abs(z());
        if (std::abs(x()) > least || std::abs(y()) > least) {
            const double inverse = 1 / std::sqrt(x() * x() + y() * y());
            return {-y() * inverse, x() * inverse, 0};
        }
        const double inverse = 1 / std::sqrt(y() * y() + z() * z());
        return {0, -z() * inverse, y() * inverse};
    }
    [[nodiscard]] double sum() const { return x() + y() + z(); }
    [[nodiscard]] double maxCoeff() const { return larger(larger(x(), y()), z()); }
    [[nodiscard]] double minCoeff() const { return smaller(smaller(x(), y()), z()); }
    [[nodiscard]] Vec3 cwiseAbs() const { return {std::abs(x()), std::abs(y()), std::abs(z())}; }
    [[nodiscard]] Vec3 cwiseMin(const Vec3& b) const { return {smaller(x(), b.x()), smaller(y(), b.y()), smaller(z(), b.z())}; }
    [[nodiscard]] Vec3 cwiseMax(const Vec3& b) const { return {larger(x(), b.x()), larger(y(), b.y()), larger(z(), b.z())}; }
    [[nodiscard]] Vec3 cwiseProduct(const Vec3& b) const { return {x() * b.x(), y() * b.y(), z() * b.z()}; }
    [[nodiscard]] Vec3 cwiseQuotient(const Vec3& b) const { return {x() / b.x(), y() / b.y(), z() / b.z()}; }
    [[nodiscard]] bool allFinite() const { return std::isfinite(x()) && std::isfinite(y()) && std::isfinite(z()); }
    [[nodiscard]] bool isZero() const { return x() == 0 && y() == 0 && z() == 0; }
    void setZero() { *this = Zero(); }

    Vec3& operator+=(const Vec3& b) { return *this = {x() + b.x(), y() + b.y(), z() + b.z()}; }
    Vec3& operator-=(const Vec3& b) { return *this = {x() - b.x(), y() - b.y(), z() - b.z()}; }
    Vec3& operator*=(double s) { return *this = {x() * s, y() * s, z() * s}; }
    Vec3& operator/=(double s) { return *this = *this / s; }
    friend Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
    friend Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
    friend Vec3 operator-(const Vec3& a) { return {-a.x(), -a.y(), -a.z()}; }
    friend Vec3 operator*(double s, Vec3 a) { return a *= s; }
    friend Vec3 operator*(Vec3 a, double s) { return a *= s; }
    friend Vec3 operator/(const Vec3& a, double s) { return {a.x() / s, a.y() / s, a.z() / s}; }
    friend bool operator==(const Vec3&, const Vec3&) = default;

private:
    static double smaller(double a, double b) { return b < a ? b : a; }
    static double larger(double a, double b) { return a < b ? b : a; }

    double v_[3];
};

/// Adds to the three numbers at `to`.
inline void add_to(double* to, const Vec3& v) { to[0] += v[0], to[1] += v[1], to[2] += v[2]; }

/// Stored column by column. Not set unless it is given.
class Mat3 {
public:
    Mat3() = default;
    static Mat3 Zero() { return Constant(0); }
    static Mat3 Constant(double c) { return columns(Vec3::Constant(c), Vec3::Constant(c), Vec3::Constant(c)); }
    static Mat3 Identity() { return columns(Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()); }
    static Mat3 columns(const Vec3& a, const Vec3& b, const Vec3& c)
    {
        Mat3 m;
        m.column_[0] = a, m.column_[1] = b, m.column_[2] = c;
        return m;
    }
    static Mat3 rows(const Vec3& a, const Vec3& b, const Vec3& c)
    {
        return columns({a.x(), b.x(), c.x()}, {a.y(), b.y(), c.y()}, {a.z(), b.z(), c.z()});
    }

    double& operator()(std::size_t i, std::size_t j) { return column_[j][i]; }
    double operator()(std::size_t i, std::size_t j) const { return column_[j][i]; }
    Vec3& col(std::size_t j) { return column_[j]; }
    [[nodiscard]] const Vec3& col(std::size_t j) const { return column_[j]; }
    [[nodiscard]] Vec3 row(std::size_t i) const { return {column_[0][i], column_[1][i], column_[2][i]}; }
    [[nodiscard]] const double* data() const { return column_[0].data(); }
    [[nodiscard]] double* data() { return column_[0].data(); }

    [[nodiscard]] Mat3 transpose() const { return columns(row(0), row(1), row(2)); }
    /// Frobenius.
    [[nodiscard]] double norm() const
    {
        return std::sqrt(column_[0].squaredNorm() + column_[1].squaredNorm() + column_[2].squaredNorm());
    }
    /// By cofactors: not for matrices that are nearly singular.
    [[nodiscard]] Mat3 inverse() const
    {
        const Vec3 a = column_[1].cross(column_[2]), b = column_[2].cross(column_[0]), c = column_[0].cross(column_[1]);
        const double inverse = 1 / a.dot(column_[0]);
        return rows(a * inverse, b * inverse, c * inverse);
    }
    [[nodiscard]] bool isZero() const { return column_[0].isZero() && column_[1].isZero() && column_[2].isZero(); }
    [[nodiscard]] bool allFinite() const { return column_[0].allFinite() && column_[1].allFinite() && column_[2].allFinite(); }

    Mat3& operator+=(const Mat3& b)
    {
        for (std::size_t j = 0; j < 3; ++j) column_[j] += b.column_[j];
        return *this;
    }
    Mat3& operator-=(const Mat3& b)
    {
        for (std::size_t j = 0; j < 3; ++j) column_[j] -= b.column_[j];
        return *this;
    }
    Mat3& operator*=(double s)
    {
        for (Vec3& column : column_) column *= s;
        return *this;
    }
    friend Mat3 operator+(Mat3 a, const Mat3& b) { return a += b; }
    friend Mat3 operator-(Mat3 a, const Mat3& b) { return a -= b; }
    friend Mat3 operator-(const Mat3& a) { return columns(-a.column_[0], -a.column_[1], -a.column_[2]); }
    friend Mat3 operator*(double s, Mat3 a) { return a *= s; }
    friend Mat3 operator*(Mat3 a, double s) { return a *= s; }
    friend Mat3 operator/(const Mat3& a, double s) { return columns(a.column_[0] / s, a.column_[1] / s, a.column_[2] / s); }
    friend Vec3 operator*(const Mat3& a, const Vec3& v)
    {
        return a.column_[0] * v[0] + a.column_[1] * v[1] + a.column_[2] * v[2];
    }
    friend Mat3 operator*(const Mat3& a, const Mat3& b) { return columns(a * b.column_[0], a * b.column_[1], a * b.column_[2]); }
    friend bool operator==(const Mat3&, const Mat3&) = default;

private:
    Vec3 column_[3];
};

/// a b^T
[[nodiscard]] inline Mat3 outer(const Vec3& a, const Vec3& b) { return Mat3::columns(a * b[0], a * b[1], a * b[2]); }

/// v x (.) as a matrix.
[[nodiscard]] inline Mat3 skew(const Vec3& v) { return Mat3::rows({0, -v.z(), v.y()}, {v.z(), 0, -v.x()}, {-v.y(), v.x(), 0}); }

/// A box with sides along the axes; empty until something is in it.
class Box3 {
public:
    Box3() = default;
    Box3(const Vec3& min, const Vec3& max) : min_(min), max_(max) {}

    [[nodiscard]] const Vec3& min() const { return min_; }
    [[nodiscard]] const Vec3& max() const { return max_; }
    Vec3& min() { return min_; }
    Vec3& max() { return max_; }
    void extend(const Vec3& p) { min_ = min_.cwiseMin(p), max_ = max_.cwiseMax(p); }
    void extend(const Box3& b) { min_ = min_.cwiseMin(b.min_), max_ = max_.cwiseMax(b.max_); }
    [[nodiscard]] bool isEmpty() const { return min_.x() > max_.x() || min_.y() > max_.y() || min_.z() > max_.z(); }
    [[nodiscard]] bool contains(const Vec3& p) const { return min_.cwiseMin(p) == min_ && max_.cwiseMax(p) == max_; }
    /// How far a point is outside; 0 inside.
    [[nodiscard]] double exteriorDistance(const Vec3& p) const { return (p - p.cwiseMax(min_).cwiseMin(max_)).norm(); }
    [[nodiscard]] Vec3 center() const { return (min_ + max_) / 2; }
    [[nodiscard]] Vec3 diagonal() const { return max_ - min_; }

private:
    Vec3 min_ = Vec3::Constant(std::numeric_limits<double>::max());
    Vec3 max_ = Vec3::Constant(-std::numeric_limits<double>::max());
};

}  // namespace seldinger

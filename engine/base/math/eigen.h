#pragma once
// The program's own small vectors beside Eigen's: for sources that do linear algebra, and never for headers.

#include "math/vec3.h"

#include <Eigen/Core>

namespace seldinger {

[[nodiscard]] inline Eigen::Map<Eigen::Vector3d> eigen(Vec3& v) { return Eigen::Map<Eigen::Vector3d>(v.data()); }
[[nodiscard]] inline Eigen::Map<const Eigen::Vector3d> eigen(const Vec3& v)
{
    return Eigen::Map<const Eigen::Vector3d>(v.data());
}
[[nodiscard]] inline Eigen::Map<Eigen::Matrix3d> eigen(Mat3& m) { return Eigen::Map<Eigen::Matrix3d>(m.data()); }
[[nodiscard]] inline Eigen::Map<const Eigen::Matrix3d> eigen(const Mat3& m)
{
    return Eigen::Map<const Eigen::Matrix3d>(m.data());
}

template <class Derived>
[[nodiscard]] Vec3 to_vec3(const Eigen::MatrixBase<Derived>& v)
{
    Vec3 out;
    eigen(out) = v;
    return out;
}
template <class Derived>
[[nodiscard]] Mat3 to_mat3(const Eigen::MatrixBase<Derived>& m)
{
    Mat3 out;
    eigen(out) = m;
    return out;
}

}  // namespace seldinger

#pragma once
// A point or vector of space, in double precision.

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross

namespace seldinger {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

}  // namespace seldinger

#pragma once
// A point or vector of space, in double precision.
//
// Files for AVX-512 and files for any x86-64 are linked into one program (CMakeLists.txt, SELDINGER_NATIVE), and of a template that both
// have compiled the linker keeps one. Eigen aligns fixed-size types and the memory it takes by what the compiler may use, unless it is told:
// a product whose memory was taken by the one (16 bytes) and packed by the other (aligned stores of 64) ends the program.

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross

static_assert(EIGEN_MAX_STATIC_ALIGN_BYTES == 16 && EIGEN_DEFAULT_ALIGN_BYTES == 64,
    "define EIGEN_MAX_STATIC_ALIGN_BYTES=16 and EIGEN_MAX_ALIGN_BYTES=64, as the CMake target Seldinger::seldinger does");

namespace seldinger {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

}  // namespace seldinger

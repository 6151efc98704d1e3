#pragma once
// Kernel files that are built together. A program costs 50 ms at the start of a process even where its kernels are compiled on
// disk, so that what every step launches is one.

namespace seldinger::programs {

inline constexpr const char* quadrature = "contact/near_wall.cl+contact/evaluation.cl+contact/edge_sums.cl";
inline constexpr const char* layer = "contact/layer.cl+contact/edge_sums.cl";
inline constexpr const char* multipliers = "contact/multipliers.cl";
inline constexpr const char* instruments = "contact/instruments.cl";
inline constexpr const char* barrier = "contact/barrier_path.cl";

}  // namespace seldinger::programs

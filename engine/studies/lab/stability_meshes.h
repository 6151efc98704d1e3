#pragma once
// Walls of the stability maps that no generated shape gives: written as mesh files (PLY, mm), so that a cell takes the way that a
// user's mesh takes, import and repair included. A file that is there already stays.

#include <filesystem>
#include <string>

namespace seldinger {

inline constexpr double carina_radius = 0.004;  // of the trunk [m]

/// The maps' bend (arc of 3 cm, lumen 4 mm, about 3,000 triangles), a share of its triangles spoilt: in equal parts doubled,
/// turned round, missing (single ones) and cut into slivers. The same triangles every time.
void write_damaged_mesh(const std::filesystem::path& folder, double share);
[[nodiscard]] std::string damaged_mesh_name(double share);

/// A trunk along x that forks after 3 cm into two branches at 35 degrees to either side, in the plane z = 0.
void write_carina_mesh(const std::filesystem::path& folder);
[[nodiscard]] std::string carina_mesh_name();

/// A tube along x of 3 mm radius, narrowed over 1 cm to `throat` [m]. @param value  names the file
void write_stenosis_mesh(const std::filesystem::path& folder, double throat, double value);
[[nodiscard]] std::string stenosis_mesh_name(double value);

/// Two tubes along x, one below the other, with `thickness` [m] between their walls. @param value  names the file
void write_septum_mesh(const std::filesystem::path& folder, double thickness, double value);
[[nodiscard]] std::string septum_mesh_name(double value);

}  // namespace seldinger

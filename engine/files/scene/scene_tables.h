#pragma once
// What a scene takes from tables of measurements: stiffness along an instrument (bend_table), the drive of a robot (log).

#include "io/number_table.h"
#include "scene/scene.h"

#include <optional>
#include <string>

namespace seldinger {

/// Properties between the tip and the hub, linear between rows, and beyond the first and the last row as there. Two rows at one
/// place are a jump.
struct BendTable {
    std::vector<double> from_tip;                 // [m]
    std::vector<double> bend, twist, stretch, mass;  // [N m^2], [N m^2], [N], [kg/m]; but the first empty: not measured
};
/// @param length  of the wire [m]   @throws Error BadFile
[[nodiscard]] BendTable read_bend_table(const std::filesystem::path& file, double length);
/// Puts it in from `begin` to `end`: sections within which stiffness changes by at most a tenth, each with the table's compliance
/// and mass, and with all else of the wire as it is there.
void take_bend_table(const BendTable& table, double begin, double end, WireSpec& wire);

/// Keys from the log of a robot: the fewest whose lines pass all rows within the noise of its encoders.
/// @param length  of the wire  @param said  what was made of it  @throws Error BadFile
[[nodiscard]] std::vector<FeedKey> read_feed_log(const std::filesystem::path& file, double length, std::string& said);

}  // namespace seldinger

#pragma once
// Quantities with a unit on the command line: "0.2mm", "5%", "60".

#include <string>

namespace seldinger::apps {

/// @param option  named in messages, "--tolerance"
/// @return metres, above 0. @throws Error BadScene: no number, no unit or another than um, mm, cm, m, in
[[nodiscard]] double parse_length(const std::string& option, const std::string& text);

/// @return pascals, above 0. @throws Error BadScene: no number, no unit or another than kPa, Pa, MPa
[[nodiscard]] double parse_pressure(const std::string& option, const std::string& text);

/// @return newtons, above 0. @throws Error BadScene: no number, no unit or another than N, mN, uN
[[nodiscard]] double parse_force(const std::string& option, const std::string& text);

/// @return newtons per metre, above 0. @throws Error BadScene: no number, no unit or another than N/m, mN/mm
[[nodiscard]] double parse_load(const std::string& option, const std::string& text);

struct ForceTolerance {
    double value = 0;
    bool relative = true;  // else [N]
};
/// A share in % or a force in N, mN or uN; above 0. @throws Error BadScene
[[nodiscard]] ForceTolerance parse_force_tolerance(const std::string& option, const std::string& text);

}  // namespace seldinger::apps

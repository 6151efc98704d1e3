// Parses quantities of the command line; a missing or unknown unit is an error that lists the known ones.
#include "quantity.h"

#include "core/error.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

namespace seldinger::apps {
namespace {

using Unit = std::pair<std::string_view, double>;

/// @return the number and the index of its unit
std::pair<double, std::size_t> parse(const std::string& option, const std::string& text, std::span<const Unit> units,
                                     const char* example)
{
    const auto fail = [&](const std::string& what) -> std::pair<double, std::size_t> {
        throw Error(ErrorKind::BadScene, fmt::format("{} {}: {}; write for example {}", option, text, what, example));
    };
    double number = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (problem != std::errc() || !std::isfinite(number)) return fail("expected a number with its unit");
    std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
    while (unit.starts_with(' ')) unit.remove_prefix(1);
    if (!(number > 0)) return fail("expected a number above 0");
    std::string known;
    for (std::size_t k = 0; k < units.size(); ++k) {
        if (unit == units[k].first) return {number * units[k].second, k};
        known += (known.empty() ? "" : ", ") + std::string(units[k].first);
    }
    return fail(unit.empty() ? fmt::format("has no unit; expected one of {}", known)
                             : fmt::format("unknown unit \"{}\"; expected one of {}", unit, known));
}

}  // namespace

double parse_length(const std::string& option, const std::string& text)
{
    static constexpr Unit units[] = {{"mm", 1e-3}, {"um", 1e-6}, {"cm", 1e-2}, {"m", 1.0}, {"in", 0.0254}};
    return parse(option, text, units, "0.2mm").first;
}

double parse_pressure(const std::string& option, const std::string& text)
{
    static constexpr Unit units[] = {{"kPa", 1e3}, {"Pa", 1.0}, {"MPa", 1e6}};
    return parse(option, text, units, "80kPa").first;
}

double parse_force(const std::string& option, const std::string& text)
{
    static constexpr Unit units[] = {{"N", 1.0}, {"mN", 1e-3}, {"uN", 1e-6}};
    return parse(option, text, units, "50mN").first;
}

double parse_load(const std::string& option, const std::string& text)
{
    static constexpr Unit units[] = {{"mN/mm", 1.0}, {"N/m", 1.0}, {"mN/m", 1e-3}};
    return parse(option, text, units, "20mN/mm").first;
}

ForceTolerance parse_force_tolerance(const std::string& option, const std::string& text)
{
    static constexpr Unit units[] = {{"%", 1e-2}, {"N", 1.0}, {"mN", 1e-3}, {"uN", 1e-6}};
    const auto [value, unit] = parse(option, text, units, "5%");
    return {value, unit == 0};
}

}  // namespace seldinger::apps

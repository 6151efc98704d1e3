// The usual wire, bend and feeds of the stability maps.
#include "lab/stability_parts.h"

#include <fmt/format.h>
#include <cmath>

namespace seldinger::stability_parts {
namespace {

/// First, middle and last.
std::vector<double> few(const std::vector<double>& values) { return {values.front(), values[values.size() / 2], values.back()}; }

}  // namespace

std::string head(const char* name)
{
    return fmt::format("[scene]\nname = \"stability: {}\"\ndt_s = 0.001\nduration_s = {}\n", name, duration);
}

Texts feed(double length, double time, double pace, double start)
{
    return {fmt::format("scene.duration_s={}", time * pace),
            fmt::format("feed.keys=[{{t_s=0.0, advance_m={}}}, {{t_s={}, advance_m={}}}]", start, time * pace, start + length)};
}

Texts fed(double pace, Texts more)
{
    Texts texts = feed(0.04, duration, pace, bend_start);
    texts.insert(texts.end(), more.begin(), more.end());
    return texts;
}

std::vector<double> decades(double from, double to, int per_decade)
{
    std::vector<double> values;
    const int count = static_cast<int>(std::lround(std::log10(to / from) * per_decade));
    for (int k = 0; k <= count; ++k) values.push_back(from * std::pow(10.0, static_cast<double>(k) / per_decade));
    return values;
}

StabilityMap map_of(const char* name, const char* rows, const char* title, const char* axis, std::vector<double> values)
{
    StabilityMap map;
    map.name = name;
    map.rows = rows;
    map.title = title;
    map.axis = axis;
    map.values = std::move(values);
    map.quick_values = few(map.values);
    map.scene = head(name) + wire;
    return map;
}

StabilityMap fed_map(const char* name, const char* rows, const char* title, const char* axis, std::vector<double> values)
{
    StabilityMap map = map_of(name, rows, title, axis, std::move(values));
    map.scene += bend;
    return map;
}

StabilityMap fed_by(const char* name, const char* rows, const char* title, const char* axis, std::vector<double> values,
                    std::function<Texts(double)> set)
{
    StabilityMap map = fed_map(name, rows, title, axis, std::move(values));
    map.set = [set = std::move(set)](double value, double, double pace, const fs::path&) { return fed(pace, set(value)); };
    return map;
}

}  // namespace seldinger::stability_parts

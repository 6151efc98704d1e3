// Maps of several instruments: inside each other (F20) and beside each other (F21).
#include "lab/stability_parts.h"

#include <fmt/format.h>

namespace seldinger::stability_parts {
namespace {

namespace fs = std::filesystem;

/// A catheter of 5 F and a wire of 0.035 inch in it, fed together round the bend, the wire ahead of the catheter and back again.
StabilityMap inside_each_other(const char* name, const char* title, const char* model)
{
    StabilityMap map = map_of(name, "F20", title, "wire's over catheter's bending stiffness", decades(1e-2, 1e2));
    map.scene = head(name) + R"(
[[instrument]]
name = "catheter"
length_m = 0.08
radius_m = 0.000833
lumen_radius_m = 0.00055
density = 1230.0
bend_nm2 = 1.0e-4
twist_nm2 = 7.7e-5
stretch_n = 1.2e3
nodes = 33

[[instrument.section]]
from_tip_m = [0.0, 0.01]
rest_curvature_1_m = [60.0, 0.0]

[instrument.feed]
inlet = "auto"
keys = [ {t_s = 0.0, advance_m = 0.0} ]

[[instrument]]
name = "wire"
length_m = 0.1
radius_m = 0.0004445
density = 7900.0
bend_nm2 = 1.0e-4
twist_nm2 = 7.7e-5
stretch_n = 1.0e4
nodes = 41

[instrument.feed]
keys = [ {t_s = 0.0, advance_m = 0.0} ]

[coaxial]
order = ["catheter", "wire"]
)" + fmt::format("model = \"{}\"\n", model) +
                std::string(bend).substr(0, std::string(bend).find("[feed]"));
    map.static_load = map.hand_is_steady = false;  // a wire that is drawn back lets the catheter's tip go
    map.set = [](double value, double, double pace, const fs::path&) {
        const double end = duration * pace;
        return Texts{
            fmt::format("scene.duration_s={}", end),
            fmt::format("instrument.0.feed.keys=[{{t_s=0.0, advance_m={0}}}, {{t_s={1}, advance_m={2}}}]", bend_start, end, 0.05),
            fmt::format(
                "instrument.1.feed.keys=[{{t_s=0.0, advance_m={0}}}, {{t_s={1}, advance_m={2}}}, {{t_s={3}, advance_m={4}}}]",
                bend_start, 0.6 * end, 0.06, end, 0.03),
            fmt::format("instrument.1.bend_nm2={}", 1e-4 * value), fmt::format("instrument.1.twist_nm2={}", 7.7e-5 * value)};
    };
    return map;
}

StabilityMap coaxial_separate()
{
    return inside_each_other("coaxial", "a wire so many times as stiff goes through a catheter round a bend and back",
                             "separate");
}
StabilityMap coaxial_merged()
{
    return inside_each_other("coaxial-merged", "the same as one centreline with two spins", "merged");
}

constexpr double there = 0.03, pushed = 0.003;  // of each wire: inside at the start, straight; and so much more by the end [m]

/// Their tips are held, so fed length has to find room: the wires buckle against each other and the wall. The hands push
/// with 1 N (6 radii) to 11 N (2.1).
StabilityMap channel()
{
    StabilityMap map = map_of("channel", "F21", "two wires, held at their tips, are pushed together in a channel",
                              "lumen over wire radius", {2.1, 2.3, 2.6, 3, 4, 6});
    map.logarithmic = false;
    const auto one = [](const char* name) {
        return fmt::format(
            "[[instrument]]\nname = \"{0}\"\nlength_m = 0.08\nradius_m = 0.0004445\ndensity = 7900.0\nbend_nm2 = 1.0e-5\n"
            "twist_nm2 = 7.7e-6\nstretch_n = 1.0e4\nnodes = 65\n[instrument.feed]\npoint = [0.0, 0.0, 0.0]\n"
            "direction = [1.0, 0.0, 0.0]\nkeys = [ {{t_s = 0.0, advance_m = {1}}} ]\n"
            "[[hold]]\ninstrument = \"{0}\"\nat = \"tip\"\nposition = true\n",
            name, there);
    };
    map.scene = head("channel") + one("left") + one("right") + "[contact]\ninstruments = true\n" +
                "[vessel]\nshape = \"tube\"\nradius_m = 0.002\nlength_m = 0.05\norigin = [-0.005, 0.0, 0.0]\ntriangles = "
                "3000\nyoungs_pa = 1e6\n";
    map.static_load = map.hand_is_steady = false;  // wires that buckle snap
    map.set = [](double value, double, double pace, const fs::path&) {
        const double end = duration * pace;
        Texts texts = {fmt::format("scene.duration_s={}", end), fmt::format("vessel.radius_m={}", value * radius)};
        for (int k = 0; k < 2; ++k) {
            texts.push_back(fmt::format("instrument.{}.feed.point=[0.0, {}, 0.0]", k, (k ? -1.02 : 1.02) * radius));
            texts.push_back(fmt::format("instrument.{}.feed.keys=[{{t_s=0.0, advance_m={}}}, {{t_s={}, advance_m={}}}]", k, there,
                                        end, there + pushed));
        }
        return texts;
    };
    return map;
}

}  // namespace

std::vector<StabilityMap> instrument_maps() { return {coaxial_separate(), coaxial_merged(), channel()}; }

}  // namespace seldinger::stability_parts

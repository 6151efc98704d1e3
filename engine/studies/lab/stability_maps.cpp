// The maps: failure rows F1 ... F21 as small scenes. A wire of 0.9 mm, 8 cm long, does the row's motion in 2/3 s. Most rows use
// one scene, fed round a bend whose outer wall it meets at once. Sizes are chosen so that a cell costs a fraction of a second at
// 1 ms.
#include "lab/stability.h"
#include "lab/stability_meshes.h"
#include "lab/stability_parts.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

using namespace stability_parts;

// ---- a free rod ---------------------------------------------------------------------------------------------------------------

StabilityMap axial()
{
    StabilityMap map = map_of("axial", "F1", "a cantilever is let go level; explicit steps meet the axial wave",
                              "stretching stiffness [N]", decades(1e-2, 1e4));
    map.touches = map.static_load = false;
    map.scene +=
        "place = { shape = \"straight\", base = [0.0, 0.0, 0.0], direction = [1.0, 0.0, 0.0] }\n"
        "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nspin = true\n";
    map.set = [](double value, double, double, const fs::path&) { return Texts{fmt::format("wire.stretch_n={}", value)}; };
    return map;
}

StabilityMap fold()
{
    StabilityMap map = map_of("fold", "F16", "a straight wire, bent by so much at every node, springs open",
                              "turning per edge [degrees]", {10, 30, 60, 90, 120, 150, 170});
    map.touches = map.static_load = map.logarithmic = false;
    map.scene +=
        "place = { shape = \"arc\", base = [0.0, 0.0, 0.0], direction = [1.0, 0.0, 0.0], bend_radius_m = 1.0 }\n"
        "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nspin = true\n";
    // 8 edges, each turned against the last; energy of a fold is bounded, so a soft wire
    map.set = [](double value, double, double, const fs::path&) {
        const double edge = 0.08 / 8;
        return Texts{"wire.nodes=9", "wire.bend_nm2=1e-6", "wire.twist_nm2=7.7e-7",
                     fmt::format("wire.place.bend_radius_m={}", edge / (value * std::numbers::pi / 180))};
    };
    return map;
}

StabilityMap twist()
{
    StabilityMap map = map_of("twist", "F16", "the base turns, the tip is held: spin per edge far beyond pi",
                              "turning of the base, per edge [rad]", {0.03, 0.1, 0.3, 1, 3, 10});
    map.touches = map.static_load = false;
    map.scene +=
        "place = { shape = \"straight\", base = [0.0, 0.0, 0.0], direction = [1.0, 0.0, 0.0] }\n"
        "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nspin = true\nturn = [[0.0, 0.0], [1.0, 0.0]]\n"
        "[[hold]]\nat = \"tip\"\nposition = true\ndirection = true\nspin = true\n";
    map.set = [](double value, double, double, const fs::path&) {
        return Texts{fmt::format("hold.0.turn=[[0.0, 0.0], [{}, {}]]", duration, 32 * value)};
    };
    return map;
}

// ---- fed round a bend ---------------------------------------------------------------------------------------------------------

StabilityMap stiffness()
{
    return fed_by("stiffness", "F2 F3", "contact stiffness, by the wall's modulus", "stiffness of the wall, of nominal",
                  decades(0.1, 1e3, 2), [](double value) { return Texts{fmt::format("vessel.youngs_pa={}", 1e6 * value)}; });
}

StabilityMap speed()
{
    StabilityMap map = fed_map("speed", "F4", "fed round the bend, then held; at 1 m/s a step of 1/30 s is 75 radii long",
                               "feed speed [m/s]", decades(1e-3, 1, 2));
    map.static_load = false;  // a tip at 1 m/s hits
    // the slow ones do not get far: the wall is a twentieth of a millimetre ahead; the fast ones come to a halt after 4 cm, which
    // is watched too
    map.set = [](double value, double, double pace, const fs::path&) {
        constexpr double start = 0.0162;
        const double length = std::min(0.04, value * duration), time = length / value;
        std::string keys = fmt::format("{{t_s=0.0, advance_m={}}}, {{t_s={}, advance_m={}}}", start, time * pace, start + length);
        return Texts{fmt::format("scene.duration_s={}", duration * pace), fmt::format("feed.keys=[{}]", keys)};
    };
    return map;
}

StabilityMap bending()
{
    return fed_by("bending", "F11", "bending stiffness, from a thread to a rod; EA stays", "bending stiffness [N m^2]",
                  decades(1e-7, 1e-2), [](double value) {
                      return Texts{fmt::format("wire.bend_nm2={}", value), fmt::format("wire.twist_nm2={}", 0.77 * value)};
                  });
}

StabilityMap ratio()
{
    return fed_by("ratio", "F11", "a tip so many times softer than the shaft", "shaft over tip stiffness", decades(1, 1e4),
                  [](double value) {
                      return Texts{"wire.bend_nm2=1e-3", "wire.twist_nm2=7.7e-4",
                                   fmt::format("wire.section=[{{from_tip_m=[0.0, 0.02], bend_nm2={}, twist_nm2={}}}]",
                                               1e-3 / value, 7.7e-4 / value)};
                  });
}

StabilityMap friction()
{
    StabilityMap map = fed_by("friction", "F8", "friction; sgn(v) chatters", "sliding friction coefficient",
                              {0, 0.05, 0.1, 0.2, 0.4, 0.7, 1}, [](double value) {
                                  return Texts{fmt::format("contact.mu_sliding={}", value),
                                               fmt::format("contact.mu_static={}", std::min(1.0, 1.2 * value))};
                              });
    map.logarithmic = false;
    return map;
}

StabilityMap spacing()
{
    return fed_by("spacing", "F5", "edges against the bend's radius of 12 mm", "edge length over bend radius",
                  {0.05, 0.1, 0.2, 0.4, 0.8, 1.6}, [](double value) {
                      const long nodes = std::max(3L, std::lround(0.08 / (value * 0.012)) + 1);
                      return Texts{fmt::format("wire.nodes={}", nodes), "wire.bend_nm2=1e-5",     "wire.twist_nm2=7.7e-6",
                                   "vessel.bend_radius_m=0.012",        "vessel.angle_deg=150.0", "vessel.radius_m=0.003"};
                  });
}

StabilityMap offset()
{
    StabilityMap map =
        fed_by("offset", "F14", "the scene stands so far from the origin", "distance from the origin [m]", {0, 0.1, 1, 10, 100},
               [](double value) { return Texts{fmt::format("vessel.origin=[{0}, {0}, {0}]", value / std::sqrt(3.0))}; });
    map.logarithmic = false;
    return map;
}

StabilityMap strokes()
{
    StabilityMap map = fed_map("strokes", "F15", "push 3 cm, then pull and push 5 mm, so many times a second",
                               "strokes per second [1/s]", {0.5, 1, 2, 4, 8, 16});
    map.static_load = map.hand_is_steady = false;  // a hand that turns round at once hits
    map.set = [](double value, double, double, const fs::path&) {
        std::string keys = "{t_s=0.0, advance_m=0.0155}, {t_s=0.4, advance_m=0.045}";
        const double half = 0.5 / value, end = 0.4 + std::max(duration, 1 / value);
        int k = 1;
        for (double t = 0.4 + half; t < end + half / 2; t += half, ++k)
            keys += fmt::format(", {{t_s={}, advance_m={}}}", t, k % 2 ? 0.04 : 0.045);
        return Texts{fmt::format("scene.duration_s={}", end), fmt::format("feed.keys=[{}]", keys)};
    };
    return map;
}

StabilityMap whip()
{
    StabilityMap map =
        fed_map("whip", "F9", "a curved tip is turned in the bend and lets go", "tip curvature [1/m]", {1, 25, 50, 100, 200});
    map.static_load = false;  // torque is stored and released
    map.logarithmic = false;
    map.set = [](double value, double, double, const fs::path&) {
        const double end = 0.4 + duration;
        return Texts{
            fmt::format("scene.duration_s={}", end),
            fmt::format("feed.keys=[{{t_s=0.0, advance_m=0.0, turn_rad=0.0}}, {{t_s=0.4, advance_m=0.05, turn_rad=0.0}}, "
                        "{{t_s={}, advance_m=0.05, turn_rad={}}}]",
                        end, 4 * std::numbers::pi),
            fmt::format(
                "wire.section=[{{from_tip_m=[0.0, 0.015], bend_nm2=1e-5, twist_nm2=7.7e-6, rest_curvature_1_m=[{}, 0.0]}}]",
                value)};
    };
    return map;
}

// ---- other walls --------------------------------------------------------------------------------------------------------------

StabilityMap triangles()
{
    StabilityMap map = fed_map("triangles", "F5", "fed round a narrow bend whose facets are so large",
                               "triangle's leg over wire radius", {0.1, 0.25, 0.6, 1.5, 4, 9, 20});
    // a lumen of 4 radii; at 20 an arc of 120 degrees is left with four facets along and eight around it
    map.set = [](double value, double, double pace, const fs::path&) {
        constexpr double leg = 20 * radius, lumen = 4 * radius;  // of the coarsest
        constexpr double length = leg / 2 + 4 * leg + leg / 2, least_around = 8;
        const double around = std::max(least_around, 2 * std::numbers::pi * lumen / (value * radius));
        Texts texts = feed(0.036, duration, pace, 0.006);
        texts.insert(texts.end(),
                     {"wire.length_m=0.05", "wire.nodes=41", "wire.bend_nm2=1e-5", "wire.twist_nm2=7.7e-6",
                      fmt::format("vessel.radius_m={}", lumen),
                      fmt::format("vessel.bend_radius_m={}", 4 * leg / (2 * std::numbers::pi / 3)), "vessel.angle_deg=120.0",
                      fmt::format("vessel.lead_in_m={}", leg / 2), fmt::format("vessel.lead_out_m={}", leg / 2),
                      fmt::format("vessel.triangles={}", std::lround(2 * around * length / (value * radius)))});
        return texts;
    };
    return map;
}

/// An aorta's wall of modulus `youngs`, on a control mesh of 1.5 mm; the wire's edges are at most as long.
Texts elastic(double youngs, Texts more)
{
    more.insert(more.end(), {"vessel.wall=elastic", fmt::format("vessel.youngs_pa={}", youngs)});
    return more;
}

// A wire as soft as a tip: a stiffer one pushes the softer of these walls away by more than 20 % of the lumen's radius
StabilityMap soft_wall()
{
    constexpr double nominal = 0.4e6;  // of a thoracic aorta [Pa]
    return fed_by("soft-wall", "F18", "fed round a bend with an elastic wall", "modulus of the wall, of nominal",
                  decades(1e-2, 1e2), [](double value) {
                      return elastic(nominal * value, {"vessel.thickness_m=0.00082", "vessel.wall_edge_m=0.0015", "wire.nodes=65",
                                                       "wire.bend_nm2=1e-5", "wire.twist_nm2=7.7e-6"});
                  });
}

StabilityMap snug()
{
    StabilityMap map = fed_map("snug", "F19", "a wire is fed into a soft bent tube that is hardly wider than it",
                               "bending stiffness, of 1e-4 N m^2", decades(1, 100, 2));
    map.static_load = false;  // the tube's bend presses, not a load; the wire's radius is the limit
    // 35 mm on a circle of half a metre, a lumen of 1.2 radii, 0.1 MPa: the wire straightens the tube by at most 0.33 mm
    map.set = [](double value, double, double pace, const fs::path&) {
        Texts texts = feed(0.03, duration, pace, 0.006);
        texts.insert(texts.end(), {"wire.length_m=0.045", "wire.nodes=46", fmt::format("wire.bend_nm2={}", 1e-4 * value),
                                   fmt::format("wire.twist_nm2={}", 7.7e-5 * value),
                                   fmt::format("vessel.radius_m={}", 1.2 * radius), "vessel.bend_radius_m=0.5",
                                   "vessel.angle_deg=4.0", "vessel.lead_out_m=0.005", "vessel.thickness_m=0.0002"});
        return elastic(1e5, std::move(texts));
    };
    return map;
}

StabilityMap approach()
{
    StabilityMap map =
        map_of("approach", "F7", "a wire comes down on a floor so slowly, and lies", "approach speed [m/s]", decades(1e-6, 1));
    map.static_load = false;  // the fast ones hit
    map.scene +=
        "place = { shape = \"straight\", base = [-0.04, 0.0, 0.0004495], direction = [1.0, 0.0, 0.0] }\nvelocity_m_s = [0.0, "
        "0.0, 0.0]\n"
        "[vessel]\nshape = \"plane\"\nnormal = [0.0, 0.0, 1.0]\nsize_m = 0.1\ntriangles = 200\nyoungs_pa = 1e6\n";
    map.set = [](double value, double, double, const fs::path&) {
        // 5 um above the floor; no weight would be felt for 1 ms on the way, so it starts at its speed
        return Texts{fmt::format("wire.velocity_m_s=[0.0, 0.0, {}]", -value)};
    };
    return map;
}

StabilityMap buckling()
{
    StabilityMap map = map_of("buckling", "F10", "a wire in a tube, its tip held, is pushed 8 mm: sinusoidal, then helical",
                              "tube radius over wire radius", {1.5, 2, 4, 8, 16});
    map.scene +=
        "place = { shape = \"straight\", base = [0.01, 0.0, 0.0], direction = [1.0, 0.0, 0.0] }\n"
        "[[hold]]\nat = \"tip\"\nposition = true\n"
        "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nspin = true\nmove = [[0.0, 0.0, 0.0, 0.0]]\n"
        "[vessel]\nshape = \"tube\"\nradius_m = 0.004\nlength_m = 0.1\ntriangles = 3000\nyoungs_pa = 1e6\n";
    map.set = [](double value, double, double pace, const fs::path&) {
        return Texts{fmt::format("vessel.radius_m={}", value * radius), "wire.bend_nm2=1e-5", "wire.twist_nm2=7.7e-6",
                     fmt::format("scene.duration_s={}", duration * pace),
                     fmt::format("hold.1.move=[[0.0, 0.0, 0.0, 0.0], [{}, 0.008, 0.0, 0.0]]", duration * pace)};
    };
    return map;
}

StabilityMap alternating()
{
    StabilityMap map = map_of("alternating", "F17", "a side load that turns round at every step", "load [N]", decades(1e-3, 10));
    map.static_load = map.hand_is_steady = false;
    map.scene +=
        "place = { shape = \"straight\", base = [0.01, 0.0, 0.0], direction = [1.0, 0.0, 0.0] }\n"
        "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nspin = true\n"
        "[[link]]\nat = 0.02\nanchor = [0.07, 0.0, 0.0]\nstiffness_n_m = 1.0\nmove = [[0.0, 0.0, 0.0, 0.0]]\n"
        "[vessel]\nshape = \"tube\"\nradius_m = 0.002\nlength_m = 0.1\ntriangles = 3000\nyoungs_pa = 1e6\n";
    // a soft spring to an anchor a metre off is a force that hardly knows where the wire is
    map.set = [](double value, double dt, double, const fs::path&) {
        std::string rows;
        const long steps = std::min(200L, std::lround(duration / dt));
        for (long k = 0; k <= steps; ++k)
            rows += fmt::format("{}[{}, 0.0, {}, {}]", k ? ", " : "", static_cast<double>(k) * dt, k % 2 ? 0.8 : -0.8,
                                k % 2 ? 0.6 : -0.6);
        return Texts{fmt::format("scene.duration_s={}", static_cast<double>(steps) * dt),
                     fmt::format("link.0.stiffness_n_m={}", value), fmt::format("link.0.move=[{}]", rows)};
    };
    return map;
}

// ---- walls of a file ----------------------------------------------------------------------------------------------------------

std::string file_vessel(const char* feed_point, const char* direction)
{
    return fmt::format(
        "[vessel]\nmesh = \"mesh.ply\"\nunits = \"mm\"\nyoungs_pa = 1e6\n"
        "[feed]\npoint = {}\ndirection = {}\nkeys = [ {{t_s = 0.0, advance_m = 0.0}} ]\n",
        feed_point, direction);
}

Texts with_mesh(Texts texts, const fs::path& folder, const std::string& mesh)
{
    texts.push_back(fmt::format("vessel.mesh='{}'", std::filesystem::absolute(folder / mesh).string()));
    return texts;
}

StabilityMap damage()
{
    StabilityMap map = map_of("damage", "F6", "so many of the wall's triangles are doubled, flipped, missing or slivers",
                              "share of spoilt triangles", {0, 0.01, 0.02, 0.05, 0.1, 0.2});
    map.logarithmic = false;
    map.scene += file_vessel("[0.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]");
    map.set = [](double value, double, double pace, const fs::path& folder) {
        return with_mesh(fed(pace), folder, damaged_mesh_name(value));
    };
    map.write_meshes = [values = map.values](const fs::path& folder) {
        for (const double value : values) write_damaged_mesh(folder, value);
    };
    return map;
}

StabilityMap carina()
{
    StabilityMap map = map_of("carina", "F9", "a tip meets a carina, so far off its middle, bends and prolapses",
                              "tip off the carina's middle, of the lumen's radius", {0, 0.05, 0.1, 0.2, 0.4});
    map.logarithmic = false;
    map.scene += file_vessel("[0.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]");
    map.set = [](double value, double, double pace, const fs::path& folder) {
        Texts texts = feed(0.06, duration, pace);
        texts.insert(texts.end(), {fmt::format("feed.point=[0.0, {}, 0.0]", value * carina_radius), "wire.bend_nm2=1e-5",
                                   "wire.twist_nm2=7.7e-6"});
        return with_mesh(std::move(texts), folder, carina_mesh_name());
    };
    map.write_meshes = write_carina_mesh;
    return map;
}

StabilityMap stenosis()
{
    StabilityMap map = map_of("stenosis", "F12", "pushed at a throat that may be narrower than the wire",
                              "throat over wire radius", {0.6, 0.8, 0.95, 1.05, 1.2, 1.5, 2});
    map.logarithmic = false;
    map.static_load = false;  // overlap is what is asked for here; the radius is the limit
    map.scene += file_vessel("[0.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]");
    map.set = [](double value, double, double pace, const fs::path& folder) {
        Texts texts = feed(0.04, duration, pace);
        texts.insert(texts.end(), {"wire.bend_nm2=1e-5", "wire.twist_nm2=7.7e-6"});
        return with_mesh(std::move(texts), folder, stenosis_mesh_name(value));
    };
    map.write_meshes = [values = map.values](const fs::path& folder) {
        for (const double value : values) write_stenosis_mesh(folder, value * radius, value);
    };
    return map;
}

StabilityMap septum()
{
    StabilityMap map = map_of("septum", "F13", "two lumens side by side: the neighbour's wall must not push",
                              "thickness of the common wall over wire radius", {0.05, 0.2, 0.5, 1, 2});
    map.scene += file_vessel("[0.0, 0.0, 0.0]", "[0.995, 0.0, -0.1]");
    map.set = [](double value, double, double pace, const fs::path& folder) {
        Texts texts = feed(0.05, duration, pace);
        texts.insert(texts.end(), {"wire.bend_nm2=1e-5", "wire.twist_nm2=7.7e-6"});
        return with_mesh(std::move(texts), folder, septum_mesh_name(value));
    };
    map.write_meshes = [values = map.values](const fs::path& folder) {
        for (const double value : values) write_septum_mesh(folder, value * radius, value);
    };
    return map;
}

}  // namespace

const std::vector<StabilityMap>& stability_maps()
{
    static const std::vector<StabilityMap> maps = [] {
        std::vector<StabilityMap> all = {axial(),    stiffness(),   speed(),     triangles(), spacing(),  damage(),
                                         approach(), friction(),    carina(),    whip(),      buckling(), bending(),
                                         ratio(),    stenosis(),    septum(),    offset(),    strokes(),  fold(),
                                         twist(),    alternating(), soft_wall(), snug()};
        for (StabilityMap& map : instrument_maps()) all.push_back(std::move(map));
        return all;
    }();
    return maps;
}

}  // namespace seldinger

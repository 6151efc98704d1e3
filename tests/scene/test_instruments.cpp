// The catalogue: every instrument is read, is what its bending test or its geometry says, moves in a tube, and has its row in
// docs/instruments.md.
#include "core/error.h"
#include "engine.h"
#include "setup/key_frames.h"
#include "scene/instruments.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "setup/vessel_load.h"
#include "support/approx.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

namespace seldinger::test::test_instruments {

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file)
{
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

/// 12 cm of an instrument, half of it in a tube of 10 mm radius that it is fed into slightly downhill.
std::string tube_scene(const std::string& name)
{
    return fmt::format(R"([scene]
duration_s = 0.05
dt_s = 0.001
[wire]
preset = "{}"
length_m = 0.12
nodes = 61
[vessel]
shape = "tube"
radius_m = 0.01
length_m = 0.2
triangles = 2000
[feed]
point = [0.0, 0.0, -0.004]
direction = [1.0, 0.0, -0.05]
keys = [ {{t_s = 0.0, advance_m = 0.05}}, {{t_s = 0.05, advance_m = 0.052}} ]
)",
                       name);
}

const Instrument& find(const std::vector<Instrument>& all, const std::string& name)
{
    const auto found = std::find_if(all.begin(), all.end(), [&](const Instrument& i) { return i.name == name; });
    REQUIRE_MESSAGE(found != all.end(), name);
    return *found;
}

/// Angle [rad] by which the sections with rest curvature turn the tip.
double rest_angle(const WireSpec& wire)
{
    double angle = 0;
    for (const WireSectionRange& range : wire.sections) angle += range.section.rest_curvature[0] * (range.end - range.begin);
    return angle;
}

}  // namespace

TEST_SUITE("scene/instruments")
{
    TEST_CASE("property: every file is an instrument whose numbers can be")
    {
        const std::vector<Instrument> all = instruments();
        REQUIRE(all.size() >= 12);
        std::set<std::string> kinds;
        for (const Instrument& instrument : all) {
            CAPTURE(instrument.name);
            kinds.insert(instrument.kind);
            CHECK(!instrument.title.empty());
            const WireSpec& wire = instrument.wire;
            CHECK((wire.lumen_radius > 0) == (instrument.kind != "wire"));
            std::vector<WireSection> parts = {wire.shaft};
            for (const WireSectionRange& range : wire.sections) {
                CHECK(range.end <= 0.5);  // a tip, not a shaft in disguise
                parts.push_back(range.section);
            }
            for (const WireSection& part : parts) {
                // a round rod of one material has C/B = 1/(1 + nu), 2/3 to 1 for 0 <= nu <= 1/2; sections are rounded to two
                // digits
                CHECK(part.twist_stiffness / part.bend_stiffness >= 0.65);
                CHECK(part.twist_stiffness / part.bend_stiffness <= 1.01);
                // no round section of radius r has more than B = EA r^2/2 (a thin tube) ...
                CHECK(part.bend_stiffness <= part.stretch_stiffness * part.radius * part.radius / 2);
                // ... nor is it stiffer than solid steel (210 GPa) or heavier than platinum
                CHECK(part.bend_stiffness <= 210e9 * std::numbers::pi * std::pow(part.radius, 4) / 4);
                CHECK(part.density >= 1000);
                CHECK(part.density <= 21450);
                CHECK(part.mu_static >= part.mu_sliding);
                CHECK(part.bend_stiffness <= wire.shaft.bend_stiffness);  // nothing is stiffer than the shaft
            }
        }
        CHECK(kinds == std::set<std::string>{"wire", "catheter", "sheath"});
    }

    TEST_CASE("analytic: stiffness of measured wires is their flexural modulus times pi d^4/64")
    {
        const std::vector<Instrument> all = instruments();
        const double area_moment = std::numbers::pi * std::pow(0.035 * 0.0254, 4) / 64;
        // Harrison et al. 2011, doi:10.1583/11-3592.1; the files are rounded to three digits
        CHECK(find(all, "lunderquist-035").wire.shaft.bend_stiffness == test::about(158.4e9 * area_moment).epsilon(0.005));
        CHECK(find(all, "amplatz-super-stiff-035").wire.shaft.bend_stiffness ==
              test::about(60.3e9 * area_moment).epsilon(0.005));
    }

    TEST_CASE("analytic: shapes turn the tip by the angles that their files say")
    {
        const std::vector<Instrument> all = instruments();
        const auto degrees = [&](const char* name) { return rest_angle(find(all, name).wire) * 180 / std::numbers::pi; };
        // curvatures are rounded to three digits: half a degree
        CHECK(degrees("terumo-angled-035") == test::about(50).epsilon(0.02));
        CHECK(degrees("pigtail-5f") == test::about(344).epsilon(0.01));
        CHECK(degrees("judkins-right-4-5f") == test::about(120).epsilon(0.01));
        CHECK(degrees("cobra-2-5f") == test::about(170).epsilon(0.01));
        CHECK(degrees("vertebral-5f") == test::about(45).epsilon(0.01));
        CHECK(degrees("simmons-1-5f") == test::about(145).epsilon(0.01));
        CHECK(degrees("bentson-035") == 0);
    }

    TEST_CASE("property: every instrument moves 50 steps in a tube and stays inside")
    {
        const std::vector<std::string> names = instrument_names();
        std::vector<Scene> scenes;
        for (const std::string& name : names) scenes.push_back(read_scene_text(tube_scene(name), "tube.toml"));
        // wires that do not know of each other, in one world: its kernels are built once
        World world(make_setup(scenes, load_vessel(scenes[0].vessel), -1));
        const KeyFrames keys(scenes);
        for (int i = 0; i < 50; ++i) REQUIRE_FALSE(step(world, keys.control(), scenes[0].dt).failed());
        const Output now = world.output();
        REQUIRE(now.wires.size() == names.size());
        // it is a tube that they are in: some lie on it
        CHECK(std::any_of(now.wires.begin(), now.wires.end(), [](const WireOutput& wire) { return wire.readings.contacts > 0; }));
        for (std::size_t i = 0; i < names.size(); ++i) {
            CAPTURE(names[i]);
            REQUIRE(now.wires[i].position.size() > 10);
            for (const Vec3& at : now.wires[i].position) CHECK(std::hypot(at.y(), at.z()) < 0.01);  // not of what is not a number
        }
    }

    TEST_CASE("property: a wire shorter than its instrument's tip is the far end of it")
    {
        const auto read = [](const std::string& length) {
            return read_scene_text(
                       "integrator.scheme = \"static\"\n[wire]\npreset = \"lunderquist-035\"\nlength_m = " + length + "\n",
                       "short.toml")
                .wire;
        };
        CHECK(read("1.5").sections.size() == 2);
        const WireSpec cut = read("0.08");
        REQUIRE(cut.sections.size() == 2);
        CHECK(cut.sections[1].end == 0.08);
        const WireSpec tip = read("0.05");
        REQUIRE(tip.sections.size() == 1);
        CHECK(tip.sections[0].end == 0.05);
        CHECK(tip.at(0.05).bend_stiffness == 5e-5);
    }

    TEST_CASE("property: docs/instruments.md has a row for each, with its diameter and the ends of its stiffness")
    {
        const std::string docs = text_of(fs::path(SEL_SOURCE_DIR) / "docs/instruments.md");
        std::set<std::string> rows;
        std::istringstream lines(docs);
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with("| `")) rows.insert(line.substr(3, line.find('`', 3) - 3));
        const std::vector<std::string> names = instrument_names();
        CHECK(rows == std::set<std::string>(names.begin(), names.end()));
        for (const Instrument& instrument : instruments()) {
            CAPTURE(instrument.name);
            const auto at = docs.find("| `" + instrument.name + "` |");
            REQUIRE(at != std::string::npos);
            const std::string row = docs.substr(at, docs.find('\n', at) - at);
            CHECK(row.find(fmt::format(" {:.2f} mm", 2e3 * instrument.wire.shaft.radius)) != std::string::npos);
            double low = instrument.wire.shaft.bend_stiffness;
            for (const WireSectionRange& range : instrument.wire.sections) low = std::min(low, range.section.bend_stiffness);
            for (const double stiffness : {low, instrument.wire.shaft.bend_stiffness}) {
                // 4.86e-3 as people write it
                std::string text = fmt::format("{:g}", stiffness / std::pow(10, std::floor(std::log10(stiffness) + 1e-9)));
                text += fmt::format("e{:d}", static_cast<int>(std::floor(std::log10(stiffness) + 1e-9)));
                CHECK_MESSAGE(row.find(text) != std::string::npos, text);
            }
        }
    }
}

}  // namespace seldinger::test::test_instruments

// Scenes made of several files: presets and what overrides them, includes, and every way to get either wrong.
#include "core/error.h"
#include "scene/instruments.h"
#include "scene/scene.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace seldinger::test::test_scene_layers {

namespace {

namespace fs = std::filesystem;

const std::string timing = "[scene]\nduration_s = 1.0\ndt_s = 0.001\n";
const std::string shaft = "radius_m = 0.0004\ndensity = 7900.0\nbend_nm2 = 1e-4\ntwist_nm2 = 8e-5\nstretch_n = 1e4\n";

Scene read(const std::string& text, const std::vector<std::string>& sets = {})
{
    return read_scene_text(text, "scene.toml", sets);
}

template <class Read>
void check_error(const Read& reading, const std::vector<std::string>& says)
{
    check_refused(reading, says, ErrorKind::BadScene);
}

const Instrument& lunderquist()
{
    static const std::vector<Instrument> all = instruments();
    return *std::find_if(all.begin(), all.end(), [](const Instrument& i) { return i.name == "lunderquist-035"; });
}

std::string note_of(const Scene& scene, const std::string& key)
{
    std::string all;
    for (const auto& [name, value] : scene.notes)
        if (name == key) all += (all.empty() ? "" : ", ") + value;
    return all;
}

}  // namespace

TEST_SUITE("scene/scene_layers")
{
    TEST_CASE("property: a preset brings its keys in, keys beside it win")
    {
        const Scene plain = read(timing + "[wire]\npreset = \"lunderquist-035\"\nlength_m = 1.0\n");
        CHECK(plain.wire.shaft == lunderquist().wire.shaft);
        REQUIRE(plain.wire.sections.size() == lunderquist().wire.sections.size());
        for (std::size_t i = 0; i < plain.wire.sections.size(); ++i)
            CHECK(plain.wire.sections[i].section == lunderquist().wire.sections[i].section);
        CHECK(note_of(plain, "wire.preset") == "lunderquist-035");

        const Scene other = read(timing +
                                 "[wire]\nlength_m = 1.0\nmu_sliding = 0.01\npreset = \"lunderquist-035\"\ndensity = 5000.0\n"
                                 "[[wire.section]]\nfrom_tip_m = [0.0, 0.02]\nbend_nm2 = 1e-6\n");
        CHECK(other.wire.shaft.density == 5000);
        CHECK(other.wire.shaft.mu_sliding == 0.01);
        CHECK(other.wire.shaft.bend_stiffness == lunderquist().wire.shaft.bend_stiffness);
        REQUIRE(other.wire.sections.size() == 1);  // the list as a whole
        CHECK(other.wire.sections[0].section.bend_stiffness == 1e-6);
        CHECK(other.wire.sections[0].section.density == 5000);
    }

    TEST_CASE("property: a material beside a preset takes the place of its three stiffnesses")
    {
        const Scene scene = read(
            timing +
            "[wire]\npreset = \"vertebral-5f\"\nlength_m = 1.0\nyoungs_pa = 2e9\n[[wire.section]]\nfrom_tip_m = [0.0, 0.01]\n");
        CHECK(scene.wire.shaft.youngs == 2e9);
        CHECK(scene.wire.lumen_radius == 0.00055);
    }

    TEST_CASE("property: a preset on the command line takes the place of the scene's instrument")
    {
        const std::string text = timing + "[wire]\nlength_m = 1.0\nnodes = 51\nlumen_radius_m = 0.0001\n" + shaft +
                                 "[[wire.section]]\nfrom_tip_m = [0.0, 0.3]\nbend_nm2 = 1e-6\n";
        const Scene scene = read(text, {"wire.mu_sliding=0.02", "wire.preset=lunderquist-035"});
        CHECK(scene.wire.shaft.bend_stiffness == lunderquist().wire.shaft.bend_stiffness);
        CHECK(scene.wire.shaft.mu_sliding == 0.02);  // --set is said of the new instrument, wherever it stands
        CHECK(scene.wire.nodes == 51);               // how it is modelled stays
        CHECK(scene.wire.lumen_radius == 0);
        CHECK(scene.wire.sections.size() == lunderquist().wire.sections.size());
        // over a scene's own preset, and the last one wins
        const std::string preset = timing + "[wire]\nlength_m = 1.0\npreset = \"pigtail-5f\"\n";
        const Scene last = read(preset, {"wire.preset=bentson-035", "wire.preset=lunderquist-035"});
        CHECK(last.wire.shaft == lunderquist().wire.shaft);
        CHECK(note_of(last, "wire.preset") == "lunderquist-035");
        // a section that the preset brought can be reached
        const Scene reached = read(preset, {"wire.preset=lunderquist-035", "wire.section.0.bend_nm2=7e-6"});
        CHECK(reached.wire.sections[0].section.bend_stiffness == 7e-6);
    }

    TEST_CASE("property: the scene as written back is complete and reads the same")
    {
        const TemporaryFolder files;
        files.write("parts/wire.toml", "[wire]\npreset = \"cobra-2-5f\"\nlength_m = 1.0\n");
        const fs::path file =
            files.write("scene.toml", "include = \"parts/wire.toml\"\n" + timing + "[wire]\nmu_sliding = 0.11\n");
        const Scene scene = read_scene(file);
        const std::string text = write_scene(scene, files.path());
        CHECK_FALSE(has(text, "preset"));
        CHECK_FALSE(has(text, "include"));
        CHECK(has(text, "lumen_radius_m = 0.00055\n"));
        const Scene again = read_scene_text(text, file);
        CHECK(again.wire.lumen_radius == 0.00055);
        CHECK(again.wire.shaft == scene.wire.shaft);
        CHECK(write_scene(again, files.path()) == text);
    }

    TEST_CASE("property: an included file is under what the scene says, key by key")
    {
        const TemporaryFolder files;
        files.write("common/base.toml",
                    "[scene]\nduration_s = 5.0\ndt_s = 0.002\nname = \"base\"\n[contact]\nmu_static = 0.3\n"
                    "[[hold]]\nat = \"tip\"\nspin = true\n[[hold]]\nat = \"base\"\nspin = true\n");
        files.write("common/wire.toml", "include = \"base.toml\"\n[scene]\nname = \"wire\"\n[wire]\nlength_m = 0.3\n" + shaft);
        const fs::path file = files.write("scene.toml",
                                          "include = \"common/wire.toml\"\n[scene]\ndt_s = 0.001\n[wire]\ndensity = 6000\n"
                                          "[[hold]]\nat = \"base\"\nposition = true\n");
        const Scene scene = read_scene(file);
        CHECK(scene.dt == 0.001);
        CHECK(scene.duration == 5);
        CHECK(scene.name == "wire");
        CHECK(scene.contact.mu_static == 0.3);
        CHECK(scene.wire.shaft.density == 6000);
        CHECK(scene.wire.shaft.radius == 0.0004);
        REQUIRE(scene.holds.size() == 1);  // a list is taken as a whole
        CHECK(scene.holds[0].position);
        CHECK(note_of(scene, "include") == "common/wire.toml, base.toml");
        // --set is over all of them
        const std::vector<std::string> sets = {"scene.duration_s=2"};
        CHECK(read_scene(file, sets).duration == 2);
    }

    TEST_CASE("property: of several included files the later ones win, and the same file may come twice")
    {
        const TemporaryFolder files;
        files.write("a.toml", "[wire]\nlength_m = 0.3\n" + shaft + "[scene]\nseed = 1\n");
        files.write("b.toml", "include = \"a.toml\"\n[scene]\nseed = 2\nrecord_every = 7\n");
        const fs::path file = files.write("scene.toml", "include = [\"b.toml\", \"a.toml\"]\n" + timing);
        const Scene scene = read_scene(file);
        CHECK(scene.seed == 1);
        CHECK(scene.record_every == 7);
    }

    TEST_CASE("property: an instrument above replaces one below as a whole")
    {
        const TemporaryFolder files;
        files.write("catheter.toml", "[wire]\npreset = \"simmons-1-5f\"\nlength_m = 1.0\nnodes = 31\n");
        const Scene scene = read_scene(
            files.write("scene.toml", "include = \"catheter.toml\"\n" + timing + "[wire]\npreset = \"lunderquist-035\"\n"));
        CHECK(scene.wire.lumen_radius == 0);
        CHECK(scene.wire.nodes == 31);
        CHECK(scene.wire.sections.size() == lunderquist().wire.sections.size());
        CHECK(note_of(scene, "wire.preset") == "lunderquist-035");
        // a material above numbers below
        files.write("shaft.toml", "[wire]\nlength_m = 1.0\n" + shaft);
        CHECK(read_scene(files.write("b.toml", "include = \"shaft.toml\"\n" + timing + "[wire]\nyoungs_pa = 6e10\n"))
                  .wire.shaft.youngs == 6e10);
    }

    TEST_CASE("property: a mesh is looked for beside the file that names it")
    {
        const TemporaryFolder files;
        files.write("vessels/wall.stl", "solid\nendsolid\n");
        files.write("vessels/vessel.toml", "[vessel]\nmesh = \"wall.stl\"\n");
        const fs::path file =
            files.write("scene.toml", "include = \"vessels/vessel.toml\"\n" + timing + "[wire]\nlength_m = 0.3\n" + shaft);
        CHECK(read_scene(file).vessel.mesh == fs::weakly_canonical(files.path() / "vessels/wall.stl"));
        // --set is said from where the scene is
        const std::vector<std::string> sets = {"vessel.mesh=vessels/wall.stl"};
        CHECK(read_scene(file, sets).vessel.mesh == fs::weakly_canonical(files.path() / "vessels/wall.stl"));
    }

    TEST_CASE("property: one coefficient of friction changes a preset's other one in proportion; both together are as given")
    {
        const std::string wire = timing + "[wire]\npreset = \"lunderquist-035\"\nlength_m = 1.0\n";
        const WireSection own = lunderquist().wire.shaft;
        REQUIRE(own.mu_static > own.mu_sliding);
        const double ratio = own.mu_static / own.mu_sliding;
        for (const double mu : {0.02, 0.3}) {  // below and above both
            const std::string sliding = fmt::format("mu_sliding = {}\n", mu), text = fmt::format("{}", mu);
            for (const Scene& scene : {read(wire + sliding), read(wire, {"wire.mu_sliding=" + text})}) {
                CHECK(scene.wire.shaft.mu_sliding == mu);
                CHECK(scene.wire.shaft.mu_static == test::about(ratio * mu).epsilon(1e-12));
                CHECK(scene.warnings.empty());
            }
            const Scene of_static = read(wire, {"wire.mu_static=" + text});
            CHECK(of_static.wire.shaft.mu_static == mu);
            CHECK(of_static.wire.shaft.mu_sliding == test::about(mu / ratio).epsilon(1e-12));
        }
        const Scene both = read(wire + "mu_sliding = 0.3\n", {"wire.mu_static=0.31"});
        CHECK(both.wire.shaft.mu_sliding == 0.3);
        CHECK(both.wire.shaft.mu_static == 0.31);
        // a swept preset comes with its own
        CHECK(read(wire + "mu_sliding = 0.3\n", {"wire.preset=lunderquist-035"}).wire.shaft == own);
    }

    TEST_CASE("property: bend_scale multiplies bending and twisting stiffness of shaft and sections, and nothing else")
    {
        const std::string wire = timing + "[wire]\npreset = \"lunderquist-035\"\nlength_m = 1.0\n";
        const Scene plain = read(wire), twice = read(wire + "bend_scale = 2.0\n"), set = read(wire, {"wire.bend_scale=2"});
        for (const Scene* scene : {&twice, &set}) {
            REQUIRE(scene->wire.sections.size() == plain.wire.sections.size());
            REQUIRE(plain.wire.sections.size() > 0);
            for (std::size_t k = 0; k <= plain.wire.sections.size(); ++k) {
                WireSection expected = k == 0 ? plain.wire.shaft : plain.wire.sections[k - 1].section;
                expected.bend_stiffness *= 2, expected.twist_stiffness *= 2;
                CHECK((k == 0 ? scene->wire.shaft : scene->wire.sections[k - 1].section) == expected);
            }
        }
        CHECK(read_scene_text(write_scene(twice, ""), "again.toml").wire.shaft == twice.wire.shaft);
        CHECK(read(wire + "bend_scale = 2.0\n", {"wire.preset=lunderquist-035"}).wire.shaft == plain.wire.shaft);
        check_error([&] { return read(wire + "bend_scale = 0\n"); }, {"wire.bend_scale: got 0; expected a number above 0"});
    }

    TEST_CASE("bad input: presets")
    {
        const std::string wire = timing + "[wire]\nlength_m = 1.0\n";
        check_error([&] { return read(wire + "preset = \"lunderqist\"\n"); },
                    {"scene.toml:6:10: wire.preset: no instrument is called \"lunderqist\"", "lunderquist-035", "instruments",
                     "`seldinger instruments`"});
        check_error([&] { return read(wire + "preset = \"terumo\"\n"); },
                    {"nearest are terumo-angled-035, terumo-stiff-angled-035"});
        check_error([&] { return read(wire + "preset = 35\n"); },
                    {"scene.toml:6:10: wire.preset: expected an instrument's name"});
        check_error([&] { return read(wire + "preset = \"\"\n"); }, {"wire.preset: expected an instrument's name"});
        check_error([&] { return read(wire + "preset = \"../scenes/experiment1\"\n"); },
                    {"wire.preset: no instrument is called"});
        check_error(
            [&] { return read(wire, {"wire.preset=lunder"}); },
            {"--set wire.preset=lunder: wire.preset: no instrument is called \"lunder\"; the nearest are lunderquist-035"});
        // a missing key is reported in the scene's own table
        check_error([&] { return read(timing + "[wire]\npreset = \"bentson-035\"\n"); },
                    {"scene.toml:4:1: wire.length_m: is missing"});
        // and a value beside it is wrong where it stands
        check_error([&] { return read(wire + "preset = \"bentson-035\"\ndensity = -1\n"); },
                    {"scene.toml:7:11: wire.density: expected"});
        check_error([&] { return read(wire + shaft + "[[wire.section]]\nfrom_tip_m = [0.0, 0.1]\npreset = \"bentson-035\"\n"); },
                    {"wire.section.0.preset: unknown key"});
    }

    TEST_CASE("bad input: lumen")
    {
        const std::string wire = timing + "[wire]\nlength_m = 1.0\n" + shaft;
        check_error([&] { return read(wire + "lumen_radius_m = 0.0004\n"); },
                    {"wire.lumen_radius_m: expected less than the smallest outer radius, 0.0004 m"});
        check_error([&] { return read(wire + "lumen_radius_m = -1e-5\n"); },
                    {"wire.lumen_radius_m: expected a number, 0 or above"});
        check_error(
            [&] {
                return read(wire + "lumen_radius_m = 0.0003\n[[wire.section]]\nfrom_tip_m = [0.0, 0.1]\nradius_m = 0.0002\n");
            },
            {"wire.lumen_radius_m: expected less than the smallest outer radius, 0.0002 m"});
        CHECK(read(wire + "lumen_radius_m = 0.0003\n").wire.lumen_radius == 0.0003);
        CHECK(read(wire).wire.lumen_radius == 0);
    }

    TEST_CASE("bad input: includes")
    {
        const TemporaryFolder files;
        const std::string wire = "[wire]\nlength_m = 1.0\n" + shaft;
        const auto scene = [&](const std::string& include) {
            return [&files, &wire, include] {
                return read_scene(files.write("scene.toml", "include = " + include + "\n" + timing + wire));
            };
        };
        check_error(scene("\"none.toml\""), {"scene.toml:1:11: include: ", "none.toml", "folder of the file that includes"});
        check_error(scene("7"), {"scene.toml:1:11: include: expected a file's path in quotes, or a list of them"});
        check_error(scene("[\"\"]"), {"scene.toml:1:12: include: expected a file's path"});
        files.write("broken.toml", "[scene]\nseed = = 1\n");
        check_error(scene("\"broken.toml\""), {"broken.toml:2:", "is not TOML"});
        // errors name the file and the place where the bad value stands
        files.write("bad.toml", "[contact]\n\nmu_static = -2.0\n");
        check_error(scene("\"bad.toml\""), {"bad.toml:3:13: contact.mu_static: expected"});
        files.write("unknown.toml", "[contact]\nmu_statik = 0.2\n");
        check_error(scene("\"unknown.toml\""), {"unknown.toml:2:1: contact.mu_statik: unknown key", "contact.mu_static"});
        files.write("table.toml", "contact = 3\n");
        check_error(scene("\"table.toml\""), {"table.toml:1:11: contact: expected one table [contact]"});
        files.write("a.toml", "include = \"b.toml\"\n");
        files.write("b.toml", "\ninclude = [\"a.toml\"]\n");
        check_error(scene("\"a.toml\""), {"b.toml:2:12: include: goes in a circle (scene.toml > a.toml > b.toml > a.toml)"});
        check_error(scene("\"scene.toml\""), {"include: goes in a circle (scene.toml > scene.toml)"});
        for (int i = 0; i < 12; ++i) files.write(fmt::format("d{}.toml", i), fmt::format("include = \"d{}.toml\"\n", i + 1));
        files.write("d8.toml", "");
        check_error(scene("\"d0.toml\""), {"d7.toml:1:11: include: is more than 8 files deep"});
        // few bytes that would be read for hours: each includes the next eleven times
        for (int i = 0; i < 7; ++i) {
            std::string list = fmt::format("\"m{}.toml\"", i + 1);
            for (int k = 0; k < 10; ++k) list += fmt::format(", \"m{}.toml\"", i + 1);
            files.write(fmt::format("m{}.toml", i), "include = [" + list + "]\n");
        }
        files.write("m7.toml", "");
        check_error(scene("\"m0.toml\""), {"include: is one too many: a scene includes at most 100 files of 16 MB in all"});
        files.write("large.toml", "#" + std::string(9u << 20, 'x') + "\n");
        CHECK_NOTHROW(scene("\"large.toml\"")());
        check_error(scene("[\"large.toml\", \"large.toml\"]"), {"include: is one too many"});
        CHECK_NOTHROW((void)scene("\"d1.toml\"")());
        // only at the top of a scene
        check_error([&] { return read("[scene]\ninclude = \"a.toml\"\n" + wire); }, {"scene.include: unknown key"});
    }

    TEST_CASE("regression: sections that take a shaped tip away say so")
    {
        const std::string angled = timing + "[wire]\npreset = \"terumo-angled-035\"\nlength_m = 0.5\n";
        const std::string soft = "[[wire.section]]\nfrom_tip_m = [0.0, 0.1]\nbend_nm2 = 1e-5\n";
        const auto said = [](const Scene& scene) { return scene.warnings.empty() ? "" : scene.warnings.front(); };
        CHECK(said(read(angled)).empty());
        CHECK(said(read(angled + soft))
                  .starts_with(
                      "wire.section: replaces all sections of \"terumo-angled-035\", the tip that they bend by 51 degrees, too"));
        CHECK(said(read(angled, {"wire.section=[{from_tip_m = [0.0, 0.1], bend_nm2 = 1e-5}]"})).find("51 degrees") !=
              std::string::npos);
        CHECK(said(read(timing + "[wire]\nlength_m = 0.5\n" + soft, {"wire.preset=terumo-angled-035"}))
                  .empty());  // whose own sections are dropped first
        // what keeps a tip, or gives it another shape, is no loss
        const Scene kept = read(angled, {"wire.section.0.bend_nm2=1e-5"});
        CHECK(said(kept).empty());
        CHECK(kept.wire.sections.size() == 3);
        CHECK(said(read(angled + soft + "rest_curvature_1_m = [50.0, 0.0]\n")).empty());
        CHECK(said(read(timing + "[wire]\npreset = \"lunderquist-035\"\nlength_m = 0.5\n" + soft))
                  .empty());  // straight as it is sold
    }
}

}  // namespace seldinger::test::test_scene_layers

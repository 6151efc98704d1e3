// Tables of measurements in a scene: stiffness along an instrument, the log of a robot; what becomes of them, and bad files.
#include "core/error.h"
#include "scene/scene.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace seldinger::test::test_scene_tables {

namespace {

namespace fs = std::filesystem;

const std::string wire =
    "[scene]\nduration_s = 1.0\ndt_s = 0.001\n[wire]\nlength_m = 0.5\nradius_m = 0.0004\ndensity = 7000.0\ntwist_nm2 = "
    "8e-5\nstretch_n = 1e4\n";
const std::string feed = "bend_nm2 = 1e-4\n[feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n";

struct Files : TemporaryFolder {
    [[nodiscard]] Scene read(const std::string& text, const std::vector<std::string>& sets = {}) const
    {
        return read_scene_text(text, path() / "scene.toml", sets);
    }
    void refuses(const std::string& text, const std::vector<std::string>& says, ErrorKind kind = ErrorKind::BadFile) const
    {
        check_refused([&] { return read(text); }, says, kind);
    }
};

/// int ds/B over a stretch of the wire, by its sections.
double compliance(const WireSpec& spec, double from, double to)
{
    double sum = 0;
    constexpr int parts = 20000;
    for (int k = 0; k < parts; ++k) sum += (to - from) / parts / spec.at(from + (to - from) * (k + 0.5) / parts).bend_stiffness;
    return sum;
}

}  // namespace

TEST_SUITE("scene/tables")
{
    // int ds/B of B linear from a to b over l is l ln(b/a)/(b - a).
    TEST_CASE("analytic: stiffness is linear between rows, and as the outer rows beyond them")
    {
        const Files files;
        files.write("tip.csv",
                    "# three-point bending\nfrom_tip_mm, bend_nm2\n20,1e-5\n\n60,1e-5\n100,1e-3\n100,2e-3\n300,2e-3\n");
        const WireSpec spec = files.read(wire + "bend_table = \"tip.csv\"\n").wire;
        CHECK(spec.at(0).bend_stiffness == 1e-5);
        CHECK(spec.at(0.04).bend_stiffness == about(1e-5).epsilon(1e-12));
        CHECK(spec.at(0.08).bend_stiffness == about(5.05e-4).epsilon(0.06));  // within sections of 10 %
        CHECK(spec.at(0.1001).bend_stiffness == about(2e-3).epsilon(1e-12));
        CHECK(spec.at(0.5).bend_stiffness == 2e-3);
        CHECK(spec.shaft.bend_stiffness == 2e-3);
        CHECK(compliance(spec, 0.06, 0.1) == about(0.04 * std::log(100.0) / 9.9e-4).epsilon(1e-3));
        CHECK(spec.at(0.08).twist_stiffness == 8e-5);  // what the table does not have is the wire's
        CHECK(spec.at(0.08).density == 7000);
        CHECK(files.read(wire + "bend_nm2 = 1.0\nbend_table = \"tip.csv\"\n").wire.at(0).bend_stiffness == 1e-5);
        const WireSpec twice = files.read(wire + "bend_table = \"tip.csv\"\nbend_scale = 2.0\n").wire;
        CHECK(twice.at(0.04).bend_stiffness == about(2e-5).epsilon(1e-12));
    }

    TEST_CASE("every column counts, and what sections have besides stays")
    {
        const Files files;
        files.write("all.csv",
                    "from_tip_m,bend_nm2,twist_nm2,stretch_n,mass_kg_m\n0,1e-5,1e-6,1e2,1e-3\n0.5,1e-5,1e-6,1e4,1e-3\n");
        files.write("end.csv", "from_tip_m,bend_nm2\n0,3e-5\n");
        const std::string sections =
            "bend_table = \"all.csv\"\n[[wire.section]]\nfrom_tip_m = [0.0, 0.03]\nradius_m = 0.0002\n"
            "rest_curvature_1_m = [100.0, 0.0]\n[[wire.section]]\nfrom_tip_m = [0.01, 0.02]\nbend_table = "
            "\"end.csv\"\nmu_sliding = 0.03\n";
        std::string bare = wire;
        for (const char* key : {"twist_nm2 = 8e-5\n", "stretch_n = 1e4\n"}) bare.erase(bare.find(key), std::string(key).size());
        const WireSpec spec = files.read(bare + sections).wire;
        CHECK(spec.at(0.1).twist_stiffness == about(1e-6).epsilon(1e-12));
        CHECK(spec.at(0.25).stretch_stiffness == about(5.05e3).epsilon(0.06));
        CHECK(spec.at(0.005).radius == 0.0002);
        CHECK(spec.at(0.005).rest_curvature[0] == 100);
        for (const double s : {0.005, 0.1})
            CHECK(spec.at(s).density * std::numbers::pi * spec.at(s).radius * spec.at(s).radius == about(1e-3).epsilon(1e-12));
        CHECK(spec.at(0.015).bend_stiffness == about(3e-5).epsilon(1e-12));  // of this section alone
        CHECK(spec.at(0.015).mu_sliding == 0.03);
        CHECK(spec.at(0.025).bend_stiffness == about(1e-5).epsilon(1e-12));
        // a written scene has all of it, and needs no table
        const Scene scene = files.read(bare + sections);
        const Scene again = read_scene_text(write_scene(scene, files.path()), "elsewhere.toml");
        for (const double s : {0.0, 0.005, 0.015, 0.025, 0.1, 0.4}) CHECK(again.wire.at(s) == scene.wire.at(s));
    }

    TEST_CASE("refusal: a table of stiffness that is none")
    {
        const Files files;
        const std::string text = wire + "bend_table = \"tip.csv\"\n";
        files.refuses(text, {"wire.bend_table: no file at"});
        for (const auto& [table, says] : std::vector<std::pair<std::string, std::vector<std::string>>>{
                 {"", {"tip.csv", "no rows"}},
                 {"from_tip_mm,bend_nm2\n", {"no rows"}},
                 {"0,1e-5\n", {"tip.csv:1:", "expected the columns' names"}},
                 {"from_tip_mm;bend_nm2\n0;1e-5\n", {"tip.csv:1:", "separated by commas"}},
                 {"from_tip_mm\n0\n", {"expected from_tip_mm (or from_tip_m) and bend_nm2"}},
                 {"bend_nm2\n1\n", {"expected from_tip_mm (or from_tip_m) and bend_nm2"}},
                 {"from_tip_mm,bend_nm2,twist\n0,1,1\n", {"got the column twist", "twist_nm2"}},
                 {"from_tip_mm,from_tip_m,bend_nm2\n0,0,1\n", {"got from_tip_mm and from_tip_m"}},
                 {"from_tip_mm,bend_nm2,bend_nm2\n0,1,1\n", {"tip.csv:1:", "bend_nm2 twice"}},
                 {"from_tip_mm,bend_nm2\n0,1e-5\n10\n", {"tip.csv:3:", "got 1 values; expected 2"}},
                 {"from_tip_mm,bend_nm2\n0,soft\n", {"tip.csv:2:", "bend_nm2: got \"soft\"; expected a number"}},
                 {"from_tip_mm,bend_nm2\n0,nan\n", {"got \"nan\"; expected a number"}},
                 {"from_tip_mm,bend_nm2\n0,0\n", {"got 0; expected a number above 0"}},
                 {"from_tip_mm,bend_nm2\n0,-1e-5\n", {"got -1e-05; expected a number above 0"}},
                 {"from_tip_mm,bend_nm2\n10,1e-5\n5,1e-5\n", {"tip.csv:3:", "Fix: sort the rows"}},
                 {"from_tip_mm,bend_nm2\n-1,1e-5\n", {"from_tip: got -0.001 m"}},
                 {"from_tip_m,bend_nm2\n0,1e-5\n20,1e-5\n",
                  {"tip.csv:3:", "got 20 m; expected 0 to the wire's length, 0.5 m"}}}) {
            CAPTURE(table);
            files.write("tip.csv", table);
            files.refuses(text, says);
        }
        files.write("tip.csv", "from_tip_mm,bend_nm2\n0,1e-5\n");
        std::string bare = text;
        bare.erase(bare.find("twist_nm2 = 8e-5\n"), 17);
        files.refuses(bare, {"wire.twist_nm2: is missing"}, ErrorKind::BadScene);
    }

    // Rows on three lines: the keys are their ends, to the last bit.
    TEST_CASE("a clean log has the keys of its corners")
    {
        const Files files;
        std::string log = "time_s,advance_mm,turn_deg\n";
        for (int k = 0; k <= 300; ++k) {
            const double t = 0.01 * k, x = t < 1 ? 100 * t : t < 2 ? 100.0 : 100 - 20 * (t - 2), a = t < 1 ? 0 : 90 * (t - 1);
            log += fmt::format("{},{},{}\n", t, x, a);
        }
        files.write("robot.csv", log);
        const Scene scene = files.read(wire + feed + "log = \"robot.csv\"\n");
        const std::vector<FeedKey>& keys = scene.feed.keys;
        REQUIRE(keys.size() == 4);
        CHECK(keys[1].t == about(1).epsilon(1e-12));
        CHECK(keys[1].advance == about(0.1).epsilon(1e-12));
        CHECK(keys[3].advance == about(0.08).epsilon(1e-9));
        CHECK(keys[3].turn == about(std::numbers::pi).epsilon(1e-9));
        REQUIRE(scene.warnings.size() == 1);
        CHECK(scene.warnings[0].find("feed.log: 301 rows of robot.csv as 4 keys") == 0);
        CHECK(scene.notes.size() == 1);
        const Scene again = read_scene_text(write_scene(scene, files.path()), "elsewhere.toml");
        CHECK(again.feed.keys.size() == 4);
        CHECK(again.feed.keys[3].turn == keys[3].turn);
        // in place of keys, as --set may ask for
        const std::string with_keys = wire + feed + "keys = [{t_s = 0.0, advance_m = 0.01}]\n";
        const Scene set = files.read(with_keys, {"feed.log=\"robot.csv\""});
        CHECK(set.feed.keys.size() == 4);
        CHECK(has(set.warnings[0], "it replaces keys"));
    }

    // Keys pass each row within three standard deviations; the truth lies within them and the rows' own noise.
    TEST_CASE("property: noise of an encoder, equal stamps and Unix times are seen through and said")
    {
        const Files files;
        std::mt19937 random(7);
        std::uniform_real_distribution<double> noise(-0.3, 0.3);
        const auto truth = [](double t) { return t < 4 ? 20 * t : t < 6 ? 80.0 : 80 - 10 * (t - 6); };
        std::string log = "\xEF\xBB\xBFtime_s,force_n,advance_mm\n";
        for (int k = 0; k <= 1000; ++k) {
            const double t = 0.01 * k;
            for (int again = 0; again < (k % 100 == 50 ? 2 : 1); ++again)
                log += fmt::format("{:.3f},0.1,{:.4f}\n", 1.7e9 + t, truth(t) + (k == 0 ? -0.2 : noise(random)));
        }
        files.write("robot.csv", log);
        const Scene scene = files.read(wire + feed + "log = \"robot.csv\"\n");
        CHECK(scene.feed.keys.size() < 40);
        CHECK(scene.feed.keys.front().t == 0);
        CHECK(scene.feed.keys.front().advance == 0);  // -0.2 mm is noise
        for (int k = 0; k <= 1000; ++k) CHECK(std::abs(scene.feed.at(0.01 * k).advance - 1e-3 * truth(0.01 * k)) < 0.9e-3);
        const std::string& said = scene.warnings.at(0);
        INFO(said);
        for (const char* part :
             {"1011 rows", "its first time, 1700000000 s, is 0 here", "of 10 rows at the time of another the last counts",
              "mm (standard deviation)", "column force_n is not used"})
            CHECK(has(said, part));
    }

    TEST_CASE("refusal: a log that is none")
    {
        const Files files;
        const std::string text = wire + feed + "log = \"robot.csv\"\n";
        files.refuses(text, {"feed.log: no file at"});
        for (const auto& [table, says] : std::vector<std::pair<std::string, std::vector<std::string>>>{
                 {"time_s,turn_deg\n0,1\n", {"expected time_s and advance_mm (or advance_m)"}},
                 {"time_s,advance_mm,advance_m\n0,1,1\n", {"got advance_mm and advance_m"}},
                 {"time_s,advance_mm\n0,1\n-1,1\n", {"robot.csv:3:", "time_s: got -1 s after 0 s"}},
                 {"time_s,advance_m\n0,1\n", {"robot.csv:2:", "advance: got 1 m; expected 0 to the wire's length, 0.5 m"}},
                 {"time_s,advance_mm\n0,-5\n", {"advance: got -0.005 m"}},
                 {"time_s,advance_mm\n0,\n", {"advance_mm: got \"\"; expected a number"}}}) {
            CAPTURE(table);
            files.write("robot.csv", table);
            files.refuses(text, says);
        }
        files.write("robot.csv", "time_s,advance_mm\n0,1\n");
        CHECK(files.read(text).feed.keys.size() == 1);
        files.refuses(wire + feed, {"feed.keys: is missing"}, ErrorKind::BadScene);
        files.refuses(wire + feed + "hub_mass_kg = 0.1\nlog = \"robot.csv\"\n", {"feed.log: "}, ErrorKind::BadScene);
    }
}

}  // namespace seldinger::test::test_scene_tables

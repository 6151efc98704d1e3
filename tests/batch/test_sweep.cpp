// engine/studies/batch/sweep.cpp: the runs of a sweep file, and messages for a wrong one.

#include "batch/batch_table.h"
#include "batch/sweep.h"
#include "core/error.h"
#include "core/file_io.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace seldinger::test::test_sweep {

namespace {

Sweep sweep_of(const std::string& text, std::int64_t seed = 0) { return read_sweep_text(text, "s.toml", seed); }

double number_at(const Sweep& sweep, std::size_t axis, std::size_t k) { return std::stod(sweep.axes.at(axis).values.at(k)); }

std::string complaint(const std::string& text)
{
    return refusal([&] { return sweep_of(text); }, ErrorKind::BadScene);
}

}  // namespace

TEST_SUITE("batch/sweep")
{
    TEST_CASE("property: lists make a grid, the first key slowest, in the file's order")
    {
        const Sweep sweep =
            sweep_of("[vary]\n\"wire.nodes\" = [11, 21]\n\"contact.detection\" = [\"capsule\", \"nodes\", \"layer\"]\n");
        REQUIRE(sweep.run_count() == 6);
        CHECK(sweep.overrides(0) == std::vector<std::string>{"wire.nodes=11", "contact.detection=\"capsule\""});
        CHECK(sweep.overrides(1) == std::vector<std::string>{"wire.nodes=11", "contact.detection=\"nodes\""});
        CHECK(sweep.overrides(5) == std::vector<std::string>{"wire.nodes=21", "contact.detection=\"layer\""});
        std::set<std::vector<std::string>> seen;
        for (std::size_t run = 0; run < 6; ++run) seen.insert(sweep.overrides(run));
        CHECK(seen.size() == 6);
    }

    TEST_CASE("property: values keep their TOML type on one line, and a key may be written without quotes")
    {
        const Sweep sweep = sweep_of(
            "[vary]\nscene.gravity = [[0.0, 0.0, -9.81],\n [0, 0, 1]]\n\"contact.rolling\" = [true]\n"
            "\"wire.bend_nm2\" = [1e-4, 2]\n\"wire.nodes\" = [\"adaptive\"]\n"
            "\"wire.place\" = [{shape = \"arc\", bend_radius_m = 0.1}]\n");
        REQUIRE(sweep.axes.size() == 5);
        CHECK(sweep.axes[0].key == "scene.gravity");
        CHECK(sweep.axes[0].values == std::vector<std::string>{"[0.0, 0.0, -9.81]", "[0, 0, 1]"});
        CHECK(sweep.axes[1].values[0] == "true");
        CHECK(sweep.axes[2].values == std::vector<std::string>{"0.0001", "2"});
        CHECK(sweep.axes[3].values[0] == "\"adaptive\"");
        CHECK(sweep.axes[4].values[0] == "{\"bend_radius_m\" = 0.1, \"shape\" = \"arc\"}");
        CHECK(sweep_of("[vary]\nwire.place = [{'a\"b' = 1}]\n").axes[0].values[0] == R"({"a\"b" = 1})");
    }

    TEST_CASE("property: draws fill their range evenly, in the logarithm where that is asked for")
    {
        const int n = 4000;
        const Sweep sweep = sweep_of(
            "[vary]\n\"a.x\" = {min = 2.0, max = 6.0, n = 4000}\n\"a.y\" = {min = 1e-6, max = 1e-2, n = 4000, log = true}\n");
        REQUIRE(sweep.run_count() == n);
        double sum = 0, log_sum = 0, product = 0;
        for (int k = 0; k < n; ++k) {
            const double x = (number_at(sweep, 0, k) - 2) / 4, y = std::log10(number_at(sweep, 1, k) / 1e-6) / 4;
            REQUIRE(x >= 0);
            REQUIRE(x < 1);
            REQUIRE(y >= 0);
            REQUIRE(y <= 1);
            sum += x;
            log_sum += y;
            product += (x - 0.5) * (y - 0.5);
        }
        // the mean of n even draws has deviation 1 / sqrt(12 n), the mean product 1 / (12 sqrt(n)): 4.5 of each
        CHECK(std::abs(sum / n - 0.5) < 4.5 / std::sqrt(12.0 * n));
        CHECK(std::abs(log_sum / n - 0.5) < 4.5 / std::sqrt(12.0 * n));
        CHECK(std::abs(product / n) < 4.5 / (12 * std::sqrt(double(n))));
    }

    TEST_CASE("property: a draw depends on seed, key and place alone; each point of a grid sees the same draws")
    {
        const std::string drawn = "\"a.x\" = {min = 0.0, max = 1.0, n = 3}\n";
        const Sweep one = sweep_of("[vary]\n" + drawn), again = sweep_of("[vary]\n" + drawn),
                    seeded = sweep_of("[vary]\n" + drawn, 7);
        const Sweep more = sweep_of("[vary]\n\"b.k\" = [1, 2]\n" + drawn + "\"c.z\" = {min = 0.0, max = 1.0, n = 3}\n");
        CHECK(one.axes[0].values == again.axes[0].values);
        CHECK(one.axes[0].values != seeded.axes[0].values);
        CHECK(more.axes[1].values == one.axes[0].values);
        CHECK(more.axes[2].values != one.axes[0].values);
        REQUIRE(more.run_count() == 6);
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(more.overrides(k)[1] == more.overrides(k + 3)[1]);
            CHECK(more.overrides(k)[2] == more.overrides(k + 3)[2]);
            CHECK(more.overrides(k)[0] != more.overrides(k + 3)[0]);
        }
    }

    TEST_CASE("property: what is wrong is named with file, line and what was expected")
    {
        CHECK(complaint("[vary]\n\"wire.nodes\" = 3\n").starts_with("s.toml:2:"));
        CHECK(has(complaint("[vary]\n\"wire.nodes\" = []\n"), "expected a list of values"));
        CHECK(has(complaint("[vary]\nnodes = [1]\n"), "with its table"));
        CHECK(complaint("[vary]\n\"a.x\" = {min = 0.0, n = 3}\n").find("max") != std::string::npos);
        CHECK(complaint("[vary]\n\"a.x\" = {min = 1.0, max = 0.0, n = 3}\n").find("at least min") != std::string::npos);
        CHECK(complaint("[vary]\n\"a.x\" = {min = 0.0, max = 1.0, n = 3, log = true}\n").find("above 0") != std::string::npos);
        CHECK(complaint("[vary]\n\"a.x\" = {min = 0.0, max = 1.0, n = 3, step = 2}\n").find("unknown key") != std::string::npos);
        const std::string unequal =
            complaint("[vary]\n\"a.x\" = {min = 0.0, max = 1.0, n = 3}\n\"a.y\" = {min = 0.0, max = 1.0, n = 4}\n");
        CHECK(unequal.starts_with("s.toml:3: vary.a.y: n = 4 here and 3 for a.x"));
        CHECK(has(complaint("[vary]\n"), "is empty"));
        CHECK(has(complaint("[vari]\n"), "nearest known one is vary"));
        CHECK(has(complaint(""), "vary"));
        CHECK(has(complaint("[vary\n"), "is not TOML"));
        CHECK(complaint("[vary]\n\"a.x\" = {min = 0.0, max = 1.0, n = 1000}\n\"b.y\" = {min = 0.0, max = 1.0, n = 1000}\n")
                  .empty());
        std::string list = "[0";
        for (int k = 1; k < 1001; ++k) list += ", " + std::to_string(k);
        CHECK(has(complaint("[vary]\n\"a.x\" = " + list + "]\n\"a.y\" = " + list + "]\n"), "more than 1000000 runs"));
        // few bytes that would draw values without end
        std::string draws = "[vary]\n";
        for (int k = 0; k < 9; ++k) draws += fmt::format("\"a.x{}\" = {{min = 0, max = 1, n = 1000000}}\n", k);
        CHECK(has(complaint(draws), "a.x4.n: makes more than 4000000 values"));
        std::string keys = "[vary]\n";
        for (int k = 0; k < 1001; ++k) keys += fmt::format("\"a.x{}\" = {{min = 0, max = 1, n = 1}}\n", k);
        CHECK(has(complaint(keys), "is more than 1000 keys"));
    }

    TEST_CASE("property: a design is a file with keys of the scene, under its name")
    {
        const TemporaryFolder folder;
        const std::filesystem::path file = folder.path() / "s.toml";
        write_file(folder.path() / "soft.toml",
                   "[wire]\npreset = \"bentson-035\"\n[[wire.section]]\nfrom_tip_m = [0.0, 0.02]\nbend_nm2 = 1e-5\n"
                   "[[instrument]]\nlength_m = 0.5\n[[instrument]]\nfeed = {inlet = 2}\n");
        write_file(folder.path() / "stiff.toml", "wire.bend_nm2 = 2\n");
        const std::string text =
            "[vary]\n\"wire.nodes\" = [11, 21]\n[vary.design]\nstiff = \"stiff.toml\"\nsoft = \"soft.toml\"\n";
        const Sweep sweep = read_sweep_text(text, file, 0);
        REQUIRE(sweep.axes.size() == 2);
        CHECK(sweep.run_count() == 4);
        CHECK(sweep.axes[1].values == std::vector<std::string>{"\"stiff\"", "\"soft\""});  // in the file's order
        CHECK(sweep.overrides(2) == std::vector<std::string>{"wire.nodes=21", "wire.bend_nm2=2"});
        CHECK(sweep.overrides(1) ==
              std::vector<std::string>{"wire.nodes=11", "instrument.0.length_m=0.5", "instrument.1.feed.inlet=2",
                                       "wire.preset=\"bentson-035\"",
                                       "wire.section=[{\"bend_nm2\" = 1e-05, \"from_tip_m\" = [0.0, 0.02]}]"});
        CHECK(run_name(sweep, 3) == "run 3 (wire.nodes=21, design=soft)");
        // with the files behind it, it needs no file any more
        const std::string whole = with_designs(text, file);
        write_file(folder.path() / "stiff.toml", "wire.bend_nm2 = 3\n");
        CHECK(read_sweep_text(whole, "elsewhere/s.toml", 0).overrides(2) == sweep.overrides(2));
        CHECK(with_designs(whole, "elsewhere/s.toml") == whole);
        CHECK(with_designs("[vary]\n\"wire.nodes\" = [11]\n", file) == "[vary]\n\"wire.nodes\" = [11]\n");
    }

    TEST_CASE("property: a wrong design is said of its line and file")
    {
        const TemporaryFolder folder;
        write_file(folder.path() / "include.toml", "include = \"a.toml\"\n");
        write_file(folder.path() / "top.toml", "nodes = 3\n");
        write_file(folder.path() / "empty.toml", "\n");
        const auto says = [&](const std::string& design, const std::string& what) {
            CAPTURE(design);
            CHECK_THROWS_WITH_AS((void)read_sweep_text("[vary]\ndesign = " + design + "\n", folder.path() / "s.toml", 0),
                                 doctest::Contains(what.c_str()), Error);
        };
        says("{soft = \"none.toml\"}", "s.toml:2:18: vary.design.soft: ");
        says("{soft = \"none.toml\"}", "paths start at the sweep file's folder");
        says("{soft = 3}", "vary.design.soft: expected a file with keys of the scene, in quotes");
        says("{}", "vary.design: expected names with files");
        says("[\"soft.toml\"]", "vary.design: expected names with files");
        says("{a = \"include.toml\"}", "include.toml:1:11: include: a design sets keys");
        says("{a = \"top.toml\"}", "top.toml:1:9: nodes: expected keys of the scene in their tables");
        says("{a = \"empty.toml\"}", "empty.toml sets no key");
    }
}

}  // namespace seldinger::test::test_sweep

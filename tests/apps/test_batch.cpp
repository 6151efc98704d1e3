// `seldinger batch`: every run of a sweep as if it had been run alone, whatever the worlds, threads and stops.

#include "apps/app_fixture.h"
#include "support/approx.h"

#include <array>
#include <map>

namespace seldinger::test::test_batch {

namespace {

std::vector<Row> results(const fs::path& dir) { return table_rows(dir / "results.csv"); }

// stiffness and friction share a world; each dt has its own
const std::string mixed_sweep = R"([vary]
"scene.dt_s" = [0.001, 0.0005]
"wire.bend_nm2" = [1.0e-5, 3.0e-5]
"wire.radius_m" = [0.0004445, 0.0003]
"contact.mu_sliding" = [0.1]
)";

}  // namespace

TEST_SUITE("apps/batch")
{
    TEST_CASE("property: each row has the numbers and the state hash of that run alone")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.15)}, {"s.toml", mixed_sweep}};
        const AppResult result = run_ok(folder, "batch t.toml --vary s.toml -o B --json");
        CHECK(result.err.empty());
        const auto printed = nlohmann::json::parse(result.out);
        CHECK(printed == summary_of(folder.path / "B"));
        CHECK(printed["runs"] == 8);
        CHECK(printed["done"] == 8);
        CHECK(printed["worlds"] == 2);
        CHECK_FALSE(printed.contains("wall_bands"));
        CHECK(printed["wire_steps"] == 4 * (150 + 300));
        const auto rows = results(folder.path / "B");
        REQUIRE(rows.size() == 8);
        int contacts = 0;
        for (const Row& row : rows) {
            std::string set;
            for (const char* key : {"scene.dt_s", "wire.bend_nm2", "wire.radius_m", "contact.mu_sliding"})
                set += fmt::format(" --set {}={}", key, row.at(key));
            CAPTURE(set);
            run_ok(folder, "run t.toml -o R --overwrite --quiet" + set);
            const auto alone = summary_of(folder.path / "R");
            CHECK(row.at("state_hash") == alone["state_hash"]);
            CHECK(row.at("status") == "done");
            for (const char* key :
                 {"steps", "simulated_s", "inserted_m", "nodes", "contacts_max", "friction_max_n", "hand_force_n",
                  "hand_torque_nm", "overlap_max_m", "newton_max", "halved_steps", "energy_j"}) {
                CAPTURE(key);
                CHECK(std::stod(row.at(key)) == alone[key].get<double>());
            }
            contacts += alone["contacts_max"].get<int>();
        }
        CHECK(contacts > 8);
    }

    TEST_CASE(
        "property: bands of an elastic wall are those of `run` without the step, and with --bands half the step's, and the "
        "summary says so")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.1)}, {"s.toml", "[vary]\n\"contact.mu_sliding\" = [0.1]\n"}};
        const std::string wall = " --set vessel.wall=elastic --set vessel.wall_edge_m=0.002";
        run_ok(folder, "batch t.toml --vary s.toml -o B --quiet" + wall);
        run_ok(folder, "run t.toml -o R --quiet --set contact.mu_sliding=0.1" + wall);
        run_ok(folder, "batch t.toml --vary s.toml -o H --bands --quiet" + wall);
        run_ok(folder, "batch t.toml --vary s.toml -o H2 --quiet --set scene.dt_s=0.0005" + wall);
        CHECK(summary_of(folder.path / "B")["wall_bands"] != summary_of(folder.path / "H")["wall_bands"]);
        const Row banded = results(folder.path / "H").at(0), half = results(folder.path / "H2").at(0);
        const auto alone = summary_of(folder.path / "R");
        const Row row = results(folder.path / "B").at(0);
        for (const std::string name : {"wall_move_max_band", "wall_stress_max_band"}) {
            CAPTURE(name);
            const auto& band = alone.at(name);
            const std::string unit = name == "wall_move_max_band" ? "_m" : "_pa";
            const double without =
                std::hypot(band.at("mesh").get<double>(), band.at("geometry").get<double>(), band.at("nodes").get<double>());
            CHECK(band.at("nodes").get<double>() > 0.01 * without);
            if (unit == "_m") REQUIRE(alone.at(name + unit).get<double>() > 1.02 * without);
            // a run reads the whole wall with each row of its trace, a batch does not: 0.2 % here; it has the share of nodes for
            // each per cent of the largest reading, which is 0.6 % of the band here
            CHECK(std::stod(row.at(name + unit)) == about(without).epsilon(0.01));
            const std::string reading = name.substr(0, name.size() - 5) + unit;
            const double by_step = 3 * std::abs(std::stod(row.at(reading)) - std::stod(half.at(reading)));
            // the whole wall is read with each row, at other moments in the batch of half the step: 3e-4 of this band, and the
            // step adds 2e-3 to that of the displacement
            CHECK(std::stod(banded.at(name + unit)) == about(std::hypot(std::stod(row.at(name + unit)), by_step)).epsilon(5e-4));
        }
    }

    TEST_CASE("property: what is kept of each run is what that run alone writes, in one piece, in parts and by a farm")
    {
        const ScratchFolder folder;
        folder.write("t.toml", tube_scene(0.06));
        folder.write("s.toml", "[vary]\n\"scene.duration_s\" = [0.05, 0.06]\n\"wire.bend_nm2\" = [1.0e-5, 3.0e-5]\n");
        run_ok(folder, "batch t.toml --vary s.toml -o B --keep traces,last-frame --bands --quiet");
        for (const Row& row : results(folder.path / "B")) {
            const std::string stem = fmt::format("B/runs/{:06}", std::stoi(row.at("run")));
            run_ok(folder, fmt::format("run t.toml -o R --overwrite --quiet --set scene.duration_s={} --set wire.bend_nm2={}",
                                       row.at("scene.duration_s"), row.at("wire.bend_nm2")));
            const auto kept = csv_rows(folder.path / (stem + ".csv")), alone = csv_rows(folder.path / "R/trace.csv");
            REQUIRE(kept.size() == alone.size());
            for (std::size_t c = 0; c < kept[0].size(); ++c) {
                const auto same = std::find(alone[0].begin(), alone[0].end(), kept[0][c]) - alone[0].begin();
                REQUIRE(same < std::ssize(alone[0]));
                for (std::size_t k = 1; k < kept.size(); ++k) CHECK(kept[k][c] == alone[k][static_cast<std::size_t>(same)]);
            }
            const std::string last = slurp(folder.path / fmt::format("R/wire_{:06}.vtp", std::stol(row.at("steps"))));
            CHECK(!last.empty());
            CHECK(slurp(folder.path / (stem + "_wire.vtp")) == last);
        }
        CHECK(std::distance(fs::directory_iterator(folder.path / "B/runs"), {}) == 8);  // none of half the step
        const auto same_as_whole = [&](const char* other) {
            for (const auto& file : fs::directory_iterator(folder.path / "B/runs"))
                CHECK(slurp(folder.path / other / "runs" / file.path().filename()) == slurp(file.path()));
        };
        const std::string parts = "batch t.toml --vary s.toml -o P --keep traces,last-frame --bands --quiet ";
        REQUIRE(run_app(folder, parts + "--time-limit 1e-6").code == 75);
        REQUIRE(run_app(folder, parts + "--resume --time-limit 1e-6").code == 75);
        run_ok(folder, parts + "--resume");
        same_as_whole("P");
        run_ok(folder, "farm t.toml --vary s.toml -o F --tasks 3 --keep traces,last-frame --quiet");
        same_as_whole("F");
        run_ok(folder, "batch t.toml --vary s.toml -o B --overwrite --quiet");
        CHECK_FALSE(fs::exists(folder.path / "B/runs"));
        check_refused(folder, "batch t.toml --vary s.toml -o W --keep frames", 2,
                      "--keep: got \"frames\"; expected traces, last-frame");
    }

    TEST_CASE("property: the table's bytes depend neither on threads nor on stops")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.3)}};
        // twenty wires: more than one piece of work for the pool
        folder.write(
            "s.toml",
            "[vary]\n\"scene.duration_s\" = [0.001, 0.3]\n\"wire.bend_nm2\" = {min = 1e-5, max = 1e-4, n = 20, log = true}\n");
        run_ok(folder, "batch t.toml --vary s.toml -o one --threads 1");
        run_ok(folder, "batch t.toml --vary s.toml -o three --threads 3");
        CHECK(summary_of(folder.path / "three")["threads"] == 3);
        const std::string csv = slurp(folder.path / "one/results.csv"), npz = slurp(folder.path / "one/results.npz");
        REQUIRE(csv.size() > 1000);
        CHECK(slurp(folder.path / "three/results.csv") == csv);
        CHECK(slurp(folder.path / "three/results.npz") == npz);

        // a limit that is over at once lets one step through. Under a limit worlds begin with one run and double. Those of one
        // step are done after five (1, 2, 4, 8 and the 5 left), and the sixth call stops within the first of the others
        const std::string parts = "batch t.toml --vary s.toml -o parts --quiet ";
        const auto stops_after = [&](const std::string& arguments) {
            const AppResult part = run_app(folder, parts + arguments);
            CAPTURE(part.err);
            REQUIRE(part.code == 75);
            REQUIRE(part.error_lines() == 1);
            CHECK(has(part.err, "--resume"));
        };
        stops_after("--time-limit 1e-6");
        for (int call = 1; call < 6; ++call) stops_after("--time-limit 1e-6 --resume");
        CHECK(summary_of(folder.path / "parts")["wire_steps"] == 20 + 1);
        CHECK(summary_of(folder.path / "parts")["done"] == 20);
        run_ok(folder, parts + "--resume");
        CHECK(slurp(folder.path / "parts/results.csv") == csv);
        CHECK(slurp(folder.path / "parts/results.npz") == npz);
        CHECK(summary_of(folder.path / "parts")["resumes"] == 6);
        // finished runs are not run again
        const AppResult again = run_ok(folder, "batch t.toml --vary s.toml -o parts --resume --json");
        CHECK(nlohmann::json::parse(again.out)["wire_steps"] == 20 + 20 * 300);
    }

    TEST_CASE(
        "property: of several instruments a row has what each run alone says of each, in one piece, taken up again, by a farm")
    {
        const ScratchFolder folder;
        folder.write("two.toml", two_instruments("merged"));
        folder.write("s.toml",
                     "[vary]\n\"coaxial.model\" = [\"merged\", \"separate\"]\n\"instrument.1.bend_nm2\" = [1e-5, 3e-5]\n");
        run_ok(folder, "batch two.toml --vary s.toml -o B --quiet");
        const auto rows = results(folder.path / "B");
        REQUIRE(rows.size() == 4);
        for (const Row& row : rows) {
            const std::string set = fmt::format("--set coaxial.model={} --set instrument.1.bend_nm2={}", row.at("coaxial.model"),
                                                row.at("instrument.1.bend_nm2"));
            CAPTURE(set);
            run_ok(folder, "run two.toml -o R --overwrite --quiet " + set);
            const auto alone = summary_of(folder.path / "R");
            CHECK(row.at("state_hash") == alone["state_hash"]);
            REQUIRE(alone["instruments"].size() == 2);
            for (const auto& of : alone["instruments"]) {
                const std::string name = of["name"].get<std::string>() + ".";
                CAPTURE(name);
                for (const char* key : {"inserted_m", "turned_rad", "nodes", "hand_force_n", "hand_torque_nm"})
                    CHECK(std::stod(row.at(name + key)) == of[key].get<double>());
                for (const int c : {0, 1, 2})
                    CHECK(std::stod(row.at(name + std::array{"tip_x_m", "tip_y_m", "tip_z_m"}[c])) ==
                          of["tip_m"][c].get<double>());
            }
            CHECK(row.at("wire.inserted_m") != row.at("catheter.inserted_m"));
        }
        const std::string csv = slurp(folder.path / "B/results.csv"), npz = slurp(folder.path / "B/results.npz");
        for (const char* name : {"catheter.hand_force_n", "wire.tip_z_m", "wire.nodes"})
            CHECK(has(npz, std::string(name) + ".npy"));
        AppResult part = run_app(folder, "batch two.toml --vary s.toml -o P --quiet --time-limit 1e-6");
        for (int call = 0; part.code == 75 && call < 100; ++call)
            part = run_app(folder, "batch two.toml --vary s.toml -o P --quiet --resume --time-limit 0.01");
        CHECK(part.code == 0);
        CHECK(slurp(folder.path / "P/results.csv") == csv);
        run_ok(folder, "farm two.toml --vary s.toml -o F --tasks 3");
        CHECK(slurp(folder.path / "F/results.csv") == csv);
        CHECK(slurp(folder.path / "F/results.npz") == npz);

        // side by side, where no [coaxial] names them
        std::string apart = two_instruments("merged");
        apart.erase(apart.find("[coaxial]"), apart.find("[vessel]") - apart.find("[coaxial]"));
        apart.insert(apart.rfind("[instrument.feed]\n") + 18, "point = [0.0, 0.0, 0.002]\ndirection = [1.0, 0.0, 0.0]\n");
        folder.write("apart.toml", apart);
        folder.write("names.toml", "[vary]\n\"instrument.1.name\" = [\"wire\", \"other\"]\n");
        check_refused(folder, "batch apart.toml --vary names.toml -o N", 2, "run 1 has instruments of other names");
        CHECK_FALSE(fs::exists(folder.path / "N"));
    }

    TEST_CASE("property: numpy reads the same table from the .npz as from the .csv")
    {
        const ScratchFolder folder;
        folder.write("f.toml", free_scene(0.02));
        folder.write("s.toml", "[vary]\n\"wire.density\" = [6450.0, 7900.0]\n\"scene.name\" = [\"a,b\", \"Gefäß\"]\n");
        run_ok(folder, "batch f.toml --vary s.toml -o B");
        folder.write("check.py", R"(import csv, sys
import numpy as np
table, rows = np.load("B/results.npz"), list(csv.DictReader(open("B/results.csv", encoding="utf-8")))
assert len(rows) == 4 and set(table.files) == set(rows[0]), (table.files, rows[0].keys())
for name in table.files:
    column = [row[name] for row in rows]
    kind = table[name].dtype.kind
    if kind == "f": assert np.array_equal(table[name], np.array(column, float)), name
    elif kind == "i": assert np.array_equal(table[name], np.array(column, int)), name
    else: assert list(table[name]) == column, name
assert table["wire.density"].dtype == float and table["steps"].dtype == np.int64 and table["scene.name"][1] == "Gef\u00e4\u00df"
print("same")
)");
        const fs::path out = folder.path / ".py";
        const int status = std::system(
            fmt::format("cd '{}' && /usr/bin/python3 check.py >'{}' 2>&1", folder.path.string(), out.string()).c_str());
        CAPTURE(slurp(out));
        CHECK(status == 0);
        CHECK(slurp(out) == "same\n");
    }

    TEST_CASE("property: static equilibria, and runs that come to rest at their own time")
    {
        const ScratchFolder folder{{"f.toml", free_scene(20.0)}, {"stiff.toml", "[vary]\n\"wire.bend_nm2\" = [5e-5, 2e-4]\n"}};
        for (const std::string set :
             {"--set integrator.scheme=static", "--set scene.until=rest --set integrator.damping_mass_1_s=40.0"}) {
            CAPTURE(set);
            run_ok(folder, "batch f.toml --vary stiff.toml -o B --overwrite " + set);
            const auto rows = results(folder.path / "B");
            REQUIRE(rows.size() == 2);
            for (const Row& row : rows) {
                run_ok(folder,
                       fmt::format("run f.toml -o R --overwrite {} --set wire.bend_nm2={}", set, row.at("wire.bend_nm2")));
                CHECK(row.at("state_hash") == summary_of(folder.path / "R")["state_hash"]);
                CHECK(std::stol(row.at("steps")) == summary_of(folder.path / "R")["steps"].get<long>());
            }
            CHECK(std::stod(rows[0].at("tip_z_m")) < std::stod(rows[1].at("tip_z_m")));  // the stiffer hangs less
        }
    }

    TEST_CASE("property: a run that stops leaves the others alone, and the batch says so with exit 4")
    {
        const ScratchFolder folder;
        // explicit integration far above the axial wave's limit ends at once, below it does not
        folder.write("f.toml", free_scene(0.01));
        folder.write("s.toml", "[vary]\n\"wire.stretch_n\" = [0.5, 7.0e12, 0.5]\n");
        const std::string set =
            " --set integrator.scheme=explicit --set scene.dt_s=1e-5 --set wire.bend_nm2=1e-9 --set wire.twist_nm2=1e-9";
        const AppResult result = check_refused(folder, "batch f.toml --vary s.toml -o B" + set, 4, "1 of 3 runs stopped");
        CHECK(has(result.err, "run 1 first"));
        const auto rows = results(folder.path / "B");
        REQUIRE(rows.size() == 3);
        CHECK(rows[1].at("status") == "stopped");
        CHECK(rows[0].at("status") == "done");
        CHECK(rows[2].at("state_hash") == rows[0].at("state_hash"));
        CHECK(rows[0].at("steps") == "1000");
        run_ok(folder, "run f.toml -o R --set wire.stretch_n=0.5" + set);
        CHECK(rows[0].at("state_hash") == summary_of(folder.path / "R")["state_hash"]);
    }

    TEST_CASE("property: designs are files with names: the answer, the table and a later start know them")
    {
        const ScratchFolder folder;
        folder.write("t.toml", tube_scene(0.05));
        folder.write("soft.toml", "[wire]\nbend_nm2 = 1.0e-5\n[[wire.section]]\nfrom_tip_m = [0.0, 0.02]\nbend_nm2 = 1e-6\n");
        folder.write("stiff.toml", "[wire]\nbend_nm2 = 3.0e-5\n");
        folder.write("s.toml", "[vary.design]\nsoft = \"soft.toml\"\nstiff = \"stiff.toml\"\n");
        folder.write("lost.toml",
                     "[wire]\npreset = \"terumo-angled-035\"\n[[wire.section]]\nfrom_tip_m = [0.0, 0.02]\nbend_nm2 = 1e-6\n");
        folder.write("l.toml", "[vary.design]\nkept = \"stiff.toml\"\nlost = \"lost.toml\"\n");
        const AppResult lost =
            run_app(folder, "batch t.toml --vary l.toml -o L");  // what a scene warns of, a batch says, with the run
        CHECK(has(lost.out, "  note: run 1 (lost): wire.section: replaces all sections of \"terumo-angled-035\""));
        CHECK_FALSE(has(lost.out, "run 0 (kept): wire.section"));
        CHECK(run_app(
                  folder,
                  "check t.toml --set wire.preset=terumo-angled-035 --set 'wire.section=[{from_tip_m=[0.0,0.02],bend_nm2=1e-6}]'")
                  .out.find("  note: wire.section: replaces all sections") != std::string::npos);
        run_ok(folder, "batch t.toml --vary s.toml -o B");
        const auto rows = results(folder.path / "B");
        REQUIRE(rows.size() == 2);
        CHECK(rows[0].at("design") == "soft");
        CHECK(rows[1].at("design") == "stiff");
        run_ok(folder, "run t.toml -o R --set wire.bend_nm2=3e-5");
        CHECK(rows[1].at("state_hash") == summary_of(folder.path / "R")["state_hash"]);
        CHECK(rows[0].at("state_hash") != rows[1].at("state_hash"));
        run_ok(folder, "batch t.toml --vary s.toml -o B --resume");
        if (fs::exists("/usr/share/javascript/three/three.min.js")) {  // a report's commands repeat what the design's file sets
            run_ok(folder, "report B");
            CHECK(has(slurp(folder.path / "B/report.html"), "\"stiff\":[\"wire.bend_nm2=3e-05\"]"));
        }
        // the folder's own sweep needs no other file; a design that has changed is another sweep
        run_ok(folder, "batch t.toml --vary B/sweep.toml -o C");
        CHECK(results(folder.path / "C")[0].at("state_hash") == rows[0].at("state_hash"));
        folder.write("stiff.toml", "[wire]\nbend_nm2 = 4.0e-5\n");
        CHECK(has(run_app(folder, "batch t.toml --vary s.toml -o B --resume").err, "differs"));
        folder.write("stiff.toml", "[wire]\nbend_nm2 = -1.0\n");
        check_refused(folder, "batch t.toml --vary s.toml -o D", 2,
                      "s.toml:1: vary.design: run 1 (stiff): wire.bend_nm2: got -1.0");
    }

    TEST_CASE("property: refusals are those of `run`, before anything is written")
    {
        const ScratchFolder folder{{"f.toml", free_scene(0.01)}, {"s.toml", "[vary]\n\"wire.density\" = [6450.0, 7900.0]\n"}};
        const auto says = [&](const std::string& arguments, int code, const std::string& what) {
            const AppResult result = run_app(folder, "batch " + arguments);
            CAPTURE(arguments);
            CAPTURE(result.err);
            CHECK(result.code == code);
            CHECK(result.error_lines() == 1);
            CHECK(has(result.err, what));
        };
        says("f.toml -o B", 2, "--vary");
        says("f.toml --vary none.toml -o B", 3, "none.toml");
        says("none.toml --vary s.toml -o B", 3, "none.toml");
        folder.write("bad.toml", "[vary]\n\"wire.nodes\" = [21]\n\"wire.density\" = [6450.0, -1.0]\n");
        says("f.toml --vary bad.toml -o B", 2,
             "bad.toml:3: vary.wire.density: run 1 (wire.nodes=21, wire.density=-1.0): wire.density: got -1.0; expected a number "
             "above 0");
        folder.write("typo.toml", "[vary]\n\"wire.densty\" = [6450.0]\n");
        says("f.toml --vary typo.toml -o B", 2, "nearest known one is wire.density");
        says("f.toml --vary s.toml -o B --threads 0", 2, "threads");
        CHECK_FALSE(fs::exists(folder.path / "B"));
        run_ok(folder, "batch f.toml --vary s.toml -o B");
        says("f.toml --vary s.toml -o B", 2, "--overwrite");
        says("f.toml --vary s.toml -o B --resume --set wire.nodes=31", 2, "differs");
        folder.write("other.toml", "[vary]\n\"wire.density\" = [6450.0]\n");
        says("f.toml --vary other.toml -o B --resume", 2, "differs");
        run_ok(folder, "batch f.toml --vary other.toml -o B --overwrite");
        CHECK(results(folder.path / "B").size() == 1);
        folder.write("B/checkpoint.bin", "SELBATC1 torn");
        says("f.toml --vary other.toml -o B --resume", 3, "checkpoint.bin");
    }
}

}  // namespace seldinger::test::test_batch

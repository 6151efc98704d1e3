// What `seldinger run` writes and prints.

#include "apps/app_fixture.h"
#include "io/vtp_read.h"
#include "support/approx.h"
#include "support/scenes.h"
#include "support/skip.h"

#include <cmath>
#include <cstring>

namespace seldinger::test::test_run {

namespace {

double number(const std::vector<std::vector<std::string>>& rows, std::size_t row, const std::string& column)
{
    const auto at = std::find(rows[0].begin(), rows[0].end(), column);
    REQUIRE(at != rows[0].end());
    return std::stod(rows.at(row).at(static_cast<std::size_t>(at - rows[0].begin())));
}

}  // namespace

TEST_SUITE("apps/run")
{
    TEST_CASE("property: a run in a tube writes every file of the contract, and they agree with each other")
    {
        const ScratchFolder folder{{"t.toml", tube_scene()}};
        const AppResult result = run_app(folder, "run t.toml -o D --json --set vessel.youngs_pa=1e9");  // no sinking to warn of
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        CHECK(result.err.empty());
        const auto printed = nlohmann::json::parse(result.out);  // one object and nothing else, or this throws
        const fs::path dir = folder.path / "D";
        const auto summary = summary_of(dir);
        CHECK(printed == summary);
        for (const char* key :
             {"steps",         "simulated_s",    "wall_s",       "steps_per_s",    "realtime_factor", "inserted_m",
              "contacts_max",  "friction_max_n", "hand_force_n", "hand_torque_nm", "base_force_n",    "remesh_energy_j",
              "overlap_max_m", "outside_max_m",  "newton_max",   "energy_j",       "stage_ms",        "state_hash",
              "model",         "device",         "version"}) {
            CAPTURE(key);
            CHECK(summary.contains(key));
            CHECK_FALSE(summary[key].is_null());
        }
        for (const char* stage : {"detect", "evaluate", "reduce", "solve", "wall", "adapt", "record"})
            CHECK(summary["stage_ms"][stage].is_number());
        CHECK(summary["steps"] == 300);
        CHECK(summary["simulated_s"].get<double>() == about(0.3));
        CHECK(summary["inserted_m"].get<double>() == about(0.08 * 0.3));  // advance since the start
        CHECK(summary["contacts_max"].get<int>() > 0);                    // it does reach the floor
        CHECK(summary["warnings"].empty());

        const std::string header = slurp(dir / "trace.csv");
        CHECK(header.starts_with(
            "step,time_s,inserted_m,turned_rad,nodes,contacts,normal_n,friction_n,sliding_n,static_n,rolling_nm,"
            "hand_force_n,hand_torque_nm,overlap_m,newton,step_ms"));
        const auto trace = csv_rows(dir / "trace.csv");
        REQUIRE(trace.size() == 1 + 300 / 5);
        double friction = 0;
        for (std::size_t k = 1; k < trace.size(); ++k) {
            REQUIRE(trace[k].size() == trace[0].size());
            CHECK(number(trace, k, "step") == 5.0 * static_cast<double>(k));
            // sums of the same numbers in another order: rounding only
            CHECK(number(trace, k, "friction_n") ==
                  about(number(trace, k, "sliding_n") + number(trace, k, "static_n")).epsilon(1e-12));
            friction = std::max(friction, number(trace, k, "friction_n"));
        }
        CHECK(friction > 0);
        CHECK(summary["friction_max_n"].get<double>() >= friction);  // over every step, not only recorded ones
        const std::size_t last = trace.size() - 1;
        CHECK(summary["energy_j"].get<double>() ==
              about(number(trace, last, "kinetic_j") + number(trace, last, "elastic_j") + number(trace, last, "gravitational_j"))
                  .epsilon(1e-12));

        const auto wire = csv_rows(dir / "wire.csv");
        CHECK(wire[0] ==
              std::vector<std::string>{"s_m", "x_m", "y_m", "z_m", "vx", "vy", "vz", "spin_rad", "fx_n", "fy_n", "fz_n"});
        REQUIRE(wire.size() == 1 + summary["nodes"].get<std::size_t>());
        CHECK(number(wire, 1, "s_m") == 0.0);  // tip first
        CHECK(number(wire, wire.size() - 1, "s_m") == about(0.004 + 0.08 * 0.3).epsilon(1e-3));
        CHECK(wire.back()[7] == wire[wire.size() - 2][7]);  // spin of the last row repeats

        const auto contacts = csv_rows(dir / "contacts.csv");
        CHECK(slurp(dir / "contacts.csv").starts_with("edge,triangle,x_m,y_m,z_m,nx,ny,nz,gap_m,normal_n,friction_n,stuck"));
        REQUIRE(contacts.size() == 1 + static_cast<std::size_t>(number(trace, last, "contacts")));
        double normal = 0;
        for (std::size_t k = 1; k < contacts.size(); ++k) {
            normal += number(contacts, k, "normal_n");
            const double stuck = number(contacts, k, "stuck");
            CHECK((stuck == 0 || stuck == 1));
            CHECK(std::hypot(number(contacts, k, "nx"), number(contacts, k, "ny"), number(contacts, k, "nz")) ==
                  about(1).epsilon(1e-6));
        }
        CHECK(normal == about(number(trace, last, "normal_n")).epsilon(1e-9));
    }

    TEST_CASE("property: the ParaView series can be read and ends in the final state")
    {
        const ScratchFolder folder{{"t.toml", tube_scene()}};
        run_ok(folder, "run t.toml -o D");
        const fs::path dir = folder.path / "D";
        const std::string pvd = slurp(dir / "wire.pvd");
        const auto count = [&](const std::string& word) {
            long found = 0;
            for (std::size_t at = pvd.find(word); at != std::string::npos; at = pvd.find(word, at + 1)) ++found;
            return found;
        };
        CHECK(count("<DataSet") == 101);  // about 100 frames: every third of 300 steps, and the start
        CHECK(count("wire_000300.vtp") == 1);
        const PolyData wire = read_poly_data(dir / "wire_000300.vtp");
        const auto table = csv_rows(dir / "wire.csv");
        REQUIRE(wire.points.size() == table.size() - 1);
        for (std::size_t i = 0; i < wire.points.size(); ++i)
            for (int d = 0; d < 3; ++d) CHECK(wire.points[i][d] == number(table, i + 1, d == 0 ? "x_m" : d == 1 ? "y_m" : "z_m"));
        CHECK(wire.lines.offsets.size() == 1);
        // the same frames as one array: the last one begins at the tip and ends at the last node
        const std::string npz = slurp(dir / "wire.npz"), shape = "'shape': (101, 64, 3), }";
        REQUIRE(has(npz, "time_s.npy"));
        REQUIRE(has(npz, "position_m.npy"));
        const std::size_t data = npz.find('\n', npz.find(shape)) + 1;
        REQUIRE(has(npz, shape));
        const auto position = [&](std::size_t station, std::size_t d) {
            double value = 0;
            std::memcpy(&value, npz.data() + data + sizeof(double) * ((100 * 64 + station) * 3 + d), sizeof value);
            return value;
        };
        for (std::size_t d = 0; d < 3; ++d) {
            CHECK(position(0, d) == wire.points.front()[d]);
            CHECK(std::abs(position(63, d) - wire.points.back()[d]) < 1e-15);  // [m], of decimetres
        }
        CHECK(wire.point_data.at("radius").values[0] == 0.0004445);
        CHECK(wire.point_data.at("contact_force").components == 3);
        const PolyData contacts = read_poly_data(dir / "contacts_000300.vtp");
        CHECK(contacts.points.size() == csv_rows(dir / "contacts.csv").size() - 1);
        CHECK(contacts.point_data.at("normal_n").values.size() == contacts.points.size());
        const PolyData vessel = read_poly_data(dir / "vessel.vtp");
        REQUIRE(vessel.polys.offsets.size() > 1000);
        // normals into the lumen: triangle 0's points at the axis (x axis)
        const auto corner = [&](int k) { return vessel.points[static_cast<std::size_t>(vessel.polys.connectivity[k])]; };
        const auto a = corner(0), b = corner(1), c = corner(2);
        const double ny = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
        const double nz = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        CHECK(ny * a[1] + nz * a[2] < 0);
    }

    TEST_CASE("property: the resolved scene, run again elsewhere, gives the same bits")
    {
        const ScratchFolder folder{{"t.toml", tube_scene()}};
        run_ok(folder, "run t.toml -o A --set contact.mu_sliding=0.05 --set scene.duration_s=0.2");
        run_ok(folder, "run A/scene.toml -o B/deeper");
        CHECK(summary_of(folder.path / "A")["state_hash"] == summary_of(folder.path / "B/deeper")["state_hash"]);
        CHECK(timeless_trace(folder.path / "A") == timeless_trace(folder.path / "B/deeper"));
        CHECK(slurp(folder.path / "A/scene.toml") == slurp(folder.path / "B/deeper/scene.toml"));
        // and --set was not without effect
        run_ok(folder, "run t.toml -o C --set scene.duration_s=0.2");
        CHECK(summary_of(folder.path / "A")["state_hash"] != summary_of(folder.path / "C")["state_hash"]);
    }

    TEST_CASE("property: --overwrite leaves nothing of the old run, and nothing else is touched")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.05)}};
        run_ok(folder, "run s.toml -o D");
        folder.write("D/notes.txt", "mine");
        REQUIRE(fs::exists(folder.path / "D/wire_000050.vtp"));
        run_ok(folder, "run s.toml -o D --overwrite --set scene.duration_s=0.02");
        CHECK_FALSE(fs::exists(folder.path / "D/wire_000050.vtp"));
        CHECK(slurp(folder.path / "D/notes.txt") == "mine");
        CHECK(summary_of(folder.path / "D")["steps"] == 20);
    }

    TEST_CASE("property: the folder is named after the scene when none is given, and quiet is quiet")
    {
        const ScratchFolder folder{{"s.toml", free_scene()}};
        const AppResult loud = run_ok(folder, "run s.toml");
        CHECK(loud.err.empty());  // no progress where stderr is no terminal
        CHECK(has(loud.out, "s-run: summary.json, trace.csv"));
        CHECK(fs::exists(folder.path / "s-run" / "summary.json"));
        const AppResult quiet = run_ok(folder, "run s.toml --overwrite --quiet");
        CHECK(quiet.out.empty());
    }

    TEST_CASE("property: a wall moved farther than contact with it is exact is flagged, by loads far from the wire too")
    {
        const ScratchFolder folder;
        folder.write("w.toml", static_scene + wire_text(0.01, 1e-5, 1e-5, 5, 2e-4, 8000) + held_base +
                                   tube_text(0.012, 0.06, 2000) +
                                   "origin = [-0.03, 0.0, 0.0]\nwall = \"elastic\"\nthickness_m = 0.0015\nwall_edge_m = 0.004\n"
                                   "[[wall_load]]\nat = [0.0, 0.0, 0.012]\nforce_n = [0.0, 0.0, 2.0]\n");
        for (const bool far : {true, false}) {
            CAPTURE(far);
            // 2 N takes the wall 0.31 radii away, 0.1 N 0.03: it stiffens
            const std::string set = far ? "" : " --set 'wall_load.0.force_n=[0.0, 0.0, 0.1]'";
            run_ok(folder, "run w.toml -o D --overwrite" + set);
            const auto summary = summary_of(folder.path / "D");
            CHECK((summary["wall_move_max_m"].get<double>() > 0.2 * 0.012) == far);
            CHECK(summary["wall_nonlinear_steps"] == (far ? 1 : 0));
            CHECK(summary["wall_far_steps"] == summary["wall_nonlinear_steps"]);  // old name, until 0.3.0
            CHECK((summary["warnings"].dump().find("20 % of the lumen's radius") != std::string::npos) == far);
            const auto rows = csv_rows(folder.path / "D" / "trace.csv");
            const auto column = std::find(rows[0].begin(), rows[0].end(), "flags") - rows[0].begin();
            CHECK(rows.at(1).at(column) == (far ? "4" : "0"));
        }
    }

    TEST_CASE("property: coarse control edges are warned about where the wall has moved, and not where nothing has touched it")
    {
        const ScratchFolder folder;
        folder.write("w.toml", static_scene + wire_text(0.02, 1e-5, 1e-5, 21, 4e-4, 8000) +
                                   "place = { shape = \"straight\", base = [-0.01, 0.0, 0.0004] }\n"
                                   "[[load]]\nat = 0.01\nforce_n = [0.0, 0.0, -0.005]\n"
                                   "[vessel]\nshape = \"plane\"\nsize_m = 0.06\nwall = \"elastic\"\nyoungs_pa = 0.5e6\n"
                                   "thickness_m = 0.0009\nsupport_pa_m = 3e6\nwall_edge_m = 0.005\n");
        // the decay length is 2.67 mm, so edges are nearly two of them
        for (const bool touches : {true, false}) {
            CAPTURE(touches);
            const std::string away =
                touches ? "" : " --set 'wire.place.base=[-0.01, 0.0, 0.01]' --set 'load.0.force_n=[0.0, 0.0, 0.0]'";
            run_ok(folder, "run w.toml -o D --overwrite" + away);
            const auto summary = summary_of(folder.path / "D");
            CHECK((summary["wall_move_max_m"].get<double>() > 1e-6) == touches);
            CHECK((summary["warnings"].dump().find("vessel.wall_edge_m: got control edges of 5") != std::string::npos) ==
                  touches);
        }
    }

    TEST_CASE("analytic: a static scene is one solve; its tip is where the elastica says")
    {
        const ScratchFolder folder;
        // P L^2 / B = 1, clamped base, dead load across the tip: x/L = 1 - 0.05643, z/L = -0.30172 [Mattiasson 1981, table 1,
        // doi:10.1002/nme.1620170111]; the error of 40 edges is about (h/L)^2 / 12 * alpha, well below 1e-3
        folder.write("e.toml", static_scene + wire_text(0.1, 5e-5, 4.2e-5, 41, 0.000178, 6450, 6966) + held_base +
                                   "[[load]]\nat = \"tip\"\nforce_n = [0.0, 0.0, -0.005]\n");
        run_ok(folder, "run e.toml -o D");
        const auto wire = csv_rows(folder.path / "D/wire.csv");
        CHECK(number(wire, 1, "x_m") == about(0.1 * (1 - 0.05643)).epsilon(1e-3));
        CHECK(number(wire, 1, "z_m") == about(-0.1 * 0.30172).epsilon(1e-3));
        CHECK(csv_rows(folder.path / "D/trace.csv").size() == 2);
        CHECK(summary_of(folder.path / "D")["steps"] == 0);
    }

    TEST_CASE("property: until = rest stops when the wire rests, not at a turning point and not before the load is on")
    {
        const ScratchFolder folder;
        folder.write(
            "s.toml",
            free_scene(10.0) +
                "[[load]]\nat = \"tip\"\nforce_n = [0.0, 0.0, -0.001]\nramp_s = 0.2\n[integrator]\ndamping_mass_1_s = 60.0\n");
        run_ok(folder, "run s.toml -o D --set scene.until=rest");
        const auto summary = summary_of(folder.path / "D");
        CHECK(summary["at_rest"] == true);
        CHECK(summary["steps"].get<int>() > 200);   // the ramp
        CHECK(summary["steps"].get<int>() < 5000);  // damped with 1/60 s: at rest long before
        // where it rests, the base carries weight and load: m g + F, m = rho pi r^2 L
        const double weight = 6450 * 3.14159265358979 * 4e-8 * 0.1 * 9.81;
        CHECK(summary["base_force_n"][2].get<double>() == about(weight + 0.001).epsilon(0.01));
    }

    TEST_CASE("property: a simulation that cannot go on is exit 4, names a setting, and leaves what is good")
    {
        const ScratchFolder folder;
        // 80 mm in a millisecond: 0.08 m in one step of a tube of 0.1 m
        std::string scene = tube_scene();
        scene.replace(scene.find("{t_s = 1.0, advance_m"), 21, "{t_s = 0.001, advance_m");
        folder.write("t.toml", scene);
        check_refused(folder, "run t.toml -o D --quiet", 4, "scene.dt_s");
        CHECK(summary_of(folder.path / "D")["status"] == "stopped");
        const auto wire = csv_rows(folder.path / "D/wire.csv");
        REQUIRE(wire.size() > 2);
        for (std::size_t row = 1; row < wire.size(); ++row)
            for (const std::string& cell : wire[row]) CHECK(std::isfinite(std::stod(cell)));
    }

    TEST_CASE("property: a picture of a run")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.05)}};
        run_ok(folder, "run t.toml -o D");
        const AppResult result = run_app(folder, "render D --size 320x180");
        if (result.code == 5 || result.err.find("no renderer") != std::string::npos) {
            skip("nothing to draw with");
            return;
        }
        CAPTURE(result.err);
        CHECK(result.code == 0);
        CHECK(fs::file_size(folder.path / "D/picture.png") > 2000);
        CHECK(run_app(folder, "render D --frames 0:100000").code == 2);
    }

    TEST_CASE("property: version, help and devices")
    {
        const ScratchFolder folder;
        CHECK(run_app(folder, "--version").out.starts_with("seldinger 0."));
        const AppResult help = run_ok(folder, "run --help");
        CHECK(has(help.out, "--time-limit"));
        CHECK(run_app(folder, "devices").out.starts_with("0: "));
    }

    TEST_CASE("property: a scene that comes with the program is found by its name, but a file of that name comes first")
    {
        const ScratchFolder folder;
        run_ok(folder, "check bounce");
        check_refused(folder, "check bounces", 3, "bounces");
        folder.write("bounce", "[no_such_table]\n");
        const AppResult own = run_app(folder, "check bounce");
        CHECK(own.code != 0);
        CHECK(has(own.err, "no_such_table"));
    }
}

}  // namespace seldinger::test::test_run

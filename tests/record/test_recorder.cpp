// The parts of a recording on their own: VTK files, checkpoints, tables with non-finite numbers.

#include "core/error.h"
#include "io/vtp_read.h"
#include "io/vtp_write.h"
#include "record/checkpoint.h"
#include "record/recorder.h"
#include "setup/key_frames.h"
#include "setup/scene_setup.h"
#include "support/approx.h"
#include "support/scenes.h"
#include "support/temporary_folder.h"
#include "world/world.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

namespace seldinger::test::test_recorder {

namespace {

const std::string hanging = scene_text(0.01, 1e-3, "record_every = 4\n") + wire_text(0.1, 5e-5, 4e-5, 11, 2e-4, 6450, 7000) +
                            "[[hold]]\nat = \"base\"\nposition = true\n";

/// A wire fed through a tube; {}: record_every.
constexpr const char* through =
    "[scene]\nduration_s = 0.5\ndt_s = 0.003\nrecord_every = {}\ngravity = [0.0, 0.0, -9.81]\n"
    "[wire]\nlength_m = 0.12\nradius_m = 0.0004\ndensity = 7900.0\nbend_nm2 = 1e-4\ntwist_nm2 = 8e-5\nstretch_n = 1e4\nnodes = "
    "41\n"
    "[vessel]\nshape = \"tube\"\naxis = [1.0, 0.0, 0.0]\nradius_m = 0.004\nlength_m = 0.04\ntriangles = 2000\n"
    "[feed]\npoint = [0.002, 0.0, -0.003]\ndirection = [1.0, 0.0, -0.04]\n"
    "keys = [{{ t_s = 0.0, advance_m = 0.005 }}, {{ t_s = 0.5, advance_m = 0.055 }}]\n";

}  // namespace

TEST_SUITE("record/recorder")
{
    TEST_CASE("twin: what VtpWriter writes, the reader of the pictures reads, bit for bit")
    {
        const std::vector<Vec3> points = {{0.1, -2e-9, 3}, {1.0 / 3, 5, 6}, {7, 8, 9}, {1e300, 0, -0.0}};
        VtpWriter out(points);
        out.set_verts();
        out.set_line();
        const std::vector<std::array<std::int32_t, 3>> triangles = {{0, 1, 2}, {2, 1, 3}};
        out.set_polys(triangles);
        const std::vector<double> scalar = {1, 2, 3, 0.1};
        out.add_point_data("radius", 1, scalar);
        out.add_point_vectors("force", points);
        const PolyData data = parse_poly_data(out.bytes(), "test");
        REQUIRE(data.points.size() == 4);
        for (std::size_t i = 0; i < 4; ++i)
            for (int d = 0; d < 3; ++d) CHECK(data.points[i][d] == points[i][d]);
        CHECK(data.verts.offsets == std::vector<std::int64_t>{1, 2, 3, 4});
        CHECK(data.lines.connectivity == std::vector<std::int64_t>{0, 1, 2, 3});
        CHECK(data.lines.offsets == std::vector<std::int64_t>{4});
        CHECK(data.polys.connectivity == std::vector<std::int64_t>{0, 1, 2, 2, 1, 3});
        CHECK(data.polys.offsets == std::vector<std::int64_t>{3, 6});
        CHECK(data.point_data.at("radius").values == scalar);
        CHECK(data.point_data.at("force").components == 3);
        CHECK(parse_poly_data(VtpWriter(std::vector<Vec3>{}).bytes(), "empty").points.empty());
    }

    TEST_CASE("property: a wall of 30,000 triangles stays below 3 MB")
    {
        // as many vertices as a closed surface has: V = T / 2 + 2
        WallMesh mesh;
        mesh.vertices.assign(15002, Vec3(0.1, 0.2, 0.3));
        mesh.triangles.assign(30000, {0, 1, 2});
        VtpWriter out(mesh.vertices);
        out.set_polys(mesh.triangles);
        CHECK(out.bytes().size() < 3'000'000);
    }

    TEST_CASE("property: a checkpoint comes back as it was, and one damaged byte anywhere is found")
    {
        const TemporaryFolder folder;
        const auto file = folder.path() / "checkpoint.bin";
        Checkpoint saved{.version = version(), .device = "some device", .vessel_hash = 77, .status = RunStatus::Interrupted};
        saved.tally.steps = 123;
        saved.tally.friction_max = 0.25;
        saved.trace_bytes = {4567, 89};
        saved.wire_frames = {{0, 0.0}, {3, 0.003}};
        saved.state = {1, 2, 3, 255};
        write_checkpoint(file, saved);
        const Checkpoint read = read_checkpoint(file);
        CHECK(read.device == saved.device);
        CHECK(read.vessel_hash == 77);
        CHECK(read.status == RunStatus::Interrupted);
        CHECK(std::memcmp(&read.tally, &saved.tally, sizeof(RunTally)) == 0);
        CHECK(read.trace_bytes == saved.trace_bytes);
        REQUIRE(read.wire_frames.size() == 2);
        CHECK(read.wire_frames[1].step == 3);
        CHECK(read.contact_frames.empty());
        CHECK(read.state == saved.state);

        const std::string good = read_file(file);
        for (std::size_t i = 0; i < good.size(); ++i) {
            std::string bad = good;
            bad[i] = static_cast<char>(bad[i] ^ 0x10);
            write_file(file, bad);
            CAPTURE(i);
            CHECK_THROWS_AS((void)read_checkpoint(file), Error);
        }
        for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{20}, good.size() - 1}) {
            write_file(file, good.substr(0, size));
            CHECK_THROWS_AS((void)read_checkpoint(file), Error);
        }
        saved.version = "0.0.0-other";
        write_checkpoint(file, saved);
        CHECK_THROWS_AS((void)read_checkpoint(file), Error);
    }

    TEST_CASE("property: a number that is not finite is an empty field and a null, and the summary says so")
    {
        const TemporaryFolder folder;
        const Scene scene = read_scene_text(hanging, folder.path() / "scene-file.toml");
        World world(make_setup(scene));
        const RepairReport none;
        Recorder recorder(scene, none, world, folder.path() / "run");
        for (int k = 0; k < 4; ++k) {
            const StepReport report = step(world, scene.dt);
            REQUIRE_FALSE(report.failed());
            if (k == 3) data_of(world).rod(0).x[0] = std::numeric_limits<double>::quiet_NaN();  // behind the solver's back
            recorder.stepped(world.output(), report, 0.001);
        }
        const auto summary = nlohmann::json::parse(recorder.finish(world, RunStatus::Stopped, 0.1));
        const std::string table = read_file(folder.path() / "run" / "wire.csv");
        const std::size_t row = table.find('\n') + 1;
        CHECK(table.substr(row, 3) == "0,,");
        CHECK(table.find("nan") == std::string::npos);
        REQUIRE(summary["warnings"].size() == 1);
        CHECK(summary["warnings"][0].get<std::string>().find("2 numbers were not finite") !=
              std::string::npos);  // in the trace and in wire.csv
        CHECK(summary["status"] == "stopped");
    }

    // A twin of half the step finds no difference in a step that was divided: with a third of them, 1.5 times the difference is
    // what it would be without safety. A step that missed the tolerance in its smallest parts is no state of equilibrium at all.
    TEST_CASE(
        "property: divided steps are counted, and are a warning from a third on; a single one that missed the tolerance is one")
    {
        const TemporaryFolder folder;
        const Scene scene = read_scene_text(hanging, folder.path() / "scene-file.toml");
        const World world(make_setup(scene));
        SummaryNotes notes;
        notes.scene = &scene;
        const auto summary_of = [&](int count, unsigned flag) {
            RunTally tally;
            tally.steps = 999;
            for (int k = 0; k < 999; ++k) tally.take_in(world.readings(0), k < count ? flag : 0u, 1, 1e-3);
            return nlohmann::json::parse(summary_json(world, tally, notes));
        };
        const auto few = summary_of(333, StepHalved), many = summary_of(334, StepHalved);
        CHECK(few["halved_steps"] == 333);
        CHECK(few["warnings"].empty());
        CHECK(many["halved_steps"] == 334);
        REQUIRE(many["warnings"].size() == 1);
        CHECK(many["warnings"][0].get<std::string>().find("334 of 999 steps were halved") != std::string::npos);
        const auto missed = summary_of(1, StepBestEffort);
        REQUIRE(missed["warnings"].size() == 1);
        CHECK(missed["warnings"][0].get<std::string>().find("1 of 999 steps missed the tolerance") != std::string::npos);
    }

    TEST_CASE("property: spin_rad grows with spin_rad_s, in the sense of every other turn")
    {
        const TemporaryFolder folder;
        std::string text = hanging;
        text.insert(text.find("nodes"), "spin_rad_s = 2.0\n");
        const Scene scene = read_scene_text(text, folder.path() / "scene-file.toml");
        World world(make_setup(scene));
        const RepairReport none;
        Recorder recorder(scene, none, world, folder.path() / "run");
        for (int k = 0; k < 10; ++k) {
            const StepReport report = step(world, scene.dt);
            REQUIRE_FALSE(report.failed());
            recorder.stepped(world.output(), report, 0.001);
        }
        (void)recorder.finish(world, RunStatus::Done, 0.1);
        const std::string table = read_file(folder.path() / "run" / "wire.csv");
        std::string row = table.substr(table.find('\n') + 1);
        for (int k = 0; k < 7; ++k) row.erase(0, row.find(',') + 1);
        CHECK(std::stod(row) == test::about(0.02).epsilon(1e-6));  // 2 rad/s for 10 ms, nothing against it
    }

    TEST_CASE(
        "property: the greatest loads and hand force, with place and time, are those of every step however few rows there are")
    {
        const auto run = [](int every) {
            const TemporaryFolder folder;
            const Scene scene = read_scene_text(fmt::format(through, every), folder.path() / "scene-file.toml");
            World world(make_setup(scene));
            const RepairReport none;
            KeyFrames keys(scene);
            Recorder recorder(scene, none, world, folder.path() / "run");
            int read = 0;
            Output now;
            for (long k = 0; k < scene.steps(); ++k) {
                const StepReport report = step(world, keys.control(), scene.step_length(k));
                REQUIRE_FALSE(report.failed());
                const unsigned parts = recorder.wants(world);
                read += (parts & (Output::Contacts | Output::Loads)) != 0;
                world.read(now, parts);
                recorder.stepped(now, report, 0.001);
            }
            auto summary = nlohmann::json::parse(recorder.finish(world, RunStatus::Done, 0.1));
            summary["read"] = read;
            return summary;
        };
        const auto every_row = run(1), few_rows = run(1000);
        CHECK(every_row["state_hash"] == few_rows["state_hash"]);
        CHECK(few_rows["patch_force_max_n"].get<double>() > 0);
        for (const char* key :
             {"force_per_length_max_n_per_m", "force_per_length_max_at_m", "force_per_length_max_at_s", "patch_force_max_n",
              "patch_force_max_at_m", "patch_force_max_at_s", "hand_force_max_n", "hand_force_max_at_s"}) {
            CAPTURE(key);
            CHECK(every_row[key] == few_rows[key]);
        }
        // the greatest is neither in the last step, which is always read, nor read in every step
        CHECK(few_rows["patch_force_max_at_s"].get<double>() < few_rows["simulated_s"].get<double>());
        CHECK(few_rows["read"].get<int>() < every_row["read"].get<int>());
    }

    TEST_CASE("property: the last step is recorded even when it is not due")
    {
        const TemporaryFolder folder;
        const Scene scene = read_scene_text(hanging, folder.path() / "scene-file.toml");
        World world(make_setup(scene));
        const RepairReport none;
        Recorder recorder(scene, none, world, folder.path() / "run");
        for (int k = 0; k < 10; ++k) {
            const StepReport report = step(world, scene.dt);
            recorder.stepped(world.output(), report, 0.001);
        }
        (void)recorder.finish(world, RunStatus::Done, 0.1);
        const std::string trace = read_file(folder.path() / "run" / "trace.csv");
        CHECK(std::count(trace.begin(), trace.end(), '\n') == 4);  // header, steps 4, 8 and 10
        CHECK(trace.find("\n10,") != std::string::npos);
        CHECK(read_checkpoint(folder.path() / "run" / "checkpoint.bin").status == RunStatus::Done);
    }
}

}  // namespace seldinger::test::test_recorder

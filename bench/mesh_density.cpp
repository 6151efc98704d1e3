// Step time against mesh density: the same wire in the same vessel, Loop-subdivided round by round.
//
//     mesh_density SCENE.toml [--rounds 4] [--first 0] [--steps N] [--repeat 1] [--csv FILE] [--set table.key=value]…
//
// A row per round: triangles; tree build rate (two threads, median of three); resident bytes per triangle; steps per second;
// processor time; time of each stage. Resident bytes are those of the world's arrays, and the growth of the resident set.
// Processor time is the least of the repeats. A step is one thread's work unless thousands of samples touch.

#include "core/clock.h"
#include "core/error.h"
#include "core/exit_code.h"
#include "core/file_io.h"
#include "setup/key_frames.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "shapes/subdivide.h"
#include "vessel/tree.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <malloc.h>
#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>

namespace {

using namespace seldinger;

double processor_time()
{
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Memory of this process in RAM [bytes]; freed memory has been given back.
double resident()
{
    malloc_trim(0);
    std::ifstream in("/proc/self/statm");
    double pages = 0, in_ram = 0;
    in >> pages >> in_ram;
    return in_ram * static_cast<double>(sysconf(_SC_PAGESIZE));
}

struct Options {
    std::string scene, csv;
    std::vector<std::string> overrides;
    int rounds = 4, first = 0, repeat = 1;
    long steps = 0;  // 0: all
};

/// The wall's arrays that stay: the mesh (world), tree nodes, vertices, rims and the way back to the mesh's triangles (contact).
double kept_bytes(const WallMesh& mesh, const WallTree& tree)
{
    const double t = static_cast<double>(tree.triangle_count());
    return static_cast<double>(mesh.vertices.size() * sizeof(Vec3) + mesh.triangles.size() * sizeof(mesh.triangles[0]) +
                               tree.nodes.size() * sizeof(TreeNode)) +
           t * (9 * sizeof(float) + 2 * sizeof(std::uint32_t));
}

std::string row_of(const Scene& scene, const WorldSetup& setup, const Options& options)
{
    std::vector<double> builds;
    double bytes = 0;
    for (int k = 0; k < 3; ++k) {
        const auto start = Clock::now();
        const WallTree tree = build_wall_tree(setup.mesh);
        builds.push_back(seconds_since(start));
        bytes = kept_bytes(setup.mesh, tree);
    }
    std::sort(builds.begin(), builds.end());
    const double triangles = static_cast<double>(setup.mesh.triangles.size());
    const long steps = options.steps > 0 ? std::min(options.steps, scene.steps()) : scene.steps();
    std::vector<std::pair<double, StageTimes>> runs;
    double grown = 0, newton = 0, load = 0, cpu = 0;
    int contacts = 0;
    std::string hash;
    const KeyFrames keys(scene);
    for (int r = 0; r < options.repeat; ++r) {
        WorldSetup copy = setup;
        const double before =
            resident() - static_cast<double>(setup.mesh.vertices.size() * sizeof(Vec3) + setup.mesh.triangles.size() * 12);
        const auto loading = Clock::now();
        World world(std::move(copy));
        load = seconds_since(loading);
        grown = resident() - before;
        StageTimes stages;
        newton = 0;
        const auto start = Clock::now();
        const double cpu_start = processor_time();
        for (long k = 0; k < steps; ++k) {
            const StepReport report = step(world, keys.control(), scene.dt);
            if (report.failed()) throw Error(ErrorKind::Stopped, fmt::format("step {} failed", k + 1));
            stages += report.times;
            newton += report.newton_iterations;
            contacts = std::max(contacts, world.readings(0).contacts);
        }
        const double cpu_here = processor_time() - cpu_start;
        cpu = r == 0 ? cpu_here : std::min(cpu, cpu_here);
        runs.emplace_back(seconds_since(start), stages);
        hash = world.state_hash();
    }
    std::sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const auto& [wall, s] = runs[runs.size() / 2];
    const double n = static_cast<double>(steps), us = 1e6 / n;
    return fmt::format(
        "{:.0f},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{},{:.5g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{},{}\n", triangles,
        builds[1], triangles / builds[1], bytes / triangles, grown / triangles, load, steps, n / wall, wall * us, cpu * us,
        s.detect * us, s.evaluate * us, s.reduce * us, s.solve * us, newton / n, contacts, hash);
}

int run(const Options& options)
{
    const Scene scene = read_scene(options.scene, options.overrides);
    WorldSetup setup = make_setup(scene);
    std::string table =
        "triangles,tree_build_s,tree_triangles_per_s,kept_bytes_per_triangle,grown_bytes_per_triangle,world_s,steps,steps_per_s,"
        "step_us,processor_us,detect_us,"
        "evaluate_us,reduce_us,solve_us,newton_per_step,contacts_max,state_hash\n";
    fmt::print("{}", table);
    for (int round = 0; round <= options.rounds; ++round) {
        if (round > 0) setup.mesh = subdivide_loop(setup.mesh);
        if (round < options.first) continue;
        const std::string row = row_of(scene, setup, options);
        table += row;
        fmt::print("{}", row);
        std::fflush(stdout);
    }
    if (!options.csv.empty()) write_file(options.csv, table);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    Options options;
    CLI::App app("Step time against mesh density: the same wire in the same vessel, Loop-subdivided round by round.");
    app.add_option("scene", options.scene, "scene file")->required();
    app.add_option("--rounds", options.rounds, "subdivisions");
    app.add_option("--first", options.first, "the first round that is measured");
    app.add_option("--steps", options.steps, "the first so many steps only");
    app.add_option("--repeat", options.repeat)->check(CLI::PositiveNumber);
    app.add_option("--csv", options.csv, "the table");
    app.add_option("--set", options.overrides, "table.key=value")->allow_extra_args(false);
    CLI11_PARSE(app, argc, argv);
    try {
        return run(options);
    } catch (const Error& error) {
        fmt::print(stderr, "mesh_density: {}\n", error.what());
        return exit_code(error.kind());
    }
}

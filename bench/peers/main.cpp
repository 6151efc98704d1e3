// The same contact queries on the same meshes by the project's kernels and by other libraries, side by side.
//
//     mesh_peers [--triangles 30000,300000,3000000] [--queries 2000] [--repeat 5] [--csv FILE] [--only NAME]
//
// Queries: capsules of 5 mm and a radius of 0.5 mm at the wall of the project's aortic arch, at random positions and in random
// directions along it. Asked are all triangles within the radius of the axis, and the nearest point of the mesh for the same
// middles. Two threads each. Every set is compared with the project's: a triangle that one has and the other has not must lie
// within 1 nm of the radius (float32, GJK: 1 um). Medians of the repeats; the repeats of all libraries are interleaved, so that
// a disturbed moment strikes all alike.

#include "exact.h"
#include "peers.h"

#include "core/clock.h"
#include "core/error.h"
#include "shapes/aortic_arch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

namespace {

using namespace peers;
using seldinger::Clock, seldinger::seconds_since;

struct Options {
    std::vector<int> triangles = {30000, 300000, 3000000};
    std::size_t queries = 2000;
    int repeat = 5;
    std::string csv, only;
};

Problem make_problem(const seldinger::WallTree& tree, std::size_t queries)
{
    Problem problem;
    problem.tree = &tree;
    std::mt19937 rng(3);
    std::uniform_int_distribution<std::size_t> any(0, tree.triangle_count() - 1);
    std::uniform_real_distribution<double> unit(0, 1);
    constexpr double radius = 0.5e-3, half = 2.5e-3;
    while (problem.capsules.size() < queries) {
        const std::size_t t = any(rng);
        const float *v = &tree.vertices[9 * t], *n = &tree.normals[3 * t];
        const seldinger::Vec3 normal(n[0], n[1], n[2]), corner(v[0], v[1], v[2]), side(v[3] - v[0], v[4] - v[1], v[5] - v[2]);
        if (normal.norm() < 0.5 || side.norm() == 0) continue;
        const seldinger::Vec3 u = side.normalized(), w = normal.cross(u);
        const double angle = 6.283 * unit(rng), depth = radius * (0.6 + 0.5 * unit(rng));
        const seldinger::Vec3 middle = corner + depth * normal, along = half * (std::cos(angle) * u + std::sin(angle) * w);
        const seldinger::Vec3 a = middle - along, b = middle + along;
        problem.capsules.push_back({{a.x(), a.y(), a.z()}, {b.x(), b.y(), b.z()}, radius});
        problem.points.push_back({middle.x(), middle.y(), middle.z()});
    }
    return problem;
}

struct Score {
    double build = 0;
    std::vector<double> sets, nearest;  // [s] per repeat
    std::size_t asked = 0, doubtful = 0, wrong = 0;
    double worst_distance = 0;
};

double median(std::vector<double> x)
{
    std::sort(x.begin(), x.end());
    return x.empty() ? 0 : x[x.size() / 2];
}

/// Triangles of the two sets that only one has: within `tolerance` of the radius they are doubtful, else wrong.
void compare(const Problem& problem, std::size_t k, std::vector<std::uint32_t> mine, std::vector<std::uint32_t> other,
             double tolerance, Score& score)
{
    std::sort(mine.begin(), mine.end());
    std::sort(other.begin(), other.end());
    std::vector<std::uint32_t> differ;
    std::set_symmetric_difference(mine.begin(), mine.end(), other.begin(), other.end(), std::back_inserter(differ));
    const Capsule& c = problem.capsules[k];
    for (const std::uint32_t t : differ) {
        const double d = std::sqrt(seldinger::segment_triangle_distance2(vec(c.a), vec(c.b) - vec(c.a), triangle(problem, t)));
        (std::abs(d - c.radius) <= tolerance ? score.doubtful : score.wrong)++;
    }
}

std::string measure(int wanted, const Options& options)
{
    seldinger::VesselSpec spec;
    spec.shape = seldinger::VesselShape::Arch;
    spec.triangles = wanted;
    const seldinger::WallMesh mesh = seldinger::make_aortic_arch(spec).mesh;
    const auto building = Clock::now();
    const seldinger::WallTree tree = seldinger::build_wall_tree(mesh);
    const double own_build = seconds_since(building);
    const Problem problem = make_problem(tree, options.queries);

    std::vector<std::unique_ptr<Peer>> list;
    list.push_back(make_ours(false));
    list.push_back(make_ours(true));
    list.push_back(make_embree(true));
    list.push_back(make_embree(false));
    list.push_back(make_cgal());
    list.push_back(make_bullet());
    if (wanted <= 1000000) list.push_back(make_fcl());  // 1.6 GB and 15 s at three million
    if (!options.only.empty())
        list.erase(std::remove_if(list.begin() + 1, list.end(),
                                  [&](const auto& p) { return p->name.find(options.only) == std::string::npos; }),
                   list.end());

    std::vector<Score> scores(list.size());
    std::vector<Sets> sets(list.size());
    std::vector<Distances> distances(list.size());
    std::vector<Problem> parts(list.size());
    for (std::size_t p = 0; p < list.size(); ++p) {
        const auto start = Clock::now();
        list[p]->build(problem);
        scores[p].build = seconds_since(start) + (p < 2 ? own_build : 0);
        parts[p] = problem;
        const auto part = static_cast<std::size_t>(static_cast<double>(problem.capsules.size()) * list[p]->share());
        parts[p].capsules.resize(part);
        parts[p].points.resize(part);
        sets[p].resize(part);
        distances[p].resize(part);
    }
    // Each call is made twice and timed the second time: other libraries' threads spin for a while after their turn, and what
    // these keep in the caches is nobody else's.
    const auto timed = [](std::vector<double>& seconds, const auto& call) {
        call();
        const auto start = Clock::now();
        call();
        seconds.push_back(seconds_since(start));
    };
    for (int r = 0; r < options.repeat; ++r)
        for (std::size_t p = 0; p < list.size(); ++p) {
            if (list[p]->has_sets()) timed(scores[p].sets, [&] { list[p]->sets(parts[p], sets[p]); });
            if (list[p]->has_nearest()) timed(scores[p].nearest, [&] { list[p]->nearest(parts[p], distances[p]); });
        }
    double found = 0;
    for (const auto& set : sets[0]) found += static_cast<double>(set.size());
    std::string rows;
    for (std::size_t p = 0; p < list.size(); ++p) {
        Score& s = scores[p];
        const bool rounded = list[p]->name.find("float32") != std::string::npos || list[p]->name.find("FCL") != std::string::npos;
        for (std::size_t k = 0; p > 0 && k < sets[p].size(); ++k) {
            compare(problem, k, sets[0][k], sets[p][k], rounded ? 1e-6 : 1e-9, s);
            if (list[p]->has_nearest())
                s.worst_distance = std::max(s.worst_distance, std::abs(distances[p][k] - distances[0][k]));
        }
        const double n = static_cast<double>(sets[p].size());
        const double set_rate = n / median(s.sets), nearest_rate = list[p]->has_nearest() ? n / median(s.nearest) : 0;
        rows += fmt::format("{},{},{},{:.4g},{:.1f},{:.5g},{:.5g},{},{},{:.2g}\n", list[p]->name, tree.triangle_count(),
                            sets[p].size(), s.build, found / static_cast<double>(problem.capsules.size()), set_rate, nearest_rate,
                            s.doubtful, s.wrong, s.worst_distance);
    }
    fmt::print("{}", rows);
    std::fflush(stdout);
    return rows;
}

int run(int argc, char** argv)
{
    Options options;
    for (int k = 1; k < argc; ++k) {
        const std::string word = argv[k], value = k + 1 < argc ? argv[k + 1] : "";
        if (value.empty()) throw seldinger::Error(seldinger::ExitCode::BadScene, word + ": a value is missing");
        ++k;
        if (word == "--queries") options.queries = std::strtoul(value.c_str(), nullptr, 10);
        else if (word == "--repeat") options.repeat = std::atoi(value.c_str());
        else if (word == "--csv") options.csv = value;
        else if (word == "--only") options.only = value;
        else if (word == "--triangles") {
            options.triangles.clear();
            for (std::size_t at = 0; at < value.size(); at = std::min(value.find(',', at), value.size() - 1) + 1)
                options.triangles.push_back(std::atoi(value.c_str() + at));
        } else throw seldinger::Error(seldinger::ExitCode::BadScene, word + ": unknown option");
    }
    std::string table =
        "library,triangles,queries,build_s,triangles_per_set,sets_per_s,nearest_per_s,doubtful,wrong,nearest_worst_m\n";
    fmt::print("{}", table);
    for (const int triangles : options.triangles) table += measure(triangles, options);
    if (!options.csv.empty()) std::ofstream(options.csv) << table;
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "mesh_peers: {}\n", error.what());
        return 1;
    }
}

// The table of built-in benchmarks and their refinements, and the benchmark of a user's scene.
#include "lab/benchmarks.h"

#include "core/error.h"
#include "scene/toml_table.h"
#include "lab/elastica.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double of_the_end = std::numeric_limits<double>::infinity();

/// One line per benchmark. Intervals are multiples of 0.1 s, which every step that is charted divides (33.3 ms too).
struct Entry {
    std::string_view name, file;
    double until, quick_until, interval;  // [s]
    double count_from, count_until;       // [s]
    int nodes;                            // of the reference's coarsest level ...
    double dt;                            // ... and its step [s]
    bool trapezoid;                       // second order, for what swings freely; backward Euler where contact damps
    bool touches;
};

constexpr Entry entries[] = {
    {"elastica", "study/elastica.toml", 2, 2, 0.1, 1.5, of_the_end, 0, 0, false, false},
    {"heavy-swing", "study/heavy-swing.toml", 1, 0.5, 0.1, 0, of_the_end, 51, 1e-3, true, false},
    {"whip", "study/whip.toml", 5, 4, 0.1, 0, of_the_end, 51, 2e-3, false, true},
    {"capstan", "study/capstan.toml", 0.4, 0.4, 0.1, 0.3, of_the_end, 101, 2e-3, false, true},
    {"experiment1", "experiment1.toml", 12, 5, 0.2, 0, of_the_end, 61, 2e-3, false, true},
    // past 24 cm the tip meets a fork and small differences decide which way it goes
    {"experiment2", "experiment2.toml", 12, 12, 0.4, 0, 12, 61, 2e-3, false, true},
    {"coronary", "study/coronary.toml", 3, 2, 0.1, 0, of_the_end, 61, 2e-3, false, true},
    {"siphon", "study/siphon.toml", 4, 2.5, 0.1, 0, of_the_end, 61, 2e-3, false, true},
};

constexpr double reference_wall = 240, quick_reference_wall = 30;  // [s]

std::vector<Observable> observables(bool touches)
{
    if (!touches) return {Observable::Tip, Observable::Shape};
    return {Observable::Tip, Observable::Shape, Observable::HandForce, Observable::Friction, Observable::Contact};
}

Refinement refinement(int nodes, double dt, bool trapezoid, bool quick)
{
    Refinement how;
    how.coarsest.nodes = nodes;
    how.coarsest.dt = dt;
    how.coarsest.scheme = Scheme::Newton;
    how.coarsest.trapezoid = trapezoid;
    how.least_levels = 3;
    how.most_levels = quick ? 4 : 6;
    how.wall_limit = quick ? quick_reference_wall : reference_wall;
    return how;
}

std::vector<Vec3> elastica_of(const Scene& scene)
{
    const WirePlacement& place = scene.wire.place;
    return elastica_shape(scene.wire.shaft, scene.wire.length, place.base, place.direction, scene.loads.front().force, 4001);
}

}  // namespace

std::vector<std::string> benchmark_names()
{
    std::vector<std::string> names;
    for (const Entry& entry : entries) names.emplace_back(entry.name);
    return names;
}

Benchmark find_benchmark(const std::string& wanted, const std::filesystem::path& scenes, bool quick)
{
    Benchmark benchmark;
    if (wanted.ends_with(".toml")) {
        benchmark.file = wanted;
        benchmark.name = benchmark.file.stem().string();
        benchmark.refinement = refinement(0, 0, false, quick);
        return benchmark;
    }
    const auto found =
        std::find_if(std::begin(entries), std::end(entries), [&](const Entry& entry) { return entry.name == wanted; });
    if (found == std::end(entries)) {
        std::vector<std::string_view> names;
        for (const Entry& entry : entries) names.push_back(entry.name);
        throw Error(ErrorKind::BadScene,
                    fmt::format("--scenes: no benchmark \"{}\"; the nearest is \"{}\". Fix: give that, or a scene file (*.toml)",
                                wanted, nearest_word(wanted, names)));
    }
    benchmark.name = found->name;
    benchmark.file = scenes / found->file;
    benchmark.until = quick ? found->quick_until : found->until;
    benchmark.interval = found->interval;
    benchmark.window = {found->count_from, found->count_until};
    benchmark.charted = observables(found->touches);
    benchmark.refinement = refinement(found->nodes, found->dt, found->trapezoid, quick);
    if (benchmark.name == "elastica") benchmark.analytic = elastica_of;
    return benchmark;
}

void complete(Benchmark& benchmark, const Scene& scene)
{
    if (benchmark.until == 0) benchmark.until = scene.duration;
    // a multiple of 0.1 s, so that steps of 33 ms divide it too, and some 40 samples; a short scene in parts of 33 ms or a little
    // more
    if (benchmark.interval == 0)
        benchmark.interval = benchmark.until >= 1 ? 0.1 * std::max(1.0, std::round(benchmark.until / 4))
                                                  : benchmark.until / std::max(1.0, std::floor(30 * benchmark.until + 1e-9));
    if (benchmark.charted.empty()) benchmark.charted = observables(scene.vessel.shape != VesselShape::None);
    Model& coarsest = benchmark.refinement.coarsest;
    if (coarsest.nodes == 0) {
        const int uniform =
            scene.wire.nodes > 0 ? scene.wire.nodes : static_cast<int>(scene.wire.length / (0.4 * scene.wire.max_edge)) + 1;
        coarsest.nodes = std::max(uniform / 2, 3);
        coarsest.dt = 2 * scene.dt;
        coarsest.trapezoid = scene.integrator.newmark;
    }
}

Reference analytic_reference(const Benchmark& benchmark, const Scene& scene)
{
    Reference reference;
    const std::vector<Vec3> shape = benchmark.analytic(scene);
    reference.values.wire_length = scene.wire.length;
    const long samples = std::lround(benchmark.until / benchmark.interval);
    for (long k = 1; k <= samples; ++k) {
        Sample sample;
        sample.t = static_cast<double>(k) * benchmark.until / static_cast<double>(samples);
        sample.shape = shape;
        if (benchmark.window.holds(sample.t)) reference.values.samples.push_back(std::move(sample));
    }
    for (const Observable which : {Observable::Tip, Observable::Shape}) {
        reference.known[static_cast<std::size_t>(which)] = true;
        reference.convergence[static_cast<std::size_t>(which)] = Convergence::Analytic;
    }
    reference.note = "analytic";
    return reference;
}

}  // namespace seldinger

// Operations and loads of every kernel, counted by running its host reference with a number that counts.
#include "roofline/kernel_bench.h"

#include <array>
#include <cstdint>

namespace sel_count {

struct Tally {
    double flops = 0, floats = 0;
};
Tally tally;

/// A double that counts its operations. A float is converted where it is loaded from one of the float32 arrays, and next to
/// nowhere else.
struct Counted {
    double value;
    Counted() = default;
    Counted(double v) : value(v) {}
    Counted(int v) : value(v) {}
    Counted(unsigned v) : value(v) {}
    Counted(float v) : value(static_cast<double>(v)) { tally.floats += 1; }
    explicit operator double() const { return value; }
    Counted operator-() const { return -value; }
    Counted& operator+=(Counted b) { return *this = *this + b; }
    Counted& operator-=(Counted b) { return *this = *this - b; }
    Counted& operator*=(Counted b) { return *this = *this * b; }
    Counted& operator/=(Counted b) { return *this = *this / b; }
    static Counted done(double v) { return tally.flops += 1, v; }
    friend Counted operator+(Counted a, Counted b) { return done(a.value + b.value); }
    friend Counted operator-(Counted a, Counted b) { return done(a.value - b.value); }
    friend Counted operator*(Counted a, Counted b) { return done(a.value * b.value); }
    friend Counted operator/(Counted a, Counted b) { return done(a.value / b.value); }
    friend bool operator<(Counted a, Counted b) { return a.value < b.value; }
    friend bool operator>(Counted a, Counted b) { return a.value > b.value; }
    friend bool operator<=(Counted a, Counted b) { return a.value <= b.value; }
    friend bool operator>=(Counted a, Counted b) { return a.value >= b.value; }
    friend bool operator==(Counted a, Counted b) { return a.value == b.value; }
    friend bool operator!=(Counted a, Counted b) { return a.value != b.value; }
};

}  // namespace sel_count

#include <cmath>

namespace sel_count {
inline Counted sqrt(Counted a) { return Counted::done(std::sqrt(a.value)); }
inline Counted fabs(Counted a) { return std::fabs(a.value); }
inline Counted pow(Counted a, Counted b) { return Counted::done(std::pow(a.value, b.value)); }
}  // namespace sel_count

#define SEL_REAL ::sel_count::Counted
#define seldinger seldinger_counted
#include "roofline/kernel_bench_load.h"

namespace {

/// Adds one kernel: body() does all items and returns how many pairs they make.
template <class Body>
void count(std::vector<KernelWork>& out, const char* kernel, std::size_t items, const Body& body)
{
    sel_count::tally = {};
    const double pairs = body(), n = static_cast<double>(items);
    out.push_back({kernel, sel_count::tally.flops / n, sel_count::tally.floats / n, pairs / n});
}

}  // namespace

std::vector<KernelWork> sel_bench::count_work(const BenchWall& wall, std::size_t points)
{
    const Load s(wall, points);
    const std::size_t n = s.models.size(), edges = s.layer_edges.size();
    const WallView view = s.view(wall);
    std::vector<KernelWork> work;
    std::vector<uint> near_cells(n * slots), counts(n);
    const auto point = [&](uint k) {
        return point_view(k, s.models[k], s.places[k], near_wall_view(view, &near_cells[k * slots], counts[k]));
    };
    double near_pairs = 0;
    std::vector<Clearance> known(n);
    std::vector<WallMemory> memories(n);
    count(work, "contact_find", n, [&] {
        for (const uint k : s.list) {
            const AxisPoint at = axis_point(s.places[k].edge, s.places[k].bary, s.now());
            const real radius = s.models[k].radius;
            counts[k] = std::min(slots, find_near_cells(at, radius + s.models[k].reach + real(slack), SEL_NEAR_CELL_SIZE * radius,
                                                        view, slots, &near_cells[k * slots]));
            known[k] =
                found_clearance(at.origin + at.offset, radius + s.models[k].reach + real(slack), real(slack), radius, counts[k]);
            near_pairs += counts[k];
        }
        return near_pairs;
    });

    count(work, "contact_distance", n, [&] {
        for (const uint k : s.list) {
            const AxisPoint at = axis_point(s.places[k].edge, s.places[k].bary, s.now());
            (void)wall_distance(at.origin + at.offset, real(1), view);
        }
        return static_cast<double>(n);
    });

    std::vector<ContactForce> forces(n);
    std::vector<ContactState> states = s.states_t0;
    const auto evaluate = [&] {
        for (const uint k : s.list)
            forces[k] =
                evaluate_point(point(k), s.par, s.now(), s.before(),
                               state_view(s.states_t0.data(), states.data(), s.multipliers.data()), &memories[k], &known[k]);
        return near_pairs;
    };
    (void)evaluate();  // launches are timed with the wall in mind
    count(work, "contact_evaluate", n, evaluate);
    std::vector<real> barys(n);
    for (std::size_t k = 0; k < n; ++k) barys[k] = s.places[k].bary;
    count(work, "contact_reduce", edges, [&] {
        EdgeForce sum;
        for (std::size_t e = 0; e < edges; ++e) reduce_edge(forces.data(), barys.data(), s.first[e], s.first[e + 1], &sum);
        return static_cast<double>(n);
    });
    ContactParams par = s.par;
    par.normal_law = SEL_NORMAL_AUGMENTED;
    std::vector<MultiplierState> multipliers = s.multipliers;
    count(work, "contact_start", n, [&] {
        for (std::size_t k = 0; k < 2 * n; ++k) multipliers[k] = multiplier_start(s.states_t0[k], 9, s.models[k / 2], par);
        return static_cast<double>(n);
    });
    count(work, "contact_multipliers", n, [&] {
        for (std::size_t k = 0; k < 2 * n; ++k) {
            real ratio = 0;
            (void)multiplier_update(multipliers[k], states[k], s.states_t0[k], 9, s.models[k / 2], par, &ratio);
        }
        return static_cast<double>(n);
    });
    par.normal_law = SEL_NORMAL_BARRIER;
    count(work, "contact_clearance", n, [&] {
        for (const uint k : s.list) (void)gap_of_point(point(k), par, s.now(), s.states_t0.data());
        return near_pairs;
    });
    count(work, "contact_sweep", n, [&] {
        for (const uint k : s.list) {
            const QuadraturePlace& p = s.places[k];
            (void)sweep_point(axis_point(p.edge, p.bary, s.before()), axis_point(p.edge, p.bary, s.now()), s.models[k].radius,
                              point(k).near);
        }
        return near_pairs;
    });
    std::vector<uint> found(edges * slots), pair_counts(edges);
    double layer_pairs = 0;
    count(work, "layer_find", edges, [&] {
        for (std::size_t e = 0; e < edges; ++e) {
            real touching;
            pair_counts[e] = find_pairs(s.layer_edges[e], s.now(), view, slots, &found[e * slots], &touching);
            layer_pairs += pair_counts[e] = std::min(pair_counts[e], slots);
        }
        return layer_pairs;
    });
    count(work, "layer_evaluate", static_cast<std::size_t>(std::max(layer_pairs, 1.0)), [&] {
        for (std::size_t e = 0; e < edges; ++e)
            for (uint k = 0; k < pair_counts[e]; ++k) {
                real bary;
                ContactForce force;
                const LayerPair pair{static_cast<uint>(e), found[e * slots + k], 0, 0};
                evaluate_pair(pair, s.layer_edges[e], s.par, s.now(), s.before(), wall.vertices.data(), s.states_t0[0],
                              states.data(), &force, &bary);
            }
        return layer_pairs;
    });
    return work;
}

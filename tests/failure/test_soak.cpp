// Days of use in one process: worlds made and put back, a wire pushed, pulled and turned. What the process holds stays flat, and
// the same phase of a cycle reads the same. SELDINGER_SOAK=N: N resets and 1000 N steps (`./dev test --long`: 10000).

#include "support/count_allocations.h"
#include "support/tries.h"
#include "support/world_fixture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace seldinger::test::test_soak {

namespace {

/// What the system counts of this process.
struct Held {
    long memory_kb = 0, threads = 0, handles = 0;
};

Held held()
{
    Held now;
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        std::istringstream words(line);
        std::string key;
        words >> key;
        if (key == "VmRSS:") words >> now.memory_kb;
        if (key == "Threads:") words >> now.threads;
    }
    for ([[maybe_unused]] const auto& handle : std::filesystem::directory_iterator("/proc/self/fd")) ++now.handles;
    return now;
}

/// The allocator keeps some pages more or less from one moment to the next; a leak of 64 bytes a step would be 640 MB.
constexpr long slack_kb = 4096;

void check_flat(const Held& before, const Held& after)
{
    MESSAGE("memory " << before.memory_kb << " -> " << after.memory_kb << " kB, threads " << before.threads << " -> "
                      << after.threads << ", handles " << before.handles << " -> " << after.handles);
    // a sanitizer's allocator keeps 256 MB of freed memory, to notice a later use
    if (allocations_are_counted()) CHECK(after.memory_kb <= before.memory_kb + slack_kb);
    CHECK(after.threads <= before.threads);
    CHECK(after.handles <= before.handles);
}

/// A short wire in a bend, which it presses against all along.
TestSetup wire_in_bend()
{
    TestSetup setup = in_bend(0.004, 0.03, 2000);
    setup.wires = {fed_wire(steel_wire(0.08, 17), Vec3(0, 0, -0.003), 0)};
    setup.wires[0].feed.keys.clear();
    return setup;
}

constexpr double dt = 1e-3;  // [s]
constexpr int cycle = 1000;  // steps
constexpr double deep = 0.05, stroke = 0.02, turns = 6.283185307179586;

/// Pushed in over the first half of a cycle and drawn back over the second, and turned by a full turn forth and back in
/// quadrature.
void move(Control& control, long k)
{
    const double phase = static_cast<double>(k % cycle) / cycle;
    const auto wave = [](double p) { return 1 - std::abs(2 * (p - std::floor(p)) - 1); };  // 0, 1 in the middle, 0
    const double start = std::min(1.0, static_cast<double>(k) / cycle);                    // the first cycle brings it there
    control.move_to(0, start * (deep + stroke * wave(phase)), turns * wave(phase + 0.25));
}

/// Compared from cycle to cycle: forces, energies, where the tip is, and what the ledger has grown by.
const std::array<std::string, 9> names = {"hand force", "hand torque", "normal force",  "friction",   "elastic energy",
                                          "tip x",      "tip z",       "energy put in", "energy open"};
using Reading = std::array<double, std::tuple_size_v<decltype(names)>>;

Reading read(const World& world)
{
    const WireReadings now = world.readings(0);
    const Vec3 tip = world.rod(0).pos(0);
    return {now.hand_force, now.hand_torque, now.normal,      now.friction,     now.elastic,
            tip[0],         tip[2],          now.energy.in(), now.energy.open()};
}

/// Readings in the same phase of every cycle; the ledger's as they have changed since the cycle before.
class Phase {
public:
    explicit Phase(std::size_t cycles) { cycles_.reserve(cycles); }
    void add(const World& world)
    {
        const Reading total = read(world);
        Reading now = total;
        for (const std::size_t k : {7, 8}) now[k] -= before_[k];
        before_ = total;
        cycles_.push_back(now);
    }
    /// Tenths of the cycles at both ends agree, to what the tolerance of a step leaves. The first four settle.
    void check_steady() const
    {
        const std::size_t tenth = std::max<std::size_t>(1, cycles_.size() / 10);
        for (std::size_t which = 0; which < names.size(); ++which) {
            const double first = mean(4, which, tenth), last = mean(cycles_.size() - tenth, which, tenth);
            MESSAGE(names[which] << ": " << first << " -> " << last << ", apart by " << last - first);
            CHECK(std::abs(last - first) <= 1e-5 * std::abs(first));
        }
    }

private:
    [[nodiscard]] double mean(std::size_t from, std::size_t which, std::size_t count) const
    {
        double sum = 0;
        for (std::size_t k = from; k < from + count; ++k) sum += cycles_[k][which];
        return sum / static_cast<double>(count);
    }
    std::vector<Reading> cycles_;
    Reading before_{};
};

}  // namespace

TEST_SUITE("failure/soak")
{
    TEST_CASE(
        "property: worlds made, and put back, again and again leave memory, threads and handles flat, and end with the same bits")
    {
        const WorldSetup setup = wire_in_bend();
        const long resets = tries("SELDINGER_SOAK", 60);
        World kept(setup);
        const std::vector<std::uint8_t> start = kept.save_state();
        const auto run = [&](World& world) {
            Control control;
            for (long k = 0; k < 5; ++k) {
                move(control, 100 + 20 * k);
                (void)step(world, control, dt);
            }
            return world.state_hash();
        };
        const std::string hash = run(kept);
        Held before;
        for (long k = 0; k < resets; ++k) {
            World fresh(setup);
            kept.restore_state(start);
            if (run(fresh) != hash || run(kept) != hash) FAIL("reset " << k << " went another way");
            if (k == resets / 10) before = held();
        }
        check_flat(before, held());
    }

    TEST_CASE(
        "property: a wire pushed, pulled and turned for long leaves memory, threads and handles flat, and reads the same in the "
        "same phase")
    {
        World world(wire_in_bend());
        Control control;
        const long cycles = tries("SELDINGER_SOAK", 20);
        Phase in(static_cast<std::size_t>(cycles)), out(static_cast<std::size_t>(cycles));  // in the middle of each way
        Held before;
        unsigned flags = 0;
        for (long k = 0; k < cycles * cycle; ++k) {
            move(control, k);
            const StepReport report = step(world, control, dt);
            if (report.failed()) FAIL("step " << k << " failed");
            flags |= report.flags;
            if (k % cycle == cycle / 4) in.add(world);
            if (k % cycle == 3 * cycle / 4) out.add(world);
            if (k == cycles / 10 * cycle) before = held();
        }
        check_flat(before, held());
        CHECK((flags & (StepWallPenetration | StepBestEffort)) == 0);
        in.check_steady();
        out.check_steady();
    }
}

}  // namespace seldinger::test::test_soak

// Bounds on what a saved state may say. They are wide: no run gets near them, and values beyond them would overflow in an index, or
// make a step without end.
#include "world/state_check.h"

#include "core/bytes.h"
#include "core/error.h"
#include "world/merged.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double least_edge = 1e-9;    // [m] an edge: a thousandth of what a wire is thick
constexpr double longest = 1e4;      // [m] places, lengths
constexpr double most_turned = 1e9;  // [rad]
constexpr double most_rate = 1e18;     // speeds, accelerations, stiffnesses, energies, in their units
constexpr double latest = 1e12;      // [s]

[[noreturn]] void refuse_state(const char* what)
{
    throw Error(ExitCode::BadFile, fmt::format("the saved state is damaged: {} is out of bounds", what));
}

void need(bool sound, const char* what)
{
    if (!sound) refuse_state(what);
}

bool within(double value, double bound) { return std::abs(value) <= bound; }  // false for NaN

void all_within(std::span<const double> values, double bound, const char* what)
{
    need(std::all_of(values.begin(), values.end(), [&](double value) { return within(value, bound); }), what);
}

void all_positive(std::span<const double> values, double bound, const char* what)
{
    need(std::all_of(values.begin(), values.end(), [&](double value) { return value > 0 && value <= bound; }), what);
}

/// @param length  of the wire  @param rod  null where it is not the feed's own
void check_feed(const FeedState& feed, double length, const BasicRodView<const double>* rod)
{
    need(within(feed.advance, longest) && within(feed.surplus, longest), "a fed length");
    need(within(feed.turn, most_turned), "a turn");
    need(within(feed.surplus_rate, most_rate), "a feed's speed");
    need(feed.inside <= 1, "a feed's flag");
    if (!feed.on) return;
    need(feed.advance >= 0 && feed.advance <= length * (1 + 1e-9), "a fed length");
    if (!feed.inside || !rod) return;
    const double inside = rod->material_s[rod->n - 1];  // what is there is what was fed and the surplus
    need(std::abs(inside - (feed.advance + feed.surplus)) <= 1e-6 * length, "a fed length");
}

/// Lines and passengers of a common centreline: values in use follow from others, and the remaining ones may be zero.
void check_shared_rod(const RodArrays& rods, int wire)
{
    for (const std::span<double>& array : const_cast<RodArrays&>(rods).arrays(wire)) all_within(array, most_rate, "a number");
}

void check_rod(const BasicRodView<const double>& rod)
{
    const auto nodes = [&](std::span<const double> all) { return all.first(static_cast<std::size_t>(rod.n)); };
    const auto edges = [&](std::span<const double> all) { return all.first(static_cast<std::size_t>(rod.n) - 1); };
    all_within(nodes(rod.material_s), longest, "a material coordinate");
    for (int j = 0; j + 1 < rod.n; ++j) {
        const double length = rod.material_s[j + 1] - rod.material_s[j];
        need(length > least_edge && std::abs(rod.rest_length[j] - length) <= 1e-6 * length, "an edge's length");
    }
    all_positive(edges(rod.radius), longest, "a radius");
    for (const auto& stiffness : {edges(rod.stretch_stiffness), nodes(rod.bend_stiffness), nodes(rod.twist_stiffness)})
        all_positive(stiffness, most_rate, "a stiffness");
    all_positive(nodes(rod.mass), most_rate, "a mass");
    all_positive(edges(rod.spin_inertia), most_rate, "an inertia");
    for (const auto& angle : {nodes(rod.rest_kappa1), nodes(rod.rest_kappa2), nodes(rod.rest_twist), edges(rod.theta),
                              nodes(rod.ref_twist), nodes(rod.clamp_twist_a), nodes(rod.clamp_twist_b)})
        all_within(angle, most_turned, "an angle");
    for (const auto& place : {nodes(rod.x), nodes(rod.y), nodes(rod.z)}) all_within(place, longest, "a node's place");
    for (const auto& motion : {nodes(rod.vx), nodes(rod.vy), nodes(rod.vz), edges(rod.spin_rate), nodes(rod.ax), nodes(rod.ay),
                               nodes(rod.az), edges(rod.spin_acc)})
        all_within(motion, most_rate, "a speed");
    for (const auto& director : {edges(rod.tx), edges(rod.ty), edges(rod.tz), edges(rod.d1x), edges(rod.d1y), edges(rod.d1z)})
        all_within(director, 2, "a director");
}

}  // namespace

void check_saved_wire(const World::Impl& state, int wire)
{
    need(within(state.wire_time[wire], latest), "the time");
    need(within(state.remesh_energy[wire], most_rate), "an energy");
    auto& rods = const_cast<RodArrays&>(state.rods);  // views are of changeable arrays; this only reads
    const BasicRodView<const double> rod = rods.view(wire);
    const double length = state.setup.wires[wire].wire.length;
    const bool own = state.merged_of[wire] < 0;
    if (own) check_rod(rod);
    else check_shared_rod(rods, wire);
    check_feed(state.feeds[wire], length, own ? &rod : nullptr);
    const Solver::SpinRecord& spins = state.solver->spin_record(wire);
    need(spins.wait >= 0 && spins.last_wait >= 0 && spins.last_wait <= 256 && spins.wait <= 256, "a count of steps");
    if (!own && !state.is_passenger(wire)) check_feed(state.merged[state.merged_of[wire]]->feed, longest, nullptr);
}

void check_saved_audit(const EnergyAudit& audit)
{
    const auto all = [](const auto& plain) {
        static_assert(sizeof plain % sizeof(double) == 0 && alignof(decltype(plain)) == alignof(double));
        all_within({reinterpret_cast<const double*>(&plain), sizeof plain / sizeof(double)}, most_rate, "an energy");
    };
    all(audit.balance);
    all(audit.ledger);
    all_within(std::initializer_list<double>{audit.wire_then, audit.elastic_then, audit.moving, audit.remeshed,
                                             audit.hand_force, audit.speed},
               most_rate, "an energy");
    for (const auto* list : {&audit.held, &audit.held_speed, &audit.torque, &audit.turns})
        all_within(*list, most_rate, "a reaction");
}

void check_saved_time(double time, std::int64_t steps)
{
    need(time >= 0 && time <= latest, "the time");
    need(steps >= 0, "the number of steps");
}

}  // namespace seldinger

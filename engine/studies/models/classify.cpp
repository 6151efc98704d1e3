// Judges a run from its readings step by step: jitter of the hand's force, overlap, escape, failed steps, energy that appears.
#include "models/classify.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

// what contact springs may give back later: a law f ~ depth^n holds f depth/(n+1), friction springs less
WireEnergy energy_of(const WireReadings& r)
{
    return {r.kinetic, r.elastic + r.gravitational, (r.normal + r.friction) * r.overlap};
}

bool all_finite(const WireReadings& r)
{
    return std::isfinite(r.hand_force + r.hand_torque + r.normal + r.friction + r.overlap + r.outside + r.kinetic + r.elastic +
                         r.gravitational + r.base_force.sum());
}

// A fed wire whose piece is still in the introducer has no energies yet, and a wire that was placed bent has none before its
// first step; they begin when they are first known.
bool not_known_yet(const WireReadings& r, long step)
{
    return (r.nodes == 2 || step == 1) && r.kinetic == 0 && r.elastic == 0 && r.gravitational == 0;
}

constexpr int least_window = 10;  // steps; fewer say nothing of jitter
constexpr int least_turns = 3;    // in a window

}  // namespace

const char* name(Outcome outcome)
{
    static constexpr const char* names[] = {"hold", "jitter", "overlap", "escape", "gave-up", "blow-up"};
    return names[static_cast<int>(outcome)];
}

FailureWatch::FailureWatch(const FailureLimits& limits, const WireReadings& start)
    : limits_(limits), last_(start), jitter_(limits)
{
    balance_.begin(energy_of(start));
}

void FailureWatch::note(Outcome outcome)
{
    long& first = first_step_[static_cast<int>(outcome)];
    if (first < 0) first = seen_.steps;
}

void FailureWatch::observe(const StepReport& report, const WireReadings& now, double work, double carried_in, double jerk)
{
    seen_.steps++;
    seen_.sub_steps = std::max(seen_.sub_steps, report.sub_steps);
    seen_.newton_iterations = std::max(seen_.newton_iterations, report.newton_iterations);
    iterations_ += report.newton_iterations;
    if (report.flags & (StepNotConverged | StepBestEffort)) note(Outcome::GaveUp);
    if ((report.flags & (StepNonFinite | StepEnergy)) || !all_finite(now))
        return note(Outcome::BlowUp);  // nothing in `now` can be reckoned with

    seen_.overlap = std::max(seen_.overlap, now.overlap);
    seen_.outside = std::max(seen_.outside, now.outside);
    if (now.outside > 0 || (report.flags & StepWallPenetration)) note(Outcome::Escape);
    if (now.overlap > std::min(2 * limits_.static_indentation, limits_.radius)) note(Outcome::Overlap);
    seen_.touching += now.normal > 0;
    seen_.hand_force = std::max(seen_.hand_force, std::abs(now.hand_force));
    note_jitter(jitter_.add(now.hand_force));
    watch_energy(now, {work, carried_in, jerk});
    last_ = now;
}

void FailureWatch::note_jitter(double ratio)
{
    seen_.jitter = std::max(seen_.jitter, ratio);
    if (ratio > limits_.jitter) note(Outcome::Jitter);
}

JitterMeter::JitterMeter(const FailureLimits& limits) : length_(limits.jitter_window), floor_(limits.force_floor)
{
    SEL_ASSERT(length_ >= least_window);
    window_.reserve(static_cast<std::size_t>(length_));
}

double JitterMeter::add(double force)
{
    if (++forces_ > 2) {
        const double came = last_ - before_, went = force - last_;
        window_.push_back(came * went < 0 ? std::min(std::abs(came), std::abs(went)) : 0.0);
        sum_ += std::abs(last_);
    }
    before_ = last_;
    last_ = force;
    if (static_cast<int>(window_.size()) < length_) return -1;
    const double ratio = of_window();
    sum_ = 0;
    window_.clear();
    return ratio;
}

// the rest of the last window counts if it is long enough, or if there is no other
double JitterMeter::rest() const
{
    const int left = static_cast<int>(window_.size());
    return left >= least_window && (2 * left >= length_ || forces_ <= length_ + 2) ? of_window() : -1;
}

double JitterMeter::of_window() const
{
    std::vector<double> turns = window_;
    const auto size = static_cast<std::ptrdiff_t>(turns.size());
    const auto tenth = turns.begin() + std::min(size * 9 / 10, size - least_turns);
    std::nth_element(turns.begin(), tenth, turns.end());
    return *tenth / std::max(sum_ / static_cast<double>(size), floor_);
}

double jitter_of(std::span<const double> forces, const FailureLimits& limits)
{
    JitterMeter meter(limits);
    double worst = 0;
    for (const double force : forces) worst = std::max(worst, meter.add(force));
    return std::max(worst, meter.rest());
}

void FailureWatch::watch_energy(const WireReadings& now, const EnergyInput& input)
{
    EnergyInput step = input;
    step.work += (now.hand_force + last_.hand_force) / 2 * (now.inserted - last_.inserted) +
                 (now.hand_torque + last_.hand_torque) / 2 * (now.turned - last_.turned);
    if (not_known_yet(last_, seen_.steps)) return balance_.begin_after(energy_of(now), step);
    if (!balance_.take_in(energy_of(now), step, limits_.energy)) note(Outcome::BlowUp);
    seen_.energy_made = balance_.made();
}

Verdict FailureWatch::verdict() const
{
    FailureWatch ended = *this;
    ended.note_jitter(jitter_.rest());
    Verdict verdict;
    verdict.first_step = ended.first_step_;
    verdict.readings = ended.seen_;
    verdict.readings.mean_iterations = seen_.steps > 0 ? static_cast<double>(iterations_) / seen_.steps : 0;
    for (int k = 1; k < 6; ++k)
        if (verdict.first_step[k] >= 0) verdict.outcome = static_cast<Outcome>(k);
    return verdict;
}

namespace {

/// At one place of the wire [kg/m].
double line_density(const WireSpec& wire, double s)
{
    const WireSection& section = wire.at(s);
    return section.density * std::numbers::pi * section.radius * section.radius;
}

}  // namespace

double fed_energy(const WorldSetup& setup, int wire, double from, double to, double speed)
{
    const WireSetup& w = setup.wires[wire];
    return (to - from) * line_density(w.wire, (from + to) / 2) * (speed * speed - setup.gravity.dot(w.feed.point));
}

double jerk_energy(const WorldSetup& setup, int wire, double inside, double speed_before, double speed)
{
    return inside * line_density(setup.wires[wire].wire, inside / 2) * std::abs(speed * speed - speed_before * speed_before);
}

}  // namespace seldinger

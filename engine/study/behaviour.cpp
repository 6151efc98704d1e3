#include "study/behaviour.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

constexpr double least_force = 1e-3;  // [N]: a hand does not feel jitter of a tenth of this

double mass_of(const WireSpec& wire)
{
    const double area = std::numbers::pi * wire.shaft.radius * wire.shaft.radius;
    double heaviest = wire.shaft.density * area;
    for (const WireSectionRange& range : wire.sections)
        heaviest = std::max(heaviest, range.section.density * std::numbers::pi * range.section.radius * range.section.radius);
    return heaviest * wire.length;
}

double fastest_feed(const FeedSpec& feed)
{
    double fastest = 0;
    for (std::size_t k = 1; k < feed.keys.size(); ++k)
        fastest =
            std::max(fastest, std::abs(feed.keys[k].advance - feed.keys[k - 1].advance) / (feed.keys[k].t - feed.keys[k - 1].t));
    return fastest;
}

double base_turn(const Scene& scene, double t)
{
    for (const HoldSpec& hold : scene.holds) {
        if (hold.at.kind != WirePoint::Kind::Base || hold.turn.empty()) continue;
        if (t <= hold.turn.front()[0]) return hold.turn.front()[1];
        for (std::size_t k = 1; k < hold.turn.size(); ++k) {
            const auto &a = hold.turn[k - 1], &b = hold.turn[k];
            if (t <= b[0]) return a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]);
        }
        return hold.turn.back()[1];
    }
    return 0;
}

/// Work comes in at the base and by forces on tip or base; anything else is not metered here.
bool work_is_metered(const Scene& scene)
{
    if (!scene.links.empty()) return false;
    for (const LoadSpec& load : scene.loads)
        if (load.at.kind == WirePoint::Kind::Distance || !load.moment.isZero()) return false;
    for (const HoldSpec& hold : scene.holds) {
        const bool moves = !hold.move.empty() || !hold.turn.empty() || !hold.velocity.isZero();
        if (moves && hold.at.kind != WirePoint::Kind::Base) return false;
    }
    return true;
}

}  // namespace

std::string_view word_of(Verdict verdict)
{
    constexpr std::string_view words[] = {"hold", "jitter", "overlap", "escape", "blow-up", "gave up"};
    return words[static_cast<int>(verdict)];
}

BehaviourWatch::BehaviourWatch(const Scene& scene, const BehaviourLimits& limits)
    : scene_(scene), limits_(limits), knows_work_(work_is_metered(scene))
{
    if (limits_.overlap == 0) limits_.overlap = scene.wire.shaft.radius;
    const double mass = mass_of(scene.wire), speed = std::max(fastest_feed(scene.feed), scene.wire.place.velocity.norm());
    put_in_ = mass * scene.gravity.norm() * scene.wire.length + 0.5 * mass * speed * speed;
    // a placed shape that is not the stress-free one starts with elastic energy, and so may a spinning wire with kinetic: that of
    // the first step is taken as given (after_step)
}

void BehaviourWatch::add_work(const WireReadings& now, const std::vector<Vec3>& shape, double t)
{
    const Vec3 tip = shape.front(), base = shape.back();
    const double turned = scene_.feed.on ? now.turned : base_turn(scene_, t);
    if (seen_.steps == 1) {
        put_in_ += now.kinetic + now.elastic;
    } else {
        const auto give = [&](double work) { put_in_ += std::max(0.0, work); };
        give(now.hand_torque * (turned - last_turned_));
        if (scene_.feed.on) give(now.hand_force * (now.inserted - last_inserted_));
        else give(now.base_force.dot(base - last_base_));
        for (const LoadSpec& load : scene_.loads)
            give(load.force.dot(load.at.kind == WirePoint::Kind::Tip ? tip - last_tip_ : base - last_base_));
    }
    last_tip_ = tip;
    last_base_ = base;
    last_turned_ = turned;
    last_inserted_ = now.inserted;
}

bool BehaviourWatch::after_step(const Simulation& simulation, const StepReport& report, double t)
{
    if (ended_) return false;
    ++seen_.steps;
    seen_.newton += report.newton_iterations;
    if (report.flags & StepHalved) ++seen_.halved;
    if (report.flags & StepBestEffort) ++seen_.best_effort;
    const WireReadings now = simulation.readings();
    const auto end = [&](Verdict verdict) {
        seen_.verdict = verdict;
        seen_.failed_at = t;
        ended_ = true;
        return false;
    };
    const std::vector<Vec3> shape = simulation.shape();
    const bool finite = std::isfinite(now.kinetic + now.elastic + now.hand_force) && shape.front().allFinite();
    if ((report.flags & StepNonFinite) || !finite) return end(Verdict::BlowUp);
    if (report.failed()) return end(Verdict::GaveUp);
    seen_.overlap = std::max(seen_.overlap, now.overlap);
    seen_.outside = std::max(seen_.outside, now.outside);
    hand_force_.push_back(now.hand_force);
    if (!knows_work_) return true;
    add_work(now, shape, t);
    if (put_in_ <= 0) return true;
    seen_.energy_ratio = std::max(seen_.energy_ratio, (now.kinetic + now.elastic) / put_in_);
    if (seen_.energy_ratio > limits_.energy) return end(Verdict::BlowUp);
    return true;
}

double BehaviourWatch::jitter() const
{
    if (hand_force_.size() < 3) return 0;
    std::vector<double> change;
    double mean = 0;
    for (const double f : hand_force_) mean += std::abs(f) / static_cast<double>(hand_force_.size());
    for (std::size_t k = 1; k + 1 < hand_force_.size(); ++k)
        change.push_back(std::abs(hand_force_[k + 1] - 2 * hand_force_[k] + hand_force_[k - 1]) / 2);
    const auto place = change.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(change.size() - 1));
    std::nth_element(change.begin(), place, change.end());
    return *place / std::max(mean, least_force);
}

Behaviour BehaviourWatch::result() const
{
    Behaviour result = seen_;
    result.jitter = jitter();
    if (ended_) return result;
    if (result.outside > limits_.outside) result.verdict = Verdict::Escape;
    else if (result.overlap > limits_.overlap) result.verdict = Verdict::Overlap;
    else if (result.jitter > limits_.jitter) result.verdict = Verdict::Jitter;
    return result;
}

}  // namespace seldinger

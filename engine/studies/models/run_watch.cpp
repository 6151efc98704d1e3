// Adds up the work of holds and loads on a wire and hands it to the failure watch after each step.
#include "models/run_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

/// How far the base has been turned by its hold [rad].
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

bool work_is_metered(const Scene& scene)
{
    if (!scene.links.empty() || !scene.forces.empty()) return false;
    for (const LoadSpec& load : scene.loads)
        if (load.at.kind == WirePoint::Kind::Distance || !load.moment.isZero()) return false;
    for (const HoldSpec& hold : scene.holds) {
        const bool moves = !hold.move.empty() || !hold.turn.empty() || !hold.velocity.isZero();
        if (moves && hold.at.kind != WirePoint::Kind::Base) return false;
    }
    return true;
}

FailureLimits completed(FailureLimits limits, const Scene& scene)
{
    if (!std::isfinite(limits.radius) || limits.radius == 0) {
        limits.radius = scene.wire.shaft.radius;
        for (const WireSectionRange& range : scene.wire.sections) limits.radius = std::min(limits.radius, range.section.radius);
    }
    // what a wall takes and gives back, or another instrument's hand, only the engine's own audit knows (energy_audit.h), which
    // ends such a run
    if (!work_is_metered(scene) || scene.vessel.elastic || !scene.others.empty())
        limits.energy.floor = std::numeric_limits<double>::infinity();
    return limits;
}

}  // namespace

RunWatch::RunWatch(const Scene& scene, const WorldSetup& setup, FailureLimits limits, bool end_on_blow_up,
                   const Simulation& start)
    : scene_(scene),
      setup_(setup),
      watch_(completed(limits, scene), start.readings()),
      end_on_blow_up_(end_on_blow_up),
      last_(start.readings()),
      tip_(start.shape().front()),
      base_(start.shape().back())
{
}

double RunWatch::work_of_step(const WireReadings& now, const std::vector<Vec3>& shape, double t)
{
    double work = 0;
    if (!scene_.feed.on) {  // the hand that feeds is in the readings
        const double turned = base_turn(scene_, t);
        work += (now.base_force + last_.base_force).dot(shape.back() - base_) / 2;
        // both about the direction of insertion
        work += (now.hand_torque + last_.hand_torque) / 2 * (turned - turned_);
        turned_ = turned;
    }
    for (const LoadSpec& load : scene_.loads) {
        const double share = load.ramp > 0 ? std::min(1.0, (t + t_) / 2 / load.ramp) : 1.0;
        work += share * load.force.dot(load.at.kind == WirePoint::Kind::Tip ? shape.front() - tip_ : shape.back() - base_);
    }
    return work;
}

bool RunWatch::after_step(const Simulation& simulation, const StepReport& report, double t)
{
    const WireReadings now = simulation.readings();
    const std::vector<Vec3> shape = simulation.shape();
    const double dt = t - t_;
    double carried = 0, jerk = 0;
    if (scene_.feed.on && dt > 0) {
        const double speed = (now.inserted - last_.inserted) / dt;
        carried = fed_energy(setup_, 0, last_.inserted, now.inserted, speed);
        jerk = jerk_energy(setup_, 0, scene_.feed.at(t).advance, speed_, speed);
        speed_ = speed;
    }
    watch_.observe(report, now, work_of_step(now, shape, t), carried, jerk);
    last_ = now;
    tip_ = shape.front();
    base_ = shape.back();
    t_ = t;
    const bool finite = std::isfinite(now.kinetic + now.elastic + now.hand_force) && tip_.allFinite();
    return !report.failed() && finite && !(end_on_blow_up_ && watch_.verdict().had(Outcome::BlowUp));
}

}  // namespace seldinger

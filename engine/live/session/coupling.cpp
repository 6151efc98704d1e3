// The coupling's equation of one step, its energies, and the damping that brings them back above zero.
#include "session/coupling.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double most_damping = 20;  // times that of the spec: more, and the damper is a lock
// Rounding of sums of millijoules over hours stays far below this [J]; a deficit that could be felt is far above.
constexpr double negligible = 1e-12;

}  // namespace

/// With what the observer misses, taken out of the motion as it was in the last step.
double Coupling::damping() const
{
    const double missing = -energy();
    if (missing <= negligible || stretch_rate_ == 0) return spec_.damping;
    const double extra = missing / (stretch_rate_ * stretch_rate_ * step_);
    return spec_.damping + std::min(extra, most_damping * spec_.damping);
}

double Coupling::next(double hand, const HubLoad& load, double low, double high)
{
    const double k = spec_.stiffness, b = damping() / step_;
    moved_by_hand_ = hand - hand_;
    hand_ = hand;
    const double inertia = std::min(load.mass / (step_ * step_), load.stiffness);
    const double at_rest = load.force - inertia * (moved_ - moved_before_);
    const double whole = k + b + load.stiffness;
    const double d = (k * (hand - hub_) + b * moved_by_hand_ - at_rest + inertia * moved_) / whole;
    const double reach = spec_.speed_limit * step_;
    const double to = std::clamp(hub_ + std::clamp(d, -reach, reach), low, high);
    go_to(to, b, to != hub_ + d ? k : k * load.stiffness / whole);  // at an end of its path the hub does not give
    return hub_;
}

void Coupling::go_to(double to, double damping, double slope)
{
    const double d = to - hub_, before = stretch_;
    moved_before_ = moved_;
    moved_ = d;
    hub_ = to;
    stretch_ = hand_ - hub_;
    stretch_rate_ = (stretch_ - before) / step_;
    force_ = spec_.stiffness * stretch_ + damping * (moved_by_hand_ - d);
    slope_ = slope;
    brought_ += force_ * moved_by_hand_;
}

double Coupling::pull(double hand)
{
    moved_by_hand_ = hand - hand_;
    hand_ = hand;
    return spec_.stiffness * (hand - hub_) + spec_.damping / step_ * moved_by_hand_;
}

void Coupling::pulled_to(double to, double stiffness)
{
    go_to(to, spec_.damping / step_, spec_.stiffness * stiffness / (spring_of(spec_, step_) + stiffness));
    stepped(force_);
}

void Coupling::stepped(double force)
{
    done_ += force * moved_;
    lowest_ = std::min(lowest_, energy());
}

void Coupling::place(double at)
{
    brought_ -= stored();  // let go of, not given back
    hand_ = hub_ = at;
    moved_ = moved_before_ = stretch_ = stretch_rate_ = force_ = slope_ = 0;
}

}  // namespace seldinger

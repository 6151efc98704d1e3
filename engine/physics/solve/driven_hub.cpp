// The equation of a hub that a force drives, and its energies.
#include "solve/driven_hub.h"

#include <algorithm>

namespace seldinger {

HubEquation::HubEquation(const HubSpec& spec, const HubState& start, double force, double spring, double h, double low,
                         double high)
    : spec_(spec), start_(start), force_(force), spring_(spring), h_(h), end_low_(low), end_high_(high)
{
}

double HubEquation::solve(const Answer& answer) const
{
    const double slope = (spec_.mass / h_ + spec_.damping) / h_ + spring_ + answer.stiffness;
    const double pushed = force_ + spec_.mass * start_.speed / h_ - answer.force + answer.stiffness * answer.at;
    const double beyond = std::max(0.0, std::abs(pushed) - spec_.friction);  // of what the friction takes at rest
    return std::clamp(std::copysign(beyond, pushed) / slope, end_low_, end_high_);
}

double HubEquation::first() const
{
    const double at_rest = start_.answer - start_.mass * (start_.acceleration + start_.speed / h_);
    return solve({0, at_rest, start_.stiffness + start_.mass / (h_ * h_)});
}

double HubEquation::rest(double u, double answer) const
{
    const double left = force_ - spring_ * u - answer - ((spec_.mass / h_ + spec_.damping) * u - spec_.mass * start_.speed) / h_;
    if ((u >= end_high_ && left > 0) || (u <= end_low_ && left < 0)) return 0;  // the end of the way takes it
    if (u > 0) return left - spec_.friction;
    if (u < 0) return left + spec_.friction;
    return std::copysign(std::max(0.0, std::abs(left) - spec_.friction), left);
}

double HubEquation::next(const Answer& answer)
{
    (rest(answer.at, answer.force) > 0 ? low_ : high_) = answer.at;
    const double u = solve(answer);
    return u > low_ && u < high_ ? u : 0.5 * (low_ + high_);
}

HubState HubEquation::after(const Answer& answer, double mass) const
{
    const double u = answer.at;
    HubState now = start_;
    now.speed = u / h_;
    now.acceleration = (now.speed - start_.speed) / h_;
    now.answer = answer.force;
    now.mass = std::min(mass, answer.stiffness * h_ * h_);
    now.stiffness = answer.stiffness - now.mass / (h_ * h_);

    const double force = force_ - spring_ * u, more = now.speed - start_.speed;
    HubReadings& r = now.readings;
    r.speed = now.speed;
    r.force = force;
    r.kinetic = 0.5 * spec_.mass * now.speed * now.speed;
    r.work += force * u;
    r.wire += answer.force * u;
    r.damping += spec_.damping * now.speed * u;
    r.friction += spec_.friction * std::abs(u);
    r.scheme += 0.5 * spec_.mass * more * more;
    if (u == end_low_ || u == end_high_)
        r.stopped += (force - answer.force - spec_.damping * now.speed - std::copysign(spec_.friction, u)) * u -
                     spec_.mass * more * now.speed;
    return now;
}

}  // namespace seldinger

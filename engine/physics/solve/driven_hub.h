#pragma once
// A hub that a force drives (D16): one equation beside those of the instrument, in the way u that the hub goes within a step.
//
//   m dv/dt + c v + f sgn(v) + P = F                                                                                   (D16)
//
// m [kg], c [N s/m] and f [N] are the hand's (HubSpec): what moves with it, and what resists it outside of the body. F is its
// force and P the instrument's answer, WireReadings::hand_force. v is the speed of the feed; at rest the friction takes what it
// has to, up to f. Backward Euler from the speed v_0 over a step h, with F = F_0 - S u as of a spring to the hand:
//
//   (m/h^2 + c/h + S) u + f sgn(u) + P(u) = F_0 + m v_0/h,      v = u/h
//
// P(u) is what the instrument answers at the end of the step in which u is fed. The step's own equations are solved for a given
// u, as for any other feed, and u is corrected until the rest of (D16) is within their tolerance: Newton's method, with dP/du
// that of the step's tangent, the instrument's stiffness and inertia together. So the hub is as implicit as the instrument, and
// a light hub on a stiff wire is stable at any step. P rises with u; rests of both signs enclose the solution, and no trial
// leaves that interval. The first trial of a step takes the answer of the last one,
//
//   P = P_0 + K u + (M/h^2) (u - v_0 h) - M a_0,
//
// where M is the part of the instrument that moves with the hub within a step, a_0 its acceleration then, and K the stiffness
// that is left without it.
//
// Times u, (D16) is the balance of energy: F u = P u + [m v^2/2 - m v_0^2/2] + m (v - v_0)^2/2 + c v u + f |u|.
//
// The hub's way ends where the whole instrument is inside, and outside of the body. There it stops, and what it brought along is
// lost.

#include "solve/hub_readings.h"
#include "solve/solve_spec.h"

#include <cmath>

namespace seldinger {

/// What of a driven hub survives a step.
struct HubState {
    double speed = 0, acceleration = 0;  // [m/s], [m/s^2]
    double answer = 0;                   // P [N]
    double mass = 0, stiffness = 0;      // M [kg], K [N/m]
    HubReadings readings;                // affects no motion
};

/// The hub's equation in one sub-step.
class HubEquation {
public:
    /// Where the instrument answers `answer`, and by how much more with each metre fed.
    struct Answer {
        double at = 0, force = 0, stiffness = 0;  // [m], [N], [N/m]
    };

    HubEquation() = default;
    /// @param force, spring  F_0 [N], S [N/m]      @param low, high  ends of the hub's way from here [m]
    HubEquation(const HubSpec& spec, const HubState& start, double force, double spring, double h, double low, double high);

    /// The first trial. [m]
    [[nodiscard]] double first() const;
    /// The next one, after the last one's answer.
    [[nodiscard]] double next(const Answer& answer);
    /// What is left of the equation where u has been fed [N]; > 0: the hub goes on.
    [[nodiscard]] double rest(double u, double answer) const;
    /// No trial between the enclosing ones is another number, as far as anyone can tell.
    [[nodiscard]] bool closed() const { return high_ - low_ <= narrowest; }
    /// The state after its `at`. @param mass  of the instrument's part inside [kg]
    [[nodiscard]] HubState after(const Answer& answer, double mass) const;

private:
    static constexpr double narrowest = 1e-12;  // [m]
    [[nodiscard]] double solve(const Answer& answer) const;

    HubSpec spec_;
    HubState start_;
    double force_ = 0, spring_ = 0, h_ = 1;
    double end_low_ = 0, end_high_ = 0;  // of the way
    double low_ = -INFINITY, high_ = INFINITY;  // that enclose the solution
};

}  // namespace seldinger

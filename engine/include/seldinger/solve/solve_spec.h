#pragma once
// The user's settings of the integrator, and the holds, loads and feeds of a wire. Times [s], SI.

#include "rod/wire_spec.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

enum class Scheme { Newton, Linearised, Static, Explicit };

/// Auto: spin angles are unknowns only of steps in which torques do not balance without (solve/spins.cpp). Kept: of all steps.
enum class Spins { Auto, Kept };

struct IntegratorSpec {
    Scheme scheme = Scheme::Newton;
    bool newmark = false;   // the trapezoid rule, Newmark's with beta = 1/4 and gamma = 1/2; false: backward Euler
    bool conserve = false;  // energy-momentum steps (rod/discrete_gradient.h); not with newmark
    Spins spins = Spins::Auto;
    double tolerance = 1e-6;       // force residual relative to the scene's own force scale [-] (see solve/wire_scales.cpp)
    double damping_mass = 0;       // [1/s]
    double damping_stiffness = 0;  // [s]
};

/// A point of the wire: its tip, its base, or a distance from the tip.
struct WirePoint {
    enum class Kind { Base, Tip, Distance } kind = Kind::Base;
    double from_tip = 0;  // [m]
};

struct HoldSpec {
    WirePoint at;
    bool position = false, direction = false, spin = false;  // what is held
    std::array<bool, 3> axes = {true, true, true};           // of `position`: which of x, y, z; it slides along the others
    std::vector<std::array<double, 4>> move;                 // [t, dx, dy, dz], piecewise linear, relative to the start
    std::vector<std::array<double, 2>> turn;                 // [t, rad], right-handed about the direction of insertion
    Vec3 velocity = Vec3::Zero();                            // added to `move` [m/s]
    double until = std::numeric_limits<double>::infinity();  // lets go after this time [s]

    /// Whether coordinate c of the position is held.
    [[nodiscard]] bool holds(int c) const { return position && axes[static_cast<std::size_t>(c)]; }
};

struct LoadSpec {
    WirePoint at;
    Vec3 force = Vec3::Zero();   // dead [N]
    Vec3 moment = Vec3::Zero();  // dead [N m]
    double ramp = 0;             // linear from 0 over this time [s]
    double until = std::numeric_limits<double>::infinity();  // acts up to this time [s]
};

struct LinkSpec {
    WirePoint at;
    Vec3 anchor = Vec3::Zero();
    double stiffness = 0;  // [N/m]
    std::vector<std::array<double, 4>> move;
};

/// Where the hub of a fed wire is at time t [s]: how much wire has been pushed in [m], and by how much it has been turned [rad],
/// right-handed about the direction of insertion. Of a hub that a force drives: by which force instead of how far [N].
struct FeedKey {
    double t = 0, advance = 0, turn = 0, force = 0;
};

/// A hub that moves as a force pushes it (D16): what moves with the hand, and what holds that back outside of the body.
struct HubSpec {
    double mass = 0;      // [kg]; 0: no force drives the hub, a control says where it is
    double damping = 0;   // [N s/m]
    double friction = 0;  // dry, of a valve or a grip [N]
    [[nodiscard]] bool driven() const { return mass > 0; }
};

/// The inlet that a wire is fed through, and where its hub is at the start.
struct FeedSpec {
    bool on = false;
    Vec3 point = Vec3::Zero(), direction = Vec3::UnitX();
    double advance = 0, turn = 0;  // at the start [m], [rad]
    HubSpec hub;
    // For instruments in one centreline: length between the hand and the inlet at the start. It is twisted, and gets shorter as
    // the instrument is pushed; 0: the hand is always at the inlet [m].
    double behind = 0;
    std::vector<Vec3> path;  // what is inside at the start lies along it, from the inlet on [m]; empty: straight ahead
};

}  // namespace seldinger

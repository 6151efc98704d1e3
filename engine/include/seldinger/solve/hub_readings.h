#pragma once
// What is read of a hub that a force drives.

namespace seldinger {

/// A hub that a force drives (D16), and its energy balance since the start [J].
struct HubReadings {
    double speed = 0;  // [m/s]
    double force = 0;  // that drives it, at the end of the last step [N]
    double work = 0;   // of that force
    double wire = 0;   // done on the instrument: hand_force times the way
    double kinetic = 0;
    // lost to friction and damping of the hub; where it has run to an end of its way; by backward Euler
    double friction = 0, damping = 0, stopped = 0, scheme = 0;

    [[nodiscard]] double open() const { return work - wire - kinetic - friction - damping - stopped - scheme; }
};

}  // namespace seldinger

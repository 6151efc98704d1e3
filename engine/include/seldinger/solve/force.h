#pragma once
// The door for a force of your own: it sees points of one instrument and says what acts on them. World::add_force takes it.
//
//   forces    f [N] and m [N m] on each point, in world axes, at every trial of Newton's method, or once a sub-step
//   tangents  K = d(f, m)/d(x, phi) and C = d(f, m)/d(v, omega) of each point; without them the engine takes differences
//   energy    U [J] of all points, for a reading
//   accept    a sub-step has ended there: the only place where its state may change
//
// x is the point, v its velocity, phi a small turn of its frame and omega that per second: the work on a move is f.dx + m.dphi.
// Each point's force depends on its own motion, on time and on the state. Calls come one after the other, from the thread that
// steps the world. Whatever a call throws ends the step, which then leaves the world as it was.

#include "math/vec3.h"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace seldinger {

/// What a force sees: arrays [points], tip first, worth nothing after the call.
struct ForcePoints {
    double time = 0, dt = 0;                 // end of the sub-step, its length (0: an equilibrium) [s]
    std::span<const double> s, length;       // from the tip along the unstressed wire; wire that it stands for, 0: a point [m]
    std::span<const Vec3> position;          // x [m]
    std::span<const Vec3> velocity;          // v: mean over the sub-step [m/s]
    std::span<const Vec3> axis, director;    // unit: direction of insertion; first director of the material
    std::span<const Vec3> turning;           // omega [rad/s]
    std::span<const double> state;           // as accept() has left it
};
struct PointForce {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();  // [N], [N m]
};
/// Rows fx, fy, fz, mx, my, mz; columns x, y, z and the turns about these axes.
using PointMatrix = std::array<std::array<double, 6>, 6>;
struct PointTangent {
    PointMatrix stiffness{}, damping{};  // K, C
};

class Force {
public:
    virtual ~Force() = default;
    /// @param out  [points], zero when called
    virtual void forces(const ForcePoints& at, std::span<PointForce> out) const = 0;
    /// Of each point, zero when called. @return false: it has none
    [[nodiscard]] virtual bool tangents(const ForcePoints& /*at*/, std::span<PointTangent> /*out*/) const { return false; }
    [[nodiscard]] virtual double energy(const ForcePoints& /*at*/) const { return 0; }
    virtual void accept(const ForcePoints& /*at*/, std::span<double> /*state*/) const {}

    // set before it is added to a world
    std::string name = "force";  // in messages
    enum class On { Points, Nodes, Edges } on = On::Points;  // `places`; each node; the middle of each edge
    std::vector<double> places = {0};  // from the tip [m]; what is not inside yet is left out
    std::vector<double> state;         // at the start: saved, hashed and restored with the world
    bool each_trial = true;            // false: asked once, at the start of a sub-step, and constant through it
};

}  // namespace seldinger

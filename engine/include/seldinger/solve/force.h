#pragma once
// The door for a force of your own: it sees points of an instrument and says what acts on them. World::add_force takes it, or a
// scene's [[force]], from a library that ends with SELDINGER_FORCE(class).
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
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace seldinger {

/// What a force sees: arrays [points], tip first, worth nothing after the call.
struct ForcePoints {
    double time = 0, dt = 0;                 // end of the sub-step, its length (0: an equilibrium) [s]
    std::span<const int> wire;               // instrument of the point: one in a call, unless Force::together
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
    bool together = false;             // added to several instruments: asked for all in one call, but for energy; no state
    // of a sensor: names of the first numbers of `state`, sensor_NAME.csv of a run; a row at each step in which the first changes
    std::vector<std::string> record;
};

/// The keys of a scene's [[force]] that are the plugin's own. One that is asked for without a default must be there; one that
/// nobody asks for is refused.
class ForceKeys {
public:
    std::map<std::string, std::vector<double>> lists;  // a number is a list of one
    std::map<std::string, std::string> texts;
    mutable std::set<std::string> asked;

    [[nodiscard]] const std::vector<double>& list(const std::string& key) const { return of(lists, key, "numbers"); }
    [[nodiscard]] const std::string& text(const std::string& key) const { return of(texts, key, "a text"); }
    [[nodiscard]] double number(const std::string& key) const { return sized(key, 1, "a number")[0]; }
    [[nodiscard]] double number(const std::string& key, double absent) const { return has(key) ? number(key) : absent; }
    [[nodiscard]] Vec3 vector(const std::string& key) const { return Vec3(sized(key, 3, "three numbers [x, y, z]").data()); }
    [[nodiscard]] bool has(const std::string& key) const { return asked.insert(key), lists.contains(key) || texts.contains(key); }

private:
    const std::vector<double>& sized(const std::string& key, std::size_t size, const char* expected) const
    {
        if (list(key).size() != size) throw std::runtime_error(key + ": got other numbers; expected " + expected);
        return list(key);
    }
    template <class Values>
    const typename Values::mapped_type& of(const Values& values, const std::string& key, const char* expected) const
    {
        if (!has(key)) throw std::runtime_error(key + ": is missing; expected " + expected);
        if (!values.contains(key)) throw std::runtime_error(key + ": got a value of another kind; expected " + expected);
        return values.at(key);
    }
};

// What a library and the program that loads it must agree in: this file, and the compiler's layout of classes.
#define SELDINGER_TEXT_OF(X) #X
#define SELDINGER_TEXT(X) SELDINGER_TEXT_OF(X)
#define SELDINGER_FORCE_VERSION "force 1, C++ ABI " SELDINGER_TEXT(__GXX_ABI_VERSION)
/// Makes a library a plugin: Class, a Force, has a constructor that takes const ForceKeys&.
#define SELDINGER_FORCE(Class)                                                                                   \
    extern "C" __attribute__((visibility("default"))) const char seldinger_force_version[] = SELDINGER_FORCE_VERSION; \
    extern "C" __attribute__((visibility("default"))) seldinger::Force* seldinger_make_force(                    \
        const seldinger::ForceKeys& keys)                                                                        \
    {                                                                                                            \
        return new Class(keys);                                                                                  \
    }

}  // namespace seldinger

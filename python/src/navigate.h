#pragma once
// What a policy that steers a wire through a vessel sees: the tip and the shape in coordinates of the centreline that leads to a
// target. It concerns every system's first instrument.
//
// Every point i of the centreline knows its path D_i [m] along the tree to the target and the next point on it. A place p whose
// nearest point is i has the path D_i - (p - c_i).u_i left, u_i the direction of the path there. It is off the centreline by ((p
// - c_i).n_i, (p - c_i).b_i) / r_i. The frames (u, n, b) are carried along the tree from the target without twist.

#include "engine.h"

#include <span>
#include <vector>

namespace seldinger::python {

struct NavigateSpec {
    Vec3 target = Vec3::Zero();   // [m]
    int shape_points = 6;         // along the wire, from the tip
    double shape_spacing = 0.01;  // [m] of wire
    int ahead_points = 4;         // on the path to the target, from the tip's place
    double ahead_spacing = 0.01;  // [m]
};

class Navigator {
public:
    /// @throws Error BadScene: no centreline
    Navigator(const Centreline& centreline, const NavigateSpec& spec);

    /// Numbers of one observation: `tip` 8, `ahead` 3 per point, `shape` 3 per point, `hand` 2, `wall` 2, `hub` 3.
    [[nodiscard]] int size() const { return 15 + 3 * (spec_.ahead_points + spec_.shape_points); }
    static constexpr int measure_count = 9;

    /// @param observation  [systems][size()]
    /// @param measures     [systems][9]: path left [m], distance from the target [m], hand force [N], hand torque [N m], normal
    /// force
    ///                     of the wall, summed [N], advance [m], turn [rad], whether a step failed, simulated time [s]
    /// @param failed       per instrument. Rows of retired systems stay as they are
    void observe(const World& world, std::span<const std::uint8_t> failed, std::span<float> observation,
                 std::span<double> measures) const;
    /// The path that is left from a place [m].
    [[nodiscard]] double way(const Vec3& place) const;

private:
    struct Place {
        int at = 0;           // nearest point of the centreline
        double left = 0;      // path to the target [m]
        double n = 0, b = 0;  // off the centreline, radii of the lumen
    };
    [[nodiscard]] Place locate(const Vec3& p) const;
    [[nodiscard]] Vec3 ahead(int at, double distance) const;
    void see(const World& world, int system, bool failed, float* to, double* measures) const;

    NavigateSpec spec_;
    std::vector<double> x_, y_, z_;  // of the centreline's points [m]
    std::vector<double> radius_, left_;
    std::vector<int> next_;  // towards the target; of the last point itself
    std::vector<Vec3> u_, n_, b_;
};

}  // namespace seldinger::python

// A force of one's own: a spring from the tip of a cantilever to a point, against the formula for small deflections.

#include <seldinger/engine.h>

#include <cmath>
#include <cstdio>

using namespace seldinger;

namespace {

class Spring final : public Force {
public:
    Spring(const Vec3& anchor, double stiffness) : anchor_(anchor), stiffness_(stiffness) { name = "spring"; }
    void forces(const ForcePoints& at, std::span<PointForce> out) const override
    {
        out[0].force = stiffness_ * (anchor_ - at.position[0]);
    }
    bool tangents(const ForcePoints&, std::span<PointTangent> out) const override
    {
        for (int c = 0; c < 3; ++c) out[0].stiffness[c][c] = -stiffness_;
        return true;
    }
    double energy(const ForcePoints& at) const override
    {
        return 0.5 * stiffness_ * (anchor_ - at.position[0]).squaredNorm();
    }

private:
    Vec3 anchor_;
    double stiffness_;
};

}  // namespace

int main()
{
    const double length = 0.2, bend = 1e-3, spring = 0.3, away = 2e-3;  // [m], [N m^2], [N/m], [m]
    WireSetup wire;
    wire.wire.length = length;
    wire.wire.nodes = 81;
    wire.wire.shaft.radius = 5e-4;
    wire.wire.shaft.density = 6500;
    wire.wire.shaft.bend_stiffness = wire.wire.shaft.twist_stiffness = bend;
    wire.wire.shaft.stretch_stiffness = 1e5;
    HoldSpec clamp;  // of the base
    clamp.position = clamp.direction = clamp.spin = true;
    wire.holds.push_back(clamp);
    WorldSetup setup;
    setup.gravity = Vec3::Zero();
    setup.integrator.scheme = Scheme::Static;
    setup.wires.push_back(wire);
    try {
        World world(setup);
        world.add_force(0, std::make_shared<Spring>(Vec3(length, 0, away), spring));
        if (settle(world).failed()) return 1;
        const double tip = world.rod(0).z[0], formula = away * spring / (spring + 3 * bend / std::pow(length, 3));
        std::printf("tip %.4f mm, by formula %.4f mm, energy of the spring %.3g J\n", 1e3 * tip, 1e3 * formula,
                    world.readings(0).force_energy);
        return std::abs(tip / formula - 1) < 1e-3 ? 0 : 1;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

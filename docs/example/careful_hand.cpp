// A hand that feels: pushes a guidewire into a curved vessel, and turns and draws it back a little when it meets too much force.

#include <seldinger/engine.h>

#include <algorithm>
#include <cstdio>
#include <utility>

using namespace seldinger;

namespace {

/// A floppy wire of 0.035 inch, fed at the beginning of a lumen that bends through 90 degrees.
WorldSetup curved_vessel()
{
    WireSetup wire;
    wire.wire.length = 0.2;
    wire.wire.shaft.radius = 0.4445e-3;
    wire.wire.shaft.density = 7900;
    wire.wire.shaft.bend_stiffness = 2e-5;
    wire.wire.shaft.twist_stiffness = 1.5e-5;
    wire.wire.shaft.stretch_stiffness = 1e4;
    wire.feed.on = true;
    wire.feed.point = {0.001, 0, -0.001};

    WorldSetup setup;
    setup.wires.push_back(std::move(wire));
    setup.vessel.shape = VesselShape::Arc;
    setup.vessel.radius = 0.004;
    setup.vessel.bend_radius = 0.03;
    setup.vessel.angle = 1.5708;
    setup.vessel.lead_in = 0.02;
    setup.vessel.lead_out = 0.03;
    setup.vessel.triangles = 8000;
    load_vessel(setup);
    return setup;
}

}  // namespace

int main()
{
    try {
        World world(curved_vessel());
        const double dt = 1e-3, most_force = 0.03;  // [s], [N]
        double advance = 0, turn = 0, highest = 0;
        int drawn_back = 0;
        for (int k = 0; k < 2000; ++k) {
            const bool too_much = world.readings(0).hand_force > most_force;
            drawn_back += too_much;
            advance = std::clamp(advance + (too_much ? -0.05 : 0.05) * dt, 0.0, 0.09);  // [m]
            turn += too_much ? 2.0 * dt : 0.0;                                          // [rad]
            Control control;
            control.move_to(0, advance, turn);
            const StepReport report = step(world, control, dt);
            if (report.failed()) {
                std::fprintf(stderr, "step %d failed (flags %u)\n", k, report.flags);
                return 1;
            }
            highest = std::max(highest, world.readings(0).hand_force);
        }
        const Output now = world.output();
        std::printf("inserted %.1f mm, turned %.2f rad, tip at (%.1f, %.1f, %.1f) mm, %zu contacts\n",
                    1e3 * now.wires[0].readings.inserted, now.wires[0].readings.turned, 1e3 * now.wires[0].tip.x(),
                    1e3 * now.wires[0].tip.y(), 1e3 * now.wires[0].tip.z(), now.contacts.size());
        std::printf("highest force %.1f mN, drawn back in %d of 2000 steps, state %s\n", 1e3 * highest, drawn_back,
                    world.state_hash().c_str());
        return 0;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

// F7 approach speed towards zero in the damped law, F8 friction that chatters or creeps, F15 push, pull, push again.

#include "contact/wall_law.h"
#include "failure/hard_vessels.h"
#include "failure/watched_run.h"
#include "shared/contact_law.h"

#include <limits>

namespace seldinger::test::test_laws {

namespace {

constexpr double radius = 0.4445e-3;

/// A metre of wire laid on the wall without speed, backward Euler at the law itself. @return its depth after `time` [m]
double laid_down(const QuadratureModel& m, double least_approach, double time, double dt)
{
    double d = 0, v = 0, approach = 0;
    for (double t = 0; t < time; t += dt) {
        double next = d + dt * v;
        for (int i = 0; i < 200; ++i) {
            double slope = 0;
            // v- is the speed at which contact began: that of the first step
            const double from = std::max(approach > 0 ? approach : (next - d) / dt, least_approach);
            const double f = next > 0 ? normal_law(next, (next - d) / dt, from, 1 / dt, m, &slope) : 0;
            const double change =
                (m.line_mass * (((next - d) / dt - v) / dt - weight_gravity) + f) / (m.line_mass / dt / dt + slope);
            next -= change;
            if (std::abs(change) <= 1e-15 * radius) break;
        }
        v = (next - d) / dt;
        if (approach == 0 && next > 0) approach = std::max(v, 1e-300);
        d = next;
    }
    return d;
}

Method with_friction(FrictionLaw law)
{
    Method method = standard;
    method.friction = law;
    return method;
}

}  // namespace

TEST_SUITE("failure/laws")
{
    // f = k d^n (1 + (beta / v-) d'): with v- -> 0 the wire hangs in its own damping
    TEST_CASE(
        "property: F7: without a floor of v- a wire laid down without speed hangs above its depth for seconds; with it, it is "
        "down at once")
    {
        WireSection wire = steel_wire(1, 2).shaft;
        for (const NormalLaw law : {NormalLaw::LankaraniNikravesh, NormalLaw::HuntCrossley}) {
            CAPTURE(static_cast<int>(law));
            ContactSpec contact;
            contact.normal = law;
            QuadratureModel m = line_model(wire, contact, VesselSpec{}, INFINITY, 1);
            m.depth_limit = 0;
            const double depth = depth_under(m.line_mass * weight_gravity, m.stiffness, m.exponent);
            // contact begins in a step of 0.1 us, at v- = 0.98 um/s, where 2.6 mm/s are the speed of a fall of the depth itself
            const double bare = laid_down(m, 0, 0.02, 1e-7) / depth, floored = laid_down(m, m.speed_floor, 0.02, 1e-7) / depth;
            MESSAGE("F7: after 20 ms " << bare << " of the static depth without a floor, " << floored
                                       << " with it, v- floored at " << m.speed_floor << " m/s");
            CHECK(bare < 0.9);
            CHECK(floored == about(1).epsilon(1e-3));
        }
    }

    TEST_CASE(
        "property: F8: ten minutes at half the friction cone: sticking sticks, a regularised law creeps half a metre, a sharp "
        "one a micrometre")
    {
        const double angle = std::atan(0.1);  // of mu_sliding 0.2, mu_static 0.25
        const auto creep = [&](const TestSetup& setup, FrictionLaw law) {
            WatchedRun run(setup, with_friction(law), 0.25);
            REQUIRE_FALSE(settle(run.world).failed());
            const double start = run.world.rod(0).x[3];
            run.run(2400);
            const double moved = run.world.rod(0).x[3] - start;
            MESSAGE("F8: moved " << 1e6 * moved << " um in ten minutes; " << tell(run.outcomes()));
            CHECK(run.outcomes().outcome() == Outcome::Hold);
            return moved;
        };
        const TestSetup plane = on_a_slope(2, 5000, -0.8, angle);
        CHECK(std::abs(creep(plane, FrictionLaw::StickSlip)) < 1e-6);
        // |f| = cone |u| / (|u| + u_s): half the cone at u = u_s, 1 mm/s and a millionth of it
        CHECK(creep(plane, FrictionLaw::Smooth) == about(0.6).epsilon(0.01));
        CHECK(creep(plane, FrictionLaw::Sign) == about(0.6e-6).epsilon(0.01));
    }

    TEST_CASE(
        "property: F15: push, pull, push: the default's force returns along its loop and every cycle dissipates; the published "
        "one's does not")
    {
        const PushPull scene;
        const int before = scene.before, cycle = scene.cycle;
        const auto loop_error = [&](const TestSetup& setup, const Method& method) {
            WatchedRun run(setup, method, PushPull::dt);
            std::vector<double> force;
            double work[3] = {}, stored[4] = {}, last = 0, advance = 0;
            int step = 0;
            run.run(before + 3 * cycle, [&](FedWorld& world) {
                const WireReadings now = world.readings(0);
                if (++step > before) {
                    force.push_back(now.hand_force);
                    work[(step - before - 1) / cycle] += 0.5 * (now.hand_force + last) * (now.inserted - advance);
                }
                if (step >= before && (step - before) % cycle == 0)
                    stored[(step - before) / cycle] = now.kinetic + now.elastic + now.gravitational;
                last = now.hand_force;
                advance = now.inserted;
                return true;
            });
            if (run.outcomes().outcome() == Outcome::BlowUp) {  // ended before it was round
                MESSAGE("F15, " << std::string(method.name) << ": " << tell(run.outcomes()));
                return std::numeric_limits<double>::infinity();
            }
            const auto second = force.begin() + cycle, third = second + cycle;
            const auto [low, high] = std::minmax_element(second, third);
            double off = 0;
            for (int k = 0; k < cycle; ++k) off = std::max(off, std::abs(*(third + k) - *(second + k)));
            const double error = off / (*high - *low), lost = work[2] - (stored[3] - stored[2]);
            MESSAGE("F15, " << std::string(method.name) << ": third loop off the second by " << 100 * error << " %, lost in it "
                            << lost << " J; " << tell(run.outcomes()));
            if (method.scheme == Scheme::Newton) {
                CHECK(run.outcomes().outcome() == Outcome::Hold);
                CHECK(lost > 0);
            } else {
                CHECK(run.outcomes().outcome() > Outcome::Overlap);
            }
            return error;
        };
        CHECK(loop_error(scene.setup, standard) < 0.02);
        CHECK(loop_error(scene.setup, published) > 0.1);
        TestSetup soft = scene.setup;  // its wall gives way and comes back
        make_elastic(soft, 0.1e6);
        CHECK(loop_error(soft, standard) < 0.02);
    }
}

}  // namespace seldinger::test::test_laws

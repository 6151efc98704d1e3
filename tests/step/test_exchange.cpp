// Instruments that take each other's place inside another one, in both models: one comes out, another goes in.
#include "core/error.h"
#include "core/parallel.h"
#include "setup/key_frames.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "world/world.h"

#include <cmath>
#include <functional>
#include <vector>

namespace seldinger::test::test_exchange {

using Model = CoaxialSpec::Model;

namespace {

WireSpec instrument(double length, double radius, double lumen, double bend, bool adaptive)
{
    WireSpec spec;
    spec.length = length;
    spec.lumen_radius = lumen;
    spec.nodes = adaptive ? 0 : static_cast<int>(length / 2.5e-3) + 1;
    spec.shaft.radius = radius;
    spec.shaft.density = 6000;
    spec.shaft.bend_stiffness = bend;
    spec.shaft.twist_stiffness = 0.7 * bend;
    spec.shaft.stretch_stiffness = 4 * bend / (radius * radius);
    return spec;
}

/// A catheter with a bent tip, 6 cm in, and two wires for it: one softer than it, one stiffer.
WorldSetup two_wires(Model model, bool adaptive, double friction)
{
    WorldSetup setup;
    const double lengths[] = {0.12, 0.15, 0.15}, bends[] = {2e-4, 5e-5, 5e-4};
    for (int k = 0; k < 3; ++k) {
        WireSetup wire;
        wire.wire = instrument(lengths[k], k == 0 ? 9e-4 : 4.5e-4, k == 0 ? 6e-4 : 0, bends[k], adaptive);
        wire.feed.on = true;
        wire.feed.advance = k == 0 ? 0.06 : 0;
        setup.wires.push_back(wire);
    }
    WireSectionRange tip{0, 0.02, setup.wires[0].wire.shaft};
    tip.section.rest_curvature = {15, 0};
    setup.wires[0].wire.sections = {tip};
    setup.systems = {3};
    setup.integrator.damping_mass = 20;
    CoaxialSpec nest;
    nest.model = model;
    nest.order = {0, 1, 2};
    nest.exchanged = 2;
    nest.mu_static = nest.mu_sliding = friction;
    nest.lumen_friction = model == Model::Merged && friction > 0;
    setup.coaxial = {nest};
    return setup;
}

constexpr double dt = 2e-3, stroke = 0.4;  // [s]
constexpr int steps_of_stroke = 200;

/// In by 9 cm within a stroke, and out again within the next.
void add_visit(std::vector<FeedKey>& keys, double from)
{
    keys.push_back({from, 0, 0});
    keys.push_back({from + stroke, 0.09, 0.5});
    keys.push_back({from + 2 * stroke, 0, 0});
}

/// The first wire in and out, the second, and the first again.
KeyFrames visits()
{
    std::vector<std::vector<FeedKey>> keys{{{0, 0.06, 0}}, {}, {}};
    add_visit(keys[1], 0);
    add_visit(keys[2], 2 * stroke);
    add_visit(keys[1], 4 * stroke);
    return KeyFrames(keys);
}

void run(World& world, const KeyFrames& keys, int steps)
{
    for (int k = 0; k < steps; ++k) REQUIRE_FALSE(step(world, keys.control(), dt).failed());
}

/// Energy that comes from nowhere or goes there, of all instruments, as a share of what hands do [-].
double open_share(const World& world)
{
    double open = 0, work = 0;
    for (int w = 0; w < world.wire_count(); ++w) {
        open += std::abs(world.readings(w).energy.open());
        work += std::abs(world.readings(w).energy.hand);
    }
    return open / work;
}

}  // namespace

TEST_SUITE("step/exchange")
{
    TEST_CASE("property: a wire goes in and out of a catheter, another one, and the first again: energies close")
    {
        const KeyFrames keys = visits();
        for (const Model model : {Model::Separate, Model::Merged})
            for (const bool adaptive : {false, true}) {
                CAPTURE(int(model));
                CAPTURE(adaptive);
                World world(two_wires(model, adaptive, 0.1));
                run(world, keys, steps_of_stroke / 2);
                const Vec3 alone = world.rod(0).pos(0);  // no wire is at its tip yet
                double farthest = 0, friction = 0;
                for (int visit = 0; visit < 3; ++visit) {
                    const int w = 1 + visit % 2;
                    if (visit > 0) run(world, keys, steps_of_stroke / 2);
                    run(world, keys, steps_of_stroke / 2);
                    CHECK(world.readings(w).inserted == about(0.09).epsilon(1e-9));
                    CHECK(world.rod(w).pos(0).x() > world.rod(0).pos(0).x());
                    CHECK(world.readings(3 - w).inserted == 0);
                    farthest = std::max(farthest, (world.rod(0).pos(0) - alone).norm());
                    run(world, keys, steps_of_stroke);
                    // what each wire has lost so far is still known: its balance goes on from visit to visit
                    double sum = 0;
                    for (const int one : {0, 1, 2}) sum += world.readings(one).energy.friction;
                    CHECK(sum > friction);
                    friction = sum;
                    // hubs that start and turn round at once leave what half of their half cell gets from that
                    CHECK(open_share(world) < 2e-3);
                }
                CHECK(farthest > 1e-3);  // the stiff wire straightens the tip
                for (int k = 0; k < 200; ++k) REQUIRE_FALSE(step(world, keys.control(), dt).failed());
                CHECK((world.rod(0).pos(0) - alone).norm() < 1e-3 * farthest + 2e-4);
            }
    }

    TEST_CASE("property: in the midst of an exchange a save and the number of threads change no bit")
    {
        const KeyFrames keys = visits();
        for (const Model model : {Model::Separate, Model::Merged}) {
            std::vector<std::string> hashes;
            for (const int threads : {1, 3}) {
                set_thread_count(threads);
                World world(two_wires(model, true, 0.1)), resumed(two_wires(model, true, 0.1));
                run(world, keys, 2 * steps_of_stroke + 40);  // the second wire has just come in
                resumed.restore_state(world.save_state());
                run(world, keys, steps_of_stroke);
                run(resumed, keys, steps_of_stroke);
                hashes.push_back(world.state_hash());
                hashes.push_back(resumed.state_hash());
            }
            set_thread_count(0);
            for (const std::string& hash : hashes) CHECK(hash == hashes[0]);
        }
    }

    // without friction and at rest nothing tells how it got there
    TEST_CASE("property: after an exchange the second wire lies as if there had never been another one")
    {
        for (const Model model : {Model::Separate, Model::Merged}) {
            const std::vector<std::vector<FeedKey>> only{{{0, 0.06, 0}}, {{0, 0, 0}}, {{0, 0, 0}, {stroke, 0.09, 0}}};
            std::vector<std::vector<FeedKey>> after{{{0, 0.06, 0}}, {}, {{2 * stroke, 0, 0}, {3 * stroke, 0.09, 0}}};
            add_visit(after[1], 0);
            World alone(two_wires(model, false, 0)), exchanged(two_wires(model, false, 0));
            run(alone, KeyFrames(only), 5 * steps_of_stroke);
            run(exchanged, KeyFrames(after), 7 * steps_of_stroke);
            for (const int w : {0, 2}) CHECK((alone.rod(w).pos(0) - exchanged.rod(w).pos(0)).norm() < 2e-5);
            CHECK(alone.readings(2).hand_force == about(exchanged.readings(2).hand_force).epsilon(0.05).scale(1e-3));
        }
    }

    TEST_CASE("error: one is inside at a time, and one instrument at least is around them")
    {
        World world(two_wires(Model::Separate, false, 0));
        Control both;
        both.move_to(1, 0.001, 0).move_to(2, 0.001, 0);
        CHECK(refusal([&] { (void)step(world, both, 1e-3); }) ==
              "control: instrument 2: advance: got 0.001 m; expected 0 while instrument 1 is inside: they take turns in another "
              "one "
              "(exchanged)");
        CHECK(world.step_count() == 0);
        for (const int exchanged : {0, 3}) {
            WorldSetup setup = two_wires(Model::Separate, false, 0);
            setup.coaxial[0].exchanged = exchanged;
            CHECK(refusal([&] { World refused(setup); }).starts_with("coaxial[0].exchanged: got "));
        }
    }
}

}  // namespace seldinger::test::test_exchange

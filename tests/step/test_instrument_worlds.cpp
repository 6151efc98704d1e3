// Worlds whose instruments touch each other: nothing passes, saved states come back, systems are independent.

#include "contact/instrument_fixture.h"
#include "core/parallel.h"
#include "support/world_fixture.h"

#include <cmath>

namespace seldinger::test::test_instrument_worlds {

namespace {

/// A wire shot across another that is held at its ends, or is free.
WorldSetup shot(double speed, bool held, double askew = 0)
{
    WireSetup a = straight_wire(5e-5, 7000, 0.06, 2e-4, 41, 1e9), b = a;
    put(a, {-0.03, 0, 0}, Vec3::UnitX());
    put(b, {1e-3, -0.03, 2e-3}, Vec3(askew, 1, 0).normalized());
    b.wire.place.velocity = {0, 0, -speed};
    if (held) a.holds = {hold_of(WirePoint::Kind::Base, false), hold_of(WirePoint::Kind::Tip, false)};
    a.contact.friction = b.contact.friction = FrictionLaw::StickSlip;
    WorldSetup made = touching({a, b});
    made.integrator.scheme = Scheme::Newton;
    return made;
}

/// Least height of b over a where they cross, seen along z; infinity where they do not.
double height_over(const World& world)
{
    double least = INFINITY;
    const ConstRodView a = world.rod(0), b = world.rod(1);
    for (int i = 0; i + 1 < a.n; ++i)
        for (int j = 0; j + 1 < b.n; ++j) {
            const Vec3 p = a.pos(i), u = a.pos(i + 1) - p, q = b.pos(j), v = b.pos(j + 1) - q;
            const double det = u.x() * -v.y() + v.x() * u.y();
            if (det == 0) continue;
            const Vec3 d = q - p;
            const double s = (d.x() * -v.y() + v.x() * d.y()) / det, t = (u.x() * d.y() - u.y() * d.x()) / det;
            if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min(least, q.z() + t * v.z() - p.z() - s * u.z());
        }
    return least;
}

/// A catheter and a wire fed through one inlet into a tube that bends, nodes that come and go.
TestSetup over_the_wire()
{
    TestSetup made = in_bend(0.005, 0.04, 3000);
    WireSpec catheter = steel_wire(0.12, 0), wire = steel_wire(0.14, 0);
    catheter.shaft.radius = 0.9e-3;
    catheter.lumen_radius = 0.55e-3;
    catheter.shaft.bend_stiffness = 3e-5;
    catheter.shaft.density = 1500;
    catheter.shaft.youngs = 1e8;
    const auto points = made.centreline.main_points();
    made.wires = {fed_wire(catheter, points.front(), 0), fed_wire(wire, points.front(), 0)};
    made.wires[0].feed.keys = {{0, 0.02, 0}, {1, 0.04, 0.5}};
    made.wires[1].feed.keys = {{0, 0.022, 0}, {0.5, 0.06, 0}, {1, 0.05, 1}};
    for (TestWire& one : made.wires) one.feed.direction = (points[1] - points[0]).normalized();
    made.systems = {2};
    return made;
}

struct Fed {
    explicit Fed(const TestSetup& from, int copies = 1) : keys(all_keys(from, copies)), world(setup_of(from, copies)) {}
    static WorldSetup setup_of(const TestSetup& from, int copies)
    {
        TestSetup many = from;
        for (int k = 1; k < copies; ++k) {
            many.wires.insert(many.wires.end(), from.wires.begin(), from.wires.end());
            many.systems.push_back(2);
        }
        WorldSetup made = many;
        for (int k = 0; k < copies; ++k) {
            CoaxialSpec nest;
            nest.model = CoaxialSpec::Model::Separate;
            nest.order = {2 * k, 2 * k + 1};
            made.coaxial.push_back(nest);
        }
        made.instruments_touch = true;
        return made;
    }
    static std::vector<std::vector<FeedKey>> all_keys(const TestSetup& from, int copies)
    {
        std::vector<std::vector<FeedKey>> all;
        for (int k = 0; k < copies; ++k)
            for (const auto& one : from.keys()) all.push_back(one);
        return all;
    }
    void run(int steps)
    {
        for (int k = 0; k < steps; ++k) REQUIRE_FALSE(step(world, keys.control(), 2e-3).failed());
    }
    KeyFrames keys;
    World world;
};

}  // namespace

TEST_SUITE("step/instrument_worlds")
{
    TEST_CASE("property: a wire shot at another does not pass it")
    {
        for (const double speed : {0.5, 5.0, 20.0})
            for (const bool held : {true, false}) {
                CAPTURE(speed);
                CAPTURE(held);
                World world(shot(speed, held, 0.3));
                const double until = 6e-3 / speed, dt = until / 12;
                bool touched = false;
                for (int k = 0; k < 12; ++k) {
                    REQUIRE_FALSE(step(world, dt).failed());
                    touched = touched || world.readings(0).contacts > 0;
                    CHECK(height_over(world) > 2.5e-4);  // sunk by half a radius at most; corners of the polygons cut some
                    for (int w = 0; w < 2; ++w) CHECK(world.readings(w).overlap <= 1e-4);
                }
                CHECK(touched);
            }
        WorldSetup apart = shot(5, true, 0.3);  // that this is looked at where it happens
        apart.instruments_touch = false;
        World world(apart);
        for (int k = 0; k < 12; ++k) REQUIRE_FALSE(step(world, 1e-4).failed());
        CHECK(height_over(world) < 0);
    }

    TEST_CASE("property: momentum of two free wires that meet stays, and the ledger of energy closes")
    {
        World world(shot(2, false, 0.2));
        const auto momentum_of_all = [&] {
            Vec3 sum = Vec3::Zero();
            for (int w = 0; w < 2; ++w)
                for (int i = 0; i < world.rod(w).n; ++i) sum += world.rod(w).mass[i] * world.rod(w).vel(i);
            return sum;
        };
        const Vec3 before = momentum_of_all();
        double contact = 0;
        for (int k = 0; k < 30; ++k) {
            REQUIRE_FALSE(step(world, 2e-4).failed());
            contact = std::max(contact, world.readings(0).normal);
        }
        REQUIRE(contact > 1e-3);
        // the solver's tolerance, a millionth of the force scale (newtons) in each of 82 nodes, over 6 ms
        CHECK((momentum_of_all() - before).norm() < 1e-6 * before.norm());
        const EnergyLedger a = world.readings(0).energy, b = world.readings(1).energy;
        const double moved = std::abs(b.wire);
        REQUIRE(moved > 1e-6);
        CHECK(std::abs(a.open()) < 1e-3 * moved);
        CHECK(std::abs(b.open()) < 1e-3 * moved);
        CHECK(std::abs(a.wall + b.wall) < 1e-12 * std::abs(a.wall));  // what one gives the other takes
        CHECK(a.contact + b.contact > 0);
        CHECK(a.friction + b.friction > 0);
    }

    TEST_CASE("property: a catheter fed over a wire; saved and restored it goes on with the same bits")
    {
        for (const bool adaptive : {false, true}) {  // nodes that come and go let a search of one step serve the next, or not
            CAPTURE(adaptive);
            TestSetup setup = over_the_wire();
            for (TestWire& wire : setup.wires)
                if (adaptive) wire.wire.nodes = 0;
            Fed first(setup);
            first.run(150);
            REQUIRE(first.world.readings(0).contacts > 0);
            const std::vector<std::uint8_t> saved = first.world.save_state();
            first.run(60);
            Fed second(setup);
            second.world.restore_state(saved);
            CHECK(second.world.step_count() == 150);
            second.run(60);
            CHECK(second.world.state_hash() == first.world.state_hash());
            CHECK(first.world.state_hash(0) == first.world.state_hash());
            CHECK(first.world.readings(1).inserted > 0.02);
            bool rods = false;
            for (const ContactRow& row : first.world.contacts()) rods = rods || row.b.kind == BodyKind::Rod;
            CHECK(rods);
        }
    }

    TEST_CASE("property: one system goes back, the other goes on")
    {
        Fed two(over_the_wire(), 2);
        two.run(80);
        const std::vector<std::uint8_t> saved = two.world.save_state(1);
        const std::string then = two.world.state_hash(1);
        two.run(30);
        const std::string other = two.world.state_hash(0);
        CHECK(two.world.state_hash(1) != then);
        two.world.restore_state(1, saved);
        CHECK(two.world.state_hash(0) == other);
        CHECK(two.world.save_state(1) == saved);
    }

    TEST_CASE("property: the same bits on one thread and on many, and whoever else is in the world")
    {
        std::string alone;
        for (const int threads : {1, 4}) {
            set_thread_count(threads);
            Fed one(over_the_wire());
            one.run(120);
            if (alone.empty()) alone = one.world.state_hash(0);
            CHECK(one.world.state_hash(0) == alone);
            Fed three(over_the_wire(), 3);
            three.run(120);
            for (int s = 0; s < 3; ++s) CHECK(three.world.state_hash(s) == alone);
        }
        set_thread_count(0);
    }

    // If one of two systems moves far in a step, it is searched again in late trials, when the other is done with the step.
    TEST_CASE("property: a wire that is shot does not change the bits of a system that touches and has converged")
    {
        const auto calm = [] { return shot(0.5, true, 0.3); };
        const double dt = 1e-4;  // 50 um at 0.5 m/s, 2 mm at 20: half of the skin is 100 um
        World alone(calm());
        WorldSetup both = calm(), wild = shot(20, false, 0.3);
        both.wires.insert(both.wires.end(), wild.wires.begin(), wild.wires.end());
        both.systems = {2, 2};
        World together(both);
        int touching_steps = 0;
        for (int k = 0; k < 60; ++k) {
            REQUIRE_FALSE(step(alone, dt).failed());
            REQUIRE_FALSE(step(together, dt).failed());
            touching_steps += alone.readings(0).contacts > 0;
            REQUIRE(together.state_hash(0) == alone.state_hash(0));
        }
        CHECK(touching_steps > 5);
    }

    TEST_CASE("property: a system that is retired is left alone, and the others go on")
    {
        Fed two(over_the_wire(), 2);
        two.run(60);
        two.world.retire(0);
        const double tip = two.world.rod(1).x[0];
        two.run(60);
        CHECK(two.world.rod(1).x[0] == tip);
        Fed one(over_the_wire());
        one.run(120);
        CHECK(two.world.state_hash(1) == one.world.state_hash(0));
    }

    TEST_CASE("property: two wires pushed into one tube lie beside each other, not in each other")
    {
        TestSetup made = in_tube(0.0025, 0.2, 4000);
        WireSpec wire = steel_wire(0.1, 51);
        wire.shaft.radius = 6e-4;
        made.wires = {fed_wire(wire, {5e-4, 8e-4, -5e-4}, 0.1), fed_wire(wire, {5e-4, -8e-4, -5e-4}, 0.09)};
        made.systems = {2};
        WorldSetup setup = made;
        setup.instruments_touch = true;
        World world(setup);
        KeyFrames keys(made.keys());
        double deepest = 0, most = 0;
        for (int k = 0; k < 500; ++k) {
            REQUIRE_FALSE(step(world, keys.control(), 1e-3).failed());
            if (k % 20) continue;
            for (const ContactRow& row : world.contacts()) {
                if (row.b.kind != BodyKind::Rod) continue;
                deepest = std::max(deepest, -row.gap);
                most = std::max(most, row.normal_force);
            }
        }
        CHECK(most > 1e-5);
        CHECK(deepest < 0.02 * 6e-4);
        // from the first 5 mm on, where the inlets hold them apart
        for (int i = 0; i + 6 < world.rod(0).n; ++i)
            for (int j = 0; j + 6 < world.rod(1).n; ++j)
                CHECK((world.rod(0).pos(i) - world.rod(1).pos(j)).norm() > 2 * 6e-4 * 0.98);
    }
}

}  // namespace seldinger::test::test_instrument_worlds

// engine/physics/world/world.cpp: wires of one world are independent, and a saved state continues with the same bits.

#include "support/world_fixture.h"

#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <cstring>
#include <memory>

namespace seldinger::test::test_worlds {

namespace {

// three wires of different lengths, sections and feeds; the vessel is empty
TestSetup three_wires(Detection detection)
{
    TestSetup setup = in_bend(0.003, 0.05);
    for (int w = 0; w < 3; ++w) {
        WireSpec spec = steel_wire(0.06 + 0.02 * w, 21 + 7 * w);
        spec.shaft.bend_stiffness *= 1 + w;
        TestWire wire =
            w < 2 ? fed_wire(spec, {0.0005, 3e-4 * w, -0.0024}, 0.2 + 0.1 * w, 2.0 * w) : placed_wire(spec, Vec3::Zero());
        if (w == 2) {  // lies along the whole bend, and springs against its outer wall
            wire.wire.place.shape = PlaceShape::Centreline;
            wire.wire.place.from = 0.002;
            // pressed against the wall the published layer halves every step; free of it, some
            wire.wire.place.rest_is_placed = detection == Detection::Layer;
            wire.wire.place.velocity = {0.05, 0.02, 0};
        }
        wire.contact.detection = detection;
        wire.contact.rolling = w == 1;
        if (w == 0) wire.wire.shaft.radius = 0.3e-3;  // the thinnest: what contact is searched with must not reach the others
        setup.wires.push_back(wire);
    }
    return setup;
}

std::vector<double> state_of(FedWorld& world, int wire)
{
    std::vector<double> all;
    for (const std::span<double>& array : data_of(world).state.rods.arrays(wire))
        all.insert(all.end(), array.begin(), array.end());
    return all;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b)
{
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// the published layer may fail to converge; which wires it fails for must not matter to the others either
void run(FedWorld& world, int steps)
{
    for (int k = 0; k < steps; ++k) {
        const bool failed = step(world, 1e-3).failed();
        if (world.setup().wires[0].contact.detection != Detection::Layer) REQUIRE_FALSE(failed);
    }
}

}  // namespace

TEST_SUITE("step/worlds")
{
    TEST_CASE("property: three wires of one world give the bits that each gives alone")
    {
        for (const Detection detection : {Detection::Swept, Detection::Layer, Detection::Nodes}) {
            CAPTURE(static_cast<int>(detection));
            const int steps = detection == Detection::Layer ? 110 : 250;  // its half steps take long
            FedWorld together(three_wires(detection));
            run(together, steps);
            int contacts = 0;
            for (int w = 0; w < 3; ++w) {
                CAPTURE(w);
                TestSetup setup = three_wires(detection);
                setup.wires = {setup.wires[w]};
                FedWorld alone(std::move(setup));
                run(alone, steps);
                CHECK(same_bits(state_of(alone, 0), state_of(together, w)));
                std::vector<ContactRow> rows;
                for (const ContactRow& row : together.contacts())
                    if (row.a.body == w) rows.push_back(row);
                const std::vector<ContactRow>& own = alone.contacts();
                REQUIRE(rows.size() == own.size());
                contacts += static_cast<int>(rows.size());
                for (std::size_t k = 0; k < rows.size(); ++k) {
                    CHECK(rows[k].a.element == own[k].a.element);
                    CHECK(rows[k].b.element == own[k].b.element);
                    CHECK(rows[k].normal_force == own[k].normal_force);
                    CHECK(rows[k].friction == own[k].friction);
                    CHECK(rows[k].point == own[k].point);
                }
                CHECK(alone.readings(0).hand_force == together.readings(w).hand_force);
            }
            if (detection == Detection::Swept) REQUIRE(contacts > 20);
        }
    }

    TEST_CASE(
        "property: wires that converge after different numbers of iterations give the bits that each gives alone, at 1/60 s")
    {
        const auto five = [] {
            TestSetup setup = in_bend(0.003, 0.05);
            for (int w = 0; w < 5; ++w) {
                WireSpec spec = steel_wire(0.08, 25);
                spec.shaft.bend_stiffness *= 0.2 * (1 + w);
                setup.wires.push_back(fed_wire(spec, {0.0005, 1e-4 * w, -0.0024 + 2e-4 * w}, 0.03 + 0.01 * w));
            }
            return setup;
        };
        FedWorld together(five());
        std::vector<std::unique_ptr<FedWorld>> alone;
        for (int w = 0; w < 5; ++w) {
            TestSetup setup = five();
            setup.wires = {setup.wires[w]};
            alone.push_back(std::make_unique<FedWorld>(std::move(setup)));
        }
        int mixed = 0, contacts = 0;  // steps in which some wires were done before others
        for (int k = 0; k < 60; ++k) {
            REQUIRE_FALSE(step(together, 1.0 / 60).failed());
            int least = 1000, most = 0;
            for (int w = 0; w < 5; ++w) {
                REQUIRE_FALSE(step(*alone[w], 1.0 / 60).failed());
                least = std::min(least, together.report(w).newton_iterations);
                most = std::max(most, together.report(w).newton_iterations);
                CHECK(together.readings(w).normal == alone[w]->readings(0).normal);
                CHECK(together.readings(w).contacts == alone[w]->readings(0).contacts);
                contacts += together.readings(w).contacts;
            }
            mixed += most > least;
        }
        for (int w = 0; w < 5; ++w) CHECK(together.state_hash(w) == alone[w]->state_hash());
        REQUIRE(mixed > 10);
        REQUIRE(contacts > 100);
    }

    TEST_CASE("property: twenty wires give the same bits on one thread and on several, and each its own hash")
    {
        const auto twenty = [] {
            TestSetup setup = in_tube(0.003, 0.12);
            for (int w = 0; w < 20; ++w) {
                WireSpec spec = steel_wire(0.1, 41);
                spec.shaft.bend_stiffness *= 1 + 0.1 * w;
                setup.wires.push_back(fed_wire(spec, {0.0005, 0, -0.0025}, 0.1 + 0.005 * w));
            }
            return setup;
        };
        std::vector<std::string> hashes;
        for (const int threads : {1, 2, 5}) {
            set_thread_count(threads);
            REQUIRE(thread_count() == threads);
            FedWorld world(twenty());
            run(world, 120);
            REQUIRE(world.readings(19).contacts > 0);
            hashes.push_back(world.state_hash());
            if (threads > 1) continue;
            for (const int w : {0, 7, 19}) {
                TestSetup alone = twenty();
                alone.wires = {alone.wires[w]};
                FedWorld own(std::move(alone));
                run(own, 120);
                CHECK(world.state_hash(w) == own.state_hash());
                CHECK(world.state_hash(w) == own.state_hash(0));
            }
        }
        set_thread_count(0);
        CHECK(hashes[1] == hashes[0]);
        CHECK(hashes[2] == hashes[0]);
    }

    TEST_CASE("property: a retired wire stays as it is, contacts included, and the others go on as before")
    {
        for (const Detection detection : {Detection::Swept, Detection::Layer}) {
            CAPTURE(static_cast<int>(detection));
            FedWorld all(three_wires(detection)), fewer(three_wires(detection));
            run(all, 60);
            run(fewer, 60);
            fewer.retire(2);
            const std::vector<double> then = state_of(fewer, 2);
            const auto rows_of = [](const World& world, int wire) {
                const std::vector<ContactRow>& rows = world.contacts();
                return std::count_if(rows.begin(), rows.end(), [&](const ContactRow& row) { return row.a.body == wire; });
            };
            const auto contacts_then = rows_of(fewer, 2);
            run(all, 30);
            run(fewer, 30);
            CHECK(same_bits(state_of(fewer, 2), then));
            CHECK(rows_of(fewer, 2) == contacts_then);
            if (detection == Detection::Swept) REQUIRE(contacts_then > 0);
            for (const int w : {0, 1}) CHECK(all.state_hash(w) == fewer.state_hash(w));
        }
    }

    TEST_CASE("property: a state restored at any step ends with the same hash, in the same world and in a new one")
    {
        for (const Detection detection : {Detection::Swept, Detection::Layer}) {
            for (const int at : {1, 47}) {
                CAPTURE(static_cast<int>(detection));
                CAPTURE(at);
                FedWorld world(three_wires(detection));
                run(world, at);
                const std::vector<std::uint8_t> saved = world.save_state();
                const std::string then = world.state_hash();
                run(world, 60);
                const std::string hash = world.state_hash();
                REQUIRE(hash != then);
                world.restore_state(saved);
                CHECK(world.state_hash() == then);
                CHECK(world.step_count() == at);
                run(world, 60);
                CHECK(world.state_hash() == hash);
                FedWorld other(three_wires(detection));
                other.restore_state(saved);
                run(other, 60);
                CHECK(other.state_hash() == hash);
            }
        }
    }

    TEST_CASE("property: a state of another scene, or cut short, is refused")
    {
        FedWorld world(three_wires(Detection::Swept));
        run(world, 5);
        std::vector<std::uint8_t> bytes = world.save_state();
        bytes.pop_back();
        CHECK_THROWS_AS(World(three_wires(Detection::Swept)).restore_state(bytes), Error);
        bytes.resize(bytes.size() + 2);
        CHECK_THROWS_AS(World(three_wires(Detection::Swept)).restore_state(bytes), Error);
        TestSetup setup = three_wires(Detection::Swept);
        setup.wires.pop_back();
        CHECK_THROWS_AS(World(std::move(setup)).restore_state(world.save_state()), Error);
    }

    TEST_CASE("failure: a straight wire placed along a bend settles against the wall, whatever springs it back")
    {
        for (const double stiffer : {1.0, 0.1, 10.0}) {
            CAPTURE(stiffer);
            TestSetup setup = in_bend(0.006, 0.04);
            WireSpec spec = steel_wire(0.08, 25);
            spec.shaft.bend_stiffness *= stiffer;
            TestWire wire = placed_wire(spec, Vec3::Zero());
            wire.wire.place.shape = PlaceShape::Centreline;
            wire.wire.place.from = 0.002;
            HoldSpec hold;
            hold.position = hold.direction = hold.spin = true;
            wire.holds = {hold};
            setup.wires = {wire};
            setup.start_settled = true;
            FedWorld world(std::move(setup));
            REQUIRE_FALSE(settle(world).failed());
            const WireReadings& at_rest = world.readings(0);
            CHECK(at_rest.contacts > 0);
            CHECK(at_rest.outside == 0);
            // and it is at rest: a step on, nothing moves faster than weight takes to pass a micron in a step
            for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
            CHECK(world.readings(0).kinetic < 1e-3 * at_rest.elastic);
        }
    }

    TEST_CASE(
        "failure: a linearised step that may not go all the way takes half steps, and a moved base is where it was told to be")
    {
        TestSetup setup = in_bend(0.006, 0.04);
        TestWire wire = placed_wire(steel_wire(0.05, 25), Vec3::Zero());
        wire.wire.place.shape = PlaceShape::Centreline;
        wire.wire.place.from = 0.002;
        wire.wire.place.rest_is_placed = true;
        HoldSpec hold;
        hold.position = hold.direction = hold.spin = true;
        hold.move = {{0, 0, 0, 0}, {0.5, 0.01, 0, 0}};  // a third of a millimetre in 1/60 s; `swept` lets no update move 0.2 mm
        wire.holds = {hold};
        wire.contact.detection = Detection::Swept;
        setup.wires = {wire};
        setup.integrator.scheme = Scheme::Linearised;
        FedWorld world(std::move(setup));
        const RodView rod = data_of(world).rod(0);
        const Vec3 base = rod.pos(rod.n - 1);
        int halved = 0;
        for (int k = 1; k <= 30; ++k) {
            const StepReport report = step(world, 1.0 / 60);
            REQUIRE_FALSE(report.failed());
            halved += (report.flags & StepHalved) != 0;
            const Vec3 moved = data_of(world).rod(0).pos(rod.n - 1) - base;
            CHECK((moved - Vec3(0.02 * k / 60.0, 0, 0)).norm() <= 1e-12);
        }
        CHECK(halved > 0);
    }

    TEST_CASE("property: one system goes back to what it was, and the others go on")
    {
        for (const Detection detection : {Detection::Swept, Detection::Layer, Detection::Nodes}) {
            CAPTURE(static_cast<int>(detection));
            FedWorld world(three_wires(detection));
            run(world, 60);
            const std::vector<std::uint8_t> saved = world.save_state(1);
            const double then = world.time(1);
            run(world, 40);
            const std::vector<double> after = state_of(world, 1), first = state_of(world, 0), last = state_of(world, 2);
            world.restore_state(1, saved);
            CHECK(world.time(1) == then);
            CHECK(world.save_state(1) == saved);
            CHECK(same_bits(state_of(world, 0), first));
            CHECK(same_bits(state_of(world, 2), last));
            run(world, 40);  // the others 40 steps farther
            CHECK(same_bits(state_of(world, 1), after));
            CHECK_FALSE(same_bits(state_of(world, 0), first));
        }
    }

    TEST_CASE("regression: the state of another system is refused, and nothing has changed")
    {
        FedWorld world(three_wires(Detection::Swept));
        run(world, 5);
        const std::string before = world.state_hash();
        CHECK_THROWS_AS(world.restore_state(0, world.save_state(2)), Error);
        std::vector<std::uint8_t> longer = world.save_state(0);
        longer.push_back(0);
        CHECK_THROWS_AS(world.restore_state(0, longer), Error);
        CHECK(world.state_hash() == before);
    }
}

}  // namespace seldinger::test::test_worlds

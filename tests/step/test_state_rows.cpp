// What of a world must survive a step: put back after an attempt, refused where another version has laid it out.
#include "engine.h"
#include "world/merged.h"
#include "world/world.h"

#include <doctest/doctest.h>

namespace seldinger::test::test_state_rows {

namespace {

/// After some steps of a pair that shares a centreline, or of two rods of their own.
World pushed_pair(const char* model)
{
    LoadedScene scene = load_scene(std::string(SEL_SOURCE_DIR) + "/assets/scenes/catheter-over-wire.toml",
                                   {std::string("coaxial.model=") + model});
    World world(scene.setup);
    Control control;
    for (int w = 0; w < world.wire_count(); ++w) control.follow(w, scene.keys[w]);
    for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, control, scene.dt).failed());
    return world;
}

}  // namespace

TEST_SUITE("step/state rows")
{
    TEST_CASE(
        "property: a wire that is put back after an attempt is what it was, bit for bit, but for what the attempt has learnt")
    {
        for (const char* model : {"merged", "separate"}) {
            CAPTURE(model);
            World world = pushed_pair(model);
            WorldData& data = data_of(world);
            const std::vector<std::uint8_t> before = world.save_state();
            const std::vector<WireState> wires_before = data.state.wires;
            for (int w = 0; w < world.wire_count(); ++w) keep_wire(data, w);
            for (int w = 0; w < world.wire_count(); ++w) {
                for (const std::span<double>& array : data.state.rods.arrays(w))
                    for (double& value : array) value += 1;
                data.state.rods.set_node_count(w, data.state.rods.node_count(w) + 1);
                data.state.wires[w].time += 1;
                data.state.wires[w].remesh_energy += 1;
                FeedState& feed = data.feed(w);
                for (double* value : {&feed.advance, &feed.turn, &feed.surplus, &feed.surplus_rate, &feed.speed, &feed.grown})
                    *value += 1;
                feed.inside = 0;
                data.solver->spin_record(w).wait = 3;
            }
            for (const auto& group : data.groups.list)
                group->leader = 1 - group->leader, group->feed.advance += 1, group->feed.speed += 1;
            CHECK(world.save_state() != before);
            for (int w = 0; w < world.wire_count(); ++w) put_back_wire(data, w);
            CHECK(data.solver->spin_record(0).wait == 3);
            for (int w = 0; w < world.wire_count(); ++w) {
                data.solver->spin_record(w).wait = 0;
                CHECK(data.feed(w).speed == wires_before[w].feed.speed);
                CHECK(data.feed(w).grown == wires_before[w].feed.grown);
            }
            CHECK(world.save_state() == before);
        }
    }

    TEST_CASE("bad input: a state that another version has laid out in another way is refused, and the world stays what it was")
    {
        World world = pushed_pair("merged");
        const std::vector<std::uint8_t> good = world.save_state(), own = world.save_state(0);
        std::vector<std::uint8_t> other = good, headless(good.begin() + 8, good.end()), system = own;
        other[0] ^= 1;
        system[7] ^= 1;
        CHECK_THROWS_WITH_AS(world.restore_state(other), doctest::Contains("another version"), Error);
        CHECK_THROWS_WITH_AS(world.restore_state(headless), doctest::Contains("another version"),
                             Error);  // as before there was a number
        CHECK_THROWS_WITH_AS(world.restore_state(0, system), doctest::Contains("another version"), Error);
        CHECK(world.save_state() == good);
        CHECK_NOTHROW(world.restore_state(0, own));
        CHECK(world.save_state() == good);
    }
}

}  // namespace seldinger::test::test_state_rows

// The step loop, once warm, asks for no memory, makes no buffer and builds no program: counted.

#include "support/count_allocations.h"
#include "support/skip.h"
#include "support/world_fixture.h"

#include <Eigen/Core>

#include <algorithm>

namespace seldinger::test::test_no_allocation {

namespace {

struct Counts {
    long allocations = 0, most = 0;  // of all steps; of one
    int steps_with_some = 0, steps = 0, contacts = 0, iterations = 0, nodes_begin = 0, nodes_end = 0;
    DeviceCounts device;
};

Counts count_steps(FedWorld& world, int warm, int steps, double dt = 1e-3)
{
    for (int k = 0; k < warm; ++k) REQUIRE_FALSE(step(world, dt).failed());
    Counts counts;
    counts.steps = steps;
    counts.nodes_begin = world.readings(0).nodes;
    const DeviceCounts before = world.device_counts();
    for (int k = 0; k < steps; ++k) {
        const long start = allocations();
        const StepReport report = step(world, dt);
        const long made = allocations() - start;
        REQUIRE_FALSE(report.failed());
        counts.allocations += made;
        counts.most = std::max(counts.most, made);
        counts.steps_with_some += made > 0;
        counts.iterations += report.newton_iterations;
    }
    const DeviceCounts after = world.device_counts();
    counts.device = {after.launches - before.launches, after.reads - before.reads, after.writes - before.writes,
                     after.buffers_created - before.buffers_created, after.programs_built - before.programs_built};
    counts.contacts = world.readings(0).contacts;
    counts.nodes_end = world.readings(0).nodes;
    MESSAGE(counts.allocations << " allocations in " << counts.steps_with_some << " of " << steps << " steps, at most "
                               << counts.most << "; per step " << double(counts.device.launches) / steps << " launches, "
                               << double(counts.device.reads) / steps << " read-backs, " << double(counts.device.writes) / steps
                               << " writes at " << double(counts.iterations) / steps << " iterations; nodes "
                               << counts.nodes_begin << " to " << counts.nodes_end);
    return counts;
}

TestSetup in_a_tube(int wires, int nodes)
{
    TestSetup setup = in_tube(0.003, 0.12);
    for (int w = 0; w < wires; ++w) setup.wires.push_back(fed_wire(steel_wire(0.1, nodes), {0.0005, 1e-4 * w, -0.0025}, 0.1, 2));
    return setup;
}

/// Keeps the compiler from leaving out what nobody looks at.
void keep(const void* what) { asm volatile("" : : "g"(what) : "memory"); }

}  // namespace

TEST_SUITE("step/no_allocation")
{
    TEST_CASE("property: the counter counts new, vectors and Eigen's matrices, and not what is on the stack")
    {
        if (!allocations_are_counted()) return skip("allocations are not counted under a sanitizer");
        const long start = allocations();
        int* one = new int(3);
        keep(one);
        const long with_new = allocations();
        delete one;
        std::vector<double> some(100);
        keep(some.data());
        const long with_vector = allocations();
        Eigen::VectorXd more = Eigen::VectorXd::Zero(100);
        keep(more.data());
        const long with_matrix = allocations();
        Eigen::Vector3d none = more.head<3>();
        keep(none.data());
        const long with_small = allocations();
        CHECK(with_new == start + 1);  // compared at the end: a check allocates too
        CHECK(with_vector == start + 2);
        CHECK(with_matrix == start + 3);
        CHECK(with_small == start + 3);
    }

    TEST_CASE("property: steps with contact, friction and feed allocate nothing, make no buffer, build nothing")
    {
        if (!allocations_are_counted()) return skip("allocations are not counted under a sanitizer");
        for (const int wires : {1, 12}) {  // below and beyond what one thread takes by itself
            CAPTURE(wires);
            FedWorld world(in_a_tube(wires, 41));
            const Counts counts = count_steps(world, 150, 300);
            REQUIRE(counts.contacts > 10);
            REQUIRE(counts.nodes_end > counts.nodes_begin);  // edges were split at the hub meanwhile
            CHECK(counts.allocations == 0);
            CHECK(counts.device.buffers_created == 0);
            CHECK(counts.device.programs_built == 0);
        }
    }

    TEST_CASE("property: changing the nodes where the wire bends allocates nothing either")
    {
        if (!allocations_are_counted()) return skip("allocations are not counted under a sanitizer");
        TestSetup setup = in_bend(0.004, 0.03);
        WireSpec wire = steel_wire(0.12, 0);
        wire.min_edge = 0.001;
        wire.max_edge = 0.008;
        setup.wires = {fed_wire(wire, {0.0005, 0, 0}, 0.15)};
        FedWorld world(std::move(setup));
        const Counts counts = count_steps(world, 250, 200);
        REQUIRE(counts.contacts > 3);
        REQUIRE(counts.nodes_end != counts.nodes_begin);
        CHECK(counts.allocations == 0);
        CHECK(counts.device.buffers_created == 0);
    }
}

}  // namespace seldinger::test::test_no_allocation

// Who leads a common centreline: a step is cut where another instrument gets ahead.

#include "coaxial/merged_fixture.h"
#include "control.h"
#include "stages/step_stages.h"
#include "world/merged.h"
#include "world/sub_steps.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace seldinger::test::test_merged_lead {

namespace {

/// A catheter that is pushed and a wire that is drawn back: after `crossing` of a step of dt their tips are at one place.
struct Crossing {
    static constexpr double dt = 0.02, pushed = 0.05, drawn = 0.11;  // [s], [m/s]
    std::vector<FeedKey> catheter, wire;
    WorldSetup setup;
    explicit Crossing(double crossing, double curvature = 0)
    {
        const double tip = 0.06, before = crossing * dt;
        catheter = {{0, tip - pushed * before, 0}, {1, tip + pushed * (1 - before), 0}};
        wire = {{0, tip + drawn * before, 0}, {0.3, tip - drawn * (0.3 - before), 0}};
        setup = merged_setup({instrument_of(0.2, 2e-4, 1.5e-4, 0.03, curvature), instrument_of(0.2, 1e-4, 7.7e-5, 0.02, 0)},
                             {catheter[0].advance, wire[0].advance}, 2e-3, Scheme::Newton);
    }
    [[nodiscard]] Control control() const
    {
        Control control;
        control.follow(0, catheter);
        control.follow(1, wire);
        return control;
    }
};

}  // namespace

TEST_SUITE("coaxial/merged lead")
{
    TEST_CASE("analytic: the step is cut where the ways of both hubs cross, and nowhere else")
    {
        for (const double crossing : {0.004, 0.3, 0.7, 0.996, 1.2}) {
            CAPTURE(crossing);
            const Crossing made(crossing);
            World world(made.setup);
            WorldData& data = data_of(world);
            take_control(data, made.control(), Crossing::dt);
            const double after = lead_change_after(data, *data.groups.list.front(), Crossing::dt);
            // within 1 % of either end the gained length may be put before the tip; the cut is where the catheter is ahead by
            // 1e-6 of an edge
            const double late = 1e-6 * 2e-3 / (Crossing::pushed + Crossing::drawn);
            if (crossing > 0.99) CHECK(after == 0);
            else if (crossing < 0.01) CHECK(after == about(0.01 * Crossing::dt).epsilon(1e-12));
            else CHECK(after == about(crossing * Crossing::dt + late).epsilon(1e-7));
        }
    }

    TEST_CASE("property: a cut step is made of sub-steps that add up to it, none longer than without the cut")
    {
        for (const StepParts parts : {StepParts{1, 0}, {1, 0.3}, {4, 0.3}, {4, 1e-9}, {3, 0.999}}) {
            CAPTURE(parts.count);
            CAPTURE(parts.cut);
            SubSteps steps;
            const std::array<StepParts, 3> all = {parts, StepParts{}, parts};
            steps.begin(1, WireMask(3, 1), all);
            double whole = 0, cut_at = 0;
            while (const SubStep* sub = steps.next()) {
                CHECK(sub->wires[0] == sub->wires[2]);
                if (!sub->wires[0]) continue;
                CHECK(sub->h <= 1.0 / parts.count * (1 + 1e-12));
                CHECK((sub->after == SubStep::After::Nothing) == (whole == 0));
                whole += sub->h;
                if (std::abs(whole - parts.cut) < 1e-12) cut_at = whole;
            }
            CHECK(whole == about(1.0).epsilon(1e-12));
            if (parts.cut > 0) CHECK(cut_at == about(parts.cut).epsilon(1e-12));
        }
    }

    TEST_CASE("property: of two groups in one system the one whose leader changes first cuts the step")
    {
        for (const auto& [a, b] : {std::pair(0.4, 1.2), {1.2, 0.4}, {0.3, 0.7}, {0.7, 0.3}, {1.2, 1.3}}) {
            CAPTURE(a);
            const Crossing first(a), second(b);
            WorldSetup setup = first.setup;
            for (const WireSetup& wire : second.setup.wires) setup.wires.push_back(wire);
            setup.coaxial.push_back(second.setup.coaxial[0]);
            setup.coaxial[1].order = {2, 3};
            setup.systems = {4};
            World world(setup);
            WorldData& data = data_of(world);
            Control control = first.control();
            control.follow(2, second.catheter);
            control.follow(3, second.wire);
            take_control(data, control, Crossing::dt);
            StepReport report;
            const double cut = a > 1 && b > 1 ? 0 : lead_change_after(data, *data.groups.list[a < b ? 0 : 1], Crossing::dt);
            CHECK((cut > 0) == (std::min(a, b) < 1));
            for (const StepParts& parts : feed_parts(data, Crossing::dt, report)) CHECK(parts.cut == cut);
        }
    }

    // Length put straight before the tip of a curved catheter is bent by k too little: B k^2/2 a metre, which is added to the
    // wire's energy by no work. For a cut step it is the 1e-6 of an edge by which the cut is late; of one that is not, the
    // length gained in it.
    TEST_CASE("property: the lead changes without energy out of nothing")
    {
        const double curvature = 15, bend = 2e-4;
        const Crossing made(0.4, curvature);
        World world(made.setup);
        for (int k = 0; k < 3; ++k) REQUIRE_FALSE(step(world, made.control(), Crossing::dt).failed());
        WorldData& data = data_of(world);
        CHECK(data.groups.list.front()->leader == 0);
        const double gained = 0.6 * Crossing::dt * (Crossing::pushed + Crossing::drawn);
        // births at the hub leave some, of another order
        CHECK(std::abs(world.readings(0).remesh_energy) < 0.1 * 0.5 * bend * curvature * curvature * gained);
    }
}

}  // namespace seldinger::test::test_merged_lead

// A chart from end to end on a wire soft enough that every method, explicit too, computes its swing in milliseconds.

#include "lab/chart.h"

#include "core/error.h"
#include "support/approx.h"
#include "support/scenes.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

namespace seldinger::test::test_chart {

namespace {

const std::string soft_swing = scene_text(0.2, 1e-3, "name = \"soft swing\"\n") + wire_text(0.1, 1e-5, 1e-7, 41, 4e-4, 7900, 10) +
                               placed_along_x + held_base;

struct ChartFixture {
    TemporaryFolder folder;
    ChartOptions options;
    ChartFixture()
    {
        std::ofstream(folder.path() / "soft.toml") << soft_swing;
        options.dir = folder.path() / "chart";
        options.scenes_folder = folder.path();
        options.scenes = {(folder.path() / "soft.toml").string()};
        options.quick = true;
    }
};

const ChartPoint& point_named(const SceneChart& chart, const std::string& name)
{
    const auto found = std::find_if(chart.points.begin(), chart.points.end(),
                                    [&](const ChartPoint& point) { return point.model.model.name == name; });
    REQUIRE(found != chart.points.end());
    return *found;
}

long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

}  // namespace

TEST_SUITE("lab/chart")
{
    TEST_CASE_FIXTURE(ChartFixture,
                      "property: interrupted, a chart keeps what it has and goes on; finished, it says which models are worth it")
    {
        int asked = 0;
        options.stop = [&asked] { return ++asked > 60; };
        const ChartResult cut = make_chart(options);
        CHECK(cut.interrupted);
        REQUIRE(cut.runs_done > 0);
        REQUIRE(cut.runs_done < cut.runs_wanted);

        options.stop = {};
        const ChartResult whole = make_chart(options);
        CHECK_FALSE(whole.interrupted);
        CHECK(whole.runs_done == whole.runs_wanted);
        REQUIRE(whole.scenes.size() == 1);
        const SceneChart& chart = whole.scenes[0];
        REQUIRE(static_cast<int>(chart.points.size()) == whole.runs_wanted);
        for (int k = 0; k < cut.runs_done; ++k)  // not run again: another run would have taken another time
            CHECK(chart.points[k].run.cost.wall == cut.scenes[0].points[k].run.cost.wall);

        REQUIRE(chart.reference.usable(Observable::Tip));
        const auto tip = [&](const char* name) { return at(point_named(chart, name).errors.rms, Observable::Tip); };
        CHECK(tip("25 · 16.7 ms") > tip("101 · 5 ms"));
        CHECK(tip("101 · 5 ms") > 3 * tip("101 · 1 ms"));              // first order in the step
        CHECK(tip("101 · 1 ms") > 2 * tip("101 · 1 ms · trapezoid"));  // second order, where modes are resolved
        CHECK(point_named(chart, "explicit 25").run.complete);

        int on_front = 0;
        for (const ChartPoint& point : chart.points) {
            if (!point.front[0]) continue;
            ++on_front;
            for (const ChartPoint& other : chart.points)  // nothing sound is cheaper and better
                if (other.sound() && other.run.cost.wall < point.run.cost.wall)
                    CHECK(at(other.errors.rms, Observable::Tip) >= at(point.errors.rms, Observable::Tip));
            CHECK(standing(chart, point, Observable::Tip).cost_ratio <= 1 + 1e-12);
        }
        CHECK(on_front >= 1);  // the cheapest is on it; where that is the most accurate too, as measured, it is alone

        const std::string table = chart_csv(whole);
        CHECK(lines(table) == 1 + whole.runs_wanted);
        CHECK(table.find("nan") == std::string::npos);
        CHECK(table.find("inf") == std::string::npos);
        CHECK(lines(references_csv(whole)) == 3);  // header, tip, shape: nothing touches
        CHECK(std::filesystem::exists(options.dir / "chart.csv"));
        CHECK(chart_summary(whole).find("tip position: reference converges") != std::string::npos);
        CHECK(table.find("integrator.spins=kept") != std::string::npos);
    }

    TEST_CASE_FIXTURE(ChartFixture, "property: a wrong name is refused before anything runs, and the nearest is named")
    {
        options.scenes = {"elastika"};
        CHECK_THROWS_WITH_AS((void)make_chart(options), doctest::Contains("the nearest is \"elastica\""), Error);
        options.scenes = {"none.toml"};
        CHECK_THROWS_WITH_AS((void)make_chart(options), doctest::Contains("none.toml"), Error);
        CHECK_FALSE(std::filesystem::exists(options.dir));
    }

    TEST_CASE("property: a reference that does not converge is reported and not charted")
    {
        ChartResult result;
        SceneChart chart;
        chart.benchmark.name = "fork";
        chart.benchmark.charted = {Observable::Tip};
        chart.reference.known.fill(true);
        chart.reference.convergence.fill(Convergence::NotFalling);
        chart.reference.moved = {PerObservable{1e-3}, PerObservable{2e-3}};
        chart.reference.uncertainty = {2e-3};
        chart.scale = {0.1};
        chart.finished = true;
        result.scenes.push_back(chart);
        CHECK(chart_summary(result).find(
                  "tip position: not charted: the reference does not converge (the last refinement moved it by 2 mm)") !=
              std::string::npos);
        const std::string table = references_csv(result);
        CHECK(table.find("fork,tip,m,tip position,0,does not converge,0.002") != std::string::npos);
    }
}

TEST_SUITE("lab/chart_models")
{
    TEST_CASE_FIXTURE(ChartFixture, "property: names tell models apart, and the explicit step follows the fastest wave")
    {
        const Scene scene = read_scene(options.scenes[0]);
        for (const bool quick : {true, false}) {
            std::set<std::string> names;
            const auto models = chart_models(scene, quick, {});
            for (const ChartModel& model : models) CHECK(names.insert(model.model.name).second);
            CHECK(models.size() >= (quick ? 15u : 50u));
        }
        // torsion: sqrt(C / (rho I_p)) = sqrt(1e-7 / 3.18e-10) = 17.7 m/s; stretch: sqrt(10 / 3.97e-3) = 50.2 m/s, the fastest on
        // edges of 2.5 mm, where bending makes 4 sqrt(B / rho A) / h^2 = 32,100 rad/s against 2 c / h = 40,100
        CHECK(explicit_step(scene.wire, 41) == test::about(0.25 * 2 / 40100).epsilon(0.01).scale(0));
    }

    TEST_CASE_FIXTURE(ChartFixture,
                      "property: beside an elastic wall stand a rigid one and coarser ones; beside a rigid one, elastic")
    {
        Scene scene = read_scene(options.scenes[0]);
        scene.vessel.shape = VesselShape::Tube;
        scene.vessel.radius = 0.005;
        scene.vessel.length = 0.1;
        scene.vessel.triangles = 1000;
        const auto walls_of = [&](const WallEdges& edges) {
            std::vector<ChartModel> walls;
            for (const ChartModel& model : chart_models(scene, true, {}, edges))
                if (model.family == "wall") walls.push_back(model);
            return walls;
        };
        const auto beside_rigid = walls_of({});
        REQUIRE(beside_rigid.size() == 1);
        CHECK(beside_rigid[0].model.name == "elastic wall");
        CHECK(beside_rigid[0].refused == "");
        scene.vessel.elastic = true;
        const auto beside_elastic = walls_of({0.002, 0.001});
        std::set<std::string> names;
        for (const ChartModel& model : beside_elastic) {
            CHECK(model.refused == "");
            names.insert(model.model.name);
        }
        CHECK(names == std::set<std::string>{"rigid wall", "rigid wall · 16.7 ms", "wall edge 4 mm", "wall edge 4 mm · 16.7 ms",
                                             "wall edge 2.8 mm"});
    }
}

}  // namespace seldinger::test::test_chart

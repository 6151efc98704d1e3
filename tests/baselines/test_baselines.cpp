// The baselines of the charts against solutions that are known: a comparison is fair only when each method does its best.

#include "baselines/baselines.h"
#include "core/error.h"
#include "lab/elastica.h"
#include "models/run_model.h"
#include "support/approx.h"

#include <cmath>
#include <string>

namespace seldinger::test::test_baselines {

namespace {

constexpr double length = 0.1, bend = 5.5190957750700876e-5, tip_force = 0.011038191550140172;  // alpha = P L^2/B = 2

StudyScene cantilever(double gravity, double force)
{
    Scene scene;
    scene.duration = 1.5;
    scene.dt = 1e-3;
    scene.gravity = {0, 0, -gravity};
    scene.wire.length = length;
    scene.wire.nodes = 11;
    scene.wire.shaft.radius = 0.000178;
    scene.wire.shaft.density = 6450;
    scene.wire.shaft.bend_stiffness = bend;
    scene.wire.shaft.twist_stiffness = 4.2e-5;
    scene.wire.shaft.stretch_stiffness = 6966;
    scene.integrator.damping_mass = 60;
    HoldSpec hold;
    hold.position = hold.direction = hold.spin = true;
    scene.holds = {hold};
    if (force > 0) {
        scene.loads = {{.at = {WirePoint::Kind::Tip}, .force = {0, 0, -force}, .ramp = 0.2}};
    }
    StudyScene study;
    study.setup.gravity = scene.gravity;
    study.setup.wires.push_back({scene.wire, {}, {}, scene.holds, scene.loads, {}});
    study.scene = scene;
    return study;
}

/// At rest after 1.5 s: e^(-30 * 1.3) of the swing is left.
std::vector<Vec3> rest_shape(const StudyScene& study, const std::string& baseline, int nodes, double dt = 1e-3)
{
    Model model{.baseline = baseline, .nodes = nodes, .dt = dt};
    RunPlan plan;
    plan.interval = 1.5;
    const ModelRun run = run_model(study, model, plan, baselines::all());
    REQUIRE(run.complete);
    CHECK(run.verdict.readings.outside == 0);
    return run.trajectory.samples.back().shape;
}

double tip_error(const std::vector<Vec3>& shape, const StudyScene& study)
{
    const std::vector<Vec3> exact =
        elastica_shape(study.scene.wire.shaft, length, Vec3::Zero(), Vec3::UnitX(), study.scene.loads.front().force, 101);
    return (shape.front() - exact.front()).norm();
}

}  // namespace

TEST_SUITE("lab/elastica")
{
    TEST_CASE("analytic: tip of an inextensible cantilever, alpha = 2, by elliptic integrals [Bisshopp45]")
    {
        WireSection section;
        section.bend_stiffness = bend;
        section.stretch_stiffness = 1e12;  // inextensible
        const auto shape = elastica_shape(section, length, {0, 0, 0.5}, Vec3::UnitX(), {0, 0, -tip_force}, 201);
        REQUIRE(shape.size() == 201);
        CHECK(1 - shape.front().x() / length == about(0.1606417).epsilon(1e-6));
        CHECK((0.5 - shape.front().z()) / length == about(0.4934575).epsilon(1e-6));
        CHECK(shape.back() == Vec3(0, 0, 0.5));
    }

    TEST_CASE("analytic: a pull along the wire stretches it by F L / EA and bends nothing")
    {
        WireSection section{.bend_stiffness = bend, .stretch_stiffness = 1e3};
        const auto shape = elastica_shape(section, length, Vec3::Zero(), Vec3::UnitX(), {10, 0, 0}, 11);
        CHECK((shape.front() - Vec3(1.01 * length, 0, 0)).norm() < 1e-12);
    }
}

TEST_SUITE("baselines")
{
    TEST_CASE("analytic: corotational beams reach the elastica at second order")
    {
        const StudyScene study = cantilever(0, tip_force);
        const double coarse = tip_error(rest_shape(study, "beam", 6), study),
                     fine = tip_error(rest_shape(study, "beam", 11), study);
        CHECK(fine < 0.25 * 0.1 * 0.1 * length);
        CHECK(coarse / fine == about(4.0).epsilon(0.15));
        // one linear solve per step comes to rest at the same place
        CHECK((rest_shape(study, "beam · lin", 11).front() - rest_shape(study, "beam", 11).front()).norm() < 1e-3 * fine);
    }

    TEST_CASE("analytic: mass-spring reaches it at second order too; softened springs stretch on top")
    {
        const StudyScene study = cantilever(0, tip_force);
        const double coarse = tip_error(rest_shape(study, "mass-spring", 6), study),
                     fine = tip_error(rest_shape(study, "mass-spring", 11), study);
        CHECK(fine < 0.25 * 0.1 * 0.1 * length);  // (h/L)^2 times a number well below one
        CHECK(coarse / fine == about(4.0).epsilon(0.15));
        // EA lowered to 4 B / h^2 lets the wire stretch by the axial part of P: at most P L h^2 / (4 B) = 0.5 mm
        const double soft =
            (rest_shape(study, "soft mass-spring", 11).front() - rest_shape(study, "mass-spring", 11).front()).norm();
        CHECK(soft > 1e-4);
        CHECK(soft < 5e-4);
    }

    TEST_CASE("analytic: heavy cantilever, Gamma = w L^3/B = 10: height over width at rest is 1.0668")
    {
        const double line = 6450 * 3.14159265358979 * 0.000178 * 0.000178;
        const StudyScene study = cantilever(10 * bend / (line * length * length * length), 0);
        const auto shape = rest_shape(study, "beam", 21);
        // height over width goes wrong by twice the relative error of either: (h kappa)^2 / 12 with kappa L up to 4
        CHECK(-shape.front().z() / shape.front().x() == about(1.0668023).epsilon(0.01));
        const auto springs = rest_shape(study, "mass-spring", 21);
        CHECK(-springs.front().z() / springs.front().x() == about(1.0668023).epsilon(0.01));
    }

    TEST_CASE(
        "property: a wire let go under its weight keeps its energy (springs), or loses it to backward Euler (beams), never gains")
    {
        StudyScene study = cantilever(300, 0);
        study.scene.integrator.damping_mass = 0;
        for (const char* name : {"mass-spring", "soft mass-spring", "beam"}) {
            CAPTURE(name);
            Model model;
            model.baseline = name;
            const auto simulation = make_simulation(study, model, baselines::all());
            const auto total = [&] {
                const WireReadings r = simulation->readings();
                return r.kinetic + r.elastic + r.gravitational;
            };
            const double start = total();
            double turned_over = 0;
            for (int k = 0; k < 100; ++k) {
                REQUIRE_FALSE(simulation->step(2e-4).failed());
                turned_over = std::max(turned_over, simulation->readings().kinetic);
            }
            REQUIRE(turned_over > 0);
            // symplectic Euler's energy swings by omega h of the ringing that letting go sets off, and does not drift
            CHECK(total() - start < 0.01 * turned_over);
            if (std::string(name) != "beam") CHECK(total() - start > -0.01 * turned_over);
        }
    }

    TEST_CASE("property: what they cannot compute they refuse")
    {
        StudyScene study = cantilever(9.81, 0);
        CHECK(baselines::why_not_cantilever(study.scene).empty());
        study.scene.wire.shaft.rest_curvature = {10, 0};
        CHECK_FALSE(baselines::why_not_cantilever(study.scene).empty());
        study = cantilever(9.81, 0);
        study.scene.vessel.shape = VesselShape::Tube;
        Model model;
        model.baseline = "beam";
        CHECK_THROWS_WITH_AS((void)make_simulation(study, model, baselines::all()), doctest::Contains("no contact"), Error);
        model.baseline = "spline";
        CHECK_THROWS_WITH_AS((void)make_simulation(study, model, baselines::all()), doctest::Contains("no baseline \"spline\""),
                             Error);
    }
}

}  // namespace seldinger::test::test_baselines

// Errors of a run against a reference, on samples made by hand, and the file that keeps them.

#include "lab/pareto.h"
#include "models/errors.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

#include <cmath>
#include <fstream>
#include <functional>

namespace seldinger::test::test_errors {

namespace {

constexpr double length = 0.3;  // [m]

Sample moment(double t, double y, double hand, double friction, const std::vector<ForceAt>& forces)
{
    Sample s;
    s.t = t;
    s.shape = {{0.1, y, 0}, {0, 0, 0}};
    s.hand_force = hand;
    s.friction = friction;
    s.contact_up_to = accumulate_forces(forces, length);
    return s;
}

}  // namespace

TEST_SUITE("models/errors")
{
    TEST_CASE("analytic: tip, shape and forces of two samples")
    {
        const Sample a = moment(1, 0.003, 0.20, 0.05, {}), b = moment(1, 0, 0.17, 0.06, {});
        const PerObservable e = sample_errors(a, b);
        CHECK(at(e, Observable::Tip) == about(0.003).epsilon(1e-12));
        CHECK(at(e, Observable::Shape) == about(0.003).epsilon(1e-9));
        CHECK(at(e, Observable::HandForce) == about(0.03).epsilon(1e-12));
        CHECK(at(e, Observable::Friction) == about(0.01).epsilon(1e-12));
        CHECK(at(e, Observable::Contact) == 0);
    }

    TEST_CASE("analytic: a force put wrong by a distance d counts force d / L; a missing one counts its distance to the end")
    {
        const auto difference = [](const std::vector<ForceAt>& a, const std::vector<ForceAt>& b) {
            return at(sample_errors(moment(0, 0, 0, 0, a), moment(0, 0, 0, 0, b)), Observable::Contact);
        };
        // the lever rule keeps force and first moment on the grid, so that a shift is exact
        CHECK(difference({{0.1, 2.0}}, {{0.112345, 2.0}}) == about(2.0 * 0.012345 / length).epsilon(1e-9));
        CHECK(difference({{0.1, 2.0}}, {}) == about(2.0 * (length - 0.1) / length).epsilon(1e-2));  // half a cell of 1/256
        // the same force in two halves a symmetric distance apart: a spread of 0.02 on each side
        CHECK(difference({{0.13, 1.0}, {0.17, 1.0}}, {{0.15, 2.0}}) == about(2.0 * 0.02 / length).epsilon(1e-2));
        CHECK(difference({{0.02, 1.0}, {0.2, 0.5}}, {{0.2, 0.5}, {0.02, 1.0}}) == 0);
    }

    TEST_CASE("analytic: rms and worst over the samples in the window that both have")
    {
        Trajectory run, reference;
        for (int k = 1; k <= 4; ++k) {
            reference.samples.push_back(moment(k, 0, 0, 0, {}));
            if (k < 4) run.samples.push_back(moment(k, k == 1 ? 1.0 : 0.001 * k, 0, 0, {}));
        }
        const Errors e = trajectory_errors(run, reference, {2, 10});
        CHECK(e.samples == 2);  // t = 1 is outside the window, t = 4 is missing
        CHECK(at(e.worst, Observable::Tip) == about(0.003).epsilon(1e-12));
        CHECK(at(e.median, Observable::Tip) == about(0.003).epsilon(1e-12));  // the upper of two
        CHECK(at(e.rms, Observable::Tip) == about(std::sqrt((4e-6 + 9e-6) / 2)).epsilon(1e-12));
        CHECK(std::isnan(at(trajectory_errors(run, reference, {50, 60}).rms, Observable::Tip)));
    }

    TEST_CASE("property: a saved trajectory reads back to the same bits; a damaged one is not taken")
    {
        const TemporaryFolder folder;
        const auto file = folder.path() / "run.trajectory";
        Trajectory saved, read;
        saved.wire_length = length;
        saved.samples = {moment(0.1, 1.0 / 3, -2, 7, {{0.1, 3}}), moment(0.2, 2.0 / 3, 5, 1e-300, {})};
        save_trajectory(file, saved);
        REQUIRE(load_trajectory(file, read));
        REQUIRE(read.samples.size() == 2);
        CHECK(read.wire_length == saved.wire_length);
        for (std::size_t k = 0; k < 2; ++k) {
            const Sample &a = saved.samples[k], &b = read.samples[k];
            CHECK(a.t == b.t);
            CHECK(a.hand_force == b.hand_force);
            CHECK(a.friction == b.friction);
            CHECK(a.shape == b.shape);
            CHECK(a.contact_up_to == b.contact_up_to);
        }
        std::fstream(file, std::ios::in | std::ios::out).seekp(60).put('x');
        CHECK_FALSE(load_trajectory(file, read));
        std::filesystem::resize_file(file, 100);
        CHECK_FALSE(load_trajectory(file, read));
        CHECK_FALSE(load_trajectory(folder.path() / "none", read));
    }

    TEST_CASE("property: a trajectory that no run makes is not taken, whatever its checksum says")
    {
        const TemporaryFolder folder;
        const auto file = folder.path() / "run.trajectory";
        const auto is_taken = [&](const std::function<void(Trajectory&)>& alter) {
            Trajectory saved, read;
            saved.wire_length = length;
            saved.samples = {moment(0.1, 1.0 / 3, -2, 7, {{0.1, 3}}), moment(0.2, 2.0 / 3, 5, 1e-300, {})};
            alter(saved);
            save_trajectory(file, saved);
            return load_trajectory(file, read);
        };
        CHECK(is_taken([](Trajectory&) {}));
        CHECK_FALSE(is_taken([](Trajectory& t) { t.samples[1].shape.clear(); }));    // errors are taken of its first point
        CHECK_FALSE(is_taken([](Trajectory& t) { t.samples[0].shape.resize(1); }));  // and of its edges
        CHECK_FALSE(is_taken([](Trajectory& t) { t.samples[1].t = t.samples[0].t; }));
        CHECK_FALSE(is_taken([](Trajectory& t) { t.samples[0].t = std::nan(""); }));
    }
}

TEST_SUITE("lab/pareto")
{
    TEST_CASE("analytic: the front of a handful of points, by rising cost")
    {
        const double nan = std::nan("");
        const std::vector<CostAndError> points = {{3, 1},   {1, 5},     {2, 5}, {2, 3},    {4, 1},
                                                  {nan, 0}, {0.5, nan}, {2, 3}, {10, 0.5}, {9, 2}};
        CHECK(pareto_front(points) == std::vector<std::size_t>{1, 3, 0, 8});
        CHECK(pareto_front(points, 1.0) == std::vector<std::size_t>{1, 3, 0});  // 1 to 0.5 is no gain of more than 1
        CHECK(pareto_front({}).empty());
    }

    TEST_CASE("property: no point beats a point of the front")
    {
        std::vector<CostAndError> points;
        for (int k = 1; k <= 200; ++k) points.push_back({std::fmod(k * 0.754877666, 1.0), std::fmod(k * 0.569840296, 1.0)});
        const auto front = pareto_front(points);
        REQUIRE(front.size() > 3);
        for (const std::size_t i : front)
            for (const CostAndError& p : points)
                CHECK_FALSE((p.cost <= points[i].cost && p.error <= points[i].error &&
                             (p.cost < points[i].cost || p.error < points[i].error)));
    }
}

}  // namespace seldinger::test::test_errors

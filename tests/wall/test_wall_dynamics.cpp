// Steps of the wall in blocks against a full solve in every step.

#include "coupling/wall_stations.h"
#include "core/state_walk.h"
#include "engine.h"
#include "shell/large_shell.h"
#include "shell/shell.h"
#include "shell/wall_compliance.h"
#include "shell/wall_dynamics.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace seldinger::test::test_wall_dynamics {

namespace {

/// A wall of its setup.
struct Made {
    WorldSetup setup;
    std::unique_ptr<WallModel> model;
    std::unique_ptr<ElasticWall> wall;

    void make()
    {
        load_vessel(setup);
        model = std::make_unique<WallModel>(setup.vessel, setup.mesh, setup.centreline);
        wall = std::make_unique<ElasticWall>(*model);
    }
};

/// An iliac artery's tube on a coarse control mesh, and a force on its middle.
struct Tube : Made {
    explicit Tube(double thickness = 0.68e-3)
    {
        setup.vessel.shape = VesselShape::Tube;
        setup.vessel.radius = 5.5e-3;
        setup.vessel.length = 0.03;
        setup.vessel.triangles = 4000;
        setup.vessel.elastic = true;
        setup.vessel.youngs = 0.7e6;
        setup.vessel.thickness = thickness;
        setup.vessel.wall_edge = 2e-3;
        make();
    }
    /// @param inward  [N]
    [[nodiscard]] std::vector<WallDynamics::Push> push(double inward) const
    {
        LoopFoot foot;
        wall->surface().closest({0.015, 0, -5.5e-3}, foot);
        LoopStencil at;
        wall->surface().basis(foot.triangle, foot.u, foot.v, at);
        std::vector<WallDynamics::Push> list;
        for (int k = 0; k < at.size; ++k) list.push_back({0, at.vertex[k], at.n[k] * Vec3(0, 0, inward)});
        return list;
    }
};

/// A plate in tissue on a coarse control mesh.
struct Plate : Made {
    explicit Plate(double support_damping = 1e4, double relaxation = 0.02, const std::vector<WallLoad>& loads = {})
    {
        setup.vessel.loads = loads;
        setup.vessel.shape = VesselShape::Plane;
        setup.vessel.size = 0.04;
        setup.vessel.triangles = 800;
        setup.vessel.elastic = true;
        setup.vessel.thickness = 0.0015;
        setup.vessel.wall_edge = 0.004;
        setup.vessel.support_damping = support_damping;
        setup.vessel.relaxation = relaxation;
        make();
    }
    /// The control vertex nearest to the middle.
    [[nodiscard]] std::int32_t middle() const
    {
        const auto& list = wall->surface().control().vertices;
        const auto nearer = [](const Vec3& a, const Vec3& b) { return a.squaredNorm() < b.squaredNorm(); };
        return static_cast<std::int32_t>(std::min_element(list.begin(), list.end(), nearer) - list.begin());
    }
};

/// (K + C/h) w1 = C/h w0 + f, solved in full. @param more  [3V] forces beside those; may be empty
void full_step(const ElasticWall& wall, double h, std::span<const WallDynamics::Push> pushed, std::vector<double>& w,
               std::span<const double> more = {})
{
    const auto size = static_cast<Eigen::Index>(w.size());
    std::vector<double> rhs(w.size());
    Eigen::Map<Eigen::VectorXd>(rhs.data(), size) =
        (1 / h) * (wall.compliance().damping() * Eigen::Map<const Eigen::VectorXd>(w.data(), size));
    for (std::size_t i = 0; i < wall.load().size(); ++i) rhs[i] += wall.load()[i];
    for (std::size_t i = 0; i < more.size(); ++i) rhs[i] += more[i];
    for (const auto& push : pushed) add_to(&rhs[3 * static_cast<std::size_t>(push.vertex)], push.force);
    WallSolveWork scratch;
    wall.compliance().factor(h)->solve(rhs, scratch);
    w = rhs;
}

double largest(const std::vector<double>& w)
{
    double most = 0;
    for (const double x : w) most = std::max(most, std::abs(x));
    return most;
}

/// Largest difference over 100 steps of 1 ms, pushed for the first 60, as a share of the largest displacement; so small a one
/// (0.07 mm) that the wall is linear.
double largest_miss(const Plate& plate)
{
    WallDynamics dynamics(*plate.wall);
    std::vector<double> full(static_cast<std::size_t>(plate.wall->unknowns()));
    const WallDynamics::Push push[] = {{0, plate.middle(), Vec3(0.001, 0, -0.005)}};
    double miss = 0, most = 0;
    for (int k = 0; k < 100; ++k) {
        const auto pushed = k < 60 ? std::span<const WallDynamics::Push>(push) : std::span<const WallDynamics::Push>();
        dynamics.begin_step(1e-3);
        dynamics.end_step(pushed);
        full_step(*plate.wall, 1e-3, pushed, full);
        const std::vector<double> blocks = dynamics.displacement();
        for (std::size_t i = 0; i < full.size(); ++i) miss = std::max(miss, std::abs(full[i] - blocks[i]));
        most = std::max(most, largest(full));
    }
    return miss / most;
}

}  // namespace

// The memory is mu = (c_s - tau k_s)/((h + tau)(k_s + c_s/h)) = -0.043 of a displacement that no strain holds, which falls by
// z = 0.909 in a step once it is let go. A block that begins there takes it as it was. In 8 steps it misses, as a fraction of
// w,
// |mu| sum_j (1 - z^j) s^(7 - j) = 0.083, s = 0.952. (Backward Euler itself is off by 0.017 there: 0.909^8 for exp(-0.8).)
TEST_CASE("blocks of steps follow the full solve in every step") { CHECK(largest_miss(Plate()) < 0.083); }

// c_s = tau k_s: nothing is left to remember. tau = 0: all of it, and every step is solved in full.
TEST_CASE("where tissue and wall relax alike, or the wall does not relax at all, nothing is missed but rounding")
{
    CHECK(largest_miss(Plate(2e4, 0.02)) < 1e-9);
    CHECK(largest_miss(Plate(1e4, 0)) < 1e-9);
}

// An artery pushed outwards ever harder: M^-1 r passes 3, 6 and 12 % of the displacement, so that there are blocks of all
// lengths. The reference takes r at the start of every step. At the end of a block M^-1 r is missed by up to 1e-3 of the
// displacement, or single steps follow; inside it by a third of that on average. What a step leaves of it at the next one is s =
// tau/(h + tau) = 20/21, so that the sum of all may become 21 * 1e-3 / 3 = 0.7 % (found: 0.25 %).
TEST_CASE("property: blocks of two and four steps follow single ones under large displacements")
{
    const Tube tube;
    const ElasticWall& wall = *tube.wall;
    WallDynamics blocks(wall);
    std::vector<double> single(static_cast<std::size_t>(wall.unknowns()));
    int steps_in[WallDynamics::block_steps + 1] = {};
    double miss = 0;
    for (int k = 0; k < 1600; ++k) {
        const auto push = tube.push(-1.2 * k / 1600);
        blocks.begin_step(1e-3);
        const std::int32_t length = blocks.block_length();
        ++steps_in[length];
        blocks.end_step(push);
        std::vector<double> excess(single.size());
        if (const LargeShell* large = wall.large_for(single)) wall.take_excess_force(*large, single, excess);
        full_step(wall, 1e-3, push, single, excess);
        const std::vector<double> now = blocks.displacement();
        double apart = 0;
        for (std::size_t i = 0; i < now.size(); ++i) apart = std::max(apart, std::abs(now[i] - single[i]));
        if (length == 2 || length == 4) miss = std::max(miss, apart / largest(single));
    }
    REQUIRE(steps_in[2] >= 8);
    REQUIRE(steps_in[4] >= 16);
    CHECK(miss < 7e-3);
}

// K w + r(w) = f: contact's force is what the shell under large displacements makes of where the wall rests.
TEST_CASE("analytic: a wall that is pushed far rests where the shell under large displacements does, after steps and at once")
{
    const Plate plate;
    const ElasticWall& wall = *plate.wall;
    const WallDynamics::Push push[] = {{0, plate.middle(), Vec3(0.05, 0, -0.3)}};
    WallDynamics steps(wall), rest(wall);
    for (int k = 0; k < 400; ++k) {  // 20 relaxation times
        steps.begin_step(1e-3);
        steps.end_step(push);
    }
    const std::vector<double> w = steps.displacement();
    const auto size = static_cast<Eigen::Index>(w.size());
    const auto as_vector = [size](const std::vector<double>& list) {
        return Eigen::Map<const Eigen::VectorXd>(list.data(), size);
    };
    std::vector<double> f(w.size(), 0.0);
    add_to(&f[3 * static_cast<std::size_t>(push[0].vertex)], push[0].force);
    REQUIRE(steps.large());
    /// Of the equations at w; `excess`: the size of r.
    const auto left_at = [&](const std::vector<double>& at, bool all, double& excess) {
        std::vector<double> unmet(at.size(), 0.0);
        wall.take_excess_force(*steps.large(), at, unmet, all);
        excess = as_vector(unmet).norm();
        Eigen::VectorXd left = as_vector(f) + as_vector(unmet) - wall.compliance().stiffness() * as_vector(at);
        for (Eigen::Index v = 0; 3 * v < size; ++v)
            if (wall.compliance().matrices().held[static_cast<std::size_t>(v)]) left.segment<3>(3 * v).setZero();
        return left.norm();
    };
    double excess = 0;
    CHECK(left_at(w, false, excess) < 1e-4 * as_vector(f).norm());
    CHECK(excess > 0.1 * as_vector(f).norm());

    rest.begin_step(0);
    int rounds = 0;
    while (rest.relax(push) > 1e-9) REQUIRE(++rounds < 60);
    rest.end_step(push);
    const std::vector<double> at_once = rest.displacement();
    CHECK(left_at(at_once, true, excess) < 1e-5 * as_vector(f).norm());
    // steps leave out triangles with slopes up to 0.01: strains of 5e-5, beside those of a dent of 0.3 (slope squared over 2,
    // 0.05)
    CHECK((as_vector(at_once) - as_vector(w)).norm() < 1e-3 * as_vector(w).norm());
}

// A wall pulled inwards gives way first and stiffens later, in its short waves by more than blocks of steps bear (2.5 times). Its
// load rises all the way, so that there is one answer.
TEST_CASE("property: a wall that is pulled inwards has one answer, after steps and at once")
{
    const Tube tube;
    const auto push = tube.push(0.1);
    WallDynamics steps(*tube.wall), rest(*tube.wall);
    rest.begin_step(0);
    int rounds = 0;
    while (rest.relax(push) > 1e-8) REQUIRE(++rounds < 60);  // 97 rounds of Aitken's method
    rest.end_step(push);
    const std::vector<double> at_once = rest.displacement();
    for (int k = 0; k < 700; ++k) {  // 35 relaxation times; a tenth of K's stiffness is left to some modes
        steps.begin_step(1e-3);
        steps.end_step(push);
    }
    const std::vector<double> late = steps.displacement();
    double miss = 0;
    for (std::size_t i = 0; i < late.size(); ++i) miss = std::max(miss, std::abs(late[i] - at_once[i]));
    CHECK(largest(at_once) > 1.4e-3);
    CHECK(miss < 5e-3 * largest(at_once));
}

// w <- K^-1 (f - r(w)) contracts by a few per cent a round.
TEST_CASE("property: linear theory is off by at most its band, where it is used")
{
    for (const double thickness : {0.4e-3, 0.68e-3, 1.5e-3})
        for (const double sign : {1.0, -1.0}) {
            CAPTURE(thickness);
            const Tube tube(thickness);
            const auto factor = tube.wall->compliance().factor(0);
            const LargeShell large(tube.wall->shell());
            WallSolveWork scratch;
            std::vector<double> linear(static_cast<std::size_t>(tube.wall->unknowns()), 0.0);
            for (const auto& push : tube.push(sign)) add_to(&linear[3 * static_cast<std::size_t>(push.vertex)], push.force);
            factor->solve(linear, scratch);
            const double most = std::min(0.01 * tube.setup.vessel.radius, 0.1 * thickness), size = largest(linear);
            for (double& x : linear) x *= most / size;
            std::vector<double> w = linear;
            for (int round = 0; round < 6; ++round) {
                std::vector<double> y(w.size(), 0.0);
                tube.wall->take_excess_force(large, w, y, true);
                factor->solve(y, scratch);
                for (std::size_t i = 0; i < w.size(); ++i) w[i] = linear[i] + y[i];
            }
            const double off = std::abs(largest(linear) - largest(w)), band = tube.wall->left_out(most) * most;
            CHECK(off < band);
            CHECK(off > 0.3 * band);
            double excess = 0;
            const double stress = tube.wall->shell().stress(w, &large, &excess).mises_max,
                         by_linear = tube.wall->shell().stress(linear).mises_max;
            CHECK(std::abs(by_linear - stress) < tube.wall->left_out(most) * stress);
            const Shell::Energy e = tube.wall->shell().energy(w);
            CHECK(excess == test::about(large.energy(w).sum() - e.membrane - e.bending).epsilon(1e-9));
        }
}

TEST_CASE("a scene's load on the wall acts in every step, beside what pushes on it")
{
    const std::vector<WallLoad> loads = {{0, Vec3(0.004, -0.003, 0), Vec3(0.001, 0, 0.004)}};
    const Plate plate(1e4, 0, loads);
    REQUIRE(plate.wall->load().size() == static_cast<std::size_t>(plate.wall->unknowns()));
    CHECK(largest_miss(plate) < 1e-9);
    WallDynamics rest(*plate.wall);
    rest.begin_step(0);
    rest.end_step({});
    std::vector<double> expected(plate.wall->load().begin(), plate.wall->load().end());
    WallSolveWork scratch;
    plate.wall->compliance().factor(0)->solve(expected, scratch);
    const std::vector<double> now = rest.displacement();
    REQUIRE(largest(expected) > 0);
    for (std::size_t i = 0; i < now.size(); ++i) CHECK(std::abs(now[i] - expected[i]) <= 1e-12 * largest(expected));
}

// The map X -> X + U(X) of a wall pulled sideways: a node at x has its foot at y with y + U(foot of y) = x. One pass from y = x
// would leave the slope of U times U, here a tenth of a radius; passes end where one changes less than 1e-3 radii.
TEST_CASE("a node's foot on a moved wall is that of the place which the wall has carried to it")
{
    constexpr double radius = 4.4e-4;
    const Plate plate(1e4, 0, {{0, Vec3(0.004, -0.003, 0), Vec3(0.5, 0.1, 0.1)}});
    WallDynamics wall(*plate.wall);
    wall.begin_step(0);
    wall.end_step({});
    wall.begin_step(1e-3);
    int tried = 0;
    for (const double off : {0.0, 0.003, -0.004, 0.006}) {
        const Vec3 x(0.004 + off, -0.003, radius);
        WallStations stations(*plate.wall, 3);
        stations.place(0, x, nullptr, wall, radius);
        REQUIRE(stations[0].near);
        const Vec3 carried = x - stations[0].start;
        stations.place(1, x, &carried, wall, radius);  // one pass, from where the first one ended
        stations.place(2, x, &x, wall, radius);        // one pass, from the node itself
        REQUIRE(stations[1].near);
        CHECK((stations[1].start - stations[0].start).norm() <= 1e-3 * radius);
        tried += (stations[2].start - stations[0].start).norm() > 1e-2 * radius;
    }
    CHECK(tried >= 2);  // the passes make a difference
}

TEST_CASE("a wall that is pushed on comes to rest where its stiffness has it, and an equilibrium is there at once")
{
    const Plate plate;
    const WallDynamics::Push push[] = {{0, plate.middle(), Vec3(0, 0, -0.005)}};
    WallDynamics slow(*plate.wall), at_once(*plate.wall);
    at_once.begin_step(0);
    at_once.end_step(push);
    const std::vector<double> rest = at_once.displacement();
    for (int k = 0; k < 400; ++k) {  // 0.4 s: twenty of the wall's relaxation times
        slow.begin_step(1e-3);
        slow.end_step(push);
    }
    const std::vector<double> late = slow.displacement();
    for (std::size_t i = 0; i < rest.size(); ++i) CHECK(std::abs(late[i] - rest[i]) <= 1e-5 * largest(rest));
    std::vector<double> expected(rest.size());
    expected[3 * static_cast<std::size_t>(plate.middle()) + 2] = -0.005;
    WallSolveWork scratch;
    plate.wall->compliance().factor(0)->solve(expected, scratch);
    for (std::size_t i = 0; i < rest.size(); ++i) CHECK(std::abs(expected[i] - rest[i]) <= 1e-12 * largest(rest));
}

// Pushed on one vertex, it takes sums of columns, which are kept in single precision: 6e-8 of each. Pushed on all of them, a
// solve.
TEST_CASE("what is known of single vertices is what all of them are, at the start of a step and untouched at its end")
{
    std::vector<WallLoad> loads;
    SUBCASE("pushed") {}
    SUBCASE("pushed and under a load") { loads = {{0, Vec3(0.004, -0.003, 0), Vec3(0.01, 0, 0.04)}}; }
    const Plate plate(1e4, 0.02, loads);
    WallDynamics dynamics(*plate.wall);
    std::vector<WallDynamics::Push> push = {{0, plate.middle(), Vec3(0.02, 0, -0.05)}};
    double accuracy = 1e-7;
    SUBCASE("one") {}
    SUBCASE("all")
    {
        const auto count = static_cast<std::int32_t>(plate.wall->surface().control().vertices.size());
        REQUIRE(static_cast<std::size_t>(count) * count > plate.wall->compliance().factor(1e-3)->entries() / 100);
        for (std::int32_t v = 0; v < count; ++v) push.push_back({0, v, Vec3(0, 1e-4, 1e-4 * std::sin(v))});
        accuracy = 1e-12;
    }
    for (int k = 0; k < 13; ++k) {
        dynamics.begin_step(k == 5 ? 5e-4 : 1e-3);  // and a step of another length
        const std::vector<double> now = dynamics.displacement();
        WallDynamics untouched = dynamics;
        untouched.end_step({});
        const std::vector<double> end = untouched.displacement();
        const double scale = std::max(largest(now), 1e-9);
        for (const std::int32_t v : {plate.middle(), 0, plate.middle() / 2}) {
            CHECK((dynamics.now(v) - Vec3(&now[3 * static_cast<std::size_t>(v)])).norm() <= accuracy * scale);
            CHECK((dynamics.free(v) - Vec3(&end[3 * static_cast<std::size_t>(v)])).norm() <= accuracy * scale);
        }
        dynamics.end_step(push);
    }
}

TEST_CASE("a saved wall goes on with the same bits, and a damaged one is refused")
{
    const Plate plate;
    std::vector<WallDynamics::Push> push;
    SUBCASE("pushed at one vertex") { push = {{0, plate.middle(), Vec3(0.02, 0, -0.05)}}; }
    SUBCASE("pushed everywhere")
    {
        for (std::int32_t v = 0; v < plate.wall->unknowns() / 3; ++v) push.push_back({0, v, Vec3(2e-4, 0, -5e-4)});
    }
    WallDynamics whole(*plate.wall), resumed(*plate.wall);
    const auto advance = [&](WallDynamics& wall, int steps) {
        for (int k = 0; k < steps; ++k) {
            wall.begin_step(1e-3);
            wall.end_step(push);
        }
    };
    advance(whole, 11);
    std::vector<std::uint8_t> bytes;
    StateWalk out(bytes);
    whole.walk_state(out);
    StateWalk in(bytes, false);
    resumed.walk_state(in);
    CHECK(in.left() == 0);
    advance(whole, 9);
    advance(resumed, 9);
    CHECK(whole.displacement() == resumed.displacement());

    bytes.resize(bytes.size() / 2);
    StateWalk torn(bytes, false);
    CHECK_THROWS_AS(resumed.walk_state(torn), Error);
}

}  // namespace seldinger::test::test_wall_dynamics

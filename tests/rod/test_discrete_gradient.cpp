// The elastic force of an energy-momentum step: its work is the energy's change, whatever the step.

#include "math/eigen.h"
#include "rod/discrete_gradient.h"
#include "rod/rod_fixture.h"

namespace seldinger::test::test_discrete_gradient {

namespace {

/// What the wire has besides being straight: natural curvature and twist.
enum class Nature { Straight, Curved };

/// Lengths and stiffnesses of order 1, edges of different length, turning and twisting by up to about a radian a node.
OneWire random_wire(int n, unsigned seed, Nature nature, CurvatureMeasure measure)
{
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> sign(-1, 1), positive(0.7, 1.5);
    OneWire wire(n);
    wire.rod.curvature = measure;
    std::vector<Vec3> nodes{Vec3(0.3, -0.2, 0.1)};
    Vec3 t = random_unit(rng);
    for (int i = 1; i < n; ++i) {
        nodes.push_back(nodes.back() + positive(rng) * t);
        t = turned(t, unit_normal(random_unit(rng), t), 0.9 * sign(rng));
    }
    wire.place(nodes, random_unit(rng));
    const RodView& rod = wire.rod;
    for (int i = 0; i < n; ++i) {
        if (i < n - 1) {
            rod.rest_length[i] = (nodes[i + 1] - nodes[i]).norm() * (1 + 0.1 * sign(rng));
            rod.theta[i] = 4 * sign(rng);
        }
        rod.stretch_stiffness[i] = 3 * positive(rng);
        rod.bend_stiffness[i] = positive(rng);
        rod.twist_stiffness[i] = 0.8 * positive(rng);
        const bool curved = nature == Nature::Curved;
        rod.rest_kappa1[i] = curved ? 0.7 * sign(rng) : 0;
        rod.rest_kappa2[i] = curved ? 0.7 * sign(rng) : 0;
        rod.rest_twist[i] = curved ? 0.3 * sign(rng) : 0;
    }
    OwnedTrial trial(rod);
    REQUIRE(wire.accept(trial));
    return wire;
}

std::vector<std::vector<RodClamp>> clamp_sets(const OneWire& wire)
{
    const int n = wire.rod.n;
    return {
        {},
        {random_clamp(wire, n - 1, true, true, 1)},
        {random_clamp(wire, n - 1, true, false, 2), random_clamp(wire, 0, true, false, 3)},
        {random_clamp(wire, n / 2, true, true, 5), random_clamp(wire, n - 1, false, true, 7)},
        {random_clamp(wire, n / 2, true, false, 6), random_clamp(wire, 1, false, true, 8)},
    };
}

/// A step of random size `size` in every unknown, and its work.
struct Step {
    RodFrames before;
    std::vector<double> turned;
    Eigen::VectorXd change, force;  // q1 - q0, G
    double energy = 0;              // E(q1) - E(q0)

    Step(OneWire& wire, double size, unsigned seed)
        : before(wire.rod.n), change(RodDofs::count(wire.rod.n)), force(RodDofs::count(wire.rod.n))
    {
        const int n = wire.rod.n;
        std::mt19937 rng(seed);
        std::uniform_real_distribution<double> move(-size, size);
        REQUIRE(wire.update());
        before = wire.frames;
        const double start = wire.energy();
        OwnedTrial trial(wire.rod);
        for (int q = 0; q < RodDofs::count(n); ++q) {
            change[q] = q < RodDofs::count(n) - 1 ? move(rng) : 0;
            if (q < RodDofs::count(n) - 1) trial[q] += change[q];
        }
        REQUIRE(wire.update(trial));
        energy = wire.energy() - start;
        for (int j = 0; j < n; ++j) turned.push_back(change[RodDofs::spin(j)]);
        force.setZero();
        add_discrete_gradient(wire.rod, wire.clamps, before, wire.frames, turned,
                              {force.data(), static_cast<std::size_t>(RodDofs::count(n))});
    }
};

}  // namespace

TEST_SUITE("rod/discrete_gradient")
{
    TEST_CASE("property: work is the change of energy, for any step, with any clamps, curved and twisted")
    {
        for (const CurvatureMeasure measure : {CurvatureMeasure::Angle, CurvatureMeasure::Tangent})
            for (const Nature nature : {Nature::Straight, Nature::Curved})
                for (unsigned seed = 1; seed <= 4; ++seed) {
                    OneWire wire = random_wire(7, seed, nature, measure);
                    const auto sets = clamp_sets(wire);
                    for (std::size_t k = 0; k < sets.size(); ++k)
                        for (const double size : {1e-9, 1e-3, 0.1, 0.3}) {
                            CAPTURE(k);
                            CAPTURE(seed);
                            CAPTURE(size);
                            wire.clamps = sets[k];
                            const Step step(wire, size, 10 * seed);
                            // rounding of energies of order 10 and of forces times moves
                            CHECK(std::abs(step.force.dot(step.change) - step.energy) < 1e-13 * (10 + step.force.norm()));
                            if (size >= 0.1) REQUIRE(std::abs(step.energy) > 1e-3);
                        }
                }
    }

    // E differs from its chord by the third derivative: the mean of the end forces by h^2/12 of it, so both agree to second order
    TEST_CASE("property: it is the elastic force, to second order at the middle of the step")
    {
        for (const Nature nature : {Nature::Straight, Nature::Curved}) {
            double error[2];
            for (int k : {0, 1}) {
                OneWire wire = random_wire(7, 3, nature, CurvatureMeasure::Angle);
                wire.clamps = {random_clamp(wire, 6, true, true, 1), random_clamp(wire, 0, true, false, 3)};
                const Step step(wire, k == 0 ? 2e-3 : 1e-3, 5);
                OwnedTrial middle(wire.rod);
                for (int q = 0; q < RodDofs::count(wire.rod.n) - 1; ++q) middle[q] += 0.5 * step.change[q];
                REQUIRE(wire.accept(middle));
                REQUIRE(wire.update());
                error[k] = (step.force - wire.gradient()).norm() / wire.gradient().norm();
            }
            CAPTURE(error[1]);
            CHECK(error[1] < 1e-4);
            CHECK(std::log2(error[0] / error[1]) == about(2).epsilon(0.05));
        }
    }

    TEST_CASE("property: no net force on a free wire, and no net moment about the mean positions but what spins take up")
    {
        for (const Nature nature : {Nature::Straight, Nature::Curved})
            for (const double size : {1e-3, 0.3}) {
                CAPTURE(size);
                OneWire wire = random_wire(7, 2, nature, CurvatureMeasure::Angle);
                if (nature == Nature::Straight)  // and not twisted: no torque anywhere
                    std::fill(wire.rod.twist_stiffness.begin(), wire.rod.twist_stiffness.end(), 0.0);
                const Step step(wire, size, 9);
                Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
                for (int i = 0; i < wire.rod.n; ++i) {
                    const Vec3 f = to_vec3(step.force.segment<3>(RodDofs::position(i))),
                               moved = to_vec3(step.change.segment<3>(RodDofs::position(i)));
                    force += f;
                    moment += (wire.rod.pos(i) + 0.5 * moved).cross(f);
                    if (i < wire.rod.n - 1) {
                        const Vec3 mean = 0.5 * (step.before.tangent[i] + wire.frames.tangent[i]);
                        moment += step.force[RodDofs::spin(i)] * mean.normalized();
                    }
                }
                CHECK(force.norm() < 1e-14 * step.force.norm() * wire.rod.n);
                // directors: the moment times an edge's change of length, relative, and what tan(turn/2) differs from turn/2 by
                const double allowed = nature == Nature::Straight ? 1e-14 : size * size + 0.5 * size * size;
                CHECK(moment.norm() < 8 * allowed * step.force.norm());
            }
    }
}

}  // namespace seldinger::test::test_discrete_gradient

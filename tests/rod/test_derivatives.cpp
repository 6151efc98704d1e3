// Gradient and Hessian of D1-D3 against central differences, everywhere a wire can be.

#include "math/eigen.h"
#include "rod/rod_fixture.h"

namespace seldinger::test::test_derivatives {

namespace {

// Lengths, stiffnesses and angles of order 1, so that finite differences lose few digits.
struct Shape {
    std::string name;
    double turning;   // largest turning angle between edges [rad]
    double smallest;  // smallest
    double angles;    // theta is drawn from [-angles, angles] [rad]
    bool rest;        // natural curvature and twist
    double stretch;   // edges are drawn within 1 +- stretch of their rest length
    double step;      // of the finite differences: near a fold the energy varies over the distance to it
};

const Shape shapes[] = {
    {"straight", 0, 0, 0, false, 0, 1e-3},
    {"straight, stretched and twisted", 0, 0, 2, false, 0.2, 1e-3},
    {"nearly straight", 1e-6, 0, 1e-6, false, 1e-6, 1e-3},
    {"moderately bent", 0.5, 0, 0.5, false, 0.1, 1e-3},
    {"strongly bent", 2.2, 1.2, 1, false, 0.2, 1e-3},
    {"strongly bent, natural curvature", 2.2, 1.2, 1, true, 0.2, 1e-3},
    {"natural curvature, straightened", 0, 0, 0.5, true, 0.1, 1e-3},
    {"many turns of twist", 0.8, 0.2, 20, true, 0.1, 1e-3},
    {"nearly folded", 3.1, 3.0, 1, true, 0.1, 2e-5},
};

/// A wire of random stiffness whose accepted state has the asked-for shape.
OneWire random_wire(const Shape& shape, int n, unsigned seed, CurvatureMeasure measure = CurvatureMeasure::Angle)
{
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> sign(-1, 1), positive(0.7, 1.5);
    OneWire wire(n);
    wire.rod.curvature = measure;
    std::vector<Vec3> nodes{Vec3(0.3, -0.2, 0.1)};
    Vec3 t = random_unit(rng);
    for (int i = 1; i < n; ++i) {
        nodes.push_back(nodes.back() + positive(rng) * t);
        const Vec3 axis = unit_normal(random_unit(rng), t);
        t = turned(t, axis, shape.smallest + (shape.turning - shape.smallest) * std::abs(sign(rng)));
    }
    wire.place(nodes, random_unit(rng));
    const RodView& rod = wire.rod;
    for (int i = 0; i < n; ++i) {
        if (i < n - 1) {
            rod.rest_length[i] = (nodes[i + 1] - nodes[i]).norm() / (1 + shape.stretch * sign(rng));
            rod.theta[i] = shape.angles * sign(rng);
        }
        rod.stretch_stiffness[i] = 3 * positive(rng);
        rod.bend_stiffness[i] = positive(rng);
        rod.twist_stiffness[i] = 0.8 * positive(rng);
        rod.rest_kappa1[i] = shape.rest ? 0.7 * sign(rng) : 0;
        rod.rest_kappa2[i] = shape.rest ? 0.7 * sign(rng) : 0;
        rod.rest_twist[i] = shape.rest ? 0.3 * sign(rng) : 0;
    }
    // several full turns must survive as they are
    OwnedTrial trial(rod);
    REQUIRE(wire.accept(trial));
    return wire;
}

/// f(+-h), f(+-2h) -> f'(0), error O(h^4)
template <class F>
auto central(F f, double h) -> decltype(f(h))
{
    const auto a = f(h), b = f(-h), c = f(2 * h), d = f(-2 * h);
    return ((a - b) * (8 / (12 * h)) - (c - d) * (1 / (12 * h)));
}

void check_gradient(OneWire& wire, double step)
{
    REQUIRE(wire.update());
    const Eigen::VectorXd g = wire.gradient();
    const double scale = std::max({1.0, wire.energy(), g.lpNorm<Eigen::Infinity>()});
    for (int q = 0; q < RodDofs::count(wire.rod.n) - 1; ++q) {
        const double numeric = central(
            [&](double h) {
                OwnedTrial trial(wire.rod);
                trial[q] += h;
                return wire.energy_at(trial);
            },
            step);
        CAPTURE(q);
        // truncation (h^4 times a fifth derivative) and rounding (1e-16 E/h) both stay below 1e-8 of the scale
        CHECK(std::abs(numeric - g[q]) < 1e-8 * scale);
    }
}

void check_hessian(OneWire& wire, double step)
{
    REQUIRE(wire.update());
    const Eigen::MatrixXd exact = wire.hessian(HessianMode::Exact);
    const int size = RodDofs::count(wire.rod.n) - 1;
    Eigen::MatrixXd numeric = Eigen::MatrixXd::Zero(size + 1, size + 1);
    for (int q = 0; q < size; ++q)
        numeric.col(q) = central(
            [&](double h) -> Eigen::VectorXd {
                OwnedTrial trial(wire.rod);
                trial[q] += h;
                REQUIRE(wire.update(trial));
                return wire.gradient();
            },
            step);
    const double scale = std::max(1.0, exact.lpNorm<Eigen::Infinity>());
    CHECK((exact - exact.transpose()).lpNorm<Eigen::Infinity>() < 1e-14 * scale);
    // the force's derivative has an unsymmetric part, the torque times the holonomy's curl; the rest is the Hessian
    CHECK((0.5 * (numeric + numeric.transpose()) - exact).lpNorm<Eigen::Infinity>() < 1e-7 * scale);
}

/// Second differences of the energy alone: no force formula is trusted.
void check_hessian_from_energy(OneWire& wire, double step)
{
    REQUIRE(wire.update());
    const Eigen::MatrixXd exact = wire.hessian(HessianMode::Exact);
    const double scale = std::max({1.0, exact.lpNorm<Eigen::Infinity>(), wire.energy()});
    const int size = RodDofs::count(wire.rod.n) - 1;
    int compared = 0;
    for (int a = 0; a < size; ++a)
        for (int b = a; b <= std::min(a + 10, size - 1); ++b) {
            const double numeric = central(
                [&](double ha) {
                    return central(
                        [&](double hb) {
                            OwnedTrial trial(wire.rod);
                            trial[a] += ha;
                            trial[b] += hb;
                            return wire.energy_at(trial);
                        },
                        step);
                },
                step);
            CAPTURE(a);
            CAPTURE(b);
            // rounding: 1e-16 E/h^2 = 1e-10 E; truncation h^4 times a sixth derivative
            CHECK(std::abs(numeric - exact(a, b)) < 1e-6 * scale);
            ++compared;
        }
    REQUIRE(compared > RodDofs::count(wire.rod.n));
}

void check_safe(OneWire& wire)
{
    REQUIRE(wire.update());
    const Eigen::MatrixXd safe = wire.hessian(HessianMode::Projected);
    CHECK((safe - safe.transpose()).lpNorm<Eigen::Infinity>() <= 1e-14 * safe.lpNorm<Eigen::Infinity>());
    const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(safe).eigenvalues();
    CHECK(eigenvalues.minCoeff() > -1e-13 * eigenvalues.maxCoeff());  // rounding of the eigenvalues themselves
    CHECK(eigenvalues.maxCoeff() > 0);
}

std::vector<std::vector<RodClamp>> clamp_sets(const OneWire& wire)
{
    const int n = wire.rod.n;
    return {
        {},
        {random_clamp(wire, n - 1, true, true, 1)},
        {random_clamp(wire, n - 1, true, false, 2), random_clamp(wire, 0, true, false, 3)},
        {random_clamp(wire, 0, true, true, 4), random_clamp(wire, n / 2, true, true, 5)},
        {random_clamp(wire, n / 2, true, false, 6), random_clamp(wire, n - 1, false, true, 7)},
        {random_clamp(wire, n / 2, false, true, 8)},
    };
}

}  // namespace

TEST_SUITE("rod/elastic")
{
    TEST_CASE("derivative: gradient and Hessian match central differences on any shape, with any clamps")
    {
        for (const Shape& shape : shapes)
            for (unsigned seed = 1; seed <= 4; ++seed) {
                CAPTURE(shape.name);
                CAPTURE(seed);
                OneWire wire = random_wire(shape, 6, seed, seed < 3 ? CurvatureMeasure::Angle : CurvatureMeasure::Tangent);
                const auto sets = clamp_sets(wire);
                for (std::size_t k = 0; k < sets.size(); ++k) {
                    CAPTURE(k);
                    wire.clamps = sets[k];
                    check_gradient(wire, shape.step);
                    check_hessian(wire, shape.step);
                    check_safe(wire);
                }
            }
    }

    TEST_CASE("derivative: the Hessian is that of the energy, by second differences")
    {
        for (const CurvatureMeasure measure : {CurvatureMeasure::Angle, CurvatureMeasure::Tangent})
            for (const Shape& shape : shapes) {
                if (shape.smallest > 2.5) continue;  // too few digits in second differences near a fold
                CAPTURE(shape.name);
                OneWire wire = random_wire(shape, 5, 11, measure);
                const auto sets = clamp_sets(wire);
                for (const std::size_t k : {std::size_t(0), std::size_t(3), std::size_t(4)}) {
                    CAPTURE(k);
                    wire.clamps = sets[k];
                    check_hessian_from_energy(wire, 4e-3);
                }
            }
    }

    // Away from the accepted state the energy's derivative is the force plus the torque times the spin that transport from
    // the accepted tangent t0 adds: (t x t0).dt/(1 + t0.t) (see add_elastic).
    TEST_CASE("derivative: at a trial away from the accepted state force and energy differ by torque times holonomy")
    {
        OneWire wire = random_wire(shapes[5], 6, 21);
        wire.clamps = {random_clamp(wire, 5, true, true, 1)};
        OwnedTrial away(wire.rod);
        std::mt19937 rng(5);
        std::uniform_real_distribution<double> move(-0.3, 0.3);
        for (int q = 0; q < RodDofs::count(wire.rod.n) - 1; ++q) away[q] += move(rng);

        REQUIRE(wire.update(away));
        Eigen::VectorXd g = wire.gradient();
        const double scale = std::max(1.0, g.lpNorm<Eigen::Infinity>());
        double largest = 0;
        for (int j = 0; j < wire.rod.n - 1; ++j) {
            const Vec3 t0 = wire.rod.tangent(j), t = wire.frames.tangent[j];
            const Vec3 spin = t.cross(t0) / (one_plus_cos(t0, t) * wire.frames.edge_length[j]) * g[RodDofs::spin(j)];
            g.segment<3>(RodDofs::position(j)) -= eigen(spin);
            g.segment<3>(RodDofs::position(j + 1)) += eigen(spin);
            largest = std::max(largest, spin.norm());
        }
        REQUIRE(largest > 1e-2 * scale);  // the term is there to be seen
        for (int q = 0; q < RodDofs::count(wire.rod.n) - 1; ++q) {
            const double numeric = central(
                [&](double h) {
                    OwnedTrial trial = away;
                    trial[q] += h;
                    return wire.energy_at(trial);
                },
                1e-3);
            CAPTURE(q);
            CHECK(std::abs(numeric - g[q]) < 1e-8 * scale);
        }
    }

    TEST_CASE("property: in the rest shape the projected Hessian is exact")
    {
        for (const unsigned k : {0u, 3u, 7u}) {
            OneWire wire = random_wire(shapes[k], 6, 31);
            const RodView& rod = wire.rod;
            REQUIRE(wire.update());
            for (int i = 0; i < rod.n; ++i) {
                rod.rest_kappa1[i] = wire.frames.kappa1[i];
                rod.rest_kappa2[i] = wire.frames.kappa2[i];
                rod.rest_twist[i] = wire.frames.twist[i];
                if (i < rod.n - 1) rod.rest_length[i] = wire.frames.edge_length[i];
            }
            CHECK(wire.energy() < 1e-28);
            const Eigen::MatrixXd exact = wire.hessian(HessianMode::Exact), safe = wire.hessian(HessianMode::Projected);
            CHECK((exact - safe).lpNorm<Eigen::Infinity>() < 1e-12 * exact.lpNorm<Eigen::Infinity>());
        }
    }

    // no outer forces: forces sum to zero, and so do moments, those about the edges included
    TEST_CASE("property: a free wire pulls on itself with no net force and no net moment")
    {
        for (const Shape& shape : shapes) {
            CAPTURE(shape.name);
            OneWire wire = random_wire(shape, 8, 41);
            REQUIRE(wire.update());
            const Eigen::VectorXd g = wire.gradient();
            Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
            for (int i = 0; i < wire.rod.n; ++i) {
                const Vec3 own = to_vec3(g.segment<3>(RodDofs::position(i)));
                force += own;
                moment += wire.rod.pos(i).cross(own);
                if (i < wire.rod.n - 1) moment += g[RodDofs::spin(i)] * wire.rod.tangent(i);
            }
            const double scale = 1 + g.norm() * 8;  // the wire is 8 long
            CHECK(force.norm() < 1e-13 * scale);
            CHECK(moment.norm() < 1e-13 * scale);
        }
    }
}

}  // namespace seldinger::test::test_derivatives

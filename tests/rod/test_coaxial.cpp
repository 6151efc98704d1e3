// Instruments that share a centreline: derivatives against differences, invariance, one instrument against rod/elastic.h,
// offsets.

#include "math/eigen.h"
#include "rod/coaxial_fixture.h"
#include "rod/rod_fixture.h"
#include "support/approx.h"

namespace seldinger::test::test_coaxial {

namespace {

/// Random stiffness and natural curvature in sections [begin, end] of its length, scaled so that all is of order 1.
WireSpec random_spec(std::mt19937& rng, double length, int sections, bool curved)
{
    std::uniform_real_distribution<double> sign(-1, 1), positive(0.5, 1.5);
    WireSpec spec = uniform_spec(length, positive(rng), 0.8 * positive(rng), 4 * positive(rng));
    if (curved) spec.shaft.rest_curvature = {0.4 * sign(rng), 0.4 * sign(rng)};
    for (int i = 0; i < sections; ++i) {
        WireSection section = spec.shaft;
        section.bend_stiffness = positive(rng);
        section.twist_stiffness = 0.8 * positive(rng);
        section.stretch_stiffness = 4 * positive(rng);
        if (curved) section.rest_curvature = {0.6 * sign(rng), 0.6 * sign(rng)};
        spec.sections.push_back({length * i / (2.0 * sections), length * (i + 0.7) / (2.0 * sections), section});
    }
    return spec;
}

/// Bent, stretched and twisted at random; accepted.
void shake(Coaxial& c, unsigned seed, double most)
{
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> sign(-1, 1);
    Eigen::VectorXd step(c.size());
    for (double& value : step) value = most * sign(rng);
    REQUIRE(std::isfinite(c.at(step, nullptr, true)));
    c.base.tangent = (c.base.tangent + Vec3(0, 0.2, -0.1)).normalized();
    c.base.director = unit_normal(Vec3(0.1, 1, 0.4), c.base.tangent);
    REQUIRE(c.update());
    c.take(c.now());
}

/// Two or three instruments of which one ends inside a cell, on edges of about 1 of lengths that differ.
struct Shaken : Coaxial {
    Shaken(int instruments, unsigned seed, double most, bool curved = true)
        : Coaxial(make(instruments, seed, curved), inserted(instruments), 7)
    {
        for (int i = 0; i < n; ++i) line.material_s[i] += 0.2 * std::sin(3.0 * i) * (i > 0);
        prepare_coaxial(rod, line);
        for (int k = 0; k < instruments; ++k) base.behind[k] = k == 1 ? 0.7 : 0, base.hand[k] = 0.4;
        shake(*this, seed, most);
    }
    static std::vector<WireSpec> make(int instruments, unsigned seed, bool curved)
    {
        std::mt19937 rng(seed);
        std::vector<WireSpec> specs;
        for (int k = 0; k < instruments; ++k) specs.push_back(random_spec(rng, 12, 2 + k, curved));
        return specs;
    }
    static std::vector<double> inserted(int instruments)
    {
        std::vector<double> lengths{7.1, 4.83, 5.27};
        lengths.resize(static_cast<std::size_t>(instruments));
        return lengths;
    }
};

double largest(const Eigen::MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

/// Central difference of fourth order.
template <class F>
auto difference(F f, double d)
{
    return ((8 * (f(d) - f(-d)) - (f(2 * d) - f(-2 * d))) / (12 * d));
}

}  // namespace

TEST_SUITE("rod/coaxial")
{
    TEST_CASE("unknowns: two instruments make a half bandwidth of 12, one that of a wire")
    {
        CHECK(CoaxialDofs{1}.half_bandwidth() == RodDofs::half_bandwidth);
        CHECK(CoaxialDofs{2}.half_bandwidth() == 12);
        Shaken c(2, 1, 0.2);
        const Eigen::MatrixXd h = c.dense(HessianMode::Exact);
        for (int i = 0; i < c.size(); ++i)
            for (int j = 0; j < c.size(); ++j)
                if (std::abs(i - j) > 12) CHECK(h(i, j) == 0);
    }

    // d = 1e-3: truncation d^4 times derivatives of order 1..100 = 1e-10, rounding 1e-16 |E| / d = 1e-12
    TEST_CASE("derivative: gradient and Hessian")
    {
        for (const int instruments : {1, 2, 3})
            for (const double most : {1e-7, 0.15, 0.4}) {
                Shaken c(instruments, 10 + instruments, most);
                REQUIRE(c.update());
                const Eigen::VectorXd g = c.assemble(HessianMode::Exact);
                const Eigen::MatrixXd h = c.dense(HessianMode::Exact);
                Eigen::VectorXd numeric_g(c.size()), step = c.zero(), at;
                Eigen::MatrixXd numeric_h(c.size(), c.size());
                const double d = 1e-3;
                for (int q = 0; q < c.size(); ++q) {
                    const auto energy = [&](double by) {
                        step[q] = by;
                        return c.at(step);
                    };
                    const auto gradient = [&](double by) {
                        step[q] = by;
                        (void)c.at(step, &at);
                        return Eigen::VectorXd(at);
                    };
                    numeric_g[q] = difference(energy, d);
                    numeric_h.col(q) =
                        ((8 * (gradient(d) - gradient(-d)) - (gradient(2 * d) - gradient(-2 * d))) / (12 * d)).eval();
                    step[q] = 0;
                }
                const Eigen::MatrixXd symmetric = 0.5 * (numeric_h + numeric_h.transpose());
                CAPTURE(instruments);
                CAPTURE(most);
                CHECK(largest(g - numeric_g) < 1e-8 * largest(g));
                CHECK(largest(h - symmetric) < 1e-8 * largest(h));
            }
    }

    TEST_CASE("property: the projected Hessian is never indefinite")
    {
        for (const int instruments : {1, 2, 3})
            for (unsigned seed = 0; seed < 20; ++seed)
                for (const bool curved : {false, true}) {
                    Shaken c(instruments, seed, 0.4, curved);
                    REQUIRE(c.update());
                    const Eigen::MatrixXd h = c.dense(HessianMode::Projected);
                    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(h).eigenvalues();
                    CHECK(values.minCoeff() > -1e-12 * values.maxCoeff());
                }
    }

    // at rest both Hessians are the same: nothing but Gauss-Newton is left
    TEST_CASE("property: without residual the projected Hessian is exact")
    {
        Coaxial c({instrument_spec(1, 1, 0.8, 0.6, 2)}, {1.0}, 12);
        c.bend_to_rest();
        REQUIRE(c.equilibrate() >= 0);
        REQUIRE(c.energy() < 1e-20);
        const Eigen::MatrixXd exact = c.dense(HessianMode::Exact), safe = c.dense(HessianMode::Projected);
        CHECK(largest(exact - safe) < 1e-8 * largest(exact));
    }

    TEST_CASE("equal: one instrument is a wire")
    {
        for (unsigned seed = 0; seed < 5; ++seed) {
            Shaken c(1, seed, 0.3);
            const int n = c.n;
            c.rod.theta[0][n - 1] = 0.3;  // of the clamp
            REQUIRE(c.update());
            OneWire wire(n);
            const auto from = c.arrays.arrays(0), to = wire.arrays.arrays(0);
            for (std::size_t k = 0; k < from.size(); ++k) std::copy(from[k].begin(), from[k].end(), to[k].begin());
            wire.rod = wire.arrays.view(0);
            set_rest_shape(wire.rod, c.specs[0], false);
            RodClamp clamp{.node = n - 1, .spin = true, .tangent = c.base.tangent, .turns = 0.3};
            clamp.director = turned(c.base.director, c.base.tangent, clamp.turns);
            wire.clamps = {clamp};
            REQUIRE(wire.update());
            CHECK(c.energy() == about(wire.energy()).epsilon(1e-13));
            Eigen::VectorXd g = wire.gradient(), own = c.assemble(HessianMode::Exact);
            Eigen::MatrixXd h = wire.hessian(HessianMode::Exact), own_h = c.dense(HessianMode::Exact);
            const int hub = RodDofs::unused(n);  // the wire's clamp does not move
            g[hub] = own[hub] = 0;
            h.row(hub).setZero(), h.col(hub).setZero(), own_h.row(hub).setZero(), own_h.col(hub).setZero();
            CHECK(largest(g - own) < 1e-13 * largest(g));
            CHECK(largest(h - own_h) < 1e-13 * largest(h));
            const CoaxialHands hands = c.hands();
            CHECK(hands.torque[0] == about(clamp_torque(wire.rod, wire.clamps, wire.frames, 0)).epsilon(1e-12));
            CHECK(hands.push(0, 0, 1) ==
                  about(feed_force(wire.rod, c.specs[0], wire.clamps, wire.frames, Vec3::Zero())).epsilon(1e-12));
        }
    }

    TEST_CASE("property: moving and turning everything costs nothing")
    {
        Shaken c(2, 3, 0.3);
        REQUIRE(c.update());
        const double before = c.energy();
        const Eigen::VectorXd g = c.assemble(HessianMode::None);
        Vec3 sum = Vec3::Zero(), first = Vec3::Zero();  // E depends on differences of positions only
        for (int i = 0; i < c.n; ++i) {
            sum += to_vec3(g.segment<3>(c.rod.dofs().position(i)));
            first = first.cwiseMax(to_vec3(g.segment<3>(c.rod.dofs().position(i))).cwiseAbs());
        }
        CHECK(sum.norm() < 1e-13 * first.norm());
        const Mat3 turn = to_mat3(Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix());
        for (int i = 0; i < c.n; ++i) {
            c.line.set_pos(i, turn * c.line.pos(i) + Vec3(3, 1, -2));
            c.line.set_tangent(i, turn * c.line.tangent(i));
            c.line.set_ref_d1(i, turn * c.line.ref_d1(i));
        }
        c.base.tangent = turn * c.base.tangent;
        c.base.director = turn * c.base.director;
        REQUIRE(c.update());
        CHECK(c.energy() == about(before).epsilon(1e-13));

        // what the angles are counted from is of no account: the frames of edges and clamp turned back, all angles forward
        for (int j = 0; j < c.n - 1; ++j) c.line.set_ref_d1(j, turned(c.line.ref_d1(j), c.line.tangent(j), -0.7));
        c.base.director = turned(c.base.director, c.base.tangent, -0.7);
        for (int k = 0; k < 2; ++k) c.turn(k, 0.7);
        REQUIRE(c.update());
        CHECK(c.energy() == about(before).epsilon(1e-13));
    }

    // Away from where a change passes from one cell to the next; d = 1e-3: truncation 1e-12 times derivatives of order 100
    TEST_CASE("derivative: the hands' forces are the energy's change with what they feed")
    {
        for (const int instruments : {2, 3})
            for (const double most : {0.1, 0.3}) {
                Shaken c(instruments, 20 + instruments, most);
                c.rod.instrument[0].offset = 0.013;  // else its tip would come into the centreline and leave it
                const auto energy = [&] {
                    prepare_coaxial(c.rod, c.line);
                    REQUIRE(c.update());
                    return c.energy();
                };
                (void)energy();
                const CoaxialHands hands = c.hands();
                for (int k = 0; k < instruments; ++k) {
                    const double offset = c.rod.instrument[k].offset;
                    const auto moved = [&](double by) {
                        c.rod.instrument[k].offset = offset + by;
                        return energy();
                    };
                    const double numeric = difference(moved, 1e-3);
                    (void)moved(0);
                    CAPTURE(k);
                    CHECK(hands.offset_force[k] == about(numeric).epsilon(1e-8));
                }
                const double hub = c.line.material_s[c.n - 1];
                const auto longer = [&](double by) {
                    c.line.material_s[c.n - 1] = hub + by;
                    return energy();
                };
                CHECK(hands.line_force == about(difference(longer, 1e-3)).epsilon(1e-8));
                (void)longer(0);
                // the longest goes in and the others stay at the hub
                std::array<double, most_coaxial> offsets{};
                for (int k = 0; k < instruments; ++k) offsets[k] = c.rod.instrument[k].offset;
                const auto pushed = [&](double by) {
                    for (int k = 1; k < instruments; ++k) c.rod.instrument[k].offset = offsets[k] - by;
                    return longer(by);
                };
                CHECK(hands.push(0, 0, instruments) == about(difference(pushed, 1e-3)).epsilon(1e-8));
                CHECK(hands.push(1, 0, instruments) == hands.offset_force[1]);
                (void)pushed(0);

                // torques: at the clamp the derivative, behind it the spring's
                for (int k = 0; k < instruments; ++k) {
                    double& angle = c.base.behind[k] > 0 ? c.base.hand[k] : c.rod.theta[k][c.n - 1];
                    const double start = angle;
                    const auto rolled = [&](double by) {
                        angle = start + by;
                        return energy();
                    };
                    CHECK(hands.torque[k] == about(difference(rolled, 1e-3)).epsilon(1e-8));
                    (void)rolled(0);
                }
            }
    }

    // Every end and change of section passes through cells, edges and nodes, for which energy has no jump: it changes by no more
    // than the force times the step.
    // A push of all hubs by the same length moves the line and no offset.
    TEST_CASE("property: the hands of a group push the line together, of as many instruments as there may be")
    {
        CoaxialHands hands;
        hands.line_force = 10;
        for (int k = 0; k < most_coaxial; ++k) hands.offset_force[k] = k + 1;
        for (int instruments = 1; instruments <= most_coaxial; ++instruments) {
            double all = 0;
            for (int k = 0; k < instruments; ++k) all += hands.push(k, 0, instruments);
            CHECK(all == 10);
        }
    }

    TEST_CASE("property: the energy is continuous in the offsets")
    {
        Shaken c(3, 5, 0.3);
        const double start = c.rod.instrument[1].offset, step = 1e-3;
        double last_energy = 0, last_force = 0, largest_force = 0, worst = 0, smooth = 0;
        int kinks = 0;
        for (int i = 0; i <= 3000; ++i) {
            c.rod.instrument[1].offset = start + i * step;
            prepare_coaxial(c.rod, c.line);
            REQUIRE(c.update());
            const double energy = c.energy(), force = c.hands().offset_force[1];
            if (i > 0) {
                // trapezoidal rule, but for the few steps with a kink
                const double miss = std::abs(energy - last_energy - 0.5 * step * (force + last_force));
                worst = std::max(worst, miss);
                if (miss > 1e-7) ++kinks;
                else smooth = std::max(smooth, miss);
            }
            largest_force = std::max(largest_force, std::abs(force));
            last_energy = energy;
            last_force = force;
        }
        CHECK(worst < step * largest_force);
        CHECK(kinks > 2);
        CHECK(kinks < 150);  // eight ends and changes, each through cells and edges
    }

    TEST_CASE("idle: an angle that an instrument does not reach is of no account, and follows")
    {
        Shaken c(2, 6, 0.3);
        REQUIRE(coaxial_idle(c.rod, 0, 1));
        REQUIRE_FALSE(coaxial_idle(c.rod, c.n - 1, 1));
        for (int j = 0; j < c.n; ++j) CHECK_FALSE(coaxial_idle(c.rod, j, 0));
        REQUIRE(c.update());
        const double before = c.energy();
        c.rod.theta[1][0] += 5;
        REQUIRE(c.update());
        CHECK(c.energy() == before);
        follow_idle(c.rod, c.line);
        int live = 0;
        while (coaxial_idle(c.rod, live, 1)) ++live;
        REQUIRE(live > 0);
        for (int j = 0; j < live; ++j)
            CHECK(std::abs(c.rod.theta[1][j + 1] - c.rod.theta[1][j] + c.line.ref_twist[j + 1]) < 1e-14);
        REQUIRE(c.update());
        CHECK(c.energy() == before);
    }

    TEST_CASE("bad input: no configuration, no energy")
    {
        Shaken c(2, 7, 0.2);
        c.rod.theta[1][2] = std::nan("");
        CHECK_FALSE(c.update());
        c.rod.theta[1][2] = 0;
        REQUIRE(c.update());
        c.line.set_pos(3, c.line.pos(4));  // an edge of no length
        CHECK_FALSE(c.update());
    }
}

}  // namespace seldinger::test::test_coaxial

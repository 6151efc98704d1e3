// engine/physics/contact/valleys: one contact that goes from one facet of a valley to the other, and back over a ridge.

#include "contact/active_set.h"
#include "contact/valleys.h"
#include "math/dof_map.h"
#include "support/approx.h"

#include <array>
#include <cmath>

namespace seldinger::test::test_valleys {

namespace {

constexpr double r = 4e-4, smoothing = 0.002, force = 0.02, tilt = 0.1, bary = 0.3;
constexpr std::uint32_t epoch = 7;

/// A wire of one edge along x with one point, over two planes that meet along x: in a valley (+1) or on a ridge (-1).
class OverPlanes {
public:
    explicit OverPlanes(double sign) : sign_(sign)
    {
        sums_.edges.resize(1);
        sums_.edges[0].contacts = 1;
        sums_.edge_node = {0};
        sums_.wire_edges = {0, 1};
        list_.points = {0};
        list_.edge_first = {0, 1};
    }
    /// The facet's normal on either side of the line.
    [[nodiscard]] Vec3 normal(double y) const
    {
        return {0, y > 0 ? -sign_ * std::sin(tilt) : sign_ * std::sin(tilt), std::cos(tilt)};
    }
    void move_to(double y)
    {
        for (int node = 0; node < 2; ++node) nodes_.set(node, 1e-3 * node, y, height, 0, Vec3::Zero());
        ContactState& state = states_[0];
        state = {};
        const Vec3 n = normal(y);
        for (int k = 0; k < 3; ++k) state.normal[k] = n[k];
        state.gap = n.dot(Vec3(0, y, height)) - r;
        state.normal_force = force;
        state.flags = SEL_CONTACT_ACTIVE;
        state.epoch = epoch;
    }
    KinksPassed passed() { return valleys_.crossed(0, states_, list_, smoothing); }
    double share() { return valleys_.crossed(0, states_, list_, smoothing).share; }
    bool entered() { return valleys_.crossed(0, states_, list_, smoothing).entered; }
    bool crossed() { return share() < 1; }
    Kink kink() { return valleys_.from_base(0, 0).front(); }
    void take() { valleys_.take(0, states_, list_); }
    /// What is admitted: force that is missing where the point is, and stiffness, of the axis point.
    std::pair<Vec3, Mat3> admit()
    {
        sums_.edges[0] = {};
        sums_.edges[0].contacts = 1;
        std::array<double, RodDofs::count(2)> residual{};
        valleys_.admit(0, 0, residual);
        Vec3 missing;
        Mat3 stiffness;
        for (int i = 0; i < 3; ++i) {
            missing[i] = -residual[RodDofs::position(0, i)] - residual[RodDofs::position(1, i)];
            CHECK(residual[RodDofs::position(1, i)] == about(-bary * missing[i]));
            for (int j = 0; j < 3; ++j) stiffness(i, j) = sums_.edges[0].s_ab[3 * i + j] / (bary * (1 - bary));
        }
        const EdgeForce& sum = sums_.edges[0];
        CHECK(sum.s_aa[3] == about((1 - bary) * (1 - bary) * stiffness(1, 1)));  // yy
        CHECK(sum.s_bb[3] == about(bary * bary * stiffness(1, 1)));
        return {missing, stiffness};
    }

private:
    static QuadratureSet one_point()
    {
        QuadratureSet set;
        set.wires.resize(1);
        set.wires[0].capacity = set.wires[0].live = 1;
        set.wires[0].epoch = epoch;
        set.models.resize(1);
        set.models[0].radius = r;
        set.places.push_back({0, 0, bary, bary, epoch, 0, 0});
        return set;
    }

    static constexpr double height = 0.98 * r;
    double sign_;
    device::Context context_;
    QuadratureSet quadrature_ = one_point();
    DeviceNodes nodes_{context_, 2};
    EdgeSums sums_;
    ActiveList list_{context_, 1, 1};
    std::array<ContactState, 2> states_{};
    Valleys valleys_{quadrature_, nodes_, sums_};
};

}  // namespace

TEST_SUITE("contact/valleys")
{
    // The smooth maximum has half of each facet's normal where both are equally deep. Planes are planes: 1e-9 is rounding of
    // positions near 1e-3 m against moves of a micron.
    TEST_CASE("analytic: the direction leads to where the force is half of either facet's")
    {
        OverPlanes point(1);
        point.move_to(3e-6);
        point.take();
        for (const double y : {-1.5e-6, -4e-6, -30e-6}) {
            CAPTURE(y);
            point.move_to(y);
            REQUIRE(point.crossed());
            const auto [missing, stiffness] = point.admit();
            const Vec3 there = force * point.normal(y) + missing - stiffness * Vec3(0, -y, 0);
            CHECK((there - 0.5 * force * (point.normal(1) + point.normal(-1))).norm() < 1e-9);
        }
    }

    // depths differ by 2 sin(tilt) y, and a valley is 2 eps of these wide
    TEST_CASE("analytic: the share of the way at which the valley is crossed, and its width")
    {
        OverPlanes point(1);
        point.move_to(3e-6);
        point.take();
        point.move_to(-9e-6);
        CHECK(point.share() == about(0.25).epsilon(1e-6));
        const double turn = 2 * std::sin(tilt), eps = smoothing * r * (std::hypot(turn, 2 * smoothing) - 2 * smoothing);
        CHECK(point.passed().width == about(2 * eps / (turn * 12e-6)).epsilon(1e-6));
    }

    // z is 0 where the valley begins and 1 where it ends, which is as far beyond the line
    TEST_CASE("analytic: a kink's share of the second facet, as the base sees it")
    {
        constexpr double y = 3e-6;
        OverPlanes point(1);
        point.move_to(y);
        point.take();
        point.move_to(-9e-6);
        REQUIRE(point.crossed());
        const Kink kink = point.kink();
        CHECK(kink.node == 0);
        CHECK(kink.bary == bary);
        CHECK(kink.force == force);
        const double turn = 2 * std::sin(tilt), eps = smoothing * r * (std::hypot(turn, 2 * smoothing) - 2 * smoothing),
                     half = eps / turn;
        const auto share = [&](double to) { return (kink.rest + kink.across.dot(Vec3(0, to - y, 0))) / kink.width; };
        CHECK(std::abs(share(half)) < 1e-6);
        CHECK(share(0) == about(0.5).epsilon(1e-6));
        CHECK(share(-half) == about(1.0).epsilon(1e-6));
    }

    TEST_CASE("property: nothing is missing on one facet, within the smooth maximum, and over a ridge")
    {
        OverPlanes valley(1);
        valley.move_to(3e-6);
        valley.take();
        valley.move_to(1e-6);
        CHECK_FALSE(valley.crossed());
        CHECK_FALSE(valley.entered());
        valley.move_to(-0.9 * smoothing * r);  // it reaches smoothing r to either side
        CHECK_FALSE(valley.crossed());
        CHECK(valley.entered());
        valley.move_to(-1.1 * smoothing * r);
        CHECK(valley.crossed());
        CHECK_FALSE(valley.entered());

        OverPlanes ridge(-1);
        ridge.move_to(3e-6);
        ridge.take();
        ridge.move_to(-4e-6);
        CHECK_FALSE(ridge.crossed());
    }

    TEST_CASE("property: a valley that was admitted is not admitted again from where it has led to")
    {
        OverPlanes point(1);
        point.move_to(3e-6);
        point.take();
        point.move_to(-4e-6);
        REQUIRE(point.crossed());
        (void)point.admit();
        point.take();
        point.move_to(2e-6);  // the balance is on this facet
        CHECK_FALSE(point.crossed());
        point.take();
        point.move_to(-2e-6);
        CHECK(point.crossed());
    }
}

}  // namespace seldinger::test::test_valleys

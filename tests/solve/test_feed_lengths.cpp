// Lengths at the inlet: what is inside is what was fed and the surplus, whatever has to be cut off of either.
#include "solve/feed.h"

#include "solve/wire_fixture.h"

#include <limits>

namespace seldinger::test::test_feed_lengths {

namespace {

constexpr double edge = 0.005;

/// A wire of ten edges inside.
struct Fed {
    RodArrays arrays{std::vector<int>{40}};
    WireSpec wire = nitinol(0.2);
    FeedState state;
    Fed()
    {
        state.edge = edge;
        FeedSpec spec{.direction = Vec3(1, 0, 0), .advance = 10 * edge};
        start_feed(state, spec, wire, arrays, 0);
        REQUIRE(arrays.view(0).n == 11);
    }
    [[nodiscard]] double inside()
    {
        const RodView rod = arrays.view(0);
        double sum = 0;
        for (int j = 0; j + 1 < rod.n; ++j) sum += rod.rest_length[j];
        return sum;
    }
    [[nodiscard]] double base() { return arrays.view(0).rest_length[arrays.view(0).n - 2]; }
};

}  // namespace

TEST_SUITE("solve/feed")
{
    TEST_CASE(
        "property: a surplus that is too long for the base edge fades by half of that edge at most, and the rest of it stays")
    {
        constexpr double at_once = std::numeric_limits<double>::infinity();  // from rest to rest all of it would go
        for (const double surplus : {5 * edge, -5 * edge, 0.75 * edge, -0.75 * edge, 0.3 * edge, -0.3 * edge})
            for (const double fed : {0.0, 0.2 * edge, -0.2 * edge}) {
                CAPTURE(surplus / edge);
                CAPTURE(fed / edge);
                Fed wire;
                wire.state.surplus = surplus;
                const double before = wire.inside(), base = wire.base() + fed;
                feed_to(wire.state, {0, wire.state.advance + fed, 0}, wire.wire, wire.arrays, 0, at_once);
                const double faded = std::min(std::abs(surplus), 0.5 * base);
                CHECK(std::abs(wire.state.surplus) == about(std::abs(surplus) - faded).epsilon(1e-12).scale(1e-3 * edge));
                CHECK(wire.base() == about(base - std::copysign(faded, surplus)).epsilon(1e-12));
                CHECK(wire.state.grown == about(wire.base() - (base - fed)).epsilon(1e-9).scale(1e-3 * edge));
                // what came in is what was fed and what the surplus has changed by
                CHECK(std::abs(wire.inside() - before - fed - (wire.state.surplus - surplus)) < 1e-15);
            }
    }

    TEST_CASE("property: no more is pulled out than nine tenths of the base edge; what was asked for beyond that is surplus")
    {
        Fed wire;
        const double before = wire.inside();
        feed_to(wire.state, {0, wire.state.advance - 1.5 * edge, 0}, wire.wire, wire.arrays, 0, 1.0);
        CHECK(wire.base() == about(0.1 * edge).epsilon(1e-9));
        CHECK(wire.state.surplus == about(0.6 * edge).epsilon(1e-9));
        CHECK(std::abs(wire.inside() - before + 1.5 * edge - wire.state.surplus) < 1e-15);
    }

    // s'' + 2 w s' + w^2 s = 0, critically damped: s = (s0 + (s0' + w s0) t) exp(-w t), w = 1/25 ms + v/h
    TEST_CASE("analytic: a surplus fades as a critically damped oscillator, in any number of steps")
    {
        for (const double speed : {0.0, 0.1}) {
            Fed one, many;
            for (Fed* wire : {&one, &many}) {
                wire->state.surplus = 0.1 * edge;
                wire->state.surplus_rate = 0.02;
                wire->state.speed = speed;
            }
            const double t = 0.03, w = 1 / 0.025 + speed / edge, s0 = 0.1 * edge, v0 = 0.02;
            double added = fade_surplus(one.state, t), of_many = 0;
            for (int k = 0; k < 30; ++k) of_many += fade_surplus(many.state, t / 30);
            const double left = std::exp(-w * t), expected = (s0 + (v0 + w * s0) * t) * left,
                         rate = (v0 - w * (v0 + w * s0) * t) * left;
            for (const Fed* wire : {&one, &many}) {
                CHECK(wire->state.surplus == about(expected).epsilon(1e-12));
                CHECK(wire->state.surplus_rate == about(rate).epsilon(1e-12));
            }
            CHECK(added == about(expected - s0).epsilon(1e-12));
            CHECK(of_many == about(added).epsilon(1e-11));
        }
    }

    // theta turns about the tangent from tip to hub, which points against the feed: a turn of the hub by +a is -a of the wire's
    // angles
    TEST_CASE("property: a wire that starts inside is even, at rest, and turned as its hub is")
    {
        RodArrays arrays(std::vector<int>{40});
        FeedState state;
        state.edge = edge;
        FeedSpec spec{.point = Vec3(0.1, 0.2, 0.3), .direction = Vec3(0, 2, 0), .advance = 7.4 * edge};
        spec.turn = 7.3;  // more than a turn
        const WireSpec wire = nitinol(0.2);
        start_feed(state, spec, wire, arrays, 0);
        const RodView rod = arrays.view(0);
        REQUIRE(rod.n == 8);  // seven edges are nearer than eight
        for (int i = 0; i < rod.n; ++i) {
            CHECK((rod.pos(i) - Vec3(0.1, 0.2 + spec.advance * (1 - i / 7.0), 0.3)).norm() < 1e-16);
            CHECK(rod.vel(i) == Vec3::Zero());
        }
        for (int j = 0; j + 1 < rod.n; ++j) {
            CHECK(rod.rest_length[j] == about(spec.advance / 7).epsilon(1e-12));
            CHECK(rod.theta[j] == -7.3);
        }
        WireConstraints inlet;
        add_feed_constraints(state, rod, inlet);
        REQUIRE(inlet.clamps.size() == 1);
        RodFrames frames(40);
        REQUIRE(update_frames(rod, {rod.x, rod.y, rod.z, rod.theta}, inlet.clamps, frames));
        CHECK(elastic_energy(rod, inlet.clamps, frames) < 1e-20);  // of rounded chords and angles: nothing is bent or twisted
    }
}

}  // namespace seldinger::test::test_feed_lengths

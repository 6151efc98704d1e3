// Two wires that cross, a third one away from them: what is read of the contact, on either wire, is where they cross and what
// they bear.
#include "contact/instrument_fixture.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_wires_that_cross {

namespace {

constexpr double radius = 2e-4, overlap = 1e-5, from_tip[] = {0.026, 0.03};  // of the first wire, of the last

/// The last wire lies over the first one, both held at their ends. The middle one touches nothing.
WorldSetup crossed()
{
    WireSetup a = straight_wire(5e-5, 7000, 0.06, radius, 41, 1e9), away = a,
              b = straight_wire(5e-5, 7000, 0.05, radius, 36, 1e9);
    put(a, {-0.03, 0, 0}, Vec3::UnitX());
    put(away, {-0.03, 0, 0.1}, Vec3::UnitX());
    put(b, {0.03 - from_tip[0], from_tip[1] - 0.05, 2 * radius - overlap}, Vec3::UnitY());
    for (WireSetup* wire : {&a, &away, &b})
        wire->holds = {hold_of(WirePoint::Kind::Base, true, true), hold_of(WirePoint::Kind::Tip, false)};
    return touching({a, away, b});
}

}  // namespace

TEST_SUITE("contact/instruments")
{
    TEST_CASE("property: both wires bear one force where they cross, and their readings say so")
    {
        World world(crossed());
        REQUIRE_FALSE(step(world, 1e-2).failed());
        const Vec3 on_a = contact_force(world, 0), on_b = contact_force(world, 2);
        REQUIRE(on_a.z() < -1e-5);
        CHECK((on_a + on_b).norm() < 1e-12 * on_a.norm());
        CHECK(std::hypot(on_a.x(), on_a.y()) < 0.01 * on_a.norm());
        CHECK(contact_force(world, 1) == Vec3::Zero());

        const Output out = world.output(Output::Contacts);
        double sum = 0, deepest = 0;
        for (const ContactRow& row : out.contacts) {
            REQUIRE(row.a.body == 0);
            REQUIRE(row.b.body == 2);
            sum += row.normal_force;
            deepest = std::max(deepest, -row.gap);
            // as wide as the lens of two circles that overlap by so much
            CHECK(row.area == about(2 * std::sqrt(-row.gap * (radius + row.gap / 4)) * row.length).epsilon(1e-9));
            CHECK(std::abs(row.along_a - from_tip[0]) < 2 * radius);
            CHECK(std::abs(row.along_b - from_tip[1]) < 2 * radius);
            CHECK(row.gap < 0);
            CHECK(row.gap > -overlap);
            CHECK((row.normal - Vec3(0, 0, -1)).norm() < 0.05);  // towards a
            CHECK((row.point - Vec3(0.03 - from_tip[0], 0, radius)).norm() < 2 * radius);
        }
        REQUIRE(!out.contacts.empty());
        CHECK(sum == about(on_a.norm()).epsilon(1e-3));  // of normals that lean by a hundredth
        for (const unsigned parts : {unsigned{Output::Contacts}, unsigned{Output::Loads}}) {
            const Output read = world.output(parts);
            for (const int k : {0, 1}) {
                const ContactAlong& along = read.wires[k == 0 ? 0 : 2].on_instruments;
                CHECK(along.patch_force == about(sum).epsilon(1e-9));
                CHECK(std::abs(along.patch_at - from_tip[k]) <= 0.5 * along.patch + 2 * radius);
                CHECK(along.per_length_max * along.window ==
                      about(sum).epsilon(0.2));  // the place is as long as a window or shorter
                CHECK(read.wires[k == 0 ? 0 : 2].readings.normal_between == about(sum).epsilon(1e-9));
                CHECK(read.wires[k == 0 ? 0 : 2].readings.overlap == about(deepest).epsilon(1e-9));
                CHECK(read.wires[k == 0 ? 0 : 2].on_wall.patch_force == 0);
            }
            CHECK(read.wires[1].on_instruments.patch_force == 0);
        }
    }
}

}  // namespace seldinger::test::test_wires_that_cross

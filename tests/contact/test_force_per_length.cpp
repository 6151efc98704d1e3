// Force per length, force on a patch and places in contact: closed forms, and that samples may lie where they like.
#include "contact/force_per_length.h"

#include "support/approx.h"
#include "support/world_fixture.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace seldinger::test::test_force_per_length {

namespace {

constexpr double window = 0.9e-3;  // [m]

/// Samples of `spacing`, the first one's middle at `first`, each with what `load` [N/m] has on its stretch (midpoint rule, fine).
template <class Load>
std::vector<LoadSample> sampled(double first, double spacing, double end, Load load)
{
    std::vector<LoadSample> samples;
    for (double s = first; s + spacing / 2 <= end + 1e-12; s += spacing) {
        double force = 0;
        constexpr int parts = 64;
        for (int k = 0; k < parts; ++k) force += load(s - spacing / 2 + (k + 0.5) * spacing / parts) * spacing / parts;
        if (force > 0) samples.push_back({s, spacing, force});
    }
    return samples;
}

double integral(const LoadAlong& load, double width, double from, double to)
{
    constexpr int parts = 20000;
    double sum = 0;
    for (int k = 0; k < parts; ++k) sum += load.per_length(from + (k + 0.5) * (to - from) / parts, width) * (to - from) / parts;
    return sum;
}

}  // namespace

TEST_SUITE("contact/force_per_length")
{
    TEST_CASE("analytic: an even load reads the same at any sampling, and in the middle at any place")
    {
        constexpr double q = 3.7;
        for (const double spacing : {0.05e-3, 0.111e-3, 0.3e-3, 0.45e-3})
            for (const double shift : {0.5, 0.1, 0.9}) {
                CAPTURE(spacing);
                const std::vector<LoadSample> samples =
                    sampled(shift * spacing + spacing, spacing, 0.02, [](double) { return q; });
                const LoadAlong load(samples);
                CHECK(load.most_on(window).value / window == test::about(q).epsilon(1e-12));
                CHECK(load.most_on(5e-3).value == test::about(5e-3 * q).epsilon(1e-12));
                for (const double s : {0.005, 0.00777, 0.0123})
                    CHECK(load.per_length(s, window) == test::about(q).epsilon(1e-12));
                // half of the window hangs over where the load begins
                const double begin = samples.front().s - samples.front().length / 2;
                CHECK(load.per_length(begin, window) == test::about(q / 2).epsilon(1e-12));
                CHECK(contact_regions(samples, window).size() == 1);
            }
    }

    TEST_CASE("analytic: a force at one place, on one sample, between two, or on the tip itself, is F/W")
    {
        constexpr double force = 0.2;
        const double length = window / 2;  // as far apart as samples may be for this window
        for (const double share : {0.0, 0.3, 0.5}) {
            const std::vector<LoadSample> two = {{0.01, length, (1 - share) * force}, {0.01 + length, length, share * force}};
            const LoadAlong load(two);
            CHECK(load.most_on(window).value / window == test::about(force / window).epsilon(1e-12));
            CHECK(load.most_on(5e-3).value == test::about(force).epsilon(1e-12));
        }
        const std::vector<LoadSample> tip = {{0, 0, force}};
        const LoadAlong load(tip);
        CHECK(load.most_on(window).value == force);
        CHECK(load.per_length(0, window) == test::about(force / window));
        CHECK(load.per_length(window, window) == 0);
        CHECK(load.on(-1, 1) == force);
        CHECK(load.on(0, 0) == force);  // closed on both sides
    }

    TEST_CASE("property: the reading's integral is the sum of the forces, whatever the samples are")
    {
        std::vector<LoadSample> samples = {{0, 0, 0.013}};
        double total = 0.013;
        for (int k = 0; k < 40; ++k) {
            const double length = 1e-4 * (1 + k % 5), force = 1e-3 * (1 + (7 * k) % 11);
            samples.push_back({3e-4 * k + 2e-4 * std::sin(k), length, force});
            total += force;
        }
        const LoadAlong load(samples);
        CHECK(load.on(-1, 1) == test::about(total).epsilon(1e-12));
        // 20,000 midpoints over 22 mm, q jumps at the tip's point only: within one part of it, 1.1 um of 0.013 N / 0.9 mm
        CHECK(integral(load, window, -5e-3, 17e-3) == test::about(total).epsilon(1e-3));
        CHECK(integral(load, 3.1e-3, -5e-3, 17e-3) == test::about(total).epsilon(1e-3));
    }

    TEST_CASE("property: the most on a stretch is not less than any stretch that one tries")
    {
        std::vector<LoadSample> samples;
        for (int k = 0; k < 30; ++k) samples.push_back({4e-4 * k, 3e-4, 1e-3 * (1 + (13 * k) % 17)});
        const LoadAlong load(samples);
        for (const double length : {window, 2.345e-3, 5e-3}) {
            const LoadAlong::Place most = load.most_on(length);
            CHECK(load.on(most.at - length / 2, most.at + length / 2) == test::about(most.value).epsilon(1e-9));
            double tried = 0;
            for (int k = -500; k < 2000; ++k) tried = std::max(tried, load.on(1e-5 * k, 1e-5 * k + length));
            CHECK(most.value >= tried - 1e-15);
            CHECK(most.value <= 1.02 * tried);  // 10 um of steep sides: it is not made up either
        }
    }

    TEST_CASE("analytic: two places near one another")
    {
        const auto pair = [](double apart) {
            return std::vector<LoadSample>{{0.01, 1e-4, 0.1}, {0.01 + apart + 1e-4, 1e-4, 0.06}};
        };
        // nearer than a window: one place, and one reading of both where one window holds them
        CHECK(contact_regions(pair(0.5 * window), window).size() == 1);
        CHECK(LoadAlong(pair(0.5 * window)).most_on(window).value == test::about(0.16).epsilon(1e-12));
        // farther: two, and the greater counts
        CHECK(contact_regions(pair(1.1 * window), window).size() == 2);
        CHECK(LoadAlong(pair(1.1 * window)).most_on(window).value == test::about(0.1).epsilon(1e-12));
        CHECK(LoadAlong(pair(1.1 * window)).most_on(5e-3).value == test::about(0.16).epsilon(1e-12));
    }

    TEST_CASE("regression: samples too far apart for the window widen it, and it is said")
    {
        std::vector<ContactRow> rows(2);
        for (int k = 0; k < 2; ++k) {
            rows[k].a = {BodyKind::Rod, 0, k};
            rows[k].along_a = 0.01 + 0.003 * k;
            rows[k].length = 0.003;
            rows[k].normal_force = 0.1;
        }
        std::vector<ContactAlong> wall(1), others(1);
        read_along(rows, std::vector<AlongSpec>{{window, 5e-3, 0.003}}, wall, others);
        CHECK(wall[0].widened);
        CHECK(wall[0].window == test::about(0.006));
        CHECK(wall[0].per_length_max == test::about(0.2 / 0.006));  // a force between the two: F over the window that it has
        CHECK(rows[0].region == 1);
        CHECK(rows[1].region == 1);
        read_along(rows, std::vector<AlongSpec>{{window, 5e-3, window / 2}}, wall, others);
        CHECK_FALSE(wall[0].widened);
        CHECK(others[0].regions == 0);
    }

    // 0.1 N on 2e-6 m^2 over 2 mm at one place, in 1, 8 and 32 samples: each sample alone has anything between
    TEST_CASE("analytic: pressure is load over area of the same window, however contact is divided into samples")
    {
        for (const int count : {1, 8, 32}) {
            CAPTURE(count);
            std::vector<ContactRow> rows(static_cast<std::size_t>(count));
            const double length = 2e-3 / count;
            for (int k = 0; k < count; ++k) {
                rows[k].a = {BodyKind::Rod, 0, k};
                rows[k].along_a = 0.01 + (k + 0.5) * length;
                rows[k].length = length;
                rows[k].area = 2e-6 / count;
                rows[k].normal_force = count == 1 ? 0.1 : k % 2 == 0 ? 0.2 / count : 0.0;  // every other one bears all
            }
            std::vector<ContactAlong> wall(1), others(1);
            read_along(rows, std::vector<AlongSpec>{{1e-3, 5e-3, 0}}, wall, others);
            const double even = 0.1 / 2e-6;  // [Pa]
            // a window of half the place is off by one sample at most
            for (const ContactRow& row : rows)
                if (std::abs(row.along_a - 0.011) < 0.4e-3)
                    CHECK(row.pressure == test::about(even).epsilon(count == 1 ? 1e-12 : 2.0 / count));
        }
        std::vector<ContactRow> layer(1);
        layer[0].a = {BodyKind::Rod, 0, 0};
        layer[0].normal_force = 0.1;  // a pair of `layer` has no area
        std::vector<ContactAlong> wall(1), others(1);
        read_along(layer, std::vector<AlongSpec>{{window, 5e-3, 0}}, wall, others);
        CHECK(layer[0].pressure == 0);
    }

    TEST_CASE("analytic: rows between instruments count on both of them")
    {
        ContactRow row{.a = {BodyKind::Rod, 1, 0}, .b = {BodyKind::Rod, 0, 0}};
        row.along_a = 0.02, row.along_b = 0.05, row.length = 1e-4, row.normal_force = 0.3;
        std::vector<ContactRow> rows = {row};
        std::vector<ContactAlong> wall(2), others(2);
        read_along(rows, std::vector<AlongSpec>{{window, 5e-3, 0}, {2 * window, 5e-3, 0}}, wall, others);
        CHECK(others[0].per_length_max == test::about(0.3 / window));
        CHECK(others[1].per_length_max == test::about(0.15 / window));
        CHECK(std::abs(others[0].per_length_at - 0.05) <= window / 2);  // anywhere that the window holds it
        CHECK(wall[0].regions + wall[1].regions == 0);
        CHECK(rows[0].per_length == test::about(0.15 / window));  // of body a
    }

    TEST_CASE("analytic: a wire that its weight presses on a flat wall reads its weight per length, however it is divided")
    {
        constexpr double r = 0.5e-3;
        const double load = std::numbers::pi * r * r * 7900 * 9.81;
        for (const int nodes : {21, 41})
            for (const int samples_per_edge : {4, 8, 16, 32}) {
                CAPTURE(nodes);
                CAPTURE(samples_per_edge);
                test::TestSetup setup;
                setup.integrator.scheme = Scheme::Static;
                test::add_plane(setup, 0.2, 200);
                WireSpec spec = test::steel_wire(0.04, nodes);
                spec.shaft.radius = r;
                spec.shaft.density = 7900;
                setup.wires = {test::placed_wire(spec, {-0.02, 0, r})};
                setup.wires[0].contact.samples_per_edge = samples_per_edge;
                World world(setup);
                REQUIRE_FALSE(settle(world).failed());
                const ContactAlong read = world.output(Output::Contacts).wires[0].on_wall;
                // A free end on a bed: it sinks by less than 1 % elsewhere (the tip's point law bears some of the load beside it)
                CHECK(read.per_length_max == test::about(load).epsilon(0.02));
                CHECK(read.patch_force == test::about(5e-3 * load).epsilon(0.02));
                CHECK(read.regions == 1);
                CHECK(read.extent == test::about(0.04).epsilon(1e-9));
                CHECK(read.widened == (2 * 0.04 / (nodes - 1) / samples_per_edge > 1.01 * 2 * r));
            }
    }

    TEST_CASE("regression: a tip that touches has the length that its force is spread over")
    {
        std::vector<ContactRow> rows(1);
        rows[0].b.kind = BodyKind::Wall;
        rows[0].along_a = 0, rows[0].length = 0, rows[0].normal_force = 0.06;  // the tip's own law: a point
        const AlongSpec spec{window, 5e-3, 0};
        ContactAlong wall, instruments;
        read_along(rows, {&spec, 1}, {&wall, 1}, {&instruments, 1});
        CHECK(wall.per_length_max == test::about(0.06 / window));
        CHECK(wall.extent == test::about(window));
        // beside a stretch that touches, the stretch's own length is known
        rows.push_back(rows[0]);
        rows[1].along_a = 1e-3, rows[1].length = 2e-3;
        read_along(rows, {&spec, 1}, {&wall, 1}, {&instruments, 1});
        CHECK(wall.regions == 1);
        CHECK(wall.extent == test::about(2e-3));
    }
}

}  // namespace seldinger::test::test_force_per_length

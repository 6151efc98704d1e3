// What `seldinger bench` divides by: the measured roofs, and the work it counts.

#include "roofline/kernel_bench.h"
#include "roofline/peaks.h"
#include "support/approx.h"

#include <algorithm>
#include <limits>
#include <set>

namespace seldinger::test::test_peaks {

TEST_SUITE("device/peaks")
{
    TEST_CASE("property: vectors are no slower than one number at a time, cache no slower than a chain of launches")
    {
        device::Context context;
        const device::Peaks peaks = device::measure_peaks(context, device::Queue::Inline, 1, 3);
        CHECK(peaks.flops_float >= peaks.scalar_float);
        CHECK(peaks.flops_double >= peaks.scalar_double);
        CHECK(peaks.scalar_double > 0);
        CHECK(peaks.bandwidth > 0);
        CHECK(peaks.launch > 0);
        CHECK(peaks.queue == "light");
        device::Context single(-1, true);
        CHECK(device::measure_peaks(single, device::Queue::Pool, 1, 3).flops_double == 0);
    }

    TEST_CASE("property: median_time gives the middle of its timings, and repeats a short call until it lasts long enough")
    {
        long calls = 0;
        const auto count = [&] { ++calls; };
        // no time is too short: one call that compiles, one for each of the three
        CHECK(device::median_time(count, 3, 0) >= 0);
        CHECK(calls == 1 + 3);
        // every time is: a hundred times as many calls in each turn, up to a million for each of the three
        calls = 0;
        CHECK(device::median_time(count, 3, std::numeric_limits<double>::infinity()) > 0);
        CHECK(calls == 1 + (1 + 100 + 10000) + 3 * 1000000);
    }

    // The load is a tube of 30,000 triangles with edges of some 1.2 mm. A quadrature point of the wire sees 0.67 mm round its
    // axis and lies 0.44 mm above the wall: it sees a disc of 0.5 mm round its foot.
    TEST_CASE("property: the counted work is that of the load")
    {
        device::Context context;
        const auto wall = kernel_bench::make_bench_wall(context);
        CHECK(wall.triangles > 28000);
        CHECK(wall.triangles < 32000);
        const auto work = kernel_bench::count_work(wall, 300);
        std::set<std::string> names;
        for (const auto& w : work) {
            CAPTURE(w.kernel);
            names.insert(w.kernel);
            CHECK(w.flops > 0);
            CHECK(w.pairs > 0);
        }
        CHECK(names.size() == 10);
        const auto of = [&](const char* kernel) {
            return *std::find_if(work.begin(), work.end(), [&](const auto& w) { return w.kernel == kernel; });
        };
        // every quadrature point has cells, here leaves. One that remembers the wall near it reads none of their boxes: kept
        // triangles (nine floats each), the nearest and at least one that may be
        CHECK(of("contact_evaluate").pairs > 1);
        CHECK(of("contact_evaluate").pairs < 24);
        CHECK(of("contact_evaluate").pairs == of("contact_find").pairs);
        CHECK(of("contact_evaluate").floats > 2 * 9);
        // a closest point on a triangle is 40 to 120 operations, a box some 12
        CHECK(of("contact_find").flops > 40 + 8 * of("contact_find").pairs);
        CHECK(of("contact_reduce").pairs == test::about(5));  // quadrature points on an edge
        // twice as many wires: the same work an item, but for where they lie
        const auto more = kernel_bench::count_work(wall, 3000);
        CHECK(more[2].flops == test::about(of("contact_evaluate").flops).epsilon(0.5));
    }
}

}  // namespace seldinger::test::test_peaks

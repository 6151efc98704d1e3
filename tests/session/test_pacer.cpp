// Pacing against a clock that the test turns, quantiles of times, and the buffers between threads.

#include "session/byte_ring.h"
#include "session/pacer.h"
#include "session/time_histogram.h"
#include "session/triple_buffer.h"
#include "support/approx.h"

#include <atomic>
#include <thread>

namespace seldinger::test::test_pacer {

TEST_SUITE("session/pacer")
{
    TEST_CASE("property: steps in time stay on the grid, whatever each took")
    {
        Pacer pacer(1e-3);
        pacer.start(5.0);
        for (int k = 0; k < 1000; ++k) {
            CHECK(pacer.due() == test::about(5.0 + 1e-3 * k).epsilon(1e-13));
            CHECK_FALSE(pacer.finished(pacer.due() + (k % 2 ? 0.9e-3 : 0.1e-3)));
        }
        CHECK(pacer.late() == 0);
        CHECK(pacer.stretched() == 0);
    }

    TEST_CASE("property: a late step stretches time by what it was late, and no step follows faster for it")
    {
        Pacer pacer(1e-3);
        pacer.start(0);
        CHECK_FALSE(pacer.finished(0.5e-3));
        CHECK(pacer.finished(4.5e-3));  // was to be over at 2 ms
        CHECK(pacer.stretched() == test::about(2.5e-3).epsilon(1e-12));
        CHECK(pacer.due() == 4.5e-3);
        CHECK_FALSE(pacer.finished(5.0e-3));
        CHECK(pacer.due() == test::about(5.5e-3).epsilon(1e-12));  // a whole period after the one before
        CHECK(pacer.late() == 1);
        CHECK(pacer.steps() == 3);
    }

    TEST_CASE("property: a scene that takes twice the time runs at half of real time and says so")
    {
        Pacer pacer(1e-3);
        pacer.start(0);
        double now = 0;
        for (int k = 0; k < 500; ++k) {
            now = std::max(now, pacer.due()) + 2e-3;
            CHECK(pacer.finished(now));
        }
        CHECK(now == test::about(1.0).epsilon(1e-12));
        CHECK(pacer.stretched() == test::about(0.5).epsilon(1e-12));
    }

    TEST_CASE("property: a late step is the machine's where it took no longer than a period, else its own")
    {
        Pacer pacer(1e-3);
        pacer.start(0);
        pacer.begin(0.9e-3);
        CHECK(pacer.finished(1.4e-3));  // half a millisecond, begun 0.9 ms late
        CHECK(pacer.woken_late() == 1);
        pacer.begin(pacer.due());
        CHECK(pacer.finished(pacer.due() + 1.2e-3));
        CHECK(pacer.woken_late() == 1);
        pacer.begin(pacer.due() + 0.2e-3);
        CHECK_FALSE(pacer.finished(pacer.due() + 0.9e-3));  // begun late, and in time all the same
        CHECK(pacer.late() == 2);
        CHECK(pacer.woken_late() == 1);
    }

    TEST_CASE("property: a pause is neither late nor stretched")
    {
        Pacer pacer(1e-3);
        pacer.start(0);
        CHECK_FALSE(pacer.finished(0.5e-3));
        for (double now = 1e-3; now < 2; now += 1e-3) pacer.rest(now);
        CHECK_FALSE(pacer.finished(pacer.due() + 0.5e-3));
        CHECK(pacer.late() == 0);
        CHECK(pacer.stretched() == 0);
    }

    TEST_CASE("property: quantiles of times are right to a bin, 2.2 %")
    {
        TimeHistogram times;
        for (int k = 1; k <= 10000; ++k) times.add(1e-6 * k);
        CHECK(times.count() == 10000);
        for (const double share : {0.5, 0.99, 0.999}) CHECK(times.quantile(share) == test::about(1e-2 * share).epsilon(0.022));
        CHECK(times.quantile(1) == test::about(1e-2));
        CHECK(times.worst() == test::about(1e-2));
    }

    TEST_CASE("property: a reader sees whole values in their order, and the last one")
    {
        struct Pair {
            long a = 0, b = 0;
        };
        TripleBuffer<Pair> buffer;
        const long n = 200000;
        std::thread writer([&] {
            for (long k = 1; k <= n; ++k) buffer.put({k, -k});
        });
        long last = 0, torn = 0, back = 0;
        while (last < n) {
            if (!buffer.take()) continue;
            torn += buffer.front().a != -buffer.front().b;
            back += buffer.front().a <= last;
            last = buffer.front().a;
        }
        writer.join();
        CHECK(torn == 0);
        CHECK(back == 0);
        CHECK_FALSE(buffer.take());
    }

    TEST_CASE("property: bytes come out as they went in, and what has no room is refused whole")
    {
        ByteRing ring(10);
        const std::vector<std::uint8_t> six = {1, 2, 3, 4, 5, 6};
        CHECK(ring.put(six));
        CHECK_FALSE(ring.put(six));
        std::vector<std::uint8_t> out;
        ring.take(out);
        CHECK(out == six);
        CHECK(ring.put(six));  // around the end
        out.clear();
        ring.take(out);
        CHECK(out == six);
    }
}

}  // namespace seldinger::test::test_pacer

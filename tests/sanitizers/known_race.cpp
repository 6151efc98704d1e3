// Two items of a loop that write the same number: the thread sanitizer must find this race.
// With `clean`, the same loop has items that write only their own data, before and after accesses of the caller.
#include "core/parallel.h"

#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>
#include <vector>

int main(int argc, char** argv)
{
    const bool clean = argc > 1 && std::strcmp(argv[1], "clean") == 0;
    seldinger::set_thread_count(2);
    std::vector<double> own(64, 1.0);
    double shared = 0, sum = 0;
    for (int again = 0; again < 20; ++again) {
        for (double& x : own) x += again;
        seldinger::for_each_item(64, 1, [&](int i) {
            std::this_thread::sleep_for(std::chrono::microseconds(200));  // so that both threads come to have items
            (clean ? own[static_cast<std::size_t>(i)] : shared) += 1;
        });
        for (const double x : own) sum += x;
    }
    std::printf("%g %g\n", sum, shared);
}

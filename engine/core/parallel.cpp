// Runs ranges of items on oneTBB's pool, with the number of threads that was asked for.
#include "core/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <memory>

namespace seldinger {
namespace {

std::unique_ptr<tbb::global_control>& limit()
{
    static std::unique_ptr<tbb::global_control> control;
    return control;
}

}  // namespace

void set_thread_count(int count)
{
    limit().reset();
    if (count > 0)
        limit() =
            std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
}

int thread_count() { return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)); }

// Outside of an arena there is one thread.
int thread_slot() { return std::max(0, tbb::this_task_arena::current_thread_index()); }

int thread_slot_count() { return std::max(1, tbb::this_task_arena::max_concurrency()); }

namespace detail {

void parallel_ranges(int count, int grain, const void* body, void (*call)(const void* body, int begin, int end))
{
    tbb::parallel_for(
        tbb::blocked_range<int>(0, count, grain),
        [&](const tbb::blocked_range<int>& range) { call(body, range.begin(), range.end()); }, tbb::simple_partitioner());
}

}  // namespace detail
}  // namespace seldinger

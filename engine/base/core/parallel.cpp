// Runs ranges of items on oneTBB's pool, with the requested number of threads.
#include "core/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <memory>

// oneTBB is not built with the thread sanitizer, and neither is this file, which has its templates. The sanitizer must be told
// that a loop's items run after the code before the loop and before the code after it. Items are in no order among each
// other: their races are found.
#if defined(SEL_TELL_THREAD_SANITIZER)
    #include <sanitizer/tsan_interface.h>
    #define SEL_TSAN_RELEASE(at) __tsan_release(at)
    #define SEL_TSAN_ACQUIRE(at) __tsan_acquire(at)
#else
    #define SEL_TSAN_RELEASE(at) static_cast<void>(at)
    #define SEL_TSAN_ACQUIRE(at) static_cast<void>(at)
#endif

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
    char begun = 0, ended = 0;  // where the sanitizer is told of the order
    SEL_TSAN_RELEASE(&begun);
    tbb::parallel_for(
        tbb::blocked_range<int>(0, count, grain),
        [&](const tbb::blocked_range<int>& range) {
            SEL_TSAN_ACQUIRE(&begun);
            call(body, range.begin(), range.end());
            SEL_TSAN_RELEASE(&ended);
        },
        tbb::simple_partitioner());
    SEL_TSAN_ACQUIRE(&ended);
}

}  // namespace detail
}  // namespace seldinger

#pragma once
// Runs loops over independent items on all cores. oneTBB's pool steals work in small pieces and lets idle workers sleep.
// OpenMP's workers spin, and a region waits 8 ms for a worker that a busy neighbour keeps off its core. Items write only their
// own data, so the bits do not depend on the number of threads.

#include <functional>
#include <type_traits>

namespace seldinger {

/// Threads that for_each_item uses at most; 0: as many as there are cores. Not while a loop runs.
void set_thread_count(int count);
[[nodiscard]] int thread_count();

/// A number below thread_slot_count() that no other thread of the same loop has while it runs an item: for scratch memory.
[[nodiscard]] int thread_slot();
[[nodiscard]] int thread_slot_count();

namespace detail {
void parallel_ranges(int count, int grain, const void* body, void (*call)(const void* body, int begin, int end));
}

/// Wires that one thread takes at a time: a wire's share of a stage is some 2 to 20 us, a hand-over 1 us.
inline constexpr int wire_grain = 8;

/// body(begin, end) for pieces of [0, count) of at most `grain` items, each piece by one thread. No allocation by operator new.
template <class Body>
void for_each_piece(int count, int grain, const Body& body)
{
    if (count <= grain) {
        if (count > 0) body(0, count);
        return;
    }
    detail::parallel_ranges(count, grain, &body,
                            [](const void* b, int begin, int end) { (*static_cast<const Body*>(b))(begin, end); });
}

/// body(i) for every i in [0, count), each exactly once, in such pieces.
template <class Body>
void for_each_item(int count, int grain, const Body& body)
{
    for_each_piece(count, grain, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) body(i);
    });
}

}  // namespace seldinger

// Tests address space by reserving it, and threads by starting some that only wait.
#include "core/system_needs.h"

#include "core/error.h"

#include <fmt/format.h>
#include <limits.h>
#include <pthread.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <thread>
#include <vector>

namespace seldinger {
namespace {

constexpr std::size_t mebibyte = 1 << 20, usual_stack = 8 * mebibyte;

/// Without memory behind it, so that nothing but a limit of addresses can be in the way.
bool can_reserve(std::size_t bytes)
{
    void* at = ::mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (at == MAP_FAILED) return false;
    ::munmap(at, bytes);
    return true;
}

void* wait_for_end(void* ended)
{
    static_cast<std::atomic<bool>*>(ended)->wait(false);
    return nullptr;
}

/// @return how many threads of `count` there are at the same time
int can_start(int count)
{
    std::atomic<bool> ended = false;
    std::vector<pthread_t> threads;
    threads.reserve(static_cast<std::size_t>(count));
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, std::max<std::size_t>(PTHREAD_STACK_MIN, 64 * 1024));
    for (pthread_t thread;
         static_cast<int>(threads.size()) < count && pthread_create(&thread, &attributes, wait_for_end, &ended) == 0;)
        threads.push_back(thread);
    pthread_attr_destroy(&attributes);
    ended = true;
    ended.notify_all();
    for (const pthread_t thread : threads) pthread_join(thread, nullptr);
    return static_cast<int>(threads.size());
}

}  // namespace

void try_system_needs(const SystemNeeds& needs)
{
    const std::size_t bytes = needs.address_space + static_cast<std::size_t>(needs.threads) * usual_stack;
    if (!can_reserve(bytes))
        throw Error(ErrorKind::NoDevice,
                    fmt::format("{}: got less address space than it may need; expected {} MB more. Fix: raise the limit "
                                "(ulimit -v)",
                                needs.library, bytes / mebibyte));
    if (const int got = can_start(needs.threads); got < needs.threads)
        throw Error(ErrorKind::NoDevice,
                    fmt::format("{}: got {} threads; expected {}. Fix: raise the limit of processes (ulimit -u), or end others",
                                needs.library, got, needs.threads));
}

int library_threads(const char* variable)
{
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const char* text = std::getenv(variable);
    const int asked = text ? std::atoi(text) : 0;
    return asked > 0 ? std::min(asked, cores) : cores;
}

}  // namespace seldinger

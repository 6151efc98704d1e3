// Replaces operator new, malloc, calloc and realloc of the whole program by ones that count.
#include "support/count_allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    #define SEL_SANITIZED
#elif defined(__clang__)
    #if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
        #define SEL_SANITIZED
    #endif
#endif

#if defined(SEL_SANITIZED) || !defined(__GLIBC__) || !defined(__GNUC__)

namespace seldinger::test {
bool allocations_are_counted() { return false; }
long allocations() { return 0; }
}  // namespace seldinger::test

#else

namespace {
std::atomic<long> count{0};
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t items, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
extern char __executable_start, etext;  // of the linker: this program's code
}

namespace {
void count_if_ours(const void* caller)
{
    if (caller >= &__executable_start && caller < &etext) count.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

extern "C" {
// in the place of the library's, for the whole program; calloc because the compiler makes one of a malloc that is set to zero
void* malloc(std::size_t size)
{
    count_if_ours(__builtin_return_address(0));
    return __libc_malloc(size);
}
void* calloc(std::size_t items, std::size_t size)
{
    count_if_ours(__builtin_return_address(0));
    return __libc_calloc(items, size);
}
void* realloc(void* memory, std::size_t size)
{
    count_if_ours(__builtin_return_address(0));
    return __libc_realloc(memory, size);
}
}

void* operator new(std::size_t size)
{
    count.fetch_add(1, std::memory_order_relaxed);
    if (void* memory = __libc_malloc(size > 0 ? size : 1)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace seldinger::test {
bool allocations_are_counted() { return true; }
long allocations() { return count.load(std::memory_order_relaxed); }
}  // namespace seldinger::test

#endif

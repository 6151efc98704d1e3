#pragma once
// Our own mistakes (index, shape, invariant): a message and abort. SEL_ASSERT is cheap and on in this project's builds, Release
// too (CMakeLists.txt: SEL_ENABLE_ASSERTS). SEL_VALIDATE guards O(N) checks and is on in Debug only.

namespace seldinger::detail {
/// Calls the program's handler (core/assertion.h), or prints the condition; then aborts.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);
}  // namespace seldinger::detail

#if !defined(NDEBUG) || defined(SEL_ENABLE_ASSERTS)
    #define SEL_ASSERT(condition) \
        ((condition) ? static_cast<void>(0) : ::seldinger::detail::assertion_failed(#condition, __FILE__, __LINE__))
#else
    #define SEL_ASSERT(condition) static_cast<void>(0)
#endif

#ifndef NDEBUG
    #define SEL_VALIDATE(condition) SEL_ASSERT(condition)
#else
    #define SEL_VALIDATE(condition) static_cast<void>(0)
#endif

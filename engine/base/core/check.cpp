// The message of a failed check, and the handler that a program may put in its place.
#include "core/check.h"

#include "core/assertion.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace seldinger {
namespace {

std::atomic<AssertionHandler> the_handler{nullptr};

}  // namespace

AssertionHandler set_assertion_handler(AssertionHandler handler) { return the_handler.exchange(handler); }

void detail::assertion_failed(const char* condition, const char* file, int line)
{
    if (const AssertionHandler handler = the_handler) handler(condition, file, line);
    else
        std::fprintf(stderr, "seldinger: internal error: %s does not hold (%s:%d). Please report the scene that led here.\n",
                     condition, file, line);
    std::abort();
}

}  // namespace seldinger

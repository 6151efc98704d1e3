// A program's own handler hears of a failed check, and may throw.

#include "core/assertion.h"
#include "core/check.h"

#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

namespace seldinger::test::test_assertion {

TEST_SUITE("core/assertion")
{
    TEST_CASE("property: a failed check calls the handler with condition and place, and the handler before comes back")
    {
        const auto handler = [](const char* condition, const char* file, int line) {
            throw std::logic_error(std::string(condition) + "|" + file + "|" + (line > 0 ? "line" : ""));
        };
        CHECK_FALSE(bool(set_assertion_handler(handler)));
        const int two = 2;
        std::string heard;
        try {
            SEL_ASSERT(two == 2);  // holds
            SEL_ASSERT(two == 3);
        } catch (const std::logic_error& error) {
            heard = error.what();
        }
        CHECK(bool(set_assertion_handler(nullptr)));
        CHECK(heard.starts_with("two == 3|"));
        CHECK(heard.ends_with("test_assertion.cpp|line"));
    }
}

}  // namespace seldinger::test::test_assertion

// State hashes of the committed scenes: reference and study whole, the three of the front page whole.
#include "golden/golden_table.h"

#include <doctest/doctest.h>

namespace test_golden {

TEST_SUITE("golden")
{
    TEST_CASE("golden: every scene of the project ends with the bits of the table")
    {
        seldinger::test::check_golden_table("scenes.txt");
    }
}

}  // namespace test_golden

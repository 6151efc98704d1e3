// State hashes of worlds of several wires, each wire's own.
#include "golden/golden_table.h"

#include <doctest/doctest.h>

namespace test_golden_worlds {

TEST_SUITE("golden")
{
    TEST_CASE("golden: every wire of a world ends with the bits of the table")
    {
        seldinger::test::check_golden_table("worlds.txt");
    }
}

}  // namespace test_golden_worlds

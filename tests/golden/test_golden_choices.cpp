// State hashes of two small scenes under every detection, law and scheme, and of what else a scene can choose.
#include "golden/golden_table.h"

#include <doctest/doctest.h>

namespace test_golden_choices {

TEST_SUITE("golden")
{
    TEST_CASE("golden: every choice of a scene ends with the bits of the table")
    {
        seldinger::test::check_golden_table("choices.txt");
    }
}

}  // namespace test_golden_choices

// State hashes of the reference scenes and patients' vessels that are not part of the project; skipped where they are not.
#include "golden/golden_table.h"

#include <doctest/doctest.h>

namespace test_golden_shared {

TEST_SUITE("golden")
{
    TEST_CASE("golden: scenes and vessels of the shared reference data end with the bits of the table")
    {
        seldinger::test::check_golden_table("shared.txt");
    }
}

}  // namespace test_golden_shared

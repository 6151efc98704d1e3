// The wide tree's walks in double. The cases are in wide_cases.h.
#include "bench/wide_wall.h"

#include <cmath>
#include <cstdint>
#include <iterator>

#include "bench/wide_cases.h"

namespace test_wide_walk {

TEST_SUITE("contact/wide_walk")
{
    TEST_CASE("property: the nearest triangle is a loop's over all triangles, to the bit") { nearest_case(); }
    TEST_CASE("property: triangles within reach are a loop's over all triangles, up to rounding at the limit") { within_case(); }
    TEST_CASE("twin: query_nearest and query_capsule") { kernels_case(); }
}

}  // namespace test_wide_walk

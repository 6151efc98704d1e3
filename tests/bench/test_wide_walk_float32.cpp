// The wide tree's walks in float: the shared headers once more, in another namespace.
#include "bench/wide_wall.h"

#include <cmath>
#include <cstdint>
#include <iterator>

#define SEL_FLOAT32
#define seldinger seldinger_float32
#include "bench/wide_cases.h"

TEST_SUITE("contact/wide_walk_float32")
{
    TEST_CASE("property: the nearest triangle is a loop's over all triangles, to the bit") { nearest_case(); }
    TEST_CASE("property: triangles within reach are a loop's over all triangles, up to rounding at the limit") { within_case(); }
    TEST_CASE("twin: query_nearest and query_capsule") { kernels_case(); }
}

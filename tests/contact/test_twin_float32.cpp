// Kernels built with SEL_FLOAT32 against host loops in float: the shared headers once more, in another namespace.
#include "contact/twin_support.h"

#include <array>
#include <cmath>
#include <cstdint>

#define SEL_FLOAT32
#define seldinger seldinger_float32
#include "contact/twin_cases.h"

TEST_SUITE("contact/twin_float32")
{
    TEST_CASE("twin: contact_find") { find_case(); }
    TEST_CASE("twin: contact_distance") { distance_case(); }
    TEST_CASE("twin: contact_evaluate") { evaluate_case(); }
    TEST_CASE("twin: contact_evaluate with an exponent that needs pow") { evaluate_pow_case(); }
    TEST_CASE("twin: contact_evaluate with laws that have multipliers, and the barrier") { evaluate_hard_case(); }
    TEST_CASE("twin: contact_start and contact_multipliers") { multipliers_case(); }
    TEST_CASE("twin: contact_clearance and contact_sweep") { sweep_case(); }
    TEST_CASE("twin: contact_reduce") { reduce_case(); }
    TEST_CASE("twin: layer_find") { layer_find_case(); }
    TEST_CASE("twin: layer_evaluate") { layer_evaluate_case(); }
    TEST_CASE("twin: sizes and offsets of shared records") { layout_case(); }
}

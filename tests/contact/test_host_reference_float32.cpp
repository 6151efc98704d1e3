// Kernels built with SEL_FLOAT32 against host loops in float: the shared headers once more, in another namespace.
#include "contact/host_reference_support.h"

#include <array>
#include <cmath>
#include <cstdint>

#define SEL_FLOAT32
#define seldinger seldinger_float32
#include "contact/host_reference_cases.h"

TEST_SUITE("contact/host_reference_float32")
{
    TEST_CASE("host reference: contact_find") { find_case(); }
    TEST_CASE("host reference: contact_distance") { distance_case(); }
    TEST_CASE("host reference: contact_evaluate") { evaluate_case(); }
    TEST_CASE("host reference: contact_evaluate with an exponent that needs pow") { evaluate_pow_case(); }
    TEST_CASE("host reference: contact_evaluate in a lumen as narrow as the wire") { evaluate_narrow_case(); }
    TEST_CASE("host reference: contact_evaluate with laws that have multipliers, and the barrier") { evaluate_multiplier_case(); }
    TEST_CASE("host reference: contact_start and contact_multipliers") { multipliers_case(); }
    TEST_CASE("host reference: contact_clearance and contact_sweep") { sweep_case(); }
    TEST_CASE("host reference: contact_reduce") { reduce_case(); }
    TEST_CASE("host reference: layer_find") { layer_find_case(); }
    TEST_CASE("host reference: layer_evaluate") { layer_evaluate_case(); }
    TEST_CASE("host reference: sizes and offsets of shared records") { layout_case(); }
}

// Kernels in double against host loops. The cases are in host_reference_cases.h.
#include "contact/host_reference_support.h"

#include <array>
#include <cmath>
#include <cstdint>

#include "contact/host_reference_cases.h"

namespace test_host_reference {

TEST_SUITE("contact/host_reference")
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

}  // namespace test_host_reference

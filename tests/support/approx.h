#pragma once
// Relative comparison of small numbers. doctest::Approx(x) compares with epsilon * (1 + max(|a|, |b|)): for anything in newtons,
// metres or seconds that is far below 1, its epsilon is an absolute tolerance and the check passes whatever the value.

#include <doctest/doctest.h>

namespace seldinger::test {

/// Equal to within .epsilon(e) times the larger of the two, and nothing else.
inline doctest::Approx about(double x) { return doctest::Approx(x).scale(0); }

}  // namespace seldinger::test

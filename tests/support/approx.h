#pragma once
// Relative comparison of small numbers. The epsilon of doctest::Approx(x) is multiplied by 1 + max(|a|, |b|). For newtons,
// metres or seconds far below 1, it is an absolute tolerance, and the check passes whatever the value.

#include <doctest/doctest.h>

namespace seldinger::test {

/// Equal to within .epsilon(e) times the larger of the two, and nothing else; 0 equals 0.
inline doctest::Approx about(double x) { return doctest::Approx(x).scale(1e-300); }

}  // namespace seldinger::test

#pragma GCC poison Approx  // a check with it passes whatever a small value is

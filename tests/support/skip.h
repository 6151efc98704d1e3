#pragma once
// What a test says that cannot run here: no vtk, no renderer, no shared data. ctest shows an entry whose every test case said so
// as skipped, not as passed (main.cpp).

#include <string>

namespace seldinger::test {

/// The running test case, or the rest of it, is left out; the test then returns.
void skip(const std::string& reason);

}  // namespace seldinger::test

#pragma once
// How often a test draws at random: few times in every run, as many as its variable says where somebody waits for it.

#include <cstdlib>

namespace seldinger::test {

/// @param variable  SELDINGER_MUTANTS or SELDINGER_SOAK
inline long tries(const char* variable, long by_default)
{
    const char* given = std::getenv(variable);
    return given ? std::atol(given) : by_default;
}

}  // namespace seldinger::test

#pragma once
// Tests resources before libraries need them (PoCL, LLVM, Mesa): without a thread or memory they end or hang the process.

#include <cstddef>
#include <string>

namespace seldinger {

/// What a library takes from the system as it starts.
struct SystemNeeds {
    const char* library;        // for the message
    std::size_t address_space;  // without its threads' stacks [bytes]
    int threads;                // at the same time; processes that it starts count
};

/// Takes and gives back address space and threads. @throws Error NoDevice: which of them there is not, and what to do
void try_system_needs(const SystemNeeds& needs);

/// Cores that a library makes a thread for each. @param variable  of the environment that says fewer
[[nodiscard]] int library_threads(const char* variable);

}  // namespace seldinger

#pragma once
// Errors of the user and failures of the machine, as one exception with its exit code.

#include <stdexcept>
#include <string>

namespace seldinger {

/// Exit codes of the `seldinger` command (docs/command-line.md).
enum class ExitCode : int {
    Done = 0,
    BadScene = 2,     // the command line or the scene is wrong
    BadFile = 3,      // a file is missing or unusable
    Stopped = 4,      // the simulation stopped; the last good state is saved
    NoDevice = 5,     // no usable OpenCL device
    NotFeasible = 6,  // plan: nothing meets both tolerance and rate
    TimeLimit = 75,   // stopped by a time or signal limit; state saved, run again with --resume
    Interrupted = 130,
};

/// One line for stderr: place (file, line, key), expected value, fix. Thrown while loading and for what a caller asks; never for
/// numerical trouble in a step.
class Error : public std::runtime_error {
public:
    /// @param message  may quote files and names: what a terminal would obey becomes '?' (core/printable.h)
    Error(ExitCode code, const std::string& message);
    [[nodiscard]] ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

}  // namespace seldinger

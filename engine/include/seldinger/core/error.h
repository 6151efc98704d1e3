#pragma once
// Errors of the user and failures of the machine, as one exception that says which kind it is.

#include <stdexcept>
#include <string>

namespace seldinger {

/// What went wrong. The `seldinger` command has an exit code for each (docs/command-line.md).
enum class ErrorKind {
    None,         // nothing
    BadScene,     // the command line or the scene is wrong
    BadFile,      // a file is missing or unusable
    Stopped,      // the simulation stopped; the last good state is saved
    NoDevice,     // no usable OpenCL device
    NotFeasible,  // plan: nothing meets both tolerance and rate
    TimeLimit,    // stopped by a time or signal limit; state saved, run again with --resume
    Interrupted,
};

/// One line for stderr: place (file, line, key), expected value, fix. Thrown while loading and for what a caller asks; never for
/// numerical trouble in a step.
class Error : public std::runtime_error {
public:
    /// @param message  may quote files and names: what a terminal would obey becomes '?' (core/printable.h)
    Error(ErrorKind kind, const std::string& message);
    [[nodiscard]] ErrorKind kind() const { return kind_; }

private:
    ErrorKind kind_;
};

}  // namespace seldinger

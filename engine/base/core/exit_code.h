#pragma once
// The exit code of the `seldinger` command for each kind of error (docs/command-line.md).

#include "core/error.h"

namespace seldinger {

[[nodiscard]] constexpr int exit_code(ErrorKind kind)
{
    switch (kind) {
        case ErrorKind::None: return 0;
        case ErrorKind::BadScene: return 2;
        case ErrorKind::BadFile: return 3;
        case ErrorKind::Stopped: return 4;
        case ErrorKind::NoDevice: return 5;
        case ErrorKind::NotFeasible: return 6;
        case ErrorKind::TimeLimit: return 75;
        case ErrorKind::Interrupted: return 130;
    }
    return 1;
}

/// The kind whose exit code this is; Stopped for any other.
[[nodiscard]] constexpr ErrorKind kind_of_exit_code(int code)
{
    for (const ErrorKind kind : {ErrorKind::None, ErrorKind::BadScene, ErrorKind::BadFile, ErrorKind::Stopped,
                                 ErrorKind::NoDevice, ErrorKind::NotFeasible, ErrorKind::TimeLimit, ErrorKind::Interrupted})
        if (exit_code(kind) == code) return kind;
    return ErrorKind::Stopped;
}

}  // namespace seldinger

#pragma once
// The refusal of a file whose contents contradict each other.

#include "core/error.h"

#include <string>

namespace seldinger {

/// @param what  "got X; expected Y"
[[noreturn]] inline void refuse_damaged(const std::string& name, const std::string& what)
{
    throw Error(ExitCode::BadFile, name + ": " + what + ": the file is truncated or damaged. Fix: copy or export it again");
}

}  // namespace seldinger

#pragma once
// What happens when one of the engine's own checks fails: by default a message on stderr and std::abort().

namespace seldinger {

/// @param condition  that does not hold, as in the source
/// @param file, line  where
using AssertionHandler = void (*)(const char* condition, const char* file, int line);

/// Called instead of the message, from the thread in which a check has failed. It may write a report of its own or throw; the
/// world that was at work can then only be destroyed. If it returns, the process aborts. Null: the default again.
/// @return the handler before
AssertionHandler set_assertion_handler(AssertionHandler handler);

}  // namespace seldinger

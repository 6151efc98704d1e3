#pragma once
// Starts other programs with default signals, and waits for them.

#include <sys/types.h>

#include <string>
#include <vector>

namespace seldinger {

constexpr int no_descriptor = -1;

/// Whether the terminal's Ctrl-C reaches a program beside this one, or only through this one.
enum class ProcessGroup { Shared, Own };

/// Starts words[0], looked for in PATH, with words as its arguments. Signals that this process keeps off its threads (it may have
/// one that waits for them) it hears as usual.
/// @param input  its standard input; none: an empty one
/// @param error, output  its standard error and output; none: those of this process
/// @return -1 where it cannot be started; errno says why: ENOENT where it is not installed, EAGAIN where no process is left
[[nodiscard]] pid_t start_program(const std::vector<std::string>& words, int input = no_descriptor, int error = no_descriptor,
                                  int output = no_descriptor, ProcessGroup group = ProcessGroup::Shared);

/// Ties a process to its parent `parent`: it gets `signal` when `parent` ends for any reason, and at once if it has ended.
void end_with_parent(pid_t parent, int signal);

/// Why a program could not be started, and what to do, from errno. @param advice  where it is not installed
[[nodiscard]] std::string why_not_started(const std::string& program, const std::string& advice);

/// What waitpid's status says, as a shell does: the exit code, or 128 + the signal that ended it.
[[nodiscard]] int exit_code(int status);

/// @return the exit code of a child, when it has ended; -1 where `process` is no child
[[nodiscard]] int wait_for_program(pid_t process);

}  // namespace seldinger

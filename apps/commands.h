#pragma once
// The subcommands of `seldinger`, one file each (docs/command-line.md). add_*() declares the options; what the command does runs
// when the command line has been read, and returns the exit code or throws seldinger::Error.

#include "core/error.h"

#include <functional>
#include <string>
#include <string_view>

namespace seldinger::apps {

class CommandLine;

using Command = std::function<ErrorKind()>;

/// Each sets `chosen` when its subcommand is on the command line.
void add_run(CommandLine& app, Command& chosen);
void add_batch(CommandLine& app, Command& chosen);
void add_check(CommandLine& app, Command& chosen);
void add_init(CommandLine& app, Command& chosen);
void add_vessel(CommandLine& app, Command& chosen);
void add_render(CommandLine& app, Command& chosen);
void add_labels(CommandLine& app, Command& chosen);
void add_instruments(CommandLine& app, Command& chosen);
void add_devices(CommandLine& app, Command& chosen);
void add_plan(CommandLine& app, Command& chosen);
void add_live(CommandLine& app, Command& chosen);
void add_choose_live_model(CommandLine& app, Command& chosen);  // a part of live, not for people
void add_report(CommandLine& app, Command& chosen);
void add_farm(CommandLine& app, Command& chosen);
void add_dataset(CommandLine& app, Command& chosen);
void add_lab(CommandLine& app, Command& chosen);  // chart, stability, bench: lab/lab_commands.h

/// --time-limit and --device, as `run` has them.
void add_limits(CommandLine& command, double& time_limit, int& device);

/// Writes to stdout. @throws Error BadFile when it cannot take it (a full disk behind a redirection)
void print(std::string_view text);

}  // namespace seldinger::apps

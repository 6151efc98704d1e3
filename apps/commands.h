#pragma once
// The subcommands of `seldinger`, one file each (docs/command-line.md). add_*() declares the options; what the command does runs
// when the command line has been read, and returns the exit code or throws seldinger::Error.

#include "core/error.h"

#include <functional>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace seldinger::apps {

using Command = std::function<ExitCode()>;

/// Each sets `chosen` when its subcommand is on the command line.
void add_run(CLI::App& app, Command& chosen);
void add_batch(CLI::App& app, Command& chosen);
void add_check(CLI::App& app, Command& chosen);
void add_init(CLI::App& app, Command& chosen);
void add_vessel(CLI::App& app, Command& chosen);
void add_render(CLI::App& app, Command& chosen);
void add_labels(CLI::App& app, Command& chosen);
void add_instruments(CLI::App& app, Command& chosen);
void add_devices(CLI::App& app, Command& chosen);
void add_chart(CLI::App& app, Command& chosen);
void add_stability(CLI::App& app, Command& chosen);
void add_plan(CLI::App& app, Command& chosen);
void add_bench(CLI::App& app, Command& chosen);
void add_live(CLI::App& app, Command& chosen);
void add_choose_live_model(CLI::App& app, Command& chosen);  // a part of live, not for people
void add_report(CLI::App& app, Command& chosen);
void add_farm(CLI::App& app, Command& chosen);

/// --time-limit and --device, as `run` has them.
void add_limits(CLI::App& command, double& time_limit, int& device);

/// Writes to stdout. @throws Error BadFile when it cannot take it (a full disk behind a redirection)
void print(std::string_view text);

}  // namespace seldinger::apps

// Subcommands that the contract names and nobody has built yet. They answer in one place, whatever else is on the line.

#include "commands.h"

#include <CLI/CLI.hpp>

namespace seldinger::apps {

void add_not_yet(CLI::App& app, Command& chosen)
{
    for (const char* name : {"plan", "bench"}) {
        CLI::App* command = app.add_subcommand(name, "not available yet");
        command->prefix_command();  // takes everything that follows
        command->callback([name, &chosen] {
            chosen = [name]() -> ExitCode { throw Error(ExitCode::BadScene, std::string(name) + ": not available yet"); };
        });
    }
}

}  // namespace seldinger::apps

// The laboratory's commands, in a build without them.
#include "command_line.h"
#include "commands.h"

#include "core/error.h"

#include <fmt/format.h>

namespace seldinger::apps {

void add_lab(CommandLine& app, Command& chosen)
{
    for (const char* name : {"chart", "stability", "bench"}) {
        CommandLine* command = app.add_subcommand(name, "not in this build: ./dev build makes it");
        command->allow_extras();
        command->callback([&chosen, name] {
            chosen = [name]() -> ErrorKind {
                throw Error(ErrorKind::BadScene,
                            fmt::format("{}: got a build without charts, maps and benchmarks (SELDINGER_LAB=OFF, as "
                                        "./dev demo makes it); expected one with them. Fix: ./dev build",
                                        name));
            };
        });
    }
}

}  // namespace seldinger::apps

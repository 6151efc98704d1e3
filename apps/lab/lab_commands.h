#pragma once
// Commands of the laboratory: they compare methods, and no simulation needs them.

#include "commands.h"

namespace seldinger::apps {

void add_chart(CommandLine& app, Command& chosen);
void add_stability(CommandLine& app, Command& chosen);
void add_bench(CommandLine& app, Command& chosen);

}  // namespace seldinger::apps

// The laboratory's commands, in a build that has them.
#include "lab/lab_commands.h"

namespace seldinger::apps {

void add_lab(CommandLine& app, Command& chosen)
{
    add_chart(app, chosen);
    add_stability(app, chosen);
    add_bench(app, chosen);
}

}  // namespace seldinger::apps

// seldinger devices: the OpenCL devices and their numbers for --device.

#include "command_line.h"
#include "commands.h"
#include "engine.h"

#include <fmt/format.h>

namespace seldinger::apps {

void add_devices(CommandLine& app, Command& chosen)
{
    CommandLine* devices = app.add_subcommand("devices", "list the OpenCL devices");
    devices->callback([&chosen] {
        chosen = [] {
            const std::vector<DeviceInfo> list = list_devices();
            if (list.empty())
                throw Error(ExitCode::NoDevice,
                            "no OpenCL device; install one, e.g. the package pocl-opencl-icd for the processor");
            std::string text;
            for (const DeviceInfo& d : list)
                text += fmt::format("{}: {} ({}), {}, {}, {} compute units, {:.1f} GiB, {}\n", d.index, d.name, d.type,
                                    d.platform, d.version, d.compute_units, static_cast<double>(d.memory_bytes) / (1u << 30),
                                    d.fp64 ? "fp64" : "no fp64");
            print(text);
            return ExitCode::Done;
        };
    });
}

}  // namespace seldinger::apps

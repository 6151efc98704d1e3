// seldinger devices: the OpenCL devices and their numbers for --device; their kernels, compiled before the first run.

#include "command_line.h"
#include "commands.h"
#include "contact/force_kernels.h"
#include "device/kernel_cache.h"
#include "engine.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <vector>

namespace seldinger::apps {
namespace {

constexpr const char* smallest_scene = R"(
[scene]
duration_s = 0.001
dt_s = 0.001
[wire]
length_m = 0.05
radius_m = 0.0004445
density = 7900.0
bend_nm2 = 1.0e-5
twist_nm2 = 8.0e-6
stretch_n = 1.0e4
nodes = 21
[vessel]
shape = "tube"
radius_m = 0.005
length_m = 0.1
axis = [1.0, 0.0, 0.0]
triangles = 500
[feed]
point = [0.0, 0.0, 0.0]
direction = [1.0, 0.0, 0.0]
keys = [ {t_s = 0.0, advance_m = 0.004}, {t_s = 1.0, advance_m = 0.008} ]
)";

ErrorKind list()
{
    const std::vector<DeviceInfo> devices = list_devices();
    if (devices.empty())
        throw Error(ErrorKind::NoDevice, "no OpenCL device; install one, e.g. the package pocl-opencl-icd for the processor");
    std::string text;
    for (const DeviceInfo& d : devices)
        text +=
            fmt::format("{}: {} ({}), {}, {}, {} compute units, {:.1f} GiB, {}\n", d.index, d.name, d.type, d.platform, d.version,
                        d.compute_units, static_cast<double>(d.memory_bytes) / (1u << 30), d.fp64 ? "fp64" : "no fp64");
    print(text);
    return ErrorKind::None;
}

int kept_kernels()
{
    int count = 0;
    std::error_code error;
    for (std::filesystem::recursive_directory_iterator at(device::kernel_cache_folder(), error), end; !error && at != end;
         at.increment(error))
        count += at->path().extension() == ".so";
    return count;
}

/// What a run launches: each law of the wall by a world that has it, in both precisions, the layer's, and instruments.
ErrorKind warm(int device)
{
    (void)list_devices();  // which settles where kernels are kept
    const int before = kept_kernels();
    for (const std::vector<std::string>& how : std::vector<std::vector<std::string>>{{},
                                                                                   {"contact.precision=float32"},
                                                                                   {"contact.normal=augmented"},
                                                                                   {"contact.normal=barrier"},
                                                                                   {"contact.detection=layer"}})
        (void)World(make_setup(read_scene_text(smallest_scene, "kernels.toml", how), device));
    warm_instrument_kernels(device);
    const int after = kept_kernels();
    print(after == 0 ? "kernels were compiled; the device's driver keeps them, if any does\n"
                     : fmt::format("{} kernels compiled, {} were there; kept in {}\n", after - before, before,
                                   device::kernel_cache_folder().string()));
    return ErrorKind::None;
}

struct DevicesOptions {
    bool warm = false;
    int device = -1;
};

ErrorKind run(const DevicesOptions& options)
{
    if (options.warm) return warm(options.device);
    if (options.device >= 0)
        throw Error(ErrorKind::BadScene, "--device: got no --warm; expected both. Fix: add --warm, or take --device out");
    return list();
}

}  // namespace

void add_devices(CommandLine& app, Command& chosen)
{
    const auto options = std::make_shared<DevicesOptions>();
    CommandLine* devices = app.add_subcommand("devices", "list the OpenCL devices");
    devices->add_flag(
        "--warm", options->warm,
        "compile the kernels that runs need, and keep them: for an image of a container or a node, before its first run");
    devices->add_option("--device", options->device, "with --warm: for this device instead of the default")->type_name("N");
    devices->callback([&chosen, options] { chosen = [options] { return run(*options); }; });
}

}  // namespace seldinger::apps

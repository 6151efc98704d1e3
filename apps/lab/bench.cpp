// seldinger bench [--device N] [--json] [-o DIR] [--quick] [--repeat N] [--scenes FILE …] [--kernels-only] [--gpu [--wires N,…]]
// [--overwrite] [--quiet]

#include "assets.h"
#include "command_line.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "core/note.h"
#include "device/enumerate.h"
#include "lab/bench_gpu.h"
#include "lab/bench_report.h"
#include "lab/lab_commands.h"
#include "stop_signal.h"

#include <fmt/format.h>

#include <unistd.h>
#include <csignal>
#include <memory>

namespace seldinger::apps {
namespace {

struct BenchArguments {
    std::filesystem::path dir;
    std::vector<std::filesystem::path> scenes;
    std::vector<int> wires = {1, 64, 1024, 4096};
    int device = -1, repeat = 3;
    bool quick = false, json = false, overwrite = false, quiet = false, kernels_only = false, gpu = false;
};

constexpr long quick_steps = 600;
constexpr long fleet_steps = 60, quick_fleet_steps = 3;  // a second, and a check
constexpr const char* gpu_file = "gpu.json";

/// One line on stderr; nothing when it is not a terminal.
void show(const BenchArguments& options, const std::string& doing)
{
    if (!options.quiet && isatty(STDERR_FILENO)) note(fmt::format("\r\033[K{}", doing));
}

void stop_when_asked()
{
    if (stop_asked_for() == SIGINT) throw Error(ErrorKind::Interrupted, "interrupted; nothing was written");
    if (stop_asked_for() != 0) throw Error(ErrorKind::TimeLimit, "stopped; nothing was written");
}

void check_folder(const BenchArguments& options)
{
    if (options.dir.empty() || options.overwrite) return;
    const std::vector<const char*> files = options.gpu ? std::vector<const char*>{gpu_file}
                                                       : std::vector<const char*>(std::begin(bench_files), std::end(bench_files));
    for (const char* file : files)
        if (std::filesystem::exists(options.dir / file))
            throw Error(ErrorKind::BadScene,
                        fmt::format("{}: holds results of a benchmark ({}); give --overwrite, or another folder with -o",
                                    options.dir.string(), file));
}

/// Peaks and kernels, in double and in float.
void measure_kernels(const BenchArguments& options, BenchResults& results)
{
    using namespace device;
    kernel_bench::KernelBenchOptions how;
    how.repeats = options.quick ? 3 : 2 * options.repeat + 1;
    if (options.quick) how.light = {300}, how.heavy = {4800}, how.least = 5e-4;
    const bool fp64 = results.device.fp64;
    Context context(options.device, !fp64);
    show(options, "peaks");
    for (const Queue queue : {Queue::Inline, Queue::Pool}) {
        stop_when_asked();
        if (queue == Queue::Inline && !context.two_queues()) continue;
        results.peaks.push_back(measure_peaks(context, queue, how.repeats, options.quick ? 48 : 384));
    }
    if (!context.two_queues()) how.light.clear();
    const kernel_bench::BenchWall wall = kernel_bench::make_bench_wall(context);
    const auto work = kernel_bench::count_work(wall, 4800);
    show(options, "kernels");
    results.kernels = kernel_bench::time_kernels(context, wall, work, how);
    stop_when_asked();
    if (!fp64) return;
    show(options, "kernels in float32");
    Context single(options.device, true);
    const auto more = kernel_bench::time_kernels(single, wall, work, how);
    results.kernels.insert(results.kernels.end(), more.begin(), more.end());
    stop_when_asked();
}

void measure_scenes(const BenchArguments& options, BenchResults& results)
{
    std::vector<std::filesystem::path> files = options.scenes;
    if (files.empty())
        for (const char* name : {"experiment1.toml", "experiment2.toml", "aortic-arch.toml", "patients/tha001-arch.toml"})
            files.push_back(assets_folder() / "scenes" / name);
    for (const auto& file : files) {
        show(options, file.filename().string());
        try {
            if (!results.device.fp64)
                throw Error(ErrorKind::NoDevice,
                            "the device has no double precision, which scenes need; choose another with --device, or give "
                            "--kernels-only");
            results.scenes.push_back(time_scene(read_scene(file), options.device, options.quick ? 1 : options.repeat,
                                                options.quick ? quick_steps : 0, [] { return stop_asked_for() != 0; }));
        } catch (const Error& error) {
            stop_when_asked();
            if (!options.scenes.empty()) throw;  // asked for by name
            results.skipped.push_back({file.filename().string(), error.what()});
        }
    }
}

/// --gpu: one file for all of it.
ErrorKind bench_fleets(const BenchArguments& options)
{
    const GpuBench how = {options.device, options.wires, options.quick ? quick_fleet_steps : fleet_steps};
    const std::string found = measure_gpu(
        how, [&](const std::string& doing) { show(options, doing); },
        [] {
            stop_when_asked();
            return false;
        });
    show(options, "");
    if (!options.dir.empty()) make_folder(options.dir), write_file(options.dir / gpu_file, found);
    if (options.json) print(found);
    else if (!options.quiet) print(gpu_summary(found));
    if (!options.json && !options.quiet && !options.dir.empty()) print(fmt::format("{}\n", (options.dir / gpu_file).string()));
    return ErrorKind::None;
}

ErrorKind bench(const BenchArguments& options)
{
    const StopSignal listening;
    const FileLock lock = options.dir.empty() ? FileLock() : FileLock::of_folder(options.dir);
    check_folder(options);
    BenchResults results;
    const std::vector<DeviceInfo> list = list_devices();
    device::check_device_index(options.device);
    if (list.empty())
        throw Error(ErrorKind::NoDevice, "no OpenCL device; install one, e.g. the package pocl-opencl-icd for the processor");
    results.device =
        list[static_cast<std::size_t>(options.device < 0 ? device::default_device() : options.device)];
    if (options.gpu) return bench_fleets(options);
    for (const auto& file : options.scenes) (void)read_scene(file);  // before minutes are spent on kernels
    results.chosen = options.device < 0 ? "default" : "asked for";
    measure_kernels(options, results);
    if (!options.kernels_only) measure_scenes(options, results);
    show(options, "");
    bool drawn = false;
    if (!options.dir.empty()) {
        write_bench(results, options.dir);
        drawn = draw_with("plot_roofline.py", {options.dir.string()});
    }
    if (options.json) print(bench_json(results));
    else if (!options.quiet) print(bench_summary(results));
    if (!options.json && !options.quiet && !options.dir.empty())
        print(fmt::format("{}: device.csv, kernels.csv, scenes.csv{}\n", options.dir.string(),
                          drawn ? ", roofline.png, roofline.svg" : ""));
    return ErrorKind::None;
}

}  // namespace

void add_bench(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<BenchArguments>();
    CommandLine* command = app.add_subcommand("bench", "time an OpenCL device: its peaks, every kernel, whole scenes");
    command
        ->add_option("-o", options->dir,
                     "folder for device.csv, kernels.csv, scenes.csv and the roofline picture (default: none is written)")
        ->type_name("DIR");
    command->add_option("--scenes", options->scenes, "time these scenes instead of the built-in ones")
        ->type_name("FILE")
        ->delimiter(',');
    command->add_option("--repeat", options->repeat, "runs of each scene; the median is reported")
        ->check(in_range(1, 99))
        ->type_name("N");
    command->add_flag("--quick", options->quick, "short check: small loads, 600 steps of each scene, once");
    command->add_flag("--kernels-only", options->kernels_only, "time kernels only, no scenes");
    command->add_flag(
        "--gpu", options->gpu,
        "many wires at once: launches, bytes over the bus and the device's own time of each kernel, compared with the "
        "processor; -o writes gpu.json");
    command->add_option("--wires", options->wires, "numbers of wires for --gpu (default: 1,64,1024,4096)")
        ->check(in_range(1, 100000))
        ->type_name("N,...")
        ->delimiter(',');
    command->add_flag("--overwrite", options->overwrite, "replace the results in DIR");
    command->add_option("--device", options->device, "OpenCL device, as `seldinger devices` lists them")
        ->type_name("N")
        ->check([](const std::string& text) { return text.starts_with('-') ? "got " + text + "; expected 0 or more" : ""; });
    command->add_flag("--quiet", options->quiet, "no progress, no tables");
    command->add_flag("--json", options->json, "print the results as one JSON object");
    command->callback([options, &chosen] { chosen = [options] { return bench(*options); }; });
}

}  // namespace seldinger::apps

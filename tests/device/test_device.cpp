// What the step loop does on the device, the bits it gives on each, and the messages when something is wrong.

#include "device/device.h"
#include "device/enumerate.h"
#include "support/skip.h"
#include "support/world_fixture.h"

#include "core/error.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

namespace seldinger::test::test_device {

namespace {

// three thin wires on the floor of a tube: 3000 quadrature points in contact, so that the threaded device takes them
TestSetup heavy_setup(int device_index = -1)
{
    TestSetup setup;
    setup.device_index = device_index;
    const VesselSpec spec = tube(0.003, 0.12);
    add_tube(setup, spec);
    for (int w = 0; w < 3; ++w) {
        WireSpec wire = steel_wire(0.1, 41);
        wire.shaft.radius = 0.1e-3;
        wire.shaft.bend_stiffness = 1e-7;
        wire.shaft.twist_stiffness = 8e-8;
        TestWire made = placed_wire(wire, Vec3(0.01 + 1e-4 * w, 0, -0.003 + 0.1e-3 - 2e-7));
        made.wire.place.velocity = Vec3(0.02 * w, 0.01, 0);
        setup.wires.push_back(made);
    }
    return setup;
}

std::string hash_after(TestSetup setup, int steps)
{
    FedWorld world(std::move(setup));
    for (int k = 0; k < steps; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
    REQUIRE(world.readings(0).contacts > 500);
    return world.state_hash();
}

std::string message_of(const std::function<void()>& call, ErrorKind& code)
{
    try {
        call();
    } catch (const Error& error) {
        code = error.kind();
        return error.what();
    }
    return "";
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// the hash that a new process prints, with PoCL's pool of the given size
std::string hash_in_process(int threads)
{
    const std::string self = std::filesystem::read_symlink("/proc/self/exe");
    const std::string command = "POCL_MAX_PTHREAD_COUNT=" + std::to_string(threads) + " '" + self +
                                "' --no-skip --test-case='helper: print the state hash of a heavy run'";
    std::FILE* pipe = popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    std::string text;
    std::array<char, 256> line;
    while (std::fgets(line.data(), line.size(), pipe)) text += line.data();
    REQUIRE(pclose(pipe) == 0);
    const std::size_t at = text.find("state hash ");
    REQUIRE(at != std::string::npos);
    return text.substr(at + 11, 16);
}

}  // namespace

TEST_SUITE("device")
{
    TEST_CASE("helper: print the state hash of a heavy run" * doctest::skip())
    {
        std::printf("state hash %s\n", hash_after(heavy_setup(), 15).c_str());
    }

    TEST_CASE("property: the step loop creates no buffer and builds no program after warm-up")
    {
        TestSetup setup = in_tube(0.003, 0.12);
        setup.wires = {fed_wire(steel_wire(0.1, 41), {0.0005, 0, -0.0025}, 0.1)};
        FedWorld world(std::move(setup));
        for (int k = 0; k < 100; ++k) (void)step(world, 1e-3);
        device::Counters& counters = data_of(world).forces.context->counters();
        const device::Counters before = counters;
        int iterations = 0;
        for (int k = 0; k < 200; ++k) {
            const StepReport report = step(world, 1e-3);
            REQUIRE_FALSE(report.failed());
            iterations += report.newton_iterations;
        }
        REQUIRE(world.readings(0).contacts > 10);
        CHECK(counters.buffers_created == before.buffers_created);
        CHECK(counters.programs_built == before.programs_built);
        // an evaluation is two launches, or a chain of up to 17 (contact/force_kernels.h), and one read-back, or two from memory
        // of the device's own; candidates that are found anew are one of each on top. Evaluations: one for the guess and some 1
        // to 3 per iteration (line search, halved steps)
        const int most = data_of(world).forces.context->workgroup(device::Items::Branching) == 1 ? 2 : 17;
        const double launches = double(counters.launches - before.launches), reads = double(counters.reads - before.reads);
        MESSAGE("per step: " << launches / 200 << " launches, " << reads / 200 << " reads, "
                             << double(counters.writes - before.writes) / 200 << " writes, " << iterations / 200.0
                             << " iterations");
        CHECK(reads >= launches / most);
        CHECK(reads <= launches);
        CHECK(reads <= (data_of(world).forces.context->on_cpu() ? 3.0 : 6.0) * (iterations + 200));
        CHECK(launches >= 2 * 100);
    }

    TEST_CASE("property: PoCL's devices are known by their names of any version, and by no other platform's")
    {
        using device::PoclDevice;
        const std::string pocl = "Portable Computing Language";
        CHECK(device::pocl_device(pocl, "basic-skylake-avx512-AMD EPYC") == PoclDevice::Caller);  // up to 3
        CHECK(device::pocl_device(pocl, "pthread-skylake-avx512-AMD EPYC") == PoclDevice::Pool);
        CHECK(device::pocl_device(pocl, "cpu-minimal-skylake-avx512-AMD EPYC") == PoclDevice::Caller);  // from 4 on
        CHECK(device::pocl_device(pocl, "cpu-skylake-avx512-AMD EPYC") == PoclDevice::Pool);
        CHECK(device::pocl_device(pocl, "cuda-sm_80") == PoclDevice::None);
        CHECK(device::pocl_device("Intel(R) OpenCL", "cpu-minimal") == PoclDevice::None);
        // the default is never the caller's thread alone where a pool is offered
        const auto all = device::all_devices();
        bool pool = false;
        for (cl_device_id one : all) pool |= device::pocl_device(one) == PoclDevice::Pool;
        if (pool) CHECK(device::pocl_device(all[static_cast<std::size_t>(device::default_device(all))]) == PoclDevice::Pool);
    }

    TEST_CASE("property: the same bits run after run, on each device and on the pair, for any number of threads")
    {
        const std::string hash = hash_after(heavy_setup(), 15);
        CHECK(hash_after(heavy_setup(), 15) == hash);
        int tried = 0;
        for (const DeviceInfo& info : list_devices()) {
            if (info.type != "CPU" || info.platform.find("Portable") == std::string::npos) continue;
            CAPTURE(info.name);
            CHECK(hash_after(heavy_setup(info.index), 15) == hash);
            ++tried;
        }
        if (tried == 0) skip("no PoCL device: compared on the default device only");
        CHECK(hash_in_process(1) == hash);
        CHECK(hash_in_process(2) == hash);
    }

    TEST_CASE("property: a device index beyond the list is an error that names the range")
    {
        ErrorKind code = ErrorKind::None;
        TestSetup setup = heavy_setup(99);
        const std::string text = message_of([&] { FedWorld world(std::move(setup)); }, code);
        CHECK(code == ErrorKind::NoDevice);
        CHECK(holds(text, "--device 99"));
        CHECK(holds(text, "devices 0 to " + std::to_string(list_devices().size() - 1)));
    }

    TEST_CASE("property: a kernel that does not build says which file, on which device, and the compiler's error")
    {
        namespace fs = std::filesystem;
        const fs::path folder = fs::temp_directory_path() / ("seldinger-kernels-" + std::to_string(::getpid()));
        fs::copy(fs::path(SEL_SOURCE_DIR) / "kernels", folder, fs::copy_options::recursive);
        std::ofstream(folder / "contact" / "evaluation.cl", std::ios::app) << "\n__kernel void broken() { no_such_thing = 1; }\n";
        setenv("SEL_KERNEL_DIR", folder.c_str(), 1);
        ErrorKind code = ErrorKind::None;
        const std::string broken = message_of([] { (void)device::Context().program("contact/evaluation.cl"); }, code);
        CHECK(code == ErrorKind::NoDevice);
        CHECK(holds(broken, "kernels/contact/evaluation.cl does not build on device"));
        CHECK(holds(broken, "no_such_thing"));
        CHECK(holds(broken, "CL_BUILD_PROGRAM_FAILURE"));
        const std::string missing = message_of([] { (void)device::Context().program("contact/none.cl"); }, code);
        CHECK(holds(missing, "no kernel file"));
        CHECK(holds(missing, "contact/none.cl"));
        unsetenv("SEL_KERNEL_DIR");
        fs::remove_all(folder);
    }

    TEST_CASE(
        "property: the second context of the same devices builds nothing, and what depends on a build's options is not shared")
    {
        const char* const file = "contact/evaluation.cl";
        device::Context first, second, single(-1, true);
        const cl_program program = first.program(file);
        CHECK(second.program(file) == program);
        CHECK(second.counters().programs_built == 0);
        CHECK(single.program(file) != program);
        CHECK(device::Context(-1, true).program(file) == single.program(file));
        if (first.two_queues()) CHECK(device::Context(0).program(file) != program);  // one device alone
        // another text of the same name: with SEL_KERNEL_DIR it changes while a process runs
        namespace fs = std::filesystem;
        const fs::path folder = fs::temp_directory_path() / ("seldinger-changed-" + std::to_string(::getpid()));
        fs::copy(fs::path(SEL_SOURCE_DIR) / "kernels", folder, fs::copy_options::recursive);
        setenv("SEL_KERNEL_DIR", folder.c_str(), 1);
        CHECK(device::Context().program(file) == program);
        std::ofstream(folder / "contact" / "evaluation.cl", std::ios::app) << "\n// changed\n";
        device::Context changed;
        CHECK(changed.program(file) != program);
        CHECK(changed.counters().programs_built == 1);
        unsetenv("SEL_KERNEL_DIR");
        fs::remove_all(folder);
        CHECK(second.program(file) == program);
    }

    TEST_CASE("property: worlds in threads of their own, of both precisions at once, have the bits that they have alone")
    {
        const auto setup_of = [](bool single) {
            TestSetup setup = in_tube(0.003, 0.12);
            setup.wires = {fed_wire(steel_wire(0.1, 41), {0.0005, 0, -0.0025}, 0.1)};
            if (single) setup.wires[0].contact.precision = Precision::Float32;
            return setup;
        };
        const auto hash_of = [&](bool single) {
            FedWorld world(setup_of(single));
            for (int k = 0; k < 150; ++k)
                if (step(world, 1e-3).failed()) return std::string("failed");
            return world.state_hash();
        };
        const std::string alone[2] = {hash_of(false), hash_of(true)};
        REQUIRE(alone[0] != alone[1]);
        std::array<std::string, 4> hashes;
        for (int round = 0; round < 5; ++round) {
            std::vector<std::thread> threads;
            for (int k = 0; k < 4; ++k) threads.emplace_back([&, k] { hashes[k] = hash_of(k % 2 == 1); });
            for (std::thread& thread : threads) thread.join();
            for (int k = 0; k < 4; ++k) CHECK(hashes[k] == alone[k % 2]);
        }
        FedWorld again(setup_of(false));
        CHECK(again.device_counts().programs_built == 0);
    }

    TEST_CASE("property: a failing call is named, with OpenCL's own name for the error")
    {
        ErrorKind code = ErrorKind::None;
        const std::string text = message_of([] { device::check(CL_INVALID_BUFFER_SIZE, "clCreateBuffer(context, 0)"); }, code);
        CHECK(code == ErrorKind::NoDevice);
        CHECK(holds(text, "clCreateBuffer failed with CL_INVALID_BUFFER_SIZE"));
    }

    TEST_CASE("property: buffers begin with zeros, and copies keep to their range")
    {
        device::Context context;
        device::Buffer a(context, 1000), b(context, 1000);
        std::vector<unsigned char> bytes(1000, 7), back(1000, 1);
        context.read(device::Queue::Inline, a, back.data(), 1000);
        CHECK(std::count(back.begin(), back.end(), 0) == 1000);
        context.write(device::Queue::Inline, a, bytes.data(), 1000);
        context.copy(device::Queue::Inline, a, b, 100, 300);
        context.enter(device::Queue::Pool);  // waits: what was written on the other queue is seen here
        context.read(device::Queue::Pool, b, back.data(), 1000);
        for (int k = 0; k < 1000; ++k) REQUIRE(back[k] == (k >= 300 && k < 400 ? 7 : 0));
    }
}

}  // namespace seldinger::test::test_device

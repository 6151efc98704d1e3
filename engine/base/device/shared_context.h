#pragma once
// State that all Contexts of one process share on the same devices: the cl_context and the programs built in it. Building a
// program takes 20 ms even if PoCL finds its kernels compiled on disk. That is long beside what a small world computes for a
// second of its time, and studies make thousands of worlds.

#include "device/device.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace seldinger::device {

/// Lives as long as the process: what OpenCL has open when a process ends it closes itself, in an order that nobody knows.
class SharedContext {
public:
    /// The one of these devices, all of one platform; made at the first call. Any thread.
    static SharedContext& of(const std::vector<cl_device_id>& devices);

    [[nodiscard]] cl_context handle() const { return context_; }
    /// @param file  for messages
    /// @return the program built from this text with these options, and whether it was built by this call. Any thread
    [[nodiscard]] std::pair<cl_program, bool> program(const std::string& file, const std::string& text,
                                                      const std::string& options);

    /// @param launch  the first launch of a kernel on a device by its caller, which waits for its end. PoCL compiles a kernel
    /// there, unless it is in the cache: one process at a time, and for one of its two devices; the other's code is a copy. Any
    /// thread
    void first_launch(cl_kernel kernel, cl_device_id device, const std::function<void()>& launch);

    SharedContext(const SharedContext&) = delete;
    SharedContext& operator=(const SharedContext&) = delete;

private:
    explicit SharedContext(std::vector<cl_device_id> devices);
    [[nodiscard]] cl_program build(const std::string& file, std::string text, const std::string& options);
    /// LLVM's code of a text, of which PoCL makes kernels: the same for both devices of a processor, and kept beside PoCL's own
    /// files. Empty: PoCL has not left it in its cache
    [[nodiscard]] std::vector<std::uint8_t> bitcode(const std::string& text, const std::string& options,
                                                    const std::string& mark) const;
    /// @return nullptr: not with this code
    [[nodiscard]] cl_program from_bitcode(const std::vector<std::uint8_t>& code, const std::string& options) const;

    /// What PoCL has made of a program.
    struct Compiled {
        std::string mark;                                        // its name, the same in every process
        std::vector<std::filesystem::path> folders;              // of the cache, one a device, where they are new
        std::set<std::pair<std::string, cl_device_id>> kernels;  // that this process has launched
    };

    std::vector<cl_device_id> devices_;
    cl_context context_ = nullptr;
    bool pocl_ = false, takes_code_ = false;  // takes_code_: kernels are made of bitcode()
    std::mutex building_, launching_;
    std::map<cl_program, Compiled> compiled_;  // under launching_
    std::map<std::pair<std::string, std::string>, cl_program>
        programs_;  // by options and text: with the devices all it depends on
};

}  // namespace seldinger::device

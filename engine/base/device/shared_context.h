#pragma once
// State that all Contexts of one process share on the same devices: the cl_context and the programs built in it. Building a program
// takes 50 ms even if PoCL finds its kernels compiled on disk (it preprocesses the text to know). That is longer than a small world
// computes for a second of its time, and studies make thousands of worlds.

#include "device/device.h"

#include <map>
#include <mutex>
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

    SharedContext(const SharedContext&) = delete;
    SharedContext& operator=(const SharedContext&) = delete;

private:
    explicit SharedContext(std::vector<cl_device_id> devices);
    [[nodiscard]] cl_program build(const std::string& file, const std::string& text, const std::string& options) const;

    std::vector<cl_device_id> devices_;
    cl_context context_ = nullptr;
    std::mutex building_;
    std::map<std::pair<std::string, std::string>, cl_program>
        programs_;  // by options and text: with the devices all it depends on
};

}  // namespace seldinger::device

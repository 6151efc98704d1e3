#pragma once
// What the reference tests of both precisions share. Includes nothing of kernels/shared: those headers are compiled twice, once
// with float arithmetic and under another namespace (test_host_reference_float32.cpp).

#include "contact/force_kernels.h"
#include "device/device.h"

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

namespace seldinger::test {

using seldinger::ForceKernels;
using seldinger::GapKernels;

/// A tube with bumps, slivers, doubled and zero-area triangles, as DeviceWall holds it.
struct ReferenceWall {
    std::vector<unsigned char> nodes;  // TreeNode
    std::vector<float> vertices;
    std::vector<std::uint32_t> boundary;
    std::size_t triangles = 0;
    double radius = 0.003, length = 0.03;  // of the tube, along x through the origin [m]
};
[[nodiscard]] const ReferenceWall& reference_wall();

/// Contexts live as long as the tests: PoCL compiles each kernel once.
[[nodiscard]] device::Context& reference_context(bool float32);

/// A device buffer with canary words behind it.
template <class T>
class Guarded {
public:
    Guarded(device::Context& context, device::Queue queue, const std::vector<T>& from)
        : context_(context),
          queue_(queue),
          size_(from.size()),
          bytes_(from.size() * sizeof(T) + sizeof canary, canary[0]),
          buffer_(context, bytes_.size())
    {
        if (size_ > 0) std::memcpy(bytes_.data(), from.data(), size_ * sizeof(T));
        context.enter(queue);
        context.write(queue, buffer_, bytes_.data(), bytes_.size());
        context.finish(queue);
    }
    /// Content after the launches; fails the test when something wrote behind the end.
    std::vector<T> read()
    {
        context_.read(queue_, buffer_, bytes_.data(), bytes_.size());
        for (std::size_t k = bytes_.size() - sizeof canary; k < bytes_.size(); ++k) REQUIRE(bytes_[k] == canary[0]);
        std::vector<T> out(size_);
        if (size_ > 0) std::memcpy(out.data(), bytes_.data(), size_ * sizeof(T));
        return out;
    }
    operator const device::Buffer&() const { return buffer_; }
    const device::Buffer& buffer() const { return buffer_; }

private:
    static constexpr unsigned char canary[256] = {0xa5};
    device::Context& context_;
    device::Queue queue_;
    std::size_t size_;
    std::vector<unsigned char> bytes_;
    device::Buffer buffer_;
};

/// Index of the first record whose bytes differ; -1: none.
template <class T>
long first_difference(const std::vector<T>& a, const std::vector<T>& b)
{
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
        if (std::memcmp(&a[k], &b[k], sizeof(T)) != 0) return static_cast<long>(k);
    return -1;
}

}  // namespace seldinger::test

// names that survive the renaming of the namespace in the float32 build
namespace sel_reference = seldinger::test;
namespace sel_device = seldinger::device;

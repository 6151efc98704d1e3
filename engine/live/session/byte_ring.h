#pragma once
// Bytes from one thread to another in order, without locks: a block that does not fit is refused whole.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

class ByteRing {
public:
    explicit ByteRing(std::size_t capacity) : bytes_(capacity) {}

    /// @return false: no room, and nothing was put
    bool put(std::span<const std::uint8_t> from)
    {
        const std::uint64_t end = written_.load(std::memory_order_relaxed);
        if (end + from.size() - read_.load(std::memory_order_acquire) > bytes_.size()) return false;
        for (std::size_t k = 0; k < from.size(); ++k) bytes_[(end + k) % bytes_.size()] = from[k];
        written_.store(end + from.size(), std::memory_order_release);
        return true;
    }
    /// Appends all that is there to `to`.
    void take(std::vector<std::uint8_t>& to)
    {
        const std::uint64_t begin = read_.load(std::memory_order_relaxed), end = written_.load(std::memory_order_acquire);
        for (std::uint64_t k = begin; k < end; ++k) to.push_back(bytes_[k % bytes_.size()]);
        read_.store(end, std::memory_order_release);
    }

private:
    std::vector<std::uint8_t> bytes_;
    alignas(64) std::atomic<std::uint64_t> written_{0};
    alignas(64) std::atomic<std::uint64_t> read_{0};
};

}  // namespace seldinger

#pragma once
// The newest value from one thread to another; neither waits for the other. There are three places: one being written, one being
// read, and the newest between them.

#include <array>
#include <atomic>

namespace seldinger {

template <class T>
class TripleBuffer {
public:
    TripleBuffer() = default;
    explicit TripleBuffer(const T& first) : places_{first, first, first} {}

    /// Where the writer writes; holds some older value.
    [[nodiscard]] T& back() { return places_[back_]; }
    /// The written buffer becomes the newest.
    void publish() { back_ = middle_.exchange(back_ | fresh, std::memory_order_acq_rel) & place; }
    void put(const T& value)
    {
        back() = value;
        publish();
    }

    /// The reader takes the newest. @return whether it is newer than the one that it had
    bool take()
    {
        if (!(middle_.load(std::memory_order_relaxed) & fresh)) return false;
        front_ = middle_.exchange(front_, std::memory_order_acq_rel) & place;
        return true;
    }
    /// What the reader took last.
    [[nodiscard]] const T& front() const { return places_[front_]; }

private:
    static constexpr unsigned place = 3, fresh = 4;
    std::array<T, 3> places_{};
    alignas(64) std::atomic<unsigned> middle_{1};
    alignas(64) unsigned back_ = 0;
    alignas(64) unsigned front_ = 2;
};

}  // namespace seldinger

#pragma once
// The controller of a scene: key frames ([feed] keys) as a control that serves every step of a run.

#include "engine.h"

#include <span>
#include <vector>

namespace seldinger {

struct Scene;

class KeyFrames {
public:
    /// @param keys  per instrument, times increasing [s]; empty: the instrument is not fed
    explicit KeyFrames(std::vector<std::vector<FeedKey>> keys);
    /// Key frames of the instruments of each scene in turn.
    explicit KeyFrames(std::span<const Scene> scenes);
    explicit KeyFrames(const Scene& scene);
    KeyFrames(const KeyFrames& other) : KeyFrames(other.keys_) {}
    KeyFrames(KeyFrames&&) noexcept = default;  // the keys stay where they are in memory
    KeyFrames& operator=(KeyFrames&&) noexcept = default;

    /// Control of any step: each hub follows its keys. It refers to this object's keys.
    [[nodiscard]] const Control& control() const { return control_; }

private:
    std::vector<std::vector<FeedKey>> keys_;
    Control control_;
};

}  // namespace seldinger

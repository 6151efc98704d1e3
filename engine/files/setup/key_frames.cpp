// Key frames as a control.
#include "setup/key_frames.h"

#include "scene/scene.h"

#include <utility>

namespace seldinger {
namespace {

std::vector<std::vector<FeedKey>> keys_of(std::span<const Scene> scenes)
{
    std::vector<std::vector<FeedKey>> keys;
    for (const Scene& scene : scenes)
        for (int k = 0; k < scene.instrument_count(); ++k) keys.push_back(scene.instrument(k).feed.keys);
    return keys;
}

}  // namespace

KeyFrames::KeyFrames(std::vector<std::vector<FeedKey>> keys) : keys_(std::move(keys))
{
    for (std::size_t k = 0; k < keys_.size(); ++k)
        if (!keys_[k].empty()) control_.follow(static_cast<int>(k), keys_[k]);
}

KeyFrames::KeyFrames(std::span<const Scene> scenes) : KeyFrames(keys_of(scenes)) {}
KeyFrames::KeyFrames(const Scene& scene) : KeyFrames(std::span(&scene, 1)) {}

}  // namespace seldinger

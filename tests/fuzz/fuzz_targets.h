#pragma once
// What is fed with any bytes: each reader of meshes, and what a mesh goes through before a run. An Error is an answer; anything
// else that is thrown, and whatever the sanitizers see, is a crash.

#include <cstddef>
#include <cstdint>

namespace seldinger::fuzz {

struct Target {
    const char* name;
    void (*run)(const std::uint8_t* bytes, std::size_t size);
};

/// @return null when there is none of that name
[[nodiscard]] const Target* find_target(const char* name);

}  // namespace seldinger::fuzz

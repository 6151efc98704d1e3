#pragma once
// Each reader of outside data, fed with any bytes. An Error is an answer; anything else that is thrown, and whatever the
// sanitizers see, is a crash. Where a checksum guards a file it is put right first, so that the code behind it is reached.

#include <cstddef>
#include <cstdint>
#include <span>

namespace seldinger::fuzz {

using Bytes = std::span<const std::uint8_t>;

// fuzz_meshes.cpp
void stl(Bytes bytes);
void obj(Bytes bytes);
void ply(Bytes bytes);
void vtp(Bytes bytes);
void vtk(Bytes bytes);
void label(Bytes bytes);
void centreline(Bytes bytes);
void pipeline(Bytes bytes);
void pipeline_raw(Bytes bytes);

// fuzz_scenes.cpp
void scene(Bytes bytes);
void sweep(Bytes bytes);

// fuzz_saved.cpp
void checkpoint(Bytes bytes);
void record(Bytes bytes);
void farm(Bytes bytes);
void kept(Bytes bytes);

// fuzz_live.cpp
void web(Bytes bytes);
void hand(Bytes bytes);

}  // namespace seldinger::fuzz

#pragma once
// Reads what `seldinger run` leaves in a folder, as far as a picture needs it.

#include "view/renderer.h"

#include <filesystem>
#include <vector>

namespace seldinger {

/// One recorded frame, not yet read.
struct FrameFile {
    double time = 0;                           // [s]
    std::vector<std::filesystem::path> wires;  // wire_######.vtp, or NAME_######.vtp of each instrument
    std::vector<std::string> names;            // of the instruments; "" of the only one
    std::filesystem::path contacts;            // contacts_######.vtp; may be absent
    std::filesystem::path wall;                // wall_######.vtp; may be absent
};

/// One row of trace.csv, as far as it is shown.
struct TraceRow {
    double time = 0, inserted = 0, hand_force = 0;  // [s], [m], [N]
};

struct RunFolder {
    WallMesh wall;                  // vessel.vtp, normals into the lumen; empty when there is none
    std::vector<FrameFile> frames;  // in the order of wire.pvd, at least one
    std::vector<TraceRow> trace;    // may be empty
};

/// @throws Error BadFile: no such folder, no wire.pvd, no frame in it, a damaged file
[[nodiscard]] RunFolder read_run_folder(const std::filesystem::path& dir);

/// The wall where it had moved to in a frame. @throws Error BadFile: nothing recorded beside that frame, or damaged
[[nodiscard]] MovedWall read_moved_wall(const RunFolder& run, std::size_t index, WallQuantity quantity);

/// The largest value in any wall_*.vtp of the run, whichever frames are drawn: reads them all.
/// @throws Error BadFile: the run recorded no wall that yields, or a damaged file
[[nodiscard]] double largest_on_wall(const RunFolder& run, const std::filesystem::path& dir, WallQuantity quantity);

/// @throws Error BadFile: the frame's file is missing or damaged
[[nodiscard]] WireFrame read_frame(const RunFolder& run, std::size_t index);

}  // namespace seldinger

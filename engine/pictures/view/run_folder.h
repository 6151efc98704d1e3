#pragma once
// Reads the folder of `seldinger run`, as far as a picture needs it.

#include "core/folder.h"
#include "view/renderer.h"

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

namespace seldinger {

/// One recorded frame, not yet read.
struct FrameFile {
    double time = 0;                           // [s]
    std::int64_t step = -1;                    // of the run, from the names of its files; -1: they have no number
    std::vector<std::filesystem::path> wires;  // wire_######.vtp, or NAME_######.vtp of each instrument
    std::vector<std::string> names;            // of the instruments; "" of the only one
    std::filesystem::path contacts;            // contacts_######.vtp; may be absent
    std::filesystem::path wall;                // wall_######.vtp; may be absent
};

/// One row of trace.csv, as far as it is shown.
struct TraceRow {
    double time = 0, inserted = 0, hand_force = 0, hand_torque = 0, per_length = 0;  // [s], [m], [N], [N m], [N/m]
};

struct RunFolder {
    std::optional<TargetMark> target;  // of [task]; none in a folder without summary.json
    Folder folder;                  // where it all lies; a link in it is not followed
    WallMesh wall;                  // vessel.vtp, normals into the lumen; empty when there is none
    std::vector<FrameFile> frames;  // in the order of wire.pvd, at least one
    std::vector<TraceRow> trace;    // may be empty
    std::map<std::string, std::vector<TraceRow>> own_trace;  // of each of several instruments, by its name; may lack some
};

/// @throws Error BadFile: no such folder, no wire.pvd, no frame in it, a damaged file
[[nodiscard]] RunFolder read_run_folder(const std::filesystem::path& dir);

/// Whether a file of a frame exists: contacts and wall may be absent.
[[nodiscard]] bool is_there(const RunFolder& run, const std::filesystem::path& file);

/// The wall where it had moved to in a frame. @throws Error BadFile: nothing recorded beside that frame, or damaged
[[nodiscard]] MovedWall read_moved_wall(const RunFolder& run, std::size_t index, WallQuantity quantity);

/// The largest value in any wall_*.vtp of the run, whichever frames are drawn: reads them all.
/// @throws Error BadFile: the run recorded no elastic wall, or a damaged file
[[nodiscard]] double largest_on_wall(const RunFolder& run, const std::filesystem::path& dir, WallQuantity quantity);

/// What the pictures of a run share, so that a frame looks the same alone and in a series.
struct RunReach {
    std::vector<Vec3> nodes;  // of the instruments in any frame
    double strongest = 0;     // contact force in any frame [N]
    double load = 0;          // contact force per length along the wire in any frame [N/m]
};

/// Reads every frame once. @throws Error BadFile: a frame's file is missing or damaged
[[nodiscard]] RunReach reach_of(const RunFolder& run);

/// @throws Error BadFile: the frame's file is missing or damaged
[[nodiscard]] WireFrame read_frame(const RunFolder& run, std::size_t index);

}  // namespace seldinger

#pragma once
// What a batch keeps of each run beside its row: a trace, and the last shape of each instrument.

#include "core/folder.h"
#include "output.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace seldinger {

struct Scene;

/// Files of one finished run, by their names: 000012.csv, 000012_wire.vtp.
using KeptFiles = std::vector<std::pair<std::string, std::string>>;

/// @return words of --keep as settings of the scene @throws Error BadScene: an unknown word
[[nodiscard]] std::vector<std::string> keep_settings(const std::string& words);

/// Columns of a kept trace: those of trace.csv that cost no search for contacts.
[[nodiscard]] std::string kept_header();
/// @param readings  of all instruments as one   @param tip  of the first
[[nodiscard]] std::string kept_row(std::int64_t step, double time, const WireReadings& readings, const Vec3& tip);

/// @param trace  empty: not kept   @param wires  of the run, with Output::Shape; empty: not kept
[[nodiscard]] KeptFiles kept_files(std::int64_t run, const Scene& scene, const std::string& trace,
                                   const std::vector<WireOutput>& wires);

/// Writes them into `folder`/runs, which is made.
void write_kept(const Folder& folder, const KeptFiles& files);
/// Copies what write_kept() wrote, where it is not yet.
void copy_kept(const Folder& from, const Folder& to);
/// Removes what write_kept() wrote, and runs/ if nothing else is in it.
void remove_kept(const Folder& folder);

}  // namespace seldinger

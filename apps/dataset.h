#pragma once
// What a data set shares with `farm`, which runs its parts, and with `labels`, which knows COCO.

#include "core/error.h"
#include "core/folder.h"

#include <filesystem>
#include <vector>

namespace seldinger::apps {

/// Splits the runs of a data set by vessel and writes what describes all of it. All runs are there. @throws Error
ErrorKind finish_dataset(const std::filesystem::path& dir, bool quiet);

/// COCO annotations of pictures. @param files  NAME.json, each beside its NAME_mask.png   @throws Error BadFile
void write_coco(const std::vector<std::filesystem::path>& files, const FilePlace& to, bool quiet);

/// Says in how many pictures the field cuts an instrument off. @param files  as above   @throws Error BadFile
void warn_of_field(const std::vector<std::filesystem::path>& files);

}  // namespace seldinger::apps

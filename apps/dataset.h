#pragma once
// What a data set shares with `farm`, which runs its parts, and with `labels`, which knows COCO.

#include "core/error.h"
#include "core/folder.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::apps {

/// Splits the runs of a data set by vessel and writes what describes all of it. All runs are there. @throws Error
ErrorKind finish_dataset(const std::filesystem::path& dir, bool quiet);

/// In how many pictures the field cuts off an instrument, and its tip; in the order in which pictures name them.
class FieldCuts {
public:
    /// @param instruments  of one NAME.json
    void take_in(const nlohmann::json& instruments);
    /// A line on stderr for each that is cut off.
    void warn() const;

private:
    struct Cut {
        std::string name;
        int pictures = 0, cut = 0, tip_outside = 0;
    };
    std::vector<Cut> cuts_;
};

/// COCO annotations of pictures. @param files  NAME.json, each beside its NAME_mask.png   @throws Error BadFile
void write_coco(const std::vector<std::filesystem::path>& files, const FilePlace& to, bool quiet);

}  // namespace seldinger::apps

#pragma once
// The files beside a picture NAME.png that hold its labels: NAME.json, NAME_mask.png, NAME_lumen.png, NAME_depth.npy.

#include "pictures/labels.h"
#include "view/frame_range.h"

#include <filesystem>
#include <string>

namespace seldinger {

/// The text of NAME.json. Numbers read back to the same bits. @param picture  name of the picture's file
[[nodiscard]] std::string label_json(const PictureTruth& truth, const std::string& picture);

/// Whether all labels that are asked for are there. They are written before their picture, so a killed run misses the picture.
/// @param depth  whether depths are among them: of an ordinary view
[[nodiscard]] bool labels_exist(const FrameChoice& choice, const std::filesystem::path& picture, bool depth);

/// Into choice.labels, which is made. Each file appears when it is complete. @throws Error BadFile
void write_labels(const FrameChoice& choice, const std::filesystem::path& picture, const PictureTruth& truth);

}  // namespace seldinger

#pragma once
// `seldinger report`: one HTML file with everything inside: vessel, frames, plots, summary and settings of a run, or the table of
// a batch.

#include <filesystem>
#include <string>

namespace seldinger {

/// @throws Error BadFile: DIR holds neither a run nor a batch, or three.js is not installed
[[nodiscard]] std::string report_page(const std::filesystem::path& dir);

}  // namespace seldinger

#pragma once
// A contact sheet: pictures side by side with their labels drawn in, to look at before many are made.

#include "pictures/labels.h"
#include "view/canvas.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace seldinger {

class LabelSheet {
public:
    static constexpr std::size_t most_pictures = 16;
    /// Which frame and which view picture i of `count` shows: spread evenly over both, none twice. count <= frames x views
    struct Pick {
        std::size_t frame, view;
    };
    [[nodiscard]] static Pick pick(std::size_t i, std::size_t count, std::size_t frames, std::size_t views);

    /// @param pictures  how many at most  @param width,height  of each [pixels]. @throws Error BadFile: no font
    LabelSheet(std::size_t pictures, int width, int height);

    /// The next picture: its mask tinted, tip, contacts and centreline marked. @param rgb  rows from the top
    void add(std::span<const std::uint8_t> rgb, const PictureTruth& truth, const std::string& caption);
    /// @throws Error BadFile
    void write(const std::filesystem::path& path) const;

private:
    void shrink(std::span<const std::uint8_t> rgb, const std::vector<std::uint8_t>& mask, int left, int top);
    void mark(const PictureTruth& truth, int left, int top);

    int columns_, width_, height_, tile_width_, tile_height_, sheet_width_, sheet_height_;
    std::size_t count_ = 0;
    Font font_;
    std::vector<std::uint8_t> pixels_;
};

}  // namespace seldinger

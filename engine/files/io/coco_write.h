#pragma once
// Masks and keypoints in the format of COCO's annotations (cocodataset.org, "format-data"), as pycocotools opens them. Runs are
// compressed as pycocotools' maskApi.c does it, so that training code needs no conversion.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace seldinger {

/// Lengths of runs without and with a label in turn, column after column, beginning without it (0 where it is in the corner).
[[nodiscard]] std::vector<std::uint32_t> label_runs(std::span<const std::uint8_t> mask, int width, int height,
                                                    std::uint8_t label);

/// Their text: differences to the run before the last, five bits a letter from '0' on.
[[nodiscard]] std::string coco_text(std::span<const std::uint32_t> runs);

struct CocoPoint {
    double column = 0, row = 0;
    bool visible = false;
};

class CocoWriter {
public:
    /// The category of a name, a new one where there is none. Its keypoints are tip and base.
    int category(const std::string& name);
    /// @return its id
    int add_image(const std::string& file, int width, int height);
    /// An instrument on the picture added last; without a pixel it is left out.
    void add(int category, std::span<const std::uint8_t> mask, std::uint8_t label, const CocoPoint& tip, const CocoPoint& base);
    /// The file's text.
    [[nodiscard]] std::string finish() const;
    [[nodiscard]] std::size_t annotation_count() const { return annotations_.size(); }

private:
    struct Image {
        std::string file;
        int width, height;
    };
    struct Annotation {
        int image, category;
        std::string runs;
        std::uint64_t area;
        int box[4];  // column, row, width, height
        CocoPoint tip, base;
    };
    std::vector<std::string> categories_;
    std::vector<Image> images_;
    std::vector<Annotation> annotations_;
};

}  // namespace seldinger

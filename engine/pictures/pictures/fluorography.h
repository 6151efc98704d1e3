#pragma once
// One run for a fluoroscope, frame by frame.

#include "pictures/fluoro_run.h"
#include "pictures/labels.h"
#include "xray/detector.h"
#include "xray/fluoroscope.h"

namespace seldinger {

class Fluorography {
public:
    /// @param options  must outlive it. @param contrast  whether their contrast medium is there. @throws Error BadFile, BadScene
    Fluorography(const std::filesystem::path& dir, const FluoroOptions& options, bool contrast);

    [[nodiscard]] const RunFolder& run() const { return run_; }
    [[nodiscard]] const CArm& arm() const { return arm_; }
    Fluoroscope& scope() { return scope_; }

    /// Looks at a frame as the C-arm stands at `time`.
    void look(std::size_t index, double time);

    /// Places of everything in the current frame, without a mask.
    [[nodiscard]] PictureTruth located() const;
    /// With the mask. @param vessel  whether the lumen's thickness too
    [[nodiscard]] PictureTruth truth(bool vessel) const;

    /// The picture of the current frame; valid until the next. @param stream  that its noise is drawn with
    const std::vector<float>& picture(std::uint64_t stream)
    {
        return detector_.read(scope_.exposure(), options_.noise ? std::optional(stream) : std::nullopt);
    }

private:
    void aim(double time);
    [[nodiscard]] WallMesh wall_of(std::size_t index) const;

    const FluoroOptions& options_;
    RunFolder run_;
    CArm arm_;
    bool contrast_;
    std::vector<Material> matter_;
    Fluoroscope scope_;
    Detector detector_;
    WireFrame frame_;  // that was looked at
    bool walls_, aimed_ = false;
};

}  // namespace seldinger

// Takes vessel, instruments, contrast and the arm's angles of each frame from the run's files.
#include "pictures/fluorography.h"

#include "core/error.h"
#include "repair/repair.h"
#include "vessel/extract_centreline.h"
#include "vessel/inside.h"

#include <algorithm>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

Vec3 middle_of(const RunFolder& run)
{
    Box3 box;
    for (const Vec3& v : run.wall.vertices) box.extend(v);
    if (box.isEmpty())
        for (const WireLine& wire : read_frame(run, run.frames.size() - 1).wires)
            for (const Vec3& node : wire.nodes) box.extend(node);
    return box.center();
}

Bolus find_bolus(const RunFolder& run, const FluoroOptions::Injection& injection)
{
    if (run.wall.triangles.empty()) throw Error(ErrorKind::BadScene, "contrast: the run has no vessel for it to flow in");
    const RepairReport report = describe(run.wall);
    const Centreline centreline = extract_centreline(run.wall, report.loops, LumenQuery(run.wall, report.loops));
    return make_bolus(centreline, injection);
}

}  // namespace

Fluorography::Fluorography(const fs::path& dir, const FluoroOptions& options, bool contrast)
    : options_(options),
      run_(read_run_folder(dir)),
      arm_(options.arm),
      contrast_(contrast && options.contrast),
      matter_(materials_of(options.instruments)),
      scope_(options.kev > 0 ? single_energy(options.kev) : tube_spectrum(options.kvp)),
      detector_({options.photons, options.blur / options.arm.pixel(), options.seed}),
      walls_(std::any_of(run_.frames.begin(), run_.frames.end(), [this](const FrameFile& f) { return is_there(run_, f.wall); }))
{
    if (options.auto_isocentre) arm_.isocentre = middle_of(run_);
    if (contrast_) scope_.set_bolus(find_bolus(run_, *options.contrast));
    scope_.set_wall(run_.wall);
    if (!options.body.isZero()) scope_.set_body(options.body);
    if (!options.bone.empty()) scope_.set_bone(load_bone(options));
}

void Fluorography::look(std::size_t index, double time)
{
    aim(time);
    if (walls_) scope_.set_wall(wall_of(index));
    std::vector<Device> devices;
    frame_ = read_frame(run_, index);
    for (const WireLine& wire : frame_.wires)
        if (wire.nodes.size() > 1) devices.push_back(device_of(wire, options_.instruments));
    scope_.look(std::move(devices), matter_, contrast_ ? std::optional<double>(time) : std::nullopt);
}

PictureTruth Fluorography::located() const
{
    PictureTruth truth = locate(scope_.view(), frame_, drawn_lines(frame_));
    truth.arm = arm_;
    return truth;
}

PictureTruth Fluorography::truth(bool vessel) const
{
    PictureTruth truth = located();
    add_mask(truth, drawn_lines(frame_), false);
    if (vessel) truth.lumen = scope_.lumen_thickness();
    return truth;
}

void Fluorography::aim(double time)
{
    CArm arm = arm_;
    turn_arm(arm, options_.turning, time);
    if (aimed_ && arm.primary == arm_.primary && arm.secondary == arm_.secondary) return;
    arm_ = arm;
    scope_.set_view(arm_);
    aimed_ = true;
}

WallMesh Fluorography::wall_of(std::size_t index) const
{
    WallMesh wall = run_.wall;
    if (is_there(run_, run_.frames[index].wall))
        wall.vertices = read_moved_wall(run_, index, WallQuantity::Displacement).vertices;
    return wall;
}

}  // namespace seldinger

// Points the engine's fluoroscope at systems of a world and keeps it for the next pictures: wall and body are traced once.
#include "fluoro.h"

#include "handle.h"

#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#ifdef SEL_WITH_VIEW
    #include "pictures/fluoro_scene.h"
    #include "pictures/labels.h"
    #include "xray/detector.h"
    #include "xray/fluoroscope.h"
#endif

namespace seldinger::python {

namespace py = pybind11;

namespace {

/// What pictures are asked to be.
struct Ask {
    int width = 0, height = 0;
    std::optional<std::string> angles;
    std::optional<double> field;
    bool noise = true;
    bool labels = false, lumen = false;
};

/// One of them.
struct Shot {
    int system = 0;
    std::uint64_t frame = 0;  // the noise is drawn with
};

#ifdef SEL_WITH_VIEW

/// A picture, with its ground truth on request.
struct Taken {
    std::vector<std::uint16_t> grey;
    std::optional<PictureTruth> truth;
};

/// One system as a frame. @param each  instruments of a system
WireFrame frame_of(const Output& output, const Shot& shot, std::size_t each, const std::vector<InstrumentMatter>& matter)
{
    WireFrame frame;
    const auto of = static_cast<std::size_t>(shot.system);
    const WireOutput* wires = &output.wires[of * each];
    for (std::size_t k = 0; k < each; ++k) {
        WireLine line{
            wires[k].position, wires[k].radius, matter[k].name, {}, wires[k].readings.hand_force, wires[k].readings.hand_torque};
        frame.wires.push_back(std::move(line));
    }
    const int first = static_cast<int>(of * each), end = first + static_cast<int>(each);
    for (const ContactRow& row : output.contacts) {
        if (row.a.body < first || row.a.body >= end) continue;
        const int other = row.b.kind == BodyKind::Wall ? -1 : row.b.body - first;
        frame.contacts.push_back(
            {row.point, row.normal, row.normal_force, row.per_length, row.region, row.friction, row.a.body - first, other});
    }
    frame.time = wires->time, frame.step = static_cast<std::int64_t>(output.step);
    return frame;
}

Vec3 middle_of(const WallMesh& mesh, const Output& output)
{
    Box3 box;
    for (const Vec3& v : mesh.vertices) box.extend(v);
    if (box.isEmpty())
        for (const Vec3& node : output.wires.front().position) box.extend(node);
    return box.center();
}

/// A fluoroscope in front of a world.
class Fluoroscopy {
public:
    Fluoroscopy(const Handle& handle, const Ask& ask, const Output& output)
        : width_(ask.width), height_(ask.height), angles_(ask.angles), field_(ask.field),
          options_(fluoro_options(handle.scene(), false)), scope_(tube_spectrum(options_.kvp))
    {
        const WorldSetup& setup = handle.world().setup();
        CArm& arm = options_.arm;
        arm.columns = ask.width, arm.rows = ask.height;
        if (ask.field) arm.field = *ask.field;
        if (ask.angles) options_.turning.clear(), set_angles(arm, *ask.angles);
        if (options_.auto_isocentre) arm.isocentre = middle_of(setup.mesh, output);
        check(arm);
        detector_.emplace(DetectorSpec{options_.photons, options_.blur / arm.pixel(), options_.seed});
        if (options_.contrast) scope_.set_bolus(make_bolus(setup.centreline, *options_.contrast));
        scope_.set_wall(setup.mesh);
        if (!options_.body.isZero()) scope_.set_body(options_.body);
        if (!options_.bone.empty()) scope_.set_bone(load_bone(options_));
        for (int s = 0; s < handle.world().system_count(); ++s) matter_.push_back(fluoro_options(handle.scene(s)).instruments);
    }

    [[nodiscard]] bool fits(const Ask& ask) const
    {
        return ask.width == width_ && ask.height == height_ && ask.angles == angles_ && ask.field == field_;
    }

    Taken look(const World& world, const Output& output, const Shot& shot, const Ask& ask)
    {
        const auto of = static_cast<std::size_t>(shot.system);
        const std::size_t each = output.wires.size() / matter_.size();
        const WireOutput* wires = &output.wires[of * each];
        const double time = wires->time;
        aim(time);
        move_wall(world.setup().mesh, output, of);
        const WireFrame frame = frame_of(output, shot, each, matter_[of]);
        std::vector<Device> devices;
        for (const WireLine& wire : frame.wires)
            if (wire.nodes.size() > 1) devices.push_back(device_of(wire, matter_[of]));
        scope_.look(std::move(devices), materials_of(matter_[of]), options_.contrast ? std::optional(time) : std::nullopt);
        const auto& signal = detector_->read(scope_.exposure(), ask.noise ? std::optional(shot.frame) : std::nullopt);
        Taken taken{grey_levels(signal, scope_.reference(), false), std::nullopt};
        if (!ask.labels) return taken;
        taken.truth = locate(scope_.view(), frame, drawn_lines(frame));
        taken.truth->arm = options_.arm;
        add_mask(*taken.truth, drawn_lines(frame), false);
        if (ask.lumen) taken.truth->lumen = scope_.lumen_thickness();
        return taken;
    }

private:
    void aim(double time)
    {
        CArm arm = options_.arm;
        turn_arm(arm, options_.turning, time);
        if (aimed_ && arm.primary == options_.arm.primary && arm.secondary == options_.arm.secondary) return;
        options_.arm = arm;
        scope_.set_view(arm);
        aimed_ = true;
    }

    void move_wall(const WallMesh& mesh, const Output& output, std::size_t of)
    {
        if (of >= output.walls.size() || output.walls[of].displacement.size() != mesh.vertices.size()) return;
        WallMesh moved = mesh;
        for (std::size_t i = 0; i < moved.vertices.size(); ++i) moved.vertices[i] += output.walls[of].displacement[i];
        scope_.set_wall(moved);
    }

    int width_, height_;
    std::optional<std::string> angles_;
    std::optional<double> field_;
    FluoroOptions options_;
    Fluoroscope scope_;
    std::optional<Detector> detector_;
    bool aimed_ = false;
    std::vector<std::vector<InstrumentMatter>> matter_;  // of each system
};

using Lanes = std::vector<std::unique_ptr<Fluoroscopy>>;

/// The fluoroscopes of the last few views, the newest first: whoever looks from two sides by turns has wall and body traced once
/// for each.
using Views = std::vector<Lanes>;
constexpr std::size_t most_views = 4;

Lanes& lanes_for(Handle& handle, const Ask& ask)
{
    auto views = std::static_pointer_cast<Views>(handle.fluoroscope);
    if (!views) handle.fluoroscope = views = std::make_shared<Views>();
    const auto fits = [&](const Lanes& lanes) { return !lanes.empty() && lanes.front() && lanes.front()->fits(ask); };
    const auto found = std::ranges::find_if(*views, fits);
    if (found != views->end()) {
        std::rotate(views->begin(), found, found + 1);
    } else {
        views->insert(views->begin(), Lanes{});
        if (views->size() > most_views) views->pop_back();
    }
    return views->front();
}

/// The pictures one after the other. Several threads take every so many-th each, with a fluoroscope of their own.
std::vector<Taken> take(Handle& handle, const Ask& ask, const std::vector<Shot>& shots)
{
    const std::shared_ptr<const Output> output = handle.output();
    Lanes& kept = lanes_for(handle, ask);
    const std::size_t lanes = std::min(shots.size(), static_cast<std::size_t>(thread_slot_count()));
    kept.resize(std::max(kept.size(), lanes));
    std::vector<Taken> taken(shots.size());
    for_each_item(static_cast<int>(lanes), 1, [&](int lane) {
        std::unique_ptr<Fluoroscopy>& scope = kept[static_cast<std::size_t>(lane)];
        if (!scope) scope = std::make_unique<Fluoroscopy>(handle, ask, *output);
        for (auto k = static_cast<std::size_t>(lane); k < shots.size(); k += lanes)
            taken[k] = scope->look(handle.world(), *output, shots[k], ask);
    });
    return taken;
}

using Reals = py::array_t<double>;

Reals rows_of(const std::vector<Vec3>& points)
{
    Reals made({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
    double* out = made.mutable_data();
    for (const Vec3& p : points)
        for (int k = 0; k < 3; ++k) *out++ = p[k];
    return made;
}

Reals rows_of(const std::vector<PixelPoint>& points)
{
    Reals made({static_cast<py::ssize_t>(points.size()), py::ssize_t{2}});
    double* out = made.mutable_data();
    for (const PixelPoint& p : points) *out++ = p.column, *out++ = p.row;
    return made;
}

py::dict instrument_labels(const InstrumentTruth& of)
{
    py::array_t<bool> in_field(static_cast<py::ssize_t>(of.pixels.size()));
    std::ranges::transform(of.pixels, in_field.mutable_data(), [](const PixelPoint& p) { return p.in_field; });
    std::vector<Vec3> positions, forces;
    std::vector<PixelPoint> pixels;
    for (const ContactTruth& c : of.contacts)
        positions.push_back(c.position), pixels.push_back(c.pixel), forces.push_back(c.force);
    py::dict out;
    out["name"] = of.name, out["radius_m"] = of.radius;
    const Reals line = rows_of(of.centreline), line_px = rows_of(of.pixels);
    out["tip_m"] = of.centreline.empty() ? py::object(py::none()) : line.attr("__getitem__")(0);
    out["tip_px"] = of.centreline.empty() ? py::object(py::none()) : line_px.attr("__getitem__")(0);
    out["centreline_m"] = line, out["centreline_px"] = line_px, out["in_field"] = in_field;
    out["hand_force_n"] = of.hand_force, out["hand_torque_nm"] = of.hand_torque;
    out["contacts"] = py::dict(py::arg("position_m") = rows_of(positions), py::arg("position_px") = rows_of(pixels),
                               py::arg("force_n") = rows_of(forces));
    return out;
}

/// As NAME.json has it, with arrays in place of lists and files.
py::dict labels_of(const PictureTruth& truth)
{
    const CArmView& view = truth.view;
    const Projection p = projection_of(view);
    Reals projection({3, 4});
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 4; ++k) projection.mutable_at(i, k) = p[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
    const auto vector = [](const Vec3& v) { return rows_of(std::vector<Vec3>{v}).attr("__getitem__")(0); };
    const double degrees = 180 / std::numbers::pi;
    py::dict out;
    out["time_s"] = truth.time, out["step"] = truth.step;
    out["image"] = py::dict(py::arg("width") = view.columns, py::arg("height") = view.rows, py::arg("pixel_m") = view.pixel);
    out["camera"] = py::dict(py::arg("projection") = projection, py::arg("source_m") = vector(view.source),
                             py::arg("right") = vector(view.right), py::arg("up") = vector(view.up),
                             py::arg("towards_detector") = vector(view.direction), py::arg("sid_m") = view.sid,
                             py::arg("sod_m") = view.sod, py::arg("primary_deg") = truth.arm->primary * degrees,
                             py::arg("secondary_deg") = truth.arm->secondary * degrees);
    py::list instruments;
    for (const InstrumentTruth& of : truth.instruments) instruments.append(instrument_labels(of));
    out["instruments"] = instruments;
    const std::array<py::ssize_t, 2> shape = {view.rows, view.columns};
    out["mask"] = py::array_t<std::uint8_t>(shape, truth.mask.data());
    if (!truth.lumen.empty()) out["lumen_m"] = py::array_t<float>(shape, truth.lumen.data());
    return out;
}

#else

struct Taken {
    std::vector<std::uint16_t> grey;
    std::optional<int> truth;
};

py::dict labels_of(int) { return {}; }

std::vector<Taken> take(Handle&, const Ask&, const std::vector<Shot>&)
{
    throw Error(ErrorKind::BadScene, "fluoroscopy: this build has no pictures; configure with -DSELDINGER_VIEW=ON");
}

#endif

}  // namespace

void bind_fluoroscopy(py::module_& module)
{
    module.def(
        "fluoroscopy",
        [](Handle& handle, const std::vector<int>& systems, int width, int height, const std::optional<std::string>& angles,
           std::optional<double> field, bool noise, const std::vector<std::uint64_t>& frames, bool labels,
           bool lumen) -> py::object {
            const Ask ask{width, height, angles, field, noise, labels, lumen};
            check_process();
            std::vector<Shot> shots;
            for (std::size_t k = 0; k < systems.size(); ++k) {
                if (systems[k] < 0)
                    throw Error(ErrorKind::BadScene,
                                "fluoroscopy: got system " + std::to_string(systems[k]) + "; expected 0 or more");
                shots.push_back({systems[k], frames.at(k)});
            }
            std::vector<Taken> taken;
            {
                const py::gil_scoped_release others;
                const std::lock_guard hold(handle.lock());
                for (const Shot& shot : shots) handle.check_system(shot.system);
                taken = take(handle, ask, shots);
            }
            py::array_t<std::uint16_t> made({static_cast<py::ssize_t>(shots.size()), py::ssize_t{height}, py::ssize_t{width}});
            std::uint16_t* out = made.mutable_data();
            py::list truths;
            for (const Taken& one : taken) {
                out = std::ranges::copy(one.grey, out).out;
                if (one.truth) truths.append(labels_of(*one.truth));
            }
            if (!labels) return made;
            return py::make_tuple(made, truths);
        });
}

}  // namespace seldinger::python

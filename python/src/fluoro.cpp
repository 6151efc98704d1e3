// Points the engine's fluoroscope at systems of a world and keeps it for the next pictures: wall and body are traced once.
#include "fluoro.h"

#include "handle.h"

#include "core/parallel.h"

#include <algorithm>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#ifdef SEL_WITH_VIEW
    #include "fluoro_scene.h"
    #include "view/xray/detector.h"
    #include "view/xray/fluoroscope.h"

    #include <Eigen/Geometry>
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
};

/// One of them.
struct Shot {
    int system = 0;
    std::uint64_t frame = 0;  // the noise is drawn with
};

#ifdef SEL_WITH_VIEW

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
          options_(apps::fluoro_options(handle.scene(), false)), scope_(tube_spectrum(options_.kvp))
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
        for (int s = 0; s < handle.world().system_count(); ++s) matter_.push_back(apps::fluoro_options(handle.scene(s)).instruments);
    }

    [[nodiscard]] bool fits(const Ask& ask) const
    {
        return ask.width == width_ && ask.height == height_ && ask.angles == angles_ && ask.field == field_;
    }

    std::vector<std::uint16_t> look(const World& world, const Output& output, const Shot& shot, bool noise)
    {
        const auto of = static_cast<std::size_t>(shot.system);
        const std::size_t each = output.wires.size() / matter_.size();
        const WireOutput* wires = &output.wires[of * each];
        const double time = wires->time;
        aim(time);
        move_wall(world.setup().mesh, output, of);
        std::vector<Device> devices;
        for (std::size_t k = 0; k < each; ++k)
            if (wires[k].position.size() > 1)
                devices.push_back(device_of({wires[k].position, wires[k].radius, matter_[of][k].name}, matter_[of]));
        scope_.look(std::move(devices), materials_of(matter_[of]), options_.contrast ? std::optional(time) : std::nullopt);
        const auto& signal = detector_->read(scope_.exposure(), noise ? std::optional(shot.frame) : std::nullopt);
        return grey_levels(signal, scope_.reference(), false);
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

using Fluoroscopes = std::vector<std::unique_ptr<Fluoroscopy>>;

/// The pictures one after the other. Several threads take every so many-th each, with a fluoroscope of their own.
std::vector<std::uint16_t> take(Handle& handle, const Ask& ask, const std::vector<Shot>& shots)
{
    const std::shared_ptr<const Output> output = handle.output();
    auto kept = std::static_pointer_cast<Fluoroscopes>(handle.fluoroscope);
    if (!kept) handle.fluoroscope = kept = std::make_shared<Fluoroscopes>();
    const std::size_t lanes = std::min(shots.size(), static_cast<std::size_t>(thread_slot_count()));
    kept->resize(std::max(kept->size(), lanes));
    std::vector<std::vector<std::uint16_t>> taken(shots.size());
    for_each_item(static_cast<int>(lanes), 1, [&](int lane) {
        std::unique_ptr<Fluoroscopy>& scope = (*kept)[static_cast<std::size_t>(lane)];
        if (!scope || !scope->fits(ask)) scope = std::make_unique<Fluoroscopy>(handle, ask, *output);
        for (auto k = static_cast<std::size_t>(lane); k < shots.size(); k += lanes)
            taken[k] = scope->look(handle.world(), *output, shots[k], ask.noise);
    });
    std::vector<std::uint16_t> all;
    for (const auto& grey : taken) all.insert(all.end(), grey.begin(), grey.end());
    return all;
}

#else

std::vector<std::uint16_t> take(Handle&, const Ask&, const std::vector<Shot>&)
{
    throw Error(ExitCode::BadScene, "fluoroscopy: this build has no pictures; configure with -DSELDINGER_VIEW=ON");
}

#endif

}  // namespace

void bind_fluoroscopy(py::module_& module)
{
    module.def("fluoroscopy", [](Handle& handle, const std::vector<int>& systems, int width, int height, const std::optional<std::string>& angles,
                                 std::optional<double> field, bool noise, const std::vector<std::uint64_t>& frames) {
        const Ask ask{width, height, angles, field, noise};
        check_process();
        std::vector<Shot> shots;
        for (std::size_t k = 0; k < systems.size(); ++k) {
            if (systems[k] < 0)
                throw Error(ExitCode::BadScene, "fluoroscopy: system " + std::to_string(systems[k]) + " given, 0 or more expected");
            shots.push_back({systems[k], frames.at(k)});
        }
        std::vector<std::uint16_t> grey;
        {
            const py::gil_scoped_release others;
            const std::lock_guard hold(handle.lock());
            for (const Shot& shot : shots) handle.check_system(shot.system);
            grey = take(handle, ask, shots);
        }
        py::array_t<std::uint16_t> made({static_cast<py::ssize_t>(shots.size()), py::ssize_t{height}, py::ssize_t{width}});
        std::ranges::copy(grey, made.mutable_data());
        return made;
    });
}

}  // namespace seldinger::python

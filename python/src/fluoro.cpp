// Points the engine's fluoroscope at one system of a world and keeps it for the next picture: wall and body are traced once.
#include "fluoro.h"

#include "handle.h"

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

/// What one picture is asked to be.
struct Ask {
    int system = 0, width = 0, height = 0;
    std::optional<std::string> angles;
    std::optional<double> field;
    bool noise = true;
    std::uint64_t frame = 0;  // the noise is drawn with
};

#ifdef SEL_WITH_VIEW

Vec3 middle_of(const WallMesh& mesh, const Output& output)
{
    Eigen::AlignedBox3d box;
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

    std::vector<std::uint16_t> look(const World& world, const Output& output, const Ask& ask)
    {
        const auto of = static_cast<std::size_t>(ask.system);
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
        Exposure exposure = scope_.exposure();
        if (ask.noise) add_quantum_noise(exposure, options_.photons, options_.seed, ask.frame);
        blur_picture(exposure.signal, width_, height_, options_.blur / options_.arm.pixel());
        return grey_levels(exposure.signal, scope_.reference(), false);
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
    bool aimed_ = false;
    std::vector<std::vector<InstrumentMatter>> matter_;  // of each system
};

std::vector<std::uint16_t> picture(Handle& handle, const Ask& ask)
{
    const World& world = handle.world();
    if (ask.system < 0) throw Error(ExitCode::BadScene, "fluoroscopy: system " + std::to_string(ask.system) + " given, 0 or more expected");
    handle.check_system(ask.system);
    const std::shared_ptr<const Output> output = handle.output();
    auto kept = std::static_pointer_cast<Fluoroscopy>(handle.fluoroscope);
    if (!kept || !kept->fits(ask)) handle.fluoroscope = kept = std::make_shared<Fluoroscopy>(handle, ask, *output);
    return kept->look(world, *output, ask);
}

#else

std::vector<std::uint16_t> picture(Handle&, const Ask&)
{
    throw Error(ExitCode::BadScene, "fluoroscopy: this build has no pictures; configure with -DSELDINGER_VIEW=ON");
}

#endif

}  // namespace

void bind_fluoroscopy(py::module_& module)
{
    module.def("fluoroscopy", [](Handle& handle, int system, int width, int height, const std::optional<std::string>& angles,
                                 std::optional<double> field, bool noise, std::uint64_t frame) {
        const Ask ask{system, width, height, angles, field, noise, frame};
        check_process();
        std::vector<std::uint16_t> grey;
        {
            const py::gil_scoped_release others;
            const std::lock_guard hold(handle.lock());
            grey = picture(handle, ask);
        }
        py::array_t<std::uint16_t> made({height, width});
        std::copy(grey.begin(), grey.end(), made.mutable_data());
        return made;
    });
}

}  // namespace seldinger::python

// Runs the library's studies without the interpreter's lock and hands their tables over as text and bytes.
#include "studies.h"

#include "baselines/baselines.h"
#include "plan_report.h"
#include "batch/batch.h"
#include "lab/chart.h"
#include "plan/planner.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>
#include <unordered_map>

#ifdef SEL_WITH_VIEW
    #include "view/renderer.h"
#endif

namespace seldinger::python {

namespace py = pybind11;

namespace {

using Texts = std::vector<std::string>;
/// Eye and target [m], and the direction that is up.
using CameraPose = std::optional<std::array<std::array<double, 3>, 3>>;

/// Ctrl-C, seen while the interpreter's lock is not held: asked between steps, cheap. Throws what a signal handler raised.
void check_signals()
{
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

BatchSource source_of(const std::string& text, const std::string& file, const Texts& overrides, const std::string& sweep)
{
    return make_source(text, file, overrides, sweep, "vary");
}

py::bytes batch(const std::string& text, const std::string& file, const Texts& overrides, const std::string& sweep, int device)
{
    check_process();
    std::string table;
    {
        const py::gil_scoped_release others;
        const BatchSource source = source_of(text, file, overrides, sweep);
        table = batch_npz(source.sweep, source.layout(), run_all(source, device, [](std::size_t) { check_signals(); }));
    }
    return py::bytes(table);
}

std::vector<Texts> sweep(const std::string& text, std::int64_t seed)
{
    const Sweep read = read_sweep_text(text, "vary", seed);
    std::vector<Texts> runs;
    for (std::size_t k = 0; k < read.run_count(); ++k) runs.push_back(read.overrides(k));
    return runs;
}

/// Numbers of the worlds that scenes go to, from 0; a list of overrides for each scene.
std::vector<std::size_t> world_kinds(const std::string& text, const std::string& file, const std::vector<Texts>& overrides)
{
    std::unordered_map<std::string, std::size_t> known;
    std::vector<std::size_t> kinds;
    std::optional<Scene> first;
    for (const Texts& own : overrides) {
        Scene scene = read_scene_text(text, file, own);
        if (!first) first = scene;
        const std::string kind = world_kind(std::move(scene), *first, kinds.size());
        kinds.push_back(known.try_emplace(kind, known.size()).first->second);
    }
    return kinds;
}

/// Progress reports to both studies; the last signal's exception is raised when they have stopped.
struct Watch {
    bool interrupted = false;
    bool stop()
    {
        const py::gil_scoped_acquire locked;
        if (!interrupted && PyErr_CheckSignals() != 0) interrupted = true, PyErr_Clear();
        return interrupted;
    }
};

std::string plan(const std::string& text, const std::string& file, const Texts& overrides, const PlanGoals& goals, double budget,
                 const std::string& out, int device)
{
    check_process();
    PlanOptions what;
    what.goals = goals;
    what.budget = budget;
    what.device = device;
    what.trials = std::filesystem::path(out).replace_extension(".pilots");
    Watch watch;
    what.stop = [&] { return watch.stop(); };
    const Plan made = make_plan(load_study_scene(read_scene_text(text, file, overrides), device), what);
    if (made.status == PlanStatus::Interrupted)
        throw Error(ErrorKind::Interrupted, "interrupted; trials that were finished are kept in " + what.trials.string());
    const apps::PlanFiles files = apps::plan_files(out);
    apps::write_plan(made, goals, files);
    if (made.status != PlanStatus::Planned)
        throw Error(made.status == PlanStatus::NothingHolds ? ErrorKind::Stopped : ErrorKind::NotFeasible, made.message);
    return apps::plan_json(made, goals, files);
}

std::pair<std::string, std::string> chart(const Texts& scenes, const std::string& dir, const std::string& assets, bool quick,
                                          double run_limit, double reference_limit, int device)
{
    check_process();
    ChartOptions what;
    what.dir = dir, what.scenes_folder = std::filesystem::path(assets) / "scenes";
    what.scenes = scenes, what.quick = quick, what.device = device;
    what.run_limit = run_limit, what.reference_limit = reference_limit;
    what.baselines = baselines::all();
    Watch watch;
    what.stop = [&] { return watch.stop(); };
    const ChartResult made = make_chart(what);
    if (made.interrupted) throw Error(ErrorKind::Interrupted, "interrupted; runs that were finished are kept in " + dir);
    return {chart_csv(made), references_csv(made)};
}

#ifdef SEL_WITH_VIEW

/// A renderer and its settings.
struct Picture {
    Renderer renderer;
    int width, height;
    bool legend, looked_elsewhere = false;  // a camera was given last time
};

/// Leaves no thread with OpenGL's context, whatever happens: the next to draw, or to close the world, may be another.
struct Drawing {
    Renderer& renderer;
    ~Drawing() { renderer.release(); }
};

void aim(Picture& picture, const WireFrame& frame, const CameraPose& camera)
{
    if (camera) picture.renderer.set_camera({Vec3((*camera)[0].data()), Vec3((*camera)[1].data()), Vec3((*camera)[2].data())});
    else if (picture.looked_elsewhere) {
        std::vector<Vec3> points;
        for (const WireLine& wire : frame.wires) points.insert(points.end(), wire.nodes.begin(), wire.nodes.end());
        picture.renderer.aim(points);
    }
    picture.looked_elsewhere = camera.has_value();
}

/// The wires from `first` to before `end`, those of one system or all.
WireFrame frame_of(const Output& output, const std::vector<std::string>& names, std::size_t first, std::size_t end)
{
    WireFrame frame;
    for (std::size_t k = first; k < end; ++k) {
        WireLine line;
        line.nodes = output.wires[k].position, line.radius = output.wires[k].radius;
        if (end - first > 1) line.name = names[k];
        frame.wires.push_back(std::move(line));
    }
    for (const ContactRow& row : output.contacts)
        if (row.b.kind == BodyKind::Wall && row.a.body >= static_cast<int>(first) && row.a.body < static_cast<int>(end))
            frame.contacts.push_back(
                {row.point, row.normal, row.normal_force, row.per_length, row.region + 1'000'000 * row.a.body});
    frame.time = end - first == output.wires.size() ? output.time : output.wires[first].time;
    frame.inserted = output.wires[first].readings.inserted;
    frame.hand_force = output.wires[first].readings.hand_force;
    frame.per_length = 0;
    for (std::size_t k = first; k < end; ++k)
        frame.per_length = std::max(frame.per_length, output.wires[k].on_wall.per_length_max);
    return frame;
}

py::array render(Handle& handle, int width, int height, bool legend, double force_scale,
                 const CameraPose& camera, int system)
{
    py::array_t<std::uint8_t> pixels;
    std::vector<std::uint8_t> drawn;  // a copy: once the lock is gone another thread may draw, or close the world
    check_process();
    {
        const py::gil_scoped_release others;
        const std::lock_guard hold(handle.lock());
        handle.check_system(system);
        const World& world = handle.world();
        auto picture = std::static_pointer_cast<Picture>(handle.companion);
        if (!picture || picture->width != width || picture->height != height || picture->legend != legend) {
            Look look;
            look.legend = legend, look.inset = legend;
            handle.companion.reset();
            picture = std::make_shared<Picture>(Picture{Renderer(width, height, look), width, height, legend});
            const Drawing drawing{picture->renderer};
            picture->renderer.set_wall(world.setup().mesh);
            handle.companion = picture;
        }
        const Drawing drawing{picture->renderer};
        std::vector<std::string> names;
        for (const WireSetup& wire : world.setup().wires) names.push_back(wire.name);
        const auto [first, end] = system < 0 ? std::pair(0, world.wire_count()) : world.wires_of(system);
        const WireFrame frame = frame_of(*handle.output(), names, static_cast<std::size_t>(first), static_cast<std::size_t>(end));
        aim(*picture, frame, camera);
        picture->renderer.set_force_scale(force_scale);
        picture->renderer.draw(frame);
        drawn = picture->renderer.pixels();
    }
    pixels.resize({height, width, 3});
    std::copy(drawn.begin(), drawn.end(), pixels.mutable_data());
    return pixels;
}

#else

py::array render(Handle&, int, int, bool, double, const CameraPose&, int)
{
    throw Error(ErrorKind::BadScene, "render: this build has no renderer; configure with -DSELDINGER_VIEW=ON");
}

#endif

}  // namespace

void bind_studies(py::module_& module)
{
    module.def("batch", &batch);
    module.def("sweep", &sweep);
    module.def("world_kinds", &world_kinds);
    module.def("plan", [](const std::string& text, const std::string& file, const Texts& overrides, double tolerance,
                          double force, bool relative, double peak, bool peak_relative, double rate, double budget,
                          const std::string& out, int device) {
        PlanGoals goals;
        goals.tolerance = tolerance, goals.force_tolerance = force, goals.force_is_relative = relative, goals.rate = rate;
        goals.peaks.tolerance = peak, goals.peaks.is_relative = peak_relative;
        const py::gil_scoped_release others;
        return plan(text, file, overrides, goals, budget, out, device);
    });
    module.def("chart", &chart, py::call_guard<py::gil_scoped_release>());
    module.def("render", &render);
}

}  // namespace seldinger::python

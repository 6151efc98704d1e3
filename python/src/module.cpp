// The extension seldinger._engine: worlds, states, studies and pictures for the package's own Python, which checks and documents.
#include "fluoro.h"
#include "force.h"
#include "handle.h"
#include "navigate.h"
#include "studies.h"
#include "views.h"

#include "core/exit_code.h"
#include "run/summary.h"

#include <pybind11/stl.h>

namespace seldinger::python {
namespace {

using Bytes = std::vector<std::uint8_t>;
// without NumPy's conversions: the package refuses other types before they come here
using Reals = py::array_t<double, py::array::c_style>;

/// seldinger.Error, set by the package; lives as long as the process.
PyObject* error_class = nullptr;

void raise(const Error& error)
{
    if (!error_class) return PyErr_SetString(PyExc_RuntimeError, error.what());
    const py::object made = py::handle(error_class)(std::string(error.what()), exit_code(error.kind()));
    PyErr_SetObject(error_class, made.ptr());
}

/// Runs `body` with the world locked and without the interpreter's lock.
template <class Body>
auto alone(Handle& handle, const Body& body)
{
    check_process();  // before the lock, which a thread that a forked child does not have may hold
    if (asking_handle() == &handle)
        throw Error(ErrorKind::BadScene,
                    "world: got a call from one of its own forces in the middle of a step; expected a force that "
                    "uses its points alone. Fix: read the world between steps");
    const py::gil_scoped_release others;
    const std::lock_guard hold(handle.lock());
    return body();
}

py::bytes as_bytes(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
Bytes from_bytes(const py::bytes& bytes)
{
    const auto text = static_cast<std::string_view>(bytes);
    return {text.begin(), text.end()};
}

py::tuple summary(const StepReport& report, long steps)
{
    return py::make_tuple(report.flags, report.newton_iterations, report.sub_steps, steps);
}

std::vector<HubTarget> targets_from(const Reals& targets, const py::array_t<bool, py::array::c_style>& moves)
{
    std::vector<HubTarget> list;
    for (py::ssize_t k = 0; k < targets.shape(0); ++k) list.push_back({moves.at(k), targets.at(k, 0), targets.at(k, 1)});
    return list;
}

py::tuple step(Handle& handle, const py::object& targets, const py::object& moves, long n, double dt, bool go_on,
               const Reals& loads, const Reals& pushes)
{
    std::vector<HubPush> pushed;
    for (py::ssize_t k = 0; k < pushes.shape(0); ++k)
        pushed.push_back({static_cast<int>(*pushes.data(k, 0)), *pushes.data(k, 1), *pushes.data(k, 2), *pushes.data(k, 3)});
    std::vector<PointLoad> list;
    for (py::ssize_t k = 0; k < loads.shape(0); ++k) {
        const double* row = loads.data(k, 0);
        list.push_back({static_cast<int>(row[0]), row[1], Vec3(row + 2), Vec3(row + 5)});
    }
    std::optional<std::vector<HubTarget>> asked;
    if (!targets.is_none()) asked = targets_from(targets.cast<Reals>(), moves.cast<py::array_t<bool, py::array::c_style>>());
    const StepSummary done = alone(handle, [&] { return handle.step(asked ? &*asked : nullptr, n, dt, go_on, {list, pushed}); });
    return summary(done.report, done.steps);
}

/// The state that a Python object holds: pickle makes one and fills it then, and anybody may leave that out.
const SavedState& contents(py::handle object)
{
    if (!py::isinstance<SavedState>(object)) throw py::type_error("a State expected");
    if (!reinterpret_cast<py::detail::instance*>(object.ptr())->get_value_and_holder().holder_constructed())
        throw Error(ErrorKind::BadFile, "this State has no contents; take one from World.save(), or unpickle one");
    return object.cast<const SavedState&>();
}

void bind_state(py::module_& module)
{
    py::class_<SavedState>(module, "State",
                           "A saved state of a World. It can be pickled, and restored into any world of the same scene.")
        .def_property_readonly(
            "system", [](py::handle s) { return contents(s).system; }, "int: of which system; -1: of all")
        .def_property_readonly(
            "bytes", [](py::handle s) { return as_bytes(contents(s).bytes); }, "bytes: every changing byte")
        .def(py::pickle(
            [](py::handle object) {
                const SavedState& s = contents(object);
                return py::make_tuple(s.system, as_bytes(s.bytes), s.output ? as_bytes(pack(*s.output)) : py::bytes(),
                                      as_bytes(pack(s.scores)));
            },
            [](const py::tuple& t) {
                if (t.size() != 4) throw Error(ErrorKind::BadFile, "the pickled state is damaged");
                const Bytes output = from_bytes(t[2].cast<py::bytes>());
                return SavedState{t[0].cast<int>(), from_bytes(t[1].cast<py::bytes>()), output.empty() ? nullptr : unpack(output),
                                  unpack_scores(from_bytes(t[3].cast<py::bytes>()))};
            }));
}

py::dict centreline(const World& world)
{
    const Centreline& line = world.setup().centreline;
    const auto count = static_cast<py::ssize_t>(line.points.size());
    py::array_t<double> points({count, py::ssize_t{3}}), radius(count);
    py::array_t<int> parent(count);
    for (py::ssize_t i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        for (int d = 0; d < 3; ++d) points.mutable_at(i, d) = line.points[k][d];
        radius.mutable_at(i) = line.radius[k];
        parent.mutable_at(i) = line.parent[k];
    }
    py::dict made;
    made["points"] = points, made["radius"] = radius, made["parent"] = parent;
    return made;
}

/// [task] with the keys of a scene file, as far as they are given.
py::dict task_table(const TaskSpec& task)
{
    py::dict table;
    if (!task.on) return table;
    if (!task.text.empty()) table["text"] = task.text;
    for (const auto& [key, limit] : {std::pair{"wall_force_n", task.wall_force}, std::pair{"patch_force_n", task.patch_force},
                                     std::pair{"time_s", task.time}, std::pair{"fluoroscopy_s", task.fluoroscopy}})
        if (limit > 0) table[key] = limit;
    if (task.target == TaskSpec::Target::None) return table;
    py::dict target;
    if (!task.target_name.empty()) target["name"] = task.target_name;
    if (task.target == TaskSpec::Target::Point) {
        target["point"] = std::vector<double>{task.point.x(), task.point.y(), task.point.z()};
        target["radius_m"] = task.radius;
    } else {
        if (task.branch_path.empty()) target["branch"] = task.branch;
        else target["branch"] = task.branch_path;
        target["beyond_m"] = task.beyond;
    }
    table["target"] = target;
    return table;
}

void bind_world(py::module_& module)
{
    py::class_<Handle> c(module, "World");
    made_here_only(c);
    module.def(
        "make_world",
        [](const std::string& text, const std::string& file, const std::vector<std::vector<std::string>>& overrides, int device) {
            return std::make_unique<Handle>(text, file, overrides, device);
        },
        py::call_guard<py::gil_scoped_release>());
    c.def("step", &step, py::arg("targets"), py::arg("moves"), py::arg("n"), py::arg("dt"), py::arg("go_on") = false,
          py::arg("loads") = Reals(std::vector<py::ssize_t>{0, 8}), py::arg("pushes") = Reals(std::vector<py::ssize_t>{0, 4}));
    c.def("add_force", [](Handle& h, const std::vector<int>& instruments, const py::object& own, const py::dict& about) {
        const std::shared_ptr<const Force> force = python_force(h, own, about);
        alone(h, [&] {
            const double most = force->places.empty() ? 0 : *std::ranges::max_element(force->places);
            // the one that refuses it comes first, so that none has it
            for (const int k : instruments)
                if (most > h.world().setup().wires.at(k).wire.length) h.world().add_force(k, force);
            for (const int k : instruments) h.world().add_force(k, force);
        });
    });
    c.def("settle", [](Handle& h) { return summary(alone(h, [&] { return h.settle(); }), 0); });
    c.def("output", [](Handle& h) { return OutputView{alone(h, [&] { return h.output(); })}; });
    c.def("save", [](Handle& h, int system) { return alone(h, [&] { return h.save(system); }); });
    c.def(
        "restore",
        [](Handle& h, py::handle state, int into) {
            const SavedState& s = contents(state);
            alone(h, [&] { h.restore(s, into); });
        },
        py::arg("state"), py::arg("into") = -1);
    c.def("close", [](Handle& h) {
        if (forked()) h.close();
        else alone(h, [&] { h.close(); });
    });
    c.def("retire", [](Handle& h, int system) {  // until it is restored alone
        return alone(h, [&] {
            h.check_system(system);
            h.world().retire(system);
        });
    });
    c.def("state_hash", [](Handle& h, int system) { return alone(h, [&] { return h.state_hash(system); }); });
    c.def("time", [](Handle& h) { return alone(h, [&] { return h.world().time(); }); });
    c.def("task",
          [](Handle& h, int system) { return alone(h, [&] { return task_json(h.world(), h.scene(), h.score(system)); }); });
    c.def("task_table", [](Handle& h) { return task_table(h.scene().task); });
    c.def("branch", [](Handle& h, int system) {
        return alone(h, [&] {
            const Branches::Place place = h.branch(system);
            return std::tuple(place.branch, place.depth, h.branches(system).path(place));
        });
    });
    c.def("branches", [](Handle& h, int system) {
        return alone(h, [&] {
            const Branches& all = h.branches(system);
            std::vector<std::tuple<std::string, std::string, int, std::vector<int>>> list;
            for (const Stretch& s : all.stretches()) {
                std::vector<int> points = s.points;
                if (const int fork = all.line().parent[static_cast<std::size_t>(points.front())]; fork >= 0)
                    points.insert(points.begin(), fork);
                list.emplace_back(s.path, s.name, s.number, std::move(points));
            }
            return list;
        });
    });
    c.def("at_rest", [](Handle& h) { return alone(h, [&] { return h.world().at_rest(); }); });
    c.def("model", [](Handle& h) { return alone(h, [&] { return h.world().model(); }); });
    c.def("device_name", [](Handle& h) { return alone(h, [&] { return h.world().device_name(); }); });
    c.def("counts",
          [](Handle& h) { return alone(h, [&] { return std::pair(h.world().wire_count(), h.world().system_count()); }); });
    c.def("names", [](Handle& h) {
        return alone(h, [&] {
            std::vector<std::string> names;
            for (const WireSetup& wire : h.world().setup().wires) names.push_back(wire.name);
            return names;
        });
    });
    c.def("start", [](Handle& h) {  // where each hub is at first
        return alone(h, [&] {
            std::vector<std::tuple<bool, double, double, double>> list;
            for (const WireSetup& w : h.world().setup().wires)
                list.emplace_back(w.feed.on, w.feed.advance, w.feed.turn, w.wire.length);
            return list;
        });
    });
    c.def("centreline", [](Handle& h) { return centreline(h.world()); });
    c.def("vessel", [](Handle& h) {
        const WallMesh& mesh = h.world().setup().mesh;
        py::array_t<double> points({static_cast<py::ssize_t>(mesh.vertices.size()), py::ssize_t{3}});
        py::array_t<int> triangles({static_cast<py::ssize_t>(mesh.triangles.size()), py::ssize_t{3}});
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
            for (int d = 0; d < 3; ++d) points.mutable_at(i, d) = mesh.vertices[i][d];
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            for (int d = 0; d < 3; ++d) triangles.mutable_at(i, d) = mesh.triangles[i][d];
        return py::make_tuple(points, triangles);
    });
    c.def("scene_text", [](const Handle& h, const std::string& folder) { return write_scene(h.scene(), folder); });
    c.def("scene_numbers", [](const Handle& h) {
        const Scene& s = h.scene();
        return py::make_tuple(s.dt, s.duration, s.steps(), settles_first(s));
    });
    c.def("begin_run", [](Handle& h, bool settles) { alone(h, [&] { h.begin_run(settles); }); });
    c.def("run", [](Handle& h, long to, long most) {
        const Handle::RunPart part = alone(h, [&] { return h.run(to, most); });
        return py::make_tuple(part.over, part.as_placed, part.failed ? py::object(summary(*part.failed, 0)) : py::none(),
                              part.settling);
    });
}

void bind_navigator(py::module_& module)
{
    py::class_<Navigator> c(module, "Navigator");
    made_here_only(c);
    module.def("make_navigator", [](const Handle& h, const std::array<double, 3>& target, int shape_points, double shape_spacing,
                                    int ahead_points, double ahead_spacing) {
        const NavigateSpec spec{Vec3(target[0], target[1], target[2]), shape_points, shape_spacing, ahead_points, ahead_spacing};
        return Navigator(h.world().setup().centreline, spec);
    });
    c.def("size", &Navigator::size)
        .def("way", [](const Navigator& n, const std::array<double, 3>& p) { return n.way(Vec3(p[0], p[1], p[2])); })
        .def("observe", [](const Navigator& n, Handle& h, py::array_t<float, py::array::c_style> to, Reals measures) {
            const auto systems = h.world().system_count();
            if (to.size() != systems * n.size() || measures.size() != systems * Navigator::measure_count)
                throw py::value_error("observe: arrays of another shape");
            const std::span<float> seen(to.mutable_data(), static_cast<std::size_t>(to.size()));
            const std::span<double> read(measures.mutable_data(), static_cast<std::size_t>(measures.size()));
            alone(h, [&] { n.observe(h.world(), h.failed(), seen, read); });
        });
}

/// Debian 12's pybind11 takes NumPy 2's arrays apart as if they were NumPy 1's: wrong numbers, then a crash.
void check_numpy()
{
#if PYBIND11_VERSION_HEX < 0x020C0000
    const auto found = py::module_::import("numpy").attr("__version__").cast<std::string>();
    if (std::stoi(found) >= 2)
        throw py::import_error(
            "seldinger was built with pybind11 " PYBIND11_TOSTRING(PYBIND11_VERSION_MAJOR) "." PYBIND11_TOSTRING(
                PYBIND11_VERSION_MINOR) ", which knows NumPy 1 alone, and this is NumPy " +
            found + "; install it here with `pip install .`, which brings a newer one, or numpy<2");
#endif
}

}  // namespace

PYBIND11_MODULE(_engine, module)
{
    check_numpy();
    module.doc() = "Private to the package: see seldinger.World.";
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const Error& error) {
            raise(error);
        }
    });
    module.def("set_error", [](const py::object& type) { error_class = py::object(type).release().ptr(); });
    module.def("version", &version);
    module.def("devices", [] {
        check_process();
        std::vector<std::pair<std::string, std::string>> names;
        for (const DeviceInfo& device : list_devices()) names.emplace_back(device.name, device.platform);
        return names;
    });
    // which hubs a scene feeds: read without a device, so that the process may still be forked
    module.def("scene_feeds", [](const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
        const Scene scene = read_scene_text(text, file, overrides);
        std::vector<bool> fed;
        for (int k = 0; k < scene.instrument_count(); ++k) fed.push_back(scene.instrument(k).feed.on);
        return fed;
    });
    bind_output(module);
    bind_state(module);
    bind_world(module);
    bind_navigator(module);
    bind_studies(module);
    bind_fluoroscopy(module);
}

}  // namespace seldinger::python

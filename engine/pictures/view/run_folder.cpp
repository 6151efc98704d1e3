// Reads wire.pvd, the frames' .vtp files, vessel.vtp and the trace of a run's folder.
#include "view/run_folder.h"

#include "core/error.h"
#include "core/file_io.h"
#include "core/parallel.h"
#include "io/vtp_read.h"
#include "view/force_load.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what)
{
    throw Error(ErrorKind::BadFile, path.string() + ": " + what);
}

Vec3 point_of(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

/// Triangles and fans of larger polygons.
WallMesh read_wall(const FilePlace& file)
{
    const fs::path& path = file.path();
    const PolyData data = read_poly_data(file);
    WallMesh mesh;
    mesh.vertices.reserve(data.points.size());
    for (const auto& p : data.points) {
        mesh.vertices.push_back(point_of(p));
        if (!mesh.vertices.back().allFinite()) fail(path, "a point of the wall is not finite");
    }
    std::int64_t begin = 0;
    for (std::int64_t end : data.polys.offsets) {
        const auto corner = [&](std::int64_t k) { return static_cast<std::int32_t>(data.polys.connectivity[k]); };
        for (std::int64_t k = begin + 1; k + 1 < end; ++k) mesh.triangles.push_back({corner(begin), corner(k), corner(k + 1)});
        begin = end;
    }
    if (mesh.triangles.empty()) fail(path, "got no triangles; expected a surface. Fix: run again with --overwrite");
    return mesh;
}

/// wire_000123.vtp lies beside contacts_000123.vtp and wall_000123.vtp.
fs::path beside(const fs::path& wire, const char* stem)
{
    const std::string name = wire.filename().string();
    const std::size_t at = name.rfind('_');
    return at == std::string::npos ? fs::path() : wire.parent_path() / (stem + name.substr(at));
}

/// 123 of wire_000123.vtp.
std::int64_t step_of(const fs::path& wire)
{
    const std::string stem = wire.stem().string(), digits = stem.substr(std::min(stem.size(), stem.rfind('_') + 1));
    std::int64_t step = -1;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), step);
    return error == std::errc() && end == digits.data() + digits.size() && step >= 0 ? step : -1;
}

struct Listed {
    double time;  // [s]
    fs::path file;
    std::string name;  // of the instrument, among several
};

std::vector<Listed> read_collection(const FilePlace& place)
{
    const fs::path& pvd = place.path();
    pugi::xml_document document;
    const std::string text = read_file(place);
    const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
    if (!parsed) fail(pvd, std::string("not a ParaView collection (") + parsed.description() + ")");
    std::vector<Listed> list;
    std::set<std::string> names;
    for (const pugi::xml_node& node : document.child("VTKFile").child("Collection").children("DataSet")) {
        const std::string file = node.attribute("file").as_string();
        // files of this folder, each once: a short list would name a long file a million times, or one of somebody else's
        if (file.empty() || file.find('/') != std::string::npos)
            fail(pvd, fmt::format("got \"{}\"; expected files beside it", file));
        if (!names.insert(file).second) fail(pvd, fmt::format("names \"{}\" twice", file));
        list.push_back({node.attribute("timestep").as_double(), pvd.parent_path() / file, node.attribute("name").as_string()});
    }
    return list;
}

std::vector<FrameFile> read_frame_list(const FilePlace& pvd)
{
    std::vector<FrameFile> frames;
    for (const Listed& listed : read_collection(pvd)) {
        const fs::path contacts = beside(listed.file, "contacts");
        // instruments of one frame stand one after the other
        if (frames.empty() || frames.back().contacts != contacts)
            frames.push_back({listed.time, step_of(listed.file), {}, {}, contacts, beside(listed.file, "wall")});
        frames.back().wires.push_back(listed.file);
        frames.back().names.push_back(listed.name);
    }
    if (frames.empty())
        fail(pvd.path(), "names no frame: nothing was recorded, so there is nothing to draw ([output] wire_every)");
    return frames;
}

std::vector<std::string> split(const std::string& line)
{
    std::vector<std::string> cells;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
}

/// `task` of summary.json, where the run had a target.
std::optional<TargetMark> read_target(const FilePlace& file)
{
    const nlohmann::json summary = nlohmann::json::parse(read_file(file), nullptr, false);
    if (summary.is_discarded())
        fail(file.path(), "got something that is not JSON; expected the summary of a run. Fix: run again with --overwrite");
    const nlohmann::json task = summary.is_object() ? summary.value("task", nlohmann::json()) : nlohmann::json();
    if (!task.is_object()) return std::nullopt;
    const nlohmann::json at = task.value("target_at_m", nlohmann::json()),
                         radius = task.value("target_radius_m", nlohmann::json());
    const bool complete = at.is_array() && at.size() == 3 && radius.is_number() && task["target"].is_string() &&
                          std::ranges::all_of(at, [](const auto& x) { return x.is_number(); });
    if (!complete) return std::nullopt;
    return TargetMark{
        {at[0].get<double>(), at[1].get<double>(), at[2].get<double>()}, radius.get<double>(), task["target"].get<std::string>()};
}

/// Columns are found by name; a trace without them is not an error, only a legend without those lines.
std::vector<TraceRow> read_trace(const FilePlace& path)
{
    std::istringstream stream(read_file(path));
    std::string line;
    if (!std::getline(stream, line)) return {};
    const std::vector<std::string> names = split(line);
    const auto column = [&](const char* name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
    const auto time = column("time_s"), inserted = column("inserted_m"), hand = column("hand_force_n"),
               torque = column("hand_torque_nm"), load = column("force_per_length_max_n_per_m");
    std::vector<TraceRow> rows;
    while (std::getline(stream, line)) {
        const std::vector<std::string> cells = split(line);
        const auto number = [&](std::ptrdiff_t k) {
            return k < static_cast<std::ptrdiff_t>(cells.size()) ? std::strtod(cells[k].c_str(), nullptr) : std::nan("");
        };
        rows.push_back({number(time), number(inserted), number(hand), number(torque), number(load)});
    }
    return rows;
}

/// The row of the trace nearest to a time; NaNs without a trace.
TraceRow row_at(const std::vector<TraceRow>& trace, double time)
{
    const double unknown = std::nan("");
    TraceRow best = {unknown, unknown, unknown, unknown, unknown};
    for (const TraceRow& row : trace) {
        if (!(std::abs(row.time - time) >= std::abs(best.time - time))) best = row;
    }
    return best;
}

/// Whether a row is of that very time, not merely the nearest.
bool is_at(const TraceRow& row, double time) { return std::abs(row.time - time) <= 1e-9 * (1 + time); }

const PolyArray& need(const PolyData& data, const char* name, int components, const fs::path& path)
{
    const auto found = data.point_data.find(name);
    if (found == data.point_data.end()) fail(path, fmt::format("has no point data \"{}\"", name));
    if (found->second.values.size() != static_cast<std::size_t>(components) * data.points.size()) {
        fail(path, fmt::format("point data \"{}\" hold {} numbers, expected {} for each of {} points", name,
                               found->second.values.size(), components, data.points.size()));
    }
    return found->second;
}

std::vector<WireLine> read_wires(const FilePlace& file)
{
    const fs::path& path = file.path();
    const PolyData data = read_poly_data(file);
    const PolyArray& radius = need(data, "radius", 1, path);
    const PolyArray* force = data.point_data.count("contact_force") > 0 ? &need(data, "contact_force", 3, path) : nullptr;
    std::vector<WireLine> wires;
    std::int64_t begin = 0;
    for (std::int64_t end : data.lines.offsets) {
        WireLine wire;
        for (std::int64_t k = begin; k < end; ++k) {
            const auto point = static_cast<std::size_t>(data.lines.connectivity[k]);
            wire.nodes.push_back(point_of(data.points[point]));
            wire.radius.push_back(radius.values[point]);
            if (force)
                wire.force.push_back(
                    std::hypot(force->values[3 * point], force->values[3 * point + 1], force->values[3 * point + 2]));
            if (!wire.nodes.back().allFinite()) fail(path, "a node of the wire is not finite");
        }
        if (!wire.nodes.empty()) wires.push_back(std::move(wire));
        begin = end;
    }
    if (wires.empty()) fail(path, "holds no wire (no polyline)");
    return wires;
}

std::vector<ContactMark> read_contacts(const FilePlace& file)
{
    const fs::path& path = file.path();
    const PolyData data = read_poly_data(file);
    if (data.points.empty()) return {};
    const PolyArray& force = need(data, "normal_n", 1, path);
    const bool directed = data.point_data.count("normal") > 0;
    const PolyArray* normal = directed ? &need(data, "normal", 3, path) : nullptr;
    const auto maybe = [&](const char* name) {  // absent in folders of earlier versions
        return data.point_data.count(name) > 0 ? &need(data, name, 1, path) : nullptr;
    };
    const PolyArray *per_length = maybe("force_per_length"), *place = maybe("place"), *body = maybe("body_a"),
                    *other = maybe("body_b");
    const PolyArray* friction = data.point_data.count("friction") > 0 ? &need(data, "friction", 3, path) : nullptr;
    const auto index_of = [](const PolyArray* of, std::size_t i, int absent) {
        return of && std::abs(of->values[i]) < 256 ? static_cast<int>(of->values[i]) : absent;
    };
    std::vector<ContactMark> marks(data.points.size());
    for (std::size_t i = 0; i < marks.size(); ++i) {
        marks[i].point = point_of(data.points[i]);
        marks[i].force = std::max(0.0, force.values[i]);
        if (per_length) marks[i].per_length = per_length->values[i];
        if (place) marks[i].place = static_cast<int>(place->values[i]);
        marks[i].instrument = index_of(body, i, 0), marks[i].other = index_of(other, i, -1);
        if (friction) marks[i].friction = {friction->values[3 * i], friction->values[3 * i + 1], friction->values[3 * i + 2]};
        if (normal) marks[i].normal = {normal->values[3 * i], normal->values[3 * i + 1], normal->values[3 * i + 2]};
    }
    return marks;
}

std::vector<double> wall_values(const PolyData& data, WallQuantity quantity, const fs::path& path)
{
    std::vector<double> values(data.points.size());
    if (quantity == WallQuantity::Stress) {
        values = need(data, "stress", 1, path).values;
    } else {
        const PolyArray& moved = need(data, "displacement", 3, path);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = Vec3(moved.values[3 * i], moved.values[3 * i + 1], moved.values[3 * i + 2]).norm();
    }
    for (const double v : values)
        if (!std::isfinite(v)) fail(path, "a value on the wall is not finite");
    return values;
}

/// A file of a frame, by its name in the run's folder.
FilePlace file_of(const RunFolder& run, const fs::path& file) { return run.folder / file.filename().string(); }

}  // namespace

bool is_there(const RunFolder& run, const fs::path& file) { return !file.empty() && run.folder.has(file.filename().string()); }

MovedWall read_moved_wall(const RunFolder& run, std::size_t index, WallQuantity quantity)
{
    const fs::path& path = run.frames.at(index).wall;
    if (!is_there(run, path))
        fail(path, "frame " + std::to_string(index) +
                       " of wire.pvd has no wall beside it; run with [output] contacts_every = wire_every");
    const PolyData data = read_poly_data(file_of(run, path));
    if (data.points.size() != run.wall.vertices.size())
        fail(path, fmt::format("has {} points, vessel.vtp has {}", data.points.size(), run.wall.vertices.size()));
    MovedWall now;
    now.value = wall_values(data, quantity, path);
    now.vertices.reserve(data.points.size());
    for (const auto& p : data.points) {
        now.vertices.push_back(point_of(p));
        if (!now.vertices.back().allFinite()) fail(path, "a point of the wall is not finite");
    }
    return now;
}

double largest_on_wall(const RunFolder& run, const fs::path& dir, WallQuantity quantity)
{
    if (run.wall.vertices.empty() || !run.folder.has("wall.pvd"))
        fail(dir,
             "no wall.pvd in it: its wall is rigid or was not recorded, so there is nothing to colour; run the scene with "
             "--set vessel.wall=elastic ([output] contacts_every above 0)");
    double most = 0;
    for (const Listed& listed : read_collection(run.folder / "wall.pvd"))
        for (const double v : wall_values(read_poly_data(file_of(run, listed.file)), quantity, listed.file))
            most = std::max(most, v);
    return most;
}

RunFolder read_run_folder(const fs::path& dir)
{
    if (!fs::is_directory(dir)) fail(dir, "no such folder; give the folder that `seldinger run -o` wrote");
    RunFolder run;
    run.folder = Folder(dir);
    if (!run.folder.has("wire.pvd"))
        fail(dir, "no wire.pvd in it: not a run's folder, or the run recorded no wire ([output] wire_every)");
    run.frames = read_frame_list(run.folder / "wire.pvd");
    if (run.folder.has("vessel.vtp")) run.wall = read_wall(run.folder / "vessel.vtp");
    if (run.folder.has("summary.json")) run.target = read_target(run.folder / "summary.json");
    if (run.folder.has("trace.csv")) run.trace = read_trace(run.folder / "trace.csv");
    for (const std::string& name : run.frames.front().names)
        if (const std::string own = "trace_" + name + ".csv"; !name.empty() && run.folder.has(own))
            run.own_trace[name] = read_trace(run.folder / own);
    return run;
}

WireFrame read_frame(const RunFolder& run, std::size_t index)
{
    const FrameFile& file = run.frames.at(index);
    WireFrame frame;
    for (std::size_t k = 0; k < file.wires.size(); ++k)
        for (WireLine& line : read_wires(file_of(run, file.wires[k]))) {
            line.name = file.names[k];
            frame.wires.push_back(std::move(line));
        }
    frame.contacts_known = run.wall.triangles.empty();  // without a wall none are written
    if (is_there(run, file.contacts)) frame.contacts = read_contacts(file_of(run, file.contacts)), frame.contacts_known = true;
    frame.time = file.time, frame.step = file.step;
    const TraceRow row = row_at(run.trace, file.time);
    frame.inserted = row.inserted;
    frame.hand_force = row.hand_force;
    // a row of another time has another load; the contacts' own is then nearer
    if (is_at(row, file.time)) frame.per_length = row.per_length;
    for (WireLine& wire : frame.wires) {
        const auto own = run.own_trace.find(wire.name);
        const TraceRow of = own == run.own_trace.end() ? row : row_at(own->second, file.time);
        if ((frame.wires.size() > 1 && own == run.own_trace.end()) || !is_at(of, file.time)) continue;
        wire.hand_force = of.hand_force, wire.hand_torque = of.hand_torque;
    }
    return frame;
}

RunReach reach_of(const RunFolder& run)
{
    std::vector<RunReach> parts(run.frames.size());
    for_each_item(static_cast<int>(parts.size()), 1, [&](int i) {
        const WireFrame frame = read_frame(run, static_cast<std::size_t>(i));
        RunReach& part = parts[static_cast<std::size_t>(i)];
        for (const WireLine& wire : frame.wires) part.nodes.insert(part.nodes.end(), wire.nodes.begin(), wire.nodes.end());
        for (const ContactMark& c : frame.contacts) part.strongest = std::max(part.strongest, c.force);
        part.load = loads_of(frame).largest;
    });
    RunReach reach;
    for (const RunReach& part : parts) {
        reach.nodes.insert(reach.nodes.end(), part.nodes.begin(), part.nodes.end());
        reach.strongest = std::max(reach.strongest, part.strongest);
        reach.load = std::max(reach.load, part.load);
    }
    return reach;
}

}  // namespace seldinger

// Puts a report together: the page of assets/web/report.html with its scripts, and the run's numbers as JSON and base64.
#include "report/report_page.h"

#include "batch/sweep.h"
#include "core/assets.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/sha256.h"
#include "io/binary_text.h"
#include "io/json_text.h"
#include "io/vtp_read.h"
#include "models/result_table.h"
#include "run/summary.h"
#include "scene/run_scene.h"
#include "session/web_content.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <span>
#include <sstream>
#include <vector>

#ifdef SEL_WITH_VIEW
    #include "view/run_folder.h"
#endif

namespace seldinger {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;  // what the page shows is in the order of the files

std::string base64_of(const std::array<std::uint8_t, 32>& hash)
{
    return base64({reinterpret_cast<const char*>(hash.data()), hash.size()});
}

/// A CSV with numbers in it as {"column": [values]}, in the file's order; other cells are text.
Json table_of(const std::string& text)
{
    std::istringstream lines(text);
    std::string line;
    Json table = Json::object();
    if (!std::getline(lines, line)) return table;
    const ResultTable::Row names = csv_fields(line);
    std::vector<Json> columns(names.size(), Json::array());
    while (std::getline(lines, line)) {
        ResultTable::Row row = csv_fields(line);
        row.resize(names.size());
        for (std::size_t k = 0; k < names.size(); ++k) {
            char* end = nullptr;
            const double value = std::strtod(row[k].c_str(), &end);
            const bool is_number = !row[k].empty() && *end == '\0' && std::isfinite(value);
            columns[k].push_back(is_number ? Json(value) : Json(row[k]));
        }
    }
    for (std::size_t k = 0; k < names.size(); ++k) table[names[k]] = std::move(columns[k]);
    return table;
}

/// Columns of a trace that are plotted; of one instrument among several, those that differ from one to the other.
constexpr const char* of_all[] = {"time_s",
                                  "inserted_m",
                                  "hand_force_n",
                                  "hand_torque_nm",
                                  "normal_n",
                                  "friction_n",
                                  "contacts",
                                  "force_per_length_max_n_per_m",
                                  "patch_force_max_n",
                                  "contact_extent_m",
                                  "contact_regions",
                                  "nodes",
                                  "step_ms",
                                  "overlap_m"};
constexpr const char* of_one[] = {"time_s", "inserted_m", "hand_force_n", "hand_torque_nm", "normal_n"};

/// The plotted columns of a trace, with no more rows than a plot shows.
Json plotted(const Json& trace, std::span<const char* const> columns)
{
    constexpr std::size_t most_rows = 4000;
    Json out = Json::object();
    for (const char* name : columns) {
        if (!trace.contains(name)) continue;
        const Json& all = trace[name];
        const std::size_t every = all.size() / most_rows + 1;
        Json& column = out[name] = Json::array();
        for (std::size_t k = 0; k < all.size(); k += every) column.push_back(all[k]);
    }
    return out;
}

#ifdef SEL_WITH_VIEW
void put_floats(std::string& bytes, std::initializer_list<double> values)
{
    for (const double value : values) {
        const auto small = static_cast<float>(value);
        bytes.append(reinterpret_cast<const char*>(&small), sizeof small);
    }
}

/// Nodes with the contact force on each: x, y, z, force.
std::string nodes_of(const WireLine& wire)
{
    std::string bytes;
    for (std::size_t i = 0; i < wire.nodes.size(); ++i)
        put_floats(bytes, {wire.nodes[i].x(), wire.nodes[i].y(), wire.nodes[i].z(), wire.force.empty() ? 0.0 : wire.force[i]});
    return bytes;
}

/// What the viewer gets of an instrument once; its nodes come with each frame, in the same order.
Json instrument_of(const WireLine& wire)
{
    return {{"name", wire.name}, {"radius", wire.radius.empty() ? 0.0 : wire.radius.back()}};
}

Json playback_of(const fs::path& dir)
{
    const RunFolder run = read_run_folder(dir);
    Json frames = Json::array(), instruments = Json::array();
    for (std::size_t k = 0; k < run.frames.size(); ++k) {
        const WireFrame frame = read_frame(run, k);
        Json nodes = Json::array();
        for (const WireLine& wire : frame.wires) {
            if (nodes.size() == instruments.size()) instruments.push_back(instrument_of(wire));
            nodes.push_back(base64(nodes_of(wire)));
        }
        frames.push_back({{"time", run.frames[k].time}, {"nodes", std::move(nodes)}});
    }
    return {{"mesh", base64(mesh_bytes(run.wall))}, {"frames", frames}, {"instruments", instruments}};
}
#else
Json playback_of(const fs::path&)
{
    throw Error(ErrorKind::BadScene, "report: this build cannot read frames; configure with -DSELDINGER_VIEW=ON");
}
#endif

/// The trace of each of several instruments, in their order; empty where they have none of their own.
Json traces_of(const Folder& dir, const Json& instruments)
{
    Json traces = Json::array();
    if (instruments.size() < 2) return traces;
    for (const Json& instrument : instruments) {
        const std::string file = fmt::format("trace_{}.csv", instrument["name"].get<std::string>());
        if (!dir.has(file)) return Json::array();
        traces.push_back(plotted(table_of(read_file(dir / file)), of_one));
    }
    return traces;
}

/// Directions of the patient for the camera, as the live page has them.
void add_directions(const Folder& dir, Json& data)
{
    const Scene scene = read_run_scene(dir);
    const bool arch = scene.vessel.shape == VesselShape::Arch;
    const Vec3 head = arch ? scene.vessel.axis : Vec3(Vec3::UnitZ()), front = arch ? scene.vessel.normal : Vec3(-Vec3::UnitY());
    data["head"] = {head.x(), head.y(), head.z()};
    data["front"] = {front.x(), front.y(), front.z()};
    data["name"] = scene.name;
    data["target"] = nullptr;
    if (scene.task.target == TaskSpec::Target::Point)
        data["target"] = {{"point", {scene.task.point.x(), scene.task.point.y(), scene.task.point.z()}},
                          {"radius", scene.task.radius}};
}

constexpr int deepest_summary = 32;  // a run's has four; what writes the page calls itself once for each

/// @throws Error BadFile
Json summary_in(const Folder& dir)
{
    const fs::path file = dir.path() / "summary.json";
    bool deep = false;
    const auto shallow = [&](int depth, Json::parse_event_t, const Json&) {
        deep |= depth > deepest_summary;
        return !deep;
    };
    Json summary = Json::parse(read_file(dir / "summary.json"), shallow, false);
    if (deep)
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: is nested deeper than {} levels; no run's is", file.string(), deepest_summary));
    if (!summary.is_object())
        throw Error(ErrorKind::BadFile, file.string() + ": is damaged, no JSON object; run again with --overwrite");
    return summary;
}

Json run_data(const Folder& dir)
{
    Json data{{"kind", "run"}, {"name", dir.path().filename().string()}};
    data["summary"] = summary_in(dir);
    data["closing"] = summary_for_people(data["summary"].dump(), dir.path());
    data["settings"] = read_file(dir / "scene.toml");
    data["trace"] = plotted(table_of(read_file(dir / "trace.csv")), of_all);
    data["playback"] = playback_of(dir.path());
    data["traces"] = traces_of(dir, data["playback"]["instruments"]);
    add_directions(dir, data);
    return data;
}

/// Points of the folder's wall, as many as a small picture shows.
Json wall_points(const Folder& dir)
{
    constexpr std::size_t most_points = 6000;
    const PolyData wall = read_poly_data(dir / "vessel.vtp", PolyParts::Geometry);
    const std::size_t every = wall.points.size() / most_points + 1;
    const auto rounded = [](double x) { return std::round(1e5 * x) / 1e5; };
    Json points = Json::array();
    for (std::size_t k = 0; k < wall.points.size(); k += every)
        points.push_back({rounded(wall.points[k][0]), rounded(wall.points[k][1]), rounded(wall.points[k][2])});
    return points;
}

/// What each design of the batch's sweep sets, as texts of --set, by its name in results.csv.
Json designs_of(const Folder& dir)
{
    Json designs = Json::object();
    if (!dir.has("sweep.toml")) return designs;
    for (const SweepAxis& axis : read_sweep_text(read_file(dir / "sweep.toml"), dir.path() / "sweep.toml", 0).axes)
        for (std::size_t k = 0; k < axis.designs.size(); ++k)
            designs[Json::parse(axis.values[k]).get<std::string>()] = axis.designs[k];
    return designs;
}

Json batch_data(const Folder& dir)
{
    const auto table_in = [&](const char* name) { return dir.has(name) ? table_of(read_file(dir / name)) : Json::object(); };
    Json data{{"kind", "batch"}, {"name", fs::absolute(dir.path()).lexically_normal().filename().string()}};
    data["table"] = table_in("results.csv");
    data["columns"] = Json::array();
    for (const auto& [name, values] : data["table"].items()) data["columns"].push_back(name);
    data["units"] = table_in("results-units.csv");
    data["designs"] = designs_of(dir);
    data["shapes"] = table_in("shapes.csv");
    data["vessel"] = Json::array();
    data["head"] = {0, 0, 1};
    data["front"] = {0, -1, 0};
    data["summary"] = dir.has("summary.json") ? summary_in(dir) : Json::object();
    data["settings"] = dir.has("scene.toml") ? read_file(dir / "scene.toml") : "";
    if (!dir.has("scene.toml")) return data;
    const std::string name = data["name"];
    add_directions(dir, data);
    data["name"] = name;
    if (!data["shapes"].empty() && dir.has("vessel.vtp")) data["vessel"] = wall_points(dir);
    return data;
}

/// JSON within a <script>: no end tag can stand in it.
std::string inside_script(const Json& data)
{
    std::string out;
    for (const char c : json_text(data))
        c == '<' ? out += "\\u003c" : out += c;
    return out;
}

void fill_in(std::string& page, const std::string& mark, const std::string& text)
{
    const std::size_t at = page.find(mark);
    if (at == std::string::npos) throw Error(ErrorKind::BadFile, "assets/web/report.html: " + mark + " is missing");
    page.replace(at, mark.size(), text);
}

}  // namespace

std::string report_page(const fs::path& path)
{
    const Folder dir(path);  // the page is handed on: nothing is read that lies elsewhere
    Json data;
    if (dir.has("results.csv")) data = batch_data(dir);
    else if (dir.has("trace.csv") && dir.has("summary.json")) data = run_data(dir);
    else
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: holds neither a run that has ended nor a batch; expected what `seldinger run -o` or "
                                "`batch -o` wrote",
                                path.string()));
    const fs::path folder = assets_folder() / "web";
    std::string page = read_file(folder / "report.html");
    const std::pair<const char*, std::string> scripts[] = {{"/*three*/", data["kind"] == "run" ? three_js() : ""},
                                                           {"/*chart*/", read_file(folder / "chart.js")},
                                                           {"/*viewer*/", read_file(folder / "viewer.js")},
                                                           {"/*batch*/", read_file(folder / "batch.js")},
                                                           {"/*report*/", read_file(folder / "report.js")}};
    // the page runs these scripts and no others, and loads nothing: it is handed on with texts of others in it
    std::string allowed;
    for (const auto& [mark, script] : scripts) allowed += fmt::format("'sha256-{}' ", base64_of(sha256(script)));
    fill_in(page, "/*scripts*/", allowed);
    fill_in(page, "/*style*/", read_file(folder / "live.css"));
    for (const auto& [mark, script] : scripts) fill_in(page, mark, script);
    fill_in(page, "/*data*/", inside_script(data));
    return page;
}

}  // namespace seldinger

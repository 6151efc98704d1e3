// The page's files, the scene as JSON, the wall and the frames as bytes.
#include "session/web_content.h"

#include "core/assets.h"
#include "core/error.h"
#include "core/file_io.h"
#include "io/json_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <filesystem>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

template <class T>
void put(std::string& into, const T* data, std::size_t count)
{
    into.append(reinterpret_cast<const char*>(data), count * sizeof(T));
}

nlohmann::json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

std::string scene_json(const Scene& scene, const WorldSetup& setup, const TaskTarget& target, const Branches& branches,
                       double rate)
{
    nlohmann::json instruments = nlohmann::json::array();
    for (const int k : live_instruments(setup)) {
        const WireSetup& wire = setup.wires[static_cast<std::size_t>(k)];
        instruments.push_back({{"name", wire.name}, {"length", wire.wire.length}, {"radius", wire.wire.shaft.radius}});
    }
    const TaskSpec& task = scene.task;
    nlohmann::json json{{"name", scene.name},
                        {"instruments", instruments},
                        {"rate", rate},
                        {"dt", 1 / rate},
                        {"inlet", list(setup.wires[0].feed.point)},
                        {"task", task.text},
                        {"target", nullptr},
                        {"limits",
                         {{"wall_force", task.wall_force},
                          {"patch_force", task.patch_force},
                          {"patch", scene.force_patch},
                          {"time", task.time},
                          {"fluoroscopy", task.fluoroscopy}}}};
    // the patient's axes: an arch has its own, else those of docs/live.md
    const bool arch = setup.vessel.shape == VesselShape::Arch;
    json["head"] = list(arch ? setup.vessel.axis : Vec3(Vec3::UnitZ()));
    json["front"] = list(arch ? setup.vessel.normal : Vec3(-Vec3::UnitY()));
    json["branches"] = nlohmann::json::array();
    for (const Stretch& s : branches.stretches()) json["branches"].push_back(s.words());
    if (task.target != TaskSpec::Target::None)
        json["target"] = {{"point", list(target.mark())}, {"radius", target.mark_radius()}};
    return json_text(json);
}

nlohmann::json instrument_json(const InstrumentNumbers& n)
{
    return {{"hand", n.hand},       {"advance", n.advance},          {"turn", n.turn},         {"force", n.force},
            {"torque", n.torque},   {"wire_force", n.wire_force},    {"wall", n.wall_force},   {"contacts", n.contacts}};
}

nlohmann::json score_for_page(const ScoreNumbers& s)
{
    return {{"time", s.time},
            {"path", s.path_length},
            {"advanced", s.advanced},
            {"back", s.pulled_back},
            {"pushes", s.pushes},
            {"backs", s.pull_backs},
            {"wall", s.wall_force},
            {"wall_mean", s.wall_force_mean},
            {"wall_max", s.wall_force_max},
            {"patch", s.patch_force},
            {"patch_max", s.patch_force_max},
            {"above", s.time_above},
            {"fluoroscopy", s.fluoroscopy},
            {"contrast", s.contrast},
            {"distance", s.distance},
            {"reached", s.reached != 0},
            {"failed", s.failed != 0}};
}

}  // namespace

std::string three_js()
{
    for (const char* file : {"/usr/share/javascript/three/three.min.js", "/usr/share/nodejs/three/build/three.min.js"})
        if (fs::exists(file)) return read_file(file);
    throw Error(ErrorKind::BadFile, "three.js is not installed; as root: apt-get install libjs-three");
}

std::string mesh_bytes(const WallMesh& mesh)
{
    std::string bytes;
    const std::uint32_t counts[] = {static_cast<std::uint32_t>(mesh.vertices.size()),
                                    static_cast<std::uint32_t>(mesh.triangles.size())};
    put(bytes, counts, 2);
    for (const Vec3& v : mesh.vertices) {
        const float p[] = {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
        put(bytes, p, 3);
    }
    for (const auto& t : mesh.triangles) {
        const std::uint32_t corners[] = {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                                         static_cast<std::uint32_t>(t[2])};
        put(bytes, corners, 3);
    }
    return bytes;
}

std::map<std::string, WebFile, std::less<>> web_files(const Scene& scene, const WorldSetup& setup, const TaskTarget& target,
                                                      const Branches& branches, double rate)
{
    const fs::path folder = assets_folder() / "web";
    std::map<std::string, WebFile, std::less<>> files;
    files["/"] = {"text/html; charset=utf-8", read_file(folder / "index.html")};
    for (const char* name : {"viewer.js", "live.js", "chart.js"})
        files[std::string("/") + name] = {"text/javascript; charset=utf-8", read_file(folder / name)};
    files["/live.css"] = {"text/css; charset=utf-8", read_file(folder / "live.css")};
    files["/three.js"] = {"text/javascript; charset=utf-8", three_js()};
    files["/scene.json"] = {"application/json", scene_json(scene, setup, target, branches, rate)};
    files["/mesh.bin"] = {"application/octet-stream", mesh_bytes(setup.mesh)};
    return files;
}

void put_frame(const ViewFrame& frame, double wall_clock, int clients, std::string& into)
{
    const StepNumbers& n = frame.numbers;
    nlohmann::json instruments = nlohmann::json::array();
    for (int k = 0; k < n.instruments; ++k) instruments.push_back(instrument_json(n.instrument[static_cast<std::size_t>(k)]));
    std::string json = json_text(nlohmann::json{{"step", n.step},
                                                {"time", n.time},
                                                {"clock", wall_clock},
                                                {"late", n.late},
                                                {"cut_short", n.cut_short},
                                                {"stretched", n.stretched},
                                                {"step_ms", 1e3 * n.step_time},
                                                {"paused", n.paused},
                                                {"stopped", n.stopped},
                                                {"fluoro", n.fluoroscopy},
                                                {"contrast", n.contrast},
                                                {"resets", n.resets},
                                                {"clients", clients},
                                                {"branch", n.stretch},
                                                {"branch_depth", n.branch_depth},
                                                {"instruments", instruments},
                                                {"score", score_for_page(n.score)}});
    json.resize((json.size() + 3) / 4 * 4, ' ');
    into.clear();
    const auto length = static_cast<std::uint32_t>(json.size());
    put(into, &length, 1);
    into += json;
    for (int k = 0; k < n.instruments; ++k) {
        const auto& nodes = frame.nodes[static_cast<std::size_t>(k)];
        const auto count = static_cast<std::uint32_t>(nodes.size());
        put(into, &count, 1);
        put(into, nodes.data(), nodes.size());
    }
}

}  // namespace seldinger

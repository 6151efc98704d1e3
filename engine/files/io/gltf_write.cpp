// Binary glTF 2.0: buffers first, then the JSON that describes them. [Khronos, glTF 2.0 specification]
#include "core/error.h"
#include "core/file_io.h"
#include "io/animated_model.h"
#include "io/json_text.h"
#include "math/eigen.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace seldinger {
namespace {

using Json = nlohmann::ordered_json;
using Floats = std::vector<float>;

constexpr int around = 10;  // vertices of a ring
constexpr int number_float = 5126, number_uint = 5125, number_ushort = 5123;

class Gltf {
public:
    explicit Gltf(const AnimatedModel& model) : model_(model)
    {
        const Vec3 front = -model.back;
        axes_ = Mat3::rows(model.left, model.head, front);
        json_["asset"] = {{"version", "2.0"}, {"generator", "seldinger"}};
        json_["scene"] = 0;
        json_["scenes"] = {{{"nodes", Json::array()}}};
        json_["nodes"] = Json::array();
        json_["meshes"] = Json::array();
        json_["materials"] = {material({0.95, 0.73, 0.66, 0.35}, 0, true), material({0.08, 0.19, 0.31, 1}, 0.6, false)};
    }

    std::string file()
    {
        if (!model_.triangles.empty()) add_vessel();
        if (!model_.tubes.empty()) {
            times_ = add({Floats(model_.times.begin(), model_.times.end())}, 1, "SCALAR", 0, true);
            json_["skins"] = Json::array();
            json_["animations"] = {{{"name", "run"}, {"samplers", Json::array()}, {"channels", Json::array()}}};
            for (const AnimatedTube& tube : model_.tubes) add_tube(tube);
        }
        if (json_["meshes"].empty()) json_.erase("meshes");
        while (bytes_.size() % 4 != 0) bytes_.push_back('\0');
        json_["buffers"] = {{{"byteLength", bytes_.size()}}};
        std::string text = json_text(json_);
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string out = "glTF";
        const auto put = [&](std::size_t value) {
            const auto v = static_cast<std::uint32_t>(value);
            out.append(reinterpret_cast<const char*>(&v), 4);
        };
        put(2), put(12 + 8 + text.size() + 8 + bytes_.size());
        put(text.size());
        out += "JSON" + text;
        put(bytes_.size());
        return out + std::string("BIN\0", 4) + bytes_;
    }

private:
    static Json material(std::array<double, 4> colour, double metal, bool glass)
    {
        Json m = {{"pbrMetallicRoughness", {{"baseColorFactor", colour}, {"metallicFactor", metal}, {"roughnessFactor", 0.5}}}};
        if (glass) m["alphaMode"] = "BLEND", m["doubleSided"] = true;
        return m;
    }

    template <class T>
    int add_bytes(const std::vector<T>& values, int type, std::size_t count, const char* shape, int target)
    {
        while (bytes_.size() % 4 != 0) bytes_.push_back('\0');
        Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(T)}};
        if (target != 0) view["target"] = target;
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        json_["bufferViews"].push_back(std::move(view));
        json_["accessors"].push_back(
            {{"bufferView", json_["bufferViews"].size() - 1}, {"componentType", type}, {"count", count}, {"type", shape}});
        return static_cast<int>(json_["accessors"].size()) - 1;
    }

    /// @param limits  smallest and largest of each component are written, as the format requires for places and times
    int add(const Floats& values, int components, const char* shape, int target = 0, bool limits = false)
    {
        const int id = add_bytes(values, number_float, values.size() / components, shape, target);
        if (!limits) return id;
        Floats low(values.begin(), values.begin() + components), high = low;
        for (std::size_t i = 0; i < values.size(); ++i) {
            low[i % components] = std::min(low[i % components], values[i]);
            high[i % components] = std::max(high[i % components], values[i]);
        }
        json_["accessors"].back()["min"] = low, json_["accessors"].back()["max"] = high;
        return id;
    }

    static void put(Floats& list, const Vec3& v)
    {
        for (int k = 0; k < 3; ++k) list.push_back(static_cast<float>(v[k]));
    }
    [[nodiscard]] Vec3 turned(const Vec3& v) const { return axes_ * v; }

    int add_node(Json node, bool top)
    {
        json_["nodes"].push_back(std::move(node));
        const int id = static_cast<int>(json_["nodes"].size()) - 1;
        if (top) json_["scenes"][0]["nodes"].push_back(id);
        return id;
    }

    void add_vessel()
    {
        Floats places, normals;
        std::vector<Vec3> normal(model_.vertices.size(), Vec3::Zero());
        std::vector<std::uint32_t> corners;
        for (const auto& t : model_.triangles) {
            const Vec3& a = model_.vertices[t[0]];
            const Vec3 area = (model_.vertices[t[1]] - a).cross(model_.vertices[t[2]] - a);
            for (const int k : t) normal[k] -= area, corners.push_back(static_cast<std::uint32_t>(k));  // outwards
            std::swap(corners.back(), corners[corners.size() - 2]);
        }
        for (std::size_t i = 0; i < model_.vertices.size(); ++i) {
            put(places, turned(model_.vertices[i]));
            put(normals, turned(normal[i].squaredNorm() > 0 ? Vec3(normal[i].normalized()) : Vec3::UnitZ()));
        }
        Json primitive;
        primitive["attributes"] = {{"POSITION", add(places, 3, "VEC3", 34962, true)}, {"NORMAL", add(normals, 3, "VEC3", 34962)}};
        primitive["indices"] = add_bytes(corners, number_uint, corners.size(), "SCALAR", 34963);
        primitive["material"] = 0;
        json_["meshes"].push_back({{"name", "vessel"}, {"primitives", {primitive}}});
        add_node({{"name", "vessel"}, {"mesh", json_["meshes"].size() - 1}}, true);
    }

    /// Rings about the joints: each vertex belongs to the joint of its ring.
    int tube_mesh(const AnimatedTube& tube)
    {
        Floats places, normals, weights;
        std::vector<std::uint16_t> joints;
        std::vector<std::uint32_t> corners;
        const std::size_t rings = tube.radius.size();
        for (std::size_t i = 0; i < rings; ++i) {
            for (int k = 0; k < around; ++k) {
                const double angle = 2 * std::numbers::pi * k / around;
                const Vec3 out(std::cos(angle), std::sin(angle), 0);
                put(places, tube.radius[i] * out), put(normals, out);
                for (int w = 0; w < 4; ++w)
                    joints.push_back(w == 0 ? static_cast<std::uint16_t>(i) : 0), weights.push_back(w == 0);
                if (i + 1 == rings) continue;
                const auto a = static_cast<std::uint32_t>(i * around + k),
                           b = static_cast<std::uint32_t>(i * around + (k + 1) % around);
                corners.insert(corners.end(), {a, b, a + around, b, b + around, a + around});
            }
        }
        Json attributes;
        attributes["POSITION"] = add(places, 3, "VEC3", 34962, true);
        attributes["NORMAL"] = add(normals, 3, "VEC3", 34962);
        attributes["JOINTS_0"] = add_bytes(joints, number_ushort, joints.size() / 4, "VEC4", 34962);
        attributes["WEIGHTS_0"] = add(weights, 4, "VEC4", 34962);
        Json primitive = {{"attributes", attributes}};
        primitive["indices"] = add_bytes(corners, number_uint, corners.size(), "SCALAR", 34963);
        primitive["material"] = 1;
        json_["meshes"].push_back({{"name", tube.name}, {"primitives", {primitive}}});
        return static_cast<int>(json_["meshes"].size()) - 1;
    }

    void add_tube(const AnimatedTube& tube)
    {
        const int mesh = tube_mesh(tube);
        const Eigen::Quaterniond axes(Eigen::Matrix3d{eigen(axes_)});
        std::vector<int> joints;
        Json& animation = json_["animations"][0];
        for (std::size_t i = 0; i < tube.radius.size(); ++i) {
            Floats places, turns;
            for (const auto& pose : tube.poses) {
                put(places, turned(pose[i].place));
                const Eigen::Quaterniond q = axes * Eigen::Quaterniond(pose[i].turn.data());
                for (const double c : {q.x(), q.y(), q.z(), q.w()}) turns.push_back(static_cast<float>(c));
            }
            Json node;
            node["translation"] = {places[0], places[1], places[2]};
            node["rotation"] = {turns[0], turns[1], turns[2], turns[3]};
            const int joint = add_node(std::move(node), true);
            joints.push_back(joint);
            const std::pair<const char*, int> paths[] = {{"translation", add(places, 3, "VEC3")},
                                                         {"rotation", add(turns, 4, "VEC4")}};
            for (const auto& [path, output] : paths) {
                animation["samplers"].push_back({{"input", times_}, {"output", output}, {"interpolation", "LINEAR"}});
                animation["channels"].push_back(
                    {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", joint}, {"path", path}}}});
            }
        }
        json_["skins"].push_back({{"joints", joints}});
        add_node({{"name", tube.name}, {"mesh", mesh}, {"skin", json_["skins"].size() - 1}}, true);
    }

    const AnimatedModel& model_;
    Mat3 axes_;
    Json json_;
    std::string bytes_;
    int times_ = 0;
};

}  // namespace

void write_gltf(const std::filesystem::path& path, const AnimatedModel& model)
{
    if (path.extension() != ".glb")
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: got the ending \"{}\"; expected .glb (binary glTF). Fix: rename the file", path.string(),
                                path.extension().string()));
    make_folder_of(path);
    write_file(path, Gltf(model).file());
}

}  // namespace seldinger

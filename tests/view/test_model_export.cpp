// A run's frames as glTF and USD: what the files hold is what the frames hold, and the formats' own rules.
#include "core/error.h"
#include "core/file_io.h"
#include "support/approx.h"
#include "view/model_export.h"
#include "view_fixtures.h"

#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cstring>

namespace seldinger::test::test_model_export {

namespace {

/// Two tubes over three times, the second bent, in a tube of a vessel.
AnimatedModel small_model()
{
    AnimatedModel model;
    const WallMesh mesh = straight_tube(0.006, 0.1);
    model.vertices = mesh.vertices, model.triangles = mesh.triangles;
    model.times = {0, 0.5, 1.25};
    for (const char* name : {"wire", "guide-2"}) {
        AnimatedTube tube{name, {4e-4, 4e-4, 5e-4}, {}};
        for (int f = 0; f < 3; ++f)
            tube.poses.push_back({{{0.01 * f, 0, 0.001}, {}}, {{0.01 * f - 0.01, 0, 0}, {}}, {{0.01 * f - 0.02, 0, 0}, {}}});
        model.tubes.push_back(tube);
    }
    model.contacts = {{}, {{0, 0, 0.006}}, {{0, 0, 0.006}, {0.01, 0, 0.006}}};
    model.contact_forces = {{}, {0.1}, {0.2, 0.3}};
    return model;
}

struct Glb {
    nlohmann::json json;
    std::string bytes;
    explicit Glb(const std::string& file)
    {
        const auto word = [&](std::size_t at) {
            std::uint32_t v = 0;
            std::memcpy(&v, file.data() + at, 4);
            return v;
        };
        REQUIRE(file.substr(0, 4) == "glTF");
        REQUIRE(word(4) == 2);
        REQUIRE(word(8) == file.size());
        REQUIRE(file.substr(16, 4) == "JSON");
        REQUIRE(word(12) % 4 == 0);
        json = nlohmann::json::parse(file.substr(20, word(12)));
        const std::size_t second = 20 + word(12);
        REQUIRE(file.substr(second + 4, 3) == "BIN");
        bytes = file.substr(second + 8, word(second));
        REQUIRE(bytes.size() == json.at("buffers")[0].at("byteLength"));
    }
    [[nodiscard]] std::vector<float> floats(int accessor) const
    {
        const auto& a = json.at("accessors")[accessor];
        const auto& view = json.at("bufferViews")[a.at("bufferView").get<int>()];
        std::vector<float> list(view.at("byteLength").get<std::size_t>() / 4);
        std::memcpy(list.data(), bytes.data() + view.at("byteOffset").get<std::size_t>(), 4 * list.size());
        return list;
    }
};

struct TemporaryFile {
    std::filesystem::path path;
    explicit TemporaryFile(const char* ending)
        : path(std::filesystem::temp_directory_path() / ("seldinger_model_" + std::to_string(getpid()) + ending))
    {
    }
    ~TemporaryFile() { std::filesystem::remove(path); }
};

}  // namespace

TEST_SUITE("view/model_export")
{
    TEST_CASE("property: glTF holds vessel, tubes and their moves, with the head up")
    {
        const TemporaryFile file(".glb");
        const AnimatedModel model = small_model();
        write_gltf(file.path, model);
        const Glb glb(read_file(file.path));
        REQUIRE(glb.json.at("meshes").size() == 3);
        const auto& animation = glb.json.at("animations")[0];
        REQUIRE(animation.at("channels").size() == 2 * 2 * 3);  // place and turn of two tubes' three stations
        for (const auto& channel : animation.at("channels")) {
            const auto& sampler = animation.at("samplers")[channel.at("sampler").get<int>()];
            CHECK(glb.floats(sampler.at("input")) == std::vector<float>{0, 0.5f, 1.25f});
            const int components = channel.at("target").at("path") == "rotation" ? 4 : 3;
            CHECK(glb.floats(sampler.at("output")).size() == 3u * components);
        }
        // the first joint's places: the patient's left, head, front
        const auto places = glb.floats(animation.at("samplers")[0].at("output"));
        for (int f = 0; f < 3; ++f) {
            const Vec3& p = model.tubes[0].poses[f][0].place;
            CHECK(places[3 * f] == about(p.x()));
            CHECK(places[3 * f + 1] == about(p.z()));
            CHECK(places[3 * f + 2] == about(-p.y()));
        }
        for (const auto& view : glb.json.at("bufferViews"))
            CHECK(view.at("byteOffset").get<std::size_t>() + view.at("byteLength").get<std::size_t>() <= glb.bytes.size());
    }

    TEST_CASE("property: USD names each time, with as many points as there are, and turns names into its own")
    {
        const TemporaryFile file(".usda");
        write_usd(file.path, small_model());
        const std::string text = read_file(file.path);
        CHECK(text.starts_with("#usda 1.0\n"));
        for (const char* part :
             {"metersPerUnit = 1", "upAxis = \"Z\"", "endTimeCode = 1250", "def Mesh \"vessel\"", "def BasisCurves \"wire\"",
              "def BasisCurves \"guide_2\"", "500: [(0.01, 0, 0.001)", "def Points \"contacts\"", "1250: [0.2, 0.3]"})
            CHECK_MESSAGE(text.find(part) != std::string::npos, part);
        CHECK(std::count(text.begin(), text.end(), '{') == std::count(text.begin(), text.end(), '}'));
    }

    TEST_CASE("regression: another ending, a folder that cannot be made: one line, no file")
    {
        const AnimatedModel model = small_model();
        CHECK_THROWS_AS(write_gltf("model.obj", model), Error);
        CHECK_THROWS_AS(write_usd("model.usd", model), Error);
        CHECK_THROWS_AS(write_gltf("/dev/null/model.glb", model), Error);
    }
}

}  // namespace seldinger::test::test_model_export

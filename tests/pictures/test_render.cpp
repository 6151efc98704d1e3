// From a run's folder to PNG files, and the message for another folder.
#include "pictures/render.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "view/run_folder.h"
#include "view/view_fixtures.h"

#include <fmt/format.h>
#include <png.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace seldinger::test::test_render {

namespace fs = std::filesystem;

namespace {

void write_text(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

std::string numbers(const std::vector<Vec3>& points)
{
    std::string text;
    for (const Vec3& p : points) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    return text;
}

std::string poly_data(std::size_t points, const std::string& inside)
{
    return fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\">\n<PolyData>\n"
        "<Piece NumberOfPoints=\"{}\">\n{}</Piece>\n</PolyData>\n</VTKFile>\n",
        points, inside);
}

std::string array(const char* type, const char* name, int components, const std::string& values)
{
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">{}</DataArray>\n", type,
                       name, components, values);
}

std::string points_xml(const std::vector<Vec3>& points)
{
    return "<Points>" + array("Float64", "Points", 3, numbers(points)) + "</Points>\n";
}

void write_vessel(const fs::path& dir)
{
    const WallMesh mesh = straight_tube(0.006, 0.1);
    std::string corners, offsets;
    for (const auto& t : mesh.triangles) corners += fmt::format("{} {} {} ", t[0], t[1], t[2]);
    for (std::size_t i = 1; i <= mesh.triangles.size(); ++i) offsets += fmt::format("{} ", 3 * i);
    write_text(dir / "vessel.vtp", poly_data(mesh.vertices.size(), points_xml(mesh.vertices) + "<Polys>" +
                                                                       array("Int32", "connectivity", 1, corners) +
                                                                       array("Int32", "offsets", 1, offsets) + "</Polys>\n"));
}

void write_frame(const fs::path& dir, int index)
{
    const WireLine wire = straight_wire({0.01 * index, 0, 0.001}, {-0.05, 0, 0}, 0.0004, 11);
    std::string radius, order;
    for (std::size_t i = 0; i < wire.nodes.size(); ++i) radius += "0.0004 ", order += fmt::format("{} ", i);
    write_text(dir / fmt::format("wire_{:06}.vtp", index),
               poly_data(wire.nodes.size(), points_xml(wire.nodes) + "<Lines>" + array("Int64", "connectivity", 1, order) +
                                                array("Int64", "offsets", 1, "11") + "</Lines>\n<PointData>" +
                                                array("Float64", "radius", 1, radius) + "</PointData>\n"));
    const std::vector<Vec3> touched = {{0, 0, 0.006}, {-0.02, 0, -0.006}};
    write_text(dir / fmt::format("contacts_{:06}.vtp", index),
               poly_data(2, points_xml(touched) + "<PointData>" + array("Float64", "normal_n", 1, "0.02 0.11") +
                                array("Float64", "normal", 3, "0 0 -1 0 0 1") + "</PointData>\n"));
}

void write_list(const fs::path& dir, int frames)
{
    std::string list = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\"><Collection>\n";
    for (int i = 0; i < frames; ++i)
        list += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"wire_{:06}.vtp\"/>\n", 0.1 * i, i);
    write_text(dir / "wire.pvd", list + "</Collection></VTKFile>\n");
}

void write_run(const fs::path& dir, int frames)
{
    write_vessel(dir);
    for (int i = 0; i < frames; ++i) write_frame(dir, i);
    write_list(dir, frames);
    write_text(dir / "trace.csv", "step,time_s,inserted_m,hand_force_n\n0,0,0,0\n100,0.1,0.01,0.2\n");
}

/// Beside frame k the tube has moved by k times a bump of 0.5 mm about x = 0, with stresses of k times 20 kPa there.
void write_moved_walls(const fs::path& dir, int frames)
{
    const WallMesh mesh = straight_tube(0.006, 0.1);
    std::string list = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\"><Collection>\n";
    for (int k = 0; k < frames; ++k) {
        std::vector<Vec3> now = mesh.vertices, moves;
        std::string stress;
        for (Vec3& p : now) {
            const double share = k * std::exp(-std::pow(p.x() / 0.01, 2));
            moves.push_back({0, 0, 0.5e-3 * share});
            stress += fmt::format("{} ", 2e4 * share);
            p += moves.back();
        }
        write_text(dir / fmt::format("wall_{:06}.vtp", k),
                   poly_data(now.size(), points_xml(now) + "<PointData>" + array("Float64", "displacement", 3, numbers(moves)) +
                                             array("Float64", "stress", 1, stress) + "</PointData>\n"));
        list += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"wall_{:06}.vtp\"/>\n", 0.1 * k, k);
    }
    write_text(dir / "wall.pvd", list + "</Collection></VTKFile>\n");
}

/// True when the pictures could be drawn; false, and the test case skipped, where this machine cannot.
bool render_or_skip(const fs::path& dir, const RenderOptions& options, std::vector<fs::path>& written)
{
    try {
        written = render_run(dir, options).paths;
        return true;
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::NoDevice && std::string(e.what()).find("font") == std::string::npos) throw;
        skip(e.what());
        return false;
    }
}

std::string file_bytes(const fs::path& path)
{
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at)
{
    std::uint32_t v = 0;
    for (int k = 0; k < 4; ++k) v = (v << 8) | static_cast<unsigned char>(bytes[at + k]);
    return v;
}

void check_refused(const fs::path& dir, const RenderOptions& options, ErrorKind code, const std::string& word)
{
    test::check_refused([&] { return render_run(dir, options); }, {word}, code);
}

}  // namespace

TEST_SUITE("pictures/render")
{
    TEST_CASE("property: the last frame becomes picture.png, an 8-bit RGB PNG of the size asked for")
    {
        const TemporaryFolder dir;
        write_run(dir.path(), 3);
        RenderOptions options;
        options.width = 400, options.height = 300;
        std::vector<fs::path> written;
        if (!render_or_skip(dir.path(), options, written)) return;
        REQUIRE(written.size() == 1);
        CHECK(written[0] == dir.path() / "picture.png");
        const std::string png = file_bytes(written[0]);
        REQUIRE(png.size() > 33);
        CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
        CHECK(png.substr(12, 4) == "IHDR");
        CHECK(big_endian(png, 16) == 400);
        CHECK(big_endian(png, 20) == 300);
        CHECK(static_cast<int>(png[24]) == 8);  // bits
        CHECK(static_cast<int>(png[25]) == 2);  // true colour
        CHECK(png.substr(png.size() - 8, 4) == "IEND");
        std::vector<fs::path> again;
        REQUIRE(render_or_skip(dir.path(), options, again));
        CHECK(file_bytes(again[0]) == png);
        for (const auto& entry : fs::directory_iterator(dir.path())) CHECK(entry.path().extension() != ".part");
    }

    TEST_CASE("property: frames A:B become one picture each, and differ")
    {
        const TemporaryFolder dir;
        write_run(dir.path(), 4);
        RenderOptions options;
        options.width = 240, options.height = 160, options.first = 1, options.last = 3;
        std::vector<fs::path> written;
        if (!render_or_skip(dir.path(), options, written)) return;
        REQUIRE(written.size() == 3);
        CHECK(written[0] == dir.path() / "frame_000001.png");
        CHECK(written[2] == dir.path() / "frame_000003.png");
        CHECK(file_bytes(written[0]) != file_bytes(written[1]));
        CHECK_FALSE(fs::exists(dir.path() / "picture.png"));
    }

    TEST_CASE("property: a frame is the same bytes alone, in a series, in a half of it and as the last picture")
    {
        const TemporaryFolder dir;
        write_run(dir.path(), 4);
        // forces from 5 mN in one frame to 300 mN in another: a scale by the drawn frames would differ
        const char* forces[] = {"0.002 0.005", "0.02 0.11", "0.3 0.11", "0.001 0.003"};
        for (int k = 0; k < 4; ++k)
            write_text(dir.path() / fmt::format("contacts_{:06}.vtp", k),
                       poly_data(2, points_xml({{0, 0, 0.006}, {-0.02, 0, -0.006}}) + "<PointData>" +
                                        array("Float64", "normal_n", 1, forces[k]) + "</PointData>\n"));
        RenderOptions options;
        options.width = 800, options.height = 450;
        const auto draw = [&](int first, int last) {
            options.first = first, options.last = last;
            std::vector<fs::path> written;
            std::vector<std::string> pictures;
            if (!render_or_skip(dir.path(), options, written)) return pictures;
            for (const fs::path& path : written) pictures.push_back(file_bytes(path));
            return pictures;
        };
        const std::vector<std::string> series = draw(0, 3);
        if (series.empty()) return;
        REQUIRE(series.size() == 4);
        for (int k = 0; k < 4; ++k) CHECK(draw(k, k).at(0) == series[k]);
        const std::vector<std::string> begin = draw(0, 1), end = draw(2, 3);
        for (int k = 0; k < 2; ++k) CHECK((begin.at(k) == series[k] && end.at(k) == series[2 + k]));
        CHECK(draw(-1, -1).at(0) == series[3]);
        // the largest of the run is round: asked for, it changes nothing; another does
        // two contacts 20 mm apart, each spread over 5 mm either side: 0.3 N are 60 N/m
        options.load_max = 60;
        CHECK(draw(1, 1).at(0) == series[1]);
        options.load_max = 30;
        CHECK(draw(1, 1).at(0) != series[1]);
        options.force_max = 0.3;  // contacts in place of the wire
        CHECK(draw(1, 1).at(0) != series[1]);
    }

    TEST_CASE("property: series go on where they stopped, films appear whole or not at all")
    {
        const TemporaryFolder dir;
        write_run(dir.path(), 4);
        RenderOptions options;
        options.width = 240, options.height = 160, options.first = 0, options.last = 3;
        options.output = dir.path() / "out.png";
        std::vector<fs::path> written;
        if (!render_or_skip(dir.path(), options, written)) return;
        REQUIRE(written.size() == 4);
        const std::string second = file_bytes(dir.path() / "out_000002.png");
        fs::remove(dir.path() / "out_000002.png");
        write_text(dir.path() / "out_000001.png", "somebody's own");
        options.resume = true;
        REQUIRE(render_or_skip(dir.path(), options, written));
        CHECK(written == std::vector<fs::path>{dir.path() / "out_000002.png"});
        CHECK(file_bytes(dir.path() / "out_000002.png") == second);
        CHECK(file_bytes(dir.path() / "out_000001.png") == "somebody's own");
        // stopped between two frames: no film, no part of one
        options.resume = false, options.output.clear(), options.film = dir.path() / "film.mp4";
        const auto stop = [](std::size_t done, std::size_t, double) {
            if (done == 2) throw Error(ErrorKind::TimeLimit, "stopped");
        };
        CHECK_THROWS_AS(render_run(dir.path(), options, stop), Error);
        CHECK_FALSE(fs::exists(dir.path() / "film.mp4"));
        CHECK_FALSE(fs::exists(dir.path() / "film.mp4.part"));
        options.ground = Ground::Transparent;
        check_refused(dir.path(), options, ErrorKind::BadScene, "cannot be transparent");
    }

    TEST_CASE("property: a transparent ground has no cover where nothing is, the vessel's far wall all of it; 4K is drawn")
    {
        const TemporaryFolder dir;
        write_run(dir.path(), 1);
        RenderOptions options;
        options.width = 320, options.height = 240, options.legend = false, options.ground = Ground::Transparent;
        std::vector<fs::path> written;
        if (!render_or_skip(dir.path(), options, written)) return;
        const std::string png = file_bytes(written[0]);
        CHECK(static_cast<int>(png[25]) == 6);  // true colour with cover
        std::vector<std::uint8_t> pixels(320 * 240 * 4);
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        REQUIRE(png_image_begin_read_from_memory(&image, png.data(), png.size()));
        image.format = PNG_FORMAT_RGBA;
        REQUIRE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
        CHECK(pixels[3] == 0);                            // a corner
        CHECK(pixels[4 * (120 * 320 + 160) + 3] == 255);  // the middle
        options.width = 3840, options.height = 2160, options.ground = Ground::White;
        REQUIRE(render_or_skip(dir.path(), options, written));
        CHECK(big_endian(file_bytes(written[0]), 16) == 3840);
    }

    TEST_CASE("property: a free wire needs no vessel and no contacts")
    {
        const TemporaryFolder dir;
        write_run(dir.path(), 2);
        fs::remove(dir.path() / "vessel.vtp");
        fs::remove(dir.path() / "trace.csv");
        fs::remove(dir.path() / "contacts_000001.vtp");
        RenderOptions options;
        options.width = 240, options.height = 160;
        std::vector<fs::path> written;
        if (!render_or_skip(dir.path(), options, written)) return;
        CHECK(fs::file_size(written[0]) > 500);
    }

    TEST_CASE("property: a coloured frame is the same alone and in a series, and its scale is the one asked for")
    {
        const TemporaryFolder dir;
        write_run(dir.path(), 3);
        write_moved_walls(dir.path(), 3);
        RenderOptions options;
        options.width = 800, options.height = 450;
        options.first = 0, options.last = 2;
        std::vector<fs::path> written;
        for (const WallQuantity what : {WallQuantity::Displacement, WallQuantity::Stress}) {
            options.wall = what, options.wall_max = 0;
            options.first = 0;
            if (!render_or_skip(dir.path(), options, written)) return;
            const std::string series = file_bytes(dir.path() / "frame_000001.png"),
                              last = file_bytes(dir.path() / "frame_000002.png");
            CHECK(series != last);
            options.first = options.last = 1;
            REQUIRE(render_or_skip(dir.path(), options, written));
            CHECK(file_bytes(written[0]) == series);
            // the largest of the run is 1 mm and 40 kPa, round numbers: asked for, they change nothing; half of them does
            options.wall_max = what == WallQuantity::Stress ? 4e4 : 1e-3;
            REQUIRE(render_or_skip(dir.path(), options, written));
            CHECK(file_bytes(written[0]) == series);
            options.wall_max /= 2;
            REQUIRE(render_or_skip(dir.path(), options, written));
            CHECK(file_bytes(written[0]) != series);
            options.first = 0, options.last = 2;
        }
    }

    TEST_CASE("regression: a wall that cannot be coloured is named, with what to do")
    {
        const TemporaryFolder dir;
        write_run(dir.path(), 2);
        RenderOptions options;
        options.wall = WallQuantity::Displacement;
        check_refused(dir.path(), options, ErrorKind::BadFile, "--set vessel.wall=elastic");
        write_moved_walls(dir.path(), 2);
        fs::remove(dir.path() / "vessel.vtp");
        check_refused(dir.path(), options, ErrorKind::BadFile, "nothing to colour");
        write_vessel(dir.path());
        write_text(dir.path() / "wall_000000.vtp", poly_data(1, points_xml({{0, 0, 0}})));
        check_refused(dir.path(), options, ErrorKind::BadFile, "displacement");
        options.wall = WallQuantity::Stress;
        check_refused(dir.path(), options, ErrorKind::BadFile, "stress");
    }

    TEST_CASE("regression: what is missing or damaged is named")
    {
        const TemporaryFolder dir;
        check_refused(dir.path() / "nowhere", {}, ErrorKind::BadFile, "no such folder");
        check_refused(dir.path(), {}, ErrorKind::BadFile, "wire.pvd");
        write_list(dir.path(), 0);
        check_refused(dir.path(), {}, ErrorKind::BadFile, "names no frame");
        write_run(dir.path(), 2);
        RenderOptions options;
        for (auto [first, last] : {std::pair{2, 2}, {1, 0}, {-1, 1}, {0, 2}}) {
            options.first = first, options.last = last;
            check_refused(dir.path(), options, ErrorKind::BadScene, "0 <= A <= B <= 1, the run has 2 frames");
        }
        write_text(dir.path() / "summary.json", "{ \"task\": ");
        check_refused(dir.path(), {}, ErrorKind::BadFile, "summary.json: got something that is not JSON");
        write_text(dir.path() / "summary.json",
                   R"({"task": {"target": "left", "target_at_m": [0.1, 0.2, 0.3], "target_radius_m": 0.004}})");
        const std::optional<TargetMark> target = read_run_folder(dir.path()).target;
        REQUIRE(target);
        CHECK(target->at == Vec3(0.1, 0.2, 0.3));
        CHECK(target->radius == 0.004);
        CHECK(target->name == "left");
        for (const char* none :
             {R"({"task": {"target": null}})", R"({"task": {"target": "left", "target_at_m": [0, 1]}})", "[]", "{}"}) {
            write_text(dir.path() / "summary.json", none);
            CHECK_FALSE(read_run_folder(dir.path()).target);
        }
        fs::remove(dir.path() / "wire_000001.vtp");
        check_refused(dir.path(), {}, ErrorKind::BadFile, "wire_000001.vtp");
        write_text(dir.path() / "wire_000001.vtp", "half a fi");
        check_refused(dir.path(), {}, ErrorKind::BadFile, "wire_000001.vtp");
        write_text(dir.path() / "wire_000001.vtp", poly_data(1, points_xml({{0, 0, 0}})));
        check_refused(dir.path(), {}, ErrorKind::BadFile, "radius");
    }
}

}  // namespace seldinger::test::test_render

// The entry points of fuzzing.
#include "fuzz_targets.h"

#include "core/error.h"
#include "io/mesh_file.h"
#include "vessel/extract_centreline.h"
#include "vessel/inlets.h"
#include "vessel/repair.h"

#include <cmath>
#include <cstdlib>
#include <cstring>

namespace seldinger::fuzz {
namespace {

void require(bool holds)
{
    if (!holds) std::abort();
}

std::string text_of(const std::uint8_t* bytes, std::size_t size) { return {reinterpret_cast<const char*>(bytes), size}; }

template <class Work>
void answer(const Work& work)
{
    try {
        work();
    } catch (const Error& error) {
        require(error.code() == ExitCode::BadFile);
        for (const char* c = error.what(); *c; ++c) require(*c == '\n' || static_cast<unsigned char>(*c) >= ' ');
    }
}

template <int N>
void read_as(const std::uint8_t* bytes, std::size_t size)
{
    constexpr const char* names[] = {"x.stl", "x.obj", "x.ply", "x.vtp", "x.vtk"};
    answer([&] { (void)parse_mesh(text_of(bytes, size), names[N], "mm"); });
}

void read_centreline(const std::uint8_t* bytes, std::size_t size)
{
    answer([&] {
        const Centreline line = parse_centreline_vtp(text_of(bytes, size), "x.vtp", "mm");
        require(std::isfinite(line.total_length()));
        require(!line.main_path().empty());
    });
}

/// As vessel_load.cpp and the `vessel` command do. What is said of a mesh that is taken has to be a number.
void prepare(const std::string& bytes, const char* name)
{
    answer([&] {
        WallMesh mesh = parse_mesh(bytes, name, "mm");
        const RepairReport report = repair(mesh);
        const Centreline line = extract_centreline(mesh, report.loops, LumenQuery(mesh, report.loops));
        require(std::isfinite(line.total_length()));
        for (const double radius : line.radius) require(std::isfinite(radius) && radius >= 0);
        for (const Inlet& inlet : find_inlets(report.loops, line))
            require(inlet.point.allFinite() && inlet.direction.allFinite() && std::isfinite(inlet.radius));
    });
}

void prepare_obj(const std::uint8_t* bytes, std::size_t size) { prepare(text_of(bytes, size), "x.obj"); }

/// Triangles of an indexed mesh straight from the bytes, so that mutations reach the geometry and not the syntax: a count of
/// vertices, their coordinates as bytes or as floats, then corners.
void prepare_raw(const std::uint8_t* bytes, std::size_t size)
{
    if (size < 8) return;
    const std::size_t vertices = 3 + bytes[0];
    const bool floats = bytes[1] & 1;
    const std::size_t width = floats ? 4 : 1, head = 2 + 3 * width * vertices;
    if (size < head + 3) return;
    std::string obj;
    for (std::size_t v = 0; v < vertices; ++v) {
        obj += 'v';
        for (std::size_t d = 0; d < 3; ++d) {
            const std::uint8_t* at = bytes + 2 + width * (3 * v + d);
            float x = static_cast<float>(*at) - 128;
            if (floats) std::memcpy(&x, at, 4);
            obj += ' ' + std::to_string(x);
        }
        obj += '\n';
    }
    for (std::size_t k = head; k + 3 <= size; k += 3) {
        obj += 'f';
        for (std::size_t c = 0; c < 3; ++c) obj += ' ' + std::to_string(1 + bytes[k + c] % vertices);
        obj += '\n';
    }
    prepare(obj, "x.obj");
}

constexpr Target targets[] = {{"stl", read_as<0>},       {"obj", read_as<1>},          {"ply", read_as<2>},
                              {"vtp", read_as<3>},       {"vtk", read_as<4>},          {"centreline", read_centreline},
                              {"pipeline", prepare_obj}, {"pipeline_raw", prepare_raw}};

}  // namespace

const Target* find_target(const char* name)
{
    for (const Target& target : targets)
        if (std::strcmp(target.name, name) == 0) return &target;
    return nullptr;
}

}  // namespace seldinger::fuzz

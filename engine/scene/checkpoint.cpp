// Packs a run's state, tally and file sizes into checkpoint.bin and checks every length on the way back.
#include "scene/checkpoint.h"

#include "core/bytes.h"
#include "core/fnv1a.h"
#include "core/sealed_file.h"

#include <fmt/format.h>

namespace seldinger {
namespace {

constexpr std::string_view magic = "SELCKPT1";

template <class T>
void put_list(std::vector<std::uint8_t>& bytes, const T& list)
{
    const std::uint64_t count = list.size();
    put_bytes(bytes, &count, 1);
    put_bytes(bytes, list.data(), list.size());
}

/// @throws Error BadFile when the list claims more than is left
template <class T>
void take_list(const std::uint8_t*& at, const std::uint8_t* end, T& list)
{
    std::uint64_t count = 0;
    take_bytes(at, end, &count, 1);
    if (count > static_cast<std::uint64_t>(end - at) / sizeof(typename T::value_type))
        throw Error(ExitCode::BadFile, "a list is longer than the file");
    list.resize(count);
    take_bytes(at, end, list.data(), count);
}

void take_payload(const std::uint8_t* at, const std::uint8_t* end, Checkpoint& c)
{
    take_list(at, end, c.version);
    // what follows is laid out as this version's structures are
    if (c.version != version())
        throw Error(ExitCode::BadFile,
                    fmt::format("was written by version {}, this is {}; resume with that one, or run again with --overwrite",
                                c.version, version()));
    take_list(at, end, c.device);
    take_bytes(at, end, &c.vessel_hash, 1);
    take_bytes(at, end, &c.status, 1);
    take_bytes(at, end, &c.tally, 1);
    take_list(at, end, c.trace_bytes);
    take_list(at, end, c.wire_frames);
    take_list(at, end, c.contact_frames);
    take_list(at, end, c.state);
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& c)
{
    std::vector<std::uint8_t> payload;
    put_list(payload, c.version);
    put_list(payload, c.device);
    put_bytes(payload, &c.vessel_hash, 1);
    put_bytes(payload, &c.status, 1);
    put_bytes(payload, &c.tally, 1);
    put_list(payload, c.trace_bytes);
    put_list(payload, c.wire_frames);
    put_list(payload, c.contact_frames);
    put_list(payload, c.state);

    write_sealed(path, magic, payload);
}

Checkpoint read_checkpoint(const std::filesystem::path& path)
{
    const std::vector<std::uint8_t> payload = read_sealed(path, magic);
    Checkpoint checkpoint;
    try {
        take_payload(payload.data(), payload.data() + payload.size(), checkpoint);
    } catch (const Error& error) {
        throw Error(error.code(), fmt::format("{}: {}", path.string(), error.what()));
    }
    return checkpoint;
}

std::uint64_t hash_of(const WallMesh& mesh)
{
    std::uint64_t hash = fnv1a(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
    return fnv1a(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), hash);
}

}  // namespace seldinger

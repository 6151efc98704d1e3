#include "scene/checkpoint.h"

#include "core/bytes.h"
#include "core/file_io.h"
#include "core/fnv1a.h"

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
        throw Error(ExitCode::BadFile, fmt::format("was written by version {}, this is {}; resume with that one, or run again with --overwrite",
                                                   c.version, version()));
    take_list(at, end, c.device);
    take_bytes(at, end, &c.vessel_hash, 1);
    take_bytes(at, end, &c.status, 1);
    take_bytes(at, end, &c.tally, 1);
    take_bytes(at, end, &c.trace_bytes, 1);
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
    put_bytes(payload, &c.trace_bytes, 1);
    put_list(payload, c.wire_frames);
    put_list(payload, c.contact_frames);
    put_list(payload, c.state);

    std::vector<std::uint8_t> file;
    put_bytes(file, magic.data(), magic.size());
    const std::uint64_t size = payload.size(), hash = fnv1a(payload.data(), payload.size());
    put_bytes(file, &size, 1);
    put_bytes(file, payload.data(), payload.size());
    put_bytes(file, &hash, 1);
    write_file(path, {reinterpret_cast<const char*>(file.data()), file.size()}, Durable::Yes);
}

Checkpoint read_checkpoint(const std::filesystem::path& path)
{
    const std::string file = read_file(path);
    const std::size_t frame = magic.size() + 2 * sizeof(std::uint64_t);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(file.data());
    std::uint64_t size = 0, hash = 0;
    bool whole = file.size() >= frame && file.starts_with(magic);
    if (whole) {
        std::memcpy(&size, bytes + magic.size(), sizeof size);
        whole = size == file.size() - frame;
    }
    if (whole) {
        std::memcpy(&hash, bytes + file.size() - sizeof hash, sizeof hash);
        whole = hash == fnv1a(bytes + magic.size() + sizeof size, size);
    }
    if (!whole) throw Error(ExitCode::BadFile, path.string() + ": is damaged or not a checkpoint; run again with --overwrite");
    Checkpoint checkpoint;
    try {
        const std::uint8_t* payload = bytes + magic.size() + sizeof size;
        take_payload(payload, payload + size, checkpoint);
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

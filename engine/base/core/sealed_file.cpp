// Writes and checks sealed files: magic, size, payload, checksum.
#include "core/sealed_file.h"

#include "core/bytes.h"
#include "core/file_io.h"
#include "core/fnv1a.h"

namespace seldinger {

void write_sealed(const FilePlace& place, std::string_view magic, const std::vector<std::uint8_t>& payload)
{
    std::vector<std::uint8_t> file;
    put_bytes(file, magic.data(), magic.size());
    const std::uint64_t size = payload.size(), hash = fnv1a(payload.data(), payload.size());
    put_bytes(file, &size, 1);
    put_bytes(file, payload.data(), payload.size());
    put_bytes(file, &hash, 1);
    write_file(place, {reinterpret_cast<const char*>(file.data()), file.size()}, Durable::Yes);
}

std::vector<std::uint8_t> read_sealed(const FilePlace& place, std::string_view magic)
{
    const std::string file = read_file(place);
    const std::size_t frame = magic.size() + 2 * sizeof(std::uint64_t);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(file.data());
    std::uint64_t size = 0, hash = 0;
    bool whole = file.size() >= frame && file.starts_with(magic);
    if (whole) {
        std::memcpy(&size, bytes + magic.size(), sizeof size);
        whole = size == file.size() - frame;
    }
    const std::uint8_t* payload = bytes + magic.size() + sizeof size;
    if (whole) {
        std::memcpy(&hash, bytes + file.size() - sizeof hash, sizeof hash);
        whole = hash == fnv1a(payload, size);
    }
    if (!whole)
        throw Error(ErrorKind::BadFile, place.path().string() + ": is damaged or not a checkpoint; run again with --overwrite");
    return {payload, payload + size};
}

}  // namespace seldinger

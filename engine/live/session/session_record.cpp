// Reads and writes records of live sessions.
#include "session/session_record.h"

#include "core/bytes.h"
#include "core/fnv1a.h"
#include "engine.h"
#include "io/json_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace seldinger {
namespace {

constexpr std::string_view magic = "SELLIVE1";
constexpr std::uint32_t longest_header = 1 << 16;
constexpr std::uint64_t most_wires = 1000;
constexpr double most_asked = 1e9;  // [m] or [rad], as of a scene's keys

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what)
{
    throw Error(ErrorKind::BadFile, fmt::format("{}: {}; expected a record of `seldinger live --record`", path.string(), what));
}

std::string header_text(const RecordHeader& h)
{
    return json_text(nlohmann::json{{"version", h.version}, {"scene", h.scene_name},
                                    {"device", h.device},   {"scene_hash", fmt::format("{:016x}", h.scene_hash)},
                                    {"dt_s", h.dt},         {"vessel_hash", fmt::format("{:016x}", h.vessel_hash)},
                                    {"instruments", h.instruments}});
}

RecordHeader header_from(const std::string& text)
{
    const auto json = nlohmann::json::parse(text);
    const auto hash = [&](const char* key) { return std::stoull(json.at(key).get<std::string>(), nullptr, 16); };
    RecordHeader h;
    h.version = json.at("version");
    h.scene_name = json.at("scene");
    h.device = json.at("device");
    h.scene_hash = hash("scene_hash");
    h.vessel_hash = hash("vessel_hash");
    h.dt = json.at("dt_s");
    const auto& instruments = json.at("instruments");  // a number above what an int holds would be cut to another one
    const bool counts = instruments.is_number_unsigned() && instruments.get<std::uint64_t>() - 1 < most_wires;
    if (!(h.dt > 0) || !counts) throw std::invalid_argument("out of range");
    h.instruments = instruments.get<int>();
    return h;
}

/// Entries of one block. @return false if they do not fill it exactly, or hold an impossible value
bool take_entries(std::string_view block, SessionRecord& record)
{
    const std::size_t hubs = static_cast<std::size_t>(2 * record.header.instruments);
    while (block.size() >= 2) {
        RecordEntry entry;
        entry.kind = static_cast<RecordEntry::Kind>(block[0]);
        entry.flags = static_cast<std::uint8_t>(block[1]);
        block.remove_prefix(2);
        std::size_t size = 0;
        if (entry.kind == RecordEntry::Kind::Step) {
            size = hubs * sizeof(double);
            if (block.size() < size) return false;
            entry.hubs.resize(hubs);
            std::memcpy(entry.hubs.data(), block.data(), size);
            const auto is_asked = [](double value) { return std::abs(value) <= most_asked; };  // false of NaN
            if (!std::all_of(entry.hubs.begin(), entry.hubs.end(), is_asked)) return false;
        } else if (entry.kind == RecordEntry::Kind::CutShort) {
            size = sizeof entry.trials;
            if (block.size() < size) return false;
            std::memcpy(&entry.trials, block.data(), size);
            if (entry.trials == 0) return false;
        } else if (entry.kind == RecordEntry::Kind::End) {
            size = 16;
            if (block.size() < size) return false;
            entry.hash = block.substr(0, size);
            record.whole = true;
        } else if (entry.kind != RecordEntry::Kind::Reset) {
            return false;
        }
        block.remove_prefix(size);
        record.entries.push_back(std::move(entry));
    }
    return block.empty();
}

}  // namespace

long SessionRecord::steps() const
{
    return std::count_if(entries.begin(), entries.end(), [](const RecordEntry& e) { return e.kind == RecordEntry::Kind::Step; });
}

std::uint64_t record_hash(const Scene& scene)
{
    Scene plain = scene;
    const Scene usual;
    plain.name.clear();
    plain.planned.clear();
    plain.duration = plain.dt = 1;
    plain.until = usual.until;
    plain.record_every = usual.record_every;
    plain.seed = usual.seed;
    plain.wire_every = plain.contacts_every = 1;
    plain.task = {};
    if (plain.feed.on) plain.feed.keys = {plain.feed.at(0)};
    // a mesh is identified by its own hash, wherever it lies
    if (!plain.vessel.mesh.empty()) plain.vessel.mesh = "mesh";
    if (!plain.vessel.centreline.empty()) plain.vessel.centreline = "centreline";
    const std::string text = write_scene(plain, ".");
    return fnv1a(text.data(), text.size());
}

void put_step(std::vector<std::uint8_t>& bytes, std::uint8_t flags, const double* hubs, int instruments)
{
    bytes.push_back(static_cast<std::uint8_t>(RecordEntry::Kind::Step));
    bytes.push_back(flags);
    put_bytes(bytes, hubs, static_cast<std::size_t>(2 * instruments));
}

void put_cut_short(std::vector<std::uint8_t>& bytes, std::uint32_t trials)
{
    bytes.push_back(static_cast<std::uint8_t>(RecordEntry::Kind::CutShort));
    bytes.push_back(0);
    put_bytes(bytes, &trials, 1);
}

void put_reset(std::vector<std::uint8_t>& bytes)
{
    bytes.push_back(static_cast<std::uint8_t>(RecordEntry::Kind::Reset));
    bytes.push_back(0);
}

RecordWriter::RecordWriter(const std::filesystem::path& path, const RecordHeader& header)
{
    std::error_code missing;
    if (std::filesystem::exists(path, missing)) {
        const bool is_record = std::filesystem::is_regular_file(path, missing) && read_file(path).starts_with(magic);
        if (!is_record)
            throw Error(ErrorKind::BadScene,
                        fmt::format("{}: exists, is not a record and would be overwritten; choose another file with --record",
                                    path.string()));
    }
    make_folder_of(path);
    file_ = AppendFile(path, 0);
    const std::string text = header_text(header);
    const auto length = static_cast<std::uint32_t>(text.size());
    std::string head(magic);
    head.append(reinterpret_cast<const char*>(&length), sizeof length);
    file_.append(head + text);
}

void RecordWriter::append(const std::vector<std::uint8_t>& entries)
{
    if (entries.empty()) return;
    const auto length = static_cast<std::uint32_t>(entries.size());
    const std::uint64_t sum = fnv1a(entries.data(), entries.size());
    std::string block(reinterpret_cast<const char*>(&length), sizeof length);
    block.append(reinterpret_cast<const char*>(&sum), sizeof sum);
    block.append(reinterpret_cast<const char*>(entries.data()), entries.size());
    file_.append(block);
}

void RecordWriter::finish(const std::string& state_hash)
{
    std::vector<std::uint8_t> end = {static_cast<std::uint8_t>(RecordEntry::Kind::End), 0};
    end.insert(end.end(), state_hash.begin(), state_hash.end());
    append(end);
    file_.sync();
}

SessionRecord read_record(const std::filesystem::path& path)
{
    const std::string text = read_file(path);
    std::string_view rest = text;
    if (!rest.starts_with(magic) || rest.size() < magic.size() + 4) fail(path, "is no record");
    rest.remove_prefix(magic.size());
    const auto take = [&](auto& value) {
        std::memcpy(&value, rest.data(), sizeof value);
        rest.remove_prefix(sizeof value);
    };
    std::uint32_t length = 0;
    take(length);
    if (length > longest_header || length > rest.size()) fail(path, "is damaged at its head");
    SessionRecord record;
    try {
        record.header = header_from(std::string(rest.substr(0, length)));
    } catch (const std::exception&) {
        fail(path, "is damaged at its head");
    }
    rest.remove_prefix(length);
    while (rest.size() >= 12) {  // what follows a block that is not whole is what a kill left
        std::uint64_t sum = 0;
        take(length);
        take(sum);
        if (length > rest.size() || fnv1a(rest.data(), length) != sum) break;
        if (!take_entries(rest.substr(0, length), record)) fail(path, "has a damaged block");
        rest.remove_prefix(length);
    }
    return record;
}

void check_record(const SessionRecord& record, const std::filesystem::path& path, const Scene& scene, std::uint64_t vessel_hash)
{
    const RecordHeader& h = record.header;
    const auto wrong = [&](const std::string& what) {
        throw Error(ErrorKind::BadScene, fmt::format("{}: {}", path.string(), what));
    };
    if (h.version != version())
        wrong(fmt::format("was recorded by version {}, this is {}; replay it with that one", h.version, version()));
    if (h.scene_hash != record_hash(scene))
        wrong(fmt::format("is of another scene (\"{}\") or of other --set; give those that the session had", h.scene_name));
    if (h.vessel_hash != vessel_hash) wrong("is of another vessel: the mesh file has changed since");
}

}  // namespace seldinger

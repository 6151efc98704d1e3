// Prepared vessels to and from the bytes of a cache entry: key, checksum, arrays.
#include "setup/vessel_cache.h"

#include "core/cache_folder.h"
#include "core/content_hash.h"
#include "core/error.h"
#include "core/note.h"
#include "core/printable.h"
#include "engine.h"
#include "vessel/shared_tree.h"

#include <elf.h>
#include <fmt/format.h>
#include <link.h>
#include <atomic>
#include <charconv>
#include <cstdlib>
#include <cstring>

namespace seldinger {
namespace {

constexpr std::string_view vessel_magic = "seldinger vessel 2\n", ending = ".vessel";
constexpr std::uint64_t usual_limit = 2000, megabyte = 1000000;

std::atomic<bool> turned_on = false;

class Writer {
public:
    template <class T>
    void put(const T* values, std::size_t count)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
    }
    void number(std::int64_t n) { put(&n, 1); }
    void point(const Vec3& p)
    {
        const double xyz[3] = {p.x(), p.y(), p.z()};
        put(xyz, 3);
    }
    void points(const std::vector<Vec3>& list)
    {
        number(static_cast<std::int64_t>(list.size()));
        for (const Vec3& p : list) point(p);
    }
    template <class T>
    void list(const T& values)  // vector or string of plain values
    {
        number(static_cast<std::int64_t>(values.size()));
        put(values.data(), values.size());
    }
    void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

struct Damaged {};  // how a Reader says so

class Reader {
public:
    explicit Reader(std::string_view bytes) : left_(bytes) {}
    template <class T>
    void take(T* values, std::size_t count)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        if (count > left_.size() / sizeof(T)) throw Damaged{};
        if (count > 0) std::memcpy(values, left_.data(), count * sizeof(T));
        left_.remove_prefix(count * sizeof(T));
    }
    std::int64_t number()
    {
        std::int64_t n = 0;
        take(&n, 1);
        return n;
    }
    Vec3 point()
    {
        double xyz[3];
        take(xyz, 3);
        return {xyz[0], xyz[1], xyz[2]};
    }
    /// Length of a list whose items take that many bytes.
    std::size_t count(std::size_t bytes_each)
    {
        const std::int64_t n = number();
        if (n < 0 || static_cast<std::uint64_t>(n) > left_.size() / bytes_each) throw Damaged{};
        return static_cast<std::size_t>(n);
    }
    void points(std::vector<Vec3>& list)
    {
        list.reserve(count(3 * sizeof(double)));
        for (std::size_t n = list.capacity(); list.size() < n;) list.push_back(point());
    }
    template <class T>
    void list(T& values)
    {
        values.resize(count(sizeof(typename T::value_type)));
        take(values.data(), values.size());
    }
    [[nodiscard]] bool at_end() const { return left_.empty(); }

private:
    std::string_view left_;
};

/// Every count of the report, in one place for both ways.
template <class Report, class Each>
void each_count(Report& r, const Each& each)
{
    for (auto* n : {&r.triangles_read, &r.triangles, &r.vertices, &r.vertices_welded, &r.non_finite_dropped,
                    &r.degenerate_dropped, &r.duplicates_dropped, &r.flipped, &r.non_manifold_edges, &r.boundary_edges,
                    &r.components, &r.hole_loops_closed, &r.slivers})
        each(*n);
}

std::string bytes_of(const LoadedVessel& vessel)
{
    Writer out;
    out.reserve(24 * vessel.mesh.vertices.size() + 32 * vessel.mesh.triangles.size() + (1 << 20));
    out.points(vessel.mesh.vertices);
    out.list(vessel.mesh.triangles);
    const RepairReport& r = vessel.report;
    each_count(r, [&](long n) { out.number(n); });
    out.number(r.inverted);
    out.number(static_cast<std::int64_t>(r.loops.size()));
    for (const BoundaryLoop& loop : r.loops) {
        out.list(loop.vertices);
        out.point(loop.centre);
        out.point(loop.inward);
        out.put(&loop.radius, 1);
    }
    out.number(static_cast<std::int64_t>(r.notes.size()));
    for (const std::string& text : r.notes) out.list(text);
    out.points(r.unreached);
    out.points(vessel.centreline.points);
    out.list(vessel.centreline.radius);
    out.list(vessel.centreline.parent);
    const TreeDivision division = division_of(*shared_wall_tree(vessel.mesh));
    out.list(division.nodes);
    out.list(division.original);
    out.list(division.edge_bits);
    return out.bytes();
}

void check_indices(const LoadedVessel& vessel)
{
    const auto vertices = static_cast<std::int32_t>(vessel.mesh.vertices.size());
    const auto known = [&](std::int32_t v) { return v >= 0 && v < vertices; };
    bool sound = true;
    for (const auto& t : vessel.mesh.triangles) sound &= known(t[0]) && known(t[1]) && known(t[2]);
    for (const BoundaryLoop& loop : vessel.report.loops)
        for (const std::int32_t v : loop.vertices) sound &= known(v);
    const Centreline& line = vessel.centreline;
    sound &= line.radius.size() == line.points.size() && line.parent.size() == line.points.size();
    for (const int parent : line.parent) sound &= parent >= -1 && parent < static_cast<int>(line.points.size());
    if (!sound) throw Damaged{};
}

LoadedVessel vessel_in(std::string_view bytes)
{
    Reader in(bytes);
    LoadedVessel vessel;
    in.points(vessel.mesh.vertices);
    in.list(vessel.mesh.triangles);
    RepairReport& r = vessel.report;
    each_count(r, [&](long& n) { n = static_cast<long>(in.number()); });
    r.inverted = in.number() != 0;
    r.loops.resize(in.count(1));
    for (BoundaryLoop& loop : r.loops) {
        in.list(loop.vertices);
        loop.centre = in.point();
        loop.inward = in.point();
        in.take(&loop.radius, 1);
    }
    r.notes.resize(in.count(1));
    for (std::string& text : r.notes) in.list(text);
    in.points(r.unreached);
    in.points(vessel.centreline.points);
    in.list(vessel.centreline.radius);
    in.list(vessel.centreline.parent);
    TreeDivision division;
    in.list(division.nodes);
    in.list(division.original);
    in.list(division.edge_bits);
    if (!in.at_end()) throw Damaged{};
    check_indices(vessel);
    std::optional<WallTree> tree = divided_wall_tree(vessel.mesh, std::move(division));
    if (!tree) throw Damaged{};
    keep_wall_tree(vessel.mesh, std::move(*tree));
    return vessel;
}

/// The linker's fingerprint of the program or library that this function is in, as hexadecimal digits; empty without one.
std::string build_id()
{
    std::string id;
    const auto look = [](dl_phdr_info* info, std::size_t, void* result) -> int {
        const auto here = reinterpret_cast<ElfW(Addr)>(&turned_on);
        bool ours = false;
        for (int k = 0; k < info->dlpi_phnum; ++k) {
            const auto& part = info->dlpi_phdr[k];
            const ElfW(Addr) begin = info->dlpi_addr + part.p_vaddr;
            ours |= part.p_type == PT_LOAD && here >= begin && here < begin + part.p_memsz;
        }
        for (int k = 0; ours && k < info->dlpi_phnum; ++k) {
            const auto& part = info->dlpi_phdr[k];
            if (part.p_type != PT_NOTE) continue;
            const auto* at = reinterpret_cast<const unsigned char*>(info->dlpi_addr + part.p_vaddr);
            const auto* end = at + part.p_memsz;
            const std::size_t step = part.p_align > 4 ? 8 : 4;
            while (at + sizeof(ElfW(Nhdr)) <= end) {
                ElfW(Nhdr) note;
                std::memcpy(&note, at, sizeof note);
                const auto* name = at + sizeof note;
                const auto padded = [&](std::size_t n) { return (n + step - 1) / step * step; };
                const auto* text = name + padded(note.n_namesz);
                if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0)
                    for (std::size_t i = 0; i < note.n_descsz; ++i)
                        *static_cast<std::string*>(result) += fmt::format("{:02x}", text[i]);
                at = text + padded(note.n_descsz);
            }
        }
        return ours;
    };
    ::dl_iterate_phdr(look, &id);
    return id;
}

std::string file_of(const std::string& key)
{
    const ContentHash hash = content_hash(key);
    return fmt::format("{:016x}{:016x}{}", hash.high, hash.low, ending);
}

/// vessel_magic, key, zero, checksum of the payload, payload
std::string sealed(const std::string& key, const std::string& payload)
{
    const ContentHash hash = content_hash(payload);
    std::string file;
    file.reserve(vessel_magic.size() + key.size() + 1 + sizeof hash + payload.size());
    file.append(vessel_magic).append(key).push_back('\0');
    file.append(reinterpret_cast<const char*>(&hash), sizeof hash).append(payload);
    return file;
}

LoadedVessel opened(const std::string& key, std::string_view file)
{
    const std::size_t head = vessel_magic.size() + key.size() + 1;
    ContentHash hash;
    if (file.size() < head + sizeof hash || !file.starts_with(vessel_magic) ||
        file.substr(vessel_magic.size(), key.size() + 1) != std::string_view(key.c_str(), key.size() + 1))
        throw Damaged{};
    std::memcpy(&hash, file.data() + head, sizeof hash);
    const std::string_view payload = file.substr(head + sizeof hash);
    if (content_hash(payload) != hash) throw Damaged{};
    return vessel_in(payload);
}

}  // namespace

void use_vessel_cache(bool on) { turned_on = on; }

std::uint64_t vessel_cache_limit()
{
    if (!turned_on) return 0;
    const char* given = std::getenv("SELDINGER_VESSEL_CACHE");
    if (!given || !*given) return usual_limit * megabyte;
    const std::string_view text = given;
    if (text == "off") return 0;
    std::uint64_t megabytes = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), megabytes);
    if (error != std::errc() || end != text.data() + text.size() || megabytes > ~std::uint64_t{0} / megabyte)
        throw Error(ErrorKind::BadScene,
                    fmt::format("SELDINGER_VESSEL_CACHE: got \"{}\"; expected \"off\" or a number of megabytes. "
                                "Fix: unset it, or give one of these.",
                                printable(text)));
    return megabytes * megabyte;
}

std::string vessel_key(std::string_view bytes, const std::string& extension, const std::string& units, bool with_centreline)
{
    const std::string build = build_id();
    if (build.empty()) return {};
    const ContentHash content = content_hash(bytes);
    return fmt::format("seldinger {} build {}\n{} bytes of \"{}\" in {}, content {:016x}{:016x}\ncentreline {}\n", version(),
                       build, bytes.size(), printable(extension), units, content.high, content.low,
                       with_centreline ? "found" : "given");
}

std::optional<LoadedVessel> find_prepared(const std::string& key)
{
    if (key.empty() || vessel_cache_limit() == 0) return std::nullopt;
    const CacheFolder folder;
    if (!folder.is_open()) return std::nullopt;
    const std::string name = file_of(key);
    const std::optional<CacheFolder::Entry> entry = folder.read(name);
    if (!entry) return std::nullopt;
    try {
        if (!entry->foreign) return opened(key, entry->bytes);
    } catch (const Damaged&) {
    } catch (const std::bad_alloc&) {  // the mesh itself may still fit
    }
    note(fmt::format("seldinger: the prepared vessel {} is {}; preparing the vessel again\n", printable(folder.path_of(name)),
                     entry->foreign ? "a link or another user's" : "damaged"));
    folder.remove(name);
    return std::nullopt;
}

void keep_prepared(const std::string& key, const LoadedVessel& vessel)
{
    const std::uint64_t limit = key.empty() ? 0 : vessel_cache_limit();
    if (limit == 0) return;
    const CacheFolder folder;
    if (!folder.is_open()) return;
    const std::string file = sealed(key, bytes_of(vessel));
    if (file.size() > limit) return;
    folder.trim(ending, limit - file.size());
    folder.write(file_of(key), file);
}

}  // namespace seldinger

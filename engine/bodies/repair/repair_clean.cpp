// Repair, first half: removes non-finite, degenerate and double triangles, and welds vertices.
#include "core/check.h"
#include "repair/repair_steps.h"
#include "vessel/mesh_components.h"
#include "vessel/mesh_edges.h"
#include "vessel/triangle_geometry.h"
#include "vessel/work_budget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>

namespace seldinger::repair_steps {
namespace {

/// Keeps the triangles for which keep(t) holds; returns how many went.
template <class Keep>
long keep_triangles(WallMesh& mesh, Keep keep)
{
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (keep(t)) mesh.triangles[kept++] = mesh.triangles[t];
    const long dropped = static_cast<long>(mesh.triangles.size() - kept);
    mesh.triangles.resize(kept);
    return dropped;
}

/// Three corners in a fixed order, then whether that order is an odd permutation of the triangle's own, then its index.
struct TriangleKey {
    std::array<std::int32_t, 3> corners;
    bool odd;
    std::int32_t triangle;
    auto operator<=>(const TriangleKey&) const = default;
};

TriangleKey key_of(const WallMesh& mesh, std::size_t t)
{
    auto v = mesh.triangles[t];
    bool odd = false;
    for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {0, 1}})  // bubble sort of three, counting swaps
        if (v[static_cast<std::size_t>(a)] > v[static_cast<std::size_t>(b)]) {
            std::swap(v[static_cast<std::size_t>(a)], v[static_cast<std::size_t>(b)]);
            odd = !odd;
        }
    return {v, odd, static_cast<std::int32_t>(t)};
}

/// Counting sort by the first corner, then the few keys of each corner: 1/3 of the time of sorting them all.
std::vector<TriangleKey> sorted_keys(const WallMesh& mesh)
{
    std::vector<std::size_t> start(mesh.vertices.size() + 1, 0);
    for (const auto& v : mesh.triangles) ++start[static_cast<std::size_t>(std::min({v[0], v[1], v[2]})) + 1];
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) start[v + 1] += start[v];
    std::vector<TriangleKey> keys(mesh.triangles.size());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (std::size_t t = 0; t < keys.size(); ++t) {
        const TriangleKey key = key_of(mesh, t);
        keys[next[static_cast<std::size_t>(key.corners[0])]++] = key;
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        std::sort(keys.begin() + static_cast<std::ptrdiff_t>(start[v]), keys.begin() + static_cast<std::ptrdiff_t>(start[v + 1]));
    return keys;
}

long drop_equal_copies(WallMesh& mesh, const std::vector<TriangleKey>& keys)
{
    std::vector<bool> copy(keys.size(), false);
    for (std::size_t k = 1; k < keys.size(); ++k)
        copy[static_cast<std::size_t>(keys[k].triangle)] =
            keys[k].corners == keys[k - 1].corners && keys[k].odd == keys[k - 1].odd;
    return keep_triangles(mesh, [&](std::size_t t) { return !copy[t]; });
}

/// For each triangle the one on the same corners that faces the other way, -1: none. @param keys  without equal copies
std::vector<std::int32_t> opposite_twins(const std::vector<TriangleKey>& keys)
{
    std::vector<std::int32_t> twin(keys.size(), -1);
    for (std::size_t k = 1; k < keys.size(); ++k) {
        if (keys[k].corners != keys[k - 1].corners) continue;
        twin[static_cast<std::size_t>(keys[k].triangle)] = keys[k - 1].triangle;
        twin[static_cast<std::size_t>(keys[k - 1].triangle)] = keys[k].triangle;
    }
    return twin;
}

/// Which twins are folds, and which are one wall written twice. Without both twins of a patch, an even number of other triangles
/// meets its rim round a fold (the wall continues without the patch), and an odd number round a doubled wall (a hole).
std::vector<bool> folded_twins(const WallMesh& mesh, const std::vector<std::int32_t>& twin)
{
    std::vector<std::int32_t> group(twin.size());
    for (std::size_t t = 0; t < group.size(); ++t) group[t] = static_cast<std::int32_t>(t);
    auto root = [&](std::int32_t t) {
        while (group[static_cast<std::size_t>(t)] != t) {
            group[static_cast<std::size_t>(t)] = group[static_cast<std::size_t>(group[static_cast<std::size_t>(t)])];
            t = group[static_cast<std::size_t>(t)];
        }
        return static_cast<std::size_t>(t);
    };
    const MeshEdges edges = find_edges(mesh);
    std::vector<std::pair<std::int32_t, int>> votes;  // a twin on the rim, + fold or - wall
    for (std::size_t k = 0; k < edges.count(); ++k) {
        std::int32_t first = -1;
        int others = 0;
        for (const std::int32_t h : edges.uses(k)) {
            if (twin[static_cast<std::size_t>(h / 3)] < 0) {
                ++others;
                continue;
            }
            if (first < 0) first = h / 3;
            else group[root(h / 3)] = static_cast<std::int32_t>(root(first));
        }
        if (first >= 0 && others > 0) votes.emplace_back(first, others % 2 == 0 ? 1 : -1);
    }
    std::vector<int> balance(twin.size(), 0);
    for (const auto& [t, vote] : votes) balance[root(t)] += vote;
    std::vector<bool> fold(twin.size(), false);
    for (std::size_t t = 0; t < twin.size(); ++t) fold[t] = twin[t] >= 0 && balance[root(static_cast<std::int32_t>(t))] > 0;
    return fold;
}

}  // namespace

double median_edge(const WallMesh& mesh)
{
    std::vector<double> lengths;
    lengths.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(mesh, t);
        for (const double length : {(tri.b - tri.a).norm(), (tri.c - tri.b).norm(), (tri.a - tri.c).norm()})
            if (length > 0) lengths.push_back(length);
    }
    if (lengths.empty()) return 0;
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    return *middle;
}

namespace {

/// Hash grid of representatives in one table, each with its place: a look-up is one line of memory, which whoever asks for many
/// can ask for ahead. Cells are 4 tolerances wide.
class WeldGrid {
public:
    WeldGrid(std::size_t vertices, double tolerance, const Vec3& low) : tolerance_(tolerance), cell_(4 * tolerance), low_(low)
    {
        // a soup has six copies of each vertex, so this is rarely too small
        std::size_t slots = 64;
        while (slots < vertices / 3) slots *= 2;
        slots_.resize(slots);
    }
    /// Where a vertex at p is looked for first.
    [[nodiscard]] std::uint64_t home(const Vec3& p) const { return key(cell(p.x(), 0), cell(p.y(), 1), cell(p.z(), 2)); }
    void expect(std::uint64_t home) const { __builtin_prefetch(&slots_[home & (slots_.size() - 1)]); }

    /// The earlier vertex that v is welded to, or v itself, which then represents its place p.
    std::int32_t representative(std::int32_t v, const Vec3& p, std::uint64_t home)
    {
        // Representatives are farther apart than the tolerance: one in the very place of p is the only one within it.
        for (std::size_t at = first(home); slots_[at].vertex >= 0; at = next(at))
            if (slots_[at].place == p) return slots_[at].vertex;
        std::int32_t best = v;
        std::array<std::int64_t, 3> from, to;
        for (std::size_t d = 0; d < 3; ++d) from[d] = cell(p[d] - tolerance_, d), to[d] = cell(p[d] + tolerance_, d);
        for (std::int64_t x = from[0]; x <= to[0]; ++x)
            for (std::int64_t y = from[1]; y <= to[1]; ++y)
                for (std::int64_t z = from[2]; z <= to[2]; ++z) best = std::min(best, search(key(x, y, z), p, v));
        if (best == v) insert({p, v}, home);
        return best;
    }

private:
    struct Slot {
        Vec3 place;
        std::int32_t vertex = -1;  // -1: empty
    };
    [[nodiscard]] std::int64_t cell(double coordinate, std::size_t d) const
    {
        return static_cast<std::int64_t>(std::floor((coordinate - low_[d]) / cell_));
    }
    static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z)
    {
        // cells that share a key are distinguished by distance; mixed by large odd numbers, so that distant cells in a row do not
        // share
        std::uint64_t mixed = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u;
        mixed = (mixed ^ (mixed >> 32) ^ static_cast<std::uint64_t>(y)) * 0xbf58476d1ce4e5b9u;
        mixed = (mixed ^ (mixed >> 29) ^ static_cast<std::uint64_t>(z)) * 0x94d049bb133111ebu;
        return mixed ^ (mixed >> 32);
    }
    [[nodiscard]] std::size_t first(std::uint64_t key) const { return key & (slots_.size() - 1); }
    [[nodiscard]] std::size_t next(std::size_t at) const { return (at + 1) & (slots_.size() - 1); }
    [[nodiscard]] std::int32_t search(std::uint64_t key, const Vec3& p, std::int32_t v) const
    {
        std::int32_t best = v;
        for (std::size_t at = first(key); slots_[at].vertex >= 0; at = next(at))
            if ((slots_[at].place - p).norm() <= tolerance_) best = std::min(best, slots_[at].vertex);
        return best;
    }
    void insert(const Slot& slot, std::uint64_t home)
    {
        if (2 * ++used_ > slots_.size()) grow();
        std::size_t at = first(home);
        while (slots_[at].vertex >= 0) at = next(at);
        slots_[at] = slot;
    }
    void grow()
    {
        std::vector<Slot> old(2 * slots_.size());
        old.swap(slots_);
        used_ = 1;  // the one that is coming
        for (const Slot& slot : old)
            if (slot.vertex >= 0) insert(slot, home(slot.place));
    }
    double tolerance_, cell_;
    Vec3 low_;
    std::vector<Slot> slots_;  // open addressing, a power of two
    std::size_t used_ = 0;
};

/// For each vertex, the earlier vertex that it is welded to, or itself.
std::vector<std::int32_t> weld_targets(const std::vector<Vec3>& vertices, double tolerance, const Vec3& low)
{
    constexpr std::size_t ahead = 32;
    WeldGrid grid(vertices.size(), tolerance, low);
    std::vector<std::int32_t> target(vertices.size());
    std::array<std::uint64_t, ahead> home;
    for (std::size_t begin = 0; begin < target.size(); begin += ahead) {
        const std::size_t end = std::min(begin + ahead, target.size());
        for (std::size_t v = begin; v < end; ++v) grid.expect(home[v - begin] = grid.home(vertices[v]));
        for (std::size_t v = begin; v < end; ++v)
            target[v] = grid.representative(static_cast<std::int32_t>(v), vertices[v], home[v - begin]);
    }
    return target;
}

}  // namespace

void drop_non_finite(WallMesh& mesh, RepairReport& report)
{
    const auto count = static_cast<std::int32_t>(mesh.vertices.size());
    report.non_finite_dropped = keep_triangles(mesh, [&](std::size_t t) {
        return std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), [&](std::int32_t v) {
            return v >= 0 && v < count && mesh.vertices[static_cast<std::size_t>(v)].allFinite();
        });
    });
    drop_unused_vertices(mesh);
}

void weld(WallMesh& mesh, RepairReport& report)
{
    if (mesh.triangles.empty()) return;
    Box3 box;
    for (const Vec3& v : mesh.vertices) box.extend(v);
    // A mesh that is a single point has no edge to compare with; any tolerance above 0 welds it. Doubles cannot separate places
    // nearer than 1e-16 of the box. Cells are numbered in 64 bits.
    const double across = box.diagonal().norm();
    const double tolerance = std::max({std::min(1e-6 * across, 1e-3 * median_edge(mesh)), 1e-17 * across, 1e-300});
    const std::vector<std::int32_t> target = weld_targets(mesh.vertices, tolerance, box.min());
    for (std::size_t v = 0; v < target.size(); ++v) report.vertices_welded += target[v] != static_cast<std::int32_t>(v);
    for (auto& triangle : mesh.triangles)
        for (auto& v : triangle) v = target[static_cast<std::size_t>(v)];
    drop_unused_vertices(mesh);
}

void drop_degenerate(WallMesh& mesh, RepairReport& report)
{
    report.degenerate_dropped += keep_triangles(mesh, [&](std::size_t t) {
        const auto& v = mesh.triangles[t];
        return v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
    });
}

void drop_duplicates(WallMesh& mesh, RepairReport& report)
{
    std::vector<TriangleKey> keys = sorted_keys(mesh);
    const long copies = drop_equal_copies(mesh, keys);
    report.duplicates_dropped += copies;
    if (copies > 0) keys = sorted_keys(mesh);
    const std::vector<std::int32_t> twin = opposite_twins(keys);
    if (std::all_of(twin.begin(), twin.end(), [](std::int32_t t) { return t < 0; })) return;
    const std::vector<bool> fold = folded_twins(mesh, twin);
    long folds = 0;
    const long dropped = keep_triangles(mesh, [&](std::size_t t) {
        if (twin[t] < 0) return true;
        folds += fold[t];
        return !fold[t] && static_cast<std::size_t>(twin[t]) > t;
    });
    report.duplicates_dropped += dropped;
    note(report, folds / 2, "pair of triangles lay face to face as a fold without a lumen between; both were removed",
         "pairs of triangles lay face to face as folds without a lumen between them; both of each pair were removed");
}

MeshEdges drop_flaps(WallMesh& mesh, RepairReport& report)
{
    long dropped = 0;
    MeshEdges edges;
    WorkBudget work("taking off flaps, a rim at a time,", 1e7 + 100.0 * static_cast<double>(mesh.triangles.size()));
    for (long last = -1; last != 0;) {  // a flap may be several triangles long
        work.spend(static_cast<double>(mesh.triangles.size()));
        edges = find_edges(mesh);
        std::vector<std::uint8_t> open(mesh.triangles.size(), 0);  // open edges of each triangle
        for (std::size_t k = 0; k < edges.count(); ++k)
            if (edges.uses(k).size() == 1) ++open[static_cast<std::size_t>(edges.uses(k)[0] / 3)];
        std::vector<bool> flap(mesh.triangles.size(), false);
        for (std::size_t k = 0; k < edges.count(); ++k) {
            const auto uses = edges.uses(k);
            if (uses.size() == 1 || uses.size() % 2 == 0) continue;  // an odd one out hangs here
            const auto loosest = *std::max_element(uses.begin(), uses.end(), [&](std::int32_t a, std::int32_t b) {
                return open[static_cast<std::size_t>(a / 3)] < open[static_cast<std::size_t>(b / 3)];
            });
            if (open[static_cast<std::size_t>(loosest / 3)] > 0) flap[static_cast<std::size_t>(loosest / 3)] = true;
        }
        last = keep_triangles(mesh, [&](std::size_t t) { return !flap[t]; });
        dropped += last;
    }
    note(report, dropped, "triangle hung on the wall as a flap and was removed",
         "triangles hung on the wall as flaps and were removed");
    drop_unused_vertices(mesh);  // which keeps the order of the others, and with it that of the edges
    return edges;
}

void weld_rims(WallMesh& mesh, MeshEdges& edges, RepairReport& report)
{
    constexpr double gap = 0.02;  // of an edge: rounded numbers, two halves of a mirrored model
    std::vector<std::int32_t> rim;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const std::int32_t h = edges.uses(k)[0];
        if (edges.uses(k).size() == 1) rim.push_back(half_edge_from(mesh, h)), rim.push_back(half_edge_to(mesh, h));
    }
    std::sort(rim.begin(), rim.end());
    rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
    const std::vector<std::int32_t> label = label_components(mesh, edges);
    if (rim.empty() || *std::max_element(label.begin(), label.end()) == 0) return;
    const std::vector<std::int32_t> part = labels_of_vertices(mesh, label);
    std::vector<std::int32_t> target(mesh.vertices.size(), -1);
    std::vector<Vec3> places;
    Box3 box;
    for (const std::int32_t v : rim) places.push_back(mesh.vertices[static_cast<std::size_t>(v)]), box.extend(places.back());
    const std::vector<std::int32_t> to = weld_targets(places, gap * median_edge(mesh), box.min());
    long joined = 0;
    for (std::size_t k = 0; k < rim.size(); ++k) {
        const auto v = static_cast<std::size_t>(rim[k]), other = static_cast<std::size_t>(rim[static_cast<std::size_t>(to[k])]);
        if (part[v] != part[other]) target[v] = static_cast<std::int32_t>(other), ++joined;
    }
    if (joined == 0) return;
    report.vertices_welded += joined;
    note(report, joined, "point on rims of parts that nearly meet was joined (gaps below 2 % of an edge)",
         "points on rims of parts that nearly meet were joined (gaps below 2 % of an edge)");
    for (auto& triangle : mesh.triangles)
        for (auto& v : triangle)
            if (target[static_cast<std::size_t>(v)] >= 0) v = target[static_cast<std::size_t>(v)];
    drop_degenerate(mesh, report);
    drop_unused_vertices(mesh);
    edges = find_edges(mesh);
}

void drop_crumbs(WallMesh& mesh, MeshEdges& edges, RepairReport& report)
{
    constexpr long times = 100;  // more triangles has the part that they hang on
    constexpr int longest = 5;   // chain of such
    const std::vector<std::int32_t> label = label_components(mesh, edges);
    std::vector<long> size, largest(mesh.vertices.size(), 0);  // triangles of each part; of the largest part at each vertex
    for (const std::int32_t k : label) {
        if (static_cast<std::size_t>(k) >= size.size()) size.resize(static_cast<std::size_t>(k) + 1, 0);
        ++size[static_cast<std::size_t>(k)];
    }
    std::vector<long> beside = size;  // of the largest part that each hangs on
    const auto each_corner = [&](const auto& visit) {
        for (std::size_t t = 0; t < label.size(); ++t)
            for (const std::int32_t v : mesh.triangles[t])
                visit(beside[static_cast<std::size_t>(label[t])], largest[static_cast<std::size_t>(v)]);
    };
    for (int link = 0; link < longest && size.size() > 1; ++link) {
        each_corner([](long part, long& most) { most = std::max(most, part); });
        each_corner([](long& part, long most) { part = std::max(part, most); });
    }
    const long dropped = keep_triangles(mesh, [&](std::size_t t) {
        const auto part = static_cast<std::size_t>(label[t]);
        return beside[part] < times * size[part];
    });
    if (dropped == 0) return;
    note(report, dropped, "triangle hung on the wall by a corner and was removed",
         "triangles hung on the wall by a corner and were removed");
    drop_unused_vertices(mesh);
    edges = find_edges(mesh);
}

void dissolve_needles(WallMesh& mesh, MeshEdges& edges, RepairReport& report)
{
    // height below 1e-6 of the longest edge: float32 input cannot tell such a triangle's normal
    constexpr double kFlat = 1e-6;
    for (int pass = 0; pass < 4; ++pass) {
        const std::vector<std::int32_t> opposite = opposite_half_edges(mesh, edges);
        std::vector<bool> gone(mesh.triangles.size(), false), touched(mesh.triangles.size(), false);
        std::vector<std::array<std::int32_t, 3>> added;
        bool again = false;
        for (std::size_t t = 0; t < gone.size(); ++t) {
            const Triangle3 tri = triangle_of(mesh, t);
            const double length[3] = {(tri.b - tri.a).norm(), (tri.c - tri.b).norm(), (tri.a - tri.c).norm()};
            const auto e = static_cast<std::size_t>(std::max_element(length, length + 3) - length);
            if (double_area(tri).norm() > kFlat * length[e] * length[e] || touched[t]) continue;
            const std::int32_t across = opposite[3 * t + e];
            touched[t] = gone[t] = true;
            if (across < 0) continue;
            // neighbour (from, to, apex) lies across the long edge; cut it at the needle's tip
            const auto n = static_cast<std::size_t>(across / 3);
            if (touched[n]) {
                gone[t] = false;
                again = true;
                continue;
            }
            const std::int32_t from = half_edge_from(mesh, across), to = half_edge_to(mesh, across);
            const std::int32_t apex = mesh.triangles[n][static_cast<std::size_t>((across % 3 + 2) % 3)];
            const std::int32_t tip = mesh.triangles[t][(e + 2) % 3];
            touched[n] = gone[n] = true;
            if (tip == apex) continue;  // the two lie on each other
            added.push_back({from, tip, apex});
            added.push_back({tip, to, apex});
        }
        const long needles = std::count(gone.begin(), gone.end(), true) - static_cast<long>(added.size() / 2);
        report.degenerate_dropped += needles;
        keep_triangles(mesh, [&](std::size_t t) { return !gone[t]; });
        mesh.triangles.insert(mesh.triangles.end(), added.begin(), added.end());
        if (needles == 0 && !again) break;
        edges = find_edges(mesh);
    }
    drop_unused_vertices(mesh);
}

void drop_unused_vertices(WallMesh& mesh)
{
    std::vector<std::int32_t> place(mesh.vertices.size(), -1);
    for (const auto& triangle : mesh.triangles)
        for (const std::int32_t v : triangle)
            if (v >= 0 && static_cast<std::size_t>(v) < place.size()) place[static_cast<std::size_t>(v)] = 0;
    std::int32_t kept = 0;
    for (std::size_t v = 0; v < place.size(); ++v) {
        if (place[v] < 0) continue;
        mesh.vertices[static_cast<std::size_t>(kept)] = mesh.vertices[v];
        place[v] = kept++;
    }
    mesh.vertices.resize(static_cast<std::size_t>(kept));
    for (auto& triangle : mesh.triangles)
        for (auto& v : triangle) v = place[static_cast<std::size_t>(v)];
}

}  // namespace seldinger::repair_steps

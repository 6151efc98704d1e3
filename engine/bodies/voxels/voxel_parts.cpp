// Parts of a label: which one is the vessel, what is left out, and where it is open.
#include "voxels/voxels.h"

#include "core/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace seldinger {
namespace {

enum class Joined { Faces, Corners };  // voxels that share a face; an edge or a corner is enough

/// The first run of each run's connected part.
std::vector<std::int32_t> parts_of(const std::vector<VoxelRun>& runs, int rows_per_slice, Joined joined)
{
    std::vector<std::int32_t> up(runs.size());
    std::iota(up.begin(), up.end(), 0);
    const auto first_of = [&](std::int32_t i) {
        while (true) {
            std::int32_t& next = up[static_cast<std::size_t>(i)];
            if (next == i) return i;
            i = next = up[static_cast<std::size_t>(next)];
        }
    };
    const int n = rows_per_slice, reach = joined == Joined::Corners;
    for (const int back : {1, n, n - 1, n + 1}) {  // rows that come before
        if (joined == Joined::Faces && back != 1 && back != n) continue;
        std::size_t j = 0;
        for (std::size_t i = 0; i < runs.size(); ++i) {
            const VoxelRun& run = runs[i];
            const int y = run.row % n;
            if ((back == 1 || back == n + 1) && y == 0) continue;
            if (back == n - 1 && y == n - 1) continue;
            const int row = run.row - back;
            while (j < i && (runs[j].row < row || (runs[j].row == row && runs[j].end + reach <= run.begin))) ++j;
            for (std::size_t k = j; k < i && runs[k].row == row && runs[k].begin < run.end + reach; ++k) {
                const std::int32_t a = first_of(static_cast<std::int32_t>(k)), b = first_of(static_cast<std::int32_t>(i));
                up[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
            }
        }
    }
    for (std::size_t i = 0; i < up.size(); ++i) up[i] = up[static_cast<std::size_t>(up[i])];  // an earlier one has its first
    return up;
}

struct Part {
    std::int64_t voxels = 0;
    Vec3 sum = Vec3::Zero();  // of indices
};

std::map<std::int32_t, Part> measure(const std::vector<VoxelRun>& runs, const std::vector<std::int32_t>& part_of,
                                     int rows_per_slice)
{
    std::map<std::int32_t, Part> parts;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const VoxelRun& r = runs[i];
        const double count = r.end - r.begin;
        Part& part = parts[part_of[i]];
        part.voxels += r.end - r.begin;
        part.sum += count * Vec3(0.5 * (r.begin + r.end - 1), r.row % rows_per_slice, r.row / rows_per_slice);
    }
    return parts;
}

std::string place(const Vec3& mm) { return fmt::format("[{:.4g}, {:.4g}, {:.4g}] mm", mm.x(), mm.y(), mm.z()); }

/// Volumes and places of the largest three.
std::string list_of(const VoxelGrid& grid, std::vector<Part> parts)
{
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.voxels > b.voxels; });
    std::string text;
    for (std::size_t k = 0; k < parts.size() && k < 3; ++k)
        text += fmt::format("{}{:.3g} ml at {}", k == 0 ? "" : "; ",
                            1e-3 * std::abs(grid.volume()) * static_cast<double>(parts[k].voxels),
                            place(grid.at(parts[k].sum / static_cast<double>(parts[k].voxels))));
    return parts.size() > 3 ? text + fmt::format("; and {} more", parts.size() - 3) : text;
}

/// Keeps the largest part.
std::vector<VoxelRun> take_vessel(const VoxelGrid& grid, const std::vector<VoxelRun>& runs, std::vector<std::string>& notes)
{
    const int n = grid.size[1];
    const std::vector<std::int32_t> part_of = parts_of(runs, n, Joined::Faces);
    const std::map<std::int32_t, Part> parts = measure(runs, part_of, n);
    const std::int32_t kept = std::max_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
                                  return a.second.voxels < b.second.voxels;
                              })->first;
    if (parts.size() == 1) return runs;
    const std::vector<std::int32_t> wide = parts_of(runs, n, Joined::Corners);
    std::vector<VoxelRun> vessel;
    std::vector<Part> away, touching;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        if (part_of[i] == kept) vessel.push_back(runs[i]);
        else if (part_of[i] == static_cast<std::int32_t>(i))
            (wide[i] == wide[static_cast<std::size_t>(kept)] ? touching : away).push_back(parts.at(part_of[i]));
    }
    const Part& largest = parts.at(kept);
    const std::string size = fmt::format("{:.3g} ml", 1e-3 * std::abs(grid.volume()) * static_cast<double>(largest.voxels));
    if (!away.empty())
        notes.push_back(fmt::format("The largest part, {}, is the vessel; {} not joined to it {} left out: {}.", size,
                                    count_of(away.size(), "part", "parts"), away.size() == 1 ? "was" : "were",
                                    list_of(grid, away)));
    if (!touching.empty())
        notes.push_back(
            fmt::format("{} only touch{} the vessel ({}) at edges or corners of voxels and {} left out: {}. If it belongs to "
                        "the vessel, join it by a voxel in the label map.",
                        count_of(touching.size(), "part", "parts"), touching.size() == 1 ? "es" : "", size,
                        touching.size() == 1 ? "was" : "were", list_of(grid, touching)));
    return vessel;
}

LumenVoxels box_of(const std::vector<VoxelRun>& runs, int rows_per_slice)
{
    std::array<int, 3> low = {runs[0].begin, runs[0].row % rows_per_slice, runs[0].row / rows_per_slice}, high = low;
    for (const VoxelRun& r : runs) {
        const int y = r.row % rows_per_slice, z = r.row / rows_per_slice;
        low = {std::min(low[0], r.begin), std::min(low[1], y), std::min(low[2], z)};
        high = {std::max(high[0], r.end - 1), std::max(high[1], y), std::max(high[2], z)};
    }
    LumenVoxels box;
    std::size_t count = 1;
    for (std::size_t a = 0; a < 3; ++a) {
        box.low[a] = low[a] - 1;
        box.size[a] = high[a] - low[a] + 3;
        count *= static_cast<std::size_t>(box.size[a]);
    }
    box.flags.assign(count, 0);
    return box;
}

/// What is closed off within the vessel, unless it is more than a hundredth of it: the label of a wall has its lumen there.
void fill_cavities(const VoxelGrid& grid, LumenVoxels& box, std::int64_t voxels)
{
    std::vector<VoxelRun> gaps;
    const std::int32_t rows = box.size[1] * box.size[2];
    for (std::int32_t row = 0; row < rows; ++row) {
        const std::uint8_t* at = box.flags.data() + static_cast<std::ptrdiff_t>(row) * box.size[0];
        for (int x = 0; x < box.size[0];) {
            const int begin = x;
            while (x < box.size[0] && at[x] == at[begin]) ++x;
            if (!(at[begin] & LumenVoxels::inside)) gaps.push_back({row, begin, x, 0});
        }
    }
    const std::vector<std::int32_t> part_of = parts_of(gaps, box.size[1], Joined::Corners);
    const std::map<std::int32_t, Part> parts = measure(gaps, part_of, box.size[1]);
    const auto is_small = [&](const Part& part) { return part.voxels <= voxels / 100; };
    std::vector<Part> filled, kept;
    for (auto [first, part] : parts) {
        if (first == 0) continue;  // the first one is the margin's
        part.sum += static_cast<double>(part.voxels) * Vec3(box.low[0], box.low[1], box.low[2]);
        (is_small(part) ? filled : kept).push_back(part);
    }
    for (std::size_t i = 0; !filled.empty() && i < gaps.size(); ++i) {
        if (part_of[i] == 0 || !is_small(parts.at(part_of[i]))) continue;
        std::uint8_t* at = box.flags.data() + static_cast<std::ptrdiff_t>(gaps[i].row) * box.size[0];
        std::fill(at + gaps[i].begin, at + gaps[i].end, LumenVoxels::inside);
    }
    if (!filled.empty())
        box.notes.push_back(fmt::format("{} within the label {} filled: {}.", count_of(filled.size(), "cavity", "cavities"),
                                        filled.size() == 1 ? "was" : "were", list_of(grid, filled)));
    if (!kept.empty())
        box.notes.push_back(fmt::format("{} within the label {} left as {}: {}. The label should be the lumen, not its wall.",
                                        count_of(kept.size(), "cavity", "cavities"), kept.size() == 1 ? "was" : "were",
                                        kept.size() == 1 ? "it is" : "they are", list_of(grid, kept)));
}

/// Looks for ends. Voxels whose next one along an axis is outside the lumen, and which hang together in their slice, are a cap.
/// On the image's border it is an opening. Elsewhere it is one where the map ends flat: two radii deep, and at least four
/// slices, the section through the lumen keeps the cap's area within a quarter. The last slice of a round end has at most 64 %
/// of the section from 2.5 voxels' radius on; a flank of such a lumen has no lumen four slices deeper, or a wider one.
class Ends {
public:
    Ends(const VoxelGrid& grid, LumenVoxels& box) : grid_(grid), box_(box), stride_(box.strides()) {}

    void open()
    {
        for (int axis = 0; axis < 3; ++axis)
            for (const bool high : {false, true}) open_along(axis, high);
        const auto say = [&](const std::vector<std::string>& places, const char* what) {
            if (places.empty()) return;
            std::string text = fmt::format("{} {}: ", what, places.size());
            for (std::size_t k = 0; k < places.size() && k < 12; ++k) text += (k == 0 ? "" : "; ") + places[k];
            box_.notes.push_back(text + (places.size() > 12 ? fmt::format("; and {} more.", places.size() - 12) : "."));
        };
        say(border_, "Openings where the lumen leaves the image,");
        say(flat_, "Openings where the label ends flat (caps were cut out),");
    }

private:
    [[nodiscard]] bool is_inside(std::ptrdiff_t v) const { return box_.flags[static_cast<std::size_t>(v)] & LumenVoxels::inside; }
    [[nodiscard]] int index(std::ptrdiff_t v, int axis) const
    {
        return static_cast<int>(v / stride_[static_cast<std::size_t>(axis)] % box_.size[static_cast<std::size_t>(axis)]);
    }

    /// Voxels that hang together in a slice and that `take` takes, once each; more than `most` end the search.
    template <class Take>
    void flood(std::vector<std::ptrdiff_t>& region, int axis, std::size_t most, const Take& take) const
    {
        for (std::size_t k = 0; k < region.size() && region.size() <= most; ++k)
            for (int a = 0; a < 3; ++a)
                for (const int sign : {-1, 1})
                    if (const std::ptrdiff_t next = region[k] + sign * stride_[static_cast<std::size_t>(a)];
                        a != axis && take(next))
                        region.push_back(next);
    }

    void open_along(int axis, bool high)
    {
        const std::size_t a = static_cast<std::size_t>(axis);
        const std::ptrdiff_t out = high ? stride_[a] : -stride_[a];
        std::vector<std::ptrdiff_t> seen, region;
        std::vector<std::vector<std::ptrdiff_t>> caps;
        const auto take = [&](std::ptrdiff_t v) {
            if (is_inside(v + out) || !mark(v)) return false;
            seen.push_back(v);
            return true;
        };
        const auto is_border = [&](std::ptrdiff_t v) { return box_.low[a] + index(v, axis) == (high ? grid_.size[a] - 1 : 0); };
        const auto last = static_cast<std::ptrdiff_t>(box_.flags.size()) - stride_[2];
        for (std::ptrdiff_t v = stride_[2]; v < last; ++v) {
            if (!is_inside(v) || !take(v)) continue;
            region.assign(1, v);
            flood(region, axis, box_.flags.size(), take);
            if (region.size() >= least || is_border(v)) caps.push_back(region);
        }
        unmark(seen);
        for (const std::vector<std::ptrdiff_t>& cap : caps) {
            const bool border = is_border(cap[0]);
            if (!border && !is_flat(cap, axis, -out)) continue;
            for (const std::ptrdiff_t v : cap) box_.flags[static_cast<std::size_t>(v)] |= LumenVoxels::open_face(axis, high);
            (border ? border_ : flat_).push_back(describe(cap, axis));
        }
    }

    /// @return false: it was marked, or is not of the lumen
    bool mark(std::ptrdiff_t v)
    {
        std::uint8_t& flags = box_.flags[static_cast<std::size_t>(v)];
        if (!(flags & LumenVoxels::inside) || flags & LumenVoxels::seen) return false;
        flags |= LumenVoxels::seen;
        return true;
    }
    void unmark(const std::vector<std::ptrdiff_t>& voxels)
    {
        for (const std::ptrdiff_t v : voxels)
            box_.flags[static_cast<std::size_t>(v)] &= static_cast<std::uint8_t>(~LumenVoxels::seen);
    }

    [[nodiscard]] double radius(const std::vector<std::ptrdiff_t>& region, int axis) const
    {
        const Vec3 across = grid_.step.col((axis + 1) % 3).cross(grid_.step.col((axis + 2) % 3));
        return std::sqrt(static_cast<double>(region.size()) * across.norm() / std::numbers::pi);
    }

    [[nodiscard]] bool is_flat(const std::vector<std::ptrdiff_t>& cap, int axis, std::ptrdiff_t in)
    {
        const std::size_t a = static_cast<std::size_t>(axis);
        const int deep = std::max(4, static_cast<int>(std::lround(2 * radius(cap, axis) / grid_.spacing()[a])));
        if ((in < 0 ? index(cap[0], axis) : box_.size[a] - 1 - index(cap[0], axis)) < deep) return false;
        std::vector<std::ptrdiff_t> section = cap, next;
        const std::size_t most = cap.size() * 5 / 4;
        for (int depth = 1; depth <= deep; ++depth) {
            next.clear();
            const auto take = [&](std::ptrdiff_t v) { return mark(v); };
            for (const std::ptrdiff_t v : section)
                if (take(v + in)) next.push_back(v + in);
            flood(next, axis, most, take);
            unmark(next);
            if (next.size() > most || next.size() < cap.size() * 4 / 5) return false;
            section.swap(next);
        }
        return true;
    }

    [[nodiscard]] std::string describe(const std::vector<std::ptrdiff_t>& region, int axis) const
    {
        Vec3 sum = Vec3::Zero();
        for (const std::ptrdiff_t v : region)
            sum += Vec3(box_.low[0] + index(v, 0), box_.low[1] + index(v, 1), box_.low[2] + index(v, 2));
        return fmt::format("{}, radius {:.3g} mm", place(grid_.at(sum / static_cast<double>(region.size()))),
                           radius(region, axis));
    }

    static constexpr std::size_t least = 12;  // voxels of a flat end: below two of radius none can be told from a round one
    const VoxelGrid& grid_;
    LumenVoxels& box_;
    std::array<std::ptrdiff_t, 3> stride_;
    std::vector<std::string> border_, flat_;
};

}  // namespace

LumenVoxels lumen_of(const VoxelGrid& grid, const std::vector<VoxelRun>& runs)
{
    std::vector<std::string> notes;
    const std::vector<VoxelRun> vessel = take_vessel(grid, runs, notes);
    LumenVoxels box = box_of(vessel, grid.size[1]);
    box.notes = std::move(notes);
    std::int64_t voxels = 0;
    for (const VoxelRun& r : vessel) {
        const std::ptrdiff_t y = r.row % grid.size[1] - box.low[1], z = r.row / grid.size[1] - box.low[2];
        std::uint8_t* at = box.flags.data() + (z * box.size[1] + y) * box.size[0] - box.low[0];
        std::fill(at + r.begin, at + r.end, LumenVoxels::inside);
        voxels += r.end - r.begin;
    }
    fill_cavities(grid, box, voxels);
    Ends(grid, box).open();
    return box;
}

}  // namespace seldinger

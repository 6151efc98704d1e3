// Centrelines from files: which array is the radius, lines to a graph, the graph to a tree.
#include "io/centreline_file.h"

#include "core/error.h"
#include "core/file_io.h"
#include "core/printable.h"
#include "io/mesh_file.h"
#include "io/text_words.h"
#include "io/vtp_read.h"
#include "vessel/mesh_limits.h"
#include "vessel/work_budget.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace seldinger {
namespace {

[[noreturn]] void fail_centreline(const std::string& name, const std::string& message)
{
    throw Error(ErrorKind::BadFile, name + ": " + message);
}

struct RadiusArray {
    const std::vector<double>* values = nullptr;
    double factor = 1;
};

/// VMTK and SimVascular write MaximumInscribedSphereRadius, 3D Slicer Radius, others other names.
RadiusArray radius_of(const PolyData& data, const std::string& name)
{
    std::string known;
    std::vector<std::string> similar;
    const auto find = [&](std::string_view word) -> const std::vector<double>* {
        for (const auto& [array, content] : data.point_data)
            if (same_word(array, word) && content.values.size() == data.points.size()) return &content.values;
        return nullptr;
    };
    for (const auto& [array, content] : data.point_data) {
        known += (known.empty() ? "" : ", ") + excerpt(array);
        if (has_word(array, "radius") && content.values.size() == data.points.size()) similar.push_back(array);
    }
    for (const char* word : {"maximuminscribedsphereradius", "radius"})
        if (const auto* values = find(word)) return {values, 1};
    if (similar.size() == 1) return {&data.point_data.at(similar[0]).values, 1};
    if (const auto* values = similar.empty() ? find("diameter") : nullptr) return {values, 0.5};
    fail_centreline(
        name,
        fmt::format("got point arrays {}; expected the lumen's radius at each point, in an array MaximumInscribedSphereRadius or "
                    "Radius. Fix: rename the array that holds it{}",
                    known.empty() ? "(none)" : known,
                    similar.empty() ? "" : fmt::format(" ({} have \"radius\" in their names)", similar.size())));
}

/// The name of each line: strings of the cells called Name or Label, else the groups of VMTK's branch extractor, whose blanked
/// lines lie across forks. -1: none; an empty list: no line has one.
std::vector<int> names_of_lines(const PolyData& data, std::vector<std::string>& names)
{
    constexpr std::size_t longest = 64;
    const std::size_t lines = data.lines.offsets.size(), before = data.verts.offsets.size();
    std::vector<std::string> text(lines);
    const auto is_there = [&](std::size_t size) { return size >= before + lines; };
    for (const auto& [array, list] : data.cell_names)
        if ((has_word(array, "name") || has_word(array, "label")) && is_there(list.size()))
            for (std::size_t k = 0; k < lines; ++k) text[k] = printable(list[before + k].substr(0, longest));
    const auto numbers = [&](std::string_view word) -> const std::vector<double>* {
        for (const auto& [array, list] : data.cell_data)
            if (same_word(array, word) && is_there(list.values.size())) return &list.values;
        return nullptr;
    };
    const auto *groups = numbers("groupids"), *blanking = numbers("blanking");
    for (std::size_t k = 0; groups && k < lines; ++k)
        if (text[k].empty() && !(blanking && (*blanking)[before + k] != 0))
            text[k] = fmt::format("group {}", (*groups)[before + k]);
    std::vector<int> name_of;
    std::map<std::string, int> place_of;
    for (const std::string& name : text) {
        if (name.empty()) {
            name_of.push_back(-1);
            continue;
        }
        const auto [known, fresh] = place_of.try_emplace(name, static_cast<int>(names.size()));
        name_of.push_back(known->second);
        if (fresh) names.push_back(name);
    }
    if (names.empty()) name_of.clear();
    return name_of;
}

/// Points and the links between them, as the lines have them; which way a line runs is forgotten but for its first point.
class LineGraph {
public:
    LineGraph(const PolyData& data, double scale, const std::string& name) : name_(name), most_(most_coordinate / scale)
    {
        const RadiusArray radius = radius_of(data, name);
        const std::vector<int> name_of = names_of_lines(data, names_);
        std::map<std::array<double, 3>, int> known;  // coordinates -> point of the graph
        std::int64_t begin = 0;
        std::size_t line = 0;
        for (const std::int64_t end : data.lines.offsets) {
            int previous = -1;
            const int own_name = name_of.empty() ? -1 : name_of[line++];
            for (; begin < end; ++begin) {
                const auto i = static_cast<std::size_t>(data.lines.connectivity[static_cast<std::size_t>(begin)]);
                const int at = add(i, data.points[i], radius.factor * (*radius.values)[i], scale, known);
                if (name_of_[index(at)] < 0) name_of_[index(at)] = own_name;
                if (previous >= 0 && previous != at) link(previous, at);
                previous = at;
            }
        }
        if (points_.empty())
            fail_centreline(name,
                            "got no line; expected the polylines of a centreline. Fix: export its lines (VMTK: Centerlines, "
                            "ParaView: Save Data)");  // lines of no points are none
    }

    Centreline tree()
    {
        int pieces = 0;
        std::vector<int> piece = label_pieces(pieces);
        if (pieces > 1) {
            join_pieces(piece, pieces);
            piece = label_pieces(pieces);
        }
        Centreline line;
        line.points = points_, line.radius = radius_;
        if (!names_.empty()) line.names = names_, line.name_of = name_of_;
        line.parent.assign(points_.size(), -1);
        std::vector<bool> seen(points_.size(), false);
        for (const int root : roots_of(piece, pieces)) spread(root, line.parent, seen);
        return behind_parents(std::move(line));
    }

private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    [[nodiscard]] int count() const { return static_cast<int>(points_.size()); }

    int add(std::size_t i, const std::array<double, 3>& at, double r, double scale, std::map<std::array<double, 3>, int>& known)
    {
        if (!(r > 0 && r <= most_) || !std::all_of(at.begin(), at.end(), [&](double x) { return std::abs(x) <= most_; }))
            fail_centreline(name_, fmt::format("point {}: got [{:.6g}, {:.6g}, {:.6g}] with radius {:.6g}; expected coordinates "
                                               "within {:.0f} m and a radius above 0. Fix: check the "
                                               "units, or export the centreline again",
                                               i, at[0], at[1], at[2], r, most_coordinate));
        const auto [it, fresh] = known.try_emplace(at, count());
        if (fresh) {
            points_.push_back(scale * Vec3(at[0], at[1], at[2]));
            radius_.push_back(scale * r);
            name_of_.push_back(-1);
            near_.emplace_back();
        }
        return it->second;
    }
    void link(int a, int b)
    {
        if (std::find(near_[index(a)].begin(), near_[index(a)].end(), b) != near_[index(a)].end()) return;
        work_.spend(static_cast<double>(near_[index(a)].size() + near_[index(b)].size()));
        near_[index(a)].push_back(b);
        near_[index(b)].push_back(a);
    }

    /// All that leads away from it leads one way: one neighbour, or copies of one trunk that several lines share but for
    /// rounding.
    [[nodiscard]] bool is_end(int i) const
    {
        const std::vector<int>& near = near_[index(i)];
        work_.spend(static_cast<double>(near.size() * near.size()));
        for (const int a : near)
            for (const int b : near)
                if ((points_[index(a)] - points_[index(i)]).dot(points_[index(b)] - points_[index(i)]) <= 0) return false;
        return !near.empty();
    }

    /// Which piece each point belongs to, numbered in the order of their first points.
    [[nodiscard]] std::vector<int> label_pieces(int& pieces) const
    {
        std::vector<int> piece(points_.size(), -1), stack;
        pieces = 0;
        for (int i = 0; i < count(); ++i) {
            if (piece[index(i)] >= 0) continue;
            piece[index(i)] = pieces;
            for (stack = {i}; !stack.empty();) {
                const int at = stack.back();
                stack.pop_back();
                for (const int next : near_[index(at)])
                    if (piece[index(next)] < 0) piece[index(next)] = pieces, stack.push_back(next);
            }
            ++pieces;
        }
        return piece;
    }

    /// An end in the lumen of another piece continues it: lines that begin a step off the trunk, or beside each other at one
    /// inlet.
    void join_pieces(const std::vector<int>& piece, int pieces)
    {
        std::vector<int> joined(index(pieces));
        std::iota(joined.begin(), joined.end(), 0);
        const auto top = [&](int i) {
            int p = piece[index(i)];
            while (joined[index(p)] != p) p = joined[index(p)];
            return p;
        };
        for (int i = 0; i < count(); ++i) {
            if (!is_end(i)) continue;
            int best = -1;
            double distance = 0;
            work_.spend(static_cast<double>(points_.size()));
            for (int k = 0; k < count(); ++k) {
                const double d = (points_[index(k)] - points_[index(i)]).norm();
                if (d >= radius_[index(k)] || (best >= 0 && d >= distance) || top(k) == top(i)) continue;
                best = k, distance = d;
            }
            if (best < 0) continue;
            joined[index(top(i))] = top(best);
            link(i, best);
        }
    }

    /// One of each piece: where the file begins it if that is an end, else its widest end; a ring has none and begins anywhere.
    [[nodiscard]] std::vector<int> roots_of(const std::vector<int>& piece, int pieces) const
    {
        std::vector<int> first(index(pieces), -1), root(index(pieces), -1);
        for (int i = 0; i < count(); ++i) {
            int &begin = first[index(piece[index(i)])], &best = root[index(piece[index(i)])];
            if (begin < 0) begin = i;
            if (is_end(i) && (best < 0 || (best != begin && radius_[index(i)] > radius_[index(best)]))) best = i;
        }
        for (std::size_t p = 0; p < root.size(); ++p)
            if (root[p] < 0) root[p] = first[p];
        return root;
    }

    /// Parents of all that hangs together with `root`, nearest first.
    void spread(int root, std::vector<int>& parent, std::vector<bool>& seen) const
    {
        std::vector<int> order = {root};
        seen[index(root)] = true;
        for (std::size_t k = 0; k < order.size(); ++k)
            for (const int next : near_[index(order[k])])
                if (!seen[index(next)]) {
                    seen[index(next)] = true;
                    parent[index(next)] = order[k];
                    order.push_back(next);
                }
    }

    /// The file's order where every point stands behind its parent there, else branch by branch.
    static Centreline behind_parents(Centreline line)
    {
        bool sorted = true;
        for (std::size_t i = 0; i < line.parent.size(); ++i) sorted &= line.parent[i] < static_cast<int>(i);
        if (sorted) return line;
        std::vector<std::vector<int>> children(line.points.size());
        std::vector<int> stack, place(line.points.size(), -1);
        for (int i = static_cast<int>(line.points.size()) - 1; i >= 0; --i)
            (line.parent[index(i)] < 0 ? stack : children[index(line.parent[index(i)])]).push_back(i);
        Centreline result;
        result.names = line.names;
        while (!stack.empty()) {
            const int at = stack.back(), up = line.parent[index(at)];
            stack.pop_back();
            place[index(at)] = static_cast<int>(result.points.size());
            result.points.push_back(line.points[index(at)]);
            result.radius.push_back(line.radius[index(at)]);
            result.parent.push_back(up < 0 ? -1 : place[index(up)]);
            if (!line.names.empty()) result.name_of.push_back(line.name_of[index(at)]);
            for (const int child : children[index(at)]) stack.push_back(child);
        }
        return result;
    }

    const std::string& name_;
    double most_;
    std::vector<Vec3> points_;
    std::vector<double> radius_;
    std::vector<std::string> names_;
    std::vector<int> name_of_;
    std::vector<std::vector<int>> near_;
    mutable WorkBudget work_{"joining the lines of a centreline", 1e9};  // a hundred lines of a thousand points take 1e7
};

}  // namespace

Centreline read_centreline(const std::filesystem::path& path, const std::string& units)
{
    return parse_centreline(read_file(path), path.string(), units);
}

Centreline parse_centreline(const std::string& bytes, const std::string& name, const std::string& units)
{
    const double scale = metres_per_unit(units);
    const PolyData data =
        bytes.starts_with("# vtk DataFile") ? parse_legacy_vtk(bytes, name, PolyParts::All) : parse_poly_data(bytes, name);
    try {
        return LineGraph(data, scale, name).tree();
    } catch (const Error& error) {
        const std::string text = error.what();
        if (text.starts_with(name)) throw;
        fail_centreline(name, text);
    }
}

}  // namespace seldinger

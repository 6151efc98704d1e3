// Numbers the ends of a centreline, gives every stretch between forks its path, and says in which one a point lies.
#include "vessel/branches.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace seldinger {
namespace {

constexpr double narrower = 0.75;  // a trunk goes on past a branch whose width is less than this share of its own
// an inlet within so many lumen radii of path from an end is that end's: a closed end's lies one radius in
constexpr double at_end = 2.5;

std::vector<int> child_counts(const Centreline& line)
{
    std::vector<int> children(line.points.size());
    for (const int parent : line.parent)
        if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
    return children;
}

/// How far past the point `nearest` of its stretch `own` the foot of p lies on the two edges that meet there, < 0 before it [m].
double past_point(const Centreline& line, const std::vector<int>& own, int nearest, const Vec3& p)
{
    const auto at = [&](int i) { return line.points[static_cast<std::size_t>(i)]; };
    const Vec3 here = at(nearest);
    double past = 0, closest = (p - here).norm();
    const auto try_edge = [&](int to, double sign) {
        const Vec3 edge = at(to) - here;
        const double length = edge.norm();
        if (length == 0) return;
        const double along = std::clamp((p - here).dot(edge) / length, 0.0, length),
                     away = (p - here - (along / length) * edge).norm();
        if (away < closest) closest = away, past = sign * along;
    };
    if (line.parent[static_cast<std::size_t>(nearest)] >= 0) try_edge(line.parent[static_cast<std::size_t>(nearest)], -1);
    const auto here_at = std::find(own.begin(), own.end(), nearest);
    if (here_at != own.end() && here_at + 1 != own.end()) try_edge(*(here_at + 1), 1);
    return past;
}

std::string sub(const std::string& path, int k) { return path.empty() ? fmt::format("{}", k) : fmt::format("{}.{}", path, k); }

}  // namespace

std::string Stretch::words() const
{
    const std::string named = name.empty() ? "" : fmt::format(" ({})", name);
    if (path == "0") return "the trunk" + named;
    if (path.ends_with('+')) {
        const std::string past = path.substr(0, path.size() - 1);
        const std::size_t dot = past.rfind('.');
        return fmt::format("{} past branch {}{}",
                           dot == std::string::npos ? "the trunk" : fmt::format("branch \"{}\"", past.substr(0, dot)),
                           dot == std::string::npos ? past : fmt::format("\"{}\"", past), named);
    }
    if (path.empty() || path == fmt::format("{}", number)) return fmt::format("branch {}{}", number, named);
    return fmt::format("branch \"{}\"{}{}", path, number > 0 ? fmt::format(", end {}", number) : "", named);
}

int end_at(const Centreline& line, const Vec3& inlet)
{
    const int nearest = line.nearest(inlet);
    if (nearest < 0) return -1;
    const double reach = at_end * line.radius[static_cast<std::size_t>(nearest)];
    const auto step = [&](int a, int b) {
        return (line.points[static_cast<std::size_t>(a)] - line.points[static_cast<std::size_t>(b)]).norm();
    };
    double up = 0, down = 0;
    int root = nearest, leaf = nearest;
    for (int next; (next = line.parent[static_cast<std::size_t>(root)]) >= 0 && up <= reach; root = next) up += step(root, next);
    std::vector<std::vector<int>> children(line.points.size());
    for (int i = 0; i < static_cast<int>(line.points.size()); ++i)
        if (line.parent[static_cast<std::size_t>(i)] >= 0)
            children[static_cast<std::size_t>(line.parent[static_cast<std::size_t>(i)])].push_back(i);
    for (; children[static_cast<std::size_t>(leaf)].size() == 1 && down <= reach;
         leaf = children[static_cast<std::size_t>(leaf)].front())
        down += step(leaf, children[static_cast<std::size_t>(leaf)].front());
    const bool is_leaf = children[static_cast<std::size_t>(leaf)].empty() && down <= reach;
    const bool is_root = line.parent[static_cast<std::size_t>(root)] < 0 && up <= reach;
    return is_leaf && (!is_root || down < up) ? leaf : -1;
}

Branches::Branches(Centreline line, int root) : line_(std::move(line))
{
    if (line_.empty()) return;
    if (root >= 0) line_.set_root(root);
    from_root_ = line_.lengths();
    cut_at_forks();
    number_ends();
    find_mouths();
    take_names();
    name_paths();
}

void Branches::cut_at_forks()
{
    const std::vector<int> children = child_counts(line_);
    const auto parent = [&](int i) { return line_.parent[static_cast<std::size_t>(i)]; };
    const auto begins = [&](int i) { return parent(i) < 0 || children[static_cast<std::size_t>(parent(i))] > 1; };
    std::vector<int> stretch_of(line_.points.size(), -1), climb;
    for (int i = 0; i < static_cast<int>(line_.points.size()); ++i) {
        for (int at = i; at >= 0 && stretch_of[static_cast<std::size_t>(at)] < 0; at = parent(at)) climb.push_back(at);
        for (; !climb.empty(); climb.pop_back()) {
            const int at = climb.back(), up = parent(at);
            int& mine = stretch_of[static_cast<std::size_t>(at)];
            mine = begins(at) ? static_cast<int>(stretches_.size()) : stretch_of[static_cast<std::size_t>(up)];
            if (begins(at)) stretches_.emplace_back().from = up < 0 ? -1 : stretch_of[static_cast<std::size_t>(up)];
            stretches_[static_cast<std::size_t>(mine)].points.push_back(at);
        }
    }
    leaving_.resize(stretches_.size());
    for (int s = 0; s < static_cast<int>(stretches_.size()); ++s)
        if (stretch(s).from >= 0) leaving_[static_cast<std::size_t>(stretch(s).from)].push_back(s);
}

void Branches::number_ends()
{
    const int trunk_end = line_.main_path().back();
    struct End {
        double leaves_at;
        int leaf, stretch;
    };
    std::vector<End> ends;
    for (int s = 0; s < static_cast<int>(stretches_.size()); ++s) {
        if (!leaving_[static_cast<std::size_t>(s)].empty()) continue;
        const int leaf = stretch(s).points.back();
        ends.push_back(
            {leaf == trunk_end ? std::numeric_limits<double>::infinity() : from_root(stretch(s).points.front()), leaf, s});
    }
    std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) {
        return a.leaves_at != b.leaves_at ? a.leaves_at < b.leaves_at : a.leaf < b.leaf;
    });
    for (const End& end : ends) {
        numbered_.push_back(end.stretch);
        stretches_[static_cast<std::size_t>(end.stretch)].number = count();
    }
}

void Branches::find_mouths()
{
    stretch_of_.assign(line_.points.size(), -1);
    for (int s = 0; s < static_cast<int>(stretches_.size()); ++s) {  // the one that a stretch leaves stands before it
        Stretch& own = stretches_[static_cast<std::size_t>(s)];
        const int fork = line_.parent[static_cast<std::size_t>(own.points.front())];
        const auto is_out = [&](int i) {
            const auto f = static_cast<std::size_t>(fork);
            return fork < 0 || (line_.points[static_cast<std::size_t>(i)] - line_.points[f]).norm() > line_.radius[f];
        };
        // one that ends within the ball about its fork has its mouth at its end
        const auto mouth = std::min(std::find_if(own.points.begin(), own.points.end(), is_out), own.points.end() - 1);
        own.mouth = from_root(*mouth);
        const int before = fork < 0 ? s : stretch_of_[static_cast<std::size_t>(fork)];
        std::for_each(own.points.begin(), mouth, [&](int i) { stretch_of_[static_cast<std::size_t>(i)] = before; });
        std::for_each(mouth, own.points.end(), [&](int i) { stretch_of_[static_cast<std::size_t>(i)] = s; });
    }
}

/// The name that most points of a stretch have.
void Branches::take_names()
{
    if (line_.names.empty()) return;
    std::vector<int> points_with(line_.names.size());
    for (Stretch& own : stretches_) {
        std::fill(points_with.begin(), points_with.end(), 0);
        for (const int i : own.points)
            if (const int name = line_.name_of[static_cast<std::size_t>(i)]; name >= 0)
                ++points_with[static_cast<std::size_t>(name)];
        const auto most = std::max_element(points_with.begin(), points_with.end());
        if (2 * *most > static_cast<int>(own.points.size()))
            own.name = line_.names[static_cast<std::size_t>(most - points_with.begin())];
    }
}

/// Median lumen radius of a stretch behind its mouth [m].
double Branches::width(int index) const
{
    std::vector<double> radii;
    for (const int i : stretch(index).points)
        if (from_root(i) >= stretch(index).mouth) radii.push_back(line_.radius[static_cast<std::size_t>(i)]);
    std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
    return radii[radii.size() / 2];
}

void Branches::name_paths()
{
    // how far the farthest end behind each stretch is, and the number of the first end there
    reach_.resize(stretches_.size());
    first_end_.assign(stretches_.size(), std::numeric_limits<int>::max());
    last_end_.assign(stretches_.size(), 0);
    for (std::size_t s = stretches_.size(); s-- > 0;) {  // the one that a stretch leaves stands before it
        reach_[s] = std::max(reach_[s], from_root(stretches_[s].points.back()));
        if (stretches_[s].number > 0) first_end_[s] = last_end_[s] = stretches_[s].number;
        if (stretches_[s].from < 0) continue;
        const auto up = static_cast<std::size_t>(stretches_[s].from);
        reach_[up] = std::max(reach_[up], reach_[s]), first_end_[up] = std::min(first_end_[up], first_end_[s]),
        last_end_[up] = std::max(last_end_[up], last_end_[s]);
    }
    // the trunk's piece first; of a centreline in pieces, the others are further branches of it
    int trunk = numbered_.back();
    while (stretch(trunk).from >= 0) trunk = stretch(trunk).from;
    int last = name_vessel(trunk, "", 0);
    for (int s = 0; s < static_cast<int>(stretches_.size()); ++s)
        if (stretch(s).from < 0 && s != trunk) name_vessel(s, sub("", ++last), 1);
}

/// @return how many branches leave it
int Branches::name_vessel(int index, const std::string& path, int level)
{
    constexpr int most_levels = 32;  // further branches have numbers only
    if (level > most_levels) return 0;
    const auto leaving = [&](int s) -> const std::vector<int>& { return leaving_[static_cast<std::size_t>(s)]; };
    stretches_[static_cast<std::size_t>(index)].path = !path.empty() ? path : leaving(index).empty() ? "1" : "0";
    int k = leaving(index).empty() && path.empty() ? 1 : 0;
    while (!leaving(index).empty()) {
        std::vector<int> next = leaving(index);
        std::stable_sort(next.begin(), next.end(), [&](int a, int b) {
            return first_end_[static_cast<std::size_t>(a)] < first_end_[static_cast<std::size_t>(b)];
        });
        const auto longest = std::max_element(next.begin(), next.end(), [&](int a, int b) {
            const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
            return reach_[i] != reach_[j] ? reach_[i] < reach_[j] : last_end_[i] < last_end_[j];
        });
        std::rotate(longest, longest + 1, next.end());
        const int ahead = next.back();
        bool goes_on = !leaving(ahead).empty();
        for (std::size_t n = 0; n + 1 < next.size(); ++n) {
            goes_on &= width(next[n]) < narrower * width(ahead);
            name_vessel(next[n], sub(path, ++k), level + 1);
        }
        if (goes_on) stretches_[static_cast<std::size_t>(ahead)].path = sub(path, k) + "+";
        else name_vessel(ahead, sub(path, ++k), level + 1);
        if (!goes_on) break;
        index = ahead;
    }
    return k;
}

int Branches::find(std::string_view text) const
{
    int best = -1;
    if (text.empty()) return -1;
    for (int s = 0; s < static_cast<int>(stretches_.size()); ++s) {
        if (stretch(s).path == text) return s;
        if (stretch(s).name == text && (best < 0 || stretch(s).mouth < stretch(best).mouth)) best = s;
    }
    return best;
}

Branches::Place Branches::locate(const Vec3& p) const
{
    if (stretches_.empty()) return {};
    const int nearest = line_.nearest(p);
    const int index = stretch_of_[static_cast<std::size_t>(nearest)];
    const Stretch& in = stretch(index);
    return {in.number, std::max(0.0, depth(index, nearest) + past_point(line_, in.points, nearest, p)), index};
}

}  // namespace seldinger

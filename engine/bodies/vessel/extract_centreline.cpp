// Paths through the medial graph, one branch after the other.
#include "vessel/extract_centreline.h"

#include "vessel/medial_graph.h"
#include "vessel/mesh_components.h"
#include "vessel/reroot.h"
#include "vessel/work_budget.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace seldinger {
namespace {

constexpr double kCover = 1.6;    // wall within this many radii of a path is served by it: lumens are not round
constexpr double kJoin = 0.5;     // a new path ends where it comes this many radii near an older one
constexpr double kBranch = 2.0;   // a branch is this many times longer than wide (in radii), counted from its parent's wall
constexpr double kSpacing = 0.5;  // distance of points in radii
constexpr double kFlat = 2.5;     // a lumen so many times wider than high is a sheet; an oval one has 2
constexpr double kSight = 8;      // how far a sheet's axis is looked for, in radii; and by three radii of the axis
constexpr double kAside = 0.87;   // cosine of 30 degrees: how far from straight back

struct Polyline {
    std::vector<Vec3> points;
    std::vector<double> radius;
};

class Extraction {
public:
    Extraction(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings, const LumenQuery& lumen)
        : mesh_(mesh),
          openings_(openings),
          lumen_(lumen),
          edges_(find_edges(mesh)),
          enclosure_(mesh, openings, lumen),
          graph_(build_medial_graph(mesh, edges_, openings, lumen, enclosure_)),
          work_("laying paths through its lumen", work_limit(5e8, 5e4, mesh.vertices.size()))  // patients: up to 1.5e8
    {
        for (const Vec3& v : mesh.vertices) box_.extend(v);
    }

    Centreline run()
    {
        if (graph_.ball_count() == 0) return {};
        list_samples();
        const int root = openings_.empty() ? an_end_of_closed() : ball_at(openings_[0]);
        paths_ = cheapest_paths(graph_, root);
        // a tip's radius runs to 0: never space points closer than a fraction of the typical radius
        std::vector<double> radii = graph_.radius;
        std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 10), radii.end());
        // Where many have no radius, a path has at most 10,000 points, and not many more than a coarse wall has vertices.
        const double share = std::max(1e-4, 0.05 / static_cast<double>(graph_.wall.size()));
        finest_ =
            std::max(0.25 * radii[radii.size() / 10], share * *std::max_element(paths_.length.begin(), paths_.length.end()));
        lay_paths();
        if (is_comb()) {
            leave_sheets_out_ = true;
            lay_paths();
        }
        if (openings_.empty()) reroot_at_widest_end(tree_, mesh_, lumen_, work_);
        reach_narrow_branches();
        return std::move(tree_);
    }
    /// Paths side by side in a flat lumen that are no part of the axis.
    [[nodiscard]] int left_out() const { return left_out_; }

    /// A place in each branch without a path.
    [[nodiscard]] std::vector<Vec3> unreached() const
    {
        std::vector<Vec3> places;
        for (const MissedTube& tube : missed_tubes()) places.push_back(graph_.wall[tube.farthest]);
        return places;
    }

private:
    struct MissedTube {
        std::size_t farthest;  // sample
        double radius;         // [m]
    };

    /// Pieces of wall without a path that are tubes: branches whose triangles are too coarse for a chain of overlapping balls. A
    /// tube of length L and area A has a radius of A/(2 pi L) and faces its own middle; creases, folds and flaps do not.
    [[nodiscard]] std::vector<MissedTube> missed_tubes() const
    {
        std::vector<std::vector<std::size_t>> near(graph_.wall.size());
        for (std::size_t k = 0; k < edges_.count(); ++k) {
            const std::int32_t h = edges_.uses(k)[0];
            const auto a = sample_at(half_edge_from(mesh_, h)), b = sample_at(half_edge_to(mesh_, h));
            if (a == b || !is_missed(a) || !is_missed(b)) continue;
            near[a].push_back(b), near[b].push_back(a);
        }
        struct Piece {
            Box3 box;
            std::size_t samples = 0, farthest = 0;
            double area = 0, moment = 0;              // of the triangles; of their directions about the origin
            Vec3 first = Vec3::Zero(), facing = Vec3::Zero();  // moment of the area; its direction
        };
        std::vector<Piece> pieces;
        std::vector<int> piece_of(graph_.wall.size(), -1);
        for (std::size_t seed = 0; seed < piece_of.size(); ++seed) {
            if (piece_of[seed] >= 0 || !is_missed(seed)) continue;
            Piece piece;
            piece.farthest = seed;
            std::vector<std::size_t> stack = {seed};
            piece_of[seed] = static_cast<int>(pieces.size());
            while (!stack.empty()) {
                const std::size_t i = stack.back();
                stack.pop_back();
                ++piece.samples;
                piece.box.extend(graph_.wall[i]);
                if (length_to(graph_.ball_of_sample[i]) > length_to(graph_.ball_of_sample[piece.farthest])) piece.farthest = i;
                for (const std::size_t j : near[i])
                    if (piece_of[j] < 0) piece_of[j] = static_cast<int>(pieces.size()), stack.push_back(j);
            }
            pieces.push_back(piece);
        }
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
            const auto& v = mesh_.triangles[t];
            const int k = piece_of[sample_at(v[0])];
            if (k < 0 || piece_of[sample_at(v[1])] != k || piece_of[sample_at(v[2])] != k) continue;
            const Triangle3 corners = triangle_of(mesh_, t);
            const Vec3 middle = (corners.a + corners.b + corners.c) / 3, area = 0.5 * double_area(corners);
            Piece& piece = pieces[static_cast<std::size_t>(k)];
            piece.area += area.norm(), piece.moment += middle.dot(area);
            piece.first += area.norm() * middle, piece.facing += area;
        }
        std::vector<MissedTube> tubes;
        for (const Piece& piece : pieces) {
            if (piece.samples < kFewest || !(piece.area > 0)) continue;
            const double length = piece.box.diagonal().norm(), radius = piece.area / (2 * std::numbers::pi * length);
            const double inward = piece.first.dot(piece.facing) / piece.area - piece.moment;
            const double round = inward / (piece.area * radius);
            const bool all_round = piece.facing.norm() < kOneSided * piece.area;
            if (length > kLong * radius && all_round && round > least_round && round < most_round)
                tubes.push_back({piece.farthest, radius});
        }
        return tubes;
    }

    /// A piece may hold several branches, and each path serves one.
    void reach_narrow_branches()
    {
        for (std::size_t before = 0; before != tree_.points.size() && !work_.is_nearly_spent();) {
            before = tree_.points.size();
            work_.spend(static_cast<double>(10 * edges_.count()));
            for (const MissedTube& tube : missed_tubes())
                if (!served_[tube.farthest] && !work_.is_nearly_spent())
                    add_branch(graph_.ball_of_sample[tube.farthest], nullptr, tube.radius);
        }
    }

    void lay_paths()
    {
        tree_ = {};
        branches_ = in_sheet_ = 0;
        served_.assign(graph_.wall.size(), false);
        if (openings_.empty()) {
            add_branch(farthest_unserved(), nullptr);
        } else {
            start_at_ = openings_[0].centre;
            // the farthest opening first: its path is the trunk
            std::vector<const BoundaryLoop*> ends;
            for (std::size_t k = 1; k < openings_.size(); ++k)
                if (length_to(ball_at(openings_[k])) >= 0) ends.push_back(&openings_[k]);  // of another part no path leads to it
            std::stable_sort(ends.begin(), ends.end(), [&](const BoundaryLoop* a, const BoundaryLoop* b) {
                return length_to(ball_at(*a)) > length_to(ball_at(*b));
            });
            for (const BoundaryLoop* end : ends) add_branch(ball_at(*end), end);
            if (ends.empty()) add_branch(farthest_unserved(), nullptr);
        }
        // each round serves at least its own sample, so this ends; vessels have tens of branches
        for (int ball = farthest_unserved(); ball >= 0 && !is_comb(); ball = farthest_unserved()) add_branch(ball, nullptr);
    }
    /// Most of the latest branches lie side by side in a flat lumen.
    [[nodiscard]] bool is_comb() const { return !leave_sheets_out_ && in_sheet_ >= kComb && 2 * in_sheet_ > branches_ - kComb; }

    // branches with closed ends from which on sheets are looked for, and paths in them that make a comb
    static constexpr int kComb = 12;
    static constexpr std::size_t kFewest = 8;
    static constexpr int kLoose = 8;  // balls on the path to an opening: the lumen there is narrow for its triangles
    static constexpr double kLong = 8;     // in radii: a branch of four diameters
    static constexpr double least_round = 0.3, most_round = 3;  // a round tube has 1, a fold 0, a strip round a wide lumen more
    // mean direction of its triangles: a tube's cancel; those of a corner (the rim of a cap) do not
    static constexpr double kOneSided = 0.3;
    [[nodiscard]] std::size_t sample_at(std::int32_t vertex) const
    {
        return static_cast<std::size_t>(graph_.sample_of_vertex[static_cast<std::size_t>(vertex)]);
    }
    /// Without a path, in the part of the surface that has the tree.
    [[nodiscard]] bool is_missed(std::size_t sample) const
    {
        return !served_[sample] && length_to(graph_.ball_of_sample[sample]) >= 0;
    }
    [[nodiscard]] double length_to(int ball) const { return paths_.length[static_cast<std::size_t>(ball)]; }

    [[nodiscard]] int farthest(const MedialPaths& paths) const
    {
        int best = 0;
        for (std::size_t i = 1; i < graph_.ball_count(); ++i)
            if (graph_.is_lumen[i] && paths.length[i] > paths.length[static_cast<std::size_t>(best)]) best = static_cast<int>(i);
        return best;
    }
    /// Ball of the farthest wall sample that no path serves, -1: all are served.
    [[nodiscard]] int farthest_unserved() const
    {
        work_.spend(static_cast<double>(served_.size()));
        int best = -1;
        double length = 0;
        for (std::size_t i = 0; i < served_.size(); ++i) {
            const int ball = graph_.ball_of_sample[i];
            if (!served_[i] && graph_.is_lumen[static_cast<std::size_t>(ball)] && length_to(ball) > length) {
                length = length_to(ball);
                best = ball;
            }
        }
        return best;
    }
    /// Ball of the rim sample whose centre is nearest to the opening's.
    [[nodiscard]] int ball_at(const BoundaryLoop& loop) const
    {
        int best = -1;
        double distance = std::numeric_limits<double>::infinity();
        for (const std::int32_t v : loop.vertices) {
            const int ball =
                graph_.ball_of_sample[static_cast<std::size_t>(graph_.sample_of_vertex[static_cast<std::size_t>(v)])];
            const double d = (graph_.centre[static_cast<std::size_t>(ball)] - loop.centre).norm();
            if (d < distance) {
                distance = d;
                best = ball;
            }
        }
        return best;
    }
    /// Any end of the largest part will do until the tree is known (see reroot_at_widest_end).
    [[nodiscard]] int an_end_of_closed() const
    {
        int widest = 0;  // ball 0 is the widest of all
        const std::vector<bool> main = vertices_of_largest(mesh_, label_components(mesh_, edges_));
        if (!main.empty()) widest = static_cast<int>(graph_.ball_count());
        for (std::size_t v = 0; v < main.size(); ++v) {
            if (!main[v] || graph_.sample_of_vertex[v] < 0) continue;
            const int ball = graph_.ball_of_sample[static_cast<std::size_t>(graph_.sample_of_vertex[v])];
            if (graph_.is_lumen[static_cast<std::size_t>(ball)]) widest = std::min(widest, ball);
        }
        return farthest(cheapest_paths(graph_, widest < static_cast<int>(graph_.ball_count()) ? widest : 0));
    }

    /// Index of a tree point whose core holds p, or -1.
    [[nodiscard]] int core_at(const Vec3& p) const
    {
        work_.spend(static_cast<double>(tree_.points.size()));
        int best = -1;
        double distance = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < tree_.points.size(); ++i) {
            const double d = (tree_.points[i] - p).norm();
            if (d < kJoin * tree_.radius[i] && d < distance) {
                distance = d;
                best = static_cast<int>(i);
            }
        }
        return best;
    }

    /// Distinguishes a branch from the corner of a lumen that is not round. Towards a corner the balls shrink with the remaining
    /// path (a flat lumen twice as wide as high gives a ratio of 2); along a branch they keep their size.
    /// @param raw  from the tip to the parent's core
    static bool is_branch(const Polyline& raw, const Vec3& join, double parent_radius)
    {
        double length = 0, widest = 0;
        for (std::size_t i = 0; i < raw.points.size() && (raw.points[i] - join).norm() > parent_radius; ++i) {
            widest = std::max(widest, raw.radius[i]);
            if (i > 0) length += (raw.points[i] - raw.points[i - 1]).norm();
        }
        // a branch half as wide as its parent, outside its parent's sphere, is no corner, however short (an ascending aorta off
        // its root)
        return widest > 0 &&
               (length + raw.radius[0] >= kBranch * widest || (widest > 0.6 * parent_radius && length > parent_radius));
    }

    /// Whether most of a path, or of its narrow part, lies in a flat lumen that has an axis: wide across the path, and in sight
    /// of the axis, not only straight back as along a branch. The two lumens of a dissection are such sheets; without this each
    /// would be combed by a hundred paths.
    [[nodiscard]] bool is_in_sheet(const Polyline& raw, const Vec3& join, double parent_radius) const
    {
        constexpr double kNarrow = 0.6;  // of the radius where the path joins the axis
        constexpr double kStep = 0.3;    // of samples, in radii
        constexpr int least = 4;
        // a mesh made to be slow is not looked at for long
        if (static_cast<double>(sheet_visits_) > work_limit(4e7, 4e3, mesh_.vertices.size())) return false;
        int flat = 0, all = 0, narrow_flat = 0, narrow = 0;
        const double least_step = std::max(finest_, length_of(raw.points) / 64);
        for (std::size_t i = 0; i + 1 < raw.points.size(); ++i) {
            const Vec3 way = raw.points[i + 1] - raw.points[i];
            const double length = way.norm();
            for (double at = 0; at < length;) {
                const Vec3 p = raw.points[i] + (at / length) * way;
                if ((p - join).norm() <= parent_radius) break;
                const double far = std::numeric_limits<double>::infinity(),
                             radius = std::sqrt(lumen_.nearest(p, far, &sheet_visits_).distance2);
                const Vec3 along = way / length;
                const bool here = radius > 1e-3 * finest_ && is_flat(p, along) &&
                                  sees_axis(p, along, kSight * radius + 3 * parent_radius);
                ++all, flat += here;
                if (radius <= kNarrow * parent_radius) ++narrow, narrow_flat += here;
                at += std::max(kStep * radius, least_step);
            }
        }
        return (all >= least && 2 * flat > all) || (narrow >= least && 2 * narrow_flat > narrow);
    }

    [[nodiscard]] double free_way(const Vec3& p, const Vec3& direction) const
    {
        return first_hit(lumen_.tree(), p, direction, 0, &sheet_visits_);
    }
    /// Across the path, the lumen is this many times wider than high.
    [[nodiscard]] bool is_flat(const Vec3& p, const Vec3& along) const
    {
        const TreeHit hit = lumen_.nearest(p, std::numeric_limits<double>::infinity(), &sheet_visits_);
        const Vec3 across = along.cross(p - hit.point);
        if (!(across.norm() > 0)) return false;
        const Vec3 side = across.normalized();
        return free_way(p, side) + free_way(p, -side) > kFlat * 2 * std::sqrt(hit.distance2);
    }
    [[nodiscard]] bool sees_axis(const Vec3& p, const Vec3& back, double reach) const
    {
        sheet_visits_ += tree_.points.size() / 16;
        for (const Vec3& q : tree_.points) {
            const Vec3 to = q - p;
            const double away = to.norm();
            if (away > reach || to.dot(back) > kAside * away) continue;
            if (free_way(p, to / std::max(away, 1e-300)) > away) return true;
        }
        return false;
    }

    /// Walks from `tip` towards the root until an older path's core, refines that stretch and adds it unless it is a stub.
    /// @param narrow  radius of a lumen whose balls do not overlap all the way; 0: they do
    void add_branch(int tip, const BoundaryLoop* opening, double narrow = 0)
    {
        mark_served(tip);
        Polyline raw;
        int join = -1;
        if (opening) raw = {{opening->centre}, {opening->radius}};
        std::vector<bool> loose(raw.points.size(), false);
        for (int at = tip; at >= 0; at = paths_.towards_root[static_cast<std::size_t>(at)]) {
            join = core_at(graph_.centre[static_cast<std::size_t>(at)]);
            if (join >= 0) break;
            raw.points.push_back(graph_.centre[static_cast<std::size_t>(at)]);
            raw.radius.push_back(graph_.radius[static_cast<std::size_t>(at)]);
            loose.push_back(!graph_.is_lumen[static_cast<std::size_t>(at)]);
            mark_served(at);
        }
        if (raw.points.empty() || (join < 0 && !tree_.empty())) return;
        if (!opening && join >= 0) {
            const Vec3& at = tree_.points[static_cast<std::size_t>(join)];
            const double radius = tree_.radius[static_cast<std::size_t>(join)];
            if (!is_branch(raw, at, radius)) return serve({{raw.points[0]}, {raw.radius[0]}});
            const bool sheet = (leave_sheets_out_ || branches_ >= kComb) && is_in_sheet(raw, at, radius);
            if (sheet && leave_sheets_out_) {
                ++left_out_;
                return serve(raw);
            }
            ++branches_, in_sheet_ += sheet;
        }
        if (opening && std::count(loose.begin(), loose.end(), true) >= kLoose) narrow = opening->radius;
        std::vector<Vec3> path = narrow > 0 ? widest_of(raw, loose, narrow) : raw.points;
        if (join >= 0) path.push_back(tree_.points[static_cast<std::size_t>(join)]);
        else if (start_at_) path.push_back(*start_at_);
        std::reverse(path.begin(), path.end());
        Polyline line = refine(path, narrow > 0 ? 2 * narrow : std::numeric_limits<double>::infinity());
        if (!opening && leaves_the_vessel(line)) return serve(raw);
        serve(line);
        if (!opening) trim_tip(line);
        if (join < 0 && !start_at_) {
            std::reverse(line.points.begin(), line.points.end());
            std::reverse(line.radius.begin(), line.radius.end());
            trim_tip(line);
        }
        append(line, join);
    }

    /// Goes beyond an opening, as a path along a flap of triangles left over from a cut does.
    [[nodiscard]] bool leaves_the_vessel(const Polyline& line) const
    {
        return std::any_of(line.points.begin(), line.points.end(), [&](const Vec3& p) {
            const int k = locate(p).opening;
            if (k < 0) return false;
            const BoundaryLoop& out = openings_[static_cast<std::size_t>(k)];
            return (p - out.centre).dot(out.inward) < -0.5 * out.radius;
        });
    }

    /// Where the balls of a path are loose, leaves the widest of each four radii, moved to the middle of the lumen: between them
    /// are balls in corners of the wall, from which a path would go to and fro. Fine trees have many such branches: each brings
    /// steps of its own.
    /// @param loose  for each point
    [[nodiscard]] std::vector<Vec3> widest_of(const Polyline& raw, const std::vector<bool>& loose, double radius)
    {
        constexpr int most_branches = 100;
        constexpr std::size_t most_openings = 500;  // of a soup of triangles each is one
        if (openings_.size() < most_openings && narrow_branches_++ < most_branches) work_.allow(1e7);
        std::vector<Vec3> kept;
        for (std::size_t i = 0, end = 0; i < raw.points.size(); i = end) {
            std::size_t widest = i;
            for (end = i + 1; loose[i] && end < loose.size() && loose[end] &&
                              (raw.points[end] - raw.points[i]).norm() <= 4 * radius;
                 ++end)
                if (raw.radius[end] > raw.radius[widest]) widest = end;
            const Vec3& at = raw.points[widest];
            kept.push_back(loose[i] ? climb(bring_inside(at, 2 * radius), Vec3::Zero(), 2 * radius) : at);
        }
        return kept;
    }

    /// A path to the wall of a closed end runs through its corner: removes the narrow part beside a larger sphere.
    /// The corner of a flat end is sqrt(2) radii from the last sphere that fills the lumen: hence 1.5.
    void trim_tip(Polyline& line) const
    {
        auto beside_larger = [&](std::size_t i) {
            work_.spend(static_cast<double>(i));
            for (std::size_t j = 0; j < i; ++j)
                if (line.radius[i] < 0.5 * line.radius[j] && (line.points[i] - line.points[j]).norm() < 1.5 * line.radius[j])
                    return true;
            return false;
        };
        while (line.points.size() > 2 && beside_larger(line.points.size() - 1)) {
            line.points.pop_back();
            line.radius.pop_back();
        }
    }

    void append(const Polyline& line, int join)
    {
        int previous = join;
        for (std::size_t i = join >= 0 ? 1 : 0; i < line.points.size(); ++i) {
            tree_.points.push_back(line.points[i]);
            tree_.radius.push_back(line.radius[i]);
            tree_.parent.push_back(previous);
            previous = static_cast<int>(tree_.points.size()) - 1;
        }
    }

    /// Samples by ball, in compressed rows.
    void list_samples()
    {
        first_sample_.assign(graph_.ball_count() + 1, 0);
        for (const int ball : graph_.ball_of_sample) ++first_sample_[static_cast<std::size_t>(ball) + 1];
        for (std::size_t b = 0; b < graph_.ball_count(); ++b) first_sample_[b + 1] += first_sample_[b];
        samples_.resize(graph_.ball_of_sample.size());
        std::vector<std::size_t> next(first_sample_.begin(), first_sample_.end() - 1);
        for (std::size_t i = 0; i < samples_.size(); ++i)
            samples_[next[static_cast<std::size_t>(graph_.ball_of_sample[i])]++] = i;
    }
    /// Every sample that the ball represents.
    void mark_served(int ball)
    {
        if (ball < 0) return;
        const auto b = static_cast<std::size_t>(ball);
        work_.spend(static_cast<double>(first_sample_[b + 1] - first_sample_[b]));
        for (std::size_t k = first_sample_[b]; k < first_sample_[b + 1]; ++k) served_[samples_[k]] = true;
    }

    /// Marks the wall near the line as having a path. Plain loops: a tree query per point returns most of a wide lumen's wall.
    void serve(const Polyline& line)
    {
        Box3 box;
        for (std::size_t i = 0; i < line.points.size(); ++i)
            for (const double sign : {-1.0, 1.0})
                box.extend(Vec3(line.points[i] + sign * Vec3::Constant(kCover * line.radius[i])));
        work_.spend(static_cast<double>(served_.size()));
        for (std::size_t sample = 0; sample < served_.size(); ++sample)
            for (std::size_t i = 0; !served_[sample] && box.contains(graph_.wall[sample]) && i < line.points.size(); ++i) {
                work_.spend(1);
                const double reach = kCover * line.radius[i];
                served_[sample] = (graph_.wall[sample] - line.points[i]).squaredNorm() <= reach * reach;
            }
    }

    [[nodiscard]] TreeHit nearest(const Vec3& p) const
    {
        std::uint64_t visits = 0;
        const TreeHit hit = lumen_.nearest(p, std::numeric_limits<double>::infinity(), &visits);
        spend_visits(visits);
        return hit;
    }
    [[nodiscard]] LumenPlace locate(const Vec3& p) const
    {
        std::uint64_t visits = 0;
        const LumenPlace place = lumen_.locate(p, &visits);
        spend_visits(visits);
        return place;
    }
    void spend_visits(std::uint64_t visits) const { work_.spend(10 * static_cast<double>(visits)); }

    [[nodiscard]] double radius_at(const Vec3& p) const { return std::sqrt(nearest(p).distance2); }

    /// Points at half a radius apart, ends kept.
    [[nodiscard]] std::vector<Vec3> resample(const std::vector<Vec3>& raw) const
    {
        std::vector<Vec3> result = {raw.front()};
        double to_next = kSpacing * radius_at(raw.front());
        for (std::size_t i = 1; i < raw.size(); ++i) {
            Vec3 at = raw[i - 1];
            for (double left = (raw[i] - at).norm(); left >= to_next; left = (raw[i] - at).norm()) {
                at += (raw[i] - at) * (to_next / left);
                result.push_back(at);
                to_next = std::max(kSpacing * radius_at(at), finest_);
            }
            to_next -= (raw[i] - at).norm();
            to_next = std::max(to_next, 0.25 * finest_);
        }
        if ((result.back() - raw.back()).norm() > 0) result.push_back(raw.back());
        return result;
    }

    static void smooth(std::vector<Vec3>& points, int rounds)
    {
        std::vector<Vec3> next = points;
        for (int r = 0; r < rounds; ++r) {
            for (std::size_t i = 1; i + 1 < points.size(); ++i)
                next[i] = 0.5 * points[i] + 0.25 * (points[i - 1] + points[i + 1]);
            points = next;
        }
    }

    /// Climbs from the wall across the path while that makes the sphere larger.
    /// @param widest  sphere of a narrow lumen: a larger one lies beyond its opening; one that is as large may grow by half
    [[nodiscard]] Vec3 climb(Vec3 p, const Vec3& tangent, double widest) const
    {
        TreeHit hit = nearest(p);
        const double most = std::max(widest, 1.5 * std::sqrt(hit.distance2));
        double step = 0.3;
        for (int i = 0; i < 24 && step > 0.005; ++i) {
            const double distance = std::sqrt(hit.distance2);
            const Vec3 away = (p - hit.point) / std::max(distance, 1e-300);
            const Vec3 next = p + step * distance * (away - tangent * tangent.dot(away));
            const TreeHit there = nearest(next);
            // beyond all of the wall spheres grow without end
            if (there.distance2 > hit.distance2 && there.distance2 < most * most && box_.contains(next)) {
                p = next;
                hit = there;
            } else step *= 0.5;
        }
        return p;
    }

    /// Where triangles are longer than the lumen is wide, smoothing may leave a point in the wall: back in, and to the middle.
    [[nodiscard]] Vec3 bring_inside(const Vec3& p, double widest) const
    {
        const LumenPlace place = locate(p);
        if (place.inside()) return p;
        if (place.opening >= 0) return p;  // an opening's own centre, off its mean plane
        std::uint64_t visits = 0;
        const bool beside_fold = !openings_.empty() && enclosure_.holds(p, &visits);  // of triangles, whose back is nearest
        spend_visits(visits);
        if (beside_fold) return p;
        for (double step = finest_; step > 1e-4 * finest_; step *= 0.5)
            if (const Vec3 in = place.nearest + step * place.normal; locate(in).inside()) return climb(in, Vec3::Zero(), widest);
        return p;
    }

    [[nodiscard]] Polyline refine(const std::vector<Vec3>& raw, double widest) const
    {
        Polyline line;
        line.points = resample(raw);
        smooth(line.points, 6);
        for (int round = 0; round < 2; ++round) {
            for (std::size_t i = 1; i + 1 < line.points.size(); ++i)
                line.points[i] = climb(bring_inside(line.points[i], widest),
                                       (line.points[i + 1] - line.points[i - 1]).normalized(), widest);
            std::vector<Vec3> smoothed = line.points;
            smooth(smoothed, 2);
            // smoothing may cut a corner of a narrow lumen: a point that would lose the middle stays
            for (std::size_t i = 1; i + 1 < smoothed.size(); ++i)
                if (locate(smoothed[i]).signed_distance > 0.7 * radius_at(line.points[i])) line.points[i] = smoothed[i];
        }
        for (Vec3& p : line.points) {
            p = bring_inside(p, widest);
            line.radius.push_back(radius_at(p));
        }
        // points set close along the wall go to and fro once they have climbed to the middle
        if (length_of(line.points) > 2 * length_of(raw)) thin(line);
        return line;
    }

    static double length_of(const std::vector<Vec3>& points)
    {
        double length = 0;
        for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
        return length;
    }

    /// Leaves points a spacing apart, and the ends.
    static void thin(Polyline& line)
    {
        Polyline kept;
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            const bool last = i + 1 == line.points.size();
            if (!kept.points.empty() && !last && (line.points[i] - kept.points.back()).norm() < kSpacing * kept.radius.back())
                continue;
            kept.points.push_back(line.points[i]);
            kept.radius.push_back(line.radius[i]);
        }
        line = std::move(kept);
    }

    const WallMesh& mesh_;
    const std::vector<BoundaryLoop>& openings_;
    const LumenQuery& lumen_;
    const MeshEdges edges_;
    const Enclosure enclosure_;
    MedialGraph graph_;
    MedialPaths paths_;
    std::vector<bool> served_;
    std::vector<std::size_t> first_sample_, samples_;  // of each ball
    int narrow_branches_ = 0;          // that brought steps of their own
    int branches_ = 0, in_sheet_ = 0, left_out_ = 0;  // with closed ends; of them in a flat lumen that has an axis
    bool leave_sheets_out_ = false;
    mutable std::uint64_t sheet_visits_ = 0;
    std::optional<Vec3> start_at_;
    double finest_ = 0;  // least spacing of points [m]
    Box3 box_;
    mutable WorkBudget work_;
    Centreline tree_;
};

}  // namespace

Centreline extract_centreline(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings, const LumenQuery& lumen,
                              CentrelineGaps* gaps)
{
    Extraction extraction(mesh, openings, lumen);
    Centreline line = extraction.run();
    if (gaps && !line.empty()) *gaps = {extraction.unreached(), extraction.left_out()};
    return line;
}

}  // namespace seldinger

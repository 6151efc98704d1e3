// Shrinking balls and Dijkstra on them.
#include "vessel/medial_graph.h"

#include "core/parallel.h"
#include "vessel/mesh_edges.h"
#include "vessel/work_budget.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>
#include <unordered_map>

namespace seldinger {
namespace {

constexpr const char* kFindingBalls = "finding the spheres that fill its lumen";

struct Ball {
    Vec3 centre = Vec3::Zero();
    double radius = 0;
};

/// Places whose distance to the wall took long to find, because much of the wall is equally far from them: the middle of a
/// sphere. Samples of such a wall ask for the same place again and again, and each would look at all of it. A point's distance
/// bounds those of its neighbours.
class TiedPlaces {
public:
    static constexpr std::uint64_t kMany = 3000;  // nodes and triangles; a patient's wall takes dozens to hundreds

    void remember(const Vec3& place, double distance)
    {
        places_[next_] = {place, distance};
        next_ = (next_ + 1) % places_.size();
    }
    /// A radius within which nothing of the wall is, where that is nearly all that is asked for; else 0.
    [[nodiscard]] double nearly(const Vec3& place, double radius) const
    {
        constexpr double share = 0.97;  // such a ball is as good: those beside it are taken for one (keep_significant)
        for (const Ball& known : places_)
            if (const double bound = known.radius - (known.centre - place).norm(); bound >= share * radius)
                return std::min(bound, radius);
        return 0;
    }

private:
    std::array<Ball, 8> places_{};
    std::size_t next_ = 0;
};

/// What balls of neighbours have found out.
struct BallSearch {
    BallSearch() { met.fill(-1); }
    std::array<std::int64_t, 40>
        met;  // triangle that the last ball met in each round of shrinking, where to look first; -1: none yet
    TiedPlaces tied;
    std::uint64_t visits = 0;
};

/// Largest ball inside the lumen that touches the wall at `at` with centre along `normal`. Starts with half the chord
/// (no larger ball can avoid the wall at its far end) and shrinks onto the nearest wall until none is nearer.
/// A wall without a direction there (its triangles face each other) has no such ball.
Ball medial_ball(const LumenQuery& lumen, const Vec3& at, const Vec3& normal, double skip, double limit, BallSearch& search)
{
    auto& [met, tied, visits] = search;
    if (!(normal.squaredNorm() > 0)) return {at, 0.0};
    // two contacts closer than this seen from the centre are one contact on a rough wall, not two sides of a lumen
    constexpr double kSeparation = 40 * std::numbers::pi / 180;
    double radius = std::min(0.5 * first_hit(lumen.tree(), at, normal, skip, &visits), limit);
    for (std::int64_t& last : met) {
        const Vec3 centre = at + radius * normal;
        if (const double free = tied.nearly(centre, radius); free > 0) return {centre, free};
        const std::uint64_t before = visits;
        const TreeHit hit = lumen.nearest(centre, radius, &visits, last);
        if (visits - before > TiedPlaces::kMany) tied.remember(centre, std::sqrt(std::min(hit.distance2, radius * radius)));
        if (hit.triangle >= 0) last = hit.triangle;
        if (hit.triangle < 0 || hit.distance2 >= radius * radius * (1 - 2e-3))
            return {centre, std::sqrt(std::min(hit.distance2, radius * radius))};
        const Vec3 chord = hit.point - at;
        const double smaller = chord.squaredNorm() / (2 * chord.dot(normal));
        const Vec3 next = at + smaller * normal;
        if (!(smaller < radius)) return {centre, std::sqrt(hit.distance2)};
        // only a ball that nearly fits may ignore such a contact; one that looked out through an opening may not
        const double cosine = (at - next).dot(hit.point - next) / (smaller * smaller);
        if (cosine > std::cos(kSeparation) && hit.distance2 > 0.64 * radius * radius) return {centre, std::sqrt(hit.distance2)};
        radius = smaller;
    }
    const Vec3 centre = at + radius * normal;
    return {centre, std::sqrt(lumen.nearest(centre, std::numeric_limits<double>::infinity(), &visits).distance2)};
}

bool balls_overlap(const MedialGraph& graph, std::size_t i, std::size_t j)
{
    const double reach = 0.95 * (graph.radius[i] + graph.radius[j]);
    return (graph.centre[i] - graph.centre[j]).squaredNorm() < reach * reach;
}

/// How far a centre may go along the ray before it leaves through an opening: beyond one, any ball is empty.
double way_to_openings(const std::vector<BoundaryLoop>& openings, const Vec3& at, const Vec3& direction)
{
    double way = std::numeric_limits<double>::infinity();
    for (const BoundaryLoop& loop : openings) {
        const double closing = -direction.dot(loop.inward);
        if (closing <= 0) continue;
        const double t = std::max(0.0, (at - loop.centre).dot(loop.inward) / closing);
        // twice the mean radius: openings are not round, and the ray may pass one at its corner
        if ((at + t * direction - loop.centre).norm() < 2 * loop.radius) way = std::min(way, t);
    }
    return way;
}

/// Mesh vertices linked to each vertex, in compressed rows.
void vertex_links(const MeshEdges& edges, const WallMesh& mesh, std::vector<int>& row, std::vector<int>& to)
{
    row.assign(mesh.vertices.size() + 1, 0);
    auto ends = [&](std::size_t k) {
        const std::int32_t h = edges.uses(k)[0];
        return std::pair(half_edge_from(mesh, h), half_edge_to(mesh, h));
    };
    for (std::size_t k = 0; k < edges.count(); ++k) {
        ++row[static_cast<std::size_t>(ends(k).first) + 1];
        ++row[static_cast<std::size_t>(ends(k).second) + 1];
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) row[v + 1] += row[v];
    to.resize(static_cast<std::size_t>(row.back()));
    std::vector<int> next(row.begin(), row.end() - 1);
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto [a, b] = ends(k);
        to[static_cast<std::size_t>(next[static_cast<std::size_t>(a)]++)] = b;
        to[static_cast<std::size_t>(next[static_cast<std::size_t>(b)]++)] = a;
    }
}

/// Gathers vertices into patches of at most `size`, each round its first vertex; returns the seeds.
std::vector<int> gather_patches(const std::vector<int>& row, const std::vector<int>& to, std::size_t size,
                                std::vector<int>& sample_of_vertex)
{
    std::vector<int> seeds, patch;
    for (std::size_t v = 0; v + 1 < row.size(); ++v) {
        if (sample_of_vertex[v] >= 0) continue;
        const int node = static_cast<int>(seeds.size());
        seeds.push_back(static_cast<int>(v));
        sample_of_vertex[v] = node;
        patch.assign(1, static_cast<int>(v));
        for (std::size_t k = 0; k < patch.size() && patch.size() < size; ++k)
            for (int i = row[static_cast<std::size_t>(patch[k])];
                 i < row[static_cast<std::size_t>(patch[k]) + 1] && patch.size() < size; ++i) {
                int& other = sample_of_vertex[static_cast<std::size_t>(to[static_cast<std::size_t>(i)])];
                if (other >= 0) continue;
                other = node;
                patch.push_back(to[static_cast<std::size_t>(i)]);
            }
    }
    return seeds;
}

/// Where a patch is wide for the lumen there, each of its vertices becomes a sample: two samples a radius find the narrowest
/// branch.
void split_coarse_patches(const WallMesh& mesh, const std::vector<Ball>& balls, std::vector<int>& seeds,
                          std::vector<int>& sample_of_vertex)
{
    constexpr double kFine = 0.5;  // of the ball's radius
    std::vector<bool> coarse(seeds.size(), false);
    for (std::size_t v = 0; v < sample_of_vertex.size(); ++v) {
        const auto sample = static_cast<std::size_t>(sample_of_vertex[v]);
        const double away = (mesh.vertices[v] - mesh.vertices[static_cast<std::size_t>(seeds[sample])]).norm();
        if (away > kFine * balls[sample].radius) coarse[sample] = true;
    }
    for (std::size_t v = 0; v < sample_of_vertex.size(); ++v) {
        const auto sample = static_cast<std::size_t>(sample_of_vertex[v]);
        if (!coarse[sample] || seeds[sample] == static_cast<int>(v)) continue;
        sample_of_vertex[v] = static_cast<int>(seeds.size());
        seeds.push_back(static_cast<int>(v));
    }
}

/// Samples in the order of the tree's leaves, so that those that follow each other meet the same wall, in whatever order a file
/// has it.
std::vector<int> along_the_wall(const WallTree& tree, const WallMesh& mesh, const std::vector<int>& seeds,
                                const std::vector<int>& sample_of_vertex)
{
    std::vector<int> order;
    order.reserve(seeds.size());
    std::vector<bool> listed(seeds.size(), false);
    for (const std::uint32_t t : tree.original)
        for (const std::int32_t v : mesh.triangles[t]) {
            const int sample = sample_of_vertex[static_cast<std::size_t>(v)];
            if (seeds[static_cast<std::size_t>(sample)] != v || listed[static_cast<std::size_t>(sample)]) continue;
            listed[static_cast<std::size_t>(sample)] = true;
            order.push_back(sample);
        }
    for (std::size_t i = 0; i < listed.size(); ++i)  // vertices of no triangle
        if (!listed[i]) order.push_back(static_cast<int>(i));
    return order;
}

/// Finds the spheres that a point lies in, among many of all sizes: one grid for each power of 2 of their radii.
class BallGrid {
public:
    void add(int ball, const Vec3& centre, double radius)
    {
        const int level = std::ilogb(radius) +
                          1;  // cells at least as wide as the radius: a point's sphere lies in its cell or in one beside it
        levels_[level][cell_of(centre, level)].push_back(ball);
    }
    /// The last added that `holds`, among those within whose radius p may lie; -1: none.
    template <class Holds>
    [[nodiscard]] int latest(const Vec3& p, WorkBudget& work, const Holds& holds) const
    {
        int best = -1;
        for_each_cell(p, work, [&](const std::vector<int>& balls) {
            for (std::size_t n = balls.size(); n-- > 0 && balls[n] > best;) {
                work.spend(1);
                if (holds(balls[n])) best = balls[n];
            }
        });
        return best;
    }
    /// each(cell) for the balls of every cell that may hold one within whose radius p lies.
    template <class Each>
    void for_each_cell(const Vec3& p, WorkBudget& work, const Each& each) const
    {
        for (const auto& [level, cells] : levels_) {
            const Cell at = cell_of(p, level);
            for (int k = 0; k < 27; ++k)
                if (const auto found = cells.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
                    found != cells.end())
                    each(found->second);
            work.spend(27);
        }
    }

private:
    using Cell = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Cell& c) const
        {
            return static_cast<std::size_t>(c[0]) * 73856093U ^ static_cast<std::size_t>(c[1]) * 19349663U ^
                   static_cast<std::size_t>(c[2]) * 83492791U;
        }
    };
    /// Numbers beyond an integer's range share a cell.
    static Cell cell_of(const Vec3& p, int level)
    {
        const auto number = [&](double x) {
            return static_cast<std::int64_t>(std::clamp(std::floor(std::ldexp(x, -level)), -1e18, 1e18));
        };
        return {number(p.x()), number(p.y()), number(p.z())};
    }
    std::map<int, std::unordered_map<Cell, std::vector<int>, Hash>> levels_;
};

/// Largest first, keeps the balls that add something: one whose centre is near the centre of a kept ball, or that hardly stands
/// out of it, is represented by it. What a rough wall puts beside the axis goes this way.
/// A ball in the air beside the vessel (in front of a flap that stands out of a rim) goes, too: it would be the largest.
/// @param enclosure  of the lumen; null: it has no opening @param least  radius of a ball that is none [m]
void keep_significant(std::vector<Ball>& balls, const Enclosure* enclosure, double least, MedialGraph& graph, WorkBudget& work)
{
    constexpr double kNear = 0.3, kStandsOut = 1.1;  // of the kept ball's radius
    std::vector<int> order(balls.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return balls[static_cast<std::size_t>(a)].radius > balls[static_cast<std::size_t>(b)].radius;
    });
    graph.ball_of_sample.assign(balls.size(), -1);
    BallGrid kept;
    for (std::size_t n = 0; n < order.size(); ++n) {
        const int i = order[n];
        const Ball& ball = balls[static_cast<std::size_t>(i)];
        // the latest of them: they are of like size, and samples of one cross-section follow each other
        int keeper = kept.latest(ball.centre, work, [&](int k) {
            const double radius = graph.radius[static_cast<std::size_t>(k)],
                         reach = std::max(kNear * radius, kStandsOut * radius - ball.radius);
            return (graph.centre[static_cast<std::size_t>(k)] - ball.centre).squaredNorm() < reach * reach;
        });
        if (std::uint64_t visits = 0; keeper < 0 && enclosure && ball.radius > least) {
            const bool in_air = !enclosure->holds(ball.centre, &visits) && !enclosure->is_at_opening(ball.centre);
            work.spend(static_cast<double>(visits));
            if (in_air) {
                balls[static_cast<std::size_t>(i)] = {graph.wall[static_cast<std::size_t>(i)], least};
                order.push_back(i);  // last, where the least ones are
                continue;
            }
        }
        if (keeper < 0) {
            keeper = static_cast<int>(graph.centre.size());
            graph.centre.push_back(ball.centre);
            graph.radius.push_back(ball.radius);
            kept.add(keeper, ball.centre, kStandsOut * ball.radius);
        }
        graph.ball_of_sample[static_cast<std::size_t>(i)] = keeper;
    }
}

/// Links balls that overlap, and as a last resort those of neighbouring samples: where a lumen is narrower than its triangles are
/// long, balls may stand apart along it.
void link_balls(MedialGraph& graph, const std::vector<int>& row, const std::vector<int>& to, WorkBudget& work)
{
    std::vector<std::vector<int>> neighbours(graph.ball_count());
    for (std::size_t v = 0; v + 1 < row.size(); ++v)
        for (int i = row[v]; i < row[v + 1]; ++i) {
            auto ball_of = [&](std::size_t vertex) {
                return graph.ball_of_sample[static_cast<std::size_t>(graph.sample_of_vertex[vertex])];
            };
            const int a = ball_of(v), b = ball_of(static_cast<std::size_t>(to[static_cast<std::size_t>(i)]));
            if (a != b) neighbours[static_cast<std::size_t>(a)].push_back(b);
        }
    BallGrid larger;
    for (std::size_t i = 0; i < graph.ball_count(); ++i) {
        larger.for_each_cell(graph.centre[i], work, [&](const std::vector<int>& balls) {
            work.spend(static_cast<double>(balls.size()));
            for (const int j : balls) {
                if (!balls_overlap(graph, i, static_cast<std::size_t>(j))) continue;
                neighbours[i].push_back(j);
                neighbours[static_cast<std::size_t>(j)].push_back(static_cast<int>(i));
                work.spend(400);  // paths go over each link several times
            }
        });
        larger.add(static_cast<int>(i), graph.centre[i],
                   2 * graph.radius[i]);  // two overlap within twice the larger one's radius
    }
    graph.row.assign(1, 0);
    for (std::size_t i = 0; i < graph.ball_count(); ++i) {
        std::vector<int>& links = neighbours[i];
        std::sort(links.begin(), links.end());
        links.erase(std::unique(links.begin(), links.end()), links.end());
        graph.link_to.insert(graph.link_to.end(), links.begin(), links.end());
        graph.row.push_back(static_cast<int>(graph.link_to.size()));
    }
}

/// Marks the balls of stretches of lumen: sets of overlapping balls that represent two samples a ball or more. Loose balls in
/// corners and folds of a rough wall represent only themselves; no path shall end there. Where one sample stands for a patch of
/// vertices they are few for a narrow branch: there a long set is a lumen, too.
void mark_lumen(MedialGraph& graph, bool has_patches)
{
    constexpr long kFewest = 30;   // samples of a stretch worth a path
    constexpr double kLong = 8;    // its length in radii: a branch of four diameters
    std::vector<long> samples(graph.ball_count(), 0);
    for (const int ball : graph.ball_of_sample) ++samples[static_cast<std::size_t>(ball)];
    graph.is_lumen.assign(graph.ball_count(), false);
    std::vector<bool> seen(graph.ball_count(), false);
    std::vector<std::size_t> part;
    for (std::size_t seed = 0; seed < graph.ball_count(); ++seed) {
        if (seen[seed]) continue;
        part.assign(1, seed);
        seen[seed] = true;
        long total = 0;
        Box3 box;
        for (std::size_t k = 0; k < part.size(); ++k) {
            const std::size_t i = part[k];
            total += samples[i];
            box.extend(graph.centre[i]);
            for (int n = graph.row[i]; n < graph.row[i + 1]; ++n) {
                const auto j = static_cast<std::size_t>(graph.link_to[static_cast<std::size_t>(n)]);
                if (seen[j] || !balls_overlap(graph, i, j)) continue;
                seen[j] = true;
                part.push_back(j);
            }
        }
        const bool lumen =
            seed == 0 ||
            (total >= kFewest && (total >= 2 * static_cast<long>(part.size()) ||
                                  (has_patches && box.diagonal().norm() > kLong * graph.radius[seed])));  // ball 0 is the largest
        for (const std::size_t i : part) graph.is_lumen[i] = lumen;
    }
}

}  // namespace

MedialGraph build_medial_graph(const WallMesh& mesh, const MeshEdges& edges, const std::vector<BoundaryLoop>& openings,
                               const LumenQuery& lumen, const Enclosure& enclosure, std::size_t sample_limit)
{
    MedialGraph graph;
    if (mesh.triangles.empty()) return graph;
    std::vector<int> row, to;
    vertex_links(edges, mesh, row, to);
    graph.sample_of_vertex.assign(mesh.vertices.size(), -1);
    std::vector<int> seeds = gather_patches(row, to, mesh.vertices.size() / sample_limit + 1, graph.sample_of_vertex);

    Box3 box;
    for (const Vec3& v : mesh.vertices) box.extend(v);
    double edge_sum = 0;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const std::int32_t h = edges.uses(k)[0];
        edge_sum += (mesh.vertices[static_cast<std::size_t>(half_edge_to(mesh, h))] -
                     mesh.vertices[static_cast<std::size_t>(half_edge_from(mesh, h))])
                        .norm();
    }
    const double skip = 1e-3 * edge_sum / static_cast<double>(edges.count()), limit = box.diagonal().norm(), least = 1e-9 * limit;
    std::vector<Ball> balls;
    // Each ball is independent, with its own visits: neither their sum nor a refusal depends on the threads.
    const double most_visits = work_limit(2.4e8, 2e4, mesh.vertices.size());  // patients: up to 1e8
    std::atomic<std::uint64_t> visits = 0;
    const auto find_balls = [&](std::size_t from) {  // of the seeds from there on
        graph.wall.resize(seeds.size());
        balls.resize(seeds.size());
        std::vector<int> order = along_the_wall(lumen.tree(), mesh, seeds, graph.sample_of_vertex);
        std::erase_if(order, [&](int sample) { return static_cast<std::size_t>(sample) < from; });
        for_each_piece(static_cast<int>(order.size()), 256, [&](int begin, int end) {
            BallSearch search;  // of this piece alone, so that no thread changes another's answer
            for (int k = begin; k < end; ++k) {
                if (static_cast<double>(visits) > most_visits) return;
                const auto i = static_cast<std::size_t>(order[static_cast<std::size_t>(k)]);
                const auto v = static_cast<std::size_t>(seeds[i]);
                const Vec3 at = mesh.vertices[v];
                graph.wall[i] = at;
                search.visits = openings.size();
                const Vec3 normal = lumen.vertex_normal(seeds[i], &search.visits);
                balls[i] = medial_ball(lumen, at, normal, skip, std::min(limit, way_to_openings(openings, at, normal)), search);
                if (!box.contains(balls[i].centre)) balls[i] = {at, 0.0};  // of a wall that faces out of everything
                balls[i].radius = std::max(balls[i].radius, least);
                visits += search.visits;
            }
        });
        WorkBudget(kFindingBalls, most_visits).spend(static_cast<double>(visits));
    };
    find_balls(0);
    const std::size_t coarse = seeds.size();
    split_coarse_patches(mesh, balls, seeds, graph.sample_of_vertex);
    if (seeds.size() > coarse) find_balls(coarse);
    WorkBudget work(kFindingBalls, work_limit(7e8, 5e4, mesh.vertices.size()));  // patients: up to 2e8
    keep_significant(balls, openings.empty() ? nullptr : &enclosure, least, graph, work);
    link_balls(graph, row, to, work);
    mark_lumen(graph, seeds.size() < mesh.vertices.size());
    return graph;
}

MedialPaths cheapest_paths(const MedialGraph& graph, int root)
{
    MedialPaths paths;
    paths.towards_root.assign(graph.ball_count(), -1);
    paths.length.assign(graph.ball_count(), -1.0);
    std::vector<double> cost(graph.ball_count(), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    cost[static_cast<std::size_t>(root)] = paths.length[static_cast<std::size_t>(root)] = 0;
    queue.emplace(0.0, root);
    while (!queue.empty()) {
        const auto [c, node] = queue.top();
        queue.pop();
        const auto i = static_cast<std::size_t>(node);
        if (c > cost[i]) continue;
        for (int k = graph.row[i]; k < graph.row[i + 1]; ++k) {
            const auto j = static_cast<std::size_t>(graph.link_to[static_cast<std::size_t>(k)]);
            const double length = (graph.centre[j] - graph.centre[i]).norm();
            const double ri = graph.radius[i], rj = graph.radius[j];
            // balls that stand apart may lie on two sides of a wall (a crotch): only where nothing else leads on
            const double penalty = balls_overlap(graph, i, j) ? 1.0 : 1000.0;
            const double next = c + penalty * length * 0.5 * (1 / (ri * ri) + 1 / (rj * rj));
            if (!(next < cost[j])) continue;  // nor a path of no number
            cost[j] = next;
            paths.length[j] = paths.length[i] + length;
            paths.towards_root[j] = node;
            queue.emplace(next, static_cast<int>(j));
        }
    }
    return paths;
}

}  // namespace seldinger

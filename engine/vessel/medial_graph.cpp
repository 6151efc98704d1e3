// Shrinking balls and Dijkstra on them.
#include "vessel/medial_graph.h"

#include "vessel/mesh_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <thread>

namespace seldinger {
namespace {

struct Ball {
    Vec3 centre;
    double radius;
};

/// Largest ball inside the lumen that touches the wall at `at` with centre along `normal`. Starts with half the chord
/// (no larger ball can avoid the wall at its far end) and shrinks onto the nearest wall until none is nearer.
Ball medial_ball(const WallTree& tree, const Vec3& at, const Vec3& normal, double skip, double limit)
{
    // two contacts closer than this seen from the centre are one contact on a rough wall, not two sides of a lumen
    constexpr double kSeparation = 40 * std::numbers::pi / 180;
    double radius = std::min(0.5 * first_hit(tree, at, normal, skip), limit);
    for (int i = 0; i < 40; ++i) {
        const Vec3 centre = at + radius * normal;
        const TreeHit hit = nearest_on_wall(tree, centre, radius);
        if (hit.triangle < 0 || hit.distance2 >= radius * radius * (1 - 2e-3)) return {centre, std::sqrt(std::min(hit.distance2, radius * radius))};
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
    return {centre, std::sqrt(nearest_on_wall(tree, centre).distance2)};
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
std::vector<int> gather_patches(const std::vector<int>& row, const std::vector<int>& to, std::size_t size, std::vector<int>& node_of_vertex)
{
    std::vector<int> seeds, patch;
    for (std::size_t v = 0; v + 1 < row.size(); ++v) {
        if (node_of_vertex[v] >= 0) continue;
        const int node = static_cast<int>(seeds.size());
        seeds.push_back(static_cast<int>(v));
        node_of_vertex[v] = node;
        patch.assign(1, static_cast<int>(v));
        for (std::size_t k = 0; k < patch.size() && patch.size() < size; ++k)
            for (int i = row[static_cast<std::size_t>(patch[k])]; i < row[static_cast<std::size_t>(patch[k]) + 1] && patch.size() < size; ++i) {
                int& other = node_of_vertex[static_cast<std::size_t>(to[static_cast<std::size_t>(i)])];
                if (other >= 0) continue;
                other = node;
                patch.push_back(to[static_cast<std::size_t>(i)]);
            }
    }
    return seeds;
}

void link_nodes(MedialGraph& graph, const std::vector<int>& row, const std::vector<int>& to)
{
    std::vector<std::pair<int, int>> links;
    for (std::size_t v = 0; v + 1 < row.size(); ++v)
        for (int i = row[v]; i < row[v + 1]; ++i) {
            const int a = graph.node_of_vertex[v], b = graph.node_of_vertex[static_cast<std::size_t>(to[static_cast<std::size_t>(i)])];
            if (a != b) links.emplace_back(a, b);
        }
    std::sort(links.begin(), links.end());
    links.erase(std::unique(links.begin(), links.end()), links.end());
    graph.row.assign(graph.size() + 1, 0);
    for (const auto& [a, b] : links) {
        ++graph.row[static_cast<std::size_t>(a) + 1];
        graph.link_to.push_back(b);
    }
    for (std::size_t i = 0; i < graph.size(); ++i) graph.row[i + 1] += graph.row[i];
}

}  // namespace

MedialGraph build_medial_graph(const WallMesh& mesh, const LumenQuery& lumen, std::size_t node_limit)
{
    MedialGraph graph;
    if (mesh.triangles.empty()) return graph;
    std::vector<int> row, to;
    const MeshEdges edges = find_edges(mesh);
    vertex_links(edges, mesh, row, to);
    graph.node_of_vertex.assign(mesh.vertices.size(), -1);
    const std::vector<int> seeds = gather_patches(row, to, mesh.vertices.size() / node_limit + 1, graph.node_of_vertex);

    Eigen::AlignedBox3d box;
    for (const Vec3& v : mesh.vertices) box.extend(v);
    double edge_sum = 0;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const std::int32_t h = edges.uses(k)[0];
        edge_sum += (mesh.vertices[static_cast<std::size_t>(half_edge_to(mesh, h))] - mesh.vertices[static_cast<std::size_t>(half_edge_from(mesh, h))]).norm();
    }
    const double skip = 1e-3 * edge_sum / static_cast<double>(edges.count()), limit = box.diagonal().norm();
    graph.wall.resize(seeds.size());
    graph.centre.resize(seeds.size());
    graph.radius.resize(seeds.size());
    auto fill = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto v = static_cast<std::size_t>(seeds[i]);
            const Ball ball = medial_ball(lumen.tree(), mesh.vertices[v], lumen.vertex_normal(v), skip, limit);
            graph.wall[i] = mesh.vertices[v];
            graph.centre[i] = ball.centre;
            graph.radius[i] = std::max(ball.radius, 1e-9 * limit);
        }
    };
    std::thread helper(fill, 0, seeds.size() / 2);  // each node on its own: the same bits whoever computes it
    fill(seeds.size() / 2, seeds.size());
    helper.join();
    link_nodes(graph, row, to);
    return graph;
}

MedialPaths cheapest_paths(const MedialGraph& graph, int root)
{
    MedialPaths paths;
    paths.towards_root.assign(graph.size(), -1);
    paths.length.assign(graph.size(), -1.0);
    std::vector<double> cost(graph.size(), std::numeric_limits<double>::infinity());
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
            // balls that do not overlap may lie on two sides of a wall (a crotch): the last resort
            const double penalty = length < 0.95 * (ri + rj) ? 1.0 : 1000.0;
            // the constant keeps links between coinciding centres (a perfect tube) from being free
            const double next = c + penalty * (length + 1e-3 * ri) * 0.5 * (1 / (ri * ri) + 1 / (rj * rj));
            if (next >= cost[j]) continue;
            cost[j] = next;
            paths.length[j] = paths.length[i] + length;
            paths.towards_root[j] = node;
            queue.emplace(next, static_cast<int>(j));
        }
    }
    return paths;
}

}  // namespace seldinger

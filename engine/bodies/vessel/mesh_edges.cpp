// Edges of a triangle mesh and the loops its open ones form.
#include "vessel/mesh_edges.h"

#include "core/check.h"
#include "vessel/triangle_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

namespace seldinger {

MeshEdges find_edges(const WallMesh& mesh)
{
    const std::int32_t half_edge_count = static_cast<std::int32_t>(3 * mesh.triangles.size());
    std::vector<std::int32_t> start(mesh.vertices.size() + 1, 0);
    auto low = [&](std::int32_t h) { return std::min(half_edge_from(mesh, h), half_edge_to(mesh, h)); };
    auto high = [&](std::int32_t h) { return std::max(half_edge_from(mesh, h), half_edge_to(mesh, h)); };
    for (std::int32_t h = 0; h < half_edge_count; ++h) ++start[static_cast<std::size_t>(low(h)) + 1];
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) start[v + 1] += start[v];

    // (larger vertex, half-edge) packed, so that the short sorts below touch no other memory
    std::vector<std::uint64_t> packed(static_cast<std::size_t>(half_edge_count));
    std::vector<std::int32_t> next(start.begin(), start.end() - 1);
    for (std::int32_t h = 0; h < half_edge_count; ++h)
        packed[static_cast<std::size_t>(next[static_cast<std::size_t>(low(h))]++)] =
            (static_cast<std::uint64_t>(high(h)) << 32) | static_cast<std::uint32_t>(h);

    MeshEdges edges;
    edges.half_edges.resize(packed.size());
    edges.first.reserve(packed.size() / 2 + 2);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        std::sort(packed.begin() + start[v], packed.begin() + start[v + 1]);
        for (std::int32_t k = start[v]; k < start[v + 1]; ++k) {
            const std::uint64_t key = packed[static_cast<std::size_t>(k)];
            if (k == start[v] || (packed[static_cast<std::size_t>(k) - 1] >> 32) != (key >> 32)) edges.first.push_back(k);
            edges.half_edges[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(key & 0xffffffffu);
        }
    }
    edges.first.push_back(half_edge_count);
    return edges;
}

std::vector<std::int32_t> opposite_half_edges(const WallMesh& mesh, const MeshEdges& edges)
{
    std::vector<std::int32_t> opposite(3 * mesh.triangles.size(), -1);
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        if (uses.size() != 2) continue;
        opposite[static_cast<std::size_t>(uses[0])] = uses[1];
        opposite[static_cast<std::size_t>(uses[1])] = uses[0];
    }
    return opposite;
}

std::vector<std::vector<std::int32_t>> boundary_chains(const WallMesh& mesh, const MeshEdges& edges)
{
    constexpr std::size_t most_looked_at = 16;  // edges at a knot
    struct OpenEdge {
        std::int32_t from, to, triangle;
        bool used = false;
    };
    std::vector<OpenEdge> open;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        if (uses.size() == 1) open.push_back({half_edge_from(mesh, uses[0]), half_edge_to(mesh, uses[0]), uses[0] / 3});
    }
    std::sort(open.begin(), open.end(),
              [](const OpenEdge& a, const OpenEdge& b) { return a.from != b.from ? a.from < b.from : a.to < b.to; });
    std::vector<std::size_t> first(mesh.vertices.size(), open.size());  // of each vertex's edges that may be unused still
    for (std::size_t k = open.size(); k-- > 0;) first[static_cast<std::size_t>(open[k].from)] = k;
    const auto at = [&](std::int32_t v) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(v)]; };
    const auto facing = [&](const OpenEdge& e) { return double_area(triangle_of(mesh, static_cast<std::size_t>(e.triangle))); };
    // Turn at the end of an edge through the hole beside it, to another one. That of a slit may be a little below 0.
    const auto turn = [&](const OpenEdge& in, const OpenEdge& out) {
        const Vec3 normal = (facing(in) + facing(out)).normalized(), back = at(in.from) - at(in.to), on = at(out.to) - at(in.to);
        const double angle = std::atan2(back.cross(on).dot(normal), back.dot(on) - back.dot(normal) * on.dot(normal));
        return angle < -0.05 ? angle + 2 * std::numbers::pi : angle;
    };
    // Where holes meet in a corner, the edge that goes on along the same hole. @param in  null: none comes there
    auto unused_from = [&](std::int32_t vertex, const OpenEdge* in) -> OpenEdge* {
        std::size_t& k = first[static_cast<std::size_t>(vertex)];
        while (k < open.size() && open[k].from == vertex && open[k].used) ++k;
        if (k >= open.size() || open[k].from != vertex) return nullptr;
        OpenEdge* best = &open[k];
        for (std::size_t i = k + 1; in && i < std::min(open.size(), k + most_looked_at) && open[i].from == vertex; ++i)
            if (!open[i].used && turn(*in, open[i]) < turn(*in, *best)) best = &open[i];
        return best;
    };

    std::vector<std::int32_t> place(mesh.vertices.size(), -1);  // in the walk, -1: not on it
    std::vector<std::vector<std::int32_t>> chains;
    for (OpenEdge& seed : open) {
        if (seed.used) continue;
        std::vector<std::int32_t> walk = {seed.from};
        std::vector<const OpenEdge*> way;  // to each vertex of the walk but the first
        place[static_cast<std::size_t>(seed.from)] = 0;
        for (OpenEdge* edge = &seed; edge; edge = unused_from(walk.back(), way.empty() ? nullptr : way.back())) {
            edge->used = true;
            const std::int32_t seen = place[static_cast<std::size_t>(edge->to)];
            if (seen < 0) {
                place[static_cast<std::size_t>(edge->to)] = static_cast<std::int32_t>(walk.size());
                walk.push_back(edge->to), way.push_back(edge);
                continue;
            }
            chains.emplace_back(walk.begin() + seen, walk.end());  // a simple loop closes here; go on from its knot
            for (; walk.size() > static_cast<std::size_t>(seen) + 1; walk.pop_back(), way.pop_back())
                place[static_cast<std::size_t>(walk.back())] = -1;
        }
        for (const std::int32_t v : walk) place[static_cast<std::size_t>(v)] = -1;
        // a walk that ends elsewhere than at its start runs into an edge of three or more triangles: no opening
    }
    return chains;
}

namespace {

/// Centre, radius and direction of the loop through these vertices.
void measure_loop(const WallMesh& mesh, const std::vector<std::int32_t>& vertices, BoundaryLoop& loop)
{
    auto at = [&](std::size_t i) -> const Vec3& {
        return mesh.vertices[static_cast<std::size_t>(vertices[i % vertices.size()])];
    };
    // centre weighted by edge length, so that uneven spacing does not pull it aside
    double perimeter = 0;
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const double length = (at(i + 1) - at(i)).norm();
        sum += length * 0.5 * (at(i) + at(i + 1));
        perimeter += length;
    }
    loop.centre = perimeter > 0 ? Vec3(sum / perimeter) : at(0);
    Vec3 area = Vec3::Zero();  // vector area, sum of (a - c) x (b - c) / 2
    double distance = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        area += 0.5 * (at(i) - loop.centre).cross(at(i + 1) - loop.centre);
        distance += (at(i) - loop.centre).norm();
    }
    loop.radius = distance / static_cast<double>(vertices.size());
    // the lid that would close the loop runs against it and faces the lumen: its area is minus the loop's
    loop.inward = area.norm() > 0 ? Vec3(-area.normalized()) : Vec3(Vec3::UnitX());
}

/// Whether points go round their middle in a plane without a gap of a quarter turn.
bool go_round(const WallMesh& mesh, const std::vector<std::int32_t>& vertices, const Vec3& normal)
{
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t v : vertices)
        middle += mesh.vertices[static_cast<std::size_t>(v)] / static_cast<double>(vertices.size());
    const Vec3 u = normal.unitOrthogonal(), w = normal.cross(u);
    std::vector<double> turn;
    for (const std::int32_t v : vertices) {
        const Vec3 to = mesh.vertices[static_cast<std::size_t>(v)] - middle;
        turn.push_back(std::atan2(to.dot(w), to.dot(u)));
    }
    std::sort(turn.begin(), turn.end());
    double gap = turn.front() + 2 * std::numbers::pi - turn.back();
    for (std::size_t i = 1; i < turn.size(); ++i) gap = std::max(gap, turn[i] - turn[i - 1]);
    return gap < 0.5 * std::numbers::pi;
}

/// Area vectors of the wall at these vertices: zeros of a loop that is small against the mesh, which may have thousands.
std::unordered_map<std::int32_t, Vec3> wall_at(const WallMesh& mesh, const std::vector<std::int32_t>& vertices)
{
    constexpr std::size_t most_triangles = 2000;  // for each vertex
    std::unordered_map<std::int32_t, Vec3> wall;
    for (const std::int32_t v : vertices) wall.emplace(v, Vec3::Zero());
    if (mesh.triangles.size() > most_triangles * vertices.size()) return wall;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::int32_t v : mesh.triangles[t])
            if (const auto found = wall.find(v); found != wall.end()) found->second += double_area(triangle_of(mesh, t));
    return wall;
}

/// The vertices of a rim without those of a flap that stands far out of it: the plane through three of them that most
/// lie in, those not counted whose wall lies in that plane, too: a flap's own outline. Empty where there is no such flap.
std::vector<std::int32_t> without_flap(const WallMesh& mesh, const BoundaryLoop& loop)
{
    constexpr double thickness = 0.15;  // of the plane, in radii: a cut between triangles is a zigzag
    constexpr double stands_out = 0.75;
    constexpr std::size_t fewest = 8;
    constexpr double along_plane = 0.7;  // cosine: the wall at a rim stands on the rim's plane
    const std::size_t count = loop.vertices.size();
    if (count < fewest) return {};
    const std::unordered_map<std::int32_t, Vec3> wall = wall_at(mesh, loop.vertices);
    const auto at = [&](std::size_t i) -> const Vec3& {
        return mesh.vertices[static_cast<std::size_t>(loop.vertices[i % count])];
    };
    std::vector<std::int32_t> best;
    for (const std::size_t part : {3, 4, 6, 8})
        for (std::size_t k = 0; k < std::min<std::size_t>(count, 48); ++k) {
            const std::size_t i = k * count / std::min<std::size_t>(count, 48);
            const Vec3 &a = at(i), &b = at(i + count / part), &c = at(i + 2 * count / part), middle = (a + b + c) / 3;
            const Vec3 area = (b - a).cross(c - a);
            if (!(area.norm() > 0)) continue;
            const Vec3 normal = area.normalized();
            std::vector<std::int32_t> in;
            double out = 0;
            for (std::size_t v = 0; v < count; ++v) {
                const double away = std::abs((at(v) - middle).dot(normal));
                const Vec3& facing = wall.at(loop.vertices[v]);
                if (away < thickness * loop.radius && std::abs(facing.dot(normal)) <= along_plane * facing.norm())
                    in.push_back(loop.vertices[v]);
                out = std::max(out, away);
            }
            if (in.size() > best.size() && in.size() >= fewest && out > stands_out * loop.radius && go_round(mesh, in, normal))
                best = std::move(in);
        }
    return best;
}

}  // namespace

double rim_height(const WallMesh& mesh, const BoundaryLoop& loop, std::int32_t* vertex)
{
    double highest = 0;
    for (const std::int32_t v : loop.vertices) {
        const double away = std::abs((mesh.vertices[static_cast<std::size_t>(v)] - loop.centre).dot(loop.inward));
        if (away > highest && vertex) *vertex = v;
        highest = std::max(highest, away);
    }
    return highest;
}

BoundaryLoop describe_loop(const WallMesh& mesh, std::vector<std::int32_t> vertices)
{
    BoundaryLoop loop;
    measure_loop(mesh, vertices, loop);
    loop.vertices = std::move(vertices);
    if (rim_height(mesh, loop) > 0.4 * loop.radius)
        if (const std::vector<std::int32_t> rim = without_flap(mesh, loop); !rim.empty()) measure_loop(mesh, rim, loop);
    return loop;
}

}  // namespace seldinger

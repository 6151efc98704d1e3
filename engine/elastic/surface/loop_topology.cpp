// Neighbourhoods in a control mesh, checks that it is a manifold, and one round of Loop subdivision as rows of weights.
#include "surface/loop_topology.h"

#include "core/check.h"
#include "core/error.h"
#include "vessel/mesh_edges.h"
#include "vessel/triangle_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace seldinger {
namespace {

[[noreturn]] void refuse_mesh(const std::string& what) { throw Error(ErrorKind::BadFile, "control mesh of the wall: " + what); }

std::string name(const char* thing, std::int32_t index) { return std::string(thing) + " " + std::to_string(index); }

/// Indices in range and different, area not zero, edges of at most two triangles that run along it in opposite directions.
void check(const WallMesh& mesh)
{
    if (mesh.triangles.empty()) refuse_mesh("no triangles");
    const auto vertices = static_cast<std::int32_t>(mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::string me = name("triangle", static_cast<std::int32_t>(t));
        for (const std::int32_t v : mesh.triangles[t])
            if (v < 0 || v >= vertices) refuse_mesh(me + " names a vertex that is not there");
        const Triangle3 shape = triangle_of(mesh, t);
        const double longest = std::max({(shape.b - shape.a).norm(), (shape.c - shape.b).norm(), (shape.a - shape.c).norm()});
        if (!(double_area(shape).norm() > 1e-9 * longest * longest)) refuse_mesh(me + " has no area");
    }
    const MeshEdges edges = find_edges(mesh);
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        const auto edge = [&] {
            return "edge of vertices " + std::to_string(half_edge_from(mesh, uses[0])) + " and " +
                   std::to_string(half_edge_to(mesh, uses[0]));
        };
        if (uses.size() > 2)
            refuse_mesh(edge() + " has " + std::to_string(uses.size()) + " triangles, two at most can share one");
        if (uses.size() == 2 && half_edge_from(mesh, uses[0]) == half_edge_from(mesh, uses[1]))
            refuse_mesh("the triangles at the " + edge() + " face opposite sides; orient the mesh first");
    }
}

/// Rim vertices where the rim turns sharply.
std::vector<unsigned char> find_corners(const WallMesh& mesh, const LoopTopology& topology)
{
    const double sharp = std::cos(75 * std::numbers::pi / 180);
    std::vector<unsigned char> corner(mesh.vertices.size(), 0);
    std::array<std::int32_t, LoopTopology::max_valence + 1> fan;
    for (std::int32_t v = 0; v < topology.vertex_count(); ++v) {
        if (topology.kind[static_cast<std::size_t>(v)] == LoopVertex::Inner) continue;
        const int n = topology.fan(v, -1, fan);
        const auto at = [&](std::int32_t i) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(i)]; };
        const Vec3 in = at(v) - at(fan[static_cast<std::size_t>(n - 1)]), out = at(fan[0]) - at(v);
        if (in.dot(out) < sharp * in.norm() * out.norm()) corner[static_cast<std::size_t>(v)] = 1;
    }
    return corner;
}

LoopTopology checked(const WallMesh& mesh)
{
    check(mesh);
    const std::vector<unsigned char> none(mesh.vertices.size(), 0);
    LoopTopology topology(mesh.triangles, none);
    return LoopTopology(mesh.triangles, find_corners(mesh, topology));
}

}  // namespace

double loop_neighbour_weight(int n)
{
    const double c = 3.0 / 8 + std::cos(2 * std::numbers::pi / n) / 4;
    return (5.0 / 8 - c * c) / n;
}

double loop_limit_weight(int n) { return 1 / (n + 3 / (8 * loop_neighbour_weight(n))); }

LoopTopology::LoopTopology(const WallMesh& mesh) : LoopTopology(checked(mesh)) {}

LoopTopology::LoopTopology(std::vector<std::array<std::int32_t, 3>> of, std::span<const unsigned char> corner)
    : triangles(std::move(of))
{
    connect(static_cast<std::int32_t>(corner.size()));
    for (std::size_t v = 0; v < corner.size(); ++v)
        if (kind[v] == LoopVertex::Rim && (corner[v] || triangles_about[v] == 1)) kind[v] = LoopVertex::Corner;
}

void LoopTopology::connect(std::int32_t vertices)
{
    WallMesh mesh;
    mesh.vertices.resize(static_cast<std::size_t>(vertices));
    mesh.triangles = triangles;
    opposite = opposite_half_edges(mesh, find_edges(mesh));
    first.assign(static_cast<std::size_t>(vertices), -1);
    std::vector<int> count(static_cast<std::size_t>(vertices), 0);
    kind.assign(static_cast<std::size_t>(vertices), LoopVertex::Inner);
    for (std::int32_t h = 0; h < 3 * triangle_count(); ++h) {
        const auto v = static_cast<std::size_t>(from(h));
        ++count[v];
        if (opposite[static_cast<std::size_t>(h)] < 0) first[v] = h, kind[v] = LoopVertex::Rim;
        else if (first[v] < 0) first[v] = h;
    }
    triangles_about.assign(static_cast<std::size_t>(vertices), 0);
    for (std::int32_t v = 0; v < vertices; ++v) {
        const auto i = static_cast<std::size_t>(v);
        if (count[i] == 0) refuse_mesh(name("vertex", v) + " belongs to no triangle");
        if (count[i] > max_valence)
            refuse_mesh(name("vertex", v) + " has " + std::to_string(count[i]) + " triangles, " + std::to_string(max_valence) +
                   " at most");
        int walked = 0;
        std::int32_t h = first[i];
        do ++walked, h = turn(h);
        while (h >= 0 && h != first[i] && walked <= count[i]);
        if (walked != count[i]) refuse_mesh("two sheets touch in " + name("vertex", v));
        if (kind[i] == LoopVertex::Inner && count[i] < 3)
            refuse_mesh(name("vertex", v) + " has only two triangles, back to back");
        triangles_about[i] = static_cast<unsigned char>(count[i]);
    }
}

int LoopTopology::fan(std::int32_t v, std::int32_t start, std::span<std::int32_t> neighbours) const
{
    const std::size_t i = static_cast<std::size_t>(v);
    const bool inner = kind[i] == LoopVertex::Inner;
    std::int32_t h = inner && start >= 0 ? start : first[i];
    const int n = triangles_about[i];
    for (int k = 0; k < n; ++k) {
        neighbours[static_cast<std::size_t>(k)] = to(h);
        if (!inner && k == n - 1) neighbours[static_cast<std::size_t>(n)] = from(h - h % 3 + (h % 3 + 2) % 3);
        h = turn(h);
    }
    return inner ? n : n + 1;
}

LoopTopology::LimitMask LoopTopology::limit_mask(std::int32_t v) const
{
    LimitMask mask;
    const int n = fan(v, -1, mask.neighbours);
    switch (kind[static_cast<std::size_t>(v)]) {
        case LoopVertex::Corner:
            break;
        case LoopVertex::Rim:
            mask.neighbours[1] = mask.neighbours[static_cast<std::size_t>(n - 1)];
            mask.own = 2.0 / 3, mask.each = 1.0 / 6, mask.count = 2;
            break;
        case LoopVertex::Inner:
            mask.each = loop_limit_weight(n), mask.own = 1 - n * mask.each, mask.count = n;
    }
    return mask;
}

std::array<LoopPoint, 6> LoopTopology::ring(std::int32_t v, std::int32_t towards) const
{
    std::array<std::int32_t, 7> fanned;
    std::array<LoopPoint, 6> about;
    SEL_ASSERT(regular(v));
    if (fan(v, towards, fanned) == 6) {
        for (std::size_t k = 0; k < 6; ++k) about[k] = {fanned[k]};
        return about;
    }
    // four are real; reflections across the two rim edges close the ring
    const std::array<LoopPoint, 6> closed = {
        {{fanned[0]}, {fanned[1]}, {fanned[2]}, {fanned[3]}, {v, fanned[3], fanned[2]}, {v, fanned[0], fanned[1]}}};
    std::size_t shift = 0;
    while (shift < 3 && fanned[shift] != to(towards)) ++shift;
    for (std::size_t k = 0; k < 6; ++k) about[k] = closed[(k + shift) % 6];
    return about;
}

std::array<LoopPoint, 12> LoopTopology::patch(std::int32_t triangle) const
{
    const auto& corner = triangles[static_cast<std::size_t>(triangle)];
    const auto a = ring(corner[0], 3 * triangle), b = ring(corner[1], 3 * triangle + 1), c = ring(corner[2], 3 * triangle + 2);
    return {{{corner[0]}, {corner[1]}, {corner[2]}, a[5], b[5], a[2], a[3], a[4], b[3], b[4], c[3], c[4]}};
}

std::vector<std::int32_t> LoopTopology::corner_patch(std::int32_t triangle, int& place) const
{
    const auto& corner = triangles[static_cast<std::size_t>(triangle)];
    std::array<std::int32_t, max_valence + 1> around;
    const int n = fan(corner[0], 3 * triangle, around);
    std::vector<std::int32_t> points = {corner[0]};
    points.insert(points.end(), around.begin(), around.begin() + n);
    place = 0;
    while (around[static_cast<std::size_t>(place)] != corner[1]) ++place;
    const auto b = ring(corner[1], 3 * triangle + 1), c = ring(corner[2], 3 * triangle + 2);
    for (const LoopPoint& p : {b[3], b[4], b[5], c[3], c[4]})
        if (!p.phantom()) points.push_back(p.a);
    return points;
}

namespace {

/// Rows of weights, one after another.
struct Rows {
    LoopRefinement& to;
    void add(std::int32_t vertex, double weight) { to.vertex.push_back(vertex), to.weight.push_back(weight); }
    void end() { to.first.push_back(static_cast<std::int32_t>(to.vertex.size())); }
};

void vertex_row(const LoopTopology& coarse, std::int32_t v, Rows& rows)
{
    std::array<std::int32_t, LoopTopology::max_valence + 1> around;
    const int n = coarse.fan(v, -1, around);
    switch (coarse.kind[static_cast<std::size_t>(v)]) {
        case LoopVertex::Corner:
            rows.add(v, 1);
            break;
        case LoopVertex::Rim:
            rows.add(v, 0.75), rows.add(around[0], 0.125), rows.add(around[static_cast<std::size_t>(n - 1)], 0.125);
            break;
        case LoopVertex::Inner: {
            const double w = loop_neighbour_weight(n);
            rows.add(v, 1 - n * w);
            for (int k = 0; k < n; ++k) rows.add(around[static_cast<std::size_t>(k)], w);
        }
    }
    rows.end();
}

void edge_row(const LoopTopology& coarse, std::span<const std::int32_t> uses, Rows& rows)
{
    const double end = uses.size() == 2 ? 0.375 : 0.5;
    rows.add(coarse.from(uses[0]), end), rows.add(coarse.to(uses[0]), end);
    if (uses.size() == 2)
        for (const std::int32_t h : uses) rows.add(coarse.from(h - h % 3 + (h % 3 + 2) % 3), 0.125);
    rows.end();
}

}  // namespace

LoopRefinement refine(const LoopTopology& coarse)
{
    WallMesh mesh;
    mesh.vertices.resize(static_cast<std::size_t>(coarse.vertex_count()));
    mesh.triangles = coarse.triangles;
    const MeshEdges edges = find_edges(mesh);
    std::vector<std::int32_t> middle(3 * mesh.triangles.size());
    for (std::size_t k = 0; k < edges.count(); ++k)
        for (const std::int32_t h : edges.uses(k))
            middle[static_cast<std::size_t>(h)] = coarse.vertex_count() + static_cast<std::int32_t>(k);
    std::vector<std::array<std::int32_t, 3>> children;
    children.reserve(4 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::int32_t* m = &middle[3 * t];
        for (std::size_t c = 0; c < 3; ++c) children.push_back({mesh.triangles[t][c], m[c], m[(c + 2) % 3]});
        children.push_back({m[1], m[2], m[0]});
    }
    std::vector<unsigned char> corner(mesh.vertices.size() + edges.count(), 0);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) corner[v] = coarse.kind[v] == LoopVertex::Corner;
    LoopRefinement fine{LoopTopology(std::move(children), corner), {0}, {}, {}};
    Rows rows{fine};
    for (std::int32_t v = 0; v < coarse.vertex_count(); ++v) vertex_row(coarse, v, rows);
    for (std::size_t k = 0; k < edges.count(); ++k) edge_row(coarse, edges.uses(k), rows);
    return fine;
}

}  // namespace seldinger

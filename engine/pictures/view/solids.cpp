// Tubes, balls and cones as triangles along smooth curves through the nodes.
#include "view/solids.h"

#include "core/check.h"
#include "rod/transport.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

constexpr int ring_count = 14;  // facets around a tube: at 40 pixels across the outline is still within 0.5 pixel
constexpr int cap_rings = 4;

Vec3 any_normal(const Vec3& axis) { return axis.unitOrthogonal(); }

SolidVertex make_vertex(const Vec3& p, const Vec3& n, const Rgb& c, double pull)
{
    return {{static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())},
            {static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())},
            {c.r, c.g, c.b},
            static_cast<float>(pull)};
}

/// One ring: centre, two directors, radius; the normal leans by `lean` (sine) along the axis, for caps and cones.
struct Ring {
    Vec3 centre, d1, d2, axis;
    double radius, lean, pull;
};

/// Consecutive rings of one body, skinned with triangles.
void add_skin(Solids& solids, std::span<const Ring> rings, const Rgb& colour, const Vec3& origin)
{
    const auto first = static_cast<std::uint32_t>(solids.vertices.size());
    for (const Ring& ring : rings) {
        const double flat = std::sqrt(std::max(0.0, 1 - ring.lean * ring.lean));
        for (int k = 0; k < ring_count; ++k) {
            const double angle = 2 * std::numbers::pi * k / ring_count;
            const Vec3 out = std::cos(angle) * ring.d1 + std::sin(angle) * ring.d2;
            solids.vertices.push_back(
                make_vertex(ring.centre + ring.radius * out - origin, flat * out + ring.lean * ring.axis, colour, ring.pull));
        }
    }
    for (std::uint32_t r = 0; r + 1 < rings.size(); ++r) {
        for (std::uint32_t k = 0; k < ring_count; ++k) {
            const std::uint32_t a = first + r * ring_count + k, b = first + r * ring_count + (k + 1) % ring_count;
            const std::uint32_t c = a + ring_count, d = b + ring_count;
            solids.indices.insert(solids.indices.end(), {a, b, c, b, d, c});
        }
    }
}

/// Rings of a half sphere; side -1: the beginning (pole first), +1: the end (pole last).
void add_cap(std::vector<Ring>& rings, const Ring& edge, int side)
{
    for (int i = 0; i < cap_rings; ++i) {
        const double share = static_cast<double>(side < 0 ? cap_rings - i : i + 1) / cap_rings;
        const double angle = 0.5 * std::numbers::pi * share;
        Ring ring = edge;
        ring.centre += side * edge.radius * std::sin(angle) * edge.axis;
        ring.radius = edge.radius * std::cos(angle);
        ring.lean = side * std::sin(angle);
        rings.push_back(ring);
    }
}

Vec3 tangent_at(std::span<const TubeStation> line, std::size_t i)
{
    const Vec3& before = line[i > 0 ? i - 1 : 0].position;
    const Vec3& after = line[std::min(i + 1, line.size() - 1)].position;
    const Vec3 chord = after - before;
    const double length = chord.norm();
    return length > 0 ? Vec3(chord / length) : Vec3::UnitX();
}

/// dx/ds at node i from the parabola through its neighbours, s being chord length.
Vec3 three_point_slope(std::span<const Vec3> x, std::size_t i)
{
    const std::size_t n = x.size();
    const auto slope = [&](std::size_t a) {
        const double length = (x[a + 1] - x[a]).norm();
        return length > 0 ? Vec3((x[a + 1] - x[a]) / length) : Vec3(Vec3::Zero());
    };
    if (n < 3) return slope(0);
    const std::size_t mid = std::clamp<std::size_t>(i, 1, n - 2);
    const double before = (x[mid] - x[mid - 1]).norm(), after = (x[mid + 1] - x[mid]).norm();
    if (before + after <= 0) return Vec3::Zero();
    const Vec3 at_mid = (after * slope(mid - 1) + before * slope(mid)) / (before + after);
    if (i == 0) return 2 * slope(0) - at_mid;
    if (i == n - 1) return 2 * slope(n - 2) - at_mid;
    return at_mid;
}

}  // namespace

std::vector<TubeStation> smooth_line(std::span<const Vec3> nodes, std::span<const double> radius)
{
    SEL_ASSERT(nodes.size() == radius.size());
    std::vector<TubeStation> line;
    if (nodes.empty()) return line;
    constexpr double piece_turn = 6.0 * std::numbers::pi / 180.0;
    for (std::size_t j = 0; j + 1 < nodes.size(); ++j) {
        const Vec3 chord = nodes[j + 1] - nodes[j];
        const double length = chord.norm();
        if (!(length > 0)) continue;  // repeated node
        const Vec3 start = length * three_point_slope(nodes, j), end = length * three_point_slope(nodes, j + 1);
        const double turn = std::atan2(start.cross(end).norm(), start.dot(end));
        const int pieces = std::clamp(static_cast<int>(std::ceil(turn / piece_turn)), 1, 24);
        for (int k = 0; k < pieces; ++k) {
            const double t = static_cast<double>(k) / pieces, u = 1 - t;
            const Vec3 p =
                u * u * (1 + 2 * t) * nodes[j] + t * u * u * start - t * t * u * end + t * t * (3 - 2 * t) * nodes[j + 1];
            line.push_back({p, u * radius[j] + t * radius[j + 1], 0});
        }
    }
    line.push_back({nodes.back(), radius.back(), 0});
    return line;
}

void add_tube(Solids& solids, std::span<const TubeStation> line, const Rgb& colour, const Vec3& origin)
{
    if (line.size() < 2) {
        if (!line.empty()) add_ball(solids, line.front(), colour, origin);
        return;
    }
    std::vector<Ring> rings;
    rings.reserve(line.size() + 2 * cap_rings);
    Vec3 axis = tangent_at(line, 0), d1 = any_normal(axis);
    for (std::size_t i = 0; i < line.size(); ++i) {
        const Vec3 next = tangent_at(line, i);
        d1 = carried_director(d1, axis, next);
        axis = next;
        const Ring ring = {line[i].position, d1, axis.cross(d1), axis, line[i].radius, 0, line[i].pull};
        if (i == 0) add_cap(rings, ring, -1);
        rings.push_back(ring);
        if (i + 1 == line.size()) add_cap(rings, ring, +1);
    }
    add_skin(solids, rings, colour, origin);
}

void add_tube(Solids& solids, std::span<const TubeStation> line, std::span<const Rgb> colours, const Vec3& origin)
{
    SEL_ASSERT(colours.size() == line.size());
    if (line.empty()) return;
    const std::size_t first = solids.vertices.size();
    add_tube(solids, line, colours.front(), origin);
    if (line.size() < 2) return;
    for (std::size_t v = first; v < solids.vertices.size(); ++v) {
        const auto ring = static_cast<std::ptrdiff_t>((v - first) / ring_count) - cap_rings;
        const auto last = static_cast<std::ptrdiff_t>(colours.size()) - 1;
        const Rgb& c = colours[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(ring, 0, last))];
        solids.vertices[v].colour[0] = c.r, solids.vertices[v].colour[1] = c.g, solids.vertices[v].colour[2] = c.b;
    }
}

void add_ball(Solids& solids, const TubeStation& ball, const Rgb& colour, const Vec3& origin)
{
    const Ring equator = {ball.position, Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), ball.radius, 0, ball.pull};
    std::vector<Ring> rings;
    add_cap(rings, equator, -1);
    rings.push_back(equator);
    add_cap(rings, equator, +1);
    add_skin(solids, rings, colour, origin);
}

void add_cone(Solids& solids, const TubeStation& base, const Vec3& end, const Rgb& colour, const Vec3& origin)
{
    const Vec3 along = end - base.position;
    const double length = along.norm();
    if (!(length > 0)) return;
    const Vec3 axis = along / length, d1 = any_normal(axis), d2 = axis.cross(d1);
    const double lean = base.radius / std::hypot(base.radius, length);
    const Ring rings[] = {{base.position, d1, d2, axis, 0, -1, base.pull},  // floor
                          {base.position, d1, d2, axis, base.radius, -1, base.pull},
                          {base.position, d1, d2, axis, base.radius, lean, base.pull},
                          {end, d1, d2, axis, 0, lean, base.pull}};
    add_skin(solids, rings, colour, origin);
}

// Vertices of the wall with their normals.

namespace {

/// Area-weighted; upwards where a vertex has no triangle.
std::vector<Vec3> vertex_normals(const std::vector<Vec3>& vertices, const std::vector<std::array<std::int32_t, 3>>& triangles)
{
    std::vector<Vec3> normals(vertices.size(), Vec3::Zero());
    for (const auto& t : triangles) {
        const Vec3& a = vertices[t[0]];
        const Vec3 area = (vertices[t[1]] - a).cross(vertices[t[2]] - a);
        for (int k : t) normals[k] += area;
    }
    for (Vec3& n : normals) n = n.squaredNorm() > 0 ? Vec3(n.normalized()) : Vec3::UnitZ();
    return normals;
}

}  // namespace

std::vector<float> interleaved_wall(const std::vector<Vec3>& vertices, const std::vector<std::array<std::int32_t, 3>>& triangles,
                                    std::span<const float> share, const Vec3& origin)
{
    const std::vector<Vec3> normals = vertex_normals(vertices, triangles);
    std::vector<float> list(7 * vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3 p = vertices[i] - origin;
        for (int k = 0; k < 3; ++k) {
            list[7 * i + k] = static_cast<float>(p[k]);
            list[7 * i + 3 + k] = static_cast<float>(normals[i][k]);
        }
        if (!share.empty()) list[7 * i + 6] = share[i];
    }
    return list;
}

}  // namespace seldinger

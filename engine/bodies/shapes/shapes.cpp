// Tube, arc and plane as triangle meshes.
#include "shapes/shapes.h"

#include "core/error.h"
#include "vessel/triangle_geometry.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

constexpr int kDefaultTriangles = 20000;
constexpr int most_triangles = 50'000'000;  // vertex indices are 32 bits

void require_positive(double value, const char* key)
{
    if (!(value > 0) || !std::isfinite(value))
        throw Error(ErrorKind::BadScene, fmt::format("vessel.{}: got {}; expected a finite length above 0", key, value));
}

int wanted_triangles(const VesselSpec& spec)
{
    if (spec.triangles < 0 || spec.triangles > most_triangles)
        throw Error(ErrorKind::BadScene,
                    fmt::format("vessel.triangles: got {}; expected 0 (default) to {}", spec.triangles, most_triangles));
    return spec.triangles == 0 ? kDefaultTriangles : spec.triangles;
}

Vec3 unit(const Vec3& v, const char* key)
{
    const double length = v.norm();
    if (!(length > 0) || !std::isfinite(length))
        throw Error(ErrorKind::BadScene, fmt::format("vessel.{}: got zero; expected a direction", key));
    return v / length;
}

/// One cross-section: its centre and the two directions that span it.
struct TubeRing {
    Vec3 centre, u, v;
};

/// Joins rings of `around` vertices into a wall that faces its axis. Diagonals alternate, so that the mesh has no handedness.
GeneratedVessel sweep(const std::vector<TubeRing>& rings, double radius, int around)
{
    GeneratedVessel result;
    result.mesh.vertices.reserve(rings.size() * static_cast<std::size_t>(around));
    for (const TubeRing& ring : rings) {
        for (int k = 0; k < around; ++k) {
            const double phi = 2 * std::numbers::pi * k / around;
            result.mesh.vertices.push_back(ring.centre + radius * (std::cos(phi) * ring.u + std::sin(phi) * ring.v));
        }
        result.centreline.parent.push_back(static_cast<int>(result.centreline.points.size()) - 1);
        result.centreline.points.push_back(ring.centre);
        result.centreline.radius.push_back(radius);
    }
    for (int row = 0; row + 1 < static_cast<int>(rings.size()); ++row)
        for (int k = 0; k < around; ++k) {
            const int a = row * around + k, b = row * around + (k + 1) % around, c = b + around, d = a + around;
            if ((row + k) % 2 == 0) result.mesh.triangles.insert(result.mesh.triangles.end(), {{{a, c, b}}, {{a, d, c}}});
            else result.mesh.triangles.insert(result.mesh.triangles.end(), {{{a, d, b}}, {{b, d, c}}});
        }
    return result;
}

/// Facets around and the edge length along for `triangles` right triangles with equal legs on a tube of this size.
struct Facets {
    int around;
    double edge;  // [m]
};
Facets facets_of(double radius, double length, int triangles, const char* key)
{
    const double edge = std::sqrt(2 * 2 * std::numbers::pi * radius * length / triangles),
                 facets = 2 * std::numbers::pi * radius / edge;
    // as many around as there are triangles in all: half a row would be the whole tube
    if (!(facets <= std::max(8, triangles)))
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: {} m of {} m radius is shorter than a facet of {} triangles; expected a longer vessel, "
                                "or check the units (metres)",
                                key, length, radius, triangles));
    const int around = 4 * std::max(2, static_cast<int>(std::lround(2 * std::numbers::pi * radius / edge / 4)));
    const double rows = std::max(1.0, std::round(triangles / (2.0 * around)));
    return {around, length / rows};
}

int rows_of(double length, double edge) { return std::max(1, static_cast<int>(std::lround(length / edge))); }

}  // namespace

GeneratedVessel make_tube(const VesselSpec& spec)
{
    require_positive(spec.radius, "radius_m");
    require_positive(spec.length, "length_m");
    const Vec3 axis = unit(spec.axis, "axis");
    const CrossFrame frame = cross_frame(axis, unit(spec.normal, "normal"));
    const Facets facets = facets_of(spec.radius, spec.length, wanted_triangles(spec), "vessel.length_m");
    const int rows = rows_of(spec.length, facets.edge);
    std::vector<TubeRing> rings;
    for (int k = 0; k <= rows; ++k) rings.push_back({spec.origin + axis * (spec.length * k / rows), frame.u, frame.v});
    return sweep(rings, spec.radius, facets.around);
}

GeneratedVessel make_arc(const VesselSpec& spec)
{
    require_positive(spec.radius, "radius_m");
    require_positive(spec.bend_radius, "bend_radius_m");
    require_positive(spec.angle, "angle_deg");
    if (!(spec.lead_in >= 0) || !(spec.lead_out >= 0))
        throw Error(ErrorKind::BadScene, "vessel.lead_in_m, vessel.lead_out_m: expected lengths of 0 or more");
    if (spec.bend_radius <= spec.radius)
        throw Error(ErrorKind::BadScene,
                    fmt::format("vessel.bend_radius_m: got {} m; expected more than radius_m = {} m, or the tube cuts itself",
                                spec.bend_radius, spec.radius));
    const Vec3 axis = unit(spec.axis, "axis");
    const CrossFrame frame = cross_frame(axis, unit(spec.normal, "normal"));
    const double bend_length = spec.bend_radius * spec.angle;
    const Facets facets =
        facets_of(spec.radius, spec.lead_in + bend_length + spec.lead_out, wanted_triangles(spec), "vessel.angle_deg");

    const Vec3 bend_start = spec.origin + axis * spec.lead_in;
    auto on_bend = [&](double angle) {  // u turns with the tangent, v is the axis of the bend
        const Vec3 u = frame.u * std::cos(angle) - axis * std::sin(angle);
        return TubeRing{bend_start + spec.bend_radius * (frame.u - u), u, frame.v};
    };
    std::vector<TubeRing> rings = {{spec.origin, frame.u, frame.v}};
    const int rows_in = rows_of(spec.lead_in, facets.edge), rows_bend = rows_of(bend_length, facets.edge),
              rows_out = rows_of(spec.lead_out, facets.edge);
    if (spec.lead_in > 0)
        for (int k = 1; k <= rows_in; ++k) rings.push_back({spec.origin + axis * (spec.lead_in * k / rows_in), frame.u, frame.v});
    for (int k = 1; k <= rows_bend; ++k) rings.push_back(on_bend(spec.angle * k / rows_bend));
    const TubeRing end = rings.back();
    if (spec.lead_out > 0)
        for (int k = 1; k <= rows_out; ++k)
            rings.push_back({end.centre + end.u.cross(end.v) * (spec.lead_out * k / rows_out), end.u, end.v});
    return sweep(rings, spec.radius, facets.around);
}

GeneratedVessel make_plane(const VesselSpec& spec)
{
    require_positive(spec.size, "size_m");
    const Vec3 normal = unit(spec.normal, "normal");
    const CrossFrame frame = cross_frame(normal, spec.axis);
    const int n = std::max(1, static_cast<int>(std::lround(std::sqrt(wanted_triangles(spec) / 2.0))));
    GeneratedVessel result;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            result.mesh.vertices.push_back(spec.origin + spec.size * ((static_cast<double>(i) / n - 0.5) * frame.u +
                                                                      (static_cast<double>(j) / n - 0.5) * frame.v));
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
            if ((i + j) % 2 == 0) result.mesh.triangles.insert(result.mesh.triangles.end(), {{{a, b, c}}, {{a, c, d}}});
            else result.mesh.triangles.insert(result.mesh.triangles.end(), {{{a, b, d}}, {{b, c, d}}});
        }
    return result;
}

}  // namespace seldinger

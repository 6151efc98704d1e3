// Makes the .vtp text of the wire (with radius, curvature, material coordinate), of the contacts and of the wall.
#include "run/frames.h"

#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace seldinger {

std::string frame_name(const std::string& stem, std::int64_t step) { return fmt::format("{}_{:06}.vtp", stem, step); }

std::string series_of(const Scene& scene, int instrument)
{
    const std::string& label = scene.instrument(instrument).label;
    return label.empty() ? "wire" : label;
}

std::string wire_vtp(const WireOutput& wire)
{
    VtpWriter out(wire.position);
    out.set_line();
    out.add_point_data("radius", 1, wire.radius);
    out.add_point_data("material_s", 1, wire.material_s);
    out.add_point_data("curvature", 1, wire.curvature);
    out.add_point_data("spin", 1, wire.spin);
    out.add_point_vectors("director", wire.director);
    out.add_point_vectors("contact_force", wire.contact_force);
    out.add_point_vectors("velocity", wire.velocity);
    return out.bytes();
}

std::string contacts_vtp(std::span<const ContactRow> rows)
{
    using Place = std::tuple<int, BodyKind, int>;
    std::vector<Place> places;
    std::vector<Vec3> points, normal, friction;
    std::vector<double> force, gap, stuck, per_length, along, length, place, body_a, body_b;
    for (const ContactRow& row : rows) {
        points.push_back(row.point);
        normal.push_back(row.normal);
        friction.push_back(row.friction);
        force.push_back(row.normal_force);
        gap.push_back(row.gap);
        stuck.push_back(row.stuck ? 1 : 0);
        per_length.push_back(row.per_length);
        along.push_back(row.along_a);
        length.push_back(row.length);
        body_a.push_back(row.a.body);
        body_b.push_back(row.b.kind == BodyKind::Wall ? -1 : row.b.body);
        // of whatever it is that lies on whatever: two instruments on the wall side by side are two places
        const auto found = std::find(places.begin(), places.end(), Place{row.a.body, row.b.kind, row.region});
        place.push_back(static_cast<double>(1 + (found - places.begin())));
        if (found == places.end()) places.push_back({row.a.body, row.b.kind, row.region});
    }
    VtpWriter out(points);
    out.set_verts();
    out.add_point_data("normal_n", 1, force);
    out.add_point_vectors("normal", normal);
    out.add_point_data("gap", 1, gap);
    out.add_point_vectors("friction", friction);
    out.add_point_data("stuck", 1, stuck);
    out.add_point_data("force_per_length", 1, per_length);
    out.add_point_data("along", 1, along);
    out.add_point_data("length", 1, length);
    out.add_point_data("place", 1, place);
    out.add_point_data("body_a", 1, body_a);
    out.add_point_data("body_b", 1, body_b);
    return out.bytes();
}

std::string wall_vtp(const WallMesh& mesh)
{
    VtpWriter out(mesh.vertices);
    out.set_polys(mesh.triangles);
    return out.bytes();
}

std::string moved_wall_vtp(const WallMesh& mesh, const WallOutput& wall)
{
    std::vector<Vec3> now(mesh.vertices);
    for (std::size_t v = 0; v < now.size(); ++v) now[v] += wall.displacement[v];
    VtpWriter out(now);
    out.set_polys(mesh.triangles);
    out.add_point_vectors("displacement", wall.displacement);
    out.add_point_data("stress", 1, wall.stress);
    return out.bytes();
}

}  // namespace seldinger

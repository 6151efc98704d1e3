// Makes the .vtp text of the wire (with radius, curvature, material coordinate), of the contacts and of the wall.
#include "scene/frames.h"

#include "rod/curvature.h"

#include <fmt/format.h>
#include <algorithm>

namespace seldinger {
namespace {

/// Curvature of (D2) per Voronoi length [1/m].
double curvature_at(const RodView& rod, int node)
{
    if (node == 0 || node == rod.n - 1) return 0;
    const Vec3 e = rod.pos(node) - rod.pos(node - 1), f = rod.pos(node + 1) - rod.pos(node);
    const double chi = 1 + e.dot(f) / (e.norm() * f.norm());
    return curvature_factor(curvature_q(rod.curvature), chi) * 2 * e.cross(f).norm() /
           (chi * e.norm() * f.norm() * rod.voronoi_length(node));
}

}  // namespace

std::string frame_name(const char* stem, std::int64_t step) { return fmt::format("{}_{:06}.vtp", stem, step); }

std::string wire_vtp(const World& world)
{
    const RodView rod = world.rod(0);
    std::vector<Vec3> points, velocity;
    std::vector<double> radius, curvature;
    for (int i = 0; i < rod.n; ++i) {
        points.push_back(rod.pos(i));
        velocity.push_back(rod.vel(i));
        radius.push_back(rod.radius[std::min(i, rod.n - 2)]);
        curvature.push_back(curvature_at(rod, i));
    }
    VtpWriter out(points);
    out.set_line();
    out.add_point_data("radius", 1, radius);
    out.add_point_data("material_s", 1, {rod.material_s.data(), points.size()});
    out.add_point_data("curvature", 1, curvature);
    out.add_point_vectors("contact_force", world.nodal_contact_force(0));
    out.add_point_vectors("velocity", velocity);
    return out.bytes();
}

std::string contacts_vtp(std::span<const ContactRow> rows)
{
    std::vector<Vec3> points, normal, friction;
    std::vector<double> force, gap, stuck;
    for (const ContactRow& row : rows) {
        points.push_back(row.point);
        normal.push_back(row.normal);
        friction.push_back(row.friction);
        force.push_back(row.normal_force);
        gap.push_back(row.gap);
        stuck.push_back(row.stuck ? 1 : 0);
    }
    VtpWriter out(points);
    out.set_verts();
    out.add_point_data("normal_n", 1, force);
    out.add_point_vectors("normal", normal);
    out.add_point_data("gap", 1, gap);
    out.add_point_vectors("friction", friction);
    out.add_point_data("stuck", 1, stuck);
    return out.bytes();
}

std::string wall_vtp(const WallMesh& mesh)
{
    VtpWriter out(mesh.vertices);
    out.set_polys(mesh.triangles);
    return out.bytes();
}

}  // namespace seldinger

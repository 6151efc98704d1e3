// Volumes of components by the divergence theorem.
#include "vessel/mesh_components.h"

#include "vessel/triangle_geometry.h"

#include <algorithm>

namespace seldinger {

std::vector<std::int32_t> label_components(const WallMesh& mesh, const MeshEdges& edges)
{
    return label_sets(mesh, edges, [](std::span<const std::int32_t>) { return true; });
}

std::vector<std::int32_t> labels_of_vertices(const WallMesh& mesh, const std::vector<std::int32_t>& label)
{
    std::vector<std::int32_t> of_vertex(mesh.vertices.size(), -1);
    for (std::size_t t = 0; t < label.size(); ++t)
        for (const std::int32_t v : mesh.triangles[t]) of_vertex[static_cast<std::size_t>(v)] = label[t];
    return of_vertex;
}

std::vector<bool> vertices_of_largest(const WallMesh& mesh, const std::vector<std::int32_t>& label)
{
    std::vector<double> area;
    for (std::size_t t = 0; t < label.size(); ++t) {
        const auto c = static_cast<std::size_t>(label[t]);
        if (c >= area.size()) area.resize(c + 1, 0.0);
        area[c] += 0.5 * double_area(triangle_of(mesh, t)).norm();
    }
    if (area.size() < 2) return {};
    const auto largest = static_cast<std::int32_t>(std::max_element(area.begin(), area.end()) - area.begin());
    std::vector<bool> in_it(mesh.vertices.size(), false);
    for (std::size_t t = 0; t < label.size(); ++t)
        for (const std::int32_t v : mesh.triangles[t])
            if (label[t] == largest) in_it[static_cast<std::size_t>(v)] = true;
    return in_it;
}

std::vector<MeshComponent> measure_components(const WallMesh& mesh, const MeshEdges& edges,
                                              const std::vector<std::int32_t>& label)
{
    std::vector<MeshComponent> components;
    for (std::size_t t = 0; t < label.size(); ++t) {
        const auto c = static_cast<std::size_t>(label[t]);
        if (c >= components.size()) components.resize(c + 1);
        components[c].triangles.push_back(static_cast<std::int32_t>(t));
    }
    for (MeshComponent& part : components) {
        for (const std::int32_t t : part.triangles)
            for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)])
                part.box.extend(mesh.vertices[static_cast<std::size_t>(v)]);
        const Vec3 centre = part.box.center();  // volumes of thin parts far from the origin would drown in rounding
        for (const std::int32_t t : part.triangles) {
            const Triangle3 tri = triangle_of(mesh, static_cast<std::size_t>(t));
            const Vec3 area = double_area(tri);
            part.area += 0.5 * area.norm();
            part.volume += (tri.a - centre).dot(area) / 6;
        }
    }
    const std::vector<std::int32_t> vertex_label = labels_of_vertices(mesh, label);
    for (const auto& chain : boundary_chains(mesh, edges)) {
        MeshComponent& part = components[static_cast<std::size_t>(vertex_label[static_cast<std::size_t>(chain[0])])];
        const Vec3 origin = part.box.center(), top = describe_loop(mesh, chain).centre - origin;
        for (std::size_t i = 0; i < chain.size(); ++i) {
            const Vec3 from = mesh.vertices[static_cast<std::size_t>(chain[i])] - origin;
            const Vec3 to = mesh.vertices[static_cast<std::size_t>(chain[(i + 1) % chain.size()])] - origin;
            part.volume += to.dot(from.cross(top)) / 6;  // the lid runs against the loop
        }
    }
    return components;
}

}  // namespace seldinger

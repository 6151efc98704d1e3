// The bumpy tube of the host-reference tests and their contexts, made once.
#include "contact/host_reference_support.h"

#include "contact/contact_system.h"
#include "shapes/shapes.h"

#include <cmath>
#include <memory>

namespace seldinger::test {

namespace {

WallMesh bumpy_tube(double radius, double length)
{
    VesselSpec spec{.shape = VesselShape::Tube, .radius = radius, .length = length, .triangles = 3000};
    WallMesh mesh = make_tube(spec).mesh;
    for (Vec3& v : mesh.vertices) v *= 1 + 0.01 * std::sin(900 * v.x()) * std::cos(800 * v.y());
    const auto add = [&](int a, int b, int c) { mesh.triangles.push_back({a, b, c}); };
    for (int k = 0; k < 40; ++k) {
        const int a = 17 * k + 5, b = a + 1;
        add(a, a, a);                                      // a point
        add(a, b, a);                                      // a segment
        mesh.triangles.push_back(mesh.triangles[31 * k]);  // a copy
        mesh.vertices.push_back(mesh.vertices[a] + 1e-9 * Vec3::UnitZ());
        add(a, b, static_cast<int>(mesh.vertices.size()) - 1);  // a sliver a nanometre high
    }
    return mesh;
}

}  // namespace

const ReferenceWall& reference_wall()
{
    static const ReferenceWall wall = [] {
        ReferenceWall made;
        WallMesh mesh = bumpy_tube(made.radius, made.length);
        const WallTree tree = build_wall_tree(mesh);
        device::Context& context = reference_context(true);  // which every device can make
        const DeviceWall on_device(context, tree, mesh);
        made.triangles = tree.triangle_count();
        made.nodes.resize(tree.nodes.size() * sizeof(TreeNode));
        std::memcpy(made.nodes.data(), tree.nodes.data(), made.nodes.size());
        made.vertices = tree.vertices;
        made.boundary.resize(made.triangles);
        context.read(device::Queue::Inline, on_device.boundary, made.boundary.data(), made.triangles * sizeof(std::uint32_t));
        return made;
    }();
    return wall;
}

device::Context& reference_context(bool float32)
{
    static std::unique_ptr<device::Context> contexts[2];
    auto& context = contexts[float32];
    if (!context) context = std::make_unique<device::Context>(-1, float32);
    return *context;
}

}  // namespace seldinger::test

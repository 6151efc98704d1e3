#pragma once
// A tube, a wire and a renderer for the picture tests.

#include "core/error.h"
#include "support/refusal.h"
#include "support/skip.h"
#include "view/renderer.h"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace seldinger::test {

/// Nothing where this machine cannot draw; the caller returns then. Any other error is a failure.
inline std::unique_ptr<Renderer> renderer_or_skip(int width, int height, const Look& look)
{
    try {
        return std::make_unique<Renderer>(width, height, look);
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::NoDevice && !has(e.what(), "font")) throw;
        skip(e.what());
        return nullptr;
    }
}

inline Look bare_look()
{
    Look look;
    look.legend = false;
    return look;
}

/// Straight open tube along x about (0, 0, 0), normals into the lumen.
inline WallMesh straight_tube(double radius, double length, Vec3 centre = Vec3::Zero(), int around = 48, int along = 24)
{
    WallMesh mesh;
    for (int i = 0; i <= along; ++i) {
        for (int k = 0; k < around; ++k) {
            const double angle = 2 * std::numbers::pi * k / around;
            mesh.vertices.push_back(centre + Vec3(length * (static_cast<double>(i) / along - 0.5), radius * std::cos(angle),
                                                  radius * std::sin(angle)));
        }
    }
    for (int i = 0; i < along; ++i) {
        for (int k = 0; k < around; ++k) {
            const int a = i * around + k, b = i * around + (k + 1) % around, c = a + around, d = b + around;
            mesh.triangles.push_back({a, c, b});  // e_x x e_angle points to the axis
            mesh.triangles.push_back({b, c, d});
        }
    }
    return mesh;
}

inline WireLine straight_wire(const Vec3& tip, const Vec3& hub, double radius, int nodes = 21)
{
    WireLine wire;
    for (int i = 0; i < nodes; ++i) {
        wire.nodes.push_back(tip + (hub - tip) * (static_cast<double>(i) / (nodes - 1)));
        wire.radius.push_back(radius);
    }
    return wire;
}

/// Looks along +y from a distance, z up.
inline Camera side_camera(double distance)
{
    Camera camera;
    camera.eye = {0, -distance, 0};
    camera.target = {0, 0, 0};
    camera.up = {0, 0, 1};
    camera.fov_y = 0.3;
    return camera;
}

struct Pixel {
    int r = 0, g = 0, b = 0;
    [[nodiscard]] double grey() const { return (r + g + b) / 3.0; }
};

inline Pixel pixel_at(const Renderer& renderer, double column, double row)
{
    const int x = static_cast<int>(std::floor(column)), y = static_cast<int>(std::floor(row));
    REQUIRE(x >= 0);
    REQUIRE(y >= 0);
    REQUIRE(x < renderer.width());
    REQUIRE(y < renderer.height());
    const std::size_t at = 3 * (static_cast<std::size_t>(y) * renderer.width() + x);
    const auto& p = renderer.pixels();
    return {p[at], p[at + 1], p[at + 2]};
}

/// Blued steel under white light: dark, and bluer than red. Tissue and background are neither.
inline bool looks_like_wire(const Pixel& p) { return p.grey() < 115 && p.b > p.r; }

}  // namespace seldinger::test

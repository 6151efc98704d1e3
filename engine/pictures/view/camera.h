#pragma once
// The pinhole camera, and its default aim at a vessel.

#include "math/vec3.h"
#include "vessel/wall_mesh.h"

#include <vector>

namespace seldinger {

/// Perspective camera. A point p has view coordinates (x, y, z) along (right, up, towards the eye), z < 0 in front, and lands at
///   column = x0 + w/2 + f x/(-z),  row = y0 + h/2 - f y/(-z),  f = (h/2) / tan(fov_y/2)  [pixels]
/// in a viewport of w x h pixels whose upper left corner is (x0, y0); row 0 is the top.
struct Camera {
    Vec3 eye = {0, -1, 0};       // [m]
    Vec3 target = Vec3::Zero();  // [m] the centre of the picture
    Vec3 up = {0, 0, 1};         // need not be square to the line of sight
    double fov_y = 0.35;         // full vertical angle [rad]; 0.35 = 20 deg, a long lens
    double nearest = 0;          // what is nearer to the eye is cut away [m]; 0: 2 % of the distance to the target

    [[nodiscard]] Vec3 right() const { return (target - eye).cross(up).normalized(); }
    [[nodiscard]] Vec3 forward() const { return (target - eye).normalized(); }
};

/// Rectangle of pixels, row 0 at the top.
struct Viewport {
    int x = 0, y = 0, width = 1, height = 1;
};

/// Where a point lands, and its depth along the line of sight [m] (> 0 in front of the eye).
struct Projected {
    double column = 0, row = 0, depth = 0;
};

[[nodiscard]] Projected project(const Camera& camera, const Viewport& viewport, const Vec3& point);

/// Pixels per metre at that depth.
[[nodiscard]] double pixels_per_metre(const Camera& camera, const Viewport& viewport, double depth);

/// The camera that looks along `forward` with `up` and just holds every point, a share `margin` of the half picture left free.
/// Exact: each point bounds eye distance D and shift c by |x - c| <= tan_x (D - z), a closed form in four maxima.
[[nodiscard]] Camera fit_camera(const std::vector<Vec3>& points, const Vec3& forward, const Vec3& up, double aspect,
                                double fov_y = 0.35, double margin = 0.06);

/// Looks along the vessel's thinnest principal direction, from the patient's front, left or head, whichever is nearest (an open
/// sheet: onto its lumen side). The patient's head is up where the vessel then still fills a good part of the picture, else the
/// principal axis that fills it best.
/// @param mesh  may be empty; then `extra` alone decides. @param extra  points that must be in view too (the wire)
[[nodiscard]] Camera automatic_camera(const WallMesh& mesh, const std::vector<Vec3>& extra, double aspect,
                                      const Vec3& head = Vec3::UnitZ(), const Vec3& back = Vec3::UnitY());

}  // namespace seldinger

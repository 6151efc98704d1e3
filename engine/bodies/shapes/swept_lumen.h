#pragma once
// A lumen as an implicit function: tubes of varying radius along polylines, blended where they meet.

#include "vessel/wall_mesh.h"

#include <vector>

namespace seldinger {

/// One tube: an axis of points with radii, and its flat ends.
struct SweptTube {
    std::vector<Vec3> points;    // [m] a polyline finer than the tube is wide
    std::vector<double> radius;  // [m]
};

struct FieldValue {
    double value = 0;              // about the distance to the wall [m], < 0 in the lumen
    Vec3 gradient = Vec3::Zero();  // [-]
};

/// f(p) = smooth minimum over the tubes of |p - c| - r(c), c the nearest point of the tube's axis. The smooth minimum is the
/// quadratic one: min(a, b) - max(0, k - |a - b|)^2 / (4 k). It fills the crotch with a fillet about k wide and leaves all else
/// as it is.
class SweptLumen {
public:
    SweptLumen(std::vector<SweptTube> tubes, double fillet);
    [[nodiscard]] FieldValue at(const Vec3& p) const;
    [[nodiscard]] const std::vector<SweptTube>& tubes() const { return tubes_; }
    [[nodiscard]] double fillet() const { return fillet_; }
    /// Value of one tube's segment [i, i + 1] alone.
    [[nodiscard]] static double value_of(const SweptTube& tube, std::size_t segment, const Vec3& p);
    [[nodiscard]] FieldValue blend(const FieldValue& a, const FieldValue& b) const;

private:
    [[nodiscard]] static FieldValue of_segment(const SweptTube& tube, std::size_t segment, const Vec3& p);

    struct Chunk {  // a run of segments in a sphere, to be skipped when something nearer is known
        std::size_t first, last;
        Vec3 centre;
        double reach;  // of the sphere, largest tube radius included [m]
    };
    std::vector<SweptTube> tubes_;
    std::vector<std::vector<Chunk>> chunks_;
    double fillet_;
};

/// A plane that ends the lumen: it cuts off everything beyond `point` along `outward`, within `reach` of it.
struct LumenEnd {
    Vec3 point, outward;
    double reach;  // [m]
};

/// About `triangles` even triangles on f = 0, open at the ends, normals into the lumen (towards f < 0). Surface nets [Gibson
/// 1998, doi:10.1007/BFb0056277], cut flat at the ends, then relaxed. Vertices move towards their neighbours' mean along the wall
/// and back onto f = 0, rims stay in their planes, and edges flip while that helps the worse triangle.
[[nodiscard]] WallMesh mesh_lumen(const SweptLumen& lumen, const std::vector<LumenEnd>& ends, int triangles);

}  // namespace seldinger

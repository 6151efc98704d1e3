// Checks a wall's coordinates against what float32 can hold.
#include "vessel/mesh_limits.h"

#include "core/error.h"

#include <fmt/format.h>
#include <algorithm>

namespace seldinger {
namespace {

/// Where the vertices lie on each axis, without the `left_out` lowest and highest of each.
struct Spread {
    Vec3 low = Vec3::Zero(), middle = Vec3::Zero(), high = Vec3::Zero();
};

Spread spread_of(const std::vector<Vec3>& vertices, std::size_t left_out)
{
    Spread spread;
    std::vector<double> values(vertices.size());
    const auto place = [&](std::size_t k) { return values.begin() + static_cast<std::ptrdiff_t>(k); };
    for (int d = 0; d < 3; ++d) {
        std::transform(vertices.begin(), vertices.end(), values.begin(), [&](const Vec3& v) { return v[d]; });
        const auto value_at = [&](std::size_t k) {
            std::nth_element(values.begin(), place(k), values.end());
            return values[k];
        };
        spread.low[d] = value_at(left_out);
        spread.middle[d] = value_at(values.size() / 2);
        spread.high[d] = value_at(values.size() - 1 - left_out);
    }
    return spread;
}

[[noreturn]] void refuse_stray(const WallMesh& mesh, const Vec3& middle, const std::string& why)
{
    const auto away = std::max_element(mesh.vertices.begin(), mesh.vertices.end(), [&](const Vec3& a, const Vec3& b) {
        return (a - middle).squaredNorm() < (b - middle).squaredNorm();
    });
    throw Error(ErrorKind::BadFile,
                fmt::format("the vertex at [{:.6g}, {:.6g}, {:.6g}] m lies {:.3g} m from the middle of the others, "
                            "but {}: take out what lies far away",
                            away->x(), away->y(), away->z(), (*away - middle).norm(), why));
}

}  // namespace

std::int64_t first_unusable_vertex(const WallMesh& mesh)
{
    const auto unusable = std::find_if(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) {
        return !(std::abs(v.x()) <= most_coordinate && std::abs(v.y()) <= most_coordinate && std::abs(v.z()) <= most_coordinate);
    });
    return unusable == mesh.vertices.end() ? -1 : unusable - mesh.vertices.begin();
}

void require_no_strays(const WallMesh& mesh, double median_edge)
{
    constexpr double coarsest = 1e-2, half_step = 1.0 / (1 << 24);  // of an edge; of a float32, relative
    constexpr double widest = 20;                                   // times the box of nearly all vertices
    constexpr std::size_t few = 16, rare = 200;                     // of fewer vertices none can be called a stray
    const std::size_t count = mesh.vertices.size();
    if (count == 0) return;
    const Spread all = spread_of(mesh.vertices, 0);
    if (half_step * 0.5 * (all.high - all.low).maxCoeff() > coarsest * median_edge)
        refuse_stray(mesh, all.middle,
                     fmt::format("half of all edges are shorter than {:.3g} m, too short to be kept in float32", median_edge));
    if (count < few) return;
    const Spread most = spread_of(mesh.vertices, count / rare + 1);
    const double size = (most.high - most.low).norm();
    if ((all.high - all.low).norm() > widest * size)
        refuse_stray(mesh, all.middle, fmt::format("nearly all of them lie within a box {:.3g} m across", size));
}

}  // namespace seldinger

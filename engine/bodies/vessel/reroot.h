#pragma once
// Chooses the root of a closed vessel's axis.

#include "vessel/centreline.h"
#include "vessel/inside.h"
#include "vessel/wall_mesh.h"
#include "vessel/work_budget.h"

namespace seldinger {

/// Makes the widest of the distant ends the root. A wire enters where the vessel is wide (an aorta rather than a leg), but not in
/// a side pocket near the middle (an aortic root seen from the descending aorta). So only ends count from which the farthest
/// other end is at least 0.9 times as far as the longest path. If all of those are less than 20 % as wide as the widest end, they
/// are distal tips. The inlet is then, among ends at least half as wide as the widest, the one with the longest path to its
/// farthest end. A flat end is taken before round ones there: where a vessel was cut off a scan it ends in a plane, and a sinus
/// or an aneurysm, however wide,
/// does not. Points stand behind their parents afterwards. @param lumen  of the mesh
/// @throws Error BadFile when the ends are too many to ask each (`work`)
void reroot_at_widest_end(Centreline& tree, const WallMesh& mesh, const LumenQuery& lumen, WorkBudget& work);

}  // namespace seldinger

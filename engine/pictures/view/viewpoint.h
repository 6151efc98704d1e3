#pragma once
// Views of a run: named directions of the patient, the tip's own view, and cameras that move with time. A frame's
// camera depends on that frame, its time and the whole run's extent, never on which frames are drawn with it.

#include "view/renderer.h"
#include "view/view_from.h"

#include <vector>

namespace seldinger {

/// The objects in view, and the times covered.
struct Scenery {
    const WallMesh* wall = nullptr;
    std::vector<Vec3> nodes;  // of every frame
    PatientAxes patient;
    double begin = 0, end = 0;  // [s]
};

/// The camera of one frame. @throws Error BadScene: an endoscopic view of a frame without a wire
[[nodiscard]] Camera frame_camera(const Scenery& scenery, ViewFrom from, const CameraMotion& motion, const WireFrame& frame,
                                  double aspect);

}  // namespace seldinger

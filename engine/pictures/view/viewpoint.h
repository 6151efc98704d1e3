#pragma once
// Views of a run: named directions of the patient, the tip's own view, and cameras that move with time. A frame's
// camera depends on that frame, its time and the whole run's extent, never on which frames are drawn with it.

#include "view/renderer.h"

#include <optional>
#include <string>
#include <vector>

namespace seldinger {

enum class ViewFrom { Auto, Front, Back, Left, Right, Top, Bottom, Endoscopic };

/// The patient's axes in the scene's.
struct PatientAxes {
    Vec3 head = {0, 0, 1}, back = {0, 1, 0};
    [[nodiscard]] Vec3 left() const { return back.cross(head); }
};

/// Where a moving camera is at a time: turned about the patient's long axis and lifted, from the view that it starts from.
struct CameraKey {
    double t = 0;                       // [s]
    double azimuth = 0, elevation = 0;  // [rad]
    double zoom = 1;
};

struct CameraMotion {
    std::vector<CameraKey> keys;  // in increasing time, linear between them; empty: it stands still
    double orbit = 0;             // [rad] over the run, on top of the keys
    double follow = 0;            // [m] the tip stays in the middle of a picture this high; 0: it does not
};

/// "orbit", "orbit 180", "follow", "follow 60mm", "0s 0 0; 2s 90 20 1.5" (time, azimuth, elevation [deg], zoom).
/// @throws Error BadScene
[[nodiscard]] CameraMotion parse_motion(const std::string& text);

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

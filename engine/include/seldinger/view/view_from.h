#pragma once
// From where a run is looked at, and what its wall is coloured by.

#include "math/vec3.h"

#include <string>
#include <vector>

namespace seldinger {

/// What a wall that has moved is coloured by.
enum class WallQuantity { Displacement, Stress };

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

}  // namespace seldinger

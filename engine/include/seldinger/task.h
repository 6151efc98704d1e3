#pragma once
// [task] of a scene: where a tip is to go, and how it went.

#include "math/vec3.h"

#include <string>

namespace seldinger {

/// [task] of a scene: where the tip is to go, and within which limits.
struct TaskSpec {
    enum class Target { None, Point, Branch };
    bool on = false;
    std::string text;  // what to do, in words
    Target target = Target::None;
    std::string target_name;  // in answers; empty: "branch 2"
    Vec3 point = Vec3::Zero();  // Point: the tip comes within `radius` of it [m]
    double radius = 0.005;
    int branch = 0;  // Branch: number of an end of the centreline, from 1 (vessel/branches.h); 0: `branch_path`
    std::string branch_path;  // or the path or the name of a stretch: "2.1", "left renal"
    double beyond = 0.01;  // the tip is as far behind its mouth, along its axis [m]
    double wall_force = 0, patch_force = 0;  // limits; 0: none: of all forces on the wall, of those on one patch of it [N]
    double time = 0, fluoroscopy = 0;        // likewise [s]
};

/// What became of it so far.
struct TaskProgress {
    bool reached = false;
    double reached_at = 0, inserted_at = 0;  // when the target was reached, with so much wire inside [s], [m]
    double distance = -1;                    // of the tip from the target [m]; -1: there is none
    double wall_force_max = 0, patch_force_max = 0, hand_force_max = 0;  // until then [N]
    std::string verdict;                     // "passed", "failed", "open"; "free": there is no target
};

}  // namespace seldinger

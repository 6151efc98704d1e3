#pragma once
// [carm] and [contrast] of a scene: settings of X-ray pictures. Nothing of it acts on the simulation.

#include "math/vec3.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

/// Where the C-arm stands from a time on; between keys it turns evenly.
struct CArmKey {
    double t = 0;                     // [s]
    double lao_deg = 0, cra_deg = 0;  // position of the detector, DICOM PS3.3 C.8.7.5.1.2: LAO and CRA positive
};

enum class BodyShape { Ellipsoid, None };

struct SceneCArm {
    bool on = false;  // the table is there
    bool isocentre_auto = true;
    Vec3 isocentre = Vec3::Zero();                    // [m]
    Vec3 head = Vec3::UnitZ(), back = Vec3::UnitY();  // the patient's directions in scene axes
    double sid = 1.2, sod = 0.8;                      // source to detector, source to isocentre [m]
    double field = 0.3;                               // width of the detector [m]
    double kvp = 75;                                  // tube voltage [kV]
    double photons = 1e5;                             // per pixel in the open beam
    double blur = 2e-4;                               // standard deviation on the detector [m]
    BodyShape body = BodyShape::Ellipsoid;
    Vec3 body_axes = {0.19, 0.11, 0.5};  // half axes to the left, back and head [m]
    std::filesystem::path bone;          // mesh; empty: none
    std::string bone_units = "mm";
    std::vector<CArmKey> keys;  // times strictly increasing; empty: LAO 0, CRA 0
};

struct ContrastKey {
    double t = 0;       // [s]
    double iodine = 0;  // where it is injected [kg/m^3], which is [mg/ml]
};

struct SceneContrast {
    bool on = false;
    bool at_auto = true, inflow_auto = true;
    Vec3 at = Vec3::Zero();      // where it is injected [m]; auto: at the centreline's root
    Vec3 inflow = Vec3::Zero();  // where blood comes in [m]; auto: where it is injected
    double speed = 0.3;          // of the blood where it is injected [m/s]
    double spread = 0.15;        // standard deviation of arrival over the time of travel
    std::vector<ContrastKey> keys;
};

}  // namespace seldinger

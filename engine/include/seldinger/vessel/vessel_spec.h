#pragma once
// Which vessel: a mesh file or a generated shape, and what its wall is made of. SI (a mesh file has its own unit).

#include "math/vec3.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

enum class VesselShape { None, Mesh, Tube, Arc, Plane, Arch };  // Arch: the project's own parametric aortic arch

/// A load on an elastic wall, for as long as the run lasts.
struct WallLoad {
    double pressure = 0;        // more than the mean one, over all of it, outward [Pa]
    Vec3 at = Vec3::Zero();     // the point of the wall nearest to here carries `force` [m]
    Vec3 force = Vec3::Zero();  // [N]
};

struct VesselSpec {
    VesselShape shape = VesselShape::None;
    std::filesystem::path mesh;         // absolute after loading
    std::string units = "mm";           // of the mesh file: m, cm, mm, um, in
    int label = 0;                      // of a label map: its number, or 0 and its name; neither: the only one
    std::string label_name;
    bool close_holes = true;            // of the mesh file: small ones; else each is an opening
    double radius = 0, length = 0;      // tube, arc: lumen radius; tube: length [m]
    double bend_radius = 0, angle = 0;  // arc [m], [rad]
    double lead_in = 0, lead_out = 0;   // arc [m]
    Vec3 origin = Vec3::Zero(), axis = Vec3::UnitX(), normal = Vec3::UnitZ();
    double size = 0;                   // plane: side [m]
    int triangles = 0;                 // about
    bool elastic = false;              // the wall is an elastic one; the rest of what it takes for that is below
    double youngs = 1.0e6;             // wall [Pa]
    bool youngs_given = false;         // by the scene; otherwise choose_wall_youngs()
    double poisson = 0.45;             // [-]
    double thickness = 0.001;          // H [m]
    double support = 1e6;              // of the tissue around it, per area [Pa/m]
    double support_damping = 1e4;      // likewise [Pa s/m]
    double relaxation = 0.02;          // of the wall's own stress [s]
    double pressure = 0;               // mean pressure that the given shape carries [Pa]
    double wall_edge = 0;              // of the control mesh [m]; 0: chosen
    bool rims_held = true;             // openings' rims do not move
    std::vector<WallLoad> loads;
    // Points of the wall where instruments are expected to touch it: the control mesh of an elastic wall is fine about them. No
    // key of a scene; found by a trial run with a rigid wall (run/wall_path.h) [m]
    std::vector<Vec3> touched;
    std::filesystem::path centreline;  // optional .vtp with MaximumInscribedSphereRadius
    std::string centreline_units;      // as units; empty: what its header says, else the mesh's
    std::string centreline_space;      // "LPS" or "RAS"; empty: what its header says, else the mesh's
    bool branches_from_root = false;  // branches count from the centreline's root; else from the inlet in use (vessel/branches.h)

    [[nodiscard]] std::string label_text() const { return label > 0 ? std::to_string(label) : label_name; }
};

}  // namespace seldinger

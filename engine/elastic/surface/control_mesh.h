#pragma once
// The coarse mesh on which the wall's shell lives, made from the fine one that contact sees.

#include "surface/edge_field.h"
#include "vessel/centreline.h"
#include "vessel/wall_mesh.h"

#include <string>

namespace seldinger {

struct WallModel;

struct ControlMeshSpec {
    double edge = 0;                         // wanted [m]
    double share = 0.6;                      // of the local lumen radius, which an edge has at most [-]: ten edges around
    const Centreline* centreline = nullptr;  // tells the local radius; null: only rims do
    EdgePath path;                           // where edges are shorter
};

/// What came out.
struct ControlMeshReport {
    long vertices = 0, triangles = 0, rims = 0;
    double edge_least = 0, edge_mean = 0, edge_most = 0;  // [m]
    double fit_least = 0, fit_most = 0;                   // edge / what was wanted there: 98 % of them lie between [-]
    double angle_least = 0;                               // [rad]
    double regular = 0;                                   // part of the vertices with six neighbours, on rims with four [-]
    double distance = 0;  // largest from the fine surface, of corners, middles of edges and of triangles [m]
};

/// Isotropic triangles near to the wanted edge, vertices on the fine wall and on its rims (surface/remesh.h). The wall's
/// topology, rims and orientation are kept, and so are corners of a rim that turn by more than 60 degrees. Same input, same bits.
/// @param wall    repaired (repair/repair.h): welded, normals into the lumen
/// @param report  out, may be null
/// @throws Error BadFile if the wall is no sheet: edges of more than two triangles, inconsistent sides, more than one piece; or
/// if
///         memory does not suffice (check_control_edge)
[[nodiscard]] WallMesh make_control_mesh(const WallMesh& wall, const ControlMeshSpec& spec, ControlMeshReport* report = nullptr);

/// Bytes of the factor of a shell's matrix, three unknowns a vertex coupled over two rings of neighbours.
[[nodiscard]] double factor_bytes(double vertices);

/// Whether a wall of this area [m^2] can have control edges of this length [m].
/// @throws Error BadScene, with the memory it would take, when that is more than half of what the machine has
void check_control_edge(double area, double edge);

struct WallEdge {
    double edge = 0, share = 0.6;  // of ControlMeshSpec
    EdgePath path;                 // likewise
    double vertices = 0;           // expected
    std::string why;               // "3.4 mm (a third of the lumen's radius)"
};

/// The edge where none is given: min(R/3, half the decay length 1/beta), beta^4 = (E t/R^2 + k_s) / (4 D) [Hetenyi46, sec. 30]. R
/// is the typical radius of the lumen, and D = E t^3 / (12 (1 - nu^2)). For a plane E t/R^2 and R/3 are left out. If more than
/// about 2,000 vertices would be needed, the edge is made longer, and with it the share of narrow branches.
///
/// If VesselSpec::touched says where instruments touch, edges are half of the decay length up to one decay length from there.
/// Elsewhere they are as long as 700 vertices for the whole wall make them. If more than about 3,000 would be needed, the short
/// edges are longer.
[[nodiscard]] WallEdge choose_wall_edge(const WallModel& wall);

}  // namespace seldinger

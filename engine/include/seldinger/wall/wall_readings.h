#pragma once
// Readings of an elastic wall (shell/elastic_wall.h); all zero for a rigid one.

#include <cmath>
#include <cstddef>

namespace seldinger {

/// What an elastic wall is made of.
struct WallMechanics {
    int vertices = 0;       // of its control mesh; 0: the wall is rigid
    double edge = 0;        // mean [m]
    double edge_touched = 0;  // where instruments are expected to touch; else the mean [m]
    double decay = 0;       // length over which a dent decays (wall/wall_resolution.h) [m]; infinite: a plane on nothing
    double made_in = 0;     // control mesh and matrices [s]
    double factor = 0;      // of that, and since: factors, one per length of step [s]
    long columns = 0;       // of their inverses that contact has asked for
    std::size_t bytes = 0;  // of factors and columns
};

/// ± of a reading of the wall by independent sources, in the reading's unit.
struct WallBand {
    double mesh = 0;      // the control mesh there (wall/wall_resolution.h)
    double geometry = 0;  // linear theory, where displacements are so small that the run uses it (wall/wall_resolution.h)
    double nodes = 0;     // of the wires; of a run
    double step = 0;      // of a run that estimates it
    [[nodiscard]] double sum() const { return std::hypot(std::hypot(mesh, geometry), std::hypot(nodes, step)); }
};

struct WallReadings {
    double move_max = 0;    // largest displacement [m]
    double move_share = 0;  // largest, as a share of a fifth of the lumen's radius there [-]
    double energy = 0;      // stored in shell, tissue and against pressure [J]
    double loss = 0;        // dissipated by damping since the start, numerical damping included [J]
    double stress_max = 0;  // von Mises, membrane and bending, the larger of both surfaces, at a quadrature point of the shell;
                            // under an instrument with what the mesh cuts off (lost_peak) [Pa]
    double move_at[3] = {}, stress_at[3] = {};  // where these are, on the wall that has not moved [m]
    WallBand move_band, stress_band;            // ± of the largest ones, by control mesh and geometry [m], [Pa]
};

}  // namespace seldinger

#pragma once
// An elastic wall as a body: a thin shell on its own control mesh in the surrounding tissue (D11; shell/shell.h), and its
// position. Whatever the vessel's mesh has in triangles, its mechanics has a thousand vertices or so.
//
//     C w' + K w + r(w) = f    w: displacement of the control vertices [3V] [m], f: force on them [N]
//
// by backward Euler (shell/wall_dynamics.h). r is what linear theory leaves out of the shell's forces (shell/large_shell.h). It
// is 0 while no control vertex has moved by more than 1/100 of the lumen's radius or 1/10 of the wall's thickness. Inertia of
// the wall is small beside the tissue's damping, and left out.

#include "surface/control_mesh.h"
#include "surface/loop_surface.h"
#include "wall/wall_model.h"
#include "wall/wall_readings.h"
#include "wall/wall_resolution.h"

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace seldinger {

class LargeShell;
class Shell;
class WallCompliance;

/// Constant part; all systems of a world share it.
class ElasticWall {
public:
    /// @throws Error BadFile: no shell can be made of the mesh; BadScene: the wall could fly away, or is too fine for the memory
    explicit ElasticWall(const WallModel& wall);
    ~ElasticWall();

    [[nodiscard]] const LoopSurface& surface() const { return *surface_; }
    [[nodiscard]] const Shell& shell() const { return *shell_; }
    [[nodiscard]] const WallCompliance& compliance() const { return *compliance_; }
    [[nodiscard]] int unknowns() const { return static_cast<int>(3 * limits_.size()); }
    /// What the scene's wall loads exert on the control vertices [3V] [N]; empty: nothing.
    [[nodiscard]] std::span<const double> load() const { return load_; }
    /// Places where they act; a pressure, at some spread over the wall.
    [[nodiscard]] std::span<const LoopFoot> loaded() const { return loaded_; }
    /// Mean edge of the control mesh [m].
    [[nodiscard]] double edge() const { return edge_; }
    /// Edge where instruments are expected to touch; without a path (VesselSpec::touched) the mean [m].
    [[nodiscard]] double edge_touched() const { return edge_touched_; }
    /// Edge of an equilateral triangle as large as this one of the control mesh [m].
    [[nodiscard]] double edge_of(std::int32_t triangle) const;
    /// Share by which displacement and stress in this triangle may be off for its size (wall/wall_resolution.h).
    [[nodiscard]] WallMeshBand band_of(std::int32_t triangle) const;
    /// Stress that the mesh cuts off under a load per length q [N/m] in this triangle, and its band [Pa]
    /// (wall/wall_resolution.h).
    [[nodiscard]] LostPeak lost_peak(std::int32_t triangle, double load) const;
    /// Share of displacement and stress that linear theory leaves out where it is used (wall/wall_resolution.h). @param move  the
    /// largest [m]
    [[nodiscard]] double left_out(double move) const;
    /// Decay length of a dent where instruments are expected to touch [m].
    [[nodiscard]] double decay() const { return decay_; }
    /// Farthest that the vessel's mesh is from the wall's smooth surface [m].
    [[nodiscard]] double off() const { return off_; }
    /// Why it is that long, in words.
    [[nodiscard]] const std::string& edge_reason() const { return edge_reason_; }
    /// Limit of displacement at a place of the wall, by control vertices: 20 % of the lumen's radius there [m].
    [[nodiscard]] double largest_move(const LoopStencil& place) const;
    /// Limit of the surface at a control vertex.
    [[nodiscard]] const LoopStencil& limit(std::int32_t vertex) const { return limits_[static_cast<std::size_t>(vertex)]; }
    /// The shell under large displacements, where linear theory does not do for w [3V]; null: it does.
    [[nodiscard]] const LargeShell* large_for(std::span<const double> w) const;
    /// y -= r(w) of that shell. @param all  of triangles too that are nearly still, without which it is not smooth in w
    void take_excess_force(const LargeShell& large, std::span<const double> w, std::span<double> y, bool all = false) const;
    [[nodiscard]] WallMechanics mechanics() const;
    /// C/h = kept M + B, B = left A - kept K_p, of a step of h > 0 (shell/wall_dynamics.h).
    struct MemorySplit {
        double kept;  // s [-]
        double left;  // [Pa/m]
    };
    [[nodiscard]] MemorySplit memory_split(double h) const;
    /// y += B w of a step of h (shell/wall_dynamics.h).
    void add_memory_force(double h, std::span<const double> w, std::span<double> y) const;
    /// How much B takes of a displacement that no strain holds back, at most.
    [[nodiscard]] double memory_share(double h) const;

private:
    std::unique_ptr<LoopSurface> surface_;
    std::unique_ptr<Shell> shell_;
    std::unique_ptr<WallCompliance> compliance_;
    std::vector<double> load_;
    std::vector<LoopFoot> loaded_;
    std::vector<double> largest_move_;  // [V]
    std::vector<LoopStencil> limits_;   // [V]
    double edge_ = 0, edge_touched_ = 0, decay_ = 0, off_ = 0, made_in_ = 0;
    std::string edge_reason_;
    bool plane_ = false;
    mutable std::once_flag large_made_;
    mutable std::unique_ptr<LargeShell> large_;  // made when it is first asked for
};

/// Bands of readings that linear theory has made, whose largest displacement is `farthest` [m].
void add_geometry(const ElasticWall& wall, double farthest, WallReadings& now);

/// @param w  displacement of the control vertices [3V] [m]  @param work  done by contact since the beginning [J]
/// @param stress  at control vertices [V], the larger von Mises stress of both surfaces [Pa]; may be null
[[nodiscard]] WallReadings read_wall(const ElasticWall& wall, std::span<const double> w, double work,
                                     std::vector<double>* stress = nullptr);

}  // namespace seldinger

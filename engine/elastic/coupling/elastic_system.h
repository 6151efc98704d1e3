#pragma once
// State of contact with an elastic wall for one system while a step is solved. Private to elastic_contact*.cpp.

#include "coupling/elastic_contact.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace seldinger {

/// One trial of a system's nodes, what contact said there, and how it changes.
struct WallTrial {
    std::vector<double> q;      // [4 nodes] positions and spin angles
    std::vector<double> y;      // [3 nodes] carried back [m]
    std::vector<double> u;      // [3 rows] where the wall is thought to be [m]
    std::vector<double> force;  // [3 rows] on the wire [N]
    std::vector<double> rho;    // [3 rows] how far it would go from there under that force [m]
    Condensed linear;           // unknowns counted over the system's nodes
};

static_assert(sizeof(WallDynamics::Push) == 2 * sizeof(std::int32_t) + 3 * sizeof(double));

struct ElasticContact::System {
    System(const ElasticWall& wall, int first)
        : stations(wall, 0), kept(wall, 0), first_node(first), dynamics(wall), moves(static_cast<std::size_t>(wall.unknowns()))
    {
    }

    // ---- trials ----
    [[nodiscard]] WallTrial& trial() { return trials_[now_]; }
    [[nodiscard]] const WallTrial& trial() const { return trials_[now_]; }
    [[nodiscard]] const WallTrial* base_trial() const { return base_ >= 0 ? &trials_[base_] : nullptr; }
    WallTrial& next_trial()
    {
        if (now_ == base_) now_ = 1 - now_;
        return trials_[now_];
    }
    void take() { base_ = now_; }
    void forget_base() { base_ = -1; }
    /// The wall where contact's answer sends it, by the linear equations at the trial, whose positions stay.
    void correct();
    /// Residual of the balance of wall and contact over the permitted one.
    /// @param of_force  of the largest force  @param of_radius  of the wire's radius
    [[nodiscard]] double misses(double of_force, double of_radius) const;

    // ---- nodes ----
    /// Whether any of its wires is in the mask.
    [[nodiscard]] bool is_in(std::span<const std::uint8_t> mask) const
    {
        return std::any_of(wires.begin(), wires.end(), [&](int w) { return mask[w] != 0; });
    }
    [[nodiscard]] int row_of(int node) const { return stations[node].near ? stations[node].row : -1; }
    /// y of a node at x.
    [[nodiscard]] Vec3 carry(int node, const Vec3& x) const
    {
        const WallStation& station = stations[node];
        if (!station.near) return x;
        const Vec3 u = station.row >= 0 ? Vec3(&trial().u[3 * station.row]) : station.start;
        return station.at - station.start + station.shift + station.back * ((x - station.at) - (u - station.start));
    }
    /// Where the accepted state's feet carried a wire's nodes, now at `rod`. @param first  of them among the system's
    void find_before(int first, const RodView& rod);
    [[nodiscard]] const WallEnd* end_of(int first, int count, int node, const Vec3& x) const;
    /// Sets the shift of a node that is placed.
    void keep_carried(int node, const Vec3& x, double radius);
    /// The accepted state's nodes, to go on from.
    void note_ends(int first, int count);
    /// Rows of the wall's own state.
    void walk_wall(StateWalk& walk);
    /// dy/dx = -dy/dU = (1 + G)^-1
    [[nodiscard]] Mat3 back(int node) const { return stations[node].near ? stations[node].back : Mat3(Mat3::Identity()); }

    std::vector<int> wires;
    WallStations stations, kept;  // kept: while rows() reads
    std::vector<WallEnd> ends;  // [nodes] of the accepted state
    std::vector<WallFoot> feet_before;  // [nodes] ElasticContact::keep_feet
    std::vector<std::optional<Vec3>> before;  // [nodes] y to go on from; none: not known
    std::vector<Vec3> force_before;           // [nodes] of the accepted state
    int first_node;  // of the system in the concatenated arrays
    double least_radius = std::numeric_limits<double>::infinity();
    WallDynamics dynamics;

    // of the step
    bool begun = false;
    bool stands = true;  // ElasticContact::stands
    double h = 0;  // [s]; 0: an equilibrium
    int refinements = 0, relaxations = 0;
    bool relaxed = true;             // the last equilibrium's wall, as far as its large displacements go
    std::vector<int> rows;           // nodes that touch or may, in order
    std::vector<int> wire_of_row;    // [rows]
    StationCompliance compliance;    // W, of the rows that have been touched
    std::vector<double> u_free;      // [3 rows]
    std::vector<double> y_start;     // [3 nodes] of the start of the step [m]
    std::vector<double> scratch_q, scratch_m;
    std::vector<std::size_t> loaded;  // rows on which a force acted in the accepted state
    mutable std::vector<double> missed;
    std::vector<WallDynamics::Push> pushed;
    std::vector<WallDynamics::Push> exerted,
        exerted_before;                             // pushed in the accepted state, of which it is a part, and in the one before
    std::vector<double> work_at_rest;               // on each wire on the way to the last equilibrium [wires] [J]
    std::vector<double> moves;  // [3 control vertices] at those that are read [m]
    WallReadings under;         // of the accepted state

private:
    WallTrial trials_[2];
    int now_ = 0, base_ = -1;
};

}  // namespace seldinger

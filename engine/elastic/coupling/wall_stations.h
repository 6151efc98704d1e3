#pragma once
// Where wires meet an elastic wall. Contact is computed in the wall's undeformed shape. Each node of a wire is carried back by
// the wall's displacement under it. From there on the wall is the rigid one, exact mesh, tree and caches included.
//
//     y = x0 - U0 + (1 + G)^-1 [(x - x0) - (U - U0)],     U = sum_a N_a(foot) w_a,     G = dU/dX at the foot            (D11a)
//
// x: node; x0, U0: x and U at the time of its foot's search (the start of the step). foot: the point of the wall's smooth surface
// nearest to y0 = x0 - U0, not to x0. Then (D11a) is the tangent of the map that the next step's feet follow. If the wire
// is drawn along a dent, the two differ by terms of second order in the distance of one step alone. Between nodes y is linear, as
// the wire is. The wall's points X have gone to X + U(X), by a map of gradient 1 +
// G: what the wire does relative to the wall is carried back by its inverse. The gap at y is that to the moved wall to first
// order in the slope of the displacement. For a move of 0.2 lumen radii over a decay length, 2.5 % of it are second order. A
// force f at y is (1 + G)^-T f on the wire, turned with the wall, and its opposite on the wall at the foot. No work and no
// momentum is lost between the two. Nodes far from the wall are not carried at all: U fades out between `full` and `none`.

#include "math/vec3.h"
#include "rod/rod_arrays.h"
#include "shell/elastic_wall.h"
#include "shell/wall_dynamics.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// A node of a wire and the wall under it.
struct WallStation {
    bool near = false;             // else the wall has no say in it
    LoopStencil weights;           // N, faded [control vertices]
    Mat3 back = Mat3::Identity();  // (1 + G)^-1
    Vec3 at = Vec3::Zero();        // x0 [m]
    Vec3 start = Vec3::Zero();     // U at the start of the step [m]
    Vec3 shift = Vec3::Zero();     // of y, see WallEnd [m]
    double distance = 0;           // of y0 from the wall that has not moved [m]
    int row = -1;                  // among those that touch, or may
};

/// Where the foot of a node near the wall was found last: the next search starts there. Part of the state, because the last bits
/// of a foot depend on it.
struct WallFoot {
    double node[3] = {1e30, 1e30, 1e30};  // y from which it was found [m]
    double u = 0, v = 0;
    std::int64_t triangle = -1;
};

/// Where a node of the accepted state was and where it was carried to by the foot of that step. From its new foot it is carried
/// to x - U, which differs by terms of second order in the slope and the distance moved. That is little, but as much as an
/// overlap may have if a wire is drawn fast along a dent. y continues from its position, and by `most_made_good` radii a step to
/// x - U.
struct WallEnd {
    double x[3] = {1e30, 1e30, 1e30}, y[3] = {};  // [m]
    double force[3] = {};                         // on the node [N]
};

/// Nodes of one system.
class WallStations {
public:
    WallStations(const ElasticWall& wall, int nodes);

    void provide(int nodes);
    /// Nodes `first` to `last` of another one of the same wall.
    void copy(const WallStations& other, int first, int last);
    /// Finds the foot of a node at x anew, unless it is there already.   @param before  y of the accepted state, null: not known
    void place(int node, const Vec3& x, const Vec3* before, const WallDynamics& wall, double radius);
    /// y = x - U(foot of y) of a point of a wire at x, by repeated passes from `y`: where it is beside the wall that has not
    /// moved, by the wall as it is now alone.
    [[nodiscard]] Vec3 seen_at(const Vec3& x, Vec3 y, const WallDynamics& wall, double radius) const;
    /// Forgets nodes `first` to `last`, which have been removed.
    void forget(int first, int last);
    [[nodiscard]] WallFoot& foot(int node) { return feet_[node]; }
    [[nodiscard]] std::span<WallFoot> feet() { return feet_; }
    [[nodiscard]] const WallStation& operator[](int node) const { return stations_[node]; }
    [[nodiscard]] WallStation& operator[](int node) { return stations_[node]; }
    [[nodiscard]] int count() const { return static_cast<int>(stations_.size()); }

private:
    struct Clear {
        Vec3 at = Vec3::Constant(1e30);
        double distance = 0;  // from there to the wall, or less [m]
    };
    struct Under {
        LoopStencil weights;       // N, faded
        Vec3 move = Vec3::Zero();  // U, faded [m]
        Mat3 slope = Mat3::Zero();
        double distance = 0, share = 0;
    };
    [[nodiscard]] LoopFoot foot_of(const WallFoot& last, const Vec3& y) const;
    [[nodiscard]] Under under(const LoopFoot& foot, const Vec3& y, const WallDynamics& wall, double radius) const;

    const ElasticWall& wall_;
    std::vector<WallStation> stations_;  // [nodes]
    std::vector<WallFoot> feet_;         // [nodes]
    std::vector<Clear> clear_;           // [nodes] where a node was when it was far from the wall
};

/// W: compliance of stations to forces on them, 3x3 blocks of N (K + C/h)^-1 N^T, for those stations on which something acts: few
/// of those on which something might.
class StationCompliance {
public:
    /// @param rows  nodes of the stations  @param patch  of the step
    void reset(const WallStations& stations, std::span<const int> rows, WallPatch& patch);
    /// provide() shall give three rows of W and, as it is symmetric, three columns: of a station among `rows`.
    void want(int row);
    void provide();
    /// to += W force, [3 rows], of a force on a row that has been provided
    void add(int row, const Vec3& force, std::span<double> to) const;
    /// W [3 rows][3 rows], row by row; only rows that have been provided are to be read.
    [[nodiscard]] std::span<const double> entries() const { return w_; }

private:
    struct Part {
        int slot;  // among slots_
        double share;
    };
    struct Share {
        int slot;  // among slots_
        std::size_t station;
        double share;
    };
    /// Slots of the patch that follow each other.
    struct Run {
        int slot, count;
    };
    enum Row : std::uint8_t { Unknown, Wanted, Known };
    void provide_some(std::span<const std::size_t> some);
    std::size_t list_needed();
    void put(std::size_t own, std::span<const double> answer);

    WallPatch* patch_ = nullptr;
    std::vector<std::size_t> wanted_;
    std::vector<Share> shares_;
    std::vector<Run> runs_;             // of slots that are needed
    std::vector<int> slots_;            // of the patch, each once, in the order in which stations share in them
    std::vector<int> rising_;           // places in slots_, by slot
    std::vector<int> users_;            // [slots_] parts of rows that are not known yet
    std::vector<int> needed_;           // [slots_] place among the needed ones
    std::vector<Part> parts_;           // of all rows, one row's after the other's
    std::vector<std::size_t> first_;    // [rows + 1] among parts_
    std::vector<Row> known_;            // [rows]
    std::vector<double> w_, answer_;    // answer_: [stations][needed slots][9] of a station to a force on a control vertex
    std::vector<int> place_;            // [slots of the patch] among slots_, or -1
};

}  // namespace seldinger

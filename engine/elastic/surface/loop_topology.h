#pragma once
// Neighbours in a control mesh of Loop subdivision, and one round of it as weights.

#include "vessel/wall_mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// How subdivision treats a vertex. Rim: cubic B-spline of the rim's vertices alone; Corner: stays where it is.
enum class LoopVertex : unsigned char { Inner, Rim, Corner };

/// A point of a regular patch: vertex a, or, beyond a rim, the phantom a + b - c that makes the rim's rules those of the inside
/// [Schweitzer96; Cirak00, sec. 4.2].
struct LoopPoint {
    std::int32_t a, b = -1, c = -1;
    [[nodiscard]] bool phantom() const { return b >= 0; }
};

class LoopTopology {
public:
    static constexpr int max_valence = 24;

    /// Throws Error: an edge of three triangles, neighbours that face opposite ways, a vertex where two sheets touch, one of no
    /// triangle or of more than max_valence, a triangle of no area. Corners: rim vertices of one triangle and those where the rim
    /// turns by more than 75 degrees (so that a five-cornered opening is round and a rectangle's corner is not).
    explicit LoopTopology(const WallMesh& mesh);
    /// From known corners; every other vertex of one triangle is on the rim.
    LoopTopology(std::vector<std::array<std::int32_t, 3>> triangles, std::span<const unsigned char> corner);

    std::vector<std::array<std::int32_t, 3>> triangles;  // [T]
    std::vector<std::int32_t> opposite;                  // [3T] half-edge 3 t + e on the other side, -1 on a rim
    std::vector<std::int32_t> first;                     // [V] a half-edge that leaves the vertex; the rim's own one on a rim
    std::vector<unsigned char> triangles_about;          // [V]
    std::vector<LoopVertex> kind;                        // [V]

    [[nodiscard]] std::int32_t vertex_count() const { return static_cast<std::int32_t>(kind.size()); }
    [[nodiscard]] std::int32_t triangle_count() const { return static_cast<std::int32_t>(triangles.size()); }
    /// Six triangles about it inside, three on a rim.
    [[nodiscard]] bool regular(std::int32_t v) const
    {
        return triangles_about[v] == (kind[v] == LoopVertex::Inner ? 6 : 3) && kind[v] != LoopVertex::Corner;
    }
    [[nodiscard]] std::int32_t from(std::int32_t h) const { return triangles[h / 3][h % 3]; }
    [[nodiscard]] std::int32_t to(std::int32_t h) const { return triangles[h / 3][(h % 3 + 1) % 3]; }
    /// The next half-edge about the same vertex, counter-clockwise; -1 beyond a rim.
    [[nodiscard]] std::int32_t turn(std::int32_t h) const { return opposite[h - h % 3 + (h % 3 + 2) % 3]; }

    /// Neighbours of v, counter-clockwise from the end of half-edge `start` (inside) or from the rim (start unused).
    /// @return how many
    int fan(std::int32_t v, std::int32_t start, std::span<std::int32_t> neighbours) const;
    /// Where v ends up: own * x[v] + each * sum of x over the neighbours that count (on a rim the two along it, at a corner
    /// none).
    struct LimitMask {
        double own = 1, each = 0;
        int count = 0;
        std::array<std::int32_t, max_valence + 1> neighbours;
    };
    [[nodiscard]] LimitMask limit_mask(std::int32_t v) const;
    /// Six neighbours of a regular vertex, counter-clockwise from `towards`, phantoms beyond the rim.
    [[nodiscard]] std::array<LoopPoint, 6> ring(std::int32_t v, std::int32_t towards_half_edge) const;
    /// The twelve of a triangle of three regular corners, in the order of loop_basis.h.
    [[nodiscard]] std::array<LoopPoint, 12> patch(std::int32_t triangle) const;
    /// Those of a triangle whose corner 0 alone is irregular: corner 0, its fan, then the existing parts of the rings of corners
    /// 1, 2.
    /// @param place  place of corner 1 in the fan
    [[nodiscard]] std::vector<std::int32_t> corner_patch(std::int32_t triangle, int& place) const;

private:
    void connect(std::int32_t vertices);
};

/// One round of subdivision. Vertex v stays v, the vertex of edge k is V + k (order of find_edges). Children of triangle t:
/// 4 t + c = (corner c, middle towards corner c + 1, middle towards corner c + 2), 4 t + 3 = (middle 12, middle 20, middle 01).
struct LoopRefinement {
    LoopTopology topology;
    std::vector<std::int32_t> first;   // [V' + 1] rows of weights
    std::vector<std::int32_t> vertex;  // old vertices of a row
    std::vector<double> weight;
};
[[nodiscard]] LoopRefinement refine(const LoopTopology& coarse);

/// Weight of each of n neighbours of an inner vertex after one round [Loop87], and in its limit.
[[nodiscard]] double loop_neighbour_weight(int n);
[[nodiscard]] double loop_limit_weight(int n);

}  // namespace seldinger

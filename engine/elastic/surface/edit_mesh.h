#pragma once
// A triangle surface that can be changed edge by edge, and stays a surface: each change keeps its topology, rims and orientation.
//
// Half-edge h = 3 t + e runs from corner e of triangle t to corner e + 1 (vessel/mesh_edges.h). A removed element leaves a hole
// in the arrays that compact() closes. No operation allocates but split().

#include "vessel/mesh_edges.h"

#include <cstdint>
#include <vector>

namespace seldinger {

class EditMesh {
public:
    /// Vertices where two fans of triangles touch become one vertex for each fan.
    /// @param edges  of the mesh: of one or two triangles that agree about the way round (asserted)
    EditMesh(const WallMesh& mesh, const MeshEdges& edges);

    [[nodiscard]] std::int32_t vertex_count() const { return static_cast<std::int32_t>(out_.size()); }  // those gone included
    [[nodiscard]] std::int32_t half_edge_count() const { return static_cast<std::int32_t>(from_.size()); }
    [[nodiscard]] bool has_vertex(std::int32_t v) const { return out_[v] >= 0; }
    [[nodiscard]] bool has_triangle_of(std::int32_t h) const { return from_[h] >= 0; }
    [[nodiscard]] static std::int32_t next(std::int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
    [[nodiscard]] static std::int32_t previous(std::int32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
    [[nodiscard]] std::int32_t from(std::int32_t h) const { return from_[h]; }
    [[nodiscard]] std::int32_t to(std::int32_t h) const { return from_[next(h)]; }
    [[nodiscard]] std::int32_t apex(std::int32_t h) const { return from_[previous(h)]; }
    /// The same edge seen from its other triangle; -1 at a rim.
    [[nodiscard]] std::int32_t across(std::int32_t h) const { return across_[h]; }
    /// A half-edge that leaves v: along the rim, if v lies on one.
    [[nodiscard]] std::int32_t out(std::int32_t v) const { return out_[v]; }
    [[nodiscard]] bool on_rim(std::int32_t v) const { return across_[out_[v]] < 0; }
    [[nodiscard]] int valence(std::int32_t v) const;  // number of edges

    /// f(h) for each half-edge that leaves v, one for each triangle around it.
    template <class F>
    void for_triangles(std::int32_t v, F f) const
    {
        const std::int32_t first = out_[v];
        for (std::int32_t h = first; h >= 0;) {
            f(h);
            h = across_[previous(h)];
            if (h == first) break;
        }
    }
    /// f(w) for each neighbour w.
    template <class F>
    void for_neighbours(std::int32_t v, F f) const
    {
        const std::int32_t first = out_[v];
        for (std::int32_t h = first; h >= 0;) {
            f(to(h));
            const std::int32_t before = previous(h);
            h = across_[before];
            if (h < 0) f(from(before));
            if (h == first) break;
        }
    }
    [[nodiscard]] bool joined(std::int32_t v, std::int32_t w) const;

    /// Whether to(h) can be drawn into from(h) without a change of topology [Dey, Edelsbrunner, Guha & Nekhayev 1999,
    /// http://www.numdam.org/item/PIM_1999_66_80_23_0, the link condition] or a corner left with less than two edges.
    [[nodiscard]] bool can_collapse(std::int32_t h);
    void collapse(std::int32_t h);  // from(h) stays
    /// A new vertex on the edge. @return its index; its half-edge towards to(h) is the new triangle's first
    std::int32_t split(std::int32_t h);
    /// Whether the edge can be turned to join the two corners across it.
    [[nodiscard]] bool can_flip(std::int32_t h) const;
    void flip(std::int32_t h);

    /// Closes the holes. @return new index of each vertex, -1: it had been removed
    std::vector<std::int32_t> compact();
    [[nodiscard]] std::vector<std::array<std::int32_t, 3>> triangles() const;  // after compact()
    /// Vertex of the mesh that each vertex stood for at the start.
    [[nodiscard]] const std::vector<std::int32_t>& origin() const { return origin_; }

private:
    void link(std::int32_t g, std::int32_t h);
    /// Makes h, or the half-edge before it on the rim, the half-edge that leaves v.
    void settle(std::int32_t v, std::int32_t h);

    std::vector<std::int32_t> from_, across_;  // [3 T]
    std::vector<std::int32_t> out_;            // [V]
    std::vector<std::int32_t> origin_;         // [V at the start]
    std::vector<std::uint32_t> mark_;          // [V] scratch of can_collapse
    std::uint32_t stamp_ = 0;
};

}  // namespace seldinger

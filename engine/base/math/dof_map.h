#pragma once
// Order of unknowns. The only place, beside the band matrix, that knows how many a node has and how they lie.
//
// A rod's unknowns lie node by node from the tip: the three coordinates of node i, then the spin angle of the edge that begins
// there. The last node begins no edge; its place is kept and held. Bending joins a node with the next two, but no coordinate with
// the spin of an edge two nodes on (x_a meets theta_{a+1} at the farthest). So a rod's matrix has half bandwidth 2 * 4 + 2 = 10.
//
// A system's unknowns are those of its instruments, each in one piece or node by node in turn with the others (DofMap).

#include "core/check.h"

#include <span>
#include <vector>

namespace seldinger {

/// Unknowns of one rod, counted from its own first unknown.
struct RodDofs {
    static constexpr int per_node = 4;
    static constexpr int coordinates = 3;     // of them, which come first
    static constexpr int spin_place = 3;      // among a node's unknowns
    static constexpr int reach = 2;           // nodes that a stencil joins a node with, on either side
    static constexpr int half_bandwidth = per_node * reach + coordinates - 1;

    [[nodiscard]] static constexpr int count(int nodes) { return per_node * nodes; }
    [[nodiscard]] static constexpr int nodes(int unknowns) { return unknowns / per_node; }
    /// First coordinate of node i; the others follow.
    [[nodiscard]] static constexpr int position(int i) { return per_node * i; }
    [[nodiscard]] static constexpr int position(int i, int c) { return per_node * i + c; }
    /// Spin angle of edge j.
    [[nodiscard]] static constexpr int spin(int j) { return per_node * j + spin_place; }
    /// The place that no edge takes.
    [[nodiscard]] static constexpr int unused(int nodes) { return per_node * nodes - 1; }
    [[nodiscard]] static constexpr int node(int unknown) { return unknown / per_node; }
    [[nodiscard]] static constexpr int place(int unknown) { return unknown % per_node; }
    [[nodiscard]] static constexpr bool is_spin(int unknown) { return unknown % per_node == spin_place; }
};

/// Unknowns of a system of rods.
class DofMap {
public:
    enum class Order {
        Concatenated,  // one rod after the other: each rod's part of a vector or matrix is in one piece
        Interleaved    // nodes of all rods by their distance from the hub: those side by side are near each other in the matrix
    };

    /// @param nodes  of each rod       @param from_hub  distance of each node from the hub [m], rods one after the other, falling
    /// within a rod; asked for to interleave only
    void lay_out(std::span<const int> nodes, Order order = Order::Concatenated, std::span<const double> from_hub = {});

    [[nodiscard]] int rods() const { return static_cast<int>(first_node_.size()) - 1; }
    [[nodiscard]] int nodes(int rod) const { return first_node_[rod + 1] - first_node_[rod]; }
    [[nodiscard]] int size() const { return RodDofs::count(first_node_.back()); }
    [[nodiscard]] Order order() const { return place_.empty() ? Order::Concatenated : Order::Interleaved; }
    /// First unknown of a rod's, in one piece.
    [[nodiscard]] int first(int rod) const
    {
        SEL_VALIDATE(order() == Order::Concatenated);
        return RodDofs::count(first_node_[rod]);
    }
    /// First unknown of node i of a rod; the others of the node follow.
    [[nodiscard]] int node(int rod, int i) const
    {
        const int at = first_node_[rod] + i;
        return RodDofs::count(place_.empty() ? at : place_[at]);
    }
    [[nodiscard]] int position(int rod, int i, int c) const { return node(rod, i) + c; }
    [[nodiscard]] int spin(int rod, int j) const { return node(rod, j) + RodDofs::spin_place; }
    [[nodiscard]] int half_bandwidth() const { return RodDofs::per_node * reach_ + RodDofs::coordinates - 1; }

private:
    std::vector<int> first_node_ = {0};  // [rods + 1] in the concatenation
    std::vector<int> place_;             // [nodes] where the node of the concatenation is; empty: there
    int reach_ = RodDofs::reach;  // places that two nodes of one stencil are apart at most
};

}  // namespace seldinger

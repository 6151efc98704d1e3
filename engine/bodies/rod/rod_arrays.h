#pragma once
// All wires of a world as structure-of-arrays, concatenated with per-wire offsets. Node 0 of a wire is its tip; feeding
// appends at the hub. Edge j joins nodes j and j+1 and is stored at the index of node j; a wire of n nodes has n-1 edges.

#include "rod/rod_view.h"

#include <array>
#include <span>
#include <vector>

namespace seldinger {

class StateWalk;  // core/state_walk.h

/// Owner of all wires' arrays. Capacities are fixed at construction: no allocation in the step loop.
class RodArrays {
public:
    /// @param capacity  most nodes that each wire may ever have, >= 2
    explicit RodArrays(std::span<const int> capacity);

    [[nodiscard]] int wire_count() const { return static_cast<int>(count_.size()); }
    [[nodiscard]] int node_count(int wire) const { return count_[wire]; }
    [[nodiscard]] int capacity(int wire) const { return begin_[wire + 1] - begin_[wire]; }
    [[nodiscard]] int node_begin(int wire) const { return begin_[wire]; }  // in the concatenated arrays
    [[nodiscard]] int total_capacity() const { return begin_.back(); }
    /// @param n  2..capacity(wire); arrays keep their content, entries beyond the old count are unspecified
    void set_node_count(int wire, int n);
    /// Makes room for a node at `index` in 1..n-1. It and the edge at that index repeat the old values, for the caller to
    /// overwrite; everything hubwards moves up by one. / Takes out node and edge `index`.
    void insert_node(int wire, int index);
    void erase_node(int wire, int index);
    void set_curvature(int wire, CurvatureMeasure measure) { curvature_[wire] = measure; }
    [[nodiscard]] RodView view(int wire);
    /// All of a wire's arrays, in a fixed order.
    static constexpr int array_count = 32;  // members of RodView that are spans (checked in the source file)
    [[nodiscard]] std::array<std::span<double>, array_count> arrays(int wire);
    /// Rows of the state (core/state_walk.h). @param own  the wire is a rod by itself, and its numbers are checked as a rod's
    void walk_state(StateWalk& walk, int wire, bool own);

private:
    std::vector<int> begin_, count_;            // [wires + 1], [wires]
    std::vector<CurvatureMeasure> curvature_;   // [wires]
    std::vector<double> storage_[array_count];  // [total_capacity] each, in the order of RodView's members
};

}  // namespace seldinger

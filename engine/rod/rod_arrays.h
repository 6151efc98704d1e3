#pragma once
// All wires of a world as structure-of-arrays, concatenated with per-wire offsets. Node 0 of a wire is its tip; feeding
// appends at the hub. Edge j joins nodes j and j+1 and is stored at the index of node j; a wire of n nodes has n-1 edges.

#include "rod/wire_spec.h"

#include <array>
#include <span>
#include <vector>

namespace seldinger {

/// One wire's slice of RodArrays (or any storage of the same shape). Spans of per-node arrays have length n, of
/// per-edge arrays too (the last entry is unused). "inner" values live at nodes 1..n-2.
/// Vectors are three separate arrays, as the kernels read them.
struct RodView {
    int n = 0;                                             // nodes
    CurvatureMeasure curvature = CurvatureMeasure::Angle;  // constant
    // constant while the node set stands; written by set_rest_shape / feed / adapt
    std::span<double> material_s;         // [n] node's arc length from the tip in the unstressed wire [m]
    std::span<double> rest_length;        // [n-1] edge [m]
    std::span<double> stretch_stiffness;  // [n-1] EA [N]
    std::span<double> bend_stiffness;     // [n] B at a node [N m^2] (ends too: used by clamps)
    std::span<double> twist_stiffness;    // [n] C at a node [N m^2]
    // integrals over the node's Voronoi cell; at tip and hub over their half cell
    std::span<double> rest_kappa1, rest_kappa2;  // [n] integrated rest curvature at a node [-]
    std::span<double> rest_twist;                // [n] integrated rest twist at a node [rad]
    std::span<double> mass;                      // [n] lumped [kg]
    std::span<double> spin_inertia;              // [n-1] edge, rho * I_p * length [kg m^2]
    std::span<double> radius;                    // [n-1] edge outer radius [m]
    // state at the start of the step (t0) / the accepted state
    std::span<double> x, y, z;     // [n] node position [m]
    std::span<double> theta;       // [n-1] material frame angle from the reference frame [rad]
    std::span<double> vx, vy, vz;  // [n] [m/s]
    std::span<double> spin_rate;   // [n-1] [rad/s]
    std::span<double> ax, ay, az;  // [n] acceleration, Newmark only [m/s^2]
    std::span<double> spin_acc;    // [n-1] Newmark only [rad/s^2]
    // reference frame of the accepted state, parallel-transported in time
    std::span<double> tx, ty, tz;     // [n-1] unit tangent from node j to node j+1 (tip towards hub)
    std::span<double> d1x, d1y, d1z;  // [n-1] first reference director, unit, normal to the tangent
    std::span<double> ref_twist;      // [n] reference twist at inner nodes [rad]
    // reference twist between a clamp at this node and the edge on its tip side (a), on its hub side (b), of the accepted
    // state [rad]; kept so that full turns are not forgotten; 0 where no clamp is. Written by accept_frames
    std::span<double> clamp_twist_a, clamp_twist_b;  // [n]

    /// Half of a node's two rest edges; at tip and hub half of the only one [m].
    [[nodiscard]] double voronoi_length(int i) const
    {
        return 0.5 * ((i > 0 ? rest_length[i - 1] : 0.0) + (i < n - 1 ? rest_length[i] : 0.0));
    }
    [[nodiscard]] Vec3 pos(int i) const { return {x[i], y[i], z[i]}; }
    [[nodiscard]] Vec3 vel(int i) const { return {vx[i], vy[i], vz[i]}; }
    [[nodiscard]] Vec3 tangent(int j) const { return {tx[j], ty[j], tz[j]}; }
    [[nodiscard]] Vec3 ref_d1(int j) const { return {d1x[j], d1y[j], d1z[j]}; }
    void set_pos(int i, const Vec3& p) const
    {
        x[i] = p.x();
        y[i] = p.y();
        z[i] = p.z();
    }
    void set_vel(int i, const Vec3& v) const
    {
        vx[i] = v.x();
        vy[i] = v.y();
        vz[i] = v.z();
    }
    void set_tangent(int j, const Vec3& t) const
    {
        tx[j] = t.x();
        ty[j] = t.y();
        tz[j] = t.z();
    }
    void set_ref_d1(int j, const Vec3& d) const
    {
        d1x[j] = d.x();
        d1y[j] = d.y();
        d1z[j] = d.z();
    }
};

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
    /// Makes room for a node at `index` in 1..n-1: it and the edge at that index repeat what was there, for the caller to
    /// overwrite; everything hubwards moves up by one. / Takes out node and edge `index`.
    void insert_node(int wire, int index);
    void erase_node(int wire, int index);
    void set_curvature(int wire, CurvatureMeasure measure) { curvature_[wire] = measure; }
    [[nodiscard]] RodView view(int wire);
    /// All state and model bytes of a wire, for checkpoints and the state hash: one span per array, in a fixed order.
    static constexpr int array_count = 32;  // members of RodView that are spans (checked in the source file)
    [[nodiscard]] std::array<std::span<double>, array_count> arrays(int wire);

private:
    std::vector<int> begin_, count_;            // [wires + 1], [wires]
    std::vector<CurvatureMeasure> curvature_;   // [wires]
    std::vector<double> storage_[array_count];  // [total_capacity] each, in the order of RodView's members
};

}  // namespace seldinger

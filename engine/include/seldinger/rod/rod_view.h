#pragma once
// One wire as arrays of its nodes and edges, for the rod's functions and for users.

#include "rod/wire_spec.h"

#include <span>
#include <type_traits>

namespace seldinger {

/// One wire's slice of RodArrays (or any storage of the same shape). Spans of per-node arrays have length n, of
/// per-edge arrays too (the last entry is unused). "inner" values live at nodes 1..n-2.
/// Vectors are three separate arrays, as the kernels read them.
template <class Number>
struct BasicRodView {
    int n = 0;                                             // nodes
    CurvatureMeasure curvature = CurvatureMeasure::Angle;  // constant
    // constant while the node set stands; written by set_rest_shape / feed / adapt
    std::span<Number> material_s;         // [n] node's arc length from the tip in the unstressed wire [m]
    std::span<Number> rest_length;        // [n-1] edge [m]
    std::span<Number> stretch_stiffness;  // [n-1] EA [N]
    std::span<Number> bend_stiffness;     // [n] B at a node [N m^2] (ends too: used by clamps)
    std::span<Number> twist_stiffness;    // [n] C at a node [N m^2]
    // integrals over the node's Voronoi cell; at tip and hub over their half cell
    std::span<Number> rest_kappa1, rest_kappa2;  // [n] integrated rest curvature at a node [-]
    std::span<Number> rest_twist;                // [n] integrated rest twist at a node [rad]
    std::span<Number> mass;                      // [n] lumped [kg]
    std::span<Number> spin_inertia;              // [n-1] edge, rho * I_p * length [kg m^2]
    std::span<Number> radius;                    // [n-1] edge outer radius [m]
    // state at the start of the step (t0) / the accepted state
    std::span<Number> x, y, z;     // [n] node position [m]
    std::span<Number> theta;       // [n-1] material frame angle from the reference frame [rad]
    std::span<Number> vx, vy, vz;  // [n] [m/s]
    std::span<Number> spin_rate;   // [n-1] [rad/s]
    std::span<Number> ax, ay, az;  // [n] acceleration: Newmark, instruments of a rod each [m/s^2]
    std::span<Number> spin_acc;    // [n-1] the same [rad/s^2]
    // reference frame of the accepted state, parallel-transported in time
    std::span<Number> tx, ty, tz;     // [n-1] unit tangent from node j to node j+1 (tip towards hub)
    std::span<Number> d1x, d1y, d1z;  // [n-1] first reference director, unit, normal to the tangent
    std::span<Number> ref_twist;      // [n] reference twist at inner nodes [rad]
    // reference twist between a clamp at this node and the edge on its tip side (a), on its hub side (b), of the accepted state
    // [rad]. It is kept so that full turns are not forgotten; 0 without a clamp. Written by accept_frames
    std::span<Number> clamp_twist_a, clamp_twist_b;  // [n]

    /// The same, to be read only.
    operator BasicRodView<const double>() const
        requires(!std::is_const_v<Number>)
    {
        return {n,  curvature, material_s, rest_length, stretch_stiffness, bend_stiffness, twist_stiffness, rest_kappa1,
                rest_kappa2, rest_twist, mass, spin_inertia, radius, x, y, z, theta, vx, vy, vz, spin_rate, ax, ay, az,
                spin_acc, tx, ty, tz, d1x, d1y, d1z, ref_twist, clamp_twist_a, clamp_twist_b};
    }

    /// Half of a node's two rest edges; at tip and hub half of the only one [m].
    [[nodiscard]] double voronoi_length(int i) const
    {
        return 0.5 * ((i > 0 ? rest_length[i - 1] : 0.0) + (i < n - 1 ? rest_length[i] : 0.0));
    }
    [[nodiscard]] Vec3 pos(int i) const { return {x[i], y[i], z[i]}; }
    [[nodiscard]] Vec3 vel(int i) const { return {vx[i], vy[i], vz[i]}; }
    [[nodiscard]] Vec3 tangent(int j) const { return {tx[j], ty[j], tz[j]}; }
    [[nodiscard]] Vec3 ref_d1(int j) const { return {d1x[j], d1y[j], d1z[j]}; }
    void set_pos(int i, const Vec3& p) const { set(x, y, z, i, p); }
    void set_vel(int i, const Vec3& v) const { set(vx, vy, vz, i, v); }
    void set_tangent(int j, const Vec3& t) const { set(tx, ty, tz, j, t); }
    void set_ref_d1(int j, const Vec3& d) const { set(d1x, d1y, d1z, j, d); }
    static void set(std::span<Number> to_x, std::span<Number> to_y, std::span<Number> to_z, int i, const Vec3& v)
    {
        to_x[i] = v.x(), to_y[i] = v.y(), to_z[i] = v.z();
    }
};

using RodView = BasicRodView<double>;             // state that may be changed
using ConstRodView = BasicRodView<const double>;  // of a World that is read

/// Bending energy of a wire beyond its natural shape, and what the finite length of its edges leaves out of it or adds [J].
struct BendingError {
    double energy = 0, missed = 0;
};

}  // namespace seldinger

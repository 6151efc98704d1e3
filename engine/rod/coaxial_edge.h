#pragma once
// Parts of births and merges of a common centreline's nodes: for rod/coaxial_split.cpp and rod/coaxial_nodes.cpp alone.

#include "rod/clamp.h"
#include "rod/coaxial.h"
#include "rod/rod_arrays.h"
#include "rod/transport.h"

namespace seldinger::coaxial {

/// The instruments' accepted configuration.
inline CoaxialTrial now_of(RodArrays& rods, std::span<const int> wires)
{
    const RodView line = rods.view(wires[0]);
    CoaxialTrial now{line.x, line.y, line.z, {}};
    for (std::size_t k = 0; k < wires.size(); ++k) now.theta[k] = rods.view(wires[k]).theta;
    return now;
}

inline double axial_force(const RodView& line, int j)
{
    return line.stretch_stiffness[j] * ((line.pos(j + 1) - line.pos(j)).norm() / line.rest_length[j] - 1);
}

inline Vec3 momentum(const RodView& line, int last)
{
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i <= last; ++i) sum += line.mass[i] * line.vel(i);
    return sum;
}

/// Common shift of the velocities of the nodes up to `last` that gives them this momentum.
inline void set_momentum(const RodView& line, int last, const Vec3& wanted)
{
    double mass = 0;
    for (int i = 0; i <= last; ++i) mass += line.mass[i];
    const Vec3 shift = (wanted - momentum(line, last)) / mass;
    for (int i = 0; i <= last; ++i) line.set_vel(i, line.vel(i) + shift);
}

/// Tangent of edge j from its nodes, and a director carried to it.
inline void set_edge_frame(const RodView& line, int j, const Vec3& from, const Vec3& d1)
{
    const Vec3 t = (line.pos(j + 1) - line.pos(j)).normalized();
    line.set_tangent(j, t);
    line.set_ref_d1(j, unit_normal(parallel_transport(d1, from, t, one_plus_cos(from, t)), t));
}

/// Reference twist at inner node i of the present frames, nearest to `last`.
inline double inner_reference(const RodView& line, int i, double last)
{
    const Vec3 te = line.tangent(i - 1), tf = line.tangent(i);
    return unwrap(signed_angle(parallel_transport(line.ref_d1(i - 1), te, tf, one_plus_cos(te, tf)), line.ref_d1(i), tf), last);
}

/// The same between the base edge and the sleeve.
inline double sleeve_reference(const RodView& line, const CoaxialBase& base, double last)
{
    const Vec3 te = line.tangent(line.n - 2);
    const Vec3 carried = parallel_transport(line.ref_d1(line.n - 2), te, base.tangent, one_plus_cos(te, base.tangent));
    return unwrap(signed_angle(carried, base.director, base.tangent), last);
}

/// Reference twist at node i between its edges, or at the hub to the sleeve; at the tip none.
inline double joint_reference(const RodView& line, int i)
{
    return i == 0 ? 0.0 : i == line.n - 1 ? line.clamp_twist_a[i] : line.ref_twist[i];
}

/// Reference twist of node i anew, of the present frames. @return its change from `last`
inline double refresh_reference(const RodView& line, const CoaxialBase& base, int i, double last)
{
    if (i == 0) return 0;
    const bool hub = i == line.n - 1;
    double& reference = hub ? line.clamp_twist_a[i] : line.ref_twist[i];
    reference = hub ? sleeve_reference(line, base, last) : inner_reference(line, i, last);
    return reference - last;
}

}  // namespace seldinger::coaxial

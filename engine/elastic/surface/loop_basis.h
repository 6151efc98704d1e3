#pragma once
// The twelve functions of a regular Loop patch: the quartic box spline of three directions.

namespace seldinger {

/// Control vertices of a patch: 0, 1, 2 are its corners, 3, 4, 5 lie across edges 01, 12, 20. The outer ones follow
/// counter-clockwise: 6, 7 about corner 0 (6 beside 5, 7 beside 3), 8, 9 about corner 1 (8 beside 3, 9 beside 4), 10, 11 about
/// corner 2 (10 beside 4).
struct LoopBasis {
    double n[12], n_u[12], n_v[12];       // values, derivatives by (u, v): weights of corners 1, 2
    double n_uu[12], n_uv[12], n_vv[12];  // second derivatives, where asked for
};

/// @param u, v  in the triangle: u, v >= 0, u + v <= 1   @param curved  second derivatives as well
void loop_basis(double u, double v, bool curved, LoopBasis& basis);

}  // namespace seldinger

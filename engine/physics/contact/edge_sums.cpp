// Sums per edge in the solver's form.
#include "contact/edge_sums.h"

#include "math/jacobi.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr int tri[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};  // place of (i, j) among xx xy xz yy yz zz

}  // namespace

ContactTotals& ContactTotals::operator+=(const ContactTotals& other)
{
    contacts += other.contacts;
    if (other.depth > depth) deepest = other.deepest;
    depth = std::max(depth, other.depth);
    outside = std::max(outside, other.outside);
    normal += other.normal;
    friction += other.friction;
    sliding += other.sliding;
    rolling += other.rolling;
    length += other.length;
    work += other.work;
    return *this;
}

void EdgeSums::answer(int wire, TermAnswer& to) const
{
    uint flags = 0;
    for (int e = wire_edges[wire]; e < wire_edges[wire + 1]; ++e) {
        flags |= edges[e].flags;
        to.largest_force = std::max(to.largest_force, edges[e].normal_sum);
    }
    to.admissible = !(flags & SEL_FORCE_BLOCKED);
    to.unsymmetric = flags & SEL_FORCE_SLIDING;
}

double EdgeSums::rounding(int wire, int begin, const RodView& rod) const
{
    double most = 0;
    for (int e = wire_edges[wire]; e < wire_edges[wire + 1]; ++e) {
        const EdgeForce& f = edges[e];
        const int edge = static_cast<int>(edge_node[e]) - begin;
        const double ab = std::abs(f.s_ab[0] + f.s_ab[4] + f.s_ab[8]);
        const double stiffness =  // of both ends together
            std::abs(f.s_aa[0] + f.s_aa[3] + f.s_aa[5]) + ab + ab + std::abs(f.s_bb[0] + f.s_bb[3] + f.s_bb[5]);
        most = std::max(most, stiffness * (rod.rest_length[edge] + rod.radius[edge]));
    }
    return 4 * 0x1p-24 * most;  // difference, product, sum and root of a distance; another edge at the node
}

void EdgeSums::add(int wire, int begin, std::span<double> gradient, BandRows* jacobian, bool symmetric) const
{
    for (int e = wire_edges[wire]; e < wire_edges[wire + 1]; ++e) {
        const EdgeForce& f = edges[e];
        if (f.contacts == 0) continue;
        const int node = static_cast<int>(edge_node[e]) - begin;
        const int a = RodDofs::position(node), t = RodDofs::spin(node), b = RodDofs::position(node + 1);
        for (int i = 0; i < 3; ++i) {
            gradient[a + i] -= f.force_a[i];
            gradient[b + i] -= f.force_b[i];
        }
        gradient[t] -= f.torque;
        if (!jacobian) continue;
        const bool skew = !symmetric && (f.flags & SEL_FORCE_SLIDING);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const int k = tri[i][j], u = 3 * i + j;
                jacobian->add(a + i, a + j, f.s_aa[k] + (skew ? f.u_aa[u] : 0));
                jacobian->add(a + i, b + j, f.s_ab[u] + (skew ? f.u_ab[u] : 0));
                jacobian->add(b + i, a + j, f.s_ab[3 * j + i] + (skew ? f.u_ba[u] : 0));
                jacobian->add(b + i, b + j, f.s_bb[k] + (skew ? f.u_bb[u] : 0));
            }
            jacobian->add(a + i, t, f.st_a[i]);
            jacobian->add(b + i, t, f.st_b[i]);
            jacobian->add(t, a + i, f.st_a[i] + (skew ? f.ut_a[i] : 0));
            jacobian->add(t, b + i, f.st_b[i] + (skew ? f.ut_b[i] : 0));
        }
        jacobian->add(t, t, f.s_tt);
    }
}

void EdgeSums::make_positive(int wire, double radius)
{
    constexpr int b = 3, spin = 6;  // rows: x_a, x_b, radius theta
    for (int e = wire_edges[wire]; e < wire_edges[wire + 1]; ++e) {
        EdgeForce& f = edges[e];
        if (f.contacts == 0) continue;
        FixedMatrix<7> s;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                s(i, j) = f.s_aa[tri[i][j]];
                s(i, b + j) = s(b + j, i) = f.s_ab[3 * i + j];
                s(b + i, b + j) = f.s_bb[tri[i][j]];
            }
            s(i, spin) = s(spin, i) = f.st_a[i] / radius;
            s(b + i, spin) = s(spin, b + i) = f.st_b[i] / radius;
        }
        s(spin, spin) = f.s_tt / (radius * radius);
        s = positive_part(s);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                f.s_ab[3 * i + j] = s(i, b + j);
                if (j < i) continue;
                f.s_aa[tri[i][j]] = s(i, j);
                f.s_bb[tri[i][j]] = s(b + i, b + j);
            }
            f.st_a[i] = radius * s(i, spin);
            f.st_b[i] = radius * s(b + i, spin);
        }
        f.s_tt = radius * radius * s(spin, spin);
    }
}

ContactTotals EdgeSums::totals(int wire, double radius) const
{
    ContactTotals sum;
    for (int e = wire_edges[wire]; e < wire_edges[wire + 1]; ++e) {
        const EdgeForce& f = edges[e];
        sum.contacts += static_cast<int>(f.contacts);
        if (f.depth > sum.depth) sum.deepest = static_cast<int>(edge_node[e]);
        sum.depth = std::max(sum.depth, static_cast<double>(f.depth));
        if (f.flags & SEL_FORCE_OUTSIDE) sum.outside = std::max(sum.outside, f.depth - radius);
        sum.normal += f.normal_sum;
        sum.friction += f.friction_sum;
        sum.sliding += f.sliding_sum;
        sum.rolling += f.rolling_sum;
        sum.length += f.length;
        sum.work.normal += f.normal_work;
        sum.work.friction += f.friction_work;
        sum.work.rolling += f.rolling_work;
    }
    return sum;
}

void EdgeSums::add_nodal_forces(int wire, int begin, std::span<Vec3> forces) const
{
    for (int e = wire_edges[wire]; e < wire_edges[wire + 1]; ++e) {
        const int node = static_cast<int>(edge_node[e]) - begin;
        for (int k = 0; k < 3; ++k) {
            forces[node][k] += edges[e].force_a[k];
            forces[node + 1][k] += edges[e].force_b[k];
        }
    }
}

double EdgeSums::along(int wire, int begin, const RodView& rod) const
{
    double sum = 0;
    for (int e = wire_edges[wire]; e < wire_edges[wire + 1]; ++e) {
        const EdgeForce& f = edges[e];
        const int a = static_cast<int>(edge_node[e]) - begin;
        const Vec3 towards_tip = (rod.pos(a) - rod.pos(a + 1)).normalized();
        for (int k = 0; k < 3; ++k) sum += (f.force_a[k] + f.force_b[k]) * towards_tip[k];
    }
    return sum;
}

}  // namespace seldinger

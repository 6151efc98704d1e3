// Energy and forces of the shell under large displacements, triangle by triangle.
#include "shell/large_shell.h"

#include "core/check.h"
#include "math/node_lanes.h"
#include "shell/shell_strain.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

using namespace shell_detail;

namespace {

constexpr std::size_t capacity = LoopStencil::capacity;

/// (11, 22, 2 12) of tangents' products: strain per change of the tangents x_,1, x_,2.
Vec3 green(const Vec3& e1, const Vec3& e2, const Vec3& u1, const Vec3& u2)
{
    return {e1.dot(u1) + u1.dot(u1) / 2, e2.dot(u2) + u2.dot(u2) / 2, e1.dot(u2) + e2.dot(u1) + u1.dot(u2)};
}

/// What pulls at the tangents: n (11, 22, 12) with strain (11, 22, 2 12).
struct Pull {
    Vec3 on_1, on_2;
    Pull(const Vec3& n, const Vec3& x_1, const Vec3& x_2) : on_1(n[0] * x_1 + n[2] * x_2), on_2(n[1] * x_2 + n[2] * x_1) {}
};

/// A vector's components side by side, the last lane 0.
Vec4d lanes_of(const double* from) { return Vec4d{from[0], from[1], from[2], 0}; }
Vec4d lanes_of(const Vec3& v) { return Vec4d{v[0], v[1], v[2], 0}; }
Vec3 vector_of(const Vec4d& v) { return {v[0], v[1], v[2]}; }

}  // namespace

/// Displacements of a triangle's control vertices, which its points and edges share.
struct LargeShell::Local {
    Vec4d at[capacity];
    Local(std::span<const Shell::Weight> weights, std::span<const double> displacement)
    {
        for (std::size_t i = 0; i < weights.size(); ++i) at[i] = lanes_of(displacement.data() + 3 * weights[i].vertex);
    }
};

LargeShell::LargeShell(const Shell& shell) : shell_(shell), triangles_(shell.points().size() / per_triangle)
{
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        Triangle& to = triangles_[t];
        const std::span<const ShellPoint> points(shell.points().data() + per_triangle * t, per_triangle);
        const ShellPoint& last = points.back();
        double area = 0;
        for (const ShellPoint& q : points) area += q.area;
        for (const Shell::Weight& w : shell.weights(last)) vertices_.push_back(w.vertex);
        const TiedStrain tied(shell.surface(), last);
        const double share = tied.share_of_mean(shell.spec().thickness);
        for (std::size_t p = 0; p < per_triangle; ++p) {
            to.of_point[p] = share * points[p].area / area * turn_strain(points[p], last);
            to.second[p].fill(Vec3::Zero());
            for (const Shell::Weight& w : shell.weights(points[p])) {
                const Vec3& x = shell.surface().control().vertices[static_cast<std::size_t>(w.vertex)];
                to.second[p][0] += w.n_11 * x, to.second[p][1] += w.n_22 * x, to.second[p][2] += w.n_12 * x;
            }
        }
        for (std::size_t e = 0; e < edge_points; ++e) {
            const EdgePoint& at = tied.points[e / 2][e % 2];
            to.edge[e] = at.tangent;
            to.of_edge[e] = (1 - share) / at.tangent.norm() * tied.of_stretch.col(e / 2);
            edge_weights_.insert(edge_weights_.end(), at.n_s.begin(), at.n_s.begin() + last.vertex_count);
        }
    }
}

std::span<const double> LargeShell::edge_weights(std::size_t triangle, std::size_t point) const
{
    const ShellPoint& q = shell_.points()[per_triangle * triangle];
    const auto count = static_cast<std::size_t>(q.vertex_count);
    // a triangle's four points have one stencil
    return {edge_weights_.data() + edge_points * static_cast<std::size_t>(q.first_vertex) / per_triangle + point * count, count};
}

LargeShell::Point LargeShell::move_point(std::size_t triangle, std::size_t k, const Local& local) const
{
    const ShellPoint& q = shell_.points()[per_triangle * triangle + k];
    Point p;
    Vec4d u{}, u_1{}, u_2{}, u_11{}, u_22{}, u_12{};
    const auto weights = shell_.weights(q);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const Shell::Weight& w = weights[i];
        const Vec4d& d = local.at[i];
        u += w.n * d, u_1 += w.n_1 * d, u_2 += w.n_2 * d;
        u_11 += w.n_11 * d, u_22 += w.n_22 * d, u_12 += w.n_12 * d;
    }
    p.u = vector_of(u), p.u_1 = vector_of(u_1), p.u_2 = vector_of(u_2);
    const std::array<Vec3, 3> u_s = {vector_of(u_11), vector_of(u_22), vector_of(u_12)};
    p.x_1 = q.e1 + p.u_1, p.x_2 = q.e2 + p.u_2;
    const Vec3 across = p.x_1.cross(p.x_2);
    p.stretch = across.norm();
    p.normal = across / p.stretch;
    Vec3 bent;
    const std::array<Vec3, 3>& rest = triangles_[triangle].second[k];
    for (std::size_t c = 0; c < 3; ++c) {
        p.x_s[c] = rest[c] + u_s[c];
        bent[c] = p.normal.dot(p.x_s[c]) - q.normal.dot(rest[c]);
    }
    bent[2] *= 2;
    p.strain = join(q, green(q.e1, q.e2, p.u_1, p.u_2), bent);
    p.linear = join(q, {q.e1.dot(p.u_1), q.e2.dot(p.u_2), q.e1.dot(p.u_2) + q.e2.dot(p.u_1)},
                    {q.normal.dot(u_s[0]), q.normal.dot(u_s[1]), 2 * q.normal.dot(u_s[2])});
    return p;
}

LargeShell::Moved LargeShell::move(std::size_t triangle, std::span<const double> displacement) const
{
    const Triangle& rest = triangles_[triangle];
    Moved now;
    now.strain = now.linear = Vec3::Zero();
    now.area = 0;
    const Local local(shell_.weights(shell_.points()[per_triangle * triangle]), displacement);
    for (std::size_t k = 0; k < per_triangle; ++k) {
        now.at[k] = move_point(triangle, k, local);
        now.strain += rest.of_point[k] * now.at[k].strain.membrane;
        now.linear += rest.of_point[k] * now.at[k].linear.membrane;
        now.area += shell_.points()[per_triangle * triangle + k].area;
    }
    for (std::size_t e = 0; e < edge_points; ++e) {
        const auto n_s = edge_weights(triangle, e);
        Vec4d sum{};
        for (std::size_t k = 0; k < n_s.size(); ++k) sum += n_s[k] * local.at[k];
        Vec3& u_s = now.u_s[e];
        u_s = vector_of(sum);
        now.linear += rest.edge[e].dot(u_s) * rest.of_edge[e];
        now.strain += (rest.edge[e].dot(u_s) + u_s.dot(u_s) / 2) * rest.of_edge[e];
    }
    return now;
}

LargeShell::Energy LargeShell::energy_of(std::size_t triangle, const Moved& now) const
{
    const ShellSpec& spec = shell_.spec();
    const Mat3 h = shell_.law();
    const double d = std::pow(spec.thickness, 3) / 12;
    Energy e;
    e.membrane = 0.5 * now.area * spec.thickness * now.strain.dot(h * now.strain);
    for (std::size_t k = 0; k < per_triangle; ++k) {
        const Point& p = now.at[k];
        const double area = shell_.points()[per_triangle * triangle + k].area;
        e.bending += 0.5 * area * d * p.strain.bending.dot(h * p.strain.bending);
        e.pressure += spec.pressure * area / 3 * p.u.dot(p.u_1.cross(p.u_2));
    }
    return e;
}

/// Of the same displacement by the linear theory of shell.h.
double LargeShell::linear_energy_of(std::size_t triangle, const Moved& now) const
{
    const Mat3 h = shell_.law();
    const double c = shell_.spec().thickness;
    double e = 0.5 * now.area * c * now.linear.dot(h * now.linear);
    for (std::size_t k = 0; k < per_triangle; ++k) {
        const Vec3& bending = now.at[k].linear.bending;
        e += 0.5 * shell_.points()[per_triangle * triangle + k].area * std::pow(c, 3) / 12 * bending.dot(h * bending);
    }
    return e;
}

LargeShell::Energy LargeShell::energy(std::span<const double> displacement) const
{
    SEL_ASSERT(displacement.size() == 3 * shell_.surface().control().vertices.size());
    Energy sum;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const Energy e = energy_of(t, move(t, displacement));
        sum.membrane += e.membrane, sum.bending += e.bending, sum.pressure += e.pressure;
    }
    return sum;
}

bool LargeShell::is_still(std::size_t triangle, std::span<const double> displacement, std::span<const double> moves2,
                          double share) const
{
    const std::span<const ShellPoint> points(shell_.points().data() + per_triangle * triangle, per_triangle);
    const double most = share * share * 8 * points.back().area;  // of an edge, about
    const std::span<const std::int32_t> all(
        vertices_.data() + static_cast<std::size_t>(points.front().first_vertex) / per_triangle,
        static_cast<std::size_t>(points.front().vertex_count));
    // two that have each moved by less than half of it are within it of each other
    if (std::all_of(all.begin(), all.end(), [&](std::int32_t v) { return moves2[static_cast<std::size_t>(v)] < 0.249 * most; }))
        return true;
    const Vec3 first(displacement.data() + 3 * all.front());
    return std::all_of(all.begin(), all.end(), [&](std::int32_t v) {
        return (Vec3(displacement.data() + 3 * v) - first).squaredNorm() <= most;
    });
}

Vec3 LargeShell::strains_of(std::size_t first, std::span<const double> displacement, std::span<ShellStrain, 4> at,
                            double* excess) const
{
    const std::size_t triangle = first / per_triangle;
    const Moved now = move(triangle, displacement);
    for (std::size_t k = 0; k < per_triangle; ++k) at[k] = now.at[k].strain;
    if (excess) *excess += energy_of(triangle, now).sum() - linear_energy_of(triangle, now);
    return now.strain;
}

void LargeShell::add_excess(std::span<const double> displacement, std::span<double> force, double still) const
{
    SEL_ASSERT(displacement.size() == 3 * shell_.surface().control().vertices.size() && force.size() == displacement.size());
    const ShellSpec& spec = shell_.spec();
    const Mat3 h = shell_.law();
    const double d = std::pow(spec.thickness, 3) / 12;
    std::vector<double> moves2;
    for (std::size_t i = 0; i < displacement.size(); i += 3) moves2.push_back(Vec3(displacement.data() + i).squaredNorm());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        if (is_still(t, displacement, moves2, still)) continue;
        const Moved now = move(t, displacement);
        const Triangle& rest = triangles_[t];
        const Vec3 pulled = now.area * spec.thickness * (h * now.strain), linear = now.area * spec.thickness * (h * now.linear);
        Vec4d sum[capacity] = {};
        for (std::size_t k = 0; k < per_triangle; ++k) {
            const ShellPoint& q = shell_.points()[per_triangle * t + k];
            const Point& p = now.at[k];
            const Vec3 m = q.area * d * (h * p.strain.bending), m_linear = q.area * d * (h * p.linear.bending);
            const Mat3 to_point = rest.of_point[k].transpose();
            const Pull by(to_point * pulled + join_transposed(q, m), p.x_1, p.x_2);
            const Pull by_linear(to_point * linear + join_transposed(q, m_linear), q.e1, q.e2);
            const Vec3 tilt = m[0] * p.tilt(p.x_s[0]) + m[1] * p.tilt(p.x_s[1]) + 2 * m[2] * p.tilt(p.x_s[2]);
            const double third = spec.pressure * q.area / 3;
            const Vec3 on = third * p.u_1.cross(p.u_2);
            const Vec3 on_1 = by.on_1 - by_linear.on_1 + p.x_2.cross(tilt) + third * p.u_2.cross(p.u);
            const Vec3 on_2 = by.on_2 - by_linear.on_2 + tilt.cross(p.x_1) + third * p.u.cross(p.u_1);
            const Vec4d f = lanes_of(on), f_1 = lanes_of(on_1), f_2 = lanes_of(on_2), normal = lanes_of(p.normal),
                        normal_rest = lanes_of(q.normal);
            const auto w = shell_.weights(q);
            for (std::size_t i = 0; i < w.size(); ++i) {
                const Shell::Weight& v = w[i];
                const double bent = m[0] * v.n_11 + m[1] * v.n_22 + 2 * m[2] * v.n_12;
                const double bent_linear = m_linear[0] * v.n_11 + m_linear[1] * v.n_22 + 2 * m_linear[2] * v.n_12;
                sum[i] += v.n * f + v.n_1 * f_1 + v.n_2 * f_2 + bent * normal - bent_linear * normal_rest;
            }
        }
        const auto w = shell_.weights(shell_.points()[per_triangle * t]);
        for (std::size_t e = 0; e < edge_points; ++e) {
            const auto n_s = edge_weights(t, e);
            const Vec4d on =
                lanes_of(rest.of_edge[e].dot(pulled) * (rest.edge[e] + now.u_s[e]) - rest.of_edge[e].dot(linear) * rest.edge[e]);
            for (std::size_t i = 0; i < w.size(); ++i) sum[i] += n_s[i] * on;
        }
        for (std::size_t i = 0; i < w.size(); ++i) add_to(&force[3 * static_cast<std::size_t>(w[i].vertex)], vector_of(sum[i]));
    }
}

}  // namespace seldinger

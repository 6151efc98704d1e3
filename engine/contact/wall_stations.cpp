// Feet of nodes on a wall that yields, and how the wall gives way under them.

#include "contact/wall_stations.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

double length_from(const Vec3& a, const Vec3& b) { return (a - b).norm(); }

Vec3 weighted(const LoopStencil& at, std::span<const double> weights, std::span<const double> w)
{
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < at.size; ++k) sum += weights[k] * Eigen::Map<const Vec3>(&w[3 * static_cast<std::size_t>(at.vertex[k])]);
    return sum;
}

/// 1 up to `full`, 0 from `none` on, smooth between.
double fade(double distance, double full, double none)
{
    const double t = std::clamp((distance - full) / (none - full), 0.0, 1.0);
    return 1 - t * t * (3 - 2 * t);
}

}  // namespace

WallStations::WallStations(const ElasticWall& wall, int nodes) : wall_(wall), stations_(nodes), clear_(nodes) {}

void WallStations::provide(int nodes)
{
    stations_.resize(nodes);
    feet_.resize(nodes);
    clear_.resize(nodes);
}

void WallStations::place(int node, const Vec3& x, std::span<const double> w, double radius)
{
    const double full = 2 * radius + 0.5 * wall_.edge(), none = 2 * full;
    WallStation& station = stations_[node];
    if (station.near && station.at == x) return;
    station.near = false;
    const WallFoot last = feet_[node];
    feet_[node] = {};
    Clear& clear = clear_[node];
    if (clear.distance - length_from(x, clear.at) > none) return;
    LoopFoot foot;
    if (last.triangle >= 0 && length_from(x, Vec3(last.node)) < 0.5 * wall_.edge()) {
        foot.triangle = static_cast<std::int32_t>(last.triangle);
        foot.u = last.u;
        foot.v = last.v;
    }
    wall_.surface().closest(x, foot);
    clear = {x, foot.distance};
    station.at = x;
    station.distance = foot.distance;
    const double share = fade(foot.distance, full, none);
    if (share == 0) return;
    feet_[node] = {{x.x(), x.y(), x.z()}, foot.u, foot.v, foot.triangle};
    station.near = true;
    station.row = -1;
    wall_.surface().basis(foot.triangle, foot.u, foot.v, station.weights);
    LoopStencil& s = station.weights;
    for (int k = 0; k < s.size; ++k) s.n[k] *= share;
    station.start = weighted(s, s.n, w);
    // u_,u and u_,v against the dual base of the two tangents
    const Vec3 along_u = share * weighted(s, s.n_u, w), along_v = share * weighted(s, s.n_v, w);
    const double uu = foot.tangent_u.squaredNorm(), uv = foot.tangent_u.dot(foot.tangent_v), vv = foot.tangent_v.squaredNorm();
    const double det = uu * vv - uv * uv;
    const Vec3 dual_u = (vv * foot.tangent_u - uv * foot.tangent_v) / det, dual_v = (uu * foot.tangent_v - uv * foot.tangent_u) / det;
    station.slope = along_u * dual_u.transpose() + along_v * dual_v.transpose();
}

void WallStations::forget(int first, int last)
{
    for (int i = first; i < last; ++i) stations_[i].near = false;
}

Vec3 WallStations::displacement(const WallStation& station, std::span<const double> w) const
{
    return weighted(station.weights, station.weights.n, w);
}

void wall_compliance(const WallStations& stations, std::span<const int> rows, const WallFactor& factor, std::vector<double>& w)
{
    const std::size_t m = 3 * rows.size();
    w.assign(m * m, 0.0);
    // control vertices that any of them has a share of, in order
    std::vector<std::int32_t> touched;
    for (const int node : rows) {
        const LoopStencil& s = stations[node].weights;
        touched.insert(touched.end(), s.vertex.begin(), s.vertex.begin() + s.size);
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    std::vector<Eigen::Matrix3d> answer(touched.size());  // of each touched vertex to a force on station j
    for (std::size_t j = 0; j < rows.size(); ++j) {
        const LoopStencil& sj = stations[rows[j]].weights;
        std::fill(answer.begin(), answer.end(), Eigen::Matrix3d::Zero());
        for (int k = 0; k < sj.size; ++k) {
            const std::span<const double> columns = factor.columns(sj.vertex[k]);
            const std::size_t size = columns.size() / 3;
            for (std::size_t t = 0; t < touched.size(); ++t)
                for (int c = 0; c < 3; ++c) {
                    const double* moved = &columns[static_cast<std::size_t>(c) * size + 3 * static_cast<std::size_t>(touched[t])];
                    for (int r = 0; r < 3; ++r) answer[t](r, c) += sj.n[k] * moved[r];
                }
        }
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const LoopStencil& si = stations[rows[i]].weights;
            Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
            for (int k = 0; k < si.size; ++k) {
                const auto t = std::lower_bound(touched.begin(), touched.end(), si.vertex[k]) - touched.begin();
                block += si.n[k] * answer[static_cast<std::size_t>(t)];
            }
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) w[(3 * i + r) * m + 3 * j + c] = block(r, c);
        }
    }
}

}  // namespace seldinger

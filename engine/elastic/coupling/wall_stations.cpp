// Feet of nodes on an elastic wall, and the wall's compliance under them.
#include "coupling/wall_stations.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace seldinger {
namespace {

// Factor on the wall's largest displacement: nodes may be that far from the initial wall and still touch it. The largest is that
// of the examined points; no other has moved much farther.
constexpr double farthest_factor = 1.25;

constexpr double fade_length = 4;  // radii over which U fades out

// Passes of y = x - U(foot of y): each reduces the error by the slope of U. A node with a known y takes its next pass in the next
// step.
constexpr int most_passes = 4;
constexpr double settled = 1e-3;  // radii

// |G| up to which positions are carried back. Linear theory ends far below, and 1 + G is singular from 1 on.
constexpr double steepest = 0.5;

double length_from(const Vec3& a, const Vec3& b) { return (a - b).norm(); }

/// 1 up to `full`, 0 from `none` on, smooth between.
double fade(double distance, double full, double none)
{
    const double t = std::clamp((distance - full) / (none - full), 0.0, 1.0);
    return 1 - t * t * (3 - 2 * t);
}

}  // namespace

WallStations::WallStations(const ElasticWall& wall, int nodes) : wall_(wall), stations_(nodes), feet_(nodes), clear_(nodes) {}

void WallStations::provide(int nodes)
{
    stations_.resize(nodes);
    feet_.resize(nodes);
    clear_.resize(nodes);
}

void WallStations::copy(const WallStations& other, int first, int last)
{
    std::copy(other.stations_.begin() + first, other.stations_.begin() + last, stations_.begin() + first);
    std::copy(other.feet_.begin() + first, other.feet_.begin() + last, feet_.begin() + first);
    std::copy(other.clear_.begin() + first, other.clear_.begin() + last, clear_.begin() + first);
}

/// The nearest point of the unmoved surface to y, from where it was looked for last.
LoopFoot WallStations::foot_of(const WallFoot& last, const Vec3& y) const
{
    LoopFoot foot;
    if (last.triangle >= 0 && length_from(y, Vec3(last.node)) < 0.5 * wall_.edge()) {
        foot.triangle = static_cast<std::int32_t>(last.triangle);
        foot.u = last.u;
        foot.v = last.v;
    }
    wall_.surface().closest(y, foot);
    return foot;
}

/// U, faded, and its slope at the foot of y.
WallStations::Under WallStations::under(const LoopFoot& foot, const Vec3& y, const WallDynamics& wall, double radius) const
{
    Under at;
    wall_.surface().basis(foot.triangle, foot.u, foot.v, at.weights);
    LoopStencil& s = at.weights;
    Vec3 along_u = Vec3::Zero(), along_v = Vec3::Zero();
    for (int k = 0; k < s.size && !wall.still(); ++k) {
        const Vec3 w = wall.now(s.vertex[k]);
        at.move += s.n[k] * w;
        along_u += s.n_u[k] * w;
        along_v += s.n_v[k] * w;
    }
    const Vec3 from_wall = y - foot.position;
    at.distance = foot.rim ? from_wall.norm() : std::abs(from_wall.dot(foot.normal));
    // the mesh that contact sees is up to off() from the smooth surface
    const double full = 2 * radius + wall_.off();
    at.share = fade(at.distance, full, full + fade_length * radius);
    at.move *= at.share;
    for (int k = 0; k < s.size; ++k) s.n[k] *= at.share;
    // u_,u and u_,v against the dual base of the two tangents
    const double uu = foot.tangent_u.squaredNorm(), uv = foot.tangent_u.dot(foot.tangent_v), vv = foot.tangent_v.squaredNorm();
    const double det = uu * vv - uv * uv;
    const Vec3 dual_u = (vv * foot.tangent_u - uv * foot.tangent_v) / det,
               dual_v = (uu * foot.tangent_v - uv * foot.tangent_u) / det;
    at.slope = at.share * (outer(along_u, dual_u) + outer(along_v, dual_v));
    if (const double size = at.slope.norm(); size > steepest) at.slope *= steepest / size;
    return at;
}

void WallStations::place(int node, const Vec3& x, const Vec3* before, const WallDynamics& wall, double radius)
{
    WallStation& station = stations_[node];
    if (station.near && station.at == x) return;
    station.near = false;
    WallFoot last = feet_[node];
    feet_[node] = {};
    Clear& clear = clear_[node];
    const double reach = 2 * radius + wall_.off() + fade_length * radius + farthest_factor * wall.farthest();
    if (clear.distance - length_from(x, clear.at) > reach) return;
    Vec3 y = before ? *before : x;
    for (int pass = 0; pass < (before ? 1 : most_passes); ++pass) {
        const LoopFoot foot = foot_of(last, y);
        clear = {x, foot.distance - length_from(x, y)};
        if (clear.distance > reach) return;
        const Under at = under(foot, y, wall, radius);
        if (at.share == 0 && (before || pass == 0)) return;
        last = feet_[node] = {{y.x(), y.y(), y.z()}, foot.u, foot.v, foot.triangle};
        station.near = true;
        station.weights = at.weights;
        station.distance = at.distance;
        station.start = at.move;
        station.back = wall.still() ? Mat3(Mat3::Identity()) : Mat3((Mat3::Identity() + at.slope).inverse());
        const double change = length_from(y, x - at.move);
        y = x - at.move;
        if (change < settled * radius) break;
    }
    station.at = x;
    station.row = -1;
}

Vec3 WallStations::seen_at(const Vec3& x, Vec3 y, const WallDynamics& wall, double radius) const
{
    for (int pass = 0; pass < 2 * most_passes; ++pass) {
        const Vec3 last = y;
        y = x - under(foot_of({}, y), y, wall, radius).move;
        if (length_from(y, last) < settled * radius) break;
    }
    return y;
}

void WallStations::forget(int first, int last)
{
    for (int i = first; i < last; ++i) stations_[i].near = false;
}

void StationCompliance::reset(const WallStations& stations, std::span<const int> rows, WallPatch& patch)
{
    patch_ = &patch;
    for (const int slot : slots_) place_[static_cast<std::size_t>(slot)] = -1;
    slots_.clear();
    parts_.clear();
    first_.assign(1, 0);
    for (const int node : rows) {
        const LoopStencil& s = stations[node].weights;
        for (int k = 0; k < s.size; ++k) {
            const int slot = patch.slot(s.vertex[k]);
            if (static_cast<int>(place_.size()) <= slot) place_.resize(static_cast<std::size_t>(slot) + 64, -1);
            int& place = place_[static_cast<std::size_t>(slot)];
            if (place < 0) {
                place = static_cast<int>(slots_.size());
                slots_.push_back(slot);
            }
            parts_.push_back({place, s.n[k]});
        }
        first_.push_back(parts_.size());
    }
    users_.assign(slots_.size(), 0);
    for (const Part& part : parts_) ++users_[static_cast<std::size_t>(part.slot)];
    rising_.resize(slots_.size());
    std::iota(rising_.begin(), rising_.end(), 0);
    std::sort(rising_.begin(), rising_.end(),
              [&](int a, int b) { return slots_[static_cast<std::size_t>(a)] < slots_[static_cast<std::size_t>(b)]; });
    needed_.resize(slots_.size());
    known_.assign(rows.size(), Unknown);
    wanted_.clear();
    w_.resize(9 * rows.size() * rows.size());
}

void StationCompliance::want(int row)
{
    Row& known = known_[static_cast<std::size_t>(row)];
    if (known != Unknown) return;
    known = Wanted;
    wanted_.push_back(static_cast<std::size_t>(row));
}

// Rows of the patch do not fit the cache, and stations beside each other share most of theirs: a few at once.
void StationCompliance::provide()
{
    constexpr std::size_t at_once = 8;
    for (std::size_t begin = 0; begin < wanted_.size(); begin += at_once)
        provide_some(std::span(wanted_).subspan(begin, std::min(at_once, wanted_.size() - begin)));
    wanted_.clear();
}

/// Slots that share in a row which is not known yet: W is symmetric. Short runs, so that sums over one stay in the cache.
/// @return how many
std::size_t StationCompliance::list_needed()
{
    constexpr int longest = 48;
    runs_.clear();
    int count = 0;
    for (const int place : rising_) {
        if (users_[static_cast<std::size_t>(place)] == 0) continue;
        const int slot = slots_[static_cast<std::size_t>(place)];
        needed_[static_cast<std::size_t>(place)] = count++;
        if (!runs_.empty() && runs_.back().slot + runs_.back().count == slot && runs_.back().count < longest)
            ++runs_.back().count;
        else runs_.push_back({slot, 1});
    }
    return static_cast<std::size_t>(count);
}

void StationCompliance::provide_some(std::span<const std::size_t> some)
{
    const std::size_t size = 9 * list_needed();
    shares_.clear();
    for (std::size_t k = 0; k < some.size(); ++k)
        for (std::size_t part = first_[some[k]]; part < first_[some[k] + 1]; ++part) {
            shares_.push_back({parts_[part].slot, k, parts_[part].share});
            patch_->provide(slots_[static_cast<std::size_t>(parts_[part].slot)]);
        }
    std::stable_sort(shares_.begin(), shares_.end(), [](const Share& a, const Share& b) { return a.slot < b.slot; });
    answer_.assign(some.size() * size, 0.0);
    double* run_to = answer_.data();
    for (const Run& run : runs_) {
        const int count = 9 * run.count;
        for (const Share& own : shares_) {  // along a row of the patch, which lies as it is read
            const float* const g = patch_->block(slots_[static_cast<std::size_t>(own.slot)], run.slot);
            double* const to = run_to + own.station * size;
            for (int c = 0; c < count; ++c) to[c] += own.share * g[c];
        }
        run_to += count;
    }
    for (std::size_t k = 0; k < some.size(); ++k) put(some[k], std::span(answer_).subspan(k * size, size));
}

/// Of a station, three rows and columns of W. @param answer  [needed slots][9] to a force on it
void StationCompliance::put(std::size_t own, std::span<const double> answer)
{
    const std::size_t rows = known_.size(), m = 3 * rows;
    known_[own] = Known;
    for (std::size_t part = first_[own]; part < first_[own + 1]; ++part) --users_[static_cast<std::size_t>(parts_[part].slot)];
    for (std::size_t other = 0; other < rows; ++other) {
        if (known_[other] == Known && other != own) continue;
        double block[9] = {};
        for (std::size_t part = first_[other]; part < first_[other + 1]; ++part) {
            const double* const from =
                &answer[9 * static_cast<std::size_t>(needed_[static_cast<std::size_t>(parts_[part].slot)])];
            for (int c = 0; c < 9; ++c) block[c] += parts_[part].share * from[c];
        }
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 3; ++c) {
                w_[(3 * own + r) * m + 3 * other + c] = block[3 * r + c];
                w_[(3 * other + c) * m + 3 * own + r] = block[3 * r + c];
            }
    }
}

void StationCompliance::add(int row, const Vec3& force, std::span<double> to) const
{
    for (int c = 0; c < 3; ++c) {
        const double* const from = &w_[(3 * static_cast<std::size_t>(row) + static_cast<std::size_t>(c)) * to.size()];
        for (std::size_t k = 0; k < to.size(); ++k) to[k] += force[c] * from[k];
    }
}

}  // namespace seldinger

// Lays the paths to a target over a centreline and measures wires against them.
#include "navigate.h"

#include "core/parallel.h"
#include "rod/transport.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace seldinger::python {
namespace {

// What numbers are divided by, so that a policy sees them near one.
constexpr double way_scale = 0.1;       // [m]
constexpr double force_scale = 0.5;     // [N]
constexpr double torque_scale = 1e-3;   // [N m]
constexpr double contact_scale = 10.0;  // contacts in number
constexpr double bend_arm = 0.015;      // the tip's side is where it points against what is so far behind it [m]

Vec3 across(const Vec3& u)
{
    const Vec3 size = u.cwiseAbs();
    const int least = size.x() <= size.y() && size.x() <= size.z() ? 0 : size.y() <= size.z() ? 1 : 2;
    return u.cross(Vec3::Unit(least)).normalized();
}

/// Place on the wire's axis so far from the tip [m].
Vec3 along(const ConstRodView& rod, double s)
{
    for (int i = 0; i + 1 < rod.n; ++i) {
        const double length = (rod.pos(i + 1) - rod.pos(i)).norm();
        if (s <= length) return rod.pos(i) + (length > 0 ? s / length : 0.0) * (rod.pos(i + 1) - rod.pos(i));
        s -= length;
    }
    return rod.pos(rod.n - 1);
}

}  // namespace

Navigator::Navigator(const Centreline& line, const NavigateSpec& spec) : spec_(spec)
{
    const std::size_t count = line.points.size();
    if (count < 2)
        throw Error(ErrorKind::BadScene, "navigate: the scene's vessel has no centreline; expected a vessel with branches");
    std::vector<std::vector<int>> joined(count);
    for (std::size_t i = 0; i < count; ++i) {
        x_.push_back(line.points[i].x()), y_.push_back(line.points[i].y()), z_.push_back(line.points[i].z());
        radius_.push_back(std::max(line.radius[i], 1e-4));
        if (line.parent[i] < 0) continue;
        joined[i].push_back(line.parent[i]);
        joined[static_cast<std::size_t>(line.parent[i])].push_back(static_cast<int>(i));
    }
    left_.assign(count, std::numeric_limits<double>::infinity());
    next_.assign(count, -1);
    u_.resize(count), n_.resize(count), b_.resize(count);
    const int goal = line.nearest(spec.target);
    std::queue<int> open;
    const auto reach = [&](int i, int from) {
        const Vec3 step = line.points[from] - line.points[i];
        left_[i] = i == from ? 0.0 : left_[from] + step.norm();
        next_[i] = from;
        if (i == from) u_[i] = Vec3::Zero();
        else u_[i] = step.norm() > 0 ? Vec3(step.normalized()) : u_[from];
        open.push(i);
    };
    reach(goal, goal);
    const int beside = joined[goal].empty() ? goal : joined[goal].front();
    u_[goal] = (line.points[goal] - line.points[beside]).normalized();
    n_[goal] = across(u_[goal]);
    for (; !open.empty(); open.pop()) {
        const int i = open.front();
        if (i != goal) n_[i] = carried_director(n_[next_[i]], u_[next_[i]], u_[i]);
        b_[i] = u_[i].cross(n_[i]);
        for (const int j : joined[i])
            if (next_[j] < 0) reach(j, i);
    }
}

Navigator::Place Navigator::locate(const Vec3& p) const
{
    int at = 0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < x_.size(); ++i) {
        const double dx = x_[i] - p.x(), dy = y_[i] - p.y(), dz = z_[i] - p.z(), d2 = dx * dx + dy * dy + dz * dz;
        if (d2 < best && next_[i] >= 0) best = d2, at = static_cast<int>(i);
    }
    const Vec3 off = p - Vec3(x_[at], y_[at], z_[at]);
    return {at, left_[at] - off.dot(u_[at]), off.dot(n_[at]) / radius_[at], off.dot(b_[at]) / radius_[at]};
}

double Navigator::way(const Vec3& place) const { return locate(place).left; }

Vec3 Navigator::ahead(int at, double distance) const
{
    const double stop = std::max(0.0, left_[at] - distance);
    int i = at;
    while (next_[i] != i && left_[i] > stop) i = next_[i];
    return {x_[i], y_[i], z_[i]};
}

void Navigator::see(const World& world, int system, bool failed, float* to, double* measures) const
{
    const int wire = world.wires_of(system).first;
    const ConstRodView rod = world.rod(wire);
    const WireReadings now = world.readings(wire);
    const FeedSpec& feed = world.setup().wires[static_cast<std::size_t>(wire)].feed;
    const Vec3 tip = rod.pos(0);
    const Vec3 forward = (rod.pos(0) - rod.pos(1)).normalized();
    const Vec3 lever = along(rod, bend_arm) - tip;
    // the side that the tip bends to; of a straight one what the centreline calls its side
    Vec3 side = -lever - (-lever).dot(forward) * forward;
    const Place here = locate(tip);
    side = side.norm() > 1e-5 ? Vec3(-side.normalized()) : Vec3((n_[here.at] - n_[here.at].dot(forward) * forward).normalized());
    const Vec3 other = forward.cross(side);

    const auto put = [&to](double value) { *to++ = static_cast<float>(std::clamp(value, -10.0, 10.0)); };
    const auto put_in = [&](const Vec3& v, const Vec3& a, const Vec3& b, const Vec3& c) {
        put(v.dot(a)), put(v.dot(b)), put(v.dot(c));
    };
    put(here.left / way_scale), put(here.n), put(here.b);
    put_in(forward, u_[here.at], n_[here.at], b_[here.at]);
    put(side.dot(n_[here.at])), put(side.dot(b_[here.at]));
    for (int k = 1; k <= spec_.ahead_points; ++k)
        put_in((ahead(here.at, k * spec_.ahead_spacing) - tip) / way_scale, forward, side, other);
    for (int k = 1; k <= spec_.shape_points; ++k) {
        const Place there = locate(along(rod, k * spec_.shape_spacing));
        put((there.left - here.left) / way_scale), put(there.n), put(there.b);
    }
    const double advance = feed.advance + now.inserted, turn = feed.turn + now.turned;
    put(now.hand_force / force_scale), put(now.hand_torque / torque_scale);
    put(now.normal / force_scale), put(now.contacts / contact_scale);
    put(advance / way_scale), put(std::sin(turn)), put(std::cos(turn));

    const double values[measure_count] = {
        here.left, (tip - spec_.target).norm(), now.hand_force,  now.hand_torque, now.normal, advance,
        turn,      failed ? 1.0 : 0.0,          world.time(wire)};
    std::copy(std::begin(values), std::end(values), measures);
}

void Navigator::observe(const World& world, std::span<const std::uint8_t> failed, std::span<float> observation,
                        std::span<double> measures) const
{
    for_each_item(world.system_count(), 8, [&](int s) {
        if (world.retired(s)) return;
        bool any = false;
        const auto [first, end] = world.wires_of(s);
        for (int w = first; w < end && !failed.empty(); ++w) any = any || failed[static_cast<std::size_t>(w)];
        see(world, s, any, observation.data() + static_cast<std::size_t>(s) * static_cast<std::size_t>(size()),
            measures.data() + static_cast<std::size_t>(s) * measure_count);
    });
}

}  // namespace seldinger::python

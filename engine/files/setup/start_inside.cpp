// Finds where a placed axis lies beyond the wall. A shallow stretch is moved into the lumen, with a note; a deep one is refused.
#include "setup/start_inside.h"

#include "rod/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace seldinger {
namespace {

constexpr int most_settling_rounds = 100;
constexpr double ramp_radii = 10;  // a move of two diameters turns the wire by 1.5 * 4/10 rad at most
constexpr double finest_radii = 0.5;

/// A point of the axis and the wall nearest to it.
struct AxisSample {
    int edge = 0;
    double bary = 0;
    Vec3 point = Vec3::Zero();
    double clearance = 0;  // from the axis to the wall [m], < 0 beyond it
    Vec3 inward = Vec3::Zero();
};

class Start {
public:
    Start(const WireSpec& wire, const Centreline& centreline, const LumenQuery& lumen)
        : wire_(wire),
          centreline_(centreline),
          lumen_(lumen),
          rods_(std::vector<int>{uniform_node_count(wire)}),
          rod_(rods_.view(0))
    {
        place();
        pushed_.assign(edges(), 0);
    }

    /// The axis, finely where it is near the wall; from a point well clear of it the next one is looked up at that distance.
    void sample()
    {
        samples_.clear();
        for (int j = 0; j < edges(); ++j) {
            const double length = (rod().pos(j + 1) - rod().pos(j)).norm();
            for (double s = 0; s < length;) {
                samples_.push_back(look(j, s / length));
                s += std::max(samples_.back().clearance - radius(j), finest_radii * radius(j));
            }
        }
        samples_.push_back(look(edges() - 1, 1));
    }

    [[nodiscard]] const AxisSample& deepest() const
    {
        return *std::min_element(samples_.begin(), samples_.end(),
                                 [](const AxisSample& a, const AxisSample& b) { return a.clearance < b.clearance; });
    }

    /// Moves every stretch that has to go by a part of its path. @return false: none has; nothing where one has no path to go
    std::optional<bool> push()
    {
        bool any = false;
        std::vector<Vec3> move(rod().n, Vec3::Zero());
        for (std::size_t first = 0; first < samples_.size();) {
            if (!near_wall(samples_[first])) {
                ++first;
                continue;
            }
            std::size_t last = first;
            bool goes = false;
            for (; last < samples_.size() && near_wall(samples_[last]); ++last)
                goes = goes || samples_[last].clearance < 0 || pushed_[samples_[last].edge];
            if (goes && !push_stretch(first, last, move)) return std::nullopt;
            any = any || goes;
            first = last;
        }
        if (any) lay_along(move);
        return any;
    }

    void adopt(WireSpec& wire) const { wire.place = wire_.place; }
    Start(const Start&) = delete;
    [[nodiscard]] const RodView& rod() const { return rod_; }

private:
    [[nodiscard]] int edges() const { return rod().n - 1; }
    [[nodiscard]] double radius(int edge) const { return rod().radius[edge]; }
    [[nodiscard]] bool near_wall(const AxisSample& at) const { return at.clearance < radius(at.edge); }

    void place()
    {
        place_wire(rods_, 0, wire_, centreline_.main_points());
        rod_ = rods_.view(0);
    }

    [[nodiscard]] AxisSample look(int edge, double bary) const
    {
        AxisSample at{.edge = edge, .bary = bary, .point = (1 - bary) * rod().pos(edge) + bary * rod().pos(edge + 1)};
        const LumenPlace place = lumen_.locate(at.point);
        at.clearance = place.clearance(at.point);
        const Vec3 away = at.point - place.nearest;
        at.inward =
            away.norm() > 1e-3 * radius(edge) ? Vec3((place.signed_distance < 0 ? -1 : 1) * away.normalized()) : place.normal;
        return at;
    }

    [[nodiscard]] double material_s(const AxisSample& at) const
    {
        return (1 - at.bary) * rod().material_s[at.edge] + at.bary * rod().material_s[at.edge + 1];
    }

    /// Adds the move of samples [first, last) to that of the nodes. @return false where the walls push against each other
    bool push_stretch(std::size_t first, std::size_t last, std::vector<Vec3>& move)
    {
        Vec3 way = Vec3::Zero();
        double weight = 0, missing = 0;
        for (std::size_t k = first; k < last; ++k) {
            const double lacks = radius(samples_[k].edge) - samples_[k].clearance;
            way += lacks * samples_[k].inward;
            weight += lacks;
            missing = std::max(missing, lacks);
            pushed_[samples_[k].edge] = 1;
        }
        if (way.norm() < 0.05 * weight) return false;
        const double r = radius(samples_[first].edge);
        way *= std::clamp(missing, 0.05 * r, 0.5 * r) / way.norm();
        const double from = material_s(samples_[first]), to = material_s(samples_[last - 1]);
        for (int i = 0; i < rod().n - 2; ++i) {  // the base and its direction stay as they were given
            const double s = rod().material_s[i], beyond = std::max({from - s, s - to, 0.0});
            const double u = std::clamp((beyond - rest_edge()) / (ramp_radii * r), 0.0, 1.0);
            move[i] += (1 - u * u * (3 - 2 * u)) * way;
        }
        return true;
    }

    [[nodiscard]] double rest_edge() const { return wire_.length / edges(); }

    void lay_along(const std::vector<Vec3>& move)
    {
        std::vector<Vec3> points;
        for (int i = rod().n - 1; i >= 0; --i) points.push_back(rod().pos(i) + move[i]);
        // the moved axis may be a little shorter than the wire
        const Vec3 last = points.back() - points[points.size() - 2];
        points.push_back(points.back() + (0.1 * wire_.length / last.norm()) * last);
        wire_.place.shape = PlaceShape::Points;
        wire_.place.points = std::move(points);
        place();
    }

    WireSpec wire_;
    const Centreline& centreline_;
    const LumenQuery& lumen_;
    RodArrays rods_;
    RodView rod_;
    std::vector<AxisSample> samples_;
    std::vector<std::uint8_t> pushed_;  // [edges] of a stretch that was beyond the wall
};

std::string where_it_is(const Start& start, const AxisSample& at)
{
    const RodView& rod = start.rod();
    const double s = (1 - at.bary) * rod.material_s[at.edge] + at.bary * rod.material_s[at.edge + 1];
    const std::string what = at.bary == 0   ? fmt::format("node {}", at.edge)
                             : at.bary == 1 ? fmt::format("node {}", at.edge + 1)
                                            : fmt::format("the shaft between nodes {} and {}", at.edge, at.edge + 1);
    return fmt::format("{}, {:.4g} mm from the tip, at [{:.6g}, {:.6g}, {:.6g}] is {:.4g} mm beyond the wall", what, 1e3 * s,
                       at.point.x(), at.point.y(), at.point.z(), -1e3 * at.clearance);
}

std::vector<Vec3> nodes_of(const RodView& rod)
{
    std::vector<Vec3> nodes;
    for (int i = 0; i < rod.n; ++i) nodes.push_back(rod.pos(i));
    return nodes;
}

double farthest_move(const RodView& now, const std::vector<Vec3>& then)
{
    double farthest = 0;
    for (int i = 0; i < now.n; ++i) farthest = std::max(farthest, (now.pos(i) - then[i]).norm());
    return farthest;
}

}  // namespace

StartInside start_inside(WireSpec& wire, const Centreline& centreline, const LumenQuery& lumen)
{
    StartInside result;
    Start start(wire, centreline, lumen);
    start.sample();
    const AxisSample worst = start.deepest();
    if (worst.clearance >= 0) return result;
    const std::string where = where_it_is(start, worst);
    result.refused = where + "; expected the axis inside the lumen, move place.base or bend the shape";
    const bool ring = wire.place.shape == PlaceShape::Ring;  // its ends would come apart
    const RodView& rod = start.rod();
    if (ring || -worst.clearance > 2 * rod.radius[worst.edge] || lumen.signed_distance(rod.pos(rod.n - 1)) < 0) return result;
    const std::vector<Vec3> given = nodes_of(rod);
    for (int round = 0; round < most_settling_rounds; ++round) {
        const std::optional<bool> moved = start.push();
        if (!moved) return result;
        if (!*moved) {
            start.adopt(wire);
            result.refused.clear();
            result.moved = fmt::format("{}: moved into the lumen, by up to {:.3g} mm", where, 1e3 * farthest_move(rod, given));
            return result;
        }
        start.sample();
    }
    return result;
}

}  // namespace seldinger

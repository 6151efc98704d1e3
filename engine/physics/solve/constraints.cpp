// Places and times of holds, loads and links: points of the wire by their material distance, times by their keys.
#include "solve/constraints.h"

#include "core/error.h"
#include "rod/transport.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

/// Piecewise linear through rows [t, v...], constant outside.
template <std::size_t width>
std::array<double, width - 1> interpolate(const std::vector<std::array<double, width>>& keys, double t)
{
    std::array<double, width - 1> value{};
    if (keys.empty()) return value;
    const auto next = std::find_if(keys.begin(), keys.end(), [&](const auto& key) { return key[0] > t; });
    const auto& b = next == keys.end() ? keys.back() : *next;
    const auto& a = next == keys.begin() || next == keys.end() ? b : *(next - 1);
    const double weight = &a == &b ? 0.0 : (t - a[0]) / (b[0] - a[0]);
    for (std::size_t c = 0; c + 1 < width; ++c) value[c] = a[c + 1] + weight * (b[c + 1] - a[c + 1]);
    return value;
}

Vec3 displacement(const HoldSpec& hold, double t)
{
    const auto [x, y, z] = interpolate(hold.move, t);
    const Vec3 moved = {x, y, z};
    return hold.velocity.isZero() ? moved : Vec3(moved + t * hold.velocity);  // t may be infinite
}

/// Whether something that ends is over in the state at time t. Times of steps are sums: one that ends a step late by rounding has
/// not begun.
bool is_over(double t, double until) { return t > until * (1 + 1e-9); }

double ramp_factor(const LoadSpec& load, double t) { return load.ramp > 0 ? std::clamp(t / load.ramp, 0.0, 1.0) : 1.0; }

constexpr int most_clamps = 12;  // RodFrames has room for 16; feeding and rings add their own

Vec3 material_director(const RodView& rod, int edge)
{
    const Vec3 d1 = rod.ref_d1(edge), d2 = rod.tangent(edge).cross(d1);
    return std::cos(rod.theta[edge]) * d1 + std::sin(rod.theta[edge]) * d2;
}

void check_on_wire(const char* what, std::size_t index, const WirePoint& at, double length)
{
    if (at.kind != WirePoint::Kind::Distance) return;
    if (at.from_tip >= 0 && at.from_tip <= length * (1 + 1e-9)) return;
    throw Error(ErrorKind::BadScene, fmt::format("{}[{}].at: {:g} m from the tip is not on the wire, which is {:g} m long; "
                                                 "give \"base\", \"tip\" or a distance from 0 to {:g}",
                                                 what, index, at.from_tip, length, length));
}

void check_holds_something(std::size_t index, const HoldSpec& spec)
{
    if (spec.holds(0) || spec.holds(1) || spec.holds(2) || spec.direction || spec.spin) return;
    throw Error(ErrorKind::BadScene, fmt::format("hold[{}] holds nothing: set position, direction or spin to true", index));
}

/// By how much the director turns about the tangent from the middle of an end edge to its end [rad]: half an edge of the twist
/// that its inner node has per length.
double twist_to_end(const RodView& rod, int node)
{
    if (rod.n < 3) return 0;
    const int edge = std::min(node, rod.n - 2), inner = node == 0 ? 1 : rod.n - 2;
    const double rate = (rod.theta[inner] - rod.theta[inner - 1] + rod.ref_twist[inner]) / rod.voronoi_length(inner);
    return (node == 0 ? -0.5 : 0.5) * rod.rest_length[edge] * rate;
}

}  // namespace

// At an inner node the mean of the two edges. At an end the straight continuation of the turning from edge to edge, since the
// edge's own tangent and director are those of its middle.
NodeFrame node_frame(const RodView& rod, int node)
{
    const int last = rod.n - 2;
    const int before = std::max(node - 1, 0), after = std::min(node, last);
    Vec3 tangent = rod.tangent(before) + rod.tangent(after);
    if (before == after && rod.n > 2) {
        const int neighbour = node == 0 ? 1 : last - 1;
        tangent = 1.5 * rod.tangent(after) - 0.5 * rod.tangent(neighbour);
    }
    tangent.normalize();
    Vec3 director = Vec3::Zero();
    for (const int edge : {before, after})
        director += parallel_transport(material_director(rod, edge), rod.tangent(edge), tangent,
                                       one_plus_cos(rod.tangent(edge), tangent));
    director -= director.dot(tangent) * tangent;
    director.normalize();
    if (before == after) director = turned(director, tangent, twist_to_end(rod, node));
    return {tangent, director};
}

namespace {

/// A wire may be placed with whole turns in it (a ring): the twist between a hold and its edges starts from their angles, so that
/// none of them is lost. Reference twists as in rod/clamp.h.
void count_turns(const RodView& rod, int node)
{
    const bool end = node == 0 || node == rod.n - 1;
    const double beyond = end ? twist_to_end(rod, node) : 0.0;
    if (node > 0) rod.clamp_twist_a[node] = rod.theta[node - 1] + beyond;
    if (node < rod.n - 1) rod.clamp_twist_b[node] = -rod.theta[node] - beyond;
}

}  // namespace

WireHolds::WireHolds(std::span<const HoldSpec> holds, std::span<const LoadSpec> loads, std::span<const LinkSpec> links,
                     const RodView& rod, double wire_length)
    : loads_(loads.begin(), loads.end()), links_(links.begin(), links.end())
{
    for (std::size_t k = 0; k < loads_.size(); ++k) check_on_wire("load", k, loads_[k].at, wire_length);
    for (std::size_t k = 0; k < links_.size(); ++k) check_on_wire("link", k, links_[k].at, wire_length);
    for (std::size_t k = 0; k < holds.size(); ++k) {
        const HoldSpec& spec = holds[k];
        // a hold must find its node now; material that is fed later cannot be held
        check_on_wire("hold", k, spec.at, rod.material_s[rod.n - 1]);
        check_holds_something(k, spec);
        Hold hold;
        hold.spec = spec;
        const int at_node = nearest_node(spec.at, spec.at.from_tip, rod);
        hold.material_s = rod.material_s[at_node];
        if (spec.at.kind == WirePoint::Kind::Distance) {
            hold.offset = std::abs(hold.material_s - spec.at.from_tip);
            held_distances_.push_back(hold.material_s);
        }
        hold.position = rod.pos(at_node);
        const NodeFrame frame = node_frame(rod, at_node);
        hold.tangent = frame.tangent;
        hold.director = frame.director;
        if (spec.spin) count_turns(rod, at_node);
        holds_.push_back(hold);
    }
    const auto is_clamp = [](const Hold& h) { return h.spec.direction || h.spec.spin; };
    const auto clamps = std::count_if(holds_.begin(), holds_.end(), is_clamp);
    if (clamps > most_clamps)
        throw Error(ErrorKind::BadScene,
                    fmt::format("hold: got {} that hold a direction or spin; expected at most {}", clamps, most_clamps));
    refuse_contradictions(rod);
}

void WireHolds::refuse_contradictions(const RodView& rod) const
{
    for (std::size_t a = 0; a < holds_.size(); ++a)
        for (std::size_t b = a + 1; b < holds_.size(); ++b) {
            const HoldSpec &first = holds_[a].spec, &second = holds_[b].spec;
            if (node(static_cast<int>(a), rod) != node(static_cast<int>(b), rod)) continue;
            bool position = false;
            for (int c = 0; c < 3; ++c) position = position || (first.holds(c) && second.holds(c));
            const char* what = position                              ? "position"
                               : first.direction && second.direction ? "direction"
                               : first.spin && second.spin           ? "spin"
                                                                     : nullptr;
            if (what)
                throw Error(ErrorKind::BadScene,
                            fmt::format("hold[{}] and hold[{}] both hold the {} of the same node, {:g} m from the tip: "
                                        "keep one of them, or place them farther apart than the node spacing",
                                        a, b, what, holds_[a].material_s));
        }
}

int WireHolds::nearest_node(const WirePoint& at, double material_s, const RodView& rod)
{
    if (at.kind == WirePoint::Kind::Tip) return 0;
    if (at.kind == WirePoint::Kind::Base) return rod.n - 1;
    const auto begin = rod.material_s.begin(), end = begin + rod.n;
    const auto above = std::lower_bound(begin, end, material_s);
    if (above == end) return rod.n - 1;
    if (above != begin && material_s - *(above - 1) < *above - material_s) return static_cast<int>(above - begin) - 1;
    return static_cast<int>(above - begin);
}

int WireHolds::node(int hold, const RodView& rod) const
{
    return nearest_node(holds_[hold].spec.at, holds_[hold].material_s, rod);
}

WireHolds::Place WireHolds::locate(const WirePoint& at, const RodView& rod, double offset)
{
    const double length = rod.material_s[rod.n - 1];
    if (!(-offset < length)) return {0, 0.0, false};  // not in yet
    if (at.kind == WirePoint::Kind::Tip && offset == 0) return {0, 0.0, true};
    if (at.kind == WirePoint::Kind::Base) return {rod.n - 2, 1.0, true};
    const auto begin = rod.material_s.begin(), end = begin + rod.n;
    const double s = (at.kind == WirePoint::Kind::Tip ? 0.0 : at.from_tip) - offset;
    if (s > length * (1 + 1e-9)) return {0, 0.0, false};
    const int above = static_cast<int>(std::upper_bound(begin, end, s) - begin);
    const int edge = std::clamp(above - 1, 0, rod.n - 2);
    const double start = rod.material_s[edge], span = rod.material_s[edge + 1] - start;
    return {edge, std::clamp((s - start) / span, 0.0, 1.0), true};
}

void WireHolds::fill(double t, const RodView& rod, WireConstraints& out) const
{
    out.clear();
    for (std::size_t k = 0; k < holds_.size(); ++k) {
        const Hold& hold = holds_[k];
        if (is_over(t, hold.spec.until)) continue;
        const int at_node = node(static_cast<int>(k), rod);
        if (hold.spec.position) {
            const Vec3 position = hold.position + displacement(hold.spec, t);
            for (int c = 0; c < 3; ++c)
                if (hold.spec.axes[static_cast<std::size_t>(c)])
                    out.prescribed.emplace_back(RodDofs::position(at_node, c), position[c]);
        }
        if (hold.spec.direction || hold.spec.spin) {
            const double angle = 0.0 - interpolate(hold.spec.turn, t)[0];  // about the tangent, which points against insertion
            const Vec3 director = turned(hold.director, hold.tangent, angle);
            out.clamps.push_back({at_node, hold.spec.direction, hold.spec.spin, hold.tangent, director, angle});
        }
    }
    add_loads(t, rod, 0, 0, out);
}

void WireHolds::take_line_holds(std::span<const HoldSpec> holds, const RodView& own, double offset)
{
    const double inside = own.material_s[own.n - 1] + offset;
    for (std::size_t k = 0; k < holds.size(); ++k) {
        const HoldSpec& spec = holds[k];
        if (spec.at.kind == WirePoint::Kind::Base)
            throw Error(ErrorKind::BadScene,
                        fmt::format("hold[{}].at: the base is held by the feed already; hold another point", k));
        const double from_tip = spec.at.kind == WirePoint::Kind::Tip ? 0.0 : spec.at.from_tip;
        if (!(from_tip < inside))  // a hold must find its place now; what is fed in later cannot be held
            throw Error(ErrorKind::BadScene,
                        fmt::format("hold[{}].at: {:g} m from the tip is outside: only {:g} m of the instrument are inside; give "
                                    "\"tip\" or a smaller distance, or feed more of it in at the start",
                                    k, from_tip, std::max(inside, 0.0)));
        check_holds_something(k, spec);
        if (spec.position && spec.axes != std::array<bool, 3>{true, true, true})
            throw Error(
                ErrorKind::BadScene,
                fmt::format("hold[{}].position: got some of x, y and z; expected all of the position in a group with model = "
                            "\"merged\". Fix: position = true, or model = \"separate\"",
                            k));
        const Place place = locate(spec.at, own, offset);
        Hold hold{.spec = spec,
                  .material_s = from_tip,
                  .position = (1 - place.bary) * own.pos(place.edge) + place.bary * own.pos(place.edge + 1),
                  .tangent = own.tangent(place.edge),
                  .director = material_director(own, place.edge)};
        holds_.push_back(hold);
    }
}

void WireHolds::add_line_holds(double t, const RodView& line, double offset, WireConstraints& out) const
{
    for (std::size_t k = 0; k < holds_.size(); ++k) {
        const Hold& hold = holds_[k];
        if (is_over(t, hold.spec.until)) continue;
        const double s = hold.material_s - offset;
        // of one that gets ahead of the line within a step the tip is beyond the first node, by less than its edge
        if (!(s > -line.rest_length[0] && s < line.material_s[line.n - 1])) continue;
        const double angle = 0.0 - interpolate(hold.spec.turn, t)[0];  // about the tangent, which points against insertion
        out.line_holds.push_back({static_cast<int>(k), s, hold.spec.position, hold.spec.direction, hold.spec.spin,
                                  hold.position + displacement(hold.spec, t), hold.tangent, hold.director, angle});
    }
}

void WireHolds::add_load(const LoadSpec& load, double t, const RodView& line, double offset, int member, WireConstraints& out)
{
    const Place place = locate(load.at, line, offset);
    const double factor = ramp_factor(load, t);
    if (is_over(t, load.until) || !place.inside) return;
    out.loads.push_back({place.edge, place.bary, factor * load.force, factor * load.moment, member});
}

void WireHolds::add_loads(double t, const RodView& line, double offset, int member, WireConstraints& out) const
{
    for (const LoadSpec& load : loads_) add_load(load, t, line, offset, member, out);
    for (const LinkSpec& link : links_) {
        const Place place = locate(link.at, line, offset);
        const auto [x, y, z] = interpolate(link.move, t);
        if (place.inside) out.springs.push_back({place.edge, place.bary, link.anchor + Vec3(x, y, z), link.stiffness, member});
    }
}

double WireHolds::moving_until() const
{
    double end = 0;
    const auto include = [&](const auto& keys) {
        if (!keys.empty()) end = std::max(end, keys.back()[0]);
    };
    const auto include_end = [&](double until) { end = std::isfinite(until) ? std::max(end, until) : end; };
    for (const Hold& hold : holds_) include(hold.spec.move), include(hold.spec.turn), include_end(hold.spec.until);
    for (const LinkSpec& link : links_) include(link.move);
    for (const LoadSpec& load : loads_) end = std::max(end, load.ramp), include_end(load.until);
    return end;
}

std::vector<double> WireHolds::path(double length) const
{
    constexpr double most_move = 0.005, most_turn = std::numbers::pi / 4, most_parts = 4096;  // [-] of the length, [rad]
    std::vector<double> times = {0};
    const auto include = [&](const auto& keys) {
        for (const auto& key : keys)
            if (key[0] > 0) times.push_back(key[0]);
    };
    for (const Hold& hold : holds_) include(hold.spec.move), include(hold.spec.turn);
    for (const LinkSpec& link : links_) include(link.move);
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    const auto travel = [&](const auto& keys, double from, double until, double most) {
        const auto a = interpolate(keys, from), b = interpolate(keys, until);
        double square = 0;
        for (std::size_t c = 0; c < a.size(); ++c) square += (b[c] - a[c]) * (b[c] - a[c]);
        return std::sqrt(square) / most;
    };
    std::vector<double> path;
    if (times.size() > 1) path.push_back(0);  // work is counted from an equilibrium on
    for (std::size_t k = 1; k < times.size(); ++k) {
        const double from = times[k - 1], until = times[k];
        double parts = 1;
        for (const Hold& hold : holds_)
            parts = std::max(
                {parts, travel(hold.spec.move, from, until, most_move * length), travel(hold.spec.turn, from, until, most_turn)});
        for (const LinkSpec& link : links_) parts = std::max(parts, travel(link.move, from, until, most_move * length));
        const int count = static_cast<int>(std::min(std::ceil(parts - 1e-9), most_parts));
        for (int p = 1; p <= count; ++p) path.push_back(from + (until - from) * p / count);
    }
    if (path.empty()) return {INFINITY};
    path.back() = INFINITY;
    return path;
}

}  // namespace seldinger

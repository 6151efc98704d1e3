// Shapes that a wire can be placed along.
#include "rod/place.h"

#include "core/error.h"
#include "rod/elastic.h"
#include "rod/transport.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace seldinger {
namespace {

constexpr double pi = std::numbers::pi;

// A polyline by arc length.
struct Polyline {
    std::vector<Vec3> points;
    std::vector<double> at;  // arc length of each point

    explicit Polyline(std::vector<Vec3> list) : points(std::move(list)), at(points.size(), 0.0)
    {
        for (std::size_t i = 1; i < points.size(); ++i) at[i] = at[i - 1] + (points[i] - points[i - 1]).norm();
    }
    [[nodiscard]] double length() const { return at.back(); }
    [[nodiscard]] Vec3 operator()(double u) const
    {
        const auto above = std::upper_bound(at.begin() + 1, at.end() - 1, u);
        const std::size_t i = static_cast<std::size_t>(above - at.begin());
        const double span = at[i] - at[i - 1];
        return points[i - 1] + (span > 0 ? (u - at[i - 1]) / span : 0.0) * (points[i] - points[i - 1]);
    }
};

Polyline centreline_path(std::span<const Vec3> path, double from)
{
    if (path.empty()) throw Error(ErrorKind::BadScene, "wire.place: shape \"centreline\" needs a vessel with a centreline");
    Polyline whole({path.begin(), path.end()});
    if (from >= whole.length())
        throw Error(ErrorKind::BadScene,
                    fmt::format("wire.place.from_m: {} m is beyond the vessel's centreline of {:.4g} m", from, whole.length()));
    std::vector<Vec3> rest = {whole(from)};
    for (std::size_t i = 0; i < whole.points.size(); ++i)
        if (whole.at[i] > from) rest.push_back(whole.points[i]);
    return Polyline(std::move(rest));
}

// Where the given points turn back by more than 170 degrees, chords of an edge's length jump from one leg to the other, and the
// wire would lie somewhere else than was asked for.
void refuse_sharp_corners(const std::vector<Vec3>& points)
{
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        const Vec3 before = (points[i] - points[i - 1]).normalized(), after = (points[i + 1] - points[i]).normalized();
        if (before.dot(after) < -std::cos(10 * pi / 180))
            throw Error(ErrorKind::BadScene,
                        fmt::format("wire.place.points: the wire folds back on itself at point {}; expected corners of less than "
                                    "170 degrees, round it off",
                                    i));
    }
}

struct Curve {
    std::function<Vec3(double)> at;  // by arc length from the base
    double length;                   // infinity where it goes on
};

Curve curve_of(const WirePlacement& place, double wire_length, std::span<const Vec3> path)
{
    const Vec3 d = place.direction.normalized();
    Vec3 n = (place.normal - place.normal.dot(d) * d);
    if (n.norm() < 1e-9) n = d.unitOrthogonal();
    n.normalize();
    const double forever = std::numeric_limits<double>::infinity();
    switch (place.shape) {
        case PlaceShape::Arc:
        case PlaceShape::Ring: {
            const double r = place.shape == PlaceShape::Arc ? place.bend_radius : wire_length / (2 * pi);
            return {[=, base = place.base](double u) -> Vec3 {
                        return base + r * std::sin(u / r) * d + r * (1 - std::cos(u / r)) * n;
                    },
                    forever};
        }
        case PlaceShape::Points: {
            refuse_sharp_corners(place.points);
            const Polyline line(place.points);
            // A line of the wire's own length, to the 5 % that a scene may differ, is the asked shape: the length that edges
            // save by cutting corners continues straight.
            const bool goes_on = !place.stretched && 0.95 * wire_length <= line.length() * (1 + 1e-9);
            return {line, goes_on ? forever : line.length()};
        }
        case PlaceShape::Centreline: {
            const Polyline line = centreline_path(path, place.from);
            return {line, line.length()};
        }
        default:
            return {[=, base = place.base](double u) -> Vec3 { return base + u * d; }, forever};
    }
}

// The next point of the curve beyond u whose distance from p is `chord`: bisection, to rounding.
double next_at_chord(const Curve& curve, double u, const Vec3& p, double chord)
{
    double low = u + 0.5 * chord, high = u + chord;
    const double enough = chord * (1 - 1e-9);  // or rounding carries a chord that ends in a sharp corner past it
    while ((curve.at(high) - p).norm() < enough && high < u + 20 * chord) high += 0.25 * chord;
    for (int i = 0; i < 80; ++i) {
        const double mid = (low + high) / 2;
        ((curve.at(mid) - p).norm() < chord ? low : high) = mid;
    }
    return (low + high) / 2;
}

// Curvature and frames are not defined where an edge turns back on the one before.
void refuse_folds(const RodView& rod)
{
    for (int i = 1; i < rod.n - 1; ++i)
        if (one_plus_cos(rod.tangent(i - 1), rod.tangent(i)) <= fold_limit)
            throw Error(ErrorKind::BadScene,
                        fmt::format("wire.place: the wire folds back on itself {:.4g} m from its tip; expected a shape "
                                    "that turns by less than 180 degrees at a point, round the corner off",
                                    rod.material_s[i]));
}

}  // namespace

double uniform_edge(const WireSpec& spec) { return spec.length / (uniform_node_count(spec) - 1); }

int uniform_node_count(const WireSpec& spec)
{
    if (spec.nodes > 0) return spec.nodes;
    const double edge = std::max(spec.min_edge, 0.4 * spec.max_edge);
    return std::max(2, static_cast<int>(std::ceil(spec.length / edge - 1e-9)) + 1);
}

void place_wire(RodArrays& rods, int wire, const WireSpec& spec, std::span<const Vec3> path)
{
    const int n = uniform_node_count(spec);
    rods.set_node_count(wire, n);
    rods.set_curvature(wire, spec.curvature);
    const RodView rod = rods.view(wire);
    const WirePlacement& place = spec.place;
    const Curve curve = curve_of(place, spec.length, path);
    const double h = spec.length / (n - 1);
    // a closed polygon on the ring's circle; everywhere else chords are rest lengths
    const bool ring = place.shape == PlaceShape::Ring;
    // material is shared out evenly, chords are not rest lengths
    const double stretch = place.stretched ? curve.length / spec.length : 1.0;
    double u = 0;
    for (int i = n - 1; i >= 0; --i) {
        rod.set_pos(i, curve.at(u));
        rod.material_s[i] = i * h;
        rod.set_vel(i, place.velocity);
        rod.ax[i] = rod.ay[i] = rod.az[i] = 0;
        rod.theta[i] = rod.spin_acc[i] = rod.ref_twist[i] = 0;
        rod.spin_rate[i] = 0.0 - place.spin_rate;  // theta turns about the edges' tangents, which point against insertion
        if (i > 0) u = ring || place.stretched ? (n - i) * h * stretch : next_at_chord(curve, u, rod.pos(i), h);
        if (u > curve.length * (1 + 1e-9))
            throw Error(ErrorKind::BadScene,
                        fmt::format("wire.place: the wire of {} m is longer than the {:.4g} m that its shape offers to edges of "
                                    "{:.3g} m, which cut corners; give a longer shape or more nodes",
                                    spec.length, curve.length, h));
    }
    initialise_frames(rod, place.normal);
    refuse_folds(rod);
    if (ring)
        for (int j = 0; j < n - 1; ++j) rod.theta[j] = place.twist * ((n - 2 - j) + 0.5) / (n - 1);
    set_rest_shape(rod, spec, place.rest_is_placed);
}

void lay_along(const RodView& rod, std::span<const Vec3> path)
{
    const Curve curve{Polyline({path.begin(), path.end()}), std::numeric_limits<double>::infinity()};
    double u = 0;
    rod.set_pos(rod.n - 1, path.front());
    for (int i = rod.n - 2; i >= 0; --i) {
        u = next_at_chord(curve, u, rod.pos(i + 1), rod.material_s[i + 1] - rod.material_s[i]);
        rod.set_pos(i, curve.at(u));
    }
}

namespace {

/// Squared distance of two segments p + s u and q + t v, s and t in [0, 1] [Ericson05, sec. 5.1.9].
double segments_distance2(const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& v)
{
    const Vec3 r = p - q;
    const double a = u.dot(u), e = v.dot(v), f = v.dot(r);
    double s = 0, t = 0;
    if (e > 0) {
        const double c = u.dot(r), b = u.dot(v), det = a * e - b * b;
        if (a > 0) {
            s = det > 0 ? std::clamp((b * f - c * e) / det, 0.0, 1.0) : 0.0;
            t = b * s + f;
            if (t < 0) {
                t = 0;
                s = std::clamp(-c / a, 0.0, 1.0);
            } else if (t > e) {
                t = 1;
                s = std::clamp((b - c) / a, 0.0, 1.0);
            } else t = t / e;
        } else {
            t = std::clamp(f / e, 0.0, 1.0);
        }
    } else if (a > 0) {
        s = std::clamp(-u.dot(r) / a, 0.0, 1.0);
    }
    const Vec3 d = r + s * u - t * v;
    return d.dot(d);
}

}  // namespace

double axis_distance(const RodView& a, const RodView& b)
{
    double least2 = std::numeric_limits<double>::infinity();
    for (int i = 0; i + 1 < a.n; ++i)
        for (int j = 0; j + 1 < b.n; ++j)
            least2 = std::min(least2, segments_distance2(a.pos(i), a.pos(i + 1) - a.pos(i), b.pos(j), b.pos(j + 1) - b.pos(j)));
    return std::sqrt(least2);
}

}  // namespace seldinger

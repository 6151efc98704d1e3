// The aorta's axis and radii, and the mesh made of them.
#include "shapes/aortic_arch.h"

#include "core/error.h"
#include "shapes/swept_lumen.h"
#include "vessel/triangle_geometry.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

constexpr double kStep = 0.001;      // spacing of axis points [m]
constexpr double kOverhang = 0.008;  // tubes go on behind their ends, to be cut there [m]

/// A curve as points and the length along it.
struct Curve {
    std::vector<Vec3> points;
    std::vector<double> length;
    void add(const Vec3& p)
    {
        length.push_back(points.empty() ? 0.0 : length.back() + (p - points.back()).norm());
        points.push_back(p);
    }
};

/// Points kStep apart on a C1 curve through the knots [Catmull & Rom 1974], end tangents towards the next knot.
Curve through(const std::vector<Vec3>& knots)
{
    Curve curve;
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
        const Vec3 &a = knots[k], &b = knots[k + 1];
        const double span = (b - a).norm();
        // tangents over unequal spans: weighted so that speed is continuous in arc length
        auto tangent = [&](std::size_t i) -> Vec3 {
            if (i == 0 || i + 1 == knots.size()) return (b - a) / span;
            return (knots[i + 1] - knots[i - 1]) / ((knots[i + 1] - knots[i]).norm() + (knots[i] - knots[i - 1]).norm());
        };
        const Vec3 ta = tangent(k) * span, tb = tangent(k + 1) * span;
        const int steps = std::max(1, static_cast<int>(std::lround(span / kStep)));
        for (int i = k == 0 ? 0 : 1; i <= steps; ++i) {
            const double t = static_cast<double>(i) / steps, t2 = t * t, t3 = t2 * t;
            curve.add((2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * ta + (3 * t2 - 2 * t3) * b + (t3 - t2) * tb);
        }
    }
    return curve;
}

/// Radius along the curve: smooth steps between the given places, constant outside them.
struct RadiusKnot {
    double at, radius;  // [m]
};
double radius_at(const std::vector<RadiusKnot>& knots, double s)
{
    if (s <= knots.front().at) return knots.front().radius;
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
        if (s > knots[k + 1].at) continue;
        const double t = (s - knots[k].at) / (knots[k + 1].at - knots[k].at), smooth = t * t * (3 - 2 * t);
        return knots[k].radius + smooth * (knots[k + 1].radius - knots[k].radius);
    }
    return knots.back().radius;
}

std::size_t index_at(const Curve& curve, double s)
{
    const auto it = std::lower_bound(curve.length.begin(), curve.length.end(), s);
    return std::min(static_cast<std::size_t>(it - curve.length.begin()), curve.points.size() - 1);
}

struct Body {
    Vec3 superior, anterior, left, over;  // over: horizontal, from the ascending to the descending aorta
};

Body make_body(const ArchSpec& spec)
{
    if (!(spec.superior.norm() > 0) || !spec.superior.allFinite())
        throw Error(ErrorKind::BadScene, "vessel.axis: got zero; expected a direction");
    const Vec3 superior = spec.superior.normalized();
    const Vec3 anterior = cross_frame(superior, spec.anterior).u, left = superior.cross(anterior);
    return {superior, anterior, left, -std::cos(spec.plane_angle) * anterior + std::sin(spec.plane_angle) * left};
}

/// Lengths along the aorta's axis at which things happen.
struct AortaAxis {
    Curve curve;
    double foot = 0;                                     // end of the straight descending part
    double subclavian = 0, carotid = 0, innominate = 0;  // where branches leave
    double arch_end = 0;                                 // foot of the ascending aorta
};

AortaAxis make_axis(const ArchSpec& spec, const Body& body)
{
    const double a = 0.5 * spec.arch_width, b = spec.arch_height;
    const Vec3 foot = spec.origin + spec.descending_length * body.superior, centre = foot - a * body.over;
    std::vector<Vec3> knots = {spec.origin, spec.origin + 0.4 * spec.descending_length * body.superior,
                               spec.origin + 0.8 * spec.descending_length * body.superior};
    constexpr int kArcKnots = 16;
    for (int k = 0; k <= kArcKnots; ++k) {
        const double t = std::numbers::pi * k / kArcKnots;
        knots.push_back(centre + a * std::cos(t) * body.over + b * std::sin(t) * body.superior);
    }
    // the ascending aorta leans towards the midline on its way down to the root
    const Vec3 down = -std::cos(spec.ascending_tilt) * body.superior + std::sin(spec.ascending_tilt) * body.over;
    const Vec3 ascending_foot = knots.back();
    knots.push_back(ascending_foot + 0.5 * spec.ascending_length * (down - body.superior).normalized());
    knots.push_back(knots.back() + 0.5 * spec.ascending_length * down);

    AortaAxis axis{through(knots)};
    auto length_of = [&](const Vec3& p) {
        std::size_t best = 0;
        for (std::size_t i = 0; i < axis.curve.points.size(); ++i)
            if ((axis.curve.points[i] - p).squaredNorm() < (axis.curve.points[best] - p).squaredNorm()) best = i;
        return axis.curve.length[best];
    };
    axis.foot = length_of(foot);
    axis.arch_end = length_of(ascending_foot);
    axis.carotid = length_of(centre + b * body.superior);  // at the apex
    axis.subclavian = axis.carotid - spec.carotid_to_subclavian;
    axis.innominate = axis.carotid + spec.innominate_to_carotid;
    return axis;
}

SweptTube aorta_tube(const ArchSpec& spec, const AortaAxis& axis)
{
    const double end = axis.curve.length.back();
    const std::vector<RadiusKnot> knots = {{0, 0.5 * spec.diameter_diaphragm},
                                           {axis.foot + 0.5 * (axis.subclavian - axis.foot), 0.5 * spec.diameter_isthmus},
                                           {axis.subclavian, 0.5 * spec.diameter_distal_arch},
                                           {axis.carotid, 0.5 * spec.diameter_proximal_arch},
                                           {axis.innominate + 0.008, 0.5 * spec.diameter_before_innominate},
                                           {axis.arch_end, 0.5 * spec.diameter_ascending},
                                           {end, 0.5 * spec.diameter_root}};
    SweptTube tube{axis.curve.points, {}};
    for (const double s : axis.curve.length) tube.radius.push_back(radius_at(knots, s));
    return tube;
}

/// Leaves the aorta square to its axis and bends to `towards`.
SweptTube branch_tube(const SweptTube& aorta, std::size_t start, const Body& body, const Vec3& towards, double length,
                      double radius)
{
    const Vec3 tangent = (aorta.points[start + 1] - aorta.points[start - 1]).normalized();
    const Vec3 out = (body.superior - tangent * tangent.dot(body.superior)).normalized();
    const Vec3 base = aorta.points[start], knee = base + 0.4 * length * (out + 0.3 * towards.normalized()).normalized();
    const Curve curve = through({base, base + 0.2 * length * out, knee, knee + 0.6 * length * towards.normalized()});
    return {curve.points, std::vector<double>(curve.points.size(), radius)};
}

/// Lengthens the tube straight beyond its end (or its start), and returns the plane that cuts it there again.
LumenEnd overhang(SweptTube& tube, bool at_start)
{
    if (at_start) {
        std::reverse(tube.points.begin(), tube.points.end());
        std::reverse(tube.radius.begin(), tube.radius.end());
    }
    const std::size_t n = tube.points.size();
    const LumenEnd end{tube.points[n - 1], (tube.points[n - 1] - tube.points[n - 2]).normalized(),
                       1.6 * tube.radius[n - 1] + kOverhang};
    for (double s = kStep; s <= kOverhang; s += kStep) {
        tube.points.push_back(end.point + s * end.outward);
        tube.radius.push_back(tube.radius[n - 1]);
    }
    if (at_start) {
        std::reverse(tube.points.begin(), tube.points.end());
        std::reverse(tube.radius.begin(), tube.radius.end());
    }
    return end;
}

Centreline centreline_of(const std::vector<SweptTube>& tubes, const std::vector<std::size_t>& starts)
{
    Centreline line;
    for (std::size_t t = 0; t < tubes.size(); ++t) {
        int previous = t == 0 ? -1 : static_cast<int>(starts[t]);
        for (std::size_t i = t == 0 ? 0 : 1; i < tubes[t].points.size(); ++i) {
            line.points.push_back(tubes[t].points[i]);
            line.radius.push_back(tubes[t].radius[i]);
            line.parent.push_back(previous);
            previous = static_cast<int>(line.points.size()) - 1;
        }
    }
    return line;
}

void check_spec(const ArchSpec& spec)
{
    for (const double length :
         {spec.diameter_diaphragm, spec.diameter_isthmus, spec.diameter_distal_arch, spec.diameter_proximal_arch,
          spec.diameter_before_innominate, spec.diameter_ascending, spec.diameter_root, spec.arch_height, spec.arch_width,
          spec.descending_length, spec.ascending_length, spec.diameter_innominate, spec.diameter_carotid,
          spec.diameter_subclavian, spec.branch_length, spec.fillet})
        if (!(length > 0) || !std::isfinite(length))
            throw Error(ErrorKind::BadScene, "aortic arch: every length must be finite and above 0");
    if (spec.triangles < 2000 || spec.triangles > 4'000'000)
        throw Error(ErrorKind::BadScene,
                    fmt::format("vessel.triangles: got {}; expected 2000 to 4000000 for an aortic arch", spec.triangles));
}

}  // namespace

GeneratedVessel make_aortic_arch(const ArchSpec& spec)
{
    check_spec(spec);
    const Body body = make_body(spec);
    const AortaAxis axis = make_axis(spec, body);
    std::vector<SweptTube> tubes = {aorta_tube(spec, axis)};
    std::vector<std::size_t> starts = {0};
    // the innominate leans to the right and forward, the subclavian to the left and back
    const struct {
        double at, diameter;
        Vec3 towards;
    } branches[] = {{axis.innominate, spec.diameter_innominate, body.superior - 0.45 * body.left + 0.15 * body.anterior},
                    {axis.carotid, spec.diameter_carotid, body.superior - 0.02 * body.left + 0.1 * body.anterior},
                    {axis.subclavian, spec.diameter_subclavian, body.superior + 0.55 * body.left - 0.2 * body.anterior}};
    for (const auto& branch : branches) {
        starts.push_back(index_at(axis.curve, branch.at));
        tubes.push_back(branch_tube(tubes[0], starts.back(), body, branch.towards, spec.branch_length, 0.5 * branch.diameter));
    }
    GeneratedVessel vessel;
    vessel.centreline = centreline_of(tubes, starts);

    std::vector<LumenEnd> ends = {overhang(tubes[0], true), overhang(tubes[0], false)};
    for (std::size_t t = 1; t < tubes.size(); ++t) ends.push_back(overhang(tubes[t], false));
    vessel.mesh = mesh_lumen(SweptLumen(std::move(tubes), spec.fillet), ends, spec.triangles);
    return vessel;
}

GeneratedVessel make_aortic_arch(const VesselSpec& spec)
{
    ArchSpec arch{.origin = spec.origin, .superior = spec.axis, .anterior = spec.normal};
    if (spec.triangles != 0) arch.triangles = spec.triangles;
    return make_aortic_arch(arch);
}

}  // namespace seldinger

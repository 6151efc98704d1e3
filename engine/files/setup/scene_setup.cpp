// From a scene to the parts of a World: loads the vessel, places the feed, checks that wire and vessel fit each other.
#include "setup/scene_setup.h"

#include "core/error.h"
#include "io/mesh_file.h"
#include "rod/place.h"
#include "scene/scene_names.h"
#include "setup/force_plugin.h"
#include "setup/start_inside.h"
#include "setup/vessel_load.h"
#include "vessel/inlets.h"
#include "vessel/inside.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace seldinger {
namespace {

// A lumen this much narrower or wider than the wire [wire radii] is a mistake in units. The tightest stenosis and the widest
// ventricle lie well inside these bounds.
constexpr double narrowest_ratio = 0.05, widest_ratio = 1000;
// A mesh of a vessel has no lumen of more than a decimetre and is no larger than a patient [m]. A wire does not go into a mesh
// whose lumen is thinner than itself almost everywhere. A generated shape may be anything: a case with a closed form.
constexpr double widest_lumen = 0.1, largest_vessel = 3.0;
constexpr double far_apart = std::numeric_limits<double>::infinity();

[[noreturn]] void fail(const Scene& scene, const std::string& key, const std::string& message,
                       ErrorKind code = ErrorKind::BadScene)
{
    throw Error(code, fmt::format("{}: {}: {}", scene.source.string(), key, message));
}

/// Median lumen radius of the centreline; without one, the widest opening; 0 when neither is there.
double typical_radius(const LoadedVessel& vessel)
{
    std::vector<double> radius = vessel.centreline.radius;
    if (!radius.empty()) {
        std::nth_element(radius.begin(), radius.begin() + static_cast<std::ptrdiff_t>(radius.size() / 2), radius.end());
        return radius[radius.size() / 2];
    }
    double largest = 0;
    for (const BoundaryLoop& loop : vessel.report.loops) largest = std::max(largest, loop.radius);
    return largest;
}

/// The unit in which the file's lumen would be nearest, by ratio, to the ten wire radii of a usual vessel.
std::string_view fitting_unit(double lumen_radius, const std::string& units, double wire_radius)
{
    const double in_file = lumen_radius / metres_per_unit(units);
    const auto misfit = [&](std::string_view unit) {
        return std::abs(std::log(in_file * metres_per_unit(std::string(unit)) / (10 * wire_radius)));
    };
    return *std::min_element(std::begin(unit_words), std::end(unit_words), [&](auto a, auto b) { return misfit(a) < misfit(b); });
}

/// Longest side of the box around it [m].
double longest_side(const WallMesh& mesh)
{
    Vec3 low = Vec3::Constant(far_apart), high = -low;
    for (const Vec3& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    return mesh.vertices.empty() ? 0 : (high - low).maxCoeff();
}

/// How messages call a key of an instrument: "wire.place", "instrument.1.place"; `feed` stands alone.
std::string key_of(const Scene& scene, int k, const char* key)
{
    if (!scene.label.empty()) return fmt::format("instrument.{}.{}", k, key);
    return std::string_view(key).starts_with("feed") ? key : fmt::format("wire.{}", key);
}

void check_size(const Scene& scene, const WireSpec& spec, const LoadedVessel& vessel)
{
    const double lumen = typical_radius(vessel), wire = spec.shaft.radius;
    const bool mesh = scene.vessel.shape == VesselShape::Mesh;
    const double extent = mesh ? longest_side(vessel.mesh) : 0;
    const bool too_large = mesh && (lumen > widest_lumen || extent > largest_vessel);
    if (!too_large && (lumen == 0 || (lumen >= (mesh ? 1 : narrowest_ratio) * wire && lumen <= widest_ratio * wire))) return;
    std::string sizes = fmt::format("the lumen's radius is {:.3g} mm, the wire's {:.3g} mm", 1e3 * lumen, 1e3 * wire);
    if (too_large) sizes = fmt::format("the vessel is {:.3g} m across, its lumen's radius {:.3g} mm", extent, 1e3 * lumen);
    if (!mesh)
        fail(scene, "vessel.radius_m", sizes + "; expected the same order of size, check both (metres)");
    const std::string_view unit = fitting_unit(lumen, scene.vessel.units, wire);
    fail(scene, "vessel.units",
         fmt::format(
             "\"{}\" looks wrong: {}; {}", scene.vessel.units, sizes,
             unit == scene.vessel.units ? "check wire.radius_m too (metres)" : fmt::format("units = \"{}\" would fit", unit)));
}

/// @return choices made, for every output
std::string place_feed(const Scene& scene, int k, const LoadedVessel& vessel, FeedSpec& feed)
{
    const SceneFeed& asked = scene.instrument(k).feed;
    if (!asked.inlet_auto) return {};
    const std::string key = key_of(scene, k, "feed.inlet");
    if (scene.vessel.shape == VesselShape::Plane)
        fail(scene, key, "a plane has no inlet: its border is no opening; give point and direction");
    try {
        (void)pick_inlet(vessel.report.loops, vessel.centreline);  // refuses a vessel without any
    } catch (const Error& error) {
        fail(scene, key, error.what(), error.kind());
    }
    const std::vector<Inlet> inlets = find_inlets(vessel.report.loops, vessel.centreline);
    const std::size_t number = static_cast<std::size_t>(std::max(1, asked.inlet_number));
    if (number > inlets.size())
        fail(scene, key,
             fmt::format("got {}; the vessel has {} (`seldinger vessel` lists them)", number,
                         inlets.size() == 1 ? "one inlet" : fmt::format("{} inlets", inlets.size())));
    const Inlet& inlet = inlets[number - 1];
    feed.point = inlet.point;
    feed.direction = inlet.direction;
    return fmt::format("{} of {}{}: {}", number, inlets.size(), asked.inlet_number == 0 ? " (\"auto\")" : "", describe(inlet));
}

/// From the inlet along the centreline, the way that the inlet points: towards the root, or away from it along the longest
/// branch.
std::vector<Vec3> path_along_centreline(const Centreline& line, const FeedSpec& feed)
{
    const Vec3 ahead = feed.direction.normalized();
    const int nearest = line.nearest(feed.point);
    if (nearest < 0) return {};
    std::vector<int> rootwards, outwards;
    for (int at = nearest; at >= 0; at = line.parent[static_cast<std::size_t>(at)]) rootwards.push_back(at);
    for (const int at : line.main_path())
        if (!outwards.empty() || at == nearest) outwards.push_back(at);
    // how far ahead of the inlet a route goes within two radii of the lumen
    const double near = 2 * line.radius[static_cast<std::size_t>(nearest)];
    const auto gain = [&](const std::vector<int>& route) {
        double most = -far_apart;
        for (const int at : route) {
            const Vec3 to = line.points[static_cast<std::size_t>(at)] - feed.point;
            if (to.norm() > near) break;
            most = std::max(most, to.dot(ahead));
        }
        return most;
    };
    const std::vector<int>& route = gain(outwards) >= gain(rootwards) ? outwards : rootwards;
    // the wire leaves the inlet in its direction: what of the line is beside or behind it is left out
    std::vector<Vec3> path = {feed.point};
    for (const int at : route) {
        const Vec3 p = line.points[static_cast<std::size_t>(at)], to = p - path.back();
        const Vec3 before = path.size() > 1 ? Vec3((path.back() - path[path.size() - 2]).normalized()) : ahead;
        const bool onwards = to.norm() > (path.size() > 1 ? 0.0 : 0.25 * near) && to.dot(before) > 0.7 * to.norm();
        if (onwards) path.push_back(p);
    }
    return path;
}

/// Looks up whether wires start inside the lumen; what that takes is built once, when first asked.
class StartPlaces {
public:
    StartPlaces(const LoadedVessel& vessel, bool has_lumen) : vessel_(vessel), has_lumen_(has_lumen) {}
    void check(const Scene& scene, int k, const FeedSpec& feed, double radius)
    {
        const LumenPlace place = lumen().locate(feed.point);
        if (place.inside()) return check_inside_at_start(scene, k, feed, radius);
        if (!has_lumen_) return;  // behind a plane, which does not push from there
        const Vec3& p = feed.point;
        const std::string where = place.opening >= 0
                                      ? fmt::format("beyond inlet {} of the vessel, {:.4g} mm from its rim",
                                                    inlet_through(vessel_.report.loops, vessel_.centreline, place.opening),
                                                    1e3 * (place.nearest - p).norm())
                                      : fmt::format("{:.4g} mm outside the lumen", -1e3 * place.signed_distance);
        fail(scene, key_of(scene, k, scene.instrument(k).feed.inlet_auto ? "feed.inlet" : "feed.point"),
             fmt::format("[{:.6g}, {:.6g}, {:.6g}] is {}; expected a point inside (metres; `seldinger vessel` lists the inlets)",
                         p.x(), p.y(), p.z(), where));
    }

    /// @return the move that puts its start inside
    std::string check(const Scene& scene, int k, WireSpec& wire)
    {
        StartInside start = start_inside(wire, vessel_.centreline, lumen());
        if (!start.refused.empty()) fail(scene, key_of(scene, k, "place"), start.refused);
        return std::move(start.moved);
    }

private:
    /// The inserted length at t = 0 lies along feed.path, or straight ahead of the inlet (solve/feed.cpp). Contact cannot bring
    /// back a wire from behind a wall.
    void check_inside_at_start(const Scene& scene, int k, const FeedSpec& feed, double radius)
    {
        const bool bent = !feed.path.empty();
        const std::vector<Vec3> path = bent ? feed.path : std::vector<Vec3>{feed.point};
        double from = 0;  // of the present piece along the path
        for (std::size_t i = 0; i < path.size() && from < feed.advance; ++i) {
            const bool last = i + 1 == path.size();
            const Vec3 along = last ? (i > 0 ? Vec3(path[i] - path[i - 1]) : feed.direction).normalized()
                                    : Vec3((path[i + 1] - path[i]).normalized());
            const double until = last ? feed.advance : std::min(feed.advance, from + (path[i + 1] - path[i]).norm());
            for (double s = from; s < until;) {
                const Vec3 p = path[i] + (s - from) * along;
                const LumenPlace at = lumen().locate(p);
                if (at.opening >= 0) return;  // out through an opening: free
                if (at.clearance(p) < 0)
                    fail(scene, key_of(scene, k, "feed.keys.advance_m"),
                         fmt::format("got {:.4g} mm at t = 0, which lie {}; expected them {} the wall, which is in the way after "
                                     "{:.3g} mm. Fix: start with 0 (at most {:.4g} m) and feed the rest{}",
                                     1e3 * feed.advance, bent ? "along the centreline" : "straight ahead of the inlet",
                                     has_lumen_ ? "inside" : "in front of", 1e3 * s,
                                     1e-3 * std::floor(1e3 * std::max(0.0, s - 2 * radius)),
                                     bent || !has_lumen_ ? "" : ", or feed.start = \"centreline\""));
                s += std::max(std::abs(at.signed_distance), 0.5 * radius);
            }
            from = until;
        }
    }

    LumenQuery& lumen()
    {
        // a plane's border is no opening
        if (!lumen_)
            lumen_.emplace(vessel_.mesh, has_lumen_ ? vessel_.report.loops : std::vector<BoundaryLoop>{},
                           LumenQuery::Expect::Few);
        return *lumen_;
    }

    const LoadedVessel& vessel_;
    bool has_lumen_;
    std::optional<LumenQuery> lumen_;
};

/// Lays a wire without a vessel once, for what place_wire refuses.
void check_placement(const Scene& scene, int k, const WireSpec& wire)
{
    try {
        RodArrays rods(std::vector<int>{uniform_node_count(wire)});
        place_wire(rods, 0, wire, {});
    } catch (const Error& error) {
        fail(scene, key_of(scene, k, "place"), error.what(), error.kind());
    }
}

/// Whether one of the two is inside the other.
bool coaxial(const Scene& scene, int a, int b)
{
    if (!scene.coaxial) return false;
    const std::vector<int>& order = scene.coaxial->order;
    const auto has = [&](int k) { return std::find(order.begin(), order.end(), k) != order.end(); };
    return has(a) && has(b);
}

/// Least distance between the axes of two instruments as they start [m].
double start_distance(const WireSetup& a, const WireSetup& b, std::span<const Vec3> path)
{
    if (a.feed.on || b.feed.on) return a.feed.on && b.feed.on ? (a.feed.point - b.feed.point).norm() : far_apart;
    RodArrays rods(std::vector<int>{uniform_node_count(a.wire), uniform_node_count(b.wire)});
    place_wire(rods, 0, a.wire, path);
    place_wire(rods, 1, b.wire, path);
    return axis_distance(rods.view(0), rods.view(1));
}

/// Two instruments that are not inside each other start beside each other. Axes closer than half of their thickness coincide;
/// they do not touch.
void check_apart(const Scene& scene, std::span<const WireSetup> wires, std::span<const Vec3> path)
{
    for (int b = 1; b < scene.instrument_count(); ++b)
        for (int a = 0; a < b; ++a) {
            if (coaxial(scene, a, b)) continue;
            const double distance = start_distance(wires[a], wires[b], path);
            if (distance >= 0.5 * (wires[a].wire.shaft.radius + wires[b].wire.shaft.radius)) continue;
            fail(scene, key_of(scene, b, wires[b].feed.on ? "feed" : "place"),
                 fmt::format("coincides with \"{}\" ({:.3g} mm between their axes); put them apart{}", scene.instrument(a).label,
                             1e3 * distance, wires[b].feed.on ? ", or one inside the other with [coaxial]" : ""));
        }
}

}  // namespace

WorldSetup make_setup(const Scene& scene, int device_index, RepairReport* report)
{
    LoadedVessel vessel = load_vessel(scene.vessel);
    if (report) *report = vessel.report;
    return make_setup(std::span(&scene, 1), std::move(vessel), device_index);
}

WorldSetup make_setup(std::span<const Scene> scenes, LoadedVessel vessel, int device_index)
{
    WorldSetup setup;
    const Scene& first = scenes.front();
    const bool has_lumen = first.vessel.shape != VesselShape::None && first.vessel.shape != VesselShape::Plane;
    StartPlaces places(vessel, has_lumen);
    for (const Scene& scene : scenes) {
        const std::size_t begin = setup.wires.size();
        for (int k = 0; k < scene.instrument_count(); ++k) {
            const SceneInstrument& from = scene.instrument(k);
            WireSetup wire{from.wire, from.feed.inlet(), scene.contact, from.holds, from.loads, from.links,
                           {},        {},                {},            from.label};
            for (const SceneForce& force : from.forces) wire.forces.push_back(load_force(force));
            if (has_lumen) check_size(scene, from.wire, vessel);
            if (wire.feed.on) {
                wire.inlet = place_feed(scene, k, vessel, wire.feed);
                if (from.feed.along_centreline && scene.coaxial)
                    fail(scene, key_of(scene, k, "feed.start"),
                         "got \"centreline\" in a group of instruments; expected a single instrument. Fix: start with advance_m "
                         "= 0 and feed the rest");
                if (from.feed.along_centreline) wire.feed.path = path_along_centreline(vessel.centreline, wire.feed);
                if (first.vessel.shape != VesselShape::None) places.check(scene, k, wire.feed, wire.wire.shaft.radius);
            } else if (first.vessel.shape != VesselShape::None) {
                wire.start = places.check(scene, k, wire.wire);
            } else {
                check_placement(scene, k, wire.wire);
            }
            setup.wires.push_back(std::move(wire));
        }
        check_apart(scene, std::span(setup.wires).subspan(begin), vessel.centreline.main_points());
        setup.systems.push_back(scene.instrument_count());
        if (!scene.coaxial) continue;
        setup.coaxial.push_back(*scene.coaxial);
        for (int& wire : setup.coaxial.back().order) wire += static_cast<int>(begin);
    }
    setup.instruments_touch = first.instruments_touch;
    setup.gravity = first.gravity;
    setup.force_window = first.force_window;
    setup.force_patch = first.force_patch;
    setup.start_settled = first.start_settled;
    setup.integrator = first.integrator;
    setup.vessel = first.vessel;
    setup.mesh = std::move(vessel.mesh);
    setup.centreline = std::move(vessel.centreline);
    setup.device_index = device_index;
    return setup;
}

}  // namespace seldinger

// Errors that a world refuses, before anything is built or changed: contradictory setups and impossible controls.
#include "contact/quadrature.h"
#include "core/error.h"
#include "vessel/mesh_edges.h"
#include "vessel/mesh_limits.h"
#include "wall/wall_model.h"
#include "world/setup_check.h"
#include "world/world.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numeric>
#include <string_view>

namespace seldinger {
namespace {

[[noreturn]] void refuse(std::string_view where, std::string_view what)
{
    throw Error(ErrorKind::BadScene, fmt::format("{}: {}", where, what));
}

void need_positive(double value, const std::string& where)
{
    if (!(value > 0) || !std::isfinite(value))
        refuse(where, fmt::format("got {}; expected a finite number greater than 0", value));
}

void need_not_negative(double value, const std::string& where)
{
    if (!(value >= 0) || !std::isfinite(value))
        refuse(where, fmt::format("got {}; expected a finite number, 0 or greater", value));
}

void need_finite(const Vec3& value, const std::string& where)
{
    if (!value.allFinite())
        refuse(where, fmt::format("got [{}, {}, {}]; expected finite numbers", value.x(), value.y(), value.z()));
}

void check_friction(double mu_static, double mu_sliding, const std::string& where)
{
    need_not_negative(mu_sliding, where + ".mu_sliding");
    need_not_negative(mu_static, where + ".mu_static");
    if (!friction_in_order(mu_static, mu_sliding))
        refuse(where + ".mu_static", fmt::format("got {}; expected at least mu_sliding, {}", mu_static, mu_sliding));
}

void check_section(const WireSection& s, const std::string& where)
{
    need_positive(s.radius, where + ".radius");
    need_positive(s.density, where + ".density");
    need_positive(s.bend_stiffness, where + ".bend_stiffness");
    need_positive(s.twist_stiffness, where + ".twist_stiffness");
    need_positive(s.stretch_stiffness, where + ".stretch_stiffness");
    check_friction(s.mu_static, s.mu_sliding, where);
}

void check_wire(const WireSpec& wire, const std::string& where)
{
    need_positive(wire.length, where + ".length");
    if (wire.nodes != 0 && wire.nodes < 2)
        refuse(where + ".nodes", fmt::format("got {}; expected 2 or more, or 0 for nodes that come and go", wire.nodes));
    if (wire.nodes == 0) {
        need_positive(wire.min_edge, where + ".min_edge");
        need_positive(wire.edge_error, where + ".edge_error");
        if (!(wire.max_edge >= wire.min_edge))
            refuse(where + ".max_edge", fmt::format("got {}; expected at least min_edge, {}", wire.max_edge, wire.min_edge));
    }
    check_section(wire.shaft, where + ".shaft");
    for (std::size_t k = 0; k < wire.sections.size(); ++k) {
        const WireSectionRange& range = wire.sections[k];
        const std::string section = fmt::format("{}.sections[{}]", where, k);
        if (!(range.begin < range.end))
            refuse(section, fmt::format("got {} to {}; expected an end behind the beginning", range.begin, range.end));
        check_section(range.section, section + ".section");
    }
}

/// So many that a world can hold them.
void check_samples(const WireSetup& wire, const std::string& where)
{
    const double radius = wire.wire.least_radius();
    if (wire.wire.length > most_slender * radius)
        refuse(where + ".wire.length", fmt::format("got {} m; expected at most {:g} times the smallest radius, {} m",
                                                   wire.wire.length, most_slender, radius));
    if (double(wire.wire.nodes) * wire.contact.samples_per_edge > most_samples)
        refuse(where + ".contact.samples_per_edge",
               fmt::format("got {} for {} nodes; expected at most {:g} samples in all; take fewer of either",
                           wire.contact.samples_per_edge, wire.wire.nodes, most_samples));
}

void check_feed(const WireSetup& wire, const std::string& where)
{
    if (!wire.feed.on) return;
    need_finite(wire.feed.point, where + ".point");
    need_finite(wire.feed.direction, where + ".direction");
    if (wire.feed.direction.isZero()) refuse(where + ".direction", "got zero; expected the direction in which the wire enters");
    if (!(wire.feed.advance >= 0 && wire.feed.advance <= wire.wire.length))
        refuse(where + ".advance",
               fmt::format("got {} m; expected 0 to the wire's length, {} m", wire.feed.advance, wire.wire.length));
    need_not_negative(wire.feed.hub.mass, where + ".hub.mass");
    need_not_negative(wire.feed.hub.damping, where + ".hub.damping");
    need_not_negative(wire.feed.hub.friction, where + ".hub.friction");
    if (!std::isfinite(wire.feed.turn)) refuse(where + ".turn", "got a number that is not finite; expected a finite one");
}

/// One set of launches serves all wires of a world.
void check_agreement(const ContactSpec& contact, const ContactSpec& first, const std::string& where)
{
    const auto differs = [&](const char* member) {
        refuse(where + member,
               "got another value than wires[0]; expected the same for all wires of a world. Fix: make two worlds");
    };
    if (contact.detection != first.detection) differs(".detection");
    if (contact.normal != first.normal) differs(".normal");
    if (contact.friction != first.friction) differs(".friction");
    if (contact.precision != first.precision) differs(".precision");
}

void check_systems(const WorldSetup& setup)
{
    if (setup.systems.empty()) return;
    for (std::size_t s = 0; s < setup.systems.size(); ++s)
        if (setup.systems[s] < 1)
            refuse(fmt::format("systems[{}]", s), fmt::format("got {}; expected one instrument at least", setup.systems[s]));
    const auto in_all = std::accumulate(setup.systems.begin(), setup.systems.end(), std::int64_t{0});
    if (in_all != static_cast<std::int64_t>(setup.wires.size()))
        refuse("systems",
               fmt::format("got {} instruments in all; expected as many as there are wires, {}", in_all, setup.wires.size()));
}

/// Instruments inside each other, a rod each (D13).
void check_nested(const WorldSetup& setup, const CoaxialSpec& nest, const std::string& where)
{
    if (nest.order.size() < 2) refuse(where + ".order", "got fewer than two instruments; expected two or more, outer first");
    if (nest.exchanged < 1 || nest.exchanged >= static_cast<int>(nest.order.size()))
        refuse(where + ".exchanged", fmt::format("got {}; expected 1 to {}: one instrument at least is around them",
                                                 nest.exchanged, nest.order.size() - 1));
    const auto system_of = [&](int wire) {
        int end = 0, system = 0;
        for (const int size : setup.systems)
            if (wire < (end += size)) return system;
            else ++system;
        return setup.systems.empty() ? wire : -1;
    };
    for (std::size_t k = 0; k < nest.order.size(); ++k) {
        const int wire = nest.order[k];
        if (wire < 0 || wire >= static_cast<int>(setup.wires.size()))
            refuse(where + ".order", fmt::format("got instrument {}; expected 0 to {}", wire, setup.wires.size() - 1));
        if (std::count(nest.order.begin(), nest.order.end(), wire) > 1)
            refuse(where + ".order", fmt::format("got instrument {} twice; expected it once", wire));
        if (system_of(wire) != system_of(nest.order[0]))
            refuse(where + ".order", "got instruments of different systems; expected those of one (WorldSetup::systems)");
        if (nest.model != CoaxialSpec::Model::Separate || k == 0) continue;
        const int outer = nest.order[static_cast<std::size_t>(nest.around(k))];
        const double lumen = setup.wires[static_cast<std::size_t>(outer)].wire.lumen_radius;
        const double radius = setup.wires[static_cast<std::size_t>(wire)].wire.largest_radius();
        if (lumen <= radius)
            refuse(fmt::format("wires[{}].wire.lumen_radius", outer),
                   fmt::format("got {} m; expected more than the radius of the instrument inside, {} m", lumen, radius));
    }
    need_not_negative(nest.stiffness, where + ".stiffness");
    need_not_negative(nest.drag, where + ".drag");
    need_not_negative(nest.viscous, where + ".viscous");
    check_friction(nest.mu_static, nest.mu_sliding, where);
}

/// Contact between instruments.
void check_touching(const WorldSetup& setup)
{
    bool any = setup.instruments_touch;
    for (std::size_t k = 0; k < setup.coaxial.size(); ++k) {
        check_nested(setup, setup.coaxial[k], fmt::format("coaxial[{}]", k));
        any = any || setup.coaxial[k].model == CoaxialSpec::Model::Separate;
    }
    if (!any) return;
    if (setup.integrator.scheme != Scheme::Newton && setup.integrator.scheme != Scheme::Static)
        refuse("integrator.scheme", "got linearised or explicit; expected newton or static where instruments touch each other");
    if (setup.wires[0].contact.precision != Precision::Float64)
        refuse("wires[0].contact.precision",
               "got float32; expected float64 where instruments touch each other. Fix: take contact.precision out and choose a "
               "device "
               "with double precision (`seldinger devices` lists them)");
}

/// An elastic wall (D11).
void check_elastic_wall(const WorldSetup& setup)
{
    const VesselSpec& vessel = setup.vessel;
    if (!(vessel.poisson >= 0 && vessel.poisson < 0.5))
        refuse("vessel.poisson", fmt::format("got {}; expected a number from 0 to below 0.5", vessel.poisson));
    need_not_negative(vessel.support, "vessel.support");
    need_not_negative(vessel.support_damping, "vessel.support_damping");
    need_not_negative(vessel.relaxation, "vessel.relaxation");
    need_not_negative(vessel.wall_edge, "vessel.wall_edge");
    if (!std::isfinite(vessel.pressure))
        refuse("vessel.pressure", fmt::format("got {}; expected a finite number", vessel.pressure));
    if (vessel.pressure != 0 && setup.centreline.points.size() < 2)
        refuse("vessel.pressure",
               fmt::format("got {} Pa; expected 0 where the vessel has no axis (a plane, or no centreline was found). Fix: give "
                           "vessel.centreline",
                           vessel.pressure));
    const double radius = WallModel(vessel, setup.mesh, setup.centreline).typical_lumen_radius;
    if (vessel.thickness > radius)
        refuse("vessel.thickness",
               fmt::format("got {} m; expected at most the lumen's radius, {:.4g} m: the wall is a thin shell", vessel.thickness,
                           radius));
    if (vessel.support > 0) return;
    const MeshEdges edges = find_edges(setup.mesh);
    bool has_rim = false;
    for (std::size_t k = 0; k < edges.count(); ++k) has_rim |= edges.uses(k).size() == 1;
    if (!vessel.rims_held || !has_rim)
        refuse("vessel.support", fmt::format("got 0, and {}: nothing holds the wall in place; expected tissue or held rims",
                                             has_rim ? "rims are free" : "the mesh has no rims"));
}

void check_merged_member(const WorldSetup& setup, const CoaxialSpec& spec, int w)
{
    const WireSetup &wire = setup.wires[w], &first = setup.wires[spec.order[0]];
    const std::string where = fmt::format("wires[{}]", w);
    if (!wire.feed.on) refuse(where + ".feed.on", "got false; expected true, as instruments of one centreline (merged) are fed");
    if ((wire.feed.point - first.feed.point).norm() > 0 || (wire.feed.direction - first.feed.direction).norm() > 0)
        refuse(where + ".feed", "got another inlet than the outermost instrument has; expected the same (merged)");
    if (!(wire.feed.behind >= 0 && std::isfinite(wire.feed.behind)))
        refuse(where + ".feed.behind", fmt::format("got {} m; expected a number, 0 or more", wire.feed.behind));
    if (wire.wire.curvature != first.wire.curvature)
        refuse(where + ".wire.curvature", "got another value than the outermost instrument has; expected the same (merged)");
}

/// The lumen presses on its contents, which deviate by the clearance.
void check_merged_room(const WorldSetup& setup, const CoaxialSpec& spec)
{
    for (std::size_t k = 1; k < spec.order.size() && spec.lumen_friction; ++k) {
        const int outer = spec.order[static_cast<std::size_t>(spec.around(k))];
        const double lumen = setup.wires[outer].wire.lumen_radius;
        const double radius = setup.wires[spec.order[k]].wire.largest_radius();
        if (!(lumen > radius))
            refuse(fmt::format("wires[{}].wire.lumen_radius", outer),
                   fmt::format("got {} m; expected more than the radius of the instrument inside, {} m, with lumen_friction",
                               lumen, radius));
    }
}

/// @param merged  [wires] in how many groups it is
void check_merged_scheme(const WorldSetup& setup, std::span<const int> merged)
{
    const IntegratorSpec& integrator = setup.integrator;
    const bool newton = integrator.scheme == Scheme::Newton && !integrator.conserve;
    if (!newton && integrator.scheme != Scheme::Static)
        refuse("integrator",
               "got another scheme; expected newton (backward Euler or Newmark's) or static with instruments of one centreline "
               "(merged)");
    for (std::size_t w = 0; w < setup.wires.size() && newton && integrator.newmark; ++w)
        if (!setup.wires[w].holds.empty() && merged[w] > 0)
            refuse(fmt::format("wires[{}].holds", w),
                   "got holds; expected none on instruments of one centreline (merged) with Newmark's steps, where a velocity "
                   "that a hold removes "
                   "changes its sign at every step. Fix: take backward Euler, or a stiff link");
    if (integrator.damping_stiffness > 0)
        refuse("integrator.damping_stiffness",
               "got another value than 0; expected 0 with instruments of one centreline (merged)");
    if (setup.instruments_touch)
        refuse("instruments_touch",
               "got true; expected false with instruments of one centreline (merged). Fix: give each a rod (separate)");
    const Detection detection = setup.wires[0].contact.detection;
    if (!setup.mesh.triangles.empty() && detection != Detection::Swept)
        refuse("contact.detection", "got another method; expected swept with instruments of one centreline (merged)");
}

/// Instruments that share one centreline (D12).
void check_merged(const WorldSetup& setup)
{
    std::vector<int> merged(setup.wires.size(), 0);
    bool any = false;
    for (std::size_t c = 0; c < setup.coaxial.size(); ++c) {
        const CoaxialSpec& spec = setup.coaxial[c];
        if (spec.model != CoaxialSpec::Model::Merged) continue;
        const std::string where = fmt::format("coaxial[{}]", c);
        if (spec.order.size() > most_coaxial)
            refuse(where + ".order", fmt::format("got {} instruments; expected at most {}", spec.order.size(), most_coaxial));
        for (const int w : spec.order) {
            if (++merged[w] > 1)
                refuse(where + ".order", fmt::format("got wire {}, which is in another one already; expected it in one", w));
            check_merged_member(setup, spec, w);
        }
        check_merged_room(setup, spec);
        any = true;
    }
    if (any) check_merged_scheme(setup, merged);
    for (std::size_t w = 0; w < setup.wires.size(); ++w)
        if (setup.wires[w].feed.behind != 0 && merged[w] == 0)
            refuse(fmt::format("wires[{}].feed.behind", w),
                   "got another value than 0; expected 0 except for instruments of one centreline (merged)");
}

void check_wall(const WorldSetup& setup)
{
    if (setup.vessel.shape == VesselShape::None && setup.mesh.triangles.empty() && !setup.vessel.elastic) return;
    if (setup.mesh.triangles.empty())
        refuse("mesh", "got no triangles; expected the vessel's wall, repaired (or vessel.shape None)");
    const auto vertices = static_cast<std::int64_t>(setup.mesh.vertices.size());
    for (std::size_t t = 0; t < setup.mesh.triangles.size(); ++t)
        for (const std::int32_t v : setup.mesh.triangles[t])
            if (v < 0 || v >= vertices)
                refuse(fmt::format("mesh.triangles[{}]", t), fmt::format("got vertex {}; expected 0 to {}", v, vertices - 1));
    if (const std::int64_t v = first_unusable_vertex(setup.mesh); v >= 0) {
        const std::string name = fmt::format("mesh.vertices[{}]", v);
        need_finite(setup.mesh.vertices[static_cast<std::size_t>(v)], name);
        refuse(name, fmt::format("got more than {0:.0f} m, which float32 cannot hold finely enough; expected {0:.0f} m at most",
                                 most_coordinate));
    }
    need_positive(setup.vessel.youngs, "vessel.youngs");
    need_positive(setup.vessel.thickness, "vessel.thickness");
    if (setup.vessel.elastic) check_elastic_wall(setup);
}

/// A hub that a force drives is solved with its instrument, at the end of the step (D16); one of those that answer each other.
void check_driven(const WorldSetup& setup, const SystemList& systems)
{
    const IntegratorSpec& integrator = setup.integrator;
    const bool solved = integrator.scheme == Scheme::Newton && !integrator.newmark && !integrator.conserve;
    int last = -1;  // of those before
    for (std::size_t w = 0; w < setup.wires.size(); ++w) {
        if (!setup.wires[w].feed.on || !setup.wires[w].feed.hub.driven()) continue;
        const std::string where = fmt::format("wires[{}].feed.hub.mass", w);
        if (!solved)
            refuse(where, "got a hub that a force drives with another scheme; expected newton with backward Euler. Fix: "
                          "integrator.newmark = conserve = false, or mass = 0 and a path of the hub");
        if (last >= 0 && systems.of(last) == systems.of(static_cast<int>(w)))
            refuse(where,
                   fmt::format(
                       "got a force that drives this hub and one for wires[{}], of the same system; expected one driven hub in a "
                       "system. Fix: mass = 0 and a path of the hub for one of them",
                       last));
        last = static_cast<int>(w);
    }
}

/// Where a control has a hub at the end of the step [m].
double end_of(const WorldData& world, int wire, const Control::Hub& hub, double dt)
{
    if (hub.kind == Control::Hub::Kind::MoveTo) return hub.advance;
    if (hub.kind == Control::Hub::Kind::Follow && !world.is_driven(wire))
        return HubPath(hub.keys).at(world.state.wires[wire].time + dt).advance;
    return world.feed(wire).advance;
}

/// Of instruments that take each other's place one is inside.
void check_exchanges(const WorldData& world, std::span<const Control::Hub> hubs, double dt)
{
    for (const CoaxialSpec& spec : world.setup.coaxial) {
        if (spec.exchanged < 2) continue;
        int inside = -1;
        for (const int w : spec.turns()) {
            const double advance = end_of(world, w, static_cast<std::size_t>(w) < hubs.size() ? hubs[w] : Control::Hub{}, dt);
            if (!(advance > 0)) continue;
            if (inside >= 0)
                refuse(
                    fmt::format("control: instrument {}", w),
                    fmt::format(
                        "advance: got {} m; expected 0 while instrument {} is inside: they take turns in another one (exchanged)",
                        advance, inside));
            inside = w;
        }
    }
}

/// Asked in every step: makes no text unless there is something to say.
void check_hub(const WorldData& world, int instrument, const Control::Hub& hub, double dt)
{
    if (hub.kind == Control::Hub::Kind::Stay) return;
    const auto refuse_it = [&](const std::string& what) { refuse(fmt::format("control: instrument {}", instrument), what); };
    if (instrument >= world.wire_count()) refuse_it(fmt::format("index out of range; expected below {}", world.wire_count()));
    if (!world.feed(instrument).on) refuse_it("got a move, but it is not fed and has no hub; expected WireSetup::feed.on");
    for (std::size_t k = 0; k < hub.keys.size(); ++k)
        if (!std::isfinite(hub.keys[k].t) || (k > 0 && hub.keys[k].t <= hub.keys[k - 1].t))
            refuse_it(fmt::format("key {}: got {} s; expected times that increase", k, hub.keys[k].t));
    const bool driven = world.is_driven(instrument), moved = hub.kind == Control::Hub::Kind::MoveTo;
    const bool pushed = hub.kind == Control::Hub::Kind::Push;
    if (driven && moved) refuse_it("got a move, but a force drives its hub (FeedSpec::hub); expected Control::push");
    if (pushed && !driven)
        refuse_it("got a push, but no force drives its hub; expected Control::move_to, or FeedSpec::hub with a mass");
    // later keys of a known path need not be satisfied by this step
    const FeedKey end = moved || pushed ? FeedKey{0, hub.advance, hub.turn, hub.force}
                                        : HubPath(hub.keys).at(world.state.wires[instrument].time + dt);
    const double length = world.setup.wires[instrument].wire.length;
    if (driven && !(std::isfinite(end.force) && hub.spring >= 0 && std::isfinite(hub.spring)))
        refuse_it(fmt::format("push: got {} N and {} N/m; expected finite numbers, the second 0 or more", end.force, hub.spring));
    if (!driven && !(end.advance >= 0 && end.advance <= length))
        refuse_it(fmt::format("advance: got {} m; expected 0 to the wire's length, {} m", end.advance, length));
    if (!std::isfinite(end.turn)) refuse_it(fmt::format("turn: got {} rad; expected a finite number", end.turn));
}

}  // namespace

void check_setup(const WorldSetup& setup)
{
    if (setup.wires.empty()) refuse("wires", "got none; expected at least one wire");
    need_finite(setup.gravity, "gravity");
    need_not_negative(setup.force_window, "force_window");
    need_positive(setup.force_patch, "force_patch");
    need_positive(setup.integrator.tolerance, "integrator.tolerance");
    need_not_negative(setup.integrator.damping_mass, "integrator.damping_mass");
    need_not_negative(setup.integrator.damping_stiffness, "integrator.damping_stiffness");
    check_systems(setup);
    for (std::size_t w = 0; w < setup.wires.size(); ++w) {
        const WireSetup& wire = setup.wires[w];
        const std::string where = fmt::format("wires[{}]", w);
        check_wire(wire.wire, where + ".wire");
        if (!setup.mesh.triangles.empty() || setup.instruments_touch) check_samples(wire, where);
        check_feed(wire, where + ".feed");
        check_agreement(wire.contact, setup.wires[0].contact, where + ".contact");
    }
    check_wall(setup);
    check_touching(setup);
    check_merged(setup);
    check_driven(setup, SystemList(static_cast<int>(setup.wires.size()), setup.systems));
}

void check_on_wire(const WorldData& world, int instrument, double at, const char* where, const char* what)
{
    const std::string place = fmt::format("{}: instrument {}", where, instrument);
    if (instrument < 0 || instrument >= world.wire_count())
        refuse(place, fmt::format("index out of range; expected below {}", world.wire_count()));
    const double length = world.setup.wires[instrument].wire.length;
    if (!(at >= 0 && at <= length))
        refuse(place, fmt::format("{}: got {} m from the tip; expected 0 to the wire's length, {} m", what, at, length));
}

void check_request(const WorldData& world, const Control& control, double dt)
{
    if (!(dt > 0) || !std::isfinite(dt)) refuse("step: dt", fmt::format("got {} s; expected a finite time greater than 0", dt));
    for (std::size_t k = 0; k < control.hubs().size(); ++k) check_hub(world, static_cast<int>(k), control.hubs()[k], dt);
    for (const Control::Load& load : control.loads())
        check_on_wire(world, load.instrument, load.spec.at.from_tip, "control", "load");
    check_exchanges(world, control.hubs(), dt);
}

}  // namespace seldinger

// Choices of a world's model and why they were made, in words.
#include "contact/contact_system.h"
#include "device/device.h"
#include "rod/place.h"
#include "contact/wall_body.h"
#include "world/world_rod.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger {
namespace {

std::string describe_nodes(const WorldRod& rod)
{
    const WireSpec& spec = rod.bounds();
    const bool several = rod.wires().size() > 1;
    if (rod.adapts())
        return fmt::format("adaptive, edges of {:.3g} to {:.3g} mm, {:.3g} um of tip error each ({})", 1e3 * spec.min_edge,
                           1e3 * spec.max_edge, 1e6 * spec.edge_error, several ? "instruments of one centreline" : "asked for");
    if (!several && spec.nodes > 0) return fmt::format("uniform, {} over the whole length (asked for)", spec.nodes);
    return fmt::format("uniform edges of {:.3g} mm ({})", 1e3 * (several ? rod.feed().edge : uniform_edge(spec)),
                       several ? "instruments of one centreline" : "0.4 of max_edge_m; this detection sits on nodes or edges");
}

// Spins of wire 0, as all of model() describes it.
std::string describe_spins(const WorldData& world, const IntegratorSpec& integrator)
{
    if (integrator.spins == Spins::Kept) return "solved for (asked for)";
    const Solver::SpinRecord& record = world.solver->spin_record(0);
    return fmt::format("left out of {} of {} solves (straight, isotropic, no torque: their equations held to the tolerance)",
                       record.without, record.steps);
}

std::string describe_wall(const WorldData& world)
{
    if (!world.forces.wall_body) return "rigid shape, elastic bed under each contact (D6b)";
    const VesselSpec& v = world.setup.vessel;
    return fmt::format(
        "elastic (D11): shell of {:.3g} MPa, {:.3g} mm on tissue of {:.3g} MPa/m, {}; elastic bed under each contact (D6b) in "
        "series",
        1e-6 * v.youngs, 1e3 * v.thickness, 1e-6 * v.support, world.forces.wall_body->describe());
}

/// Friction of the first group.
std::string describe_coaxial_friction(const WorldSetup& setup)
{
    const auto merged = [](const CoaxialSpec& spec) { return spec.model == CoaxialSpec::Model::Merged; };
    const CoaxialSpec& spec = *std::ranges::find_if(setup.coaxial, merged);
    std::string text = fmt::format("{:.3g} N/m and {:.3g} Pa s", spec.drag, spec.viscous);
    if (spec.lumen_friction)
        text += fmt::format(", and {:.3g}, sliding {:.3g}, times the contact force at the clearance", spec.mu_static,
                            spec.mu_sliding);
    return text + " (asked for)";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> World::model() const
{
    WorldData& world = *data_;
    const WireSetup& wire = world.setup.wires[0];
    std::vector<std::pair<std::string, std::string>> list;
    list.emplace_back("nodes", describe_nodes(WorldRod(world, world.line_of(0))));
    if (!wire.start.empty()) list.emplace_back("start", wire.start);
    if (!wire.inlet.empty()) list.emplace_back("inlet", wire.inlet);
    static const char* const schemes[] = {"newton", "linearised", "static", "explicit"};
    const IntegratorSpec& integrator = world.setup.integrator;
    list.emplace_back("scheme",
                      fmt::format("{}, {}", schemes[static_cast<int>(integrator.scheme)],
                                  integrator.newmark    ? "Newmark beta 0.25 gamma 0.5"
                                  : integrator.conserve ? "energy-momentum (asked for)"
                                                        : "backward Euler"));
    if (integrator.scheme == Scheme::Newton || integrator.scheme == Scheme::Linearised)
        list.emplace_back("spins", describe_spins(world, integrator));
    list.emplace_back("curvature",
                      wire.wire.curvature == CurvatureMeasure::Angle ? "turning angle" : "2 tan(angle/2) (asked for)");
    if (world.forces.coaxial_friction) list.emplace_back("friction between instruments", describe_coaxial_friction(world.setup));
    if (!world.forces.contact) {
        list.emplace_back("contact", "none (no vessel)");
        return list;
    }
    static const char* const detections[] = {"swept", "layer", "nodes"};
    list.emplace_back("detection", detections[static_cast<int>(wire.contact.detection)]);
    list.emplace_back("rolling", !wire.contact.rolling ? "off" : "on (asked for)");
    list.emplace_back("wall", describe_wall(world));
    list.emplace_back("precision", world.forces.context->float32() ? "float32" : "float64");
    for (auto& entry : world.forces.contact->describe()) list.push_back(std::move(entry));
    return list;
}

std::string World::device_name() const
{
    return data_->forces.context ? data_->forces.context->name() : "none (no vessel, host only)";
}

DeviceCounts World::device_counts() const
{
    if (!data_->forces.context) return {};
    const device::Counters& c = data_->forces.context->counters();
    return {c.launches, c.reads, c.writes, c.buffers_created, c.programs_built};
}

}  // namespace seldinger

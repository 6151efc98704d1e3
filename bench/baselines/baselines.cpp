// The list of baselines, and the check that a scene is the cantilever that all of them can compute.
#include "baselines/baselines.h"

#include "baselines/corotational_beam.h"
#include "baselines/mass_spring.h"

#include <algorithm>
#include <memory>
#include <numbers>

namespace seldinger::baselines {

std::string why_not_cantilever(const Scene& scene)
{
    const bool straight = scene.wire.place.shape == PlaceShape::Straight && scene.wire.shaft.rest_curvature.isZero();
    const bool still = scene.wire.place.velocity.isZero() && scene.wire.place.spin_rate == 0;
    const bool clamped = scene.holds.size() == 1 && scene.holds[0].at.kind == WirePoint::Kind::Base && scene.holds[0].position &&
                         scene.holds[0].direction && scene.holds[0].move.empty() && scene.holds[0].turn.empty() &&
                         scene.holds[0].velocity.isZero();
    const bool tip_forces = std::all_of(scene.loads.begin(), scene.loads.end(), [](const LoadSpec& load) {
        return load.at.kind == WirePoint::Kind::Tip && load.moment.isZero();
    });
    if (scene.instrument_count() > 1) return "the baselines know one wire";
    if (scene.vessel.shape != VesselShape::None || scene.feed.on) return "the baselines have no contact and are not fed";
    if (!straight || !still || !scene.wire.sections.empty() || !clamped || !tip_forces || !scene.links.empty())
        return "the baselines know uniform straight wires, clamped at the base, with forces at the tip";
    return {};
}

Vec3 Cantilever::tip_force(double t) const
{
    Vec3 force = Vec3::Zero();
    for (const LoadSpec& load : loads) force += (load.ramp > 0 ? std::clamp(t / load.ramp, 0.0, 1.0) : 1.0) * load.force;
    return force;
}

Cantilever read_cantilever(const Scene& scene)
{
    const WireSection& wire = scene.wire.shaft;
    const double area = std::numbers::pi * wire.radius * wire.radius;
    Cantilever c;
    c.nodes = std::max(scene.wire.nodes, 3);
    c.edge = scene.wire.length / (c.nodes - 1);
    c.mass = wire.density * area * c.edge;
    c.bend = wire.bend_stiffness;
    c.twist = wire.twist_stiffness;
    c.stretch = wire.stretch_stiffness;
    c.spin_inertia = wire.density * area * wire.radius * wire.radius / 2 * c.edge;
    c.damping = scene.integrator.damping_mass;
    c.base = scene.wire.place.base;
    c.direction = scene.wire.place.direction.normalized();
    c.gravity = scene.gravity;
    c.loads = scene.loads;
    return c;
}

std::vector<Baseline> all()
{
    const auto baseline = [](std::string name, auto make, bool own_step) {
        Baseline b;
        b.name = std::move(name);
        b.make = [make](const StudyScene& study, const Model& model) { return make(read_cantilever(apply(model, study.scene))); };
        b.why_not = why_not_cantilever;
        b.own_step = own_step;
        return b;
    };
    const auto springs = [](Axial axial) {
        return
            [axial](const Cantilever& wire) -> std::unique_ptr<Simulation> { return std::make_unique<MassSpring>(wire, axial); };
    };
    const auto beam = [](int iterations) {
        return [iterations](const Cantilever& wire) -> std::unique_ptr<Simulation> {
            return std::make_unique<CorotationalBeam>(wire, iterations);
        };
    };
    return {baseline("mass-spring", springs(Axial::True), true), baseline("soft mass-spring", springs(Axial::Softened), true),
            baseline("beam", beam(50), false), baseline("beam · lin", beam(1), false)};
}

}  // namespace seldinger::baselines

// Steps a world under a method, watches each wire's readings and its exact distance to the wall, and tells the outcome.
#include "failure/watched_run.h"

#include "contact/wall_contact.h"
#include "repair/repair.h"
#include "solve/feed.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

namespace seldinger::test {

namespace {

constexpr int audit_period = 5;      // steps
constexpr int audits_in_a_run = 40;  // beside a wall that moves
constexpr int points_per_edge = 4;

TestSetup prepared(TestSetup setup, const Method& method)
{
    use(setup, method);
    return setup;
}

}  // namespace

void use(TestSetup& setup, const Method& method)
{
    setup.integrator.scheme = method.scheme;
    for (TestWire& wire : setup.wires) {
        wire.contact.detection = method.detection;
        wire.contact.normal = method.normal;
        wire.contact.friction = method.friction;
    }
}

Outcome Outcomes::outcome() const
{
    Outcome worst = nearest < 0 ? Outcome::Escape : Outcome::Hold;
    for (const Verdict& verdict : wires) worst = std::max(worst, verdict.outcome);
    return worst;
}

WatchedRun::WatchedRun(TestSetup setup, const Method& method, double dt, double static_indentation)
    : world(prepared(std::move(setup), method)), dt_(dt)
{
    for (int w = 0; w < world.wire_count(); ++w) {
        FailureLimits limits{.radius = world.setup().wires[w].wire.shaft.radius, .static_indentation = static_indentation};
        watches_.emplace_back(limits, at_start(w));
        inserted_.push_back(world.readings(w).inserted);
        wall_work_.push_back(0);
    }
    const WallMesh& mesh = world.setup().mesh;
    const bool open = world.setup().vessel.shape != VesselShape::Plane;
    if (!mesh.triangles.empty())
        lumen_ = std::make_unique<LumenQuery>(mesh, open ? describe(mesh).loops : std::vector<BoundaryLoop>{});
}

/// Readings are of steps; before the first the energies of a wire that is placed are reckoned here.
WireReadings WatchedRun::at_start(int wire)
{
    WireReadings start = world.readings(wire);
    if (world.setup().wires[wire].feed.on) return start;
    const ConstRodView rod = world.rod(wire);
    RodFrames frames(rod.n);
    start.elastic = energy_now(data_of(world).rod(wire), {}, frames);
    for (int i = 0; i < rod.n; ++i) {
        start.kinetic += 0.5 * rod.mass[i] * rod.vel(i).squaredNorm();
        start.gravitational -= rod.mass[i] * world.setup().gravity.dot(rod.pos(i));
    }
    for (int j = 0; j + 1 < rod.n; ++j) start.kinetic += 0.5 * rod.spin_inertia[j] * rod.spin_rate[j] * rod.spin_rate[j];
    return start;
}

/// The lumen inside the wall where it has moved to.
void WatchedRun::follow_wall()
{
    REQUIRE(world.system_count() == 1);  // each system has a wall of its own
    const Output now = world.output(Output::WallShape);
    WallMesh moved = world.setup().mesh;
    for (std::size_t v = 0; v < moved.vertices.size(); ++v) moved.vertices[v] += now.walls[0].displacement[v];
    seen_.wall_move = std::max(seen_.wall_move, now.walls[0].readings.move_max);
    const bool open = world.setup().vessel.shape != VesselShape::Plane;
    lumen_ = std::make_unique<LumenQuery>(moved, open ? describe(moved).loops : std::vector<BoundaryLoop>{});
}

/// That a wall has done on a wire of its own since this was last asked [J].
double WatchedRun::work_of_wall(int wire)
{
    const WallContact* wall = data_of(world).forces.wall_contact;
    if (!wall) return 0;
    const double before = wall_work_[wire];
    wall_work_[wire] = wall->work(world.system_of(wire));
    return before - wall_work_[wire];
}

void WatchedRun::audit()
{
    if (world.setup().vessel.elastic) follow_wall();
    for (int w = 0; w < world.wire_count(); ++w) {
        const WireSetup& setup = world.setup().wires[w];
        const ConstRodView rod = world.rod(w);
        for (int j = 0; j + 1 < rod.n; ++j)
            for (int k = 0; k < points_per_edge; ++k) {
                const Vec3 p = rod.pos(j) + k / double(points_per_edge) * (rod.pos(j + 1) - rod.pos(j));
                if (setup.feed.on && (p - setup.feed.point).dot(setup.feed.direction.normalized()) < 0) continue;  // in the guide
                const LumenPlace place = lumen_->locate(p);
                if (place.opening < 0) seen_.nearest = std::min(seen_.nearest, place.signed_distance);
            }
    }
}

void WatchedRun::run(int steps, const std::function<bool(FedWorld&)>& each)
{
    for (int k = 0; k < steps; ++k) {
        const StepReport report = step(world, dt_);
        ++steps_;
        seen_.halved += (report.flags & StepHalved) != 0;
        seen_.far += (report.flags & StepWallFar) != 0;
        double normal = 0, friction = 0;
        int contacts = 0;
        for (int w = 0; w < world.wire_count(); ++w) {
            const WireReadings now = world.readings(w);
            const double speed = (now.inserted - inserted_[w]) / dt_;
            const double carried =
                world.setup().wires[w].feed.on ? fed_energy(world.setup(), w, inserted_[w], now.inserted, speed) : 0.0;
            watches_[w].observe(report, now, (w == 0 && work ? work(world) : 0.0) + work_of_wall(w), carried);
            inserted_[w] = now.inserted;
            normal += now.normal;
            friction += now.friction;
            contacts += now.contacts;
        }
        seen_.normal = std::max(seen_.normal, normal);
        seen_.friction = std::max(seen_.friction, friction);
        seen_.contacts = std::max(seen_.contacts, contacts);
        const int period = world.setup().vessel.elastic ? std::max(1, steps / audits_in_a_run) : audit_period;
        if (lumen_ && (steps_ % period == 0 || k + 1 == steps)) audit();
        if (each && !each(world)) break;
    }
}

Outcomes WatchedRun::outcomes() const
{
    Outcomes result = seen_;
    for (const FailureWatch& watch : watches_) result.wires.push_back(watch.verdict());
    result.end = world.readings(0);
    return result;
}

Outcomes watch(TestSetup setup, const Method& method, double dt, int steps, double static_indentation)
{
    WatchedRun run(std::move(setup), method, dt, static_indentation);
    run.run(steps);
    return run.outcomes();
}

Outcomes watch_row(const char* row, const TestSetup& setup, const Method& method, double dt, int steps)
{
    WatchedRun run(setup, method, dt);
    // a jammed method is not worth hundreds of sub-steps: the third such step is its last
    int left = 3;
    run.run(steps, [&](FedWorld& world) {
        return method.scheme != Scheme::Linearised || world.report(0).sub_steps < 256 || --left > 0;
    });
    const Outcomes outcomes = run.outcomes();
    MESSAGE(std::string(row) << ", " << std::string(method.name) << ", dt " << 1e3 * dt << " ms: " << tell(outcomes));
    return outcomes;
}

std::string tell(const Outcomes& o)
{
    std::string text = name(o.outcome());
    for (std::size_t w = 0; w < o.wires.size(); ++w) {
        const Verdict& v = o.wires[w];
        const FailureReadings& r = v.readings;
        for (int k = 1; k < 6; ++k)
            if (v.first_step[k] >= 0) text += fmt::format(", {} at step {}", name(static_cast<Outcome>(k)), v.first_step[k]);
        text += fmt::format(
            "; overlap {:.3g} um, outside {:.3g} um, jitter {:.3g}, made {:.3g} J, |hand| {:.4g} N, sub-steps {}, Newton {} "
            "({:.2f})",
            1e6 * r.overlap, 1e6 * r.outside, r.jitter, r.energy_made, r.hand_force, r.sub_steps, r.newton_iterations,
            r.mean_iterations);
    }
    return text + fmt::format("; nearest {:.4g} mm, normal {:.3g} N, friction {:.3g} N, contacts {}, halved {}", 1e3 * o.nearest,
                              o.normal, o.friction, o.contacts, o.halved);
}

void count_turning(WatchedRun& run, double angle, long steps)
{
    run.work = [=, torque = 0.0, turned = 0.0](FedWorld& world) mutable {
        const double now = world.readings(0).hand_torque, to = angle * static_cast<double>(std::min(world.step_count(), steps)),
                     work = 0.5 * (torque + now) * (to - turned);
        torque = now, turned = to;
        return work;
    };
}

}  // namespace seldinger::test

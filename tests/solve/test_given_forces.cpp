// Loads of a control, and forces that the program gives: against the scene's own loads and links, differences, closed forms.

#include "core/error.h"
#include "math/band_matrix.h"
#include "solve/given_forces.h"
#include "solve/wire_fixture.h"

#include "engine.h"
#include "support/refusal.h"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

namespace seldinger::test::test_given_forces {

namespace {

/// A nitinol cantilever of 0.1 m along +x, without weight.
WorldSetup cantilever(Scheme scheme = Scheme::Newton)
{
    WorldSetup setup;
    setup.gravity = Vec3::Zero();
    setup.integrator.scheme = scheme;
    setup.integrator.tolerance = 1e-9;
    WireSetup wire;
    wire.wire = nitinol(0.1);
    wire.wire.nodes = 21;
    wire.holds.push_back(clamp_base());
    setup.wires.push_back(wire);
    return setup;
}

const double stiffness = nitinol(0.1).shaft.bend_stiffness;
constexpr double length = 0.1;

/// A force made of functions.
class Law final : public Force {
public:
    using Forces = std::function<void(const ForcePoints&, std::span<PointForce>)>;
    explicit Law(Forces forces) : forces_(std::move(forces)) {}
    void forces(const ForcePoints& at, std::span<PointForce> out) const override { forces_(at, out); }
    void accept(const ForcePoints& at, std::span<double> next) const override
    {
        if (accepted) accepted(at, next);
    }
    [[nodiscard]] bool tangents(const ForcePoints& at, std::span<PointTangent> out) const override
    {
        if (tangent) tangent(at, out);
        return tangent != nullptr;
    }
    std::function<void(const ForcePoints&, std::span<PointTangent>)> tangent;
    [[nodiscard]] double energy(const ForcePoints& at) const override { return potential ? potential(at) : 0; }
    std::function<void(const ForcePoints&, std::span<double>)> accepted;
    std::function<double(const ForcePoints&)> potential;

private:
    Forces forces_;
};

std::shared_ptr<Law> law(Law::Forces forces) { return std::make_shared<Law>(std::move(forces)); }

/// A spring from the tip to a point, with its potential.
std::shared_ptr<Law> spring(const Vec3& anchor, double k)
{
    auto made = law([=](const ForcePoints& at, std::span<PointForce> out) { out[0].force = k * (anchor - at.position[0]); });
    made->potential = [=](const ForcePoints& at) { return 0.5 * k * (anchor - at.position[0]).squaredNorm(); };
    return made;
}

/// Forces and moments of everything that a force sees, so strong that each counts.
void entangled(const ForcePoints& at, std::span<PointForce> out)
{
    for (std::size_t k = 0; k < out.size(); ++k) {
        const Vec3 &x = at.position[k], &v = at.velocity[k], &a = at.axis[k], &d = at.director[k], &w = at.turning[k];
        out[k].force = Vec3(3 * x.y() + x.x() * x.z(), -2 * x.x() + a.y(), d.x() - 5 * x.z() * x.z()) - 0.02 * v + 1e-3 * w;
        out[k].moment = 0.01 * Vec3(a.z() + x.x(), 2 * d.y() - x.y(), a.x() * d.z()) + 1e-4 * v - 1e-6 * w;
    }
}

}  // namespace

TEST_SUITE("solve/given forces")
{
    TEST_CASE("identity: a load of the control has the bits of the scene's own")
    {
        for (const Scheme scheme : {Scheme::Newton, Scheme::Linearised, Scheme::Static}) {
            WorldSetup with = cantilever(scheme);
            LoadSpec load{.at = {WirePoint::Kind::Distance, 0.012}, .force = {0, 1e-3, 2e-3}, .moment = {1e-6, 2e-6, -3e-6}};
            with.wires[0].loads.push_back(load);
            World scene(with), own(cantilever(scheme));
            Control control;
            control.load(0, 0.012, load.force, load.moment);
            for (int k = 0; k < 5; ++k) {
                REQUIRE(!step(scene, 1e-3).failed());
                REQUIRE(!step(own, control, 1e-3).failed());
            }
            CHECK(own.state_hash() == scene.state_hash());
            CHECK(own.readings(0).energy.outside == scene.readings(0).energy.outside);
            CHECK(own.readings(0).energy.outside > 0);
            // for one step: the next one is free of it
            REQUIRE(!step(own, 1e-3).failed());
            CHECK(own.readings(0).momentum.loads.norm() == 0);
        }
    }

    TEST_CASE("analytic: a load at the tip bends a cantilever by F L^3/(3 B)")
    {
        World world(cantilever(Scheme::Static));
        const double force = 1e-3;
        Control control;
        control.load(0, 0, {0, 0, 0.25 * force}).load(0, 0, {0, 0, 0.75 * force});  // loads add up
        REQUIRE(!step(world, control, 1).failed());
        // slopes of 9 % shorten the arm: 0.6 % at second order
        CHECK(world.rod(0).z[0] == about(force * std::pow(length, 3) / (3 * stiffness)).epsilon(0.01));
    }

    TEST_CASE("refusal: loads that are no numbers, or not on a wire")
    {
        World world(cantilever());
        const std::string before = world.state_hash();
        Control control;
        CHECK(refusal([&] { control.load(0, 0, {0, NAN, 0}); }).find("not finite") != std::string::npos);
        CHECK(refusal([&] { control.load(0, NAN, {0, 0, 0}); }).find("not finite") != std::string::npos);
        CHECK(refusal([&] { control.load(-1, 0, {0, 0, 0}); }).find("instrument -1") != std::string::npos);
        CHECK(control.loads().empty());
        for (const auto& [instrument, at] : {std::pair(1, 0.0), std::pair(0, 0.2), std::pair(0, -0.01)}) {
            control.clear();
            control.load(instrument, at, {0, 0, 1});
            CHECK(refusal([&] { (void)step(world, control, 1e-3); }).find("expected") != std::string::npos);
        }
        CHECK(world.state_hash() == before);
    }

    // Work and tangent on paper are those of given_forces.h; central differences of 1e-6 find them to 1e-9, one-sided ones inside
    // to 1e-6 of the largest entry. Where an edge has turned within the step, terms with kb are left out of the tangent: at the
    // reference itself there are none.
    TEST_CASE("differences: the tangent on nodes and spins is the derivative of what acts on them")
    {
        for (const bool linearised : {false, true}) {
            Rig rig(nitinol(0.1), 6, 1, arc_towards_z(0.08));
            const RodView rod = rig.rod();
            for (int j = 0; j < 5; ++j) rod.theta[j] = 0.3 * j - 0.4;
            GivenForces term(rig.rods, {});
            auto all = law(entangled);
            all->places = {0, 0.013, 0.05, 0.1};
            term.add(0, all, nullptr, 0);
            term.prepare(rig.rods, rig.active);
            const double h = 0.01;
            TrialState trial;
            trial.x.assign(rod.x.begin(), rod.x.end());
            trial.y.assign(rod.y.begin(), rod.y.end());
            trial.z.assign(rod.z.begin(), rod.z.end());
            trial.theta.assign(rod.theta.begin(), rod.theta.end());
            const auto unknown = [&](int u) -> double& {
                std::vector<double>* of[] = {&trial.x, &trial.y, &trial.z, &trial.theta};
                return (*of[RodDofs::place(u)])[static_cast<std::size_t>(RodDofs::node(u))];
            };
            const auto residual = [&](BandRows* tangent) {
                std::vector<double> r(RodDofs::count(6), 0.0);
                term.evaluate({trial, h, rig.active, nullptr, linearised});
                term.add(0, r, tangent, false);
                return r;
            };
            BandMatrix tangent(RodDofs::count(6));
            tangent.reset(RodDofs::count(6));
            (void)residual(&tangent);
            CHECK(term.answer(0, Ask::Trial).unsymmetric);
            if (linearised) continue;  // a linear function of the move: its tangent is asked for where it starts alone
            double largest = 0;
            for (int i = 0; i < RodDofs::count(6); ++i)
                for (int j = std::max(0, i - 10); j <= std::min(RodDofs::count(6) - 1, i + 10); ++j)
                    largest = std::max(largest, std::abs(tangent.at(i, j)));
            const double small = 1e-6;
            for (int j = 0; j < RodDofs::unused(6); ++j) {
                const double kept = unknown(j);
                unknown(j) = kept + small;
                const std::vector<double> up = residual(nullptr);
                unknown(j) = kept - small;
                const std::vector<double> down = residual(nullptr);
                unknown(j) = kept;
                for (int i = std::max(0, j - 10); i <= std::min(RodDofs::count(6) - 1, j + 10); ++i) {
                    CAPTURE(i);
                    CAPTURE(j);
                    CHECK(std::abs((up[i] - down[i]) / (2 * small) - tangent.at(i, j)) < 3e-6 * largest);
                }
            }
        }
    }

    // Virtual work: m on the edge's own turn. The director turns with the edge by dphi, so that a moment -dU/dphi of U(director,
    // axis) is the gradient of U on nodes and spins, also where the edge has turned far from the reference.
    TEST_CASE("differences: forces and moments of a potential are its gradient, turned far from the reference too")
    {
        Rig rig(nitinol(0.1), 4, 1, arc_towards_z(0.08));
        GivenForces term(rig.rods, {});
        const Vec3 p(0.3, -0.7, 0.2), q(-0.4, 0.1, 0.9), e(1, 2, -1);
        auto all = law([&](const ForcePoints& at, std::span<PointForce> out) {
            for (std::size_t k = 0; k < out.size(); ++k)
                out[k] = {-1.0 * e, -1.0 * (at.axis[k].cross(p) + at.director[k].cross(q))};  // dU/dphi = a x p + d x q
        });
        double potential = 0;
        bool first = true;  // else the engine's own differences
        auto asked = law([&](const ForcePoints& at, std::span<PointForce>) {
            if (!std::exchange(first, false)) return;
            potential = 0;
            for (std::size_t k = 0; k < at.s.size(); ++k)
                potential += e.dot(at.position[k]) + p.dot(at.axis[k]) + q.dot(at.director[k]);
        });
        for (const auto& one : {all, asked}) one->places = {0.01, 0.04, 0.08};
        term.add(0, all, nullptr, 0);
        GivenForces reader(rig.rods, {});
        reader.add(0, asked, nullptr, 0);
        term.prepare(rig.rods, rig.active);
        reader.prepare(rig.rods, rig.active);
        TrialState trial;
        trial.x = {0.1, 0.08, 0.04, 0};
        trial.y = {0.03, 0.01, -0.01, 0};
        trial.z = {-0.02, 0.01, 0.03, 0.01};
        trial.theta = {0.4, -1.2, 2.0, 0};
        const auto unknown = [&](int u) -> double& {
            std::vector<double>* of[] = {&trial.x, &trial.y, &trial.z, &trial.theta};
            return (*of[RodDofs::place(u)])[static_cast<std::size_t>(RodDofs::node(u))];
        };
        std::vector<double> r(RodDofs::count(4), 0.0);
        term.evaluate({trial, 0, rig.active});
        term.add(0, r, nullptr, false);
        const double small = 1e-7;  // edges turned by two radians have large third derivatives
        for (int j = 0; j < RodDofs::unused(4); ++j) {
            const double kept = unknown(j);
            const auto at = [&](double value) {
                unknown(j) = value;
                first = true;
                reader.evaluate({trial, 0, rig.active});
                return potential;
            };
            const double slope = (at(kept + small) - at(kept - small)) / (2 * small);
            unknown(j) = kept;
            CAPTURE(j);
            CHECK(r[j] == about(slope).epsilon(1e-6).scale(1));  // R = -Q = dU/dq
        }
    }

    // The engine's own link is the independent solution: both hold at the ends of steps, to the solver's tolerance.
    TEST_CASE("equality: a spring of the program moves a wire as a link does, in every scheme, and its work is in the ledger")
    {
        const Vec3 anchor(0.09, 0.02, 0.03);
        for (const int kind : {0, 1, 2, 3}) {
            CAPTURE(kind);
            WorldSetup setup = cantilever(kind == 1 ? Scheme::Static : kind == 2 ? Scheme::Linearised : Scheme::Newton);
            setup.integrator.newmark = kind == 3;
            WorldSetup linked = setup;
            LinkSpec link{.at = {WirePoint::Kind::Tip}, .anchor = anchor, .stiffness = 0.2};
            linked.wires[0].links.push_back(link);
            World scene(linked), own(setup);
            own.add_force(0, spring(anchor, link.stiffness));
            for (int k = 0; k < 40; ++k) {
                REQUIRE(!step(scene, 1e-3).failed());
                REQUIRE(!step(own, 1e-3).failed());
            }
            CHECK((own.rod(0).pos(0) - scene.rod(0).pos(0)).norm() < 1e-7);
            CHECK((own.rod(0).pos(0) - Vec3(0, 0, 0)).norm() > 0.09);
            CHECK(own.rod(0).z[0] > 1e-3);
            const EnergyLedger mine = own.readings(0).energy, theirs = scene.readings(0).energy;
            CHECK(mine.outside == 0);
            CHECK(mine.forces == about(theirs.outside).epsilon(kind == 3 ? 0.01 : 1e-4));  // Newmark: means of ends, at the mean
            CHECK(std::abs(mine.open()) < 1e-3 * std::abs(mine.forces));
            CHECK((own.readings(0).momentum.loads - scene.readings(0).momentum.loads).norm() < 1e-6);
            const double now = 0.5 * link.stiffness * (anchor - own.rod(0).pos(0)).squaredNorm();
            CHECK(own.readings(0).force_energy == about(now).epsilon(1e-12));
        }
    }

    TEST_CASE("equality: a force of the program on instruments in one centreline is a load there")
    {
        WorldSetup setup;
        setup.gravity = Vec3::Zero();
        setup.integrator.tolerance = 1e-9;
        CoaxialSpec group;
        for (int k = 0; k < 2; ++k) {
            WireSetup wire;
            wire.wire = nitinol(0.2);
            wire.wire.nodes = 101;
            wire.feed.on = true;
            wire.feed.advance = k == 0 ? 0.05 : 0.0613;
            setup.wires.push_back(wire);
            group.order.push_back(k);
        }
        setup.systems = {2};
        setup.coaxial.push_back(group);
        const PointForce on{{1e-3, 2e-4, 3e-4}, {1e-6, -2e-6, 3e-6}};
        World own(setup), scene(setup);
        for (const int w : {0, 1}) {
            auto constant = law([on](const ForcePoints&, std::span<PointForce> out) { out[0] = on; });
            constant->places = {0.0075};
            own.add_force(w, constant);
        }
        Control pushed, loaded;
        for (int k = 1; k <= 20; ++k) {
            loaded.clear();
            for (Control* control : {&pushed, &loaded})
                control->move_to(0, 0.05 + 1e-4 * k, 0.02 * k).move_to(1, 0.0613 + 2e-4 * k, 0);
            for (const int w : {0, 1}) loaded.load(w, 0.0075, on.force, on.moment);
            REQUIRE(!step(own, pushed, 1e-3).failed());
            REQUIRE(!step(scene, loaded, 1e-3).failed());
        }
        for (const int w : {0, 1}) {
            CHECK((own.rod(w).pos(0) - scene.rod(w).pos(0)).norm() < 1e-6);
            CHECK(own.readings(w).hand_force == about(scene.readings(w).hand_force).epsilon(0.01).scale(1e-3));
        }
        const EnergyLedger mine = own.readings(0).energy;
        CHECK(std::abs(mine.forces) > 1e-7);
        CHECK(std::abs(mine.open()) < 0.02 * std::abs(mine.forces));
    }

    // A force that remembers: each step it takes half of what it sees. What it remembers is state as any other.
    TEST_CASE("state: saved, hashed, restored and carried to a twin as it began")
    {
        const auto lagging = [] {
            auto made = law([](const ForcePoints& at, std::span<PointForce> out) { out[0].force = Vec3(0, 0, at.state[0]); });
            made->state = {1e-3, 0};
            made->accepted = [](const ForcePoints& at, std::span<double> state) {
                state[0] = 1e-3 - 0.05 * at.position[0].z();
                state[1] += at.dt;
            };
            return made;
        };
        World world(cantilever());
        const std::string without = world.state_hash();
        world.add_force(0, lagging());
        CHECK(world.state_hash() != without);
        const World twin = world.twin();
        CHECK(twin.state_hash() == world.state_hash());
        for (int k = 0; k < 5; ++k) REQUIRE(!step(world, 1e-3).failed());
        const std::vector<std::uint8_t> saved = world.save_state();
        const std::string then = world.state_hash();
        for (int k = 0; k < 5; ++k) REQUIRE(!step(world, 1e-3).failed());
        const std::string after = world.state_hash();
        CHECK(after != then);
        world.restore_state(saved);
        CHECK(world.state_hash() == then);
        for (int k = 0; k < 5; ++k) REQUIRE(!step(world, 1e-3).failed());
        CHECK(world.state_hash() == after);
        CHECK(world.save_state(0).size() > 0);
        CHECK_THROWS_AS(World(cantilever()).restore_state(saved), Error);
    }

    TEST_CASE("state: what a force throws, or says of no numbers, ends the step, and the world is as before")
    {
        struct Stopped : std::runtime_error {
            using std::runtime_error::runtime_error;
        };
        for (const bool systems : {false, true})
            for (const int kind : {0, 1, 2, 3}) {
                WorldSetup setup = cantilever();
                if (systems) setup.wires.push_back(setup.wires[0]);
                World world(setup);
                int calls = 0, last = 1 << 20;
                auto failing = law([&](const ForcePoints& at, std::span<PointForce> out) {
                    out[0].force = Vec3(0, 0, 1e-3 * std::cos(at.time));
                    if (kind < 3 && ++calls > last) {
                        if (kind == 0) throw Stopped("no more");
                        (kind == 1 ? out[0].force : out[0].moment)[1] = kind == 1 ? NAN : INFINITY;
                    }
                });
                failing->accepted = [&](const ForcePoints&, std::span<double>) {
                    if (kind == 3 && ++calls > last) throw Stopped("no more");
                };
                world.add_force(systems ? 1 : 0, failing);
                for (int k = 0; k < 3; ++k) REQUIRE(!step(world, 1e-3).failed());
                const std::vector<std::uint8_t> before = world.save_state();
                const std::string hash = world.state_hash();
                last = calls + (kind == 3 ? 0 : 2);
                const auto next = [&] { (void)step(world, 1e-3); };
                if (kind == 0 || kind == 3) CHECK_THROWS_AS(next(), Stopped);
                else CHECK(refusal(next).find("force \"force\": got a ") == 0);
                CHECK(world.save_state() == before);
                last = calls;
                CHECK_THROWS((void)settle(world));
                CHECK(world.save_state() == before);
                last = 1 << 20;
                REQUIRE(!step(world, 1e-3).failed());  // it goes on from there
                CHECK(world.state_hash() != hash);
            }
        World world(cantilever());
        CHECK(refusal([&] { world.add_force(0, nullptr); }).find("no force") != std::string::npos);
        CHECK(refusal([&] { world.add_force(2, spring({}, 1)); }).find("instrument 2") != std::string::npos);
        auto off = spring(Vec3::Zero(), 1);
        off->places = {0.3};
        CHECK(refusal([&] { world.add_force(0, off); }).find("0.3 m from the tip") != std::string::npos);
    }

    // Twice the force for half of a load that is constant through the step: asked once in each, at its start.
    TEST_CASE("a force that is asked once a step is asked once, and sees time, points, nodes and edges")
    {
        World world(cantilever());
        int calls = 0;
        double time = 0;
        auto once = law([&](const ForcePoints& at, std::span<PointForce> out) {
            ++calls;
            time = at.time;
            for (std::size_t k = 0; k < out.size(); ++k) out[k].force = at.length[k] * Vec3(0, 0, 0.01);
        });
        once->each_trial = false;
        once->on = Force::On::Edges;
        world.add_force(0, once);
        World scene(cantilever());
        Control control;
        for (int k = 0; k < 20; ++k) control.load(0, 0.005 * (k + 0.5), {0, 0, 5e-5});
        for (int k = 0; k < 4; ++k) {
            REQUIRE(!step(world, 1e-3).failed());
            REQUIRE(!step(scene, control, 1e-3).failed());
        }
        CHECK(calls == 4);
        CHECK(time == about(4e-3).epsilon(1e-12));
        CHECK((world.rod(0).pos(0) - scene.rod(0).pos(0)).norm() < 1e-9);
        double whole = 0;
        auto nodes = law([&](const ForcePoints& at, std::span<PointForce>) {
            whole = 0;
            for (const double part : at.length) whole += part;
            CHECK(at.s.size() == 21);
            CHECK((at.axis[0] - Vec3(1, 0, 0)).norm() < 0.1);  // in the direction of insertion
        });
        nodes->on = Force::On::Nodes;
        world.add_force(0, nodes);
        REQUIRE(!step(world, 1e-3).failed());
        CHECK(whole == about(length).epsilon(1e-12));
    }

    TEST_CASE("property: a force of several instruments is asked once for all, with the bits of one of each")
    {
        WorldSetup setup = cantilever();
        for (int k = 0; k < 2; ++k) setup.wires.push_back(setup.wires[0]);
        for (const Scheme scheme : {Scheme::Newton, Scheme::Linearised})
            for (const bool tangents : {true, false}) {
                setup.integrator.scheme = scheme;
                World apart(setup), joined(setup);
                int calls = 0, most = 0;
                const auto drag = [&](bool together) {
                    auto made = law([&](const ForcePoints& at, std::span<PointForce> out) {
                        calls += together;
                        most = std::max(most, static_cast<int>(out.size()));
                        for (std::size_t k = 0; k < out.size(); ++k)
                            out[k].force = (1e-4 + 1e-4 * at.wire[k]) * Vec3(0, 0, 1) - 1e-3 * at.velocity[k];
                    });
                    if (tangents)
                        made->tangent = [](const ForcePoints&, std::span<PointTangent> out) {
                            for (PointTangent& of : out)
                                for (int c = 0; c < 3; ++c) of.damping[c][c] = -1e-3;
                        };
                    made->on = Force::On::Nodes;
                    made->together = together;
                    return made;
                };
                const auto one = drag(true);
                for (int k = 0; k < 3; ++k) {
                    apart.add_force(k, drag(false));
                    joined.add_force(k, one);
                }
                for (int k = 0; k < 4; ++k) REQUIRE(!step(apart, 1e-3).failed());
                const int each = most;
                for (int k = 0; k < 4; ++k) REQUIRE(!step(joined, 1e-3).failed());
                CHECK(joined.state_hash() == apart.state_hash());
                CHECK(joined.state_hash(0) != joined.state_hash(1));
                CHECK(most == 3 * each);
                CHECK(calls > 0);
            }
        World world(setup);
        auto odd = spring({}, 1);
        odd->together = true;
        odd->state = {1};
        check_refused([&] { world.add_force(0, odd); }, {"state: got some"});
        odd->state = {};
        odd->record = {"time_s"};
        check_refused([&] { world.add_force(0, odd); }, {"record: got 1 names"});
    }

    // M x B at a tip that is magnetised along its axis, B across: B_s theta'' = -M B cos(theta), clamped at theta = 0 (theta the
    // angle in the plane of both) and free of force: theta is linear, theta' = M B cos(theta_L)/B_s.
    TEST_CASE("analytic: a magnetic tip in a uniform field, theta_L = (M B L/B_s) cos(theta_L)")
    {
        const double torque = 2 * stiffness / length;  // M B: turns the tip by a radian
        World world(cantilever(Scheme::Static));
        world.add_force(0, law([&](const ForcePoints& at, std::span<PointForce> out) {
                            out[0].moment = torque * at.axis[0].cross(Vec3(0, 0, 1));
                        }));
        REQUIRE(!step(world, 1).failed());
        double angle = 1;
        for (int k = 0; k < 100; ++k) angle -= (angle - 2 * std::cos(angle)) / (1 + 2 * std::sin(angle));
        const Vec3 axis = -world.rod(0).tangent(0);
        // on the last edge, of L/20: its tangent is that of the half of it before, and the moment that of this tangent
        CHECK(std::atan2(axis.z(), axis.x()) == about(angle).epsilon(0.03));
    }
}

}  // namespace seldinger::test::test_given_forces

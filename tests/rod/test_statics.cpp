// Closed forms: bending, twisting, buckling, and the order at which clamps and jumps of stiffness converge.

#include "rod/rod_fixture.h"

#include <numbers>

namespace seldinger::test::test_statics {

namespace {

constexpr double pi = std::numbers::pi;

RodClamp clamp_at(int node, const Vec3& tangent, bool spin, const Vec3& director = Vec3::UnitZ())
{
    return {.node = node, .spin = spin, .tangent = tangent, .director = director};
}

std::vector<int> all_angles(int n)
{
    std::vector<int> held;
    for (int i = 0; i < n - 1; ++i) held.push_back(RodDofs::spin(i));
    return held;
}

void hold_position(std::vector<int>& held, int node)
{
    for (int c = 0; c < 3; ++c) held.push_back(RodDofs::position(node, c));
}

/// Response to a small load at the straight, unloaded state: linear, so exactly that of beam theory but for the nodes.
Eigen::VectorXd linear_response(OneWire& wire, const Eigen::VectorXd& load, std::vector<int> held)
{
    REQUIRE(wire.update());
    Eigen::MatrixXd h = wire.hessian(HessianMode::Exact);
    Eigen::VectorXd r = load;
    held.push_back(RodDofs::count(wire.rod.n) - 1);
    for (const int q : held) {
        r[q] = 0;
        h.row(q).setZero();
        h.col(q).setZero();
        h(q, q) = 1;
    }
    return h.ldlt().solve(r);
}

bool stable(OneWire& wire, const std::vector<int>& held)
{
    REQUIRE(wire.update());
    Eigen::MatrixXd h = wire.hessian(HessianMode::Exact);
    for (const int q : held) {
        h.row(q).setZero();
        h.col(q).setZero();
        h(q, q) = 1;
    }
    return Eigen::LLT<Eigen::MatrixXd>(h).info() == Eigen::Success;
}

OneWire straight_wire(int n, const WireSpec& spec)
{
    OneWire wire(n);
    wire.place(straight_nodes(n, spec.length));
    set_rest_shape(wire.rod, spec, false);
    return wire;
}

double observed_order(double coarse, double fine) { return std::log2(coarse / fine); }

}  // namespace

TEST_SUITE("rod/elastic")
{
    // Every inner node of a polygon turns by phi = 2 pi/n, and E = B f^2/(2 l). Here f = 2 tan(phi/2) [Bergou08, sec. 4.2.1],
    // or phi but for 7 phi^5/1440 (rod/curvature.h; the next term is 3e-3 of that here)
    TEST_CASE("analytic: energy of an arc of nodes")
    {
        for (const CurvatureMeasure measure : {CurvatureMeasure::Angle, CurvatureMeasure::Tangent}) {
            const int n = 13;
            const double phi = 2 * pi / 24, edge = 0.01, bend = 3e-4;
            std::vector<Vec3> nodes;
            const double radius = edge / (2 * std::sin(phi / 2));
            for (int i = 0; i < n; ++i) nodes.push_back({radius * std::cos(i * phi), radius * std::sin(i * phi), 0});
            OneWire wire(n);
            wire.rod.curvature = measure;
            wire.place(nodes);
            set_rest_shape(wire.rod, uniform_spec(edge * (n - 1), bend, 2e-4, 1e3), false);
            REQUIRE(wire.update());
            const bool angle = measure == CurvatureMeasure::Angle;
            const double kb = 2 * std::tan(phi / 2), f = angle ? phi + 7 * std::pow(phi, 5) / 1440 : kb;
            const double digits = angle ? 1e-6 : 1e-12;
            for (int i = 1; i < n - 1; ++i) {
                CHECK(wire.frames.kb[i].norm() == about(kb).epsilon(1e-12));
                CHECK(std::hypot(wire.frames.kappa1[i], wire.frames.kappa2[i]) == about(f).epsilon(digits));
            }
            CHECK(wire.energy() == about((n - 2) * bend * f * f / (2 * edge)).epsilon(2 * digits));
        }
    }

    // director averaging would scale the bending energy by cos^2(twist/2); see rod/pair.h
    TEST_CASE("property: bending does not depend on twist, up to several turns per node")
    {
        const int n = 9;
        std::vector<Vec3> nodes;
        for (int i = 0; i < n; ++i) nodes.push_back({std::cos(0.3 * i), std::sin(0.3 * i), 0.05 * i});
        OneWire wire(n);
        wire.place(nodes);
        set_rest_shape(wire.rod, uniform_spec(wire.rod.material_s[n - 1], 1.0, 0.5, 10.0), false);
        REQUIRE(wire.update());
        const double untwisted = wire.energy();
        for (const double per_node : {0.1, 1.0, pi, 2 * pi, 7.0}) {
            CAPTURE(per_node);
            OwnedTrial trial(wire.rod);
            double twist_energy = 0;
            for (int j = 0; j < n - 1; ++j) trial.theta[j] = per_node * j;
            for (int i = 1; i < n - 1; ++i) twist_energy += 0.5 * 0.5 * per_node * per_node / wire.rod.voronoi_length(i);
            CHECK(wire.energy_at(trial) == about(untwisted + twist_energy).epsilon(1e-12));
        }
    }

    // u(L) = P L^3/(3 B); the clamp's half cell makes the sum over nodes the trapezoidal rule, hence error L^2 h ... = O(h^2)
    TEST_CASE("analytic: a clamped cantilever's tip deflection converges at second order")
    {
        for (const bool at_hub : {true, false}) {
            double error[3];
            const int edges[3] = {24, 48, 96};
            for (int k = 0; k < 3; ++k) {
                const int n = edges[k] + 1, root = at_hub ? n - 1 : 0, end = at_hub ? 0 : n - 1;
                OneWire wire = straight_wire(n, uniform_spec(1.0, 1.0, 1.0, 1e6));
                wire.clamps = {clamp_at(root, Vec3::UnitX(), false)};
                std::vector<int> held = all_angles(n);
                hold_position(held, root);
                Eigen::VectorXd load = Eigen::VectorXd::Zero(RodDofs::count(n));
                load[RodDofs::position(end, 1)] = 1;
                error[k] = std::abs(linear_response(wire, load, held)[RodDofs::position(end, 1)] - 1.0 / 3);
            }
            CAPTURE(error[2]);
            CHECK(error[2] < 1e-4 / 3);  // h^2/2 relative = 5e-5
            CHECK(observed_order(error[0], error[1]) > 1.95);
            CHECK(observed_order(error[1], error[2]) > 1.95);
        }
    }

    // a clamp inside parts the wire into two cantilevers that do not feel each other
    TEST_CASE("analytic: a clamp at an inner node holds both sides to second order")
    {
        double error_a[3], error_b[3];
        const int edges[3] = {25, 50, 100};
        for (int k = 0; k < 3; ++k) {
            const int n = edges[k] + 1, root = 2 * edges[k] / 5;
            OneWire wire = straight_wire(n, uniform_spec(1.0, 1.0, 1.0, 1e6));
            wire.clamps = {clamp_at(root, Vec3::UnitX(), true)};
            std::vector<int> held;
            hold_position(held, root);
            Eigen::VectorXd load = Eigen::VectorXd::Zero(RodDofs::count(n));
            load[2] = 1;                            // at the tip, 0.4 away
            load[RodDofs::position(n - 1, 1)] = 1;  // at the hub, 0.6 away
            const Eigen::VectorXd u = linear_response(wire, load, held);
            error_a[k] = std::abs(u[2] - 0.064 / 3);
            error_b[k] = std::abs(u[RodDofs::position(n - 1, 1)] - 0.216 / 3);
            CHECK(std::abs(u[1]) < 1e-12);
        }
        for (int k = 0; k < 2; ++k) {
            CHECK(observed_order(error_a[k], error_a[k + 1]) > 1.95);
            CHECK(observed_order(error_b[k], error_b[k + 1]) > 1.95);
        }
    }

    // cantilever, clamped at the hub, soft tip of stiffness 1e-3 for the first 0.337 of the length: u = P (a^3/b_soft +
    // (1-a^3)/b)/3
    TEST_CASE("analytic: a jump of stiffness of 1000:1 anywhere in a cell keeps the error below C h^2")
    {
        const double jump = 0.337;
        WireSpec spec = uniform_spec(1.0, 1.0, 1.0, 1e6);
        spec.sections.push_back({0, jump, spec.shaft});
        spec.sections[0].section.bend_stiffness = 1e-3;
        const double exact = (1e3 * std::pow(jump, 3) + 1 - std::pow(jump, 3)) / 3;
        int tested = 0;
        for (const int edges : {20, 33, 50, 77, 100, 150}) {
            const int n = edges + 1;
            OneWire wire = straight_wire(n, spec);
            wire.clamps = {clamp_at(n - 1, Vec3::UnitX(), false)};
            std::vector<int> held = all_angles(n);
            hold_position(held, n - 1);
            Eigen::VectorXd load = Eigen::VectorXd::Zero(RodDofs::count(n));
            load[1] = 1;
            const double h = 1.0 / edges;
            const double relative = std::abs(linear_response(wire, load, held)[1] / exact - 1);
            CAPTURE(edges);
            // the cell's whole angle is put at its node, off by up to h/2 times the lever's relative change (2/jump, half cell):
            // h^2 (1/2 of trapezoid's + 3/4 for the cell cut by the jump)/jump^2
            CHECK(relative < 1.25 * h * h / (jump * jump));
            ++tested;
        }
        REQUIRE(tested == 6);
    }

    // Elastica under a dead tip load, P L^2/B = 10: (u/L, w/L) = (0.55500, 0.81061)   [Mattiasson81, doi:10.1002/nme.1620170113]
    TEST_CASE("analytic: a cantilever bent far by a dead load follows the elastica, at second order")
    {
        Eigen::Vector2d tip[3];
        int worst = 0;
        for (int k = 0; k < 3; ++k) {
            const int n = (30 << k) + 1;
            OneWire wire = straight_wire(n, uniform_spec(1.0, 1.0, 1.0, 1e6));
            wire.clamps = {clamp_at(n - 1, Vec3::UnitX(), false)};
            std::vector<int> held = all_angles(n);
            hold_position(held, n - 1);
            Eigen::VectorXd load = Eigen::VectorXd::Zero(RodDofs::count(n));
            for (int part = 1; part <= 20; ++part) {
                load[1] = 0.5 * part;
                const int used = equilibrate(wire, load, held, HessianMode::Exact, 1e-7, 60);
                REQUIRE(used >= 0);
                worst = std::max(worst, used);
            }
            tip[k] = {wire.rod.x[0], wire.rod.y[0]};
        }
        CHECK(worst <= 8);                                                  // quadratic convergence; a wrong Hessian takes tens
        CHECK((tip[2] - Eigen::Vector2d(0.55500, 0.81061)).norm() < 7e-5);  // h^2; the table has five digits
        // between the grids themselves, free of the table's rounding; bent within 1/3 of the length, 30 edges are coarse: the
        // ratio is 3.2 below these grids, 3.6 here, 3.8 above
        CHECK(observed_order((tip[0] - tip[1]).norm(), (tip[1] - tip[2]).norm()) > 1.8);
    }

    TEST_CASE("analytic: a straight wire turned at both ends by several turns carries C angle/L")
    {
        const int n = 21;
        const double twist_stiffness = 0.7;
        OneWire wire = straight_wire(n, uniform_spec(1.0, 1.0, twist_stiffness, 1e3));
        wire.clamps = {clamp_at(0, Vec3::UnitX(), true), clamp_at(n - 1, Vec3::UnitX(), true)};
        std::vector<int> held;
        for (int i = 0; i < n; ++i) hold_position(held, i);
        for (int k = 1; k <= 20; ++k) {
            RodClamp& hub = wire.clamps[1];
            hub.turns = 0.3 * pi * k;  // three turns in the end
            hub.director = turned(Vec3::UnitZ(), hub.tangent, hub.turns);
            REQUIRE(equilibrate(wire, Eigen::VectorXd::Zero(RodDofs::count(n)), held, HessianMode::Exact, 1e-11) >= 0);
        }
        REQUIRE(wire.update());
        const double torque = twist_stiffness * 6 * pi;
        CHECK(clamp_torque(wire.rod, wire.clamps, wire.frames, 1) == about(torque).epsilon(1e-10));
        CHECK(clamp_torque(wire.rod, wire.clamps, wire.frames, 0) == about(-torque).epsilon(1e-10));
        for (int j = 0; j < n - 1; ++j) CHECK(wire.rod.theta[j] == about(6 * pi * (j + 0.5) / (n - 1)).epsilon(1e-10));
    }

    // Euler: clamped-free, P = pi^2 B/(4 L^2). The exact Hessian loses its definiteness there, whatever the projected one says.
    TEST_CASE("analytic: the Hessian turns indefinite at Euler's load")
    {
        const int n = 41;
        const double stretch = 1e5, euler = pi * pi / 4;
        std::vector<int> held = all_angles(n);
        hold_position(held, n - 1);
        held.push_back(RodDofs::count(n) - 1);
        const auto holds_at = [&](double load) {
            OneWire wire(n);
            wire.place(straight_nodes(n, 1 - load / stretch));  // compressed state
            for (int i = 0; i < n; ++i) wire.rod.material_s[i] = double(i) / (n - 1);
            set_rest_shape(wire.rod, uniform_spec(1.0, 1.0, 1.0, stretch), false);
            wire.clamps = {clamp_at(n - 1, Vec3::UnitX(), false)};
            return stable(wire, held);
        };
        // nodes: relative error (pi h/2)^2/12 = 1.3e-4; compression shortens the wire by 2.5e-5
        CHECK(holds_at(euler * (1 - 5e-4)));
        CHECK_FALSE(holds_at(euler * (1 + 5e-4)));
    }

    // Greenhill with clamped ends: M L/(2 B) = tan(M L/(2 B)) = 4.4934, M = 8.9868 B/L   [Timoshenko61, sec. 2.21]
    TEST_CASE("analytic: the Hessian turns indefinite at Greenhill's torque")
    {
        const int n = 61;
        const double c = 0.8, greenhill = 8.98682;
        std::vector<int> held;
        hold_position(held, 0);
        hold_position(held, n - 1);
        held.push_back(RodDofs::count(n) - 1);
        const auto holds_at = [&](double moment) {
            OneWire wire = straight_wire(n, uniform_spec(1.0, 1.0, c, 1e4));
            wire.clamps = {clamp_at(0, Vec3::UnitX(), true), clamp_at(n - 1, Vec3::UnitX(), true)};
            const double angle = moment / c;
            wire.clamps[1].turns = angle;
            wire.clamps[1].director = turned(Vec3::UnitZ(), Vec3::UnitX(), angle);
            for (int j = 0; j < n - 1; ++j) wire.rod.theta[j] = angle * (j + 0.5) / (n - 1);
            return stable(wire, held);
        };
        // nodes: relative error of order (M h/B)^2/12 = 2e-3
        CHECK(holds_at(greenhill * (1 - 4e-3)));
        CHECK_FALSE(holds_at(greenhill * (1 + 4e-3)));
    }

    TEST_CASE("property: Newton with the safe Hessian finds the large bend too")
    {
        const int n = 41;
        OneWire wire = straight_wire(n, uniform_spec(1.0, 1.0, 1.0, 1e4));
        wire.clamps = {clamp_at(n - 1, Vec3::UnitX(), false)};
        std::vector<int> held = all_angles(n);
        hold_position(held, n - 1);
        Eigen::VectorXd load = Eigen::VectorXd::Zero(RodDofs::count(n));
        load[1] = 3;
        const int used = equilibrate(wire, load, held, HessianMode::Projected, 1e-7, 400, 0.05);
        CAPTURE(used);
        CHECK(used >= 0);
        CHECK(wire.rod.y[0] == about(0.60325).epsilon(2e-3));  // [Mattiasson81], P L^2/B = 3; h^2 = 6e-4
    }

    // d(elastic energy + potential of weight)/d(length fed), feeding more of the same wire out of the inlet: natural curvature
    // comes with the material, and so does its mass. A section may end in either half of the base edge, or in the cell before.
    TEST_CASE("derivative: the hand's force is the energy's change with the length fed")
    {
        const int n = 7;
        const Vec3 gravity(3, -7, 5);
        WireSpec spec = uniform_spec(1.0, 0.8, 0.6, 30.0);
        const WireSection shaft = spec.shaft;
        for (const double end : {0.0, -0.2, 0.25, 0.75})  // of a section, in base edges from the node before the hub; 0: none
            for (const bool inner_clamp : {false, true})
                for (const bool curved : {false, true}) {
                    if (inner_clamp && (end == -0.2 || end == 0.25)) continue;  // see feed_force
                    spec.shaft = shaft;
                    if (curved) spec.shaft.rest_curvature = {0.9, -0.4};
                    OneWire wire(n);
                    std::vector<Vec3> nodes;
                    for (int i = 0; i < n; ++i) nodes.push_back({std::cos(0.4 * i), std::sin(0.3 * i), 0.1 * i * i});
                    wire.place(nodes);
                    spec.length = 2 * wire.rod.material_s[n - 1];
                    for (int j = 0; j < n - 1; ++j) wire.rod.theta[j] = 0.2 * j * j;
                    wire.clamps = {clamp_at(n - 1, (nodes[n - 1] - nodes[n - 2] + Vec3(0.1, 0.2, 0)).normalized(), true)};
                    wire.clamps[0].director = unit_normal(Vec3(1, 2, 0.3), wire.clamps[0].tangent);
                    if (inner_clamp) wire.clamps.push_back(clamp_at(n - 2, wire.rod.tangent(n - 3), false));
                    const double fed = wire.rod.material_s[n - 1] * 1.01, before = wire.rod.material_s[n - 2];
                    WireSection tip = shaft;
                    tip.bend_stiffness *= 1.5, tip.twist_stiffness *= 0.5, tip.stretch_stiffness *= 2, tip.density *= 3;
                    tip.rest_curvature = {-0.6, 1.1};
                    spec.sections.clear();
                    if (end != 0) spec.sections.push_back({0, before + end * (fed - before), tip});
                    const auto energy = [&](double more) {
                        wire.rod.material_s[n - 1] = fed + more;
                        set_rest_shape(wire.rod, spec, false);
                        REQUIRE(wire.update());
                        const double line_density = spec.shaft.density * pi * spec.shaft.radius * spec.shaft.radius;
                        double potential = line_density * more * gravity.dot(wire.rod.pos(n - 1));  // it left the inlet's height
                        for (int i = 0; i < n; ++i) potential -= wire.rod.mass[i] * gravity.dot(wire.rod.pos(i));
                        return wire.energy() + potential;
                    };
                    const double d = 1e-3;
                    const double numeric = (8 * (energy(d) - energy(-d)) - (energy(2 * d) - energy(-2 * d))) / (12 * d);
                    (void)energy(0);
                    // truncation d^4 = 1e-12 times a fifth derivative over the edge's length
                    const double force = feed_force(wire.rod, spec, wire.clamps, wire.frames, gravity);
                    CHECK(force == about(numeric).epsilon(1e-8));
                    // the weight is there to be seen
                    CHECK(std::abs(force - feed_force(wire.rod, spec, wire.clamps, wire.frames, Vec3::Zero())) >
                          1e-4 * std::abs(force));
                }
    }

    TEST_CASE("derivative: the clamp's torque is the energy's change with its turning")
    {
        const int n = 6;
        WireSpec spec = uniform_spec(1.0, 0.8, 0.6, 30.0);
        spec.shaft.rest_curvature = {0.9, -0.4};
        OneWire wire(n);
        std::vector<Vec3> nodes;
        for (int i = 0; i < n; ++i) nodes.push_back({std::cos(0.4 * i), std::sin(0.3 * i), 0.1 * i * i});
        wire.place(nodes);
        set_rest_shape(wire.rod, spec, false);
        for (int j = 0; j < n - 1; ++j) wire.rod.theta[j] = 0.2 * j * j;
        for (const int node : {0, 3, n - 1}) {
            const Vec3 tangent = (wire.rod.tangent(std::min(node, n - 2)) + Vec3(0.1, 0.2, 0)).normalized();
            const Vec3 director = unit_normal(Vec3(1, 2, 0.3), tangent);
            const auto energy = [&](double angle) {
                wire.clamps = {clamp_at(node, tangent, true, turned(director, tangent, angle))};
                wire.clamps[0].turns = angle;
                REQUIRE(wire.update());
                return wire.energy();
            };
            const double d = 1e-3;
            const double numeric = (8 * (energy(d) - energy(-d)) - (energy(2 * d) - energy(-2 * d))) / (12 * d);
            (void)energy(0);
            CAPTURE(node);
            CHECK(clamp_torque(wire.rod, wire.clamps, wire.frames, 0) == about(numeric).epsilon(1e-8));
        }
    }

    // a sleeve that wire is fed through feels M^2/(2B) less than a clamp that moves with it [Bosi14]
    TEST_CASE("analytic: feeding into a bent wire is pulled in by M^2/2B")
    {
        const int n = 41;
        const double radius = 0.5, bend = 2.0, edge = 0.02, phi = 2 * std::asin(edge / (2 * radius));
        std::vector<Vec3> nodes;
        for (int i = 0; i < n; ++i) nodes.push_back({radius * std::cos(i * phi), radius * std::sin(i * phi), 0});
        OneWire wire(n);
        wire.place(nodes);
        const WireSpec spec = uniform_spec(1, bend, 1, 1e3);
        set_rest_shape(wire.rod, spec, false);
        const double end = (n - 1) * phi;
        wire.clamps = {clamp_at(n - 1, Vec3(-std::sin(end), std::cos(end), 0), false)};
        REQUIRE(wire.update());
        const double expected = -bend / (2 * radius * radius);
        CHECK(feed_force(wire.rod, spec, wire.clamps, wire.frames, Vec3::Zero()) == about(expected).epsilon(phi * phi));
    }
}

}  // namespace seldinger::test::test_statics

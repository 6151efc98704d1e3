// Instruments inside each other, a rod each (D13): a wire in the lumen of a catheter.

#include "contact/instrument_fixture.h"

#include <array>
#include <cmath>
#include <numbers>

namespace seldinger::test::test_nested_instruments {

namespace {

constexpr double wire_radius = 2e-4, wall = 3e-4;

/// From the base along +x to the origin, an arc of `radius` towards +y about (0, bend, 0), and straight on. The part before the
/// arc comes in from `off` farther out.
std::vector<Vec3> bent_path(double bend, double radius, double angle, double lead, double tail, double off)
{
    std::vector<Vec3> points;
    const int arc = 400;
    for (int i = 0; i < arc; ++i)
        points.emplace_back(-lead * (1 - i / double(arc)), bend - radius - off * (1 - i / double(arc)), 0);
    for (int i = 0; i <= arc; ++i)
        points.emplace_back(radius * std::sin(angle * i / arc), bend - radius * std::cos(angle * i / arc), 0);
    const Vec3 onward(std::cos(angle), std::sin(angle), 0), end = points.back();
    for (int i = 1; i <= arc; ++i) points.push_back(end + onward * (tail * i / arc));
    return points;
}

/// Along a path, with edges of about `edge`; stress-free there if `at_rest`.
WireSetup along(const std::vector<Vec3>& path, double bend, double radius, double edge, bool at_rest)
{
    double length = -4e-3;  // edges cut corners
    for (std::size_t k = 1; k < path.size(); ++k) length += (path[k] - path[k - 1]).norm();
    WireSetup made = straight_wire(bend, 7000, length, radius, static_cast<int>(length / edge) + 1);
    made.wire.place.shape = PlaceShape::Points;
    made.wire.place.points = path;
    made.wire.place.rest_is_placed = at_rest;
    made.contact.friction = FrictionLaw::StickSlip;
    return made;
}

/// Every node held where it is.
void hold_all(WireSetup& wire)
{
    for (int i = 0; i < wire.wire.nodes; ++i) {
        wire.holds.push_back(hold_of(WirePoint::Kind::Distance, false));
        wire.holds.back().at.from_tip = wire.wire.length * i / (wire.wire.nodes - 1);
    }
}

/// A wire drawn through a catheter that is bent by `angle` and held; a dead force at its far end.
struct PullThrough {
    double bend, arc, clearance, mu, angle, far, hand;
    [[nodiscard]] WorldSetup setup() const
    {
        const double tail = std::max(0.03, 6 * std::sqrt(bend / far)), edge = 1e-3;
        WireSetup catheter =
            along(bent_path(arc, arc, angle, tail + 4e-3, tail + 8e-3, 0), 1e-2, wire_radius + clearance + wall, edge, true);
        catheter.wire.lumen_radius = wire_radius + clearance;
        hold_all(catheter);
        // guided B/(2 R T) off the inner wall, where a straight tail comes to lie
        WireSetup wire = along(bent_path(arc, arc - clearance, angle, tail, tail + 4e-3, bend / (2 * arc * hand)), bend,
                               wire_radius, edge, false);
        HoldSpec hub = hold_of(WirePoint::Kind::Base, false);
        hub.move = {{0, 0, 0, 0}, {1, 0, 0, 0}, {2, -2e-3, 0, 0}};
        wire.holds = {hub};
        wire.loads = {{.at = {WirePoint::Kind::Tip}, .force = far * Vec3(std::cos(angle), std::sin(angle), 0), .ramp = 1}};
        WorldSetup made = touching({catheter, wire});
        made.instruments_touch = false;
        CoaxialSpec nest;
        nest.model = CoaxialSpec::Model::Separate;
        nest.order = {0, 1};
        nest.mu_static = nest.mu_sliding = mu;
        nest.stiffness = 1e10;
        made.coaxial = {nest};
        return made;
    }
};

void add_section(WireSetup& wire, double until, double bend, double curvature, double from = 0)
{
    WireSectionRange range{.begin = from, .end = until, .section = wire.wire.shaft};
    range.section.bend_stiffness = range.section.twist_stiffness = bend;
    range.section.rest_curvature = {curvature, 0};
    wire.wire.sections.push_back(range);
}

/// A catheter with a soft bend and a wire with a J at its tip, both clamped at the origin towards x: the tips at rest.
std::array<Vec3, 2> tips_of_j_wire(const nlohmann::json& in, double inserted, double clearance)
{
    const auto& outer = in["instruments"][0];
    const auto& inner = in["instruments"][1];
    const double length = 0.1, edge = 5e-4;
    WireSetup catheter =
        straight_wire(outer[1][1], 7000, length, wire_radius + clearance + 2e-4, static_cast<int>(length / edge) + 1);
    WireSetup wire = straight_wire(inner[2][1], 7000, inserted, wire_radius, static_cast<int>(inserted / edge) + 1);
    catheter.wire.lumen_radius = wire_radius + clearance;
    add_section(catheter, outer[0][0], outer[0][1], outer[0][2]);
    const double hook = inner[0][0], soft = inner[1][0];
    add_section(wire, hook, inner[0][1], inner[0][2]);
    add_section(wire, hook + soft, inner[1][1], inner[1][2], hook);
    for (WireSetup* one : {&catheter, &wire}) {
        put(*one, Vec3::Zero(), Vec3::UnitX());
        one->wire.place.normal = Vec3::UnitY();  // natural curvature bends towards it
        one->holds = {hold_of(WirePoint::Kind::Base, true, true)};
    }
    WorldSetup setup = touching({catheter, wire});
    setup.instruments_touch = false;
    setup.integrator.scheme = Scheme::Newton;
    setup.integrator.damping_mass = 100;
    CoaxialSpec nest;
    nest.model = CoaxialSpec::Model::Separate;
    nest.order = {0, 1};
    nest.mu_static = nest.mu_sliding = 0;
    nest.stiffness = 1e11;
    setup.coaxial = {nest};
    World world(setup);
    for (int k = 0; k < 150; ++k) REQUIRE_FALSE(step(world, 2e-3).failed());
    REQUIRE(world.readings(1).kinetic < 1e-12);
    return {world.rod(0).pos(0), world.rod(1).pos(0)};
}

}  // namespace

TEST_SUITE("contact/nested_instruments")
{
    TEST_CASE("reference: 15_coaxial/pull_through: a wire drawn through a bent catheter")
    {
        const auto given = shared_case("15_coaxial.json", "15_coaxial/pull_through");
        if (!given) return;
        const auto& in = (*given)["inputs"];
        for (const auto& row : (*given)["expected"]["table"]) {
            const double far = row["T_far"], degrees = row["phi_deg"], hand = row["T_hand"];
            CAPTURE(far);
            CAPTURE(degrees);
            World world(PullThrough{in["B"], in["R_arc"], in["clearance"], in["mu"], degrees * std::numbers::pi / 180, far, hand}
                            .setup());
            double least = 1e9, most = 0;
            for (int k = 0; k < 40; ++k) {
                REQUIRE_FALSE(step(world, 0.05).failed());
                if (k < 25) continue;
                least = std::min(least, -world.readings(1).base_force.x());
                most = std::max(most, -world.readings(1).base_force.x());
            }
            CHECK(most == about(hand).epsilon(0.03));
            // it slides over some five cells and an edge and a half: no ratchet
            CHECK(most - least < 1e-4 * hand);
            CHECK((contact_force(world, 0) + contact_force(world, 1)).norm() < 1e-13 * world.readings(1).normal);
        }
    }

    TEST_CASE("analytic: drawn round a bend, exp(mu (1 - r/R) phi) of the tension for a wire without stiffness to bend")
    {
        // friction acts at the surface (friction_law.h); B/(2 R^2 T) = 4e-5 of the tension, mu^2 r/R
        const double angle = std::numbers::pi / 2, arc = 0.03, clearance = 3e-4, mu = 0.15, far = 2;
        const double radius = arc - clearance, expected = std::exp(mu * (1 - wire_radius / radius) * angle) * far;
        World world(PullThrough{1e-7, arc, clearance, mu, angle, far, expected}.setup());
        for (int k = 0; k < 40; ++k) REQUIRE_FALSE(step(world, 0.05).failed());
        CHECK(-world.readings(1).base_force.x() == about(expected).epsilon(2e-3));
    }

    // Where a section's curvature begins the axes part within the clearance, over a length ~ sqrt(clearance/curvature): tips are
    // off by its power of one half.
    TEST_CASE("reference: 15_coaxial/j_wire_in_catheter: with its clearance a wire comes to the merged axis")
    {
        const auto given = shared_case("15_coaxial.json", "15_coaxial/j_wire_in_catheter");
        if (!given) return;
        const auto& row = (*given)["expected"]["table"][1];
        std::vector<double> off;
        for (const double clearance : {2e-4, 5e-5, 1.25e-5}) {
            const auto tips = tips_of_j_wire((*given)["inputs"], row["inserted [outer, inner]"][1], clearance);
            double most = 0;
            const char* const names[] = {"tip_outer", "tip_inner"};
            for (std::size_t k = 0; k < 2; ++k) {
                const auto& tip = row[names[k]];
                most = std::max(most, (tips[k] - Vec3(tip[0], tip[1], tip[2])).norm());
            }
            MESSAGE("clearance " << clearance << " m: tips off by " << most << " m");
            off.push_back(most);
        }
        CHECK(off[1] < 0.7 * off[0]);
        CHECK(off[2] < 0.7 * off[1]);
        CHECK(off[2] < 0.005 * 0.1);
    }
}

}  // namespace seldinger::test::test_nested_instruments

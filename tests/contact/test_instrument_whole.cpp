// A cell that touches all along is taken as one (instrument_cell.h): its force, and that nothing jumps within a step.

#include "contact/spline_rod.h"
#include "shared/instrument_slot.h"
#include "support/approx.h"

#include <cmath>
#include <random>
#include <vector>

namespace seldinger::test::test_instrument_whole {

namespace {

constexpr double spacing = 0.8e-3, edge = 2e-3, lumen = 0.5e-3, radius = 0.4e-3, stiffness = 1e10;

/// An arc in the plane of x and y, every node up to `rough` off it.
SplineRod arc(double about, double rough, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> some(-1, 1);
    SplineRod rod;
    for (int i = 0; i < 12; ++i) {
        const double turn = edge * i / 0.05, away = about + rough * some(random);
        rod.position.insert(rod.position.end(), {away * std::sin(turn), away * std::cos(turn), 0});
        rod.material.push_back(edge * i);
        rod.theta.push_back(0);
    }
    return rod;
}

/// A wire that lies `deep` in the outer wall of a bent lumen.
struct Lying {
    SplineRod a, b, a_t0, b_t0;
    InstrumentScene scene{};
    SlotLaw law{no_contact_state(), {}};
    Lying(double deep, double rough, unsigned seed)
        : a(arc(0.05 + lumen - radius + deep, rough, seed)), b(arc(0.05, rough, seed + 1)), a_t0(a), b_t0(b)
    {
        InstrumentSurface wire{}, tube{};
        wire.radius = radius, wire.load = tube.load = 0.03;
        tube.radius = 0.8e-3, tube.lumen = lumen;
        InstrumentPair pair{};
        pair.touch = SEL_TOUCH_INSIDE, pair.stiffness = stiffness, pair.exponent = 1.5;
        InstrumentParams par{};
        par.inv_dt = 1e3, par.friction = SEL_FRICTION_NONE;
        law.law = law_between(wire, tube, pair, 0, 1, par);
        scene.part = gap_part(pair, wire, tube, b.view());
        look();
    }
    void look() { scene.a = a.view(), scene.b = b.view(), scene.a_t0 = a_t0.view(), scene.b_t0 = b_t0.view(); }
    [[nodiscard]] InstrumentScene of_cell(int cell) const
    {
        InstrumentScene its = scene;
        its.s0 = spacing * cell;
        its.s1 = its.s0 + spacing;
        its.edge = edge_of_material(scene.a, its.s0);
        return its;
    }
};

struct Exerted {
    InstrumentForce force = no_instrument_force();
    InstrumentState state = no_instrument_state();
    std::vector<InstrumentPoint> points = std::vector<InstrumentPoint>(SEL_INSTRUMENT_POINTS);
    CellWork work{};
};

Exerted as_whole(const Lying& lying, int cell)
{
    Exerted out;
    const InstrumentScene scene = lying.of_cell(cell);
    REQUIRE(beside_other(&scene, spacing * (cell + 0.5) / edge, &out.work.beside));
    push_whole(&scene, &lying.law, &out.work, &out.state, &out.force, out.points.data());
    return out;
}

Exerted in_pieces(const Lying& lying, int cell)
{
    Exerted out;
    const InstrumentScene scene = lying.of_cell(cell);
    look_through(&scene, cell_ends(&scene, spacing * (cell + 0.5) / edge), &out.work.pieces, &out.force);
    REQUIRE(out.force.depth > 0);
    push_pieces(&scene, &lying.law, &out.work, &out.state, &out.force, out.points.data());
    return out;
}

/// The largest jump of a rod's curvature from one knot to the next [1/m].
double largest_jump(const SplineRod& rod)
{
    double most = 0;
    vec3 last{};
    for (uint i = 1; i + 1 < rod.material.size(); ++i) {
        const SplineView view = rod.view();
        const vec3 bent = (1 / (edge * edge)) * (node_at(view, i - 1) - 2 * node_at(view, i) + node_at(view, i + 1)),
                   by = bent - last;
        if (i > 1) most = std::max(most, std::sqrt(dot3(by, by)));
        last = bent;
    }
    return most;
}

/// Force and its moment by a sum over many points, each searched for alone.
std::pair<double, double> summed(const Lying& lying, int cell)
{
    constexpr int parts = 2000;
    const InstrumentScene scene = lying.of_cell(cell);
    double force = 0, moment = 0;
    for (int k = 0; k < parts; ++k) {
        const double s = spacing * (cell + (k + 0.5) / parts), gap = cell_mark(&scene, s, s / edge).gap;
        const double here = gap < 0 ? stiffness * std::pow(-gap, 1.5) * spacing / parts : 0;
        force += here;
        moment += here * s;
    }
    return {force, moment};
}

}  // namespace

// Four Gauss points integrate depth^(3/2) to 2.1e-4 where the least depth is 1/4 of the largest (a parabola, the worst of three
// shapes). A jump of curvature at a knot adds 1.5 [kappa] l^2/2700 over the depth. A cell has two knots of each rod at most.
// The pieces end at knots. The sum that both are held against is right to (1/2000)^2.
TEST_CASE("instrument whole: force and its middle are those of the pieces, and of a sum over the cell")
{
    int tried = 0;
    double worst = 0;
    for (unsigned seed = 1; seed < 30; ++seed) {
        const Lying lying(3e-6, 1e-6, seed);
        const double jump = largest_jump(lying.a) + largest_jump(lying.b);
        for (int cell = 5; cell < 20; ++cell) {
            const InstrumentScene scene = lying.of_cell(cell);
            const Exerted pieces = in_pieces(lying, cell);
            if (!(pieces.state.contact.flags & SEL_CONTACT_WHOLE)) continue;
            ++tried;
            const Exerted whole = as_whole(lying, cell);
            const auto [force, moment] = summed(lying, cell);
            const double shallowest = SEL_WHOLE * pieces.force.depth;
            const double tolerance = 2.1e-4 + 1.5 * 2 * jump * spacing * spacing / 2700 / shallowest;
            CHECK(whole.force.count == SEL_PIECE_POINTS);
            CHECK(std::abs(pieces.force.normal_sum - force) < 2.2e-4 * force);
            CHECK(std::abs(whole.force.normal_sum - force) < tolerance * force);
            CHECK(std::abs(whole.work.moment / whole.force.normal_sum - moment / force) < tolerance * spacing);
            CHECK(std::abs(whole.force.depth - pieces.force.depth) <
                  0.03 * pieces.force.depth);  // a cubic through the points, at the ends
            CHECK(whole.work.length == test::about(pieces.work.length).epsilon(1e-12));
            worst = std::max(worst, std::abs(whole.force.normal_sum / force - 1));
        }
    }
    CHECK(tried > 100);
    CHECK(worst > 1e-6);  // they do differ: the two rules are not one
}

// Its points lie fixed in the material: the force is minus the slope of their energy, wherever the rods go within the step,
// with all of the points in touch, some, or none. By differences of 1e-9 m, of which the fourth derivatives leave 1e-18/depth^2
// of 3e-6 m: 1e-7.
TEST_CASE("instrument whole: forces are the slope of one energy, which does not jump as a cell lifts")
{
    Lying lying(3e-6, 1e-6, 3);
    lying.law.law.m.damping = 0;
    constexpr int cell = 11;
    int partly = 0;
    double last = as_whole(lying, cell).force.stored;
    for (int step = 0; step < 40; ++step) {
        // the wire is turned off the wall about one end of the cell
        for (std::size_t i = 0; i < lying.a.material.size(); ++i)
            lying.a.position[3 * i + 1] -= 4e-5 * (lying.a.material[i] - 0.9e-2 + 2e-3);
        const Exerted here = as_whole(lying, cell);
        CHECK(here.force.stored <= last * 1.01 + 1e-16);
        last = here.force.stored;
        partly += here.force.count > 0 && here.force.count < SEL_PIECE_POINTS;
        std::vector<double> force(lying.a.position.size(), 0.0);
        double largest = 0;
        for (uint k = 0; k < here.force.count; ++k)
            for (uint n = 0; n < 3; ++n)
                for (uint d = 0; d < 3; ++d)
                    force[3 * (here.points[k].node_a + n) + d] +=
                        here.points[k].force * here.points[k].wa[n] * here.points[k].n[d];
        for (const double f : force) largest = std::max(largest, std::abs(f));
        for (std::size_t k = 0; k < force.size(); ++k) {
            constexpr double h = 1e-9;
            const double before = lying.a.position[k];
            lying.a.position[k] = before + h;
            const double up = as_whole(lying, cell).force.stored;
            lying.a.position[k] = before - h;
            const double down = as_whole(lying, cell).force.stored;
            lying.a.position[k] = before;
            CHECK(std::abs(force[k] + (up - down) / (2 * h)) < 1e-4 * largest + 1e-12);
        }
    }
    CHECK(partly > 3);
    CHECK(last == 0);  // and off it is
}

// Where a cell lies over the plane of the mouth, or its end is less than 1/4 as deep as its middle, the cell is searched
// through.
TEST_CASE("instrument whole: not at a mouth, nor where it hardly touches")
{
    Lying lying(3e-6, 0, 1);
    const Exerted inside = in_pieces(lying, 8);
    CHECK((inside.state.contact.flags & SEL_CONTACT_WHOLE) != 0);
    for (const double place :
         {0.5, 0.02}) {  // the lumen ends in the middle of the cell; 16 um beyond its rim the wall falls back by 0.9 um
        lying.scene.part.low = spacing * (8 + place) / edge;
        CHECK((in_pieces(lying, 8).state.contact.flags & SEL_CONTACT_WHOLE) == 0);
    }
    Lying tilted(3e-6, 0, 1);
    for (std::size_t i = 0; i < tilted.a.material.size(); ++i)
        tilted.a.position[3 * i + 1] -= 6e-3 * (tilted.a.material[i] - 8.5 * spacing);
    const Exerted end = in_pieces(tilted, 8);
    REQUIRE(end.force.count > 0);
    CHECK((end.state.contact.flags & SEL_CONTACT_WHOLE) == 0);
}

}  // namespace seldinger::test::test_instrument_whole

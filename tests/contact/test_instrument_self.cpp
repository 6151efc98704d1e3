// The law of a wire that touches itself against its closed forms.

#include "shared/instrument_near.h"
#include "support/approx.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace seldinger::test::test_instrument_self {

namespace {

constexpr double radius = 5e-4, spacing = 1e-3, depth = 1e-5, stiffness = 1e7;
constexpr int half = 12;  // nodes of each strand

/// The cell that begins at s0 and a stretch of the same rod.
InstrumentScene scene_of(SplineView rod, double s0, double from, double until)
{
    InstrumentScene scene;
    scene.a = scene.b = scene.a_t0 = scene.b_t0 = rod;
    scene.part = {SEL_TOUCH_SELF, 0, rod.count - 1.0, radius, radius, 0, 0, 1};
    scene.apart = SEL_SELF_APART * radius;
    scene.s0 = s0;
    scene.s1 = s0 + spacing;
    scene.edge = edge_of_material(rod, s0);
    scene.from = from;
    scene.until = until;
    return scene;
}

/// What a cell exerts in equilibrium; nothing where it does not touch.
InstrumentForce force_of(const InstrumentScene& scene, double exponent)
{
    SlotLaw slot{no_contact_state(), {}};
    slot.law.m.stiffness = stiffness;
    slot.law.m.exponent = exponent;
    slot.law.m.radius = radius;
    slot.law.mv.fresh = 1;
    InstrumentForce force = no_instrument_force();
    InstrumentState now = no_instrument_state();
    std::array<InstrumentPoint, SEL_INSTRUMENT_POINTS> points;
    SelfWork work;
    if (!mark_self(&scene, radius / 2, &work.marks, &work.touch)) return force;
    touch_self(&scene, &work.marks, &work.touch);
    if (work.touch.count == 0) return force;
    close_self(&scene, &slot, 1, &work, &now, &force);
    push_self(&scene, &slot.law, 1 / std::beta(0.5, exponent + 0.5), &work, &force, points.data());
    finish_self(&scene, &slot, &work, &now, &force);
    return force;
}

/// Two straight strands of one wire, under an angle, whose middles overlap. (The way from one to the other is of no account.)
struct Strands {
    std::vector<double> position, material, theta = std::vector<double>(2 * half + 2, 0.0);

    explicit Strands(double angle)
    {
        for (int i = 0; i < 2 * half; ++i) {
            const bool second = i >= half;
            const double s = spacing * i, u = s - (second ? 1.5 * half - 0.5 : 0.5 * half - 0.5) * spacing;
            const double z = (second ? 1 : -1) * (radius - depth / 2);
            if (second) position.insert(position.end(), {u, 0, z});
            else position.insert(position.end(), {u * std::cos(angle), u * std::sin(angle), z});
            material.push_back(s);
        }
        position.resize(position.size() + 6);
        material.resize(material.size() + 2);
    }
    [[nodiscard]] InstrumentScene cell(int k) const
    {
        const SplineView rod{position.data(), material.data(), theta.data(), 2 * half};
        return scene_of(rod, k * spacing, spline_at(rod, half * spacing), spline_at(rod, (2 * half - 1) * spacing));
    }
};

/// Over all cells of the first strand, in equilibrium.
InstrumentForce force_of(const Strands& strands, double exponent, int from, int until, double* metres)
{
    InstrumentForce all = no_instrument_force();
    *metres = 0;
    for (int k = from; k < until; ++k) {
        const InstrumentForce force = force_of(strands.cell(k), exponent);
        all.normal_sum += force.normal_sum;
        all.slope_sum += force.slope_sum;
        *metres += force.length;
    }
    return all;
}

constexpr std::array<double, 3> crest_places = {0.8, 0.55, 0.3};  // of a cell

/// Force of a cell on a strand above it: a deep place at its start, and behind a crest at a place of the cell, at gap `crest`, a
/// place 30 nm deeper.
double shelf_force(double crest, double place, std::uint32_t* points_that_push)
{
    constexpr int nodes = 80;
    constexpr double edge = 1e-4;
    std::vector<double> position, material, theta(2 * nodes + 2, 0.0);
    const double start = edge * (0.5 * nodes - 0.5);  // of the cell
    for (int i = 0; i < 2 * nodes; ++i) {
        const bool second = i >= nodes;
        const double u = (i - (second ? 1.5 : 0.5) * nodes + 0.5) * edge, x = u / spacing - place;
        // falls by 10 um in front of the crest and rises beyond it, 0.2 cells on
        const double gap = crest + (x < 0 ? -1e-5 * (x * x) / (place * place)
                                          : -3e-8 * (1 - std::pow(std::cos(5 * std::numbers::pi / 2 * std::min(x, 0.4)), 2)));
        position.insert(position.end(), {u, 0, second ? radius + gap : -radius});
        material.push_back(edge * i);
    }
    position.resize(position.size() + 6);
    material.resize(material.size() + 2);
    const SplineView rod{position.data(), material.data(), theta.data(), 2 * nodes};
    const InstrumentForce force = force_of(scene_of(rod, start, nodes, 2 * nodes - 1), 1.5);
    *points_that_push = force.count;
    return force.normal_sum;
}

/// Largest jump of that force, of its size, while the crest rises from -0.1 to 0.1 um.
double largest_jump(double place, int* jumps)
{
    constexpr int steps = 60;
    double most = 0;
    std::uint32_t before = 0, now = 0, at = 0;
    const auto force = [&](double crest) { return shelf_force(crest, place, &at); };
    (void)shelf_force(-1e-7, place, &before);
    for (int k = 1; k <= steps; ++k, before = now) {
        double low = 1e-7 * (2.0 * (k - 1) / steps - 1), high = low + 2e-7 / steps;
        (void)shelf_force(high, place, &now);
        if (now == before) continue;
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (low + high);
            (void)force(middle);
            (at == before ? low : high) = middle;
        }
        ++*jumps;
        const double below = force(low), above = force(high);
        most = std::max(most, std::abs(above - below) / below);
    }
    return most;
}

}  // namespace

TEST_SUITE("contact/instrument_self")
{
    TEST_CASE("analytic: strands that cross carry k sqrt(2 D) B(1/2, n + 1) depth^(n + 1/2) / sin(angle)")
    {
        // the law per metre between straight strands, integrated along one of them; terms of the order of depth/D, 1 %, are left
        // out
        for (const double exponent : {1.0, 1.5, 2.0})
            for (const double angle : {std::numbers::pi / 2, 1.0, 0.4}) {
                CAPTURE(exponent);
                CAPTURE(angle);
                double metres = 0;
                const InstrumentForce force = force_of(Strands(angle), exponent, 0, half - 1, &metres);
                const double lens = std::sqrt(2 * 2 * radius) * std::beta(0.5, exponent + 1) / std::sin(angle);
                CHECK(force.normal_sum == about(stiffness * lens * std::pow(depth, exponent + 0.5)).epsilon(0.01));
                CHECK(force.slope_sum == about((exponent + 0.5) * force.normal_sum / depth).epsilon(0.01));
                CHECK(metres == about(2 * std::sqrt(2 * 2 * radius * depth) / std::sin(angle)).epsilon(0.02));
            }
    }

    TEST_CASE("analytic: strands side by side carry k depth^n per metre")
    {
        for (const double exponent : {1.0, 1.5, 2.0}) {
            CAPTURE(exponent);
            double metres = 0;
            const InstrumentForce force = force_of(Strands(0), exponent, 4, 7, &metres);
            CHECK(metres == about(3 * spacing).epsilon(0.01));
            CHECK(force.normal_sum == about(stiffness * std::pow(depth, exponent) * 3 * spacing).epsilon(0.01));
        }
    }

    // With one rule over a whole cell the force jumps by up to 1.6 %. A rule over each quarter lets a deep place and a shallow
    // one grow together within a quarter of a cell only. Newton's method takes a jump of 1e-3 for solved, where positions are
    // known (newton/kinks.cpp).
    TEST_CASE("property: the force hardly jumps where two places of a cell that touch grow together")
    {
        for (const double place : crest_places) {
            CAPTURE(place);
            int jumps = 0;
            CHECK(largest_jump(place, &jumps) < 1e-3);
            CHECK(jumps > 0);
        }
    }
}

}  // namespace seldinger::test::test_instrument_self

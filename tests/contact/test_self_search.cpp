// Search for places where a wire touches itself, against all pairs of points: what is passed over is too far apart to touch.

#include "contact/spline_rod.h"
#include "shared/instrument_slot.h"
#include "support/approx.h"

#include <cmath>
#include <vector>

namespace seldinger::test::test_self_search {

namespace {

constexpr double radius = 5e-4, skin = radius, spacing = 2 * radius;

/// A wire of cells two radii long, wound into a helix.
struct Helix {
    std::vector<double> position, material, theta, axes;
    InstrumentRod rod{};
    InstrumentPair pair{};
    std::vector<InstrumentSurface> surfaces;
    std::vector<uint> rod_of;

    /// @param bend  radius of the helix [m]  @param pitch  per turn [m]  @param edge  between nodes [m]
    Helix(double bend, double pitch, double edge, int cells)
    {
        const double turn = std::hypot(bend, pitch / 6.283185307179586), length = cells * spacing;
        const int nodes = static_cast<int>(std::lround(length / edge)) + 1;
        for (int i = 0; i < nodes; ++i) {
            const double s = length * i / (nodes - 1), angle = s / turn;
            position.insert(position.end(), {bend * std::cos(angle), bend * std::sin(angle), pitch / 6.283185307179586 * angle});
            material.push_back(s);
            theta.push_back(0);
        }
        rod.count = rod.count_t0 = static_cast<uint>(nodes);
        rod.epoch = 2;
        rod.live = static_cast<uint>(cells);
        rod.pairs = 1;
        rod.spacing = spacing;
        rod.inside = length;
        rod.longest_edge = edge;
        rod.widest = radius;
        pair.touch = SEL_TOUCH_SELF;
        pair.from_rod = pair.until_rod = SEL_NO_ROD;
        pair.from = -1;
        pair.until = 1e9;
        pair.stiffness = 1e7;
        pair.exponent = 1.5;
        pair.spread = 1 / std::beta(0.5, 2.0);
        InstrumentSurface surface{};
        surface.radius = radius;
        surface.load = 1e-3;
        surfaces.assign(static_cast<std::size_t>(cells), surface);
        rod_of.assign(static_cast<std::size_t>(cells), 0);
        for (int k = 0; k < cells; ++k)
            for (int i = 0; i < SEL_AXIS_POINTS; ++i) {
                const vec3 at = point(spacing * (k + 0.5 * i));
                axes.insert(axes.end(), {at.x, at.y, at.z});
            }
    }
    [[nodiscard]] InstrumentNodes nodes() const { return {position.data(), material.data(), theta.data()}; }
    [[nodiscard]] InstrumentBodies bodies() const { return instrument_bodies(&rod, &pair, surfaces.data(), rod_of.data()); }
    [[nodiscard]] vec3 point(double s) const { return test::point_of_material(spline_of(nodes(), 0, rod.count), s); }
    [[nodiscard]] SlotList slots(uint cell) const
    {
        InstrumentParams par{};
        par.skin = skin;
        return near_slots(cell, bodies(), nodes(), axes.data(), 0, par);
    }
    /// Distance of a point from the wire's axis between two coordinates, points of it that are half a circle of the surface away
    /// [m].
    [[nodiscard]] double distance(double s, double from, double until) const
    {
        const vec3 x = point(s);
        double least = INFINITY;
        for (double t = std::max(from, s + SEL_SELF_APART * radius); t <= until; t += 0.02 * radius) {
            const vec3 d = x - point(t);
            least = std::min(least, std::sqrt(dot3(d, d)));
        }
        return least;
    }
};

/// 1.3 turns of a helix, a strand beside the other by 1.95 radii for 0.3 turns, with a straight tail at its tip. @param tail  [m]
struct Spring : Helix {
    explicit Spring(double tail)
        : Helix(bend, 1.95 * radius, edge, static_cast<int>(1.3 * 2 * 3.141592653589793 * bend / spacing))
    {
        const double before = rod.inside;
        const vec3 tip = point(0), on = point(0.1 * edge), along = (1 / std::sqrt(dot3(on - tip, on - tip))) * (on - tip);
        for (int k = 1; k <= 3; ++k) {
            const vec3 x = tip - (tail * k / 3) * along;
            position.insert(position.begin(), {x.x, x.y, x.z});
            theta.push_back(0);
        }
        for (double& s : material) s += tail;
        material.insert(material.begin(), {0, tail / 3, 2 * tail / 3});
        rod.count = rod.count_t0 = static_cast<uint>(material.size());
        rod.inside = before + tail;
        rod.live = static_cast<uint>(rod.inside / spacing + 1e-9);
        surfaces.resize(rod.live + 1, surfaces.front());
        rod_of.resize(surfaces.size(), 0);
        axes.clear();
        for (uint k = 0; k < cells_inside(rod); ++k)
            for (int i = 0; i < SEL_AXIS_POINTS; ++i) {
                const vec3 at = point(std::min(spacing * (k + 0.5 * i), rod.inside));
                axes.insert(axes.end(), {at.x, at.y, at.z});
            }
    }
    /// Force of all cells [N].
    [[nodiscard]] double force() const
    {
        double sum = 0;
        for (uint cell = 0; cell < rod.live; ++cell) {
            const SlotList list = slots(cell);
            for (uint k = 0; k < list.count; ++k) {
                std::vector<InstrumentState> old(SEL_INSTRUMENT_SLOTS, no_instrument_state());
                std::vector<InstrumentPoint> points(SEL_INSTRUMENT_POINTS);
                InstrumentState now = no_instrument_state();
                InstrumentForce force;
                instrument_self_force(cell, list.slots[k], bodies(), nodes(), nodes(), old.data(), {}, &now, &force,
                                      points.data());
                sum += force.normal_sum;
            }
        }
        return sum;
    }
    static constexpr double bend = 4 * radius, edge = 0.3 * radius;
};

bool listed(const SlotList& list, uint cell)
{
    for (uint k = 0; k < list.count; ++k) {
        const auto first = static_cast<uint>(list.slots[k].at);
        if (cell >= first && cell < first + list.slots[k].cells) return true;
    }
    return false;
}

}  // namespace

TEST_SUITE("contact/self_search")
{
    TEST_CASE("self search: a wire that is straight, or bent to 30 radii and more, has nothing near itself")
    {
        for (const double bend : {30 * radius, 60 * radius, 1e3 * radius})
            for (const double edge : {0.4 * radius, 2.5 * radius}) {
                const Helix wire(bend, 40 * radius, edge, 60);
                for (uint cell = 0; cell < wire.rod.live; ++cell) CHECK(wire.slots(cell).count == 0);
            }
    }

    // Distances are sampled 0.02 radii apart, and change by no more than that between samples.
    TEST_CASE("self search: whatever comes within the skin of touching is listed, and no gap is below the clearance")
    {
        int touching = 0, clear = 0;
        for (const double bend : {1.2 * radius, 2 * radius, 4 * radius, 9 * radius, 13 * radius})
            for (const double pitch : {2.05 * radius, 3 * radius, 6 * radius}) {
                const Helix wire(bend, pitch, 0.5 * radius, 70);
                CAPTURE(bend / radius);
                CAPTURE(pitch / radius);
                for (uint cell = 0; cell < wire.rod.live; cell += 3) {
                    const SlotList list = wire.slots(cell);
                    if (list.count == SEL_INSTRUMENT_SLOTS) continue;  // the nearest are kept
                    for (int i = 0; i <= 4; ++i)
                        for (uint other = cell + 1; other < wire.rod.live; ++other) {
                            const double d = wire.distance((cell + 0.25 * i) * spacing, other * spacing, (other + 1) * spacing);
                            if (d >= 2 * radius + skin) continue;
                            ++touching;
                            CHECK(listed(list, other));
                        }
                    for (uint k = 0; k < list.count; ++k) {
                        std::vector<InstrumentState> old(SEL_INSTRUMENT_SLOTS, no_instrument_state());
                        std::vector<InstrumentPoint> points(SEL_INSTRUMENT_POINTS);
                        InstrumentState now = no_instrument_state();
                        InstrumentParams par{};
                        InstrumentForce force;
                        instrument_self_force(cell, list.slots[k], wire.bodies(), wire.nodes(), wire.nodes(), old.data(), par,
                                              &now, &force, points.data());
                        if (force.clear <= 0) continue;
                        ++clear;
                        const double from = list.slots[k].at * spacing, until = from + list.slots[k].cells * spacing;
                        for (int i = 0; i <= 16; ++i)
                            CHECK(wire.distance((cell + i / 16.0) * spacing, from, until) - 2 * radius >= force.clear - 1e-12);
                    }
                }
            }
        REQUIRE(touching > 100);
        REQUIRE(clear > 20);
    }

    // The same wire, cut into cells elsewhere: 7.5 radii of it touch. Each cell's rule of six points is right to 1e-3 and so. A
    // cell at the hub that is left out until all of it is inside takes up to two of these 7.5 radii away.
    TEST_CASE("self search: the part of a cell that has come through the inlet touches as the rest does")
    {
        const double whole = Spring(3 * spacing).force();
        REQUIRE(whole > 0);
        for (int k = 1; k <= 20; ++k) {
            CAPTURE(k);
            CHECK(Spring((3 + k / 20.0) * spacing).force() == test::about(whole).epsilon(0.005));
        }
    }
}

}  // namespace seldinger::test::test_self_search

// Kernels of contact between instruments against their host twins, bit for bit.

#include "contact/host_reference_support.h"
#include "contact/rods/instrument_cells.h"
#include "contact/spline_rod.h"
#include "shared/instrument_slot.h"

#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

namespace seldinger::test::test_instrument_kernels {

namespace {

constexpr int nodes_each = 40;

/// A catheter along x, a wire in it that comes out of its mouth, and a coil that crosses both and itself.
struct Bundle {
    std::unique_ptr<InstrumentCells> cells;
    std::vector<double> position, material, theta, position_t0;
    std::vector<InstrumentState> states;  // [cells][slots]
    InstrumentParams par{};

    [[nodiscard]] InstrumentBodies bodies() const
    {
        return instrument_bodies(cells->rods.data(), cells->pairs.data(), cells->surfaces.data(), cells->rod_of.data());
    }
    [[nodiscard]] InstrumentNodes nodes() const { return {position.data(), material.data(), theta.data()}; }
    [[nodiscard]] uint cell_count() const { return static_cast<uint>(cells->surfaces.size()); }
    [[nodiscard]] std::vector<double> axes() const
    {
        std::vector<double> points;
        for (std::size_t cell = 0; cell < cells->surfaces.size(); ++cell)
            for (int k = 0; k < SEL_AXIS_POINTS; ++k) {
                const InstrumentRod& rod = cells->rods[cells->rod_of[cell]];
                const vec3 at =
                    test::point_of_material(spline_of(nodes(), rod.node, rod.count), rod.spacing * (cell - rod.cell + 0.5 * k));
                points.insert(points.end(), {at.x, at.y, at.z});
            }
        return points;
    }
    /// As instrument_nodes() takes them.
    [[nodiscard]] std::vector<double> all(std::vector<double> places) const
    {
        REQUIRE(places.size() == 3 * theta.size());
        REQUIRE(material.size() == theta.size());
        for (const auto* list : {&material, &theta}) places.insert(places.end(), list->begin(), list->end());
        return places;
    }
    [[nodiscard]] InstrumentNodes nodes_t0() const { return {position_t0.data(), material.data(), theta.data()}; }
};

WireSpec spec(double length, double radius, double lumen)
{
    WireSpec wire;
    wire.length = length;
    wire.lumen_radius = lumen;
    wire.shaft.radius = radius;
    wire.shaft.density = 6000;
    wire.shaft.youngs = 1e8;
    return wire;
}

Vec3 place(int rod, double s)
{
    if (rod == 0) return {0.04 - s, 0, 0};
    if (rod == 1) return {0.05 - s, 0.2e-3 * std::sin(200 * s), 0.16e-3 * std::cos(170 * s)};
    const double turn = s / 1.2e-3;
    // its turns lie 0.45 to 0.57 mm apart, and touch below 0.5
    return {0.02 + 2.2e-4 * turn / 6.28 + (0.03 + 0.4 * s) * s, 0.9e-3 + 1.2e-3 * std::cos(turn), 1.2e-3 * std::sin(turn)};
}

Bundle make_scene(unsigned seed)
{
    InstrumentSetup setup;
    setup.wires = {spec(0.04, 0.8e-3, 0.5e-3), spec(0.05, 0.3e-3, 0), spec(0.02, 0.25e-3, 0)};
    setup.contacts.resize(3);
    setup.system_of = {0, 0, 0};
    setup.nested = {{{0, 1}, 0.1, 0.08, 0}};
    setup.from_outside = true;
    Bundle scene;
    scene.cells = std::make_unique<InstrumentCells>(setup);
    std::mt19937 random(seed);
    std::normal_distribution<double> some(0, 3e-6);
    for (int rod = 0; rod < 3; ++rod) {
        InstrumentRod& known = scene.cells->rods[rod];
        known.node = static_cast<uint>(nodes_each * rod);
        known.count = known.count_t0 = nodes_each;
        known.inside = setup.wires[rod].length;
        known.live = static_cast<uint>(scene.cells->of_wire[rod + 1] - scene.cells->of_wire[rod]);
        for (int i = 0; i < nodes_each; ++i) {
            const double s = known.inside * i / (nodes_each - 1);
            const Vec3 at = place(rod, s);
            known.longest_edge =
                std::max(known.longest_edge, i ? (at - place(rod, s - known.inside / (nodes_each - 1))).norm() : 0);
            for (int c = 0; c < 3; ++c) {
                scene.position.push_back(at[c] + some(random));
                scene.position_t0.push_back(at[c] + some(random));
            }
            scene.material.push_back(s);
            scene.theta.push_back(0.1 * s);
        }
        known.longest_edge += 4e-5;
    }
    scene.par.skin = 0.25e-3;
    scene.par.inv_dt = 1e3;
    scene.par.smooth_speed = 1e-3;
    scene.states.resize(SEL_INSTRUMENT_SLOTS * scene.cells->surfaces.size());
    std::memset(scene.states.data(), 0, scene.states.size() * sizeof(InstrumentState));
    return scene;
}

template <class T>
bool same(const T& a, const T& b)
{
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Compares outputs with a meaning: points that push, and friction where it acts.
bool same_force(const InstrumentForce& a, const InstrumentForce& b, const InstrumentPoint* points_a,
                const InstrumentPoint* points_b)
{
    if (a.count != b.count || a.flags != b.flags || a.depth != b.depth || a.normal_sum != b.normal_sum || a.stored != b.stored)
        return false;
    for (uint k = 0; k < a.count; ++k)
        if (!same(points_a[k], points_b[k])) return false;
    if (!(a.flags & SEL_FORCE_COUPLE)) return true;
    return same(a.force, b.force) && same(a.along, b.along) && same(a.across, b.across) && a.stiff_along == b.stiff_along &&
           a.skew == b.skew && a.friction_work == b.friction_work &&
           same(a.wa, b.wa) && same(a.db, b.db);
}

struct OnDevice {
    OnDevice(device::Context& context, device::Queue queue, const Bundle& s)
        : rods(context, queue, s.cells->rods),
          pairs(context, queue, s.cells->pairs),
          surfaces(context, queue, s.cells->surfaces),
          rod_of(context, queue, s.cells->rod_of),
          nodes(context, queue, s.all(s.position)),
          nodes_t0(context, queue, s.all(s.position_t0))
    {
    }
    Guarded<InstrumentRod> rods;
    Guarded<InstrumentPair> pairs;
    Guarded<InstrumentSurface> surfaces;
    Guarded<uint> rod_of;
    Guarded<double> nodes, nodes_t0;
};

/// Slots of all cells.
std::vector<InstrumentSlot> slots_of(const Bundle& s)
{
    std::vector<InstrumentSlot> found(s.states.size());
    const std::vector<double> axes = s.axes();
    for (uint cell = 0; cell < s.cell_count(); ++cell) {
        const SlotList list = near_slots(cell, s.bodies(), s.nodes(), axes.data(), 0, s.par);
        for (uint k = 0; k < SEL_INSTRUMENT_SLOTS; ++k) found[SEL_INSTRUMENT_SLOTS * cell + k] = list.slots[k];
    }
    return found;
}

struct Counts {
    int inside = 0, outside = 0, self = 0, self_pushing = 0, pushing = 0, whole = 0, sliding = 0, partly = 0;
};

Counts evaluate_by_both(device::Context& context, device::Queue queue, Bundle& s, const OnDevice& on,
                        const std::vector<InstrumentSlot>& slots)
{
    std::vector<uint> list;
    for (uint k = 0; k < slots.size(); ++k)
        if (slots[k].touch != SEL_TOUCH_NONE) list.push_back(k);
    s.par.item_count = static_cast<uint>(list.size());
    s.par.node_count = static_cast<uint>(s.theta.size());
    std::vector<InstrumentState> states(s.states.size());
    std::memset(states.data(), 0, states.size() * sizeof(InstrumentState));
    std::vector<InstrumentForce> forces(list.size());
    std::vector<InstrumentPoint> points(list.size() * SEL_INSTRUMENT_POINTS);
    Counts counts;
    Guarded<InstrumentState> device_states(context, queue, states), states_t0(context, queue, s.states);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const uint k = list[i], cell = k / SEL_INSTRUMENT_SLOTS;
        const auto force_of = slots[k].touch == SEL_TOUCH_SELF ? instrument_self_force : instrument_force;
        force_of(cell, slots[k], s.bodies(), s.nodes(), s.nodes_t0(), s.states.data() + SEL_INSTRUMENT_SLOTS * cell, s.par,
                 &states[k], &forces[i], points.data() + SEL_INSTRUMENT_POINTS * i);
        const InstrumentForce& f = forces[i];
        (slots[k].touch == SEL_TOUCH_INSIDE ? counts.inside : slots[k].touch == SEL_TOUCH_SELF ? counts.self : counts.outside)++;
        counts.self_pushing += slots[k].touch == SEL_TOUCH_SELF && f.count > 0;
        counts.pushing += f.count > 0;
        counts.whole += f.count > 0 && (states[k].contact.flags & SEL_CONTACT_WHOLE);
        counts.sliding += (f.flags & SEL_FORCE_SLIDING) != 0;
        counts.partly += f.count > 0 && f.length < 0.99 * s.cells->rods[s.cells->rod_of[cell]].spacing;
    }
    Guarded<uint> device_list(context, queue, list);
    Guarded<InstrumentSlot> device_slots(context, queue, slots);
    Guarded<InstrumentForce> device_forces(context, queue, std::vector<InstrumentForce>(list.size()));
    Guarded<InstrumentPoint> device_points(context, queue, std::vector<InstrumentPoint>(points.size()));
    for (const InstrumentKernels::Of of : {InstrumentKernels::Of::Others, InstrumentKernels::Of::Itself}) {
        InstrumentKernels kernels(context, "contact/instruments.cl", of);
        kernels.provide(list.size());
        kernels.launch(queue, list.size(), s.par, device_list.buffer(), on.rods.buffer(), on.pairs.buffer(),
                       on.surfaces.buffer(), on.rod_of.buffer(), device_slots.buffer(), on.nodes.buffer(), on.nodes_t0.buffer(),
                       states_t0.buffer(), device_states.buffer(), device_forces.buffer(), device_points.buffer());
    }
    const std::vector<InstrumentForce> by_device = device_forces.read();
    const std::vector<InstrumentPoint> points_by_device = device_points.read();
    for (std::size_t k = 0; k < list.size(); ++k) {
        const std::size_t first = k * SEL_INSTRUMENT_POINTS;
        CHECK(same_force(by_device[k], forces[k], points_by_device.data() + first, points.data() + first));
    }
    CHECK(first_difference(device_states.read(), states) == -1);
    s.states = states;
    return counts;
}

}  // namespace

TEST_SUITE("contact/instrument_kernels")
{
    TEST_CASE("twin: instruments_evaluate, over two steps")
    {
        device::Context& context = reference_context(false);
        for (const device::Queue queue : {device::Queue::Inline, device::Queue::Pool}) {
            Bundle scene = make_scene(7);
            scene.par.follow = queue == device::Queue::Pool;  // there states of what does not touch are written too
            const OnDevice first(context, queue, scene);
            const Counts one = evaluate_by_both(context, queue, scene, first, slots_of(scene));
            REQUIRE(one.inside > 20);
            REQUIRE(one.outside > 3);
            REQUIRE(one.self > 5);
            REQUIRE(one.self_pushing > 5);
            REQUIRE(one.pushing > 10);
            REQUIRE(one.partly > 3);
            // a second step from where the first one ended, with the states that it left
            scene.position_t0 = scene.position;
            for (double& x : scene.position) x += 2e-7;
            for (InstrumentRod& rod : scene.cells->rods) rod.epoch++;
            for (std::size_t k = 0; k < nodes_each; ++k) scene.position[3 * k] += 2e-5;  // the catheter alone, along itself
            const OnDevice second(context, queue, scene);
            const Counts two = evaluate_by_both(context, queue, scene, second, slots_of(scene));
            REQUIRE(two.pushing > 10);
            REQUIRE(one.whole > 3);  // and so taken as a whole in the second step
            REQUIRE(two.sliding > 3);
        }
    }
}

}  // namespace seldinger::test::test_instrument_kernels

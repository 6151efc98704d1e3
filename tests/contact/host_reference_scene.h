// What the reference tests are made of (host_reference_cases.h): a drawn scene, the plain loops over the shared functions, and
// the arguments that kernels take together. `seldinger` may be another namespace here.
#pragma once

#include "contact/host_reference_names.h"
#include "shared/barrier_path.h"
#include "shared/edge_sums.h"
#include "shared/layer.h"
#include "shared/multipliers.h"
#include "shared/sweep.h"

#include <algorithm>
#include <cstddef>
#include <random>
#include <string>

namespace {

constexpr std::size_t counts_to_try[] = {0, 1, 63, 64, 65, 257};  // below, at and beyond a work-group of 64

struct Draw {
    std::mt19937 rng{11};
    double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(rng); }
    uint below(uint n) { return std::uniform_int_distribution<uint>(0, n - 1)(rng); }
};

// Three wires of 7, 40 and 2 nodes along the tube's wall: touching, pressing through, and apart. In a narrow lumen: along its
// axis, and so thick that both sides touch.
struct Scene {
    Draw draw;
    std::vector<float> hi, hi_t0;
    std::vector<real> lo, lo_t0, theta, theta_t0;
    std::vector<uint> edges;  // index of the tip-side node of every edge
    std::vector<QuadratureModel> models;
    std::vector<QuadraturePlace> places;
    std::vector<ContactState> states_t0;
    std::vector<MultiplierState> multiplier;
    std::vector<TreeNode> nodes;
    ContactParams par{};
    const sel_reference::ReferenceWall& wall = sel_reference::reference_wall();

    [[nodiscard]] WallView view() const { return wall_view(nodes.data(), wall.vertices.data(), wall.boundary.data()); }
    [[nodiscard]] NodeView now() const { return node_view(hi.data(), lo.data(), theta.data()); }
    [[nodiscard]] NodeView before() const { return node_view(hi_t0.data(), lo_t0.data(), theta_t0.data()); }
    [[nodiscard]] AxisPoint axis(uint point) const { return axis_point(places[point].edge, places[point].bary, now()); }
    /// @param candidates  [points][par.slots]
    [[nodiscard]] PointView point(uint at, const std::vector<uint>& candidates, const std::vector<uint>& counts) const
    {
        return point_view(at, models[at], places[at], near_wall_view(view(), candidates.data() + at * par.slots, counts[at]));
    }

    explicit Scene(std::size_t points, bool narrow = false)
    {
        nodes.resize(wall.nodes.size() / sizeof(TreeNode));
        std::memcpy(nodes.data(), wall.nodes.data(), wall.nodes.size());
        for (uint n : {7u, 40u, 2u}) add_wire(n, narrow);
        hi.insert(hi.end(), {0, 0, 0});  // one past the end, as DeviceNodes has it
        for (int k = 0; k < 3; ++k) lo.push_back(0);
        theta.push_back(0);
        hi_t0 = hi;
        lo_t0 = lo;
        theta_t0 = theta;
        for (real& x : lo_t0) x += static_cast<real>(draw(-3e-6, 3e-6));
        for (real& x : theta_t0) x += static_cast<real>(draw(-0.01, 0.01));
        for (std::size_t k = 0; k < points; ++k) add_point(k);
        if (narrow)  // the facets are planes 0.98 to 1.01 of its radius from the axis
            for (QuadratureModel& m : models) m.radius = static_cast<real>(1.01 * wall.radius);
        par.slots = 64;
        par.friction = SEL_FRICTION_STICK_SLIP;
        par.inv_dt = 1000;
        par.smoothing = static_cast<real>(0.002);
        par.smooth_speed = static_cast<real>(1e-3);
    }

    void add_wire(uint n, bool narrow)
    {
        const double angle = draw(0, 6.28), from = draw(-0.012, 0), twist = draw(-1, 1);
        for (uint i = 0; i < n; ++i) {
            if (i + 1 < n) edges.push_back(static_cast<uint>(theta.size()));
            const double x = from + 0.012 * i / n,
                         rho = narrow ? draw(0, 1e-5) : wall.radius - 0.4445e-3 * draw(0.3, 1.15), a = angle + twist * i / n;
            for (double p : {x, rho * std::cos(a), rho * std::sin(a)}) {
                hi.push_back(static_cast<float>(p));
                lo.push_back(static_cast<real>(p - hi.back()));
            }
            theta.push_back(static_cast<real>(draw(-1, 1)));
        }
    }

    QuadratureModel model(std::size_t k)
    {
        QuadratureModel m{};
        m.weight = m.length = static_cast<real>(k % 17 == 16 ? 0.0 : 4e-4);
        m.radius = static_cast<real>(k % 2 ? 0.4445e-3 : 0.35e-3);
        m.reach = static_cast<real>(0.1 * 0.4445e-3);
        m.exponent = static_cast<real>(std::array{1.0, 1.5, 2.0}[k % 3]);
        m.stiffness = static_cast<real>(1.5e8 * std::pow(1e-6, 1.5 - m.exponent));
        m.friction_stiffness = static_cast<real>(1e5);
        m.mu_static = static_cast<real>(0.25);
        m.mu_sliding = static_cast<real>(0.2);
        m.speed_floor = static_cast<real>(1e-4);
        m.depth_limit = k % 5 ? m.radius / 2 : 0;
        m.depth_exact = k % 5 == 1 ? static_cast<real>(0.8) * m.depth_limit : k % 5 == 2 ? static_cast<real>(1e-6) : 0;
        m.damping = static_cast<real>(k % 4 ? 1.43 : 0.0);
        m.roll_arm = static_cast<real>(k % 3 ? 0.04 : 0.0);
        m.roll_depth = 2 * m.radius;
        m.roll_force = static_cast<real>(k % 2 ? 1e-9 : 0.0);
        m.penalty_stiffness = static_cast<real>(1e5);
        m.law_length = static_cast<real>(1e-5);
        m.line_mass = static_cast<real>(5e-3);
        m.restitution = static_cast<real>(0.5);
        m.multiplier_most = static_cast<real>(k % 3 == 0 ? 20 : 2000);
        return m;
    }

    void add_point(std::size_t k)
    {
        models.push_back(model(k));
        QuadraturePlace p{};
        p.edge = edges[k * edges.size() / 300 % edges.size()];
        p.edge_t0 = k % 23 == 22 ? SEL_NO_EDGE : p.edge;
        p.bary = static_cast<real>(k % 7 == 0 ? 0 : k % 7 == 1 ? 1 : draw(0, 1));
        p.bary_t0 = p.bary;
        p.epoch = 9;
        p.radius_reduction = static_cast<real>(k % 3 ? 0 : 2e-4);
        places.push_back(p);
        for (int side = 0; side < 2; ++side) {
            ContactState t{};
            const double n[3] = {draw(-1, 1), draw(-1, 1), draw(-1, 1)}, size = std::hypot(n[0], n[1], n[2]);
            for (int i = 0; i < 3; ++i) {
                t.normal[i] = static_cast<real>(n[i] / size);
                t.slip[i] = static_cast<real>(draw(-1e-6, 1e-6));
            }
            t.gap = static_cast<real>(draw(-2e-4, 1e-5));
            t.rate = static_cast<real>(draw(-0.01, 0.05));
            t.approach = static_cast<real>(draw(1e-4, 0.05));
            t.roll = static_cast<real>(draw(-1e-3, 1e-3));
            t.flags = draw.below(4);
            t.epoch = draw.below(3) ? 8 : 3;  // of the last step, or stale
            t.normal_force = static_cast<real>(draw(0, 1e-3));
            for (real& f : t.friction) f = static_cast<real>(draw(-1e-4, 1e-4));
            states_t0.push_back(t);
            MultiplierState h{};
            for (int i = 0; i < 3; ++i) {
                h.normal[i] = t.normal[i];
                h.friction[i] = static_cast<real>(draw(-0.1, 0.1));
            }
            h.force = static_cast<real>(draw(0, 1));
            h.stiffness = static_cast<real>(draw(1e5, 1e7));
            h.miss = static_cast<real>(draw(0, 1e-5));
            h.live = draw.below(3) > 0;
            multiplier.push_back(h);
        }
    }
};

std::vector<uint> up_to(std::size_t n)
{
    std::vector<uint> list(n);
    for (std::size_t k = 0; k < n; ++k) list[k] = static_cast<uint>(n - 1 - k);  // any order is allowed
    return list;
}

// host loops ------------------------------------------------------------------------------------------------------------------

struct Found {
    std::vector<uint> candidates, counts;
    std::vector<Clearance> clearances{};
    std::vector<real> touching{};  // layer: L'
};

Found host_find(const Scene& s, const std::vector<uint>& list, real slack, uint slots)
{
    const std::size_t n = s.models.size();
    Found out{std::vector<uint>(n * slots), std::vector<uint>(n), std::vector<Clearance>(n)};
    for (uint point : list) {
        const AxisPoint at = s.axis(point);
        const real radius = s.models[point].radius, range = radius + s.models[point].reach + slack;
        out.counts[point] =
            find_near_cells(at, range, SEL_NEAR_CELL_SIZE * radius, s.view(), slots, out.candidates.data() + point * slots);
        out.clearances[point] = found_clearance(at.origin + at.offset, range, slack, radius, out.counts[point]);
    }
    return out;
}

struct Evaluated {
    std::vector<ContactForce> forces;
    std::vector<real> barys;
    std::vector<ContactState> states;
    std::vector<Clearance> clearances;
    std::vector<WallMemory> memories;
};

Evaluated host_evaluate(const Scene& s, const ContactParams& par, const std::vector<uint>& list, const Found& found)
{
    Evaluated out{std::vector<ContactForce>(list.size()), std::vector<real>(list.size()), s.states_t0, found.clearances,
                  std::vector<WallMemory>(s.models.size())};
    for (std::size_t k = 0; k < list.size(); ++k) {
        const uint at = list[k];
        write_force(contact_force(s.point(at, found.candidates, found.counts), par, s.now(), s.before(),
                                  state_view(s.states_t0.data(), out.states.data(), s.multiplier.data()), &out.clearances[at],
                                  &out.memories[at]),
                    &out.forces[k]);
        out.barys[k] = s.places[at].bary;
    }
    return out;
}

/// Arguments that kernels take together, on the device.
struct GuardedNodes {
    GuardedNodes(sel_device::Context& context, Queue queue, NodeView from, std::size_t nodes)
        : hi(context, queue, std::vector<float>(from.hi, from.hi + 3 * nodes)),
          lo(context, queue, std::vector<real>(from.lo, from.lo + 3 * nodes)),
          theta(context, queue, std::vector<real>(from.theta, from.theta + nodes))
    {
    }
    template <class F>
    void for_each_argument(const F& f) const
    {
        f(hi.buffer());
        f(lo.buffer());
        f(theta.buffer());
    }
    Guarded<float> hi;
    Guarded<real> lo, theta;
};
struct GuardedWall {
    GuardedWall(sel_device::Context& context, Queue queue, const Scene& s)
        : nodes(context, queue, s.nodes), vertices(context, queue, s.wall.vertices), boundary(context, queue, s.wall.boundary)
    {
    }
    template <class F>
    void for_each_argument(const F& f) const
    {
        f(nodes.buffer());
        f(vertices.buffer());
        f(boundary.buffer());
    }
    Guarded<TreeNode> nodes;
    Guarded<float> vertices;
    Guarded<uint> boundary;
};

/// Whether kernels evaluate a point as a whole, and so keep its memory of the wall.
bool device_remembers() { return sel_reference::reference_context(float32).workgroup(sel_device::Items::Branching) == 1; }

Evaluated device_evaluate(const Scene& s, ContactParams par, const std::vector<uint>& list, const Found& found, Queue queue)
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_reference::ForceKernels kernels(context, "contact/evaluation.cl", list.size(), true);
    par.item_count = static_cast<uint>(list.size());
    Guarded<uint> items(context, queue, list), candidates(context, queue, found.candidates), counts(context, queue, found.counts);
    Guarded<QuadratureModel> models(context, queue, s.models);
    Guarded<QuadraturePlace> places(context, queue, s.places);
    const GuardedNodes now(context, queue, s.now(), s.theta.size()), before(context, queue, s.before(), s.theta.size());
    const GuardedWall wall(context, queue, s);
    Guarded<ContactState> t0(context, queue, s.states_t0), t1(context, queue, s.states_t0);
    Guarded<ContactForce> forces(context, queue, std::vector<ContactForce>(list.size()));
    Guarded<real> barys(context, queue, std::vector<real>(list.size()));
    Guarded<MultiplierState> multiplier(context, queue, s.multiplier);
    Guarded<Clearance> clearances(context, queue, found.clearances);
    Guarded<WallMemory> memories(context, queue, std::vector<WallMemory>(s.models.size()));
    kernels.launch(queue, list.size(), par, items.buffer(), models.buffer(), places.buffer(), candidates.buffer(),
                   counts.buffer(), wall, now, before, t0.buffer(), t1.buffer(), forces.buffer(), barys.buffer(),
                   multiplier.buffer(), clearances.buffer(), memories.buffer());
    (void)candidates.read();
    return {forces.read(), barys.read(), t1.read(), clearances.read(), memories.read()};
}

}  // namespace

// The bodies of the reference tests, compiled once in double (test_host_reference.cpp) and once in float
// (test_host_reference_float32.cpp, where `seldinger` is another namespace). Every kernel runs against a plain loop over the same
// shared functions; the arithmetic is the same operation by operation (contraction off on both sides, divisions and roots
// correctly rounded), so the bits are the same.
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

using namespace seldinger;
using sel_device::Queue;
using sel_reference::first_difference;
using sel_reference::Guarded;

#ifdef SEL_FLOAT32
constexpr bool float32 = true;
#else
constexpr bool float32 = false;
#endif
constexpr std::size_t counts_to_try[] = {0, 1, 63, 64, 65, 257};  // below, at and beyond a work-group of 64

struct Draw {
    std::mt19937 rng{11};
    double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(rng); }
    uint below(uint n) { return std::uniform_int_distribution<uint>(0, n - 1)(rng); }
};

// Three wires of 7, 40 and 2 nodes along the tube's wall: touching, pressing through, and apart.
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

    explicit Scene(std::size_t points)
    {
        nodes.resize(wall.nodes.size() / sizeof(TreeNode));
        std::memcpy(nodes.data(), wall.nodes.data(), wall.nodes.size());
        for (uint n : {7u, 40u, 2u}) add_wire(n);
        hi.insert(hi.end(), {0, 0, 0});  // one past the end, as DeviceNodes has it
        for (int k = 0; k < 3; ++k) lo.push_back(0);
        theta.push_back(0);
        hi_t0 = hi;
        lo_t0 = lo;
        theta_t0 = theta;
        for (real& x : lo_t0) x += static_cast<real>(draw(-3e-6, 3e-6));
        for (real& x : theta_t0) x += static_cast<real>(draw(-0.01, 0.01));
        for (std::size_t k = 0; k < points; ++k) add_point(k);
        par.slots = 64;
        par.friction = SEL_FRICTION_STICK_SLIP;
        par.inv_dt = 1000;
        par.smoothing = static_cast<real>(0.002);
        par.smooth_speed = static_cast<real>(1e-3);
    }

    void add_wire(uint n)
    {
        const double angle = draw(0, 6.28), from = draw(-0.012, 0), twist = draw(-1, 1);
        for (uint i = 0; i < n; ++i) {
            if (i + 1 < n) edges.push_back(static_cast<uint>(theta.size()));
            const double x = from + 0.012 * i / n, rho = wall.radius - 0.4445e-3 * draw(0.3, 1.15), a = angle + twist * i / n;
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
        m.ridges = static_cast<real>(k % 2);
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
            find_near_nodes(at, range, SEL_NEAR_NODE_SIZE * radius, s.view(), slots, out.candidates.data() + point * slots);
        out.clearances[point] = found_clearance(at.origin + at.offset, range, slack, radius, out.counts[point]);
    }
    return out;
}

struct Evaluated {
    std::vector<ContactForce> forces;
    std::vector<real> barys;
    std::vector<ContactState> states;
    std::vector<Clearance> clearances;
};

Evaluated host_evaluate(const Scene& s, const ContactParams& par, const std::vector<uint>& list, const Found& found)
{
    Evaluated out{std::vector<ContactForce>(list.size()), std::vector<real>(list.size()), s.states_t0, found.clearances};
    for (std::size_t k = 0; k < list.size(); ++k) {
        const uint at = list[k];
        write_force(contact_force(s.point(at, found.candidates, found.counts), par, s.now(), s.before(),
                                  state_view(s.states_t0.data(), out.states.data(), s.multiplier.data()), &out.clearances[at]),
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

Evaluated device_evaluate(const Scene& s, ContactParams par, const std::vector<uint>& list, const Found& found, Queue queue)
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_device::Kernel kernel(context, "contact/evaluation.cl", "contact_evaluate");
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
    kernel.launch(queue, list.size(), par, items.buffer(), models.buffer(), places.buffer(), candidates.buffer(), counts.buffer(),
                  wall, now, before, t0.buffer(), t1.buffer(), forces.buffer(), barys.buffer(), multiplier.buffer(),
                  clearances.buffer());
    (void)candidates.read();
    return {forces.read(), barys.read(), t1.read(), clearances.read()};
}

// layer: every edge of the scene, repeated until `count`
// -------------------------------------------------------------------------
std::vector<LayerEdge> layer_edges(Scene& s, std::size_t count)
{
    std::vector<LayerEdge> list(count);
    for (std::size_t k = 0; k < count; ++k) {
        list[k] = LayerEdge{};
        list[k].node = s.edges[k % s.edges.size()];
        list[k].epoch = 9;
        list[k].model = s.model(k);
        list[k].reach = list[k].model.radius / 2;
        list[k].width = list[k].model.radius * static_cast<real>(s.draw(0.25, 2));
        list[k].height = list[k].model.radius + list[k].reach;
    }
    return list;
}

Found host_layer_find(const Scene& s, const std::vector<LayerEdge>& edges, uint slots)
{
    Found out{std::vector<uint>(edges.size() * slots), std::vector<uint>(edges.size()), {}, std::vector<real>(edges.size())};
    for (std::size_t k = 0; k < edges.size(); ++k)
        out.counts[k] = find_pairs(edges[k], s.now(), s.view(), slots, out.candidates.data() + k * slots, &out.touching[k]);
    return out;
}

Found device_layer_find(const Scene& s, const std::vector<LayerEdge>& edges, uint slots, Queue queue)
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_device::Kernel kernel(context, "contact/layer.cl", "layer_find");
    ContactParams par = s.par;
    par.item_count = static_cast<uint>(edges.size());
    par.slots = slots;
    Guarded<LayerEdge> list(context, queue, edges);
    const GuardedNodes now(context, queue, s.now(), s.theta.size());
    const GuardedWall wall(context, queue, s);
    Guarded<uint> candidates(context, queue, std::vector<uint>(edges.size() * slots)),
        counts(context, queue, std::vector<uint>(edges.size()));
    Guarded<real> touching(context, queue, std::vector<real>(edges.size()));
    kernel.launch(queue, edges.size(), par, list.buffer(), now, wall, candidates.buffer(), counts.buffer(), touching.buffer());
    return {candidates.read(), counts.read(), {}, touching.read()};
}

// the cases --------------------------------------------------------------------------------------------------------------------

void find_case()
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_device::Kernel kernel(context, "contact/near_wall.cl", "contact_find");
    std::size_t found = 0;
    uint most = 0;
    for (const Queue queue : {Queue::Inline, Queue::Pool})
        for (const std::size_t n : counts_to_try)
            for (const uint slots : {1u, 5u, 64u}) {  // the first two overflow: what does not fit is counted, not written
                Scene s(n);
                const std::vector<uint> list = up_to(n);
                const real slack = static_cast<real>(1.5e-4);
                s.par.item_count = static_cast<uint>(n);
                s.par.slots = slots;
                const Found host = host_find(s, list, slack, slots);
                Guarded<uint> items(context, queue, list), candidates(context, queue, std::vector<uint>(n * slots)),
                    counts(context, queue, std::vector<uint>(n)), by_item(context, queue, std::vector<uint>(n));
                Guarded<Clearance> clearances(context, queue, std::vector<Clearance>(n));
                Guarded<QuadratureModel> models(context, queue, s.models);
                Guarded<QuadraturePlace> places(context, queue, s.places);
                const GuardedNodes now(context, queue, s.now(), s.theta.size());
                const GuardedWall wall(context, queue, s);
                kernel.launch(queue, n, s.par, slack, items.buffer(), models.buffer(), places.buffer(), now, wall,
                              candidates.buffer(), counts.buffer(), by_item.buffer(), clearances.buffer());
                CAPTURE(n);
                CAPTURE(slots);
                CHECK(first_difference(counts.read(), host.counts) == -1);
                CHECK(first_difference(candidates.read(), host.candidates) == -1);
                CHECK(first_difference(clearances.read(), host.clearances) == -1);
                std::vector<uint> listed;
                for (uint point : list) listed.push_back(host.counts[point]);
                CHECK(first_difference(by_item.read(), listed) == -1);
                for (uint c : host.counts) {
                    found += c;
                    most = std::max(most, c);
                }
            }
    REQUIRE(found > 1000);
    REQUIRE(most > 5);
}

void distance_case()
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_device::Kernel kernel(context, "contact/near_wall.cl", "contact_distance");
    for (const Queue queue : {Queue::Inline, Queue::Pool})
        for (const std::size_t n : counts_to_try) {
            Scene s(n);
            const std::vector<uint> list = up_to(n);
            const real most = static_cast<real>(0.35e-3);  // beyond some, within others
            std::vector<real> host(n);
            for (std::size_t k = 0; k < n; ++k) {
                const AxisPoint at = s.axis(list[k]);
                const vec3 p = at.origin + at.offset;
                host[k] = wall_distance(p, most, s.view());
                // and against all triangles, none left out
                real nearest = most;
                for (std::size_t t = 0; t < s.wall.vertices.size() / 9; ++t) {
                    int feature;
                    const Triangle tri = load_triangle(s.wall.vertices.data(), static_cast<uint>(t), make_vec3(0, 0, 0));
                    const vec3 v = p - closest_on_triangle(p, tri, &feature);
                    nearest = std::min(nearest, std::sqrt(dot3(v, v)));
                }
                CHECK(std::abs(host[k] - nearest) <= (float32 ? 1e-7 : 1e-16));  // the root of most^2
            }
            Guarded<uint> items(context, queue, list);
            Guarded<QuadraturePlace> places(context, queue, s.places);
            const GuardedNodes now(context, queue, s.now(), s.theta.size());
            const GuardedWall wall(context, queue, s);
            Guarded<real> distances(context, queue, std::vector<real>(n));
            kernel.launch(queue, n, static_cast<cl_uint>(n), most, items.buffer(), places.buffer(), now, wall,
                          distances.buffer());
            CAPTURE(n);
            CHECK(first_difference(distances.read(), host) == -1);
            if (n > 100) {
                REQUIRE(std::count(host.begin(), host.end(), std::sqrt(most * most)) > 0);
                REQUIRE(std::count_if(host.begin(), host.end(), [&](real d) { return d < (real)0.99 * most; }) > 0);
            }
        }
}

void evaluate_case()
{
    std::size_t touched = 0, sliding = 0, both = 0, outside = 0;
    for (const Queue queue : {Queue::Inline, Queue::Pool})
        for (const std::size_t n : counts_to_try)
            for (const uint friction : {SEL_FRICTION_STICK_SLIP, SEL_FRICTION_SMOOTH, SEL_FRICTION_SIGN, SEL_FRICTION_NONE}) {
                Scene s(n);
                s.par.friction = friction;
                s.par.inv_dt = static_cast<real>(n == 65 ? 0 : 1000);
                s.par.settling = n == 64 ? SEL_SETTLE_STUCK : n == 63 ? SEL_SETTLE_SLIDING : 0u;
                s.par.known = n == 257 ? SEL_KNOWN_LINEAR : n == 1 ? SEL_KNOWN_FORCE : 0u;
                const std::vector<uint> list = up_to(n);
                const Found found = host_find(s, list, static_cast<real>(2e-4), s.par.slots);
                REQUIRE((n == 0 || *std::max_element(found.counts.begin(), found.counts.end()) <= s.par.slots));
                const Evaluated host = host_evaluate(s, s.par, list, found),
                                device = device_evaluate(s, s.par, list, found, queue);
                CAPTURE(n);
                CAPTURE(friction);
                CHECK(first_difference(device.forces, host.forces) == -1);
                CHECK(first_difference(device.barys, host.barys) == -1);
                CHECK(first_difference(device.states, host.states) == -1);
                CHECK(first_difference(device.clearances, host.clearances) == -1);
                for (const ContactForce& f : host.forces) {
                    touched += f.contacts > 0;
                    sliding += (f.flags & SEL_FORCE_SLIDING) != 0;
                    both += f.contacts > 1;
                    outside += (f.flags & SEL_FORCE_OUTSIDE) != 0;
                }
            }
    REQUIRE(touched > 500);
    REQUIRE(sliding > 100);
}

void evaluate_multiplier_case()
{
    std::size_t touched = 0, blocked = 0, sliding = 0;
    for (const uint law : {SEL_NORMAL_AUGMENTED, SEL_NORMAL_CONSTRAINT, SEL_NORMAL_IMPULSE, SEL_NORMAL_BARRIER})
        for (const std::size_t n : {64u, 257u}) {
            Scene s(n);
            s.par.normal_law = law;
            const std::vector<uint> list = up_to(n);
            const Found found = host_find(s, list, static_cast<real>(2e-4), s.par.slots);
            const Evaluated host = host_evaluate(s, s.par, list, found),
                            device = device_evaluate(s, s.par, list, found, n == 64 ? Queue::Inline : Queue::Pool);
            CAPTURE(law);
            CHECK(first_difference(device.forces, host.forces) == -1);
            CHECK(first_difference(device.states, host.states) == -1);
            CHECK(first_difference(device.clearances, host.clearances) == -1);
            for (const ContactForce& f : host.forces) {
                touched += f.contacts > 0;
                blocked += (f.flags & SEL_FORCE_BLOCKED) != 0;
                sliding += (f.flags & SEL_FORCE_SLIDING) != 0;
            }
        }
    REQUIRE(touched > 200);
    REQUIRE(blocked > 20);
    REQUIRE(sliding > 5);
}

void multipliers_case()
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_device::Kernel start(context, "contact/multipliers.cl", "contact_start"),
        next(context, "contact/multipliers.cl", "contact_multipliers");
    std::size_t changed = 0, stiffened = 0;
    for (const uint law : {SEL_NORMAL_AUGMENTED, SEL_NORMAL_CONSTRAINT, SEL_NORMAL_IMPULSE})
        for (const std::size_t n : counts_to_try) {
            const Queue queue = n % 2 ? Queue::Inline : Queue::Pool;
            Scene s(n);
            s.par.normal_law = law;
            s.par.item_count = static_cast<uint>(n);
            std::vector<uint> counts(n);
            for (uint& c : counts) c = s.draw.below(3);
            std::vector<MultiplierState> started(2 * n), after(2 * n);
            std::vector<real> ratios(n);
            std::vector<ContactState> states = s.states_t0;
            for (std::size_t k = 0; k < 2 * n; ++k) states[k].epoch = k % 5 ? 9 : 8;
            for (std::size_t k = 0; k < n; ++k) {
                real ratio = 0;
                for (std::size_t side = 2 * k; side < 2 * k + 2; ++side) {
                    started[side] = multiplier_start(s.states_t0[side], s.places[k].epoch, s.models[k], s.par);
                    ContactState state = states[side];
                    if (counts[k] == 0) state.flags = 0;
                    after[side] = multiplier_update(s.multiplier[side], state, s.states_t0[side], s.places[k].epoch, s.models[k],
                                                    s.par, &ratio);
                    stiffened += after[side].stiffness > s.multiplier[side].stiffness;
                }
                ratios[k] = ratio;
                changed += ratio > 1;
            }
            Guarded<QuadratureModel> models(context, queue, s.models);
            Guarded<QuadraturePlace> places(context, queue, s.places);
            Guarded<uint> found(context, queue, counts);
            Guarded<ContactState> t0(context, queue, s.states_t0), t1(context, queue, states);
            Guarded<MultiplierState> multiplier(context, queue, s.multiplier),
                out(context, queue, std::vector<MultiplierState>(2 * n)),
                fresh(context, queue, std::vector<MultiplierState>(2 * n));
            Guarded<real> result(context, queue, std::vector<real>(n));
            start.launch(queue, n, s.par, models.buffer(), places.buffer(), t0.buffer(), fresh.buffer());
            next.launch(queue, n, s.par, models.buffer(), places.buffer(), found.buffer(), t0.buffer(), t1.buffer(),
                        multiplier.buffer(), out.buffer(), result.buffer());
            CAPTURE(law);
            CAPTURE(n);
            CHECK(first_difference(fresh.read(), started) == -1);
            CHECK(first_difference(out.read(), after) == -1);
            CHECK(first_difference(result.read(), ratios) == -1);
        }
    REQUIRE(changed > 100);
    REQUIRE(stiffened > 50);
}

void sweep_case()
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_device::Kernel clearance(context, "contact/barrier_path.cl", "contact_clearance"),
        sweep(context, "contact/barrier_path.cl", "contact_sweep");
    std::size_t stopped = 0, near_wall = 0;
    for (const std::size_t n : counts_to_try) {
        const Queue queue = n % 2 ? Queue::Inline : Queue::Pool;
        Scene s(n);
        for (std::size_t k = 0; k < s.lo_t0.size(); ++k) s.lo_t0[k] = s.lo[k] + static_cast<real>(s.draw(-1e-4, 1e-4));
        const std::vector<uint> list = up_to(n);
        const Found found = host_find(s, list, static_cast<real>(4e-4), s.par.slots);
        std::vector<real> gaps(n), ways(n);
        for (std::size_t k = 0; k < n; ++k) {
            const uint at = list[k];
            const QuadraturePlace p = s.places[at];
            const PointView point = s.point(at, found.candidates, found.counts);
            gaps[k] = gap_of_point(point, s.par, s.now(), s.states_t0.data());
            ways[k] = sweep_point(axis_point(p.edge, p.bary, s.before()), axis_point(p.edge, p.bary, s.now()),
                                  s.models[at].radius - p.radius_reduction, point.near);
            near_wall += gaps[k] < s.models[at].reach;
            stopped += ways[k] > 0 && ways[k] < 1;
        }
        s.par.item_count = static_cast<uint>(n);
        Guarded<uint> items(context, queue, list), candidates(context, queue, found.candidates),
            counts(context, queue, found.counts);
        Guarded<QuadratureModel> models(context, queue, s.models);
        Guarded<QuadraturePlace> places(context, queue, s.places);
        const GuardedNodes now(context, queue, s.now(), s.theta.size()), before(context, queue, s.before(), s.theta.size());
        const GuardedWall wall(context, queue, s);
        Guarded<real> gap_out(context, queue, std::vector<real>(n)), way_out(context, queue, std::vector<real>(n));
        Guarded<ContactState> t0(context, queue, s.states_t0);
        clearance.launch(queue, n, s.par, items.buffer(), models.buffer(), places.buffer(), candidates.buffer(), counts.buffer(),
                         wall, now, t0.buffer(), gap_out.buffer());
        sweep.launch(queue, n, s.par, items.buffer(), models.buffer(), places.buffer(), candidates.buffer(), counts.buffer(),
                     wall, before, now, way_out.buffer());
        CAPTURE(n);
        CHECK(first_difference(gap_out.read(), gaps) == -1);
        CHECK(first_difference(way_out.read(), ways) == -1);
    }
    REQUIRE(near_wall > 100);
    REQUIRE(stopped > 10);
}

void evaluate_pow_case()
{
    Scene s(257);
    for (QuadratureModel& m : s.models) m.exponent = static_cast<real>(1.3);
    const std::vector<uint> list = up_to(257);
    const Found found = host_find(s, list, static_cast<real>(2e-4), s.par.slots);
    const Evaluated host = host_evaluate(s, s.par, list, found), device = device_evaluate(s, s.par, list, found, Queue::Inline);
    // OpenCL allows pow 16 ulp; the laws multiply it by factors that carry it on, and by 1 / (1 - 0.9) at most
    const double bound = float32 ? 200 * 6e-8 : 200 * 1.1e-16;
    double largest = 0;
    for (const ContactForce& f : host.forces)
        for (real x : f.force) largest = std::max(largest, std::abs(double(x)));
    REQUIRE(largest > 0);
    for (std::size_t k = 0; k < host.forces.size(); ++k)
        for (int i = 0; i < 4; ++i)
            CHECK(std::abs(double(host.forces[k].force[i]) - device.forces[k].force[i]) <= bound * largest);
}

void reduce_case()
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_device::Kernel kernel(context, "contact/edge_sums.cl", "contact_reduce");
    Draw draw;
    for (const Queue queue : {Queue::Inline, Queue::Pool})
        for (const std::size_t n : counts_to_try) {
            std::vector<uint> first = {0};
            for (std::size_t e = 0; e < n; ++e)
                first.push_back(first.back() + (e % 5 == 3 ? 0 : draw.below(9)));  // some have none
            std::vector<ContactForce> forces(first.back());
            std::vector<real> barys(first.back());
            for (std::size_t k = 0; k < forces.size(); ++k) {
                real* x = forces[k].force;
                for (std::size_t i = 0; i < offsetof(ContactForce, flags) / sizeof(real); ++i)
                    x[i] = static_cast<real>(draw(-1, 1));
                forces[k].flags = draw.below(16);
                forces[k].contacts = draw.below(3);
                barys[k] = static_cast<real>(draw(0, 1));
            }
            std::vector<EdgeForce> host(n);
            for (std::size_t e = 0; e < n; ++e) host[e] = reduce_edge(forces.data(), barys.data(), first[e], first[e + 1]);
            Guarded<uint> firsts(context, queue, first);
            Guarded<ContactForce> in(context, queue, forces);
            Guarded<real> places(context, queue, barys);
            Guarded<EdgeForce> out(context, queue, std::vector<EdgeForce>(n));
            kernel.launch(queue, n, static_cast<uint>(n), firsts.buffer(), in.buffer(), places.buffer(), out.buffer());
            CAPTURE(n);
            CHECK(first_difference(out.read(), host) == -1);
        }
}

void layer_find_case()
{
    std::size_t found = 0;
    for (const Queue queue : {Queue::Inline, Queue::Pool})
        for (const std::size_t n : counts_to_try)
            for (const uint slots : {1u, 64u}) {
                Scene s(0);
                const std::vector<LayerEdge> edges = layer_edges(s, n);
                const Found host = host_layer_find(s, edges, slots), device = device_layer_find(s, edges, slots, queue);
                CAPTURE(n);
                CAPTURE(slots);
                CHECK(first_difference(device.counts, host.counts) == -1);
                CHECK(first_difference(device.candidates, host.candidates) == -1);
                CHECK(first_difference(device.touching, host.touching) == -1);
                for (uint c : host.counts) found += c;
            }
    REQUIRE(found > 500);
}

void layer_evaluate_case()
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    sel_device::Kernel kernel(context, "contact/layer.cl", "layer_evaluate");
    std::size_t touched = 0;
    for (const Queue queue : {Queue::Inline, Queue::Pool})
        for (const std::size_t n : counts_to_try) {
            Scene s(257);  // for its contact point records
            const std::vector<LayerEdge> edges = layer_edges(s, 60);
            std::vector<LayerPair> pairs;
            const Found found = host_layer_find(s, edges, 64);
            for (std::size_t k = 0; k < n; ++k) {  // pairs that were found, and some that were not
                const uint e = static_cast<uint>(k % edges.size()), count = found.counts[e];
                const uint t = count > 0 && k % 4 ? found.candidates[64 * e + s.draw.below(count)]
                                                  : s.draw.below(static_cast<uint>(s.wall.triangles));
                pairs.push_back({e, t, k % 3 ? s.draw.below(500) : SEL_NO_EDGE, 0});
            }
            Evaluated host{std::vector<ContactForce>(n), std::vector<real>(n), std::vector<ContactState>(n)};
            for (std::size_t k = 0; k < n; ++k) {
                const LayerEdge& edge = edges[pairs[k].edge];
                const ContactState old =
                    pairs[k].last != SEL_NO_EDGE ? s.states_t0[pairs[k].last] : empty_pair(pairs[k].triangle, edge.reach);
                write_force(evaluate_pair(pairs[k], edge, s.par, s.now(), s.before(), s.wall.vertices.data(), old,
                                          &host.states[k], &host.barys[k]),
                            &host.forces[k]);
            }
            ContactParams par = s.par;
            par.item_count = static_cast<uint>(n);
            Guarded<LayerPair> list(context, queue, pairs);
            Guarded<LayerEdge> on(context, queue, edges);
            const GuardedNodes now(context, queue, s.now(), s.theta.size()), before(context, queue, s.before(), s.theta.size());
            const GuardedWall wall(context, queue, s);
            Guarded<real> barys(context, queue, std::vector<real>(n));
            Guarded<ContactState> t0(context, queue, s.states_t0), t1(context, queue, std::vector<ContactState>(n));
            Guarded<ContactForce> forces(context, queue, std::vector<ContactForce>(n));
            kernel.launch(queue, n, par, list.buffer(), on.buffer(), wall, now, before, t0.buffer(), t1.buffer(), forces.buffer(),
                          barys.buffer());
            CAPTURE(n);
            CHECK(first_difference(forces.read(), host.forces) == -1);
            CHECK(first_difference(barys.read(), host.barys) == -1);
            CHECK(first_difference(t1.read(), host.states) == -1);
            for (const ContactForce& f : host.forces) touched += f.contacts;
        }
    REQUIRE(touched > 20);
}

// every member that follows a change of type, and the last of each record
#define SEL_LAYOUT(X)                                                                                                         \
    X(QuadratureModel, length)                                                                                                \
    X(QuadratureModel, reach)                                                                                                 \
    X(QuadratureModel, roll_force)                                                                                            \
    X(QuadratureModel, restitution)                                                                                           \
    X(QuadratureModel, ridges)                                                                                                \
    X(QuadraturePlace, edge_t0)                                                                                               \
    X(QuadraturePlace, bary)                                                                                                  \
    X(QuadraturePlace, epoch)                                                                                                 \
    X(QuadraturePlace, radius_reduction)                                                                                      \
    X(MultiplierState, stiffness)                                                                                             \
    X(MultiplierState, live) X(ContactState, point) X(ContactState, gap) X(ContactState, friction) X(ContactState, triangle)  \
        X(ContactState, pad) X(ContactForce, sym) X(ContactForce, skew) X(ContactForce, depth) X(ContactForce, couple)        \
            X(ContactForce, skew_wx) X(ContactForce, flags) X(ContactForce, contacts) X(EdgeForce, torque) X(EdgeForce, s_ab) \
                X(EdgeForce, u_ba) X(EdgeForce, ut_b) X(EdgeForce, length) X(EdgeForce, flags) X(EdgeForce, contacts)         \
                    X(ContactParams, settling) X(ContactParams, normal_law) X(ContactParams, inv_dt)                          \
                        X(ContactParams, smooth_speed) X(TreeNode, left_or_first) X(TreeNode, count) X(LayerEdge, width)      \
                            X(LayerEdge, model) X(LayerPair, last)

void layout_case()
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    std::string text = sel_device::assemble_source("contact/layer.cl");
    text +=
        "\n#define SEL_PROBE(type, member) { type x; out[2 * k] = sizeof(type);"
        " out[2 * k++ + 1] = (uint)((__private char*)&x.member - (__private char*)&x); }\n"
        "__kernel void probe(__global uint* out) { uint k = 0;\n";
    std::vector<uint> host;
#define SEL_ROW(type, member)                        \
    text += "SEL_PROBE(" #type ", " #member ")\n";   \
    host.push_back(static_cast<uint>(sizeof(type))); \
    host.push_back(static_cast<uint>(offsetof(type, member)));
    SEL_LAYOUT(SEL_ROW)
    text += "}\n";
    const char* source = text.c_str();
    cl_int status = CL_SUCCESS;
    cl_program program = clCreateProgramWithSource(context.handle(), 1, &source, nullptr, &status);
    sel_device::check(status, "probe");
    sel_device::check(
        clBuildProgram(program, 0, nullptr, float32 ? "-cl-std=CL1.2 -DSEL_FLOAT32" : "-cl-std=CL1.2", nullptr, nullptr),
        "probe");
    cl_kernel kernel = clCreateKernel(program, "probe", &status);
    sel_device::check(status, "probe");
    Guarded<uint> out(context, Queue::Inline, std::vector<uint>(host.size(), 12345));
    cl_mem memory = out.buffer().handle();
    sel_device::check(clSetKernelArg(kernel, 0, sizeof memory, &memory), "probe");
    context.enqueue(Queue::Inline, kernel, 1, 1);
    const std::vector<uint> device = out.read();
    for (std::size_t k = 0; k < host.size(); ++k) {
        CAPTURE(k);
        CHECK(device[k] == host[k]);
    }
    CHECK(sizeof(real) == (float32 ? 4 : 8));
    clReleaseKernel(kernel);
    clReleaseProgram(program);
}

}  // namespace

// The bodies of the reference tests, compiled once in double (test_host_reference.cpp) and once in float
// (test_host_reference_float32.cpp, where `seldinger` is another namespace). Every kernel runs against a plain loop over the
// same shared functions. The arithmetic is the same operation by operation (contraction off, divisions and roots correctly
// rounded), so the bits are the same.
#pragma once

#include "contact/host_reference_layer.h"
#include "contact/host_reference_scene.h"

namespace {

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
    std::size_t shortened = 0;
    for (const Queue queue : {Queue::Inline, Queue::Pool})
        for (const std::size_t n : counts_to_try) {
            // on the axis of a narrow lumen all walls are as near, so boxes stay closed
            const bool narrow = n == 65;
            Scene s(n, narrow);
            const std::vector<uint> list = up_to(n);
            const real most = static_cast<real>(narrow ? 1 : 0.35e-3);  // beyond some, within others
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
                const real rounding = static_cast<real>(float32 ? 1e-7 : 1e-16);  // of positions, and of the root of most^2
                CHECK(host[k] <= nearest + rounding);
                CHECK(host[k] >= SEL_DISTANCE_PART * nearest - rounding);
                shortened += host[k] < nearest - 10 * rounding;
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
    REQUIRE(shortened > 50);
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
                if (device_remembers()) CHECK(first_difference(device.memories, host.memories) == -1);
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

void evaluate_narrow_case()
{
    std::size_t both = 0;
    for (const std::size_t n : {64u, 257u}) {
        Scene s(n, true);
        const std::vector<uint> list = up_to(n);
        const Found found = host_find(s, list, static_cast<real>(2e-4), s.par.slots);
        REQUIRE(*std::max_element(found.counts.begin(), found.counts.end()) <= s.par.slots);
        const Evaluated host = host_evaluate(s, s.par, list, found),
                        device = device_evaluate(s, s.par, list, found, n == 64 ? Queue::Inline : Queue::Pool);
        CAPTURE(n);
        CHECK(first_difference(device.forces, host.forces) == -1);
        CHECK(first_difference(device.states, host.states) == -1);
        both += std::count_if(host.forces.begin(), host.forces.end(), [](const ContactForce& f) { return f.contacts == 2; });
    }
    REQUIRE(both > 100);
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
    sel_device::Kernel sweep(context, "contact/barrier_path.cl", "contact_sweep");
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
        sel_reference::GapKernels(context, n).launch(queue, n, s.par, items.buffer(), models.buffer(), places.buffer(),
                                                     candidates.buffer(), counts.buffer(), wall, now, t0.buffer(),
                                                     gap_out.buffer());
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
            for (std::size_t e = 0; e < n; ++e) reduce_edge(forces.data(), barys.data(), first[e], first[e + 1], &host[e]);
            Guarded<uint> firsts(context, queue, first);
            Guarded<ContactForce> in(context, queue, forces);
            Guarded<real> places(context, queue, barys);
            Guarded<EdgeForce> out(context, queue, std::vector<EdgeForce>(n));
            kernel.launch(queue, n, static_cast<uint>(n), firsts.buffer(), in.buffer(), places.buffer(), out.buffer());
            CAPTURE(n);
            CHECK(first_difference(out.read(), host) == -1);
        }
}

// every member that follows a change of type, and the last of each record
#define SEL_LAYOUT(X)                                                                                                         \
    X(QuadratureModel, length)                                                                                                \
    X(QuadratureModel, reach)                                                                                                 \
    X(QuadratureModel, roll_force)                                                                                            \
    X(QuadratureModel, restitution)                                                                                           \
    X(QuadratureModel, multiplier_most)                                                                                       \
    X(QuadraturePlace, edge_t0)                                                                                               \
    X(QuadraturePlace, bary)                                                                                                  \
    X(QuadraturePlace, epoch)                                                                                                 \
    X(QuadraturePlace, radius_reduction)                                                                                      \
    X(MultiplierState, stiffness)                                                                                             \
    X(MultiplierState, live)                                                                                                  \
    X(ContactState, point) X(ContactState, gap) X(ContactState, friction) X(ContactState, triangle) X(ContactState, pad)      \
        X(ContactForce, sym) X(ContactForce, skew) X(ContactForce, depth) X(ContactForce, couple) X(ContactForce, skew_wx)    \
            X(ContactForce, flags) X(ContactForce, contacts) X(EdgeForce, torque) X(EdgeForce, s_ab) X(EdgeForce, u_ba)       \
                X(EdgeForce, ut_b) X(EdgeForce, length) X(EdgeForce, flags) X(EdgeForce, contacts) X(ContactParams, settling) \
                    X(ContactParams, normal_law) X(ContactParams, inv_dt) X(ContactParams, smooth_speed)                      \
                        X(TreeNode, left_or_first) X(TreeNode, count) X(LayerEdge, width) X(LayerEdge, model) X(LayerPair, last)

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

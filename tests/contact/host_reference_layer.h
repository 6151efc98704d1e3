// The reference tests of the layer method (host_reference_cases.h).
#pragma once

#include "contact/host_reference_scene.h"

namespace {

// every edge of the scene, repeated until `count`
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
                ContactForce force;
                evaluate_pair(pairs[k], edge, s.par, s.now(), s.before(), s.wall.vertices.data(), old, &host.states[k], &force,
                              &host.barys[k]);
                write_force(force, &host.forces[k]);
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

}  // namespace

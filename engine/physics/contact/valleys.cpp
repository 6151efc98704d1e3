// Valleys between two facets: which contacts have crossed one, and what the direction needs to know of it.
#include "contact/valleys.h"

#include "contact/active_set.h"
#include "shared/smooth_maximum.h"

namespace seldinger {
namespace {

constexpr double least_turn = 1e-3;  // [rad] between the facets: beside a flatter valley the tangent of one facet serves

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

Valleys::Touch Valleys::touch_of(std::uint32_t record, const ContactState& state) const
{
    const QuadraturePlace& place = quadrature_.places[record / 2];
    return {record,
            vec(state.normal),
            (1 - place.bary) * nodes_.position(place.edge) + place.bary * nodes_.position(place.edge + 1),
            -state.gap,
            state.normal_force,
            false};
}

/// f(edge, touch, state) of each contact of a wire.
template <class F>
void Valleys::for_each_touch(int wire, std::span<const ContactState> states, const ActiveList& list, const F& f) const
{
    const std::uint32_t epoch = quadrature_.wires[static_cast<std::size_t>(wire)].epoch;
    for (int e = sums_.wire_edges[wire]; e < sums_.wire_edges[wire + 1]; ++e) {
        if (sums_.edges[e].contacts == 0) continue;
        for (std::uint32_t k = list.edge_first[e]; k < list.edge_first[e + 1]; ++k)
            for (std::uint32_t record = 2 * list.points[k]; record < 2 * list.points[k] + 2; ++record) {
                const ContactState& state = states[record];
                if (state.epoch == epoch && (state.flags & (SEL_CONTACT_ACTIVE | SEL_CONTACT_OUTSIDE)) == SEL_CONTACT_ACTIVE)
                    f(e, record, state);
            }
    }
}

void Valleys::take(int wire, std::span<const ContactState> states, const ActiveList& list)
{
    Wire& of = wires_[static_cast<std::size_t>(wire)];
    of.base.clear();
    auto crossing = of.crossings.begin();
    for_each_touch(wire, states, list, [&](int, std::uint32_t record, const ContactState& state) {
        of.base.push_back(touch_of(record, state));
        if (!of.admitted || crossing == of.crossings.end() || crossing->record != record) return;
        of.base.back().admitted = true;
        ++crossing;
    });
    of.admitted = false;
}

KinksPassed Valleys::crossed(int wire, std::span<const ContactState> states, const ActiveList& list, double smoothing)
{
    Wire& of = wires_[static_cast<std::size_t>(wire)];
    of.crossings.clear();
    of.admitted = false;
    double most = 0;
    KinksPassed passed;
    auto was = of.base.begin();
    for_each_touch(wire, states, list, [&](int edge, std::uint32_t record, const ContactState& state) {
        while (was != of.base.end() && was->record < record) ++was;
        if (was == of.base.end() || was->record != record || was->admitted) return;
        const Touch now = touch_of(record, state);
        const Vec3 across = was->normal - now.normal, move = now.axis - was->axis;
        const double turn = across.norm();
        if (turn < least_turn) return;
        // how much deeper each is in its own facet than in the other's
        const double beyond = now.depth - (was->depth - was->normal.dot(move));
        const double before = was->depth - (now.depth + now.normal.dot(move));
        const double eps = joint_width_of(turn * turn, quadrature_.models[record / 2].radius, smoothing), rest = eps - beyond;
        if (before <= 0) return;
        passed.entered = passed.entered || rest >= 0;
        if (rest >= 0) return;
        const double stiffness = state.normal_force / (2 * eps);
        if (state.normal_force * turn > most) {
            most = state.normal_force * turn;
            passed.share = before / (before + beyond);
            passed.width = 2 * eps / (before + beyond);
        }
        of.crossings.push_back({record, edge, quadrature_.places[record / 2].bary, stiffness * rest * across, across, stiffness,
                                was->force, eps - before, 2 * eps});
    });
    return passed;
}

std::span<const Kink> Valleys::from_base(int wire, int first_node)
{
    Wire& of = wires_[static_cast<std::size_t>(wire)];
    of.kinks.clear();
    for (const Crossing& c : of.crossings)
        of.kinks.push_back(
            {static_cast<int>(sums_.edge_node[c.edge]) - first_node, c.bary, c.across, c.base_force, c.rest, c.width});
    return of.kinks;
}

void Valleys::admit(int wire, int first_node, std::span<double> residual)
{
    Wire& of = wires_[static_cast<std::size_t>(wire)];
    of.admitted = true;
    for (const Crossing& c : of.crossings) {
        const int node = static_cast<int>(sums_.edge_node[c.edge]) - first_node;
        const double b = c.bary, a = 1 - b;
        EdgeForce& sum = sums_.edges[c.edge];
        for (int i = 0, k = 0; i < 3; ++i) {
            residual[RodDofs::position(node, i)] -= a * c.force[i];
            residual[RodDofs::position(node + 1, i)] -= b * c.force[i];
            for (int j = 0; j < 3; ++j) {
                const double s = c.stiffness * c.across[i] * c.across[j];
                sum.s_ab[3 * i + j] += a * b * s;
                if (j < i) continue;
                sum.s_aa[k] += a * a * s;
                sum.s_bb[k++] += b * b * s;
            }
        }
    }
}

}  // namespace seldinger

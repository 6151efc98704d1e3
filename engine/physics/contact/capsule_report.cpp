// Reports of contact with quadrature points: its rows, and the choices it made.
#include "contact/capsule.h"
#include "contact/loads/contact_patch.h"
#include "core/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace seldinger {

ContactRow CapsuleContact::row_of(int wire, int edge, int point, const ContactState& state) const
{
    ContactRow row;
    const WireQuadrature& quadrature = quadrature_.wires[static_cast<std::size_t>(wire)];
    row.along_a = quadrature.s[static_cast<std::size_t>(point - quadrature.begin)];
    row.a = {BodyKind::Rod, wire, edge};
    row.b = {BodyKind::Wall, 0, static_cast<int>(wall_.original[state.triangle])};
    row.point = wall_.centre + Vec3(state.point[0], state.point[1], state.point[2]);
    row.normal = {state.normal[0], state.normal[1], state.normal[2]};
    row.gap = state.gap;
    row.normal_force = state.normal_force;
    row.friction = {state.friction[0], state.friction[1], state.friction[2]};
    row.rolling_moment = state.moment;
    row.stuck = state.flags & SEL_CONTACT_STUCK;
    row.length = quadrature_.models[point].length;
    const ContactPatch patch = contact_patch(quadrature_.models[point], params_.normal_law, state.gap, state.normal_force);
    row.area = patch.area;
    return row;
}

std::vector<ContactRow> CapsuleContact::rows(RodArrays& rods)
{
    std::vector<ContactRow> rows;
    for (int w = 0; w < rods.wire_count(); ++w) {
        const WireQuadrature& wire = quadrature_.wires[w];
        const RodView rod = rods.view(w);  // whose nodes may be others than those of the step
        int edge = 0;
        states_.for_each_contact(w, [&](int point, const ContactState& state) {
            while (edge < rod.n - 2 && wire.s[point - wire.begin] - wire.offset > rod.material_s[edge + 1]) ++edge;
            rows.push_back(row_of(w, edge, point, state));
        });
    }
    std::stable_sort(rows.begin(), rows.end(), [](const ContactRow& x, const ContactRow& y) {
        return std::tie(x.a.body, x.a.element, x.b.element) < std::tie(y.a.body, y.a.element, y.b.element);
    });
    return rows;
}

void CapsuleContact::add_loads(RodArrays& rods, std::span<WireLoads> loads)
{
    for_each_item(rods.wire_count(), wire_grain, [&](int w) {
        const WireQuadrature& wire = quadrature_.wires[static_cast<std::size_t>(w)];
        WireLoads& own = loads[static_cast<std::size_t>(w)];
        own.samples.reserve(2 * static_cast<std::size_t>(wire.capacity));  // steps allocate nothing
        states_.for_each_contact(w, [&](int point, const ContactState& state) {
            const double* f = state.friction;
            own.add({wire.s[static_cast<std::size_t>(point - wire.begin)],
                     quadrature_.models[static_cast<std::size_t>(point)].length, state.normal_force},
                    std::hypot(f[0], f[1], f[2]));
        });
    });
}

std::string CapsuleContact::describe_law(const QuadratureModel& m) const
{
    const double k = m.penalty_stiffness, um = 1e6 * m.law_length;
    switch (params_.normal_law) {
        case SEL_NORMAL_AUGMENTED:
            return fmt::format("augmented, k from {:.3g} N/m^2 per metre, overlap to {:.3g} um", k, um);
        case SEL_NORMAL_CONSTRAINT:
            return fmt::format("constraint, to {:.3g} um of overlap and of stuck slip", um);
        case SEL_NORMAL_IMPULSE:
            return fmt::format("impulse, restitution {:.3g} to {:.3g} mm/s", m.restitution, 1e3 * m.law_length);
        case SEL_NORMAL_BARRIER:
            return fmt::format("barrier, from a gap of {:.3g} um, kappa {:.3g} N/m^2 per metre", um, k);
        default:
            return "damped";
    }
}

namespace {

std::string describe_limit(const QuadratureModel& m)
{
    if (m.depth_exact <= 0) return fmt::format("{:.3g} mm, half the smaller of wall thickness and radius", 1e3 * m.depth_limit);
    return fmt::format("{:.3g} mm, half the radius; the stiffness as given to {:.3g} mm", 1e3 * m.depth_limit,
                       1e3 * m.depth_exact);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> CapsuleContact::describe() const
{
    const WireQuadrature& wire = quadrature_.wires[0];
    const QuadratureModel& m = quadrature_.models[wire.begin + wire.capacity - 1];
    return {{"contact samples", fmt::format("{} over the whole wire, {:.3g} mm apart", wire.capacity, 1e3 * wire.spacing)},
            {"contact kernels", context_.float32() ? "float32 (asked for)" : "float64"},
            {"normal law", describe_law(m)},
            {"line stiffness", fmt::format("{:.4g} N/m^{:.3g} per metre, exponent {}", m.stiffness, m.exponent + 1, m.exponent)},
            {"damping", fmt::format("beta {:.4g}, approach speed not below {:.3g} m/s", m.damping, m.speed_floor)},
            {"friction stiffness",
             fmt::format("{:.4g} N/m^2 per metre (2/3 of the normal one under the wire's own weight)", m.friction_stiffness)},
            {"overlap limit", describe_limit(m)}};
}

}  // namespace seldinger

// Code that all detection methods share.

#include "contact/contact_system.h"

#include "core/parallel.h"

namespace seldinger {

ContactMethod::ContactMethod(device::Context& context, const ContactSetup& setup, RodArrays& rods, const WallTree& tree)
    : context_(context),
      rods_(rods),
      wall_(context, tree, setup.wall.mesh),
      nodes_(context, rods.total_capacity()),
      nodes_t0_(context, rods.total_capacity())
{
    if (setup.known_velocities) nodes_known_.emplace(context, rods.total_capacity());
}

void ContactMethod::set_nodes(DeviceNodes& nodes, const TrialState& state) const
{
    for_each_item(rods_.wire_count(), wire_grain, [&](int w) {
        const int begin = rods_.node_begin(w);
        for (int i = begin; i < begin + rods_.node_count(w); ++i)
            nodes.set(i, state.x[i], state.y[i], state.z[i], state.theta[i], wall_.centre);
    });
}

void ContactMethod::upload_nodes(device::Queue queue)
{
    nodes_.upload(context_, queue);
    if (params_.known) nodes_known_->upload(context_, queue);
}

void ContactMethod::evaluate_start(const TrialState& start, const TrialState& before, double h, bool linearised,
                                   std::span<const std::uint8_t> active)
{
    set_nodes(*nodes_known_, before);
    params_.known = linearised ? SEL_KNOWN_LINEAR : SEL_KNOWN_FORCE;
    evaluate(start, h, active);
    params_.known = 0;
}

void ContactMethod::add_loads(RodArrays& rods, std::span<WireLoads> loads)
{
    for (const ContactRow& row : rows(rods))
        loads[static_cast<std::size_t>(row.a.body)].add({row.along_a, row.length, row.normal_force}, row.friction.norm());
}

}  // namespace seldinger

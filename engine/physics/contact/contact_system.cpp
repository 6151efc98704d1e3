// Code that all detection methods share.
#include "contact/contact_system.h"

#include "core/parallel.h"

namespace seldinger {
namespace {

// Of the bound. The bound takes all samples of an edge to be off by four roundings to the same side; distances of a few samples,
// each off by half a rounding to either side, leave about a tenth of it.
constexpr double usual_rounding = 0.1;

}  // namespace

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

void ContactMethod::evaluate(const TermTrial& trial)
{
    if (trial.before) {
        set_nodes(*nodes_known_, *trial.before);
        params_.known = trial.linearised ? SEL_KNOWN_LINEAR : SEL_KNOWN_FORCE;
    }
    evaluate_forces(trial);
    params_.known = 0;
}

TermAnswer ContactMethod::answer(int wire, Ask what)
{
    TermAnswer answer;
    if (what == Ask::Trial) {
        sums_.answer(wire, answer);
        if (context_.float32()) {
            answer.rounding_most = sums_.rounding(wire, rods_.node_begin(wire), rods_.view(wire));
            answer.rounding = usual_rounding * answer.rounding_most;
        }
    } else if (what == Ask::Energies) {
        const ContactTotals t = totals(wire);
        answer.energies = {t.work, 0, (t.normal + t.friction) * t.depth};
    }
    return answer;
}

void ContactMethod::add_loads(RodArrays& rods, std::span<WireLoads> loads)
{
    for (const ContactRow& row : rows(rods))
        loads[static_cast<std::size_t>(row.a.body)].add({row.along_a, row.length, row.normal_force}, row.friction.norm());
}

}  // namespace seldinger

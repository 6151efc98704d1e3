// Static equilibrium: Newton with an adaptive shift first; where that stalls, pseudo-time, which follows the wire downhill.

#include "solve/newton.h"
#include "solve/solver_work.h"

#include <algorithm>

namespace seldinger {

void Solver::equilibrium(std::span<const WireConstraints> constraints, ContactTerm* contact,
                         std::span<const std::uint8_t> active, std::span<SolveReport> reports)
{
    begin(Motion::Static, 0, constraints, active);
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (active[w]) work_[w]->newton.problem.keep_reference();
    NewtonOptions newton;
    newton.shifted = true;
    newton.max_iterations = 150;
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (active[w]) work_[w]->newton.start(newton, move_limit(contact, w));
    iterate_with_multipliers(0, contact, active);

    NewtonOptions flow = newton;
    flow.gradient_flow = true;
    flow.max_iterations = 3000;
    for (int w = 0; w < rods_.wire_count(); ++w) {
        NewtonWire& wire = work_[w]->newton;
        if (!active[w] || wire.converged()) continue;
        wire.problem.restore_reference();
        wire.problem.trial = wire.problem.start;
        wire.start(flow, move_limit(contact, w));
    }
    iterate_with_multipliers(0, contact, active);
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (active[w] && !work_[w]->newton.converged()) work_[w]->newton.problem.restore_reference();
    finish(active, reports);
}

}  // namespace seldinger

// Static equilibrium: Newton with an adaptive shift first; where that stalls, pseudo-time, which follows the wire downhill; where
// that is too slow, Newton for as long. (A ring beyond Michell's twist has a buckled shape that may sit anywhere along it: a bent
// valley with hardly a slope, 1,400 iterations long. Pseudo-time creeps there, Newton walks.)

#include "solve/newton.h"
#include "solve/solver_work.h"

#include <algorithm>

namespace seldinger {

void Solver::equilibrium(std::span<const WireConstraints> constraints, const ForceTerms& terms, std::span<const std::uint8_t> active,
                         std::span<SolveReport> reports)
{
    begin(Motion::Static, 0, constraints, active);
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (active[w]) newton_of(w).problem.keep_reference();
    NewtonOptions newton;
    newton.shifted = true;
    newton.max_iterations = 150;
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (active[w]) newton_of(w).start(newton, terms.move_limit(w));
    prepare_trials(active);
    iterate_with_multipliers(0, terms, active);

    NewtonOptions flow = newton, patient = newton;
    flow.gradient_flow = true;
    flow.max_iterations = patient.max_iterations = 3000;
    for (const NewtonOptions& again : {flow, patient}) {
        bool any = false;
        std::fill(running_.begin(), running_.end(), 0);
        std::fill(evaluate_.begin(), evaluate_.end(), 0);
        for (int w = 0; w < rods_.wire_count(); ++w) {
            NewtonWire& wire = newton_of(w);
            if (!active[w] || wire.converged()) continue;
            any = true;
            wire.problem.restore_reference();
            wire.problem.trial = wire.problem.start;
            wire.start(again, terms.move_limit(w));
            prepare_trial(w);
        }
        if (any) iterate_with_multipliers(0, terms, active);
    }
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (active[w] && !newton_of(w).converged()) newton_of(w).problem.restore_reference();
    finish(active, reports);
}

}  // namespace seldinger

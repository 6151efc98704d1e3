// Static equilibrium: Newton with an adaptive shift first. If that stalls, pseudo-transient continuation follows the wire
// downhill. If that is too slow, Newton runs for as long. Example: the buckled shape of a ring beyond Michell's twist may sit
// anywhere along the ring, a bent valley with hardly a slope. There pseudo-time is slow, and Newton needs 1,400 iterations.
#include "newton/solver_work.h"

#include <algorithm>

namespace seldinger {

void Solver::equilibrium(std::span<const WireConstraints> constraints, const ForceTerms& terms,
                         std::span<const std::uint8_t> active, std::span<SolveReport> reports)
{
    NewtonOptions newton;
    newton.shifted = true;
    newton.max_iterations = 150;
    stopped_ = false;
    begin(Motion::Static, 0, constraints, active);
    for (int s = 0; s < system_count(); ++s) {
        if (!asked_[s]) continue;
        newton_of(s).problem.keep_reference();
        newton_of(s).start(newton, terms);
    }
    prepare_trials(asked_);
    iterate_with_multipliers(0, terms, asked_);

    NewtonOptions flow = newton, patient = newton;
    flow.pseudo_transient = true;
    flow.max_iterations = patient.max_iterations = 3000;
    for (const NewtonOptions& again : {flow, patient}) {
        bool any = false;
        std::fill(running_.begin(), running_.end(), std::uint8_t{0});
        std::fill(evaluate_.begin(), evaluate_.end(), std::uint8_t{0});
        for (int s = 0; s < system_count(); ++s) {
            NewtonSystem& system = newton_of(s);
            if (!asked_[s] || system.converged()) continue;
            any = true;
            system.problem.restore_reference();
            system.problem.return_to_start();
            for (const WireProblem* wire : system.problem.solved()) terms.take(wire->wire, ForceTerm::Base::Start);
            system.start(again, terms);
            prepare_trial(s);
        }
        if (any) iterate_with_multipliers(0, terms, asked_);
    }
    for (int s = 0; s < system_count(); ++s)
        if (asked_[s] && !newton_of(s).converged()) newton_of(s).problem.restore_reference();
    finish(reports);
}

}  // namespace seldinger

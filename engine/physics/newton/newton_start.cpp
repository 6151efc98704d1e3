// Start and continuation of Newton's method for one system, and its report. The first guess moves the accepted state on with its
// velocity, as far as force terms have searched. Instruments that are separate rods also use their acceleration: x + h v + h^2 a
// with a of the last step. Their mutual forces change less from step to step than from rest to motion, and such a guess saves one
// of three iterations.
#include "newton/newton_system.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// h^2 a where nothing is prescribed. @param move  [unknowns] of the wire, overwritten
void accelerated_move(const WireProblem& wire, double* move)
{
    const RodView& rod = wire.rod;
    const double square = wire.time.step() * wire.time.step();
    for (int i = 0; i < rod.n; ++i) {
        const double a[RodDofs::per_node] = {rod.ax[i], rod.ay[i], rod.az[i], i < rod.n - 1 ? rod.spin_acc[i] : 0.0};
        for (int c = 0; c < RodDofs::per_node; ++c) {
            const int k = RodDofs::position(i, c);
            move[k] = wire.q.prescribed[k] ? 0.0 : square * a[c];
        }
    }
}

}  // namespace

void NewtonSystem::start(const NewtonOptions& options, const ForceTerms& terms)
{
    at_.start(options);
    std::vector<double>& guess = at_.guess;
    for (WireProblem* wire : problem.solved()) {
        at_.course.move_limit = std::min(at_.course.move_limit, terms.most_move(wire->wire));
        wire->norm = wire->rounding = wire->rounding_most = 0;
    }
    direction_.start();
    if (problem.motion != Motion::Implicit || options.linearised) return set_guess(0);

    // one that is solved alone is solved as ever, whoever else is in its system
    const bool accelerated = problem.several_rods() && problem.solved().size() > 1 && problem.solved().front()->time.euler();
    for (const WireProblem* wire : problem.solved()) {
        double* move = guess.data() + problem.first_of(*wire);
        for (int i = 0; i < wire->size(); ++i) move[i] = wire->time.known_move(i);
        if (accelerated) accelerated_move(*wire, at_.correction.data() + (move - guess.data()));
    }
    // what lets go or strikes has an acceleration that the next step has not
    if (accelerated && problem.norm(at_.correction) <= newton_constants.most_accelerated * problem.norm(guess))
        for (int i = 0; i < problem.size(); ++i) guess[i] += at_.correction[i];
    const double move = problem.largest_move(guess), turn = problem.largest_turn(guess);
    double fraction = 1;
    if (move > at_.course.move_limit) fraction = at_.course.move_limit / move;
    if (turn * fraction > newton_constants.largest_edge_turn) fraction = newton_constants.largest_edge_turn / turn;
    set_guess(std::isfinite(fraction) && move > 0 ? fraction : 0);
}

// A prescribed unknown that the guess all but meets is set exactly; one that it does not becomes part of the first direction.
void NewtonSystem::set_guess(double fraction)
{
    at_.course.guess_fraction = fraction;
    const double met = newton_constants.met_prescribed * problem.length_scale();
    for (int i = 0; i < problem.size(); ++i) {
        problem.trial[i] = fraction == 0 ? problem.start[i] : problem.start[i] + fraction * at_.guess[i];
        if (problem.prescribed[i] && std::abs(problem.prescribed_value[i] - problem.trial[i]) < met)
            problem.trial[i] = problem.prescribed_value[i];
    }
}

void NewtonSystem::resume()
{
    at_.phase = Phase::Guess;
    at_.course.guess_fraction = 0;
    direction_.resume();
    at_.along = {};
    at_.course.first_iteration = at_.course.iterations;
}

void NewtonSystem::stop_short()
{
    at_.course.settling = at_.options.best_effort;
    at_.phase = at_.course.settling ? Phase::Done : Phase::Failed;
}

void NewtonSystem::abandon()
{
    at_.phase = Phase::Failed;
    at_.course.settling = false;
}

SolveReport NewtonSystem::report(const WireProblem& wire) const
{
    SolveReport report;
    report.converged = converged();
    report.best_effort = converged() && at_.course.settling && !at_.course.cut_short && !at_.course.rounded;
    report.cut_short = converged() && at_.course.cut_short;
    report.non_finite = at_.course.non_finite;
    report.iterations = at_.course.iterations;
    report.evaluations = at_.course.evaluations;
    report.residual = wire.norm;
    report.tolerance = wire.tolerance + wire.rounding_most;
    report.force_scale = wire.force_scale;
    return report;
}

}  // namespace seldinger

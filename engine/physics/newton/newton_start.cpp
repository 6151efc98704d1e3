// Start and continuation of Newton's method for one system, and its report. The first guess moves the accepted state on with its
// velocity, as far as force terms have searched. Instruments that are separate rods also use their acceleration: x + h v + h^2 a
// with a of the last step. Their mutual forces change less from step to step than from rest to motion, and such a guess saves one
// of three iterations.

#include "newton/newton_system.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

constexpr double most_accelerated = 0.05;  // of the move with the velocity, that the acceleration may change [-]

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
    options_ = options;
    course_ = {};
    along_ = {};
    at_base_ = {};
    at_trial_ = {};
    phase_ = Phase::Guess;
    for (WireProblem* wire : problem.solved()) {
        course_.move_limit = std::min(course_.move_limit, terms.most_move(wire->wire));
        wire->norm = wire->rounding = wire->rounding_most = 0;
    }
    model_.start(options.shifted, options.pseudo_transient ? 100 : 0);
    if (problem.motion != Motion::Implicit || options.linearised) return set_guess(0);

    // one that is solved alone is solved as ever, whoever else is in its system
    const bool accelerated = problem.several_rods() && problem.solved().size() > 1 && problem.solved().front()->time.euler();
    for (const WireProblem* wire : problem.solved()) {
        double* move = guess_.data() + problem.first_of(*wire);
        for (int i = 0; i < wire->size(); ++i) move[i] = wire->time.known_move(i);
        if (accelerated) accelerated_move(*wire, correction_.data() + (move - guess_.data()));
    }
    // what lets go or strikes has an acceleration that the next step has not
    if (accelerated && problem.norm(correction_) <= most_accelerated * problem.norm(guess_))
        for (int i = 0; i < problem.size(); ++i) guess_[i] += correction_[i];
    const double move = problem.largest_move(guess_), turn = problem.largest_turn(guess_);
    double fraction = 1;
    if (move > course_.move_limit) fraction = course_.move_limit / move;
    if (turn * fraction > largest_edge_turn) fraction = largest_edge_turn / turn;
    set_guess(std::isfinite(fraction) && move > 0 ? fraction : 0);
}

// A prescribed unknown that the guess all but meets is set exactly; one that it does not becomes part of the first direction.
void NewtonSystem::set_guess(double fraction)
{
    course_.guess_fraction = fraction;
    const double met = 1e-6 * problem.length_scale();
    for (int i = 0; i < problem.size(); ++i) {
        problem.trial[i] = fraction == 0 ? problem.start[i] : problem.start[i] + fraction * guess_[i];
        if (problem.prescribed[i] && std::abs(problem.prescribed_value[i] - problem.trial[i]) < met)
            problem.trial[i] = problem.prescribed_value[i];
    }
}

void NewtonSystem::resume()
{
    phase_ = Phase::Guess;
    course_.guess_fraction = 0;
    model_.shift = 0;
    along_ = {};
    course_.first_iteration = course_.iterations;
}

void NewtonSystem::stop_short()
{
    course_.settling = options_.best_effort;
    phase_ = course_.settling ? Phase::Done : Phase::Failed;
}

SolveReport NewtonSystem::report(const WireProblem& wire) const
{
    SolveReport report;
    report.converged = converged();
    report.best_effort = converged() && course_.settling && !course_.cut_short && !course_.rounded;
    report.cut_short = converged() && course_.cut_short;
    report.non_finite = course_.non_finite;
    report.iterations = course_.iterations;
    report.evaluations = course_.evaluations;
    report.residual = wire.norm;
    report.tolerance = wire.tolerance + wire.rounding_most;
    report.force_scale = wire.force_scale;
    return report;
}

}  // namespace seldinger

#include "solve/newton_wire.h"

#include "core/prefetch.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

constexpr double largest_edge_turn = 0.5;  // [rad] in one update; frames and stencils are safe far beyond it
constexpr double smallest_alpha = 1e-6;
constexpr int most_polish = 4;
constexpr int most_kicks = 3;
constexpr int most_jumps = 8;
constexpr double located = 1e-6;  // of the wire's radius: a position known to within this is known [-]

}  // namespace

NewtonWire::NewtonWire(int capacity, const IntegratorSpec& spec) : problem(capacity, spec)
{
    for (auto* array : {&base_, &base_residual_, &direction_, &correction_, &coupling_, &guess_, &shift_weight_})
        array->resize(4 * capacity);
}

void NewtonWire::prefetch(SolveStage next) const
{
    problem.prefetch(next);
    if (next != SolveStage::Advance) return;
    for (const auto* array : {&base_, &base_residual_, &direction_, &coupling_}) seldinger::prefetch(*array, problem.size());
}

SolveReport NewtonWire::report() const
{
    SolveReport report;
    report.converged = converged();
    report.best_effort = converged() && settling_;
    report.non_finite = non_finite_;
    report.iterations = iterations_;
    report.evaluations = evaluations_;
    report.residual = norm_;
    report.tolerance = problem.tolerance + rounding_;
    report.force_scale = problem.force_scale;
    return report;
}

// ---- first guess: the accepted state moved on with its velocity -------------------------------------------------------

void NewtonWire::start(const NewtonOptions& options, double move_limit)
{
    options_ = options;
    move_limit_ = move_limit;
    phase_ = Phase::Guess;
    non_finite_ = unsymmetric_ = shortened_ = settling_ = false;
    iterations_ = first_iteration_ = evaluations_ = retreats_ = safe_steps_ = kicks_ = jumps_passed_ = 0;
    norm_ = contraction_ = rounding_ = 0;
    shift_ = options.gradient_flow ? 100 : 0;
    if (options.shifted) set_shift_weights();
    if (problem.motion != Motion::Implicit || options.linearised) return set_guess(0);

    for (int i = 0; i < problem.size(); ++i) guess_[i] = problem.known_move(i);
    const double move = problem.largest_move(guess_), turn = problem.largest_turn(guess_);
    double fraction = 1;
    if (move > move_limit) fraction = move_limit / move;
    if (turn * fraction > largest_edge_turn) fraction = largest_edge_turn / turn;
    set_guess(std::isfinite(fraction) && move > 0 ? fraction : 0);
}

/// The shift's unit is B/L^3 per node, so that 1 doubles a cantilever's stiffness or so.
void NewtonWire::set_shift_weights()
{
    const RodView& rod = problem.rod;
    double length = 0, bend = 0;
    for (int j = 0; j < rod.n - 1; ++j) length += rod.rest_length[j];
    for (int i = 0; i < rod.n; ++i) bend = std::max(bend, rod.bend_stiffness[i]);
    const double unit = 3 * bend / (length * length * length * rod.n);
    for (int i = 0; i < problem.size(); ++i)
        shift_weight_[i] = i % 4 == 3 ? unit * problem.length_scale * problem.length_scale : unit;
    smallest_shift_ = 1e-3;
}

// A prescribed unknown that the guess all but meets is set exactly; one that it does not becomes part of the first direction.
void NewtonWire::set_guess(double fraction)
{
    guess_fraction_ = fraction;
    for (int i = 0; i < problem.size(); ++i) {
        problem.trial[i] = fraction == 0 ? problem.start[i] : problem.start[i] + fraction * guess_[i];
        if (problem.prescribed[i] && std::abs(problem.prescribed_value[i] - problem.trial[i]) < 1e-6 * problem.length_scale)
            problem.trial[i] = problem.prescribed_value[i];
    }
}

void NewtonWire::resume()
{
    phase_ = Phase::Guess;
    guess_fraction_ = 0;
    shift_ = 0;
    shortened_ = false;
    first_iteration_ = iterations_;
}

void NewtonWire::stop_short()
{
    settling_ = options_.best_effort;
    phase_ = settling_ ? Phase::Done : Phase::Failed;
}

/// The trial cannot be: nearer to the last state that could. @param open  how much of the way from there
/// is, as far as the force terms know
void NewtonWire::retreat(double open)
{
    if (phase_ == Phase::Search) return shorten((open < 1 ? std::clamp(0.9 * open, 0.05, 0.5) : 0.3) * alpha_);
    if (guess_fraction_ == 0) {
        give_up();
        return;
    }
    set_guess(++retreats_ < 6 ? 0.5 * guess_fraction_ : 0.0);
}

// ---- decisions ------------------------------------------------------------------------------------------------------------

void NewtonWire::advance(bool finite, const ForceTerms& terms, int wire)
{
    ++evaluations_;
    took_trial_ = false;
    const bool usable = finite && terms.admissible(wire);
    if (!usable || !problem.evaluate_residual(terms, wire)) {
        non_finite_ = non_finite_ || !finite;
        if (settling_) phase_ = Phase::Failed;
        else retreat(finite ? terms.feasible_step(wire) : 1);
        return;
    }
    norm_ = problem.residual_norm();
    non_finite_ = false;
    if (settling_) {
        phase_ = Phase::Done;
        return;
    }
    if (options_.linearised && phase_ == Phase::Search) {
        // Where no move may be longer than contact has searched, a part of the step is no step: half the time is asked for
        // instead. Published detection has no such limit, and takes what it gets.
        if (alpha_ != 1 && !std::isinf(move_limit_)) return give_up();
        problem.take_linear_tensions();
        phase_ = Phase::Done;
        return;
    }
    rounding_ = terms.rounding(wire);
    // one linearised step is always taken: what contact has said is of the start, and what it keeps must be of the end
    if (!options_.linearised && norm_ <= problem.tolerance + rounding_ && at_prescribed()) {
        if (options_.shifted && kicks_ < most_kicks && !stable(terms, wire)) return kick();
        if (may_be_saddle() && leave_saddle(terms, wire)) return;
        phase_ = Phase::Done;
        return;
    }
    if (phase_ == Phase::Search) {
        const Jump jump = jump_of_force(terms, wire);
        if (jump == Jump::Turns) {
            phase_ = Phase::Done;
            return;
        }
        if (jump == Jump::None && !acceptable()) {
            if (at_kink(terms, wire)) phase_ = Phase::Done;
            return;
        }
    }
    if (iterations_ - first_iteration_ >= options_.max_iterations) {
        if (at_kink(terms, wire)) phase_ = Phase::Done;
        else give_up();
        return;
    }
    take_base();
    new_direction(terms, wire);
    launch();
    polish(terms);
}

/// Out of ideas. Best effort: back to the last trial that was taken, which is nearer to the solution than the start by the tests
/// that took it, and admissible; one more evaluation makes contact speak of it.
void NewtonWire::give_up()
{
    if (!options_.best_effort || settling_ || iterations_ == 0 || phase_ != Phase::Search) {
        phase_ = Phase::Failed;
        return;
    }
    settling_ = true;
    std::copy_n(base_.begin(), problem.size(), problem.trial.begin());
    for (int i = 0; i < problem.size(); ++i)
        if (problem.prescribed[i]) problem.trial[i] = problem.prescribed_value[i];
}

bool NewtonWire::at_prescribed() const
{
    for (int i = 0; i < problem.size(); ++i)
        if (problem.prescribed[i] && problem.trial[i] != problem.prescribed_value[i]) return false;
    return true;
}

/// The tests at the top of newton_wire.h; a shorter trial is set when they fail.
bool NewtonWire::acceptable()
{
    const double slope = residual_along(direction_);
    const bool slope_falls = std::abs(slope) <= std::max(0.9, 1 - alpha_ / 2) * std::abs(slope_);
    if (options_.gradient_flow) {
        if (slope_falls || slope <= 0) return true;
        raise_shift();
        return false;
    }
    correct();
    contraction_ = problem.norm(part(correction_)) / direction_norm_;
    if (contraction_ <= 1 - alpha_ / 4 || slope_falls) return true;
    // what the linear equations did not foresee of the correction grows with alpha^2
    for (int i = 0; i < problem.size(); ++i) scratch_[i] = correction_[i] - (1 - alpha_) * direction_[i];
    const double natural = 0.5 * direction_norm_ * alpha_ * alpha_ / problem.norm(part(scratch_));
    const double secant = slope * slope_ < 0 ? alpha_ * slope_ / (slope_ - slope) : 0.0;
    shorten(std::clamp(std::max(natural, secant), 0.1 * alpha_, 0.5 * alpha_));
    return false;
}

/// R.d over the free unknowns
double NewtonWire::residual_along(std::span<const double> d) const
{
    double sum = 0;
    for (int i = 0; i < problem.size(); ++i)
        if (!problem.prescribed[i]) sum += problem.residual[i] * d[i];
    return sum;
}

double NewtonWire::smallest_radius() const
{
    return *std::min_element(problem.rod.radius.begin(), problem.rod.radius.begin() + problem.rod.n - 1);
}

/// When no point of the wire's surface is farther than a millionth of its radius (half a nanometre) from where it is in the base,
/// and yet the force differs by more than a tenth of the base's residual and of the largest contact force: which facets of the
/// wall are nearest has changed, and the force with them (in a neck as narrow as the wire, at the corner of three walls). No
/// elastic or contact stiffness does that, and no friction that begins to slip. Where the jump turns the force round, the
/// equilibrium is there, to that half nanometre, and no position has a smaller residual. Else it lies beyond, and the trial is as
/// good a base as any.
NewtonWire::Jump NewtonWire::jump_of_force(const ForceTerms& terms, int wire)
{
    if (!terms.may_jump() || options_.shifted || alpha_ == first_alpha_) return Jump::None;
    if (alpha_ * largest_surface_move(direction_) > located * smallest_radius()) return Jump::None;
    // the base edge of a fed wire may be so short that half a nanometre is newtons of EA/l: its ends are not asked
    const int asked = problem.fed() ? problem.size() - 8 : problem.size();
    double change = 0, base = terms.largest_force(wire);
    for (int i = 0; i < asked; ++i) {
        if (problem.prescribed[i] || i % 4 == 3) continue;
        change = std::max(change, std::abs(problem.residual[i] - base_residual_[i]));
        base = std::max(base, std::abs(base_residual_[i]));
    }
    if (change <= 0.1 * base) return Jump::None;
    if (residual_along(direction_) * slope_ < 0) return Jump::Turns;
    return ++jumps_passed_ <= most_jumps ? Jump::Passed : Jump::None;
}

/// Of a node, or of the surface by spin [m].
double NewtonWire::largest_surface_move(std::span<const double> d) const
{
    double largest = problem.largest_move(d);
    for (int j = 0; j < problem.rod.n - 1; ++j) largest = std::max(largest, std::abs(d[4 * j + 3]) * problem.rod.radius[j]);
    return largest;
}

/// The simplified Newton correction at the trial into correction_. With a shift, that of the shifted problem, a pseudo-time step
/// R(q) + shift (q - base) = 0: leaving a saddle must not look like a failure because R grows.
void NewtonWire::correct()
{
    problem.mixed_residual(part(scratch_));
    if (shift_ > 0)
        for (int i = 0; i < problem.size(); ++i) scratch_[i] += shift_ * shift_weight_[i] * (problem.trial[i] - base_[i]);
    correction_at_trial(scratch_, part(correction_), 1 - alpha_);
}

/// The correction is below a millionth of the wire's radius (a nanometre's half), and what is left of the force is either
/// rounding (of a single-precision gap, say) or the jump of a contact force at a kink of the faceted wall, where three facets'
/// blends meet: the position is known to that half nanometre, and no position has a smaller residual.
bool NewtonWire::at_kink(const ForceTerms& terms, int wire) const
{
    if (iterations_ < 4 || options_.shifted) return false;
    const double jump = 1e-3 * terms.largest_force(wire);
    return norm_ <= std::max(100 * problem.tolerance, jump) && problem.largest_move(direction_) <= located * smallest_radius() &&
           at_prescribed();
}

void NewtonWire::shorten(double alpha)
{
    if (options_.shifted && alpha < 0.05 * first_alpha_) return raise_shift();
    if (alpha < smallest_alpha) {
        give_up();
        return;
    }
    shortened_ = true;
    set_trial(alpha);
}

void NewtonWire::take_base()
{
    const int size = problem.size();
    // equilibrium: trust the model more after a good full step
    if (options_.shifted && phase_ == Phase::Search) {
        if (options_.gradient_flow) shift_ *= 0.7;
        else if (alpha_ == first_alpha_) shift_ *= contraction_ < 0.5 ? 0.1 : 0.5;
        if (shift_ < smallest_shift_) shift_ = 0;
    }
    problem.set_base();
    if (options_.shifted && problem.far_from_reference()) problem.move_reference();
    std::copy_n(problem.trial.begin(), size, base_.begin());
    std::copy_n(problem.residual.begin(), size, base_residual_.begin());
    phase_ = Phase::Search;
    took_trial_ = true;
    ++iterations_;
}

// ---- direction ------------------------------------------------------------------------------------------------------------

void NewtonWire::new_direction(const ForceTerms& terms, int wire)
{
    if (options_.shifted) factorise_shifted(terms, wire);
    else factorise(terms, wire);
    correction_at_trial(problem.residual, part(direction_), 1);
}

void NewtonWire::factorise(const ForceTerms& terms, int wire)
{
    // after a step that had to be shortened, the symmetric tangent, which goes downhill; but not where symmetric means wrong:
    // half of EA on the edges' mean directions and half on those of their ends
    const bool loaded = problem.unsymmetric() || terms.unsymmetric(wire);
    const bool sliding = loaded && (!shortened_ || problem.conserving());
    safe_steps_ = shortened_ ? 0 : safe_steps_;
    shortened_ = false;
    unsymmetric_ = sliding || safe_steps_ >= 3;
    const int indefinite = factorise_with(HessianMode::Exact, terms, wire);
    if (indefinite == 0 || (safe_steps_ >= 3 && indefinite < problem.size())) return;
    unsymmetric_ = sliding;
    ++safe_steps_;
    if (factorise_with(HessianMode::Safe, terms, wire) < problem.size() || !unsymmetric_) return;
    unsymmetric_ = false;
    (void)factorise_with(HessianMode::Safe, terms, wire);
}

/// @return pivots that were not positive; all of them when LU fails
int NewtonWire::factorise_with(HessianMode mode, const ForceTerms& terms, int wire)
{
    problem.assemble_tangent(mode, !unsymmetric_, terms, wire);
    // prescribed unknowns move by a known amount, which loads the others
    const int size = problem.size();
    std::fill_n(coupling_.begin(), size, 0.0);
    for (int i = 0; i < size; ++i) {
        if (!problem.prescribed[i] || problem.trial[i] == problem.prescribed_value[i]) continue;
        problem.matrix.add_column(i, problem.prescribed_value[i] - problem.trial[i], coupling_);
    }
    for (int i = 0; i < size; ++i)
        if (problem.prescribed[i] && !(problem.without_spins() && i % 4 == 3)) problem.matrix.fix(i);
    add_shift(shift_);
    return factorise_matrix();
}

/// The matrix as it stands. @return as factorise_with
int NewtonWire::factorise_matrix()
{
    if (!unsymmetric_) return problem.matrix.factor_ldlt();
    return problem.matrix.factor_lu() ? problem.matrix.negative_pivots() : problem.size();
}

void NewtonWire::add_shift(double amount)
{
    if (amount == 0) return;
    for (int i = 0; i < problem.size(); ++i)
        if (!problem.prescribed[i]) problem.matrix.add(i, i, amount * shift_weight_[i]);
}

/// As little shift as makes the exact matrix positive definite: then the direction goes down, and away from saddles. Under dead
/// moments, which have no potential, as little as leaves its pivots positive.
void NewtonWire::factorise_shifted(const ForceTerms& terms, int wire)
{
    unsymmetric_ = problem.unsymmetric();
    int raised = factorise_with(HessianMode::Exact, terms, wire);
    for (int attempt = 0; attempt < 12 && raised > 0; ++attempt) {
        const double larger = std::max(4 * shift_, smallest_shift_);
        add_shift(larger - shift_);
        shift_ = larger;
        raised = factorise_matrix();
    }
    if (raised > 0) (void)factorise_with(HessianMode::Safe, terms, wire);
}

/// Whether the equilibrium at the trial is one that can last: the exact matrix is positive definite, but for a shift far below
/// any real stiffness (a wire that nothing holds is neither).
bool NewtonWire::stable(const ForceTerms& terms, int wire)
{
    unsymmetric_ = problem.unsymmetric();
    shift_ = smallest_shift_;
    return factorise_with(HessianMode::Exact, terms, wire) == 0;
}

/// A step of backward Euler minimises its incremental potential. Where the last exact matrix was not positive definite, the
/// solution may be a saddle: a straight column pushed far beyond its buckling load, which no rounding error bends because nothing
/// leads out of its line. Asked once in a solve.
bool NewtonWire::may_be_saddle() const
{
    return !options_.shifted && !options_.linearised && safe_steps_ > 0 && kicks_ == 0 && problem.motion == Motion::Implicit &&
           !problem.conserving();
}

/// From the trial, whose equations hold. @return whether it was one
bool NewtonWire::leave_saddle(const ForceTerms& terms, int wire)
{
    set_shift_weights();
    const bool saddle = !stable(terms, wire);
    if (saddle) kick();
    shift_ = 0;
    safe_steps_ = 0;
    return saddle;
}

/// Leaves an unstable equilibrium by a hundredth of an edge along its softest mode, found by inverse iteration on the matrix that
/// stable() has assembled.
void NewtonWire::kick()
{
    ++kicks_;
    const int size = problem.size();
    for (int attempt = 0; attempt < 20; ++attempt) {
        add_shift(3 * shift_);
        shift_ *= 4;
        if (factorise_matrix() == 0) break;
    }
    for (int i = 0; i < size; ++i) direction_[i] = std::sin(1.7 * i + 0.3);  // any vector that no mode is normal to
    for (int round = 0; round < 10; ++round) {
        for (int i = 0; i < size; ++i) direction_[i] *= problem.prescribed[i] ? 0.0 : shift_weight_[i];
        solve(part(direction_));
        const double length = problem.norm(part(direction_));
        for (int i = 0; i < size; ++i) direction_[i] /= length;
    }
    double downhill = 0, largest = 0;
    for (int i = 0; i < size; ++i) {
        if (!problem.prescribed[i]) downhill -= problem.residual[i] * direction_[i];
        largest = std::max(largest, std::abs(direction_[i]) * (i % 4 == 3 ? problem.length_scale : 1.0));
    }
    const double step = (downhill < 0 ? -0.01 : 0.01) * problem.length_scale / largest;
    for (int i = 0; i < size; ++i) problem.trial[i] += step * direction_[i];
    phase_ = Phase::Guess;
    guess_fraction_ = 0;
}

/// The direction failed at any useful length: a shorter, more downhill one from the same base.
void NewtonWire::raise_shift()
{
    const double larger = std::max(10 * shift_, 10 * smallest_shift_);
    if (larger > 1e15) {
        give_up();
        return;
    }
    add_shift(larger - shift_);
    shift_ = larger;
    (void)factorise_matrix();
    std::copy_n(base_.begin(), problem.size(), problem.trial.begin());
    std::copy_n(base_residual_.begin(), problem.size(), problem.residual.begin());
    correction_at_trial(problem.residual, part(direction_), 1);
    launch();
}

void NewtonWire::solve(std::span<double> rhs_to_x)
{
    if (unsymmetric_) problem.matrix.solve_lu(rhs_to_x);
    else problem.matrix.solve_ldlt(rhs_to_x);
}

/// -A^-1 `residual` at the trial, with the present factors; prescribed unknowns go to their values.
/// @param prescribed_left  how much of the prescribed unknowns' move at the base is still to be made
void NewtonWire::correction_at_trial(std::span<const double> residual, std::span<double> out, double prescribed_left)
{
    for (int i = 0; i < problem.size(); ++i)
        out[i] = problem.prescribed[i] ? problem.prescribed_value[i] - problem.trial[i]
                                       : -residual[i] - prescribed_left * coupling_[i];
    solve(out);
}

// ---- step -------------------------------------------------------------------------------------------------------------------

void NewtonWire::launch()
{
    direction_norm_ = problem.norm(part(direction_));
    if (!std::isfinite(direction_norm_) || (direction_norm_ == 0 && !options_.linearised)) {
        give_up();
        non_finite_ = true;
        return;
    }
    slope_ = residual_along(direction_);
    const double move = problem.largest_move(direction_), turn = problem.largest_turn(direction_);
    first_alpha_ = 1;
    if (move > move_limit_) first_alpha_ = move_limit_ / move;
    if (turn * first_alpha_ > largest_edge_turn) first_alpha_ = largest_edge_turn / turn;
    set_trial(first_alpha_);
}

/// Further simplified corrections with contact linear, while they shrink fast.
void NewtonWire::polish(const ForceTerms& terms)
{
    if (!running() || alpha_ != 1 || options_.linearised || options_.gradient_flow) return;
    double last = direction_norm_;
    for (int k = 0; k < most_polish; ++k) {
        const bool usable = problem.update() && problem.evaluate_linear_contact(terms, base_);
        if (usable && problem.residual_norm() <= 0.5 * problem.tolerance) return;
        if (usable) correct();
        const double size = problem.norm(part(correction_));
        if (!usable || !(size < 0.3 * last) || (shift_ > 0 && size < 1e-3 * direction_norm_)) return;
        last = size;
        problem.correct_tension(correction_);
        for (int i = 0; i < problem.size(); ++i) problem.trial[i] += correction_[i];
    }
}

void NewtonWire::set_trial(double alpha)
{
    alpha_ = alpha;
    problem.predict_tension(direction_, alpha);
    for (int i = 0; i < problem.size(); ++i) problem.trial[i] = base_[i] + alpha * direction_[i];
    if (alpha == 1)
        for (int i = 0; i < problem.size(); ++i)
            if (problem.prescribed[i]) problem.trial[i] = problem.prescribed_value[i];
}

}  // namespace seldinger

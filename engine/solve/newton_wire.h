#pragma once
// Newton's method for one wire as a state machine: the solver evaluates all wires' trial states together, then lets each wire
// take its own decision. Nothing here looks at another wire.
//
// Direction. Exact Hessian where the matrix it gives is positive definite, else the safe one (and the exact one again, by LU,
// once the safe one has brought three full steps: near the root it converges where the safe one crawls). With sliding friction,
// dead moments or energy-momentum steps the full, unsymmetric tangent and LU, which cost the same. The geometric stiffness of
// stretching is taken at the tension that the *linear* equations of the previous iteration predict, not at the tension of the
// trial shape. A step that turns an edge by phi lengthens it by phi^2/2, and EA phi^2/2 is a spurious tension larger than any
// real force: with it the next direction is far too stiff sideways and every step needs extra iterations. ([Magisano17]: mixed
// integration points, equal to Newton on the mixed equations in position and tension; same solution, since both tensions agree
// there.)
//
// Step length. There is no potential (friction), and no residual norm fits stretching and bending at once. A trial is taken when
// either the simplified Newton correction A^-1 R(q + alpha d) of those mixed equations, in metres, has shrunk against d (the
// natural monotonicity test of [Deuflhard04, sec. 3.3.2], one back-substitution), or the derivative along d has:
// |R(q + alpha d).d| <= max(0.9, 1 - alpha/2) |R(q).d|. Else alpha is reduced. No edge turns by more than half a radian and no
// node moves farther than contact has searched in one update. Between two evaluations of contact, which cost most of a step, the
// equations with contact taken as linear are solved on by further back-substitutions (polish), so that what the next evaluation
// finds is contact's own curvature only.
//
// Statics. A shift on the diagonal, no larger than makes the exact matrix positive definite, turns each iteration into a step of
// pseudo-time, judged by that step's equations: it leaves saddles and snaps through folds, and is Newton's method at the end. A
// step in time that ends where the exact matrix is indefinite leaves its saddle likewise, once.

#include "solve/wire_problem.h"

#include <vector>

namespace seldinger {

struct NewtonOptions {
    int max_iterations = 40;
    bool best_effort = false;  // instead of failing, end at the last trial that was taken
    bool linearised = false;   // D5: one step from the start of the step, taken as it is if admissible
    // equilibrium only: shift * scale added on the diagonal, adapted (Levenberg-Marquardt)
    bool shifted = false;
    bool gradient_flow = false;  // pseudo-time: start with a large shift, lower it slowly, trust the derivative alone
};

class NewtonWire {
public:
    NewtonWire(int capacity, const IntegratorSpec& spec);

    /// See WireProblem::work_in().
    void work_in(WireProblem::Workspace& workspace, bool once) { scratch_ = problem.work_in(workspace, once); }
    /// Its arrays will be needed soon.
    void prefetch(SolveStage next) const;

    /// Starts a solve of `problem`, begun by the caller; the first trial is set.
    void start(const NewtonOptions& options, double move_limit);
    /// Takes in the evaluation at problem.trial and decides: done, failed, or a new trial.
    /// @param finite  frames at the trial are finite, and contact has been evaluated there
    void advance(bool finite, const ForceTerms& terms, int wire);

    /// After convergence, contact's multipliers having changed: Newton goes on from where it is.
    void resume();
    /// They have not settled, and will not: the wire has failed, or takes what it has (best effort).
    void stop_short();
    /// Whether the last advance() took its trial: the next ones start from there.
    [[nodiscard]] bool took_trial() const { return took_trial_; }

    [[nodiscard]] bool running() const { return phase_ == Phase::Guess || phase_ == Phase::Search; }
    [[nodiscard]] bool converged() const { return phase_ == Phase::Done; }
    [[nodiscard]] SolveReport report() const;

    WireProblem problem;

private:
    enum class Phase { Guess, Search, Done, Failed };
    enum class Jump { None, Turns, Passed };

    void set_guess(double fraction);
    void set_shift_weights();
    void retreat(double open);
    void give_up();
    [[nodiscard]] bool at_prescribed() const;
    [[nodiscard]] bool acceptable();
    [[nodiscard]] Jump jump_of_force(const ForceTerms& terms, int wire);
    [[nodiscard]] double residual_along(std::span<const double> d) const;
    [[nodiscard]] double smallest_radius() const;
    [[nodiscard]] double largest_surface_move(std::span<const double> d) const;
    void correct();
    [[nodiscard]] bool at_kink(const ForceTerms& terms, int wire) const;
    void shorten(double alpha);
    void take_base();
    void new_direction(const ForceTerms& terms, int wire);
    void factorise(const ForceTerms& terms, int wire);
    void factorise_shifted(const ForceTerms& terms, int wire);
    [[nodiscard]] int factorise_with(HessianMode mode, const ForceTerms& terms, int wire);
    [[nodiscard]] int factorise_matrix();
    void add_shift(double amount);
    void raise_shift();
    [[nodiscard]] bool stable(const ForceTerms& terms, int wire);
    [[nodiscard]] bool may_be_saddle() const;
    [[nodiscard]] bool leave_saddle(const ForceTerms& terms, int wire);
    void kick();
    void solve(std::span<double> rhs_to_x);
    void correction_at_trial(std::span<const double> residual, std::span<double> out, double prescribed_left);
    void launch();
    void polish(const ForceTerms& terms);
    void set_trial(double alpha);

    [[nodiscard]] std::span<double> part(std::span<double> v) const { return v.first(static_cast<std::size_t>(problem.size())); }

    NewtonOptions options_;
    Phase phase_ = Phase::Done;
    bool settling_ = false;  // taking the best trial instead of failing
    bool non_finite_ = false, unsymmetric_ = false, shortened_ = false, took_trial_ = false;
    int safe_steps_ = 0;  // full steps in a row with the safe Hessian
    int iterations_ = 0, first_iteration_ = 0, evaluations_ = 0, retreats_ = 0, kicks_ = 0, jumps_passed_ = 0;
    double move_limit_ = 0, guess_fraction_ = 1, norm_ = 0, rounding_ = 0;
    double alpha_ = 1, first_alpha_ = 1, direction_norm_ = 0, slope_ = 0, contraction_ = 0;
    double shift_ = 0, smallest_shift_ = 0;
    std::vector<double> base_, base_residual_, direction_, correction_, coupling_, guess_, shift_weight_;
    std::span<double> scratch_;  // in the workspace
};

}  // namespace seldinger

#pragma once
// Newton's method for one system as a state machine: the solver evaluates all systems' trial states together, then lets each take
// its own decision. Nothing here looks at another system.
//
// Direction (linear_model.cpp). The geometric stiffness of stretching is taken at the tension that the *linear* equations of the
// previous iteration predict, not at the tension of the trial shape. A step that turns an edge by phi lengthens it by phi^2/2, and
// EA phi^2/2 is a spurious tension larger than any real force. With it the next direction is far too stiff sideways and every
// step needs extra iterations. [Magisano17] has mixed integration points, which equal Newton's method on the mixed equations in
// position and tension (mixed_tension.h). The solution is the same, since both tensions agree there.
//
// Step length (step_acceptance.cpp). There is no potential (friction), and no residual norm fits stretching and bending at once. A
// trial is taken when one of two conditions holds. Either the simplified Newton correction A^-1 R(q + alpha d) of those mixed
// equations, in metres, has shrunk against d (the natural monotonicity test of [Deuflhard04, sec. 3.3.2], one back-substitution).
// Or the derivative along d has: |R(q + alpha d).d| <= max(0.9, 1 - alpha/2) |R(q).d|. Where the correction has grown, the derivative is
// believed three times in a step, because more such trials go round in a circle. Of a direction of the projected Hessian, which is
// not the derivative, it is enough that the derivative along it is still negative: it leaves a saddle. A direction whose residual had
// the forces of valleys added (below) is not what the correction tends to as alpha falls: there the residual is asked, too. Where two
// trials in a row show that both grow in proportion to alpha, no shorter one can pass. Trials that are cut short by the limits below
// may pass for ever: six bases in a row with the residual of the one before the last end the search. Else alpha is reduced. No edge
// turns by more than half a radian and no node moves farther than force terms have searched in one update. Between two evaluations of
// these, which cost most of a step, the equations with linearised terms are solved further by back-substitutions (chord steps). The next
// evaluation then meets the terms' own curvature only. A contact that goes over a valley of the wall, from facet to facet, leaves
// its curvature's sight: where a trial has, the direction from it leads to the valley (contact/valleys.h). Where the step's first
// trial fails for that, all its valleys are balanced together first (kink_balance.h). Where instruments touch, the factors may
// serve for the next direction too: the correction of the test is that direction (keeps_factors).
//
// Statics (pseudo_transient.cpp). A Levenberg-Marquardt shift, just large enough to make the exact matrix positive definite, turns
// each iteration into a step of pseudo-time, judged by that step's equations. It leaves saddles and snaps through folds, and is
// Newton's method at the end. A step in time that ends where the exact matrix is indefinite leaves its saddle in the same way, once
// (stability.cpp).

#include "newton/linear_model.h"
#include "newton/newton_trial.h"
#include "newton/system_problem.h"
#include "solve/solve_report.h"

#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace seldinger {

struct NewtonOptions {
    int max_iterations = 40;
    bool best_effort = false;  // instead of failing, end at the last trial that was taken
    bool linearised = false;   // D5: one step from the start of the step, taken as it is if admissible
    // equilibrium only: a shift on the diagonal, adapted (Levenberg-Marquardt)
    bool shifted = false;
    bool pseudo_transient = false;  // start with a large shift, lower it slowly, trust the derivative alone
};

class NewtonSystem {
public:
    NewtonSystem(int first_wire, std::span<const int> capacities, const IntegratorSpec& spec);

    /// See SystemProblem::work_in().
    void work_in(SystemProblem::Workspace& workspace, bool once) { scratch_ = problem.work_in(workspace, once); }
    /// Its arrays will be needed soon.
    void prefetch(SolveStage next) const;

    /// Starts a solve of `problem`, begun by the caller; the first trial is set.
    void start(const NewtonOptions& options, const ForceTerms& terms);
    /// Takes in the evaluation at problem.trial and decides: done, failed, or a new trial.
    /// @param finite  frames at the trial are finite, and force terms have been evaluated there
    void advance(bool finite, const ForceTerms& terms);

    /// Whether to end at the next trial that can be a state: see Solver::cut_when().
    void hurry(bool due) { course_.due = due; }
    /// Whether the solve was ended so.
    [[nodiscard]] bool cut_short() const { return course_.cut_short; }

    /// Calls `seen` for each trial after its decision. @param seen  outlives this; may be empty
    void watch(const std::function<void(const NewtonTrial&)>& seen) { seen_ = &seen; }

    /// After convergence, the terms' multipliers having changed: Newton continues from here.
    void resume();
    /// They have not settled, and will not: the system has failed, or takes its best state (best effort).
    void stop_short();
    /// Ends the solve as one that has failed.
    void abandon()
    {
        phase_ = Phase::Failed;
        course_.settling = false;
    }

    [[nodiscard]] bool running() const { return phase_ == Phase::Guess || phase_ == Phase::Search; }
    [[nodiscard]] bool converged() const { return phase_ == Phase::Done; }
    [[nodiscard]] SolveReport report(const WireProblem& wire) const;

    SystemProblem problem;

private:
    enum class Phase { Guess, Search, Done, Failed };
    enum class Jump { None, Turns, Passed };

    // the start (newton_start.cpp)
    void set_guess(double fraction);

    // the driver (newton_system.cpp)
    bool decide(bool finite, const ForceTerms& terms);
    void tell(NewtonTrial trial, bool possible) const;
    [[nodiscard]] bool ends_at_trial(const ForceTerms& terms);
    [[nodiscard]] bool can_be_state() const;
    [[nodiscard]] bool ends_when_due();
    [[nodiscard]] bool improves() const;
    void end_at_base();
    void take_linearised();
    [[nodiscard]] bool keeps_factors() const;
    [[nodiscard]] bool goes_round();
    void take_base();
    void new_direction(const ForceTerms& terms);
    void launch();
    void chord_steps(const ForceTerms& terms);
    void set_trial(double alpha);
    void give_up();

    // whether a trial is taken (step_acceptance.cpp)
    void backtrack(double open);
    void shorten(double alpha, bool into_valley = false);
    [[nodiscard]] bool acceptable(const ForceTerms& terms);
    [[nodiscard]] bool natural_test(bool slope_falls, double slope, const ForceTerms& terms);
    [[nodiscard]] bool redirect(const ForceTerms& terms);
    void take_redirection_back();
    [[nodiscard]] bool fails_however_short(double contraction, double slope);
    void correct();
    [[nodiscard]] Jump jump_of_force(const ForceTerms& terms);
    [[nodiscard]] bool at_kink() const;

    // pseudo-transient continuation (pseudo_transient.cpp)
    void adapt_shift();
    void raise_shift();

    // unstable equilibria (stability.cpp)
    [[nodiscard]] bool may_be_saddle() const;
    [[nodiscard]] bool leave_saddle(const ForceTerms& terms);
    void perturb_along_softest_mode();

    [[nodiscard]] std::span<double> part(std::span<double> v) const { return v.first(static_cast<std::size_t>(problem.size())); }

    static constexpr double largest_edge_turn = 0.5;  // [rad] in one update; frames and stencils hold far beyond it

    LinearModel model_;
    const std::function<void(const NewtonTrial&)>* seen_ = nullptr;
    NewtonOptions options_;
    Phase phase_ = Phase::Done;
    // each with what it lasts for
    struct Course {
        bool settling = false;    // taking the best trial instead of failing
        bool non_finite = false;  // the last evaluation was
        bool due = false, cut_short = false;
        bool rounded = false;  // settling at a base that is balanced
        int iterations = 0, first_iteration = 0;  // the latter: after which multipliers were renewed
        double residual_shares[2] = {};  // of the last two bases
        int same_again = 0;              // bases in a row whose residual was that of the one before the last
        int evaluations = 0, backtracks = 0, mode_perturbations = 0, jumps_passed = 0, times_grown = 0;
        double move_limit = std::numeric_limits<double>::infinity();  // of a node in one update [m]
        double guess_fraction = 1;  // of guess_, that the trial has moved by
    } course_;
    struct Base {
        double residual_share = 0;  // of the tolerance
        bool can_be_state = false, balanced = false;
    } at_base_;
    struct Direction {
        double alpha = 1, first_alpha = 1;  // of the present and of the first trial on it
        double norm = 0, slope = 0;         // slope: R . direction at the base
        bool into_valley = false;  // the trial was shortened
        bool admits = false;       // the direction is that of a residual with the forces of valleys: Valleys::admit
        bool redirected = false;  // the trial has been, to the balance of the kinks: correction_ is what this changed
        KinksPassed before_redirection;
        // per share, at the last trial on it that failed: by how much the correction grows, and the derivative along it
        std::optional<double> growth, slope_growth;
    } along_;
    struct Trial {
        KinksPassed crossed;
        std::optional<double> contraction;  // correction_ is the trial's, and so much of the direction; none: not asked for
    } at_trial_;
    std::vector<double> base_, base_residual_, direction_, correction_, guess_;  // [unknowns]
    std::span<double> scratch_;                                                  // in the workspace
};

}  // namespace seldinger

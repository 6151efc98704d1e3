#pragma once
// Directions of Newton's method: the corrections -A^-1 R, and which matrix A they take (linear_model.h).
//
// Tension. A step that turns an edge by phi lengthens it by phi^2/2. EA phi^2/2 is a spurious tension, larger than any real
// force: with it the next direction is far too stiff sideways. So the geometric stiffness takes the tension that the linear
// equations of the iteration before predict. This equals Newton's method on the mixed equations in position and tension
// [Magisano17] (solve/mixed_tension.h); the solution is the same, since both tensions agree there.
//
// Chord steps. Evaluating the force terms costs most of a step. Between two evaluations the equations with linearised terms are
// solved further by back-substitutions, so that the next evaluation meets the terms' own curvature only.
//
// Statics. A shift s on the diagonal makes an iteration a step of length 1/s in the pseudo-time of W q' = -R(q), W its weights
// (Levenberg-Marquardt). Large shifts follow the wire downhill and through folds; none is Newton's method.
//
// Saddles. A step of backward Euler minimises its incremental potential. If the exact matrix is not positive definite at its end,
// the wire leaves along the softest mode, once in a solve.

#include "newton/iterate.h"
#include "newton/linear_model.h"

namespace seldinger {

class NewtonDirection {
public:
    /// @param problem, iterate  outlive this
    NewtonDirection(SystemProblem& problem, NewtonIterate& iterate) : problem_(problem), at_(iterate), model_(problem) {}

    void start() { model_.start(at_.options.shifted, at_.options.pseudo_transient ? 100 : 0); }
    /// Newton continues without a shift.
    void resume() { model_.shift = 0; }
    void prefetch() const { model_.prefetch(); }

    /// Whether the last factors serve for the next direction too; see direction.cpp.
    [[nodiscard]] bool keeps_factors() const;
    /// The direction from the trial, which has become the base. @param keep  the last correction, by the factors that there are
    void find(bool keep, const ForceTerms& terms);
    /// Norm, derivative and first share of a new direction. @return false if it is none: not finite, or zero
    [[nodiscard]] bool measure();
    /// The trial at `alpha` on the direction.
    void set_trial(double alpha);
    /// Further simplified corrections of the trial, while they shrink fast.
    void chord_steps(const ForceTerms& terms);
    /// The simplified correction A^-1 R at the trial into iterate.correction.
    void correct();
    /// x = A^-1 b with the last factors, prescribed unknowns kept.
    void solve(std::span<double> rhs_to_x);

    /// Statics: trusts the model more after a good full step.
    void lower_shift();
    /// The direction failed at any useful length: a shorter, more downhill one from the same base. @return false if there is none
    [[nodiscard]] bool raise_shift();

    /// Full steps in a row with the Hessian made positive.
    [[nodiscard]] int projected_steps() const { return model_.projected_steps(); }
    /// Statics: whether the equilibrium at the trial is one that the wire would stay in. If not, it has been moved off it.
    [[nodiscard]] bool rests(const ForceTerms& terms);
    /// Whether the solution at the trial was a saddle. If so, it has been moved off it.
    [[nodiscard]] bool leaves_saddle(const ForceTerms& terms);

private:
    [[nodiscard]] std::span<double> part(std::span<double> v) const { return v.first(static_cast<std::size_t>(problem_.size())); }
    void perturb_along_softest_mode();

    SystemProblem& problem_;
    NewtonIterate& at_;
    LinearModel model_;
};

}  // namespace seldinger

#pragma once
// Whether a trial is taken, and otherwise which share of the direction is tried next.
//
// There is no potential (friction), and no residual norm fits stretching and bending at once. A trial is taken when one of two
// conditions holds:
//
//   1. The simplified correction A^-1 R(q + alpha d), in metres, is at most 1 - alpha/4 of d: the natural monotonicity test of
//      [Deuflhard04, sec. 3.3.2], one back-substitution.
//   2. The derivative along d has shrunk: |R(q + alpha d).d| <= max(0.9, 1 - alpha/2) |R(q).d|. For a direction of the projected
//      Hessian, which is not the derivative, a negative one is enough: it leaves a saddle.
//
// Where the correction has grown, the derivative is believed three times in a step: more such trials go round in a circle.
// Directions that lead to a valley (kinks.h) are judged by the residual too. Where two trials in a row show that correction and
// derivative grow in proportion to alpha, no shorter one can pass, and the search ends. Else alpha is reduced.

#include "newton/kinks.h"

namespace seldinger {

class NewtonAcceptance {
public:
    /// What is to be done. The driver does it.
    struct Verdict {
        enum class What {
            Taken,      // the trial is the new base
            Tried,      // another trial is set already
            Shorter,    // `alpha` of the direction
            MoreShift,  // statics: a direction of a larger shift
            GivenUp     // no shorter trial can pass
        };
        What what = What::Taken;
        double alpha = 0;
        bool into_valley = false;  // that contact went over
    };

    /// @param problem, iterate, direction, kinks  outlive this
    NewtonAcceptance(SystemProblem& problem, NewtonIterate& iterate, NewtonDirection& direction, NewtonKinks& kinks)
        : problem_(problem), at_(iterate), direction_(direction), kinks_(kinks)
    {
    }

    /// Of a trial whose residual is known.
    [[nodiscard]] Verdict judge(const ForceTerms& terms);
    /// Share of the direction after a trial that cannot be. @param open  share of the path to it that is, as far as force terms
    /// know
    [[nodiscard]] double after_refusal(double open) const;

private:
    [[nodiscard]] Verdict natural_test(bool slope_falls, double slope, const ForceTerms& terms);
    [[nodiscard]] bool fails_however_short(double contraction, double slope);
    [[nodiscard]] double next_share(double contraction, double slope);

    SystemProblem& problem_;
    NewtonIterate& at_;
    NewtonDirection& direction_;
    NewtonKinks& kinks_;
};

}  // namespace seldinger

#pragma once
// Options of one solve by Newton's method, and the constants of the method with their meaning. A constant without a source was
// chosen by the iterations of whole scenes (bench/newton_iterations.py).

namespace seldinger {

struct NewtonOptions {
    int max_iterations = 40;
    bool best_effort = false;  // instead of failing, end at the last trial that was taken
    bool linearised = false;   // D5: one step from the start of the step, taken as it is if admissible
    // equilibrium only: a shift on the diagonal, adapted (Levenberg-Marquardt)
    bool shifted = false;
    bool pseudo_transient = false;  // start with a large shift, lower it slowly, trust the derivative alone
};

struct NewtonConstants {
    // trials
    double largest_edge_turn = 0.5;   // [rad] in one update; frames and stencils hold far beyond it
    double smallest_share = 1e-6;     // of a direction; a shorter trial is none
    double refused_share = 0.3;       // of a trial that is not admissible and does not say how far it may go
    double open_share = 0.9;          // of the path that is open, where force terms say so
    double most_accelerated = 0.05;   // of the first guess, that the last acceleration may change: more is a strike or a release
    int most_guesses = 6;             // shorter first guesses; the next is the start of the step itself
    double met_prescribed = 1e-6;     // of an edge: a prescribed unknown that near to its value is set to it

    // acceptance (acceptance.h)
    double slope_left = 0.9;          // of the derivative along the direction, or 1 - alpha/2: a trial that leaves less passes
    int most_grown = 3;  // trials whose correction grows that are taken for their derivative: more go round in a circle
    // |correction|/|direction| up to which a descent is enough for a projected Hessian; 5 does no better
    double most_descending = 2;
    double contact_power = 2.5;       // of the depth in the force of contacts that begin: Hertz 3/2 and more; 2 to 3 alike
    double same_growth = 0.05;        // of correction and derivative per share at two trials; 0.1 ends directions that lead on
    double shortest_cut = 0.1, longest_cut = 0.5;  // of a trial that fails, for the next one
    double least_into_valley = 0.1;   // of a direction whose trial is shortened into a valley

    // ends
    double located = 1e-6;            // of the wire's radius (half a nanometre): a position known to within this is known
    double force_jump = 1e-3;         // of the largest contact force: more than this is a jump, no rounding
    int most_jumps = 8;               // facets passed in one solve
    double same_residual = 5e-3;      // relative, of a base that comes again in a circle of two or four
    int most_same = 6;                // such bases in a row; fewer end searches of long steps that would come out of it
    double improvement = 0.5;         // of the residual, that an iteration must leave less than to go on within rounding

    // directions (direction.h)
    int most_chord_steps = 4;
    double chord_contraction = 0.3;   // of a chord step by the one before it: those that shrink less do not pay
    double chord_enough = 0.5;        // of the tolerances, at which chord steps end
    double kept_contraction = 0.03;   // by which corrections with kept factors must shrink
    double new_contraction = 1.0 / 300;  // by which they shrink with new factors, about
    int most_kept = 3;                // iterations after which a step is none of those that go well
    int projected_in_a_row = 3;       // full steps with the projected Hessian; then the exact one, by LU
    int most_shifts = 12;             // raises, each by 4, until the exact matrix is positive definite
    double smallest_shift = 1e-3, largest_shift = 1e15;  // [-] of the weights; below there is none, above nothing moves
    double pseudo_time_growth = 0.7;  // of the shift, a step of pseudo-time
    int most_perturbations = 3;       // along the softest mode, in one solve
    double perturbation = 0.01;       // of an edge [-]
};

inline constexpr NewtonConstants newton_constants;

}  // namespace seldinger

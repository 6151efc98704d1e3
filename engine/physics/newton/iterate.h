#pragma once
// Where Newton's method is in one system: what its classes read and write. The driver (newton_system.h) makes it anew for each
// solve.

#include "newton/options.h"
#include "solve/force_term.h"

#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace seldinger {

struct NewtonIterate {
    enum class Phase { Guess, Search, Done, Failed };

    // of the whole solve; written by the driver, which settles also where a class asks for it
    struct Course {
        bool settling = false;    // taking the best trial instead of failing
        bool non_finite = false;  // the last evaluation was
        bool due = false, cut_short = false;
        bool rounded = false;  // settling at a base that is balanced
        int iterations = 0, first_iteration = 0;  // the latter: after which multipliers were renewed
        double residual_shares[2] = {};           // of the last two bases
        int same_again = 0;                       // bases in a row whose residual was that of the one before the last
        int evaluations = 0, backtracks = 0, mode_perturbations = 0, jumps_passed = 0, times_grown = 0;
        double move_limit = std::numeric_limits<double>::infinity();  // of a node in one update [m]
        double guess_fraction = 1;                                    // of `guess`, that the trial has moved by
    };
    // of the last trial that was taken; written by the driver
    struct Base {
        double residual_share = 0;  // of the tolerance
        bool can_be_state = false, balanced = false;
    };
    // of the direction from the base; written by NewtonDirection, NewtonAcceptance and NewtonKinks
    struct Along {
        double alpha = 1, first_alpha = 1;  // of the present and of the first trial on it
        double norm = 0, slope = 0;         // slope: R . direction at the base
        bool into_valley = false;           // the trial was shortened
        bool admits = false;                // the direction is that of a residual with the forces of valleys: Valleys::admit
        bool redirected = false;            // the trial has been, to the balance of the kinks: `correction` is what this changed
        KinksPassed before_redirection;
        // per share, at the last trial on it that failed: by how much the correction grows, and the derivative along it
        std::optional<double> growth, slope_growth;
    };
    // of the present trial; written by the driver and NewtonAcceptance
    struct Trial {
        KinksPassed crossed;
        std::optional<double> contraction;  // `correction` is the trial's, and so much of the direction; none: not asked for
    };

    /// @param unknowns  at most
    explicit NewtonIterate(int unknowns)
    {
        for (auto* array : {&base_q, &base_residual, &direction, &correction, &guess})
            array->resize(static_cast<std::size_t>(unknowns));
    }
    /// A new solve.
    void start(const NewtonOptions& of_solve)
    {
        options = of_solve;
        course = {}, along = {}, base = {}, trial = {};
        phase = Phase::Guess;
    }
    [[nodiscard]] bool searching() const { return phase == Phase::Search; }
    /// Iterations since multipliers were renewed.
    [[nodiscard]] int iterations() const { return course.iterations - course.first_iteration; }

    NewtonOptions options;
    Phase phase = Phase::Done;
    Course course;
    Base base;
    Along along;
    Trial trial;
    std::vector<double> base_q, base_residual, direction, correction, guess;  // [unknowns]
    std::span<double> scratch;                                                // [unknowns] in the workspace
};

}  // namespace seldinger

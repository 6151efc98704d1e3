#pragma once
// Where the contact force is not smooth: valleys and ridges of a faceted wall, and jumps of its nearest facet.
//
// A contact that goes over a valley, from facet to facet, leaves its curvature's sight. Where a trial has, the direction from it
// leads to the valley (contact/valleys.h). Where the step's first trial fails for that, all its valleys are balanced together
// first (kink_balance.h). In later iterations balances would lead from one kink to the next, and round in a circle.

#include "newton/direction.h"

namespace seldinger {

class NewtonKinks {
public:
    enum class Jump { None, Turns, Passed };

    /// @param problem, iterate, direction  outlive this
    NewtonKinks(SystemProblem& problem, NewtonIterate& iterate, NewtonDirection& direction)
        : problem_(problem), at_(iterate), direction_(direction)
    {
    }

    /// Sets a trial where all kinks are balanced that the step's first one has gone over. @return whether it has
    [[nodiscard]] bool balance(const ForceTerms& terms);
    /// The balance leaves more than the base: the direction is again as it was.
    void take_back();
    /// Whether the nearest facets of the wall have changed within a position that is known, and the force with them.
    [[nodiscard]] Jump jump_of_force(const ForceTerms& terms);
    /// Whether the position is known as well as it can be, although the equations do not hold.
    [[nodiscard]] bool at_kink() const;

private:
    [[nodiscard]] std::span<double> part(std::span<double> v) const { return v.first(static_cast<std::size_t>(problem_.size())); }

    SystemProblem& problem_;
    NewtonIterate& at_;
    NewtonDirection& direction_;
};

}  // namespace seldinger

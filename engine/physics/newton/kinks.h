#pragma once
// Where the contact force is not smooth: valleys and ridges of a faceted wall, and jumps of its nearest facet.
//
// A contact that goes over a valley, from facet to facet, leaves its curvature's sight. Where a trial has, the direction from it
// leads to the valley (contact/valleys.h). Where the step's first trial fails for that, all its valleys are balanced together
// first (kinks.h). In later iterations balances would lead from one kink to the next, and round in a circle.

#include "newton/direction.h"
#include "solve/force_term.h"

#include <array>
#include <span>

namespace seldinger {

// All kinks of the wall that a Newton direction has gone over, balanced together.
//
// At a kink a force of size f turns from f n_a to f (n_a - z w), w = n_a - n_b, with the share z of the second facet
// (contact/valleys.h, whose z is the share of the first)
//
//     z = (rest + y) / width  within 0 ... 1,     y = w . move of the wire's axis there.
//
// The tangent A of the base knows the first facet alone. With the forces p_k = f_k z_k across the kinks and rows V_k, which have
// w_k on the two nodes of an edge, the balance is
//
//     A d' = -R - sum_k V_k p_k    =>    y = V^T d - C p,    C = V^T A^-1 V,    d = -A^-1 R :
//
// a complementarity problem between bounds with as many unknowns as kinks, solved by projected Gauss-Seidel sweeps. Factors are
// those of the direction, and C takes one solution with them for each kink.

struct KinkBalance {
    static constexpr int most = 16;
    struct Met {
        Kink kink;
        int first;         // unknown of its wire
        double free_move;  // w . d there [m]
        double force = 0;  // p [N]
    };

    /// w . x where the contact is.
    [[nodiscard]] static double along(const Met& met, std::span<const double> x);
    /// x += scale V
    static void add(const Met& met, double scale, std::span<double> x);
    /// Solves for the forces.
    void solve();

    int count = 0;
    std::array<Met, most> met;
    std::array<double, most * most> compliance;  // C, in rows of `most` [m/N]
};

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

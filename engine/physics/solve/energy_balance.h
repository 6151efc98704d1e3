#pragma once
// Checks whether a wire has more energy than was ever supplied.
//
// B = kinetic + elastic + gravitational - work done on the wire - what fed material brought in. With V the energy that contact
// springs hold, B + V can only fall: dashpots, sliding and dissipative integrators take from it, nothing adds to it. V is known
// within 0 <= V <= S only, so that
//
//   made(t) = max(0, B(t) - min over s < t of (B(s) + S(s)))
//
// is a lower bound of the energy that no work accounts for. It is compared with the error that the scheme may make. No scheme
// keeps the energy of a nonlinear system exactly. A step of backward Euler may end where the potential is concave, as when a
// column buckles or a tip snaps. It then generates (1/2) d.(-H) d, with the concave part H of the Hessian and the move d. The
// trapezoid misses third order terms of either sign. Such errors are a share of the energy that the motion exchanges. A step
// makes too much when
//
//   min(made, kinetic) > fraction * (turned over + released) + floor + unseen + rounding
//
// turned over: kinetic at the start and |work|, summed; released: the largest fall of the stored energy, which a wire that was
// placed bent turns over without any work. Generated energy counts as far as it shows as kinetic energy. Forces at the ends of
// steps give the hand's work only to a fraction of the wire's stored energy, but where nothing moves, nothing grows. `unseen` is
// the work that a hand may have done between the ends of steps (see EnergyInput), `rounding` 1e-9 of the terms.

#include <algorithm>
#include <cmath>

namespace seldinger {

struct WireEnergy {
    double kinetic = 0, stored = 0;  // stored: elastic and gravitational [J]
    double contact = 0;              // S, the most that contact may give back [J]
    [[nodiscard]] bool finite() const { return std::isfinite(kinetic + stored + contact); }
};

/// Energy input of one step or sub-step.
struct EnergyInput {
    double work = 0;     // done on the wire by hands, holds, loads and links [J]
    double carried = 0;  // brought in by material that was fed [J]
    double unseen = 0;   // that forces at the ends of the step may not show: a hand that changes its speed from v0 to v within
                         // the step does up to m |v^2 - v0^2| (an inelastic jerk) [J]
};

struct EnergyLimits {
    double fraction = 0.10;  // of the energy turned over [-]
    double floor = 1e-6;     // [J]
};

class EnergyBalance {
public:
    /// Energies are counted from here.
    void begin(const WireEnergy& now);
    /// The end of a step before which the energies were not known: they are counted from its end.
    void begin_after(const WireEnergy& now, const EnergyInput& input);
    /// The end of a step. @return false: the wire has more energy than it was given
    [[nodiscard]] bool take_in(const WireEnergy& now, const EnergyInput& input, const EnergyLimits& limits);
    /// Most energy that came from nowhere so far [J].
    [[nodiscard]] double made() const { return most_made_; }

private:
    void account(const WireEnergy& now, const EnergyInput& input);
    [[nodiscard]] double own(const WireEnergy& now) const { return now.stored - carried_; }  // wherever heights are counted from

    double work_ = 0, carried_ = 0, unseen_ = 0, turned_over_ = 0, least_ = 0, most_stored_ = 0, most_released_ = 0,
           most_made_ = 0;
};

}  // namespace seldinger

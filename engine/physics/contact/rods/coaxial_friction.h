#pragma once
// Friction between instruments that share a centreline (D12), a force term on the host. The law: contact/rods/coaxial_slip.h.
//
// Where two neighbours k (outer) and l (inner) overlap, their surfaces slip by
//
//     u = (advance_l - advance_k, r (theta_l - theta_k))            along and around, r the inner one's radius,
//
// each the change over the step. Both advances are the hands' and known, so axial slip is the same everywhere. The axial force, +
// on one and - on the other, is no force on the line but one between the hands (merged_read.cpp). Around it is a couple
// between the two spins. Slip leaves out the turn of a twisted instrument as it slides, r theta' of its way, on both sides of the
// work as it leaves out 1 + kappa r at a bend.
//
// **Cells** as long as the line's shortest edge are fixed in the outer one's material and remember the elastic slip of the part
// of them that is in an overlap; what leaves it forgets. So nothing of it depends on the line's nodes, which come, go and change
// their leader. A cell turns by the mean of the edges' angles over its part, and its couple goes to these edges by the same
// weights. So work and tangent are those of one function of the angles, and forces do not jump as material passes a node.
//
// **Where the lumen presses**, friction is also mu times the force between the two. Without clearance that has no bound. The
// instruments' own clearance bounds it, from their moments in the last accepted state (rod/lumen_press.h, places a cell apart).
// In the step it is known, as the wall's friction is not: it lags by one step. With three instruments and more, all outside the
// lumen bend as one, and all inside it. An inner instrument under a tension T presses by T kappa round a bend. T sums all that
// holds it back between its tip and there; outside pulls act beyond the mouth by these sums.

#include "contact/rods/coaxial_slip.h"
#include "rod/coaxial_moment.h"
#include "rod/lumen_press.h"
#include "solve/coaxial_group.h"
#include "solve/force_term.h"

#include <vector>

namespace seldinger {

struct CoaxialFrictionSpec {
    double drag = 0;                       // dry friction per length [N/m]
    double viscous = 0;                    // [N s/m per m]
    double mu_static = 0, mu_sliding = 0;  // of what presses; 0: none is looked for
    [[nodiscard]] bool pressed() const { return mu_static > 0; }
    [[nodiscard]] bool any() const { return drag > 0 || viscous > 0 || pressed(); }
};

class CoaxialFriction final : public ForceTerm {
public:
    explicit CoaxialFriction(RodArrays& rods) : rods_(rods), place_of_(static_cast<std::size_t>(rods.wire_count()))
    {
        // spins of instruments that share a centreline are never left out of a step, and those of others are not asked for
        traits_.follows_spins = traits_.may_jump = false;
    }
    /// Instruments of a group that rub; the group outlives this.  @param cell  length that remembers one slip [m]
    void add(CoaxialGroup& group, const CoaxialFrictionSpec& spec, double cell);
    [[nodiscard]] bool empty() const { return groups_.empty(); }

    void begin_step(RodArrays& /*rods*/, Settling how) override { stuck_ = how == Settling::Stuck; }
    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override;
    void evaluate(const TermTrial& trial) override;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) override;
    void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const override;
    void couple(const SystemUnknowns& system, std::span<double> residual, BandedSolver* tangent, bool symmetric) const override;
    void commit(std::span<const std::uint8_t> active) override;
    void walk_state(StateWalk& walk, int wire) override;

    /// What pulls at an instrument from outside in the accepted state, along the line, + towards the tip [N].
    void set_outside(int wire, double force);
    /// Force of the other instruments on this one along the line at the last evaluation, + towards the tip [N]. In a group they
    /// add up to 0.
    [[nodiscard]] double along(int wire) const;

private:
    /// Stretch of the line in which two are next to each other [m].
    struct Overlap {
        double begin = 0, end = 0;
        double offset = 0;   // of the outer one's material
        bool mouth = false;  // it begins at the outer one's tip, the inner one goes on
    };
    /// The part of a cell that is in the overlap now.
    struct Part {
        std::size_t cell = 0;
        double at = 0, length = 0, radius = 0;  // its middle on the line [m]
        double start = 0;               // angle between the two at the start of the step [rad]
        std::size_t first = 0;          // in `weights`: its edges, consecutive from `edge` on
        int edge = 0, count = 0;
        // of the last evaluation
        Vec2 elastic = Vec2::Zero();
        double along = 0;              // on the inner one [N]
        double couple = 0, slope = 0;  // on the inner one [N m], its fall with the angle [N m]
        bool slides = false;
    };
    struct Pair {
        int outer = 0, inner = 0;  // places in the group
        double cell = 0;           // [m]
        // accepted, [cells]: elastic slip, whether the last step slid; force that presses [N/m] and where that leaves the inner
        // one at the cell's tip end (LumenPress::off), both where mu is not 0
        std::vector<Vec2> elastic;
        std::vector<std::uint8_t> slid;
        std::vector<double> pressing;
        std::vector<LumenPress::Complex> off;
        std::vector<Part> parts;
        std::vector<double> weights;
        // last evaluation: force along on the inner instrument [N], work on both, recoverable work [J]
        double along = 0, work = 0, stored = 0;
    };
    struct Group {
        CoaxialGroup* shared = nullptr;
        CoaxialFrictionSpec spec;
        std::vector<Pair> pairs;
        std::array<double, most_coaxial> outside{};  // accepted; of each instrument, where the lumen presses [N]
        RodFrames frames;  // scratch
        CoaxialMoments moments;
    };
    struct Place {
        int group = -1, member = 0;
    };

    [[nodiscard]] Place place_of(int wire) const { return place_of_[static_cast<std::size_t>(wire)]; }
    [[nodiscard]] const Group* led_by(int line) const;
    [[nodiscard]] Overlap overlap_of(const Group& group, const Pair& pair);
    void find_parts(Group& group, Pair& pair);
    void add_part(const Group& group, Pair& pair, std::size_t cell, double from, double to, int& edge);
    void evaluate(const Group& group, Pair& pair, const TrialState& trial, double rate);
    static void add_coupling(const Group& group, const Pair& pair, const SystemUnknowns& system, BandedSolver& tangent);
    // coaxial_press.cpp
    void find_pressing(Group& group);
    void find_pressing(const Group& group, const CoaxialTrial& now, Pair& pair);
    void set_lateral(const Group& group, const Pair& pair, const Overlap& overlap, int first);
    [[nodiscard]] LumenPress::Place place_at(const Group& group, const CoaxialTrial& now, const Pair& pair,
                                             const Overlap& overlap, double s);
    [[nodiscard]] LumenPress::End end_of(const Group& group, const CoaxialTrial& now, const Pair& pair, const Overlap& overlap);

    RodArrays& rods_;
    LumenPress press_;             // scratch
    std::vector<double> tension_;  // likewise, at its places [N]
    std::vector<Group> groups_;
    std::vector<Place> place_of_;  // [wires]
    bool stuck_ = false;
};

}  // namespace seldinger

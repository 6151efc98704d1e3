#pragma once
// Forces that the program gives (solve/force.h) as one force term.
//
// A point of edge e = x_{j+1} - x_j, of length L and tangent t (tip -> hub), has x = (1 - b) x_j + b x_{j+1} and a frame that
// turns by dphi = t x de/L + t (dtheta - kb.de/2L): directors come from those of t_0 by parallel transport, and what that turns
// about t is half of kb = 2 t_0 x t/(1 + t_0.t). G = d(x, phi)/dq, q = (x_j, x_{j+1}, theta_j), c = (m x t - (m.t) kb/2)/L:
//
//     Q = G^T (f, m):   (1 - b) f - c,   b f + c,   m.t
//     dQ/dq = G^T (K + C/h) G + (dG^T/dq)(f, m),   d(m.t)/de = (m - (m.t) t)/L
//     dc/de = [m]x (1 - 2 t t^T)/L^2 - (m.t) [t_0]x (1 - t t^T)/((1 + t_0.t) L^2), but for terms with kb
//
// since v and omega are means over the step, (x - x_0)/h. One linearised step takes (f, m) - C (v, omega) at its start: v and
// omega are 0 where nothing has moved. Work on the wire is Q.(q - q_0), with Q at the end of the step, at its start (explicit),
// or the mean of both, as the scheme has its forces (energy_audit.h).

#include "solve/coaxial_group.h"
#include "solve/force.h"
#include "solve/force_term.h"
#include "solve/solve_spec.h"

#include <exception>
#include <functional>
#include <memory>
#include <span>

namespace seldinger {

class GivenForces final : public ForceTerm {
public:
    GivenForces(RodArrays& rods, const IntegratorSpec& spec);
    /// @param group  that the wire shares a centreline in, as its `member`; null: alone. It outlives this
    void add(int wire, std::shared_ptr<const Force> force, const CoaxialGroup* group, int member);
    /// What a force throws ends its part in the step: kept here, and thrown by raise().
    [[nodiscard]] bool raised() const { return raised_ != nullptr; }
    void raise();
    /// The end of a sub-step: what commit() will take.
    void conclude(std::span<const std::uint8_t> active);
    /// Of the next evaluations: time at the end, length (0: an equilibrium) [s].
    void set_time(int wire, double time, double dt);
    using SensorReader = std::function<void(const Force& sensor, std::span<const double> numbers)>;
    void read_sensors(int wire, const SensorReader& read) const;

    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override;
    void evaluate(const TermTrial& trial) override;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) override;
    void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const override;
    void commit(std::span<const std::uint8_t> active) override;
    void walk_state(StateWalk& walk, int wire) override;

    /// On an instrument along its edges, + towards the tip [N].
    [[nodiscard]] double along(int wire) const;
    /// Potential energy in the accepted state, of forces that tell it [J].
    [[nodiscard]] double energy(int wire) const;

private:
    static constexpr int unknowns = 7;  // of an edge: two nodes, the spin
    using Vector = std::array<double, unknowns>;
    struct Place {
        int edge = 0;
        double bary = 0;
        Vector before{};          // q_0
        Vector start{}, now{};    // Q there, and at the trial
        std::array<Vector, unknowns> tangent{};
    };
    /// Arrays of ForcePoints; e and t_0.
    struct Seen {
        std::vector<int> wire;
        std::vector<double> s, length;
        std::vector<Vec3> position, velocity, axis, director, turning, span, from;
    };
    struct Given {
        int wire = 0, member = 0;
        std::shared_ptr<const Force> force;
        const CoaxialGroup* group = nullptr;
        std::vector<double> state;
        double time = 0, dt = 0, energy = 0;
        std::vector<double> next_state;
        double next_energy = 0;
        std::vector<Place> places;
        Seen seen;
        std::vector<PointForce> on, near;  // what acts; scratch
        std::vector<PointTangent> tangents;
        bool unsymmetric = false, linearised = false;
    };
    struct Motion;

    void place(Given& given) const;
    void look(Given& given, const Motion& motion) const;
    static ForcePoints points(const Given& given);
    void finish(Given& given) const;
    void catch_all(const std::function<void()>& body);
    /// Asks `call_` in one call, and empties it.
    void ask_call(bool tangents);
    void put_in_call(Given& given, bool tangents);
    static void ask(const Given& given, std::vector<PointForce>& out);
    static void ask_tangents(Given& given);
    static void differences(Given& given);
    /// Q of a point, and its tangent unless null.
    static Vector act(const Given& given, std::size_t k, std::array<Vector, unknowns>* tangent);
    [[nodiscard]] Vector unknowns_of(const Given& given, const Place& place) const;

    RodArrays& rods_;
    double end_share_;  // in the work
    std::vector<Given> list_;
    std::vector<Given*> call_;  // what is asked together, with the points of all in one
    Given whole_;
    std::exception_ptr raised_;
};

}  // namespace seldinger

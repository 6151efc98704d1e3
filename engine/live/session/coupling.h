#pragma once
// The spring and damper between a hand and the hub of an instrument (D14), in one degree of freedom: advance or rotation.
//
//   f = k (x_hand - x) + b (v_hand - v)                                                                                     (D14)
//
// x is where the hub is. In a step of length T the hand goes from x_h to x_h', wherever its newest report says, and the hub by d:
//
//   f' = k (x_h' - x - d) + b (x_h' - x_h - d)/T  =  F_s + K_s d + M (d - d_before)
//
// On the right is the predicted response of the wire, as known at the step's start. F_s is its response at the end of the last
// step less its inertia. The response grows within a step by WireReadings::hand_stiffness, K_s + M. The part M = m/T^2, the
// inertia of the wire's own mass m, acts on changes of speed only. The equation is solved for d, and the world is stepped to x +
// d.
//
// Why it is passive. Both sides are taken at the end of the step. On the left, the hand's energy is exactly the sum of stored
// energy, work on the hub and loss:
//
//   f'(x_h' - x_h) = [k e'^2/2 - k e^2/2] + f' d + k (e' - e)^2/2 + b (e' - e)^2/T,      e = x_h - x
//
// and backward Euler does the same on the wire's side. The remainder is the difference between F' of the wire and the f'
// predicted for it. The observer counts that too, energy() = brought in - stored - work done on the wire. Should it fall below
// zero, the damper dissipates the difference in the following steps [Hannaford & Ryu, IEEE Trans. Robot. Autom. 18(1), 2002,
// doi:10.1109/70.988969].
//
// A hub that a force drives (D16) is pulled by the spring itself: f' = pull() - spring_of() d. The world solves for d together
// with its instrument, nothing is predicted, and the hand's energy is accounted for exactly.
//
// A device that holds the force for a time tau after it has measured its position, or gets it that much late, adds up to k tau/2
// + b of negative damping. Its friction and the hand's must exceed that [Colgate & Schenkel, J. Robot. Syst. 14(1), 1997,
// doi:10.1002/(SICI)1097-4563(199701)14:1<37::AID-ROB4>3.0.CO;2-V].

namespace seldinger {

/// Coupling of one degree of freedom: metres and newtons, or radians and newton metres.
struct CouplingSpec {
    double stiffness = 0;    // k [N/m]
    double damping = 0;      // b [N s/m]
    double speed_limit = 0;  // of the hub [m/s]
};

inline constexpr CouplingSpec advance_coupling{500.0, 1.0, 0.5};
inline constexpr CouplingSpec turn_coupling{0.02, 4e-5, 60.0};

/// How the force of the coupling falls with the way of the hub within a step [N/m].
[[nodiscard]] constexpr double spring_of(const CouplingSpec& spec, double step) { return spec.stiffness + spec.damping / step; }

/// What the instrument answers at its hub.
struct HubLoad {
    double force = 0;      // F at the end of the last step [N]
    double stiffness = 0;  // how it grows within a step: K_s + M [N/m]
    double mass = 0;       // of what moves with the hub [kg]
};

class Coupling {
public:
    Coupling(const CouplingSpec& spec, double step) : spec_(spec), step_(step) {}

    /// Where the hub is to be at the end of the next step, the hand having gone to `hand`.
    /// @param low, high  where the hub can be
    double next(double hand, const HubLoad& load, double low, double high);
    /// Of a driven hub: the force where it is, the hand having gone to `hand` in the next step [N]; falls by spring_of() a metre.
    double pull(double hand);
    /// In that step it has gone to `to`. @param stiffness  how its answer grows with that, its own inertia included [N/m]
    void pulled_to(double to, double stiffness);
    /// The step to there has been taken. @param force  what the instrument answered at its end
    void stepped(double force);
    /// Hand and hub are here and at rest, nothing is stored; the observer's sum continues.
    void place(double at);

    [[nodiscard]] double position() const { return hub_; }
    /// How far the hand is ahead of the hub [m].
    [[nodiscard]] double stretch() const { return stretch_; }
    /// Force of the hand on the hub, and so of the hub on the hand [N].
    [[nodiscard]] double force() const { return force_; }
    /// How the force of a step would grow with the hand farther on, at the same speed: d f'/d x_h' = k K/(k + b/T + K) [N/m].
    [[nodiscard]] double force_per_advance() const { return slope_; }
    /// Energy supplied by the hand so far, less the stored energy and the work on the instrument [J].
    [[nodiscard]] double energy() const { return brought_ - stored() - done_; }
    [[nodiscard]] double stored() const { return 0.5 * spec_.stiffness * stretch_ * stretch_; }
    /// The lowest that energy() has been [J].
    [[nodiscard]] double lowest_energy() const { return lowest_; }

private:
    [[nodiscard]] double damping() const;
    void go_to(double to, double damping, double slope);

    CouplingSpec spec_;
    double step_;
    double hand_ = 0, moved_by_hand_ = 0, hub_ = 0, moved_ = 0, moved_before_ = 0, stretch_ = 0, stretch_rate_ = 0;
    double force_ = 0, slope_ = 0;
    double brought_ = 0, done_ = 0, lowest_ = 0;
};

}  // namespace seldinger

#pragma once
// What the failure suite (docs/failures.md, F1 ... F17) has in common: the two methods that are compared, and a run that is
// watched step by step. The criteria are those of models/classify.h and, beside the engine's own readings, the exact distance of
// the axis to the wall.

#include "models/classify.h"

#include "support/world_fixture.h"
#include "vessel/inside.h"

#include <functional>
#include <memory>

namespace seldinger::test {

struct Method {
    const char* name;
    Scheme scheme;
    Detection detection;
    NormalLaw normal;
    FrictionLaw friction;
};

/// As published: one Newton step, the detection layer, Lankarani-Nikravesh damping, sgn(v).
inline constexpr Method published{"published", Scheme::Linearised, Detection::Layer, NormalLaw::LankaraniNikravesh,
                                  FrictionLaw::Sign};
inline constexpr Method standard{"default", Scheme::Newton, Detection::Swept, NormalLaw::HuntCrossley, FrictionLaw::StickSlip};

/// Single pieces of the published method beside the rest of the default, where a row of the table is about that piece alone.
inline constexpr Method one_newton_step{"one Newton step", Scheme::Linearised, Detection::Swept, NormalLaw::HuntCrossley,
                                        FrictionLaw::StickSlip};
inline constexpr Method at_nodes{"contact at nodes", Scheme::Newton, Detection::Nodes, NormalLaw::HuntCrossley,
                                 FrictionLaw::StickSlip};
inline constexpr Method explicit_steps{"explicit", Scheme::Explicit, Detection::Swept, NormalLaw::HuntCrossley,
                                       FrictionLaw::StickSlip};

void use(TestSetup& setup, const Method& method);

/// What a run came to: the verdict per wire, and what the fixture measured itself. Distances are to the wall where it is:
/// beside an elastic one the lumen is made anew for each check. What such a wall gives back is work on the wire.
struct Outcomes {
    std::vector<Verdict> wires;
    double nearest = 1;    // least signed distance of any point of any axis to the wall, openings left aside [m]; < 0: outside
    double friction = 0;   // largest sum [N]
    double normal = 0;     // largest sum [N]
    long halved = 0;       // steps that were
    long far = 0;          // steps in which an elastic wall has gone farther than its theory is good for
    double wall_move = 0;  // farthest that it was found to have gone [m]
    int contacts = 0;      // most
    WireReadings end;      // of wire 0
    [[nodiscard]] const Verdict& verdict() const { return wires[0]; }
    [[nodiscard]] Outcome outcome() const;  // the worst wire's; an axis point found outside is an escape
};

class WatchedRun {
public:
    /// @param static_indentation  see FailureLimits; infinity where nothing static presses
    WatchedRun(TestSetup setup, const Method& method, double dt, double static_indentation = INFINITY);

    /// @param each  after every step; returns false to end the run
    void run(int steps, const std::function<bool(FedWorld&)>& each = {});
    /// Work that the scene's loads, links or moving holds have done on wire 0 in the step just taken [J]; asked after every step.
    std::function<double(FedWorld&)> work;

    [[nodiscard]] Outcomes outcomes() const;
    FedWorld world;

private:
    void audit();
    void follow_wall();
    [[nodiscard]] double work_of_wall(int wire);
    [[nodiscard]] WireReadings at_start(int wire);

    double dt_;
    std::vector<FailureWatch> watches_;
    std::vector<double> inserted_;
    std::vector<double> wall_work_;  // [wires] done on the wall up to the last step [J]
    std::unique_ptr<LumenQuery> lumen_;
    Outcomes seen_;
    long steps_ = 0;
};

[[nodiscard]] Outcomes watch(TestSetup setup, const Method& method, double dt, int steps, double static_indentation = INFINITY);

/// One line: outcome, first steps of each failure, measured numbers.
[[nodiscard]] std::string tell(const Outcomes& outcomes);

/// Runs, a linearised method until it jams, and says what came of it, for docs/failures.md. @param row  of docs/failures.md, "F1"
[[nodiscard]] Outcomes watch_row(const char* row, const TestSetup& setup, const Method& method, double dt, int steps);

/// Makes the run count the work of a base that is turned, `angle` rad in each of the first `steps` steps, by the trapezoid as
/// RunWatch does.
void count_turning(WatchedRun& run, double angle, long steps);

/// Wall whose bed is `factor` times as stiff as the nominal 1 MPa one.
inline void stiffen_wall(TestSetup& setup, double factor) { setup.vessel.youngs *= factor; }

}  // namespace seldinger::test

#pragma once
// Keeps the score sheet of a world that is stepped: for a live session and for its replay, which so end with the same sheet.

#include "engine.h"
#include "session/score.h"

#include <vector>

namespace seldinger {

/// Instruments of the first system of a world made from this that a hand can hold: those that are fed.
[[nodiscard]] std::vector<int> live_instruments(const WorldSetup& setup);

class ScoreWatch {
public:
    /// @throws Error BadScene: a task that the vessel has not
    ScoreWatch(const Scene& scene, const World& world);

    /// The world is where a session begins, at first or after a reset.
    void begin(const World& world);
    /// A step of dt [s] has been taken. Allocates nothing once it has been called.
    void stepped(const World& world, double dt, bool fluoroscopy, bool contrast);
    [[nodiscard]] const Scorer& scorer() const { return scorer_; }

private:
    Scorer scorer_;
    std::vector<int> fed_;  // the first one's tip is the one that is to go somewhere
    double inserted_ = 0;   // of the first, before the step [m]
    Output contacts_;
};

}  // namespace seldinger

#pragma once
// A recorded live session as the controller of a run: what every hub was asked, step by step, and where the session was reset.

#include "session/score.h"
#include "session/session_record.h"

#include <filesystem>
#include <optional>

namespace seldinger::apps {

class Replay {
public:
    /// @throws Error BadFile: no record, or one without a step
    explicit Replay(const std::filesystem::path& record);

    /// The scene with the record's step and length.
    [[nodiscard]] Scene scene(Scene of_session) const;
    /// @throws Error BadScene: of another scene, vessel or version
    void check(const Scene& scene, const WorldSetup& setup) const;
    /// Before the first step, of the world as it starts.
    void begin(const Scene& scene, const World& world);
    [[nodiscard]] bool begun() const { return watch_.has_value(); }
    [[nodiscard]] const ScoreNumbers& score() const { return score_; }
    /// Input of the next step; takes the world back to its start where the session was reset.
    [[nodiscard]] const Control& next(World& world);
    /// The step that was asked has been taken.
    void stepped(const World& world);
    /// After the last step.
    void end(World& world) { take_resets(world); }
    /// Writes the sheet that the session was scored with beside the run: score.json, score.html.
    void write_score(const Scene& scene, const std::filesystem::path& dir) const;

private:
    void take_resets(World& world);
    std::filesystem::path path_;
    SessionRecord record_;
    std::size_t at_ = 0;
    std::vector<std::uint8_t> initial_;
    Control control_;
    std::optional<ScoreWatch> watch_;
    ScoreNumbers score_;
};

}  // namespace seldinger::apps

#pragma once
// A recorded live session as the controller of a run: what every hub was asked, step by step, and where the session was reset.

#include "session/session_record.h"

#include <filesystem>

namespace seldinger::apps {

class Replay {
public:
    /// @throws Error BadFile: no record, or one without a step
    explicit Replay(const std::filesystem::path& record);

    /// The scene with the record's step and length.
    [[nodiscard]] Scene scene(Scene of_session) const;
    /// Before the first step, of the world as it starts. @throws Error BadScene: of another scene, vessel or version
    void begin(const Scene& scene, const World& world);
    /// What is asked in the next step; takes the world back to its start where the session was reset.
    [[nodiscard]] const Control& next(World& world);
    /// After the last step.
    void end(World& world) { take_resets(world); }

private:
    void take_resets(World& world);
    std::filesystem::path path_;
    SessionRecord record_;
    std::size_t at_ = 0;
    std::vector<std::uint8_t> initial_;
    Control control_;
};

}  // namespace seldinger::apps

#pragma once
// Writes what a program steps into a folder, as `seldinger run` does. The command, Python and the component `pictures` read it.
//
//     const seldinger::LoadedScene scene = seldinger::load_scene("aortic-arch");
//     seldinger::World world(scene.setup);
//     seldinger::Recording recording(scene, world, "out");
//     while (world.time() < scene.duration) recording.stepped(world, step(world, control, scene.dt));
//     recording.finish(world);

#include "engine.h"

#include <filesystem>
#include <memory>
#include <string>

namespace seldinger {

class Recording {
public:
    /// Begins a run in `dir`. @param world  of scene.setup, before its first step; outlives the recording  @param overwrite  a
    /// run that is there already
    /// @throws Error BadFile, BadScene
    Recording(const LoadedScene& scene, const World& world, const std::filesystem::path& dir, bool overwrite = false);
    ~Recording();
    Recording(Recording&&) noexcept;
    Recording& operator=(Recording&&) noexcept;

    /// After settle(), where the world begins with it.
    void settled(const World& world, const StepReport& report);
    /// After every step of scene.dt that has not failed. @param seconds  that it took, for step_ms
    /// @throws Error BadScene: a step of another length, one that failed
    void stepped(const World& world, const StepReport& report, double seconds = 0);
    /// How the scene's [task] goes; "free" and nothing else without one.
    [[nodiscard]] TaskProgress task() const;
    /// Writes tables, lists of frames and the summary. @return summary.json
    std::string finish(const World& world);

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace seldinger

#pragma once
// Many runs of one scene. Runs whose scenes share vessel, time step and schemes are systems of one World. They are stepped in
// lockstep, with one launch per stage for all. Other runs get worlds of their own, one after the other. A run's bits are those
// of the run alone.

#include "bands/grid_error.h"
#include "batch/batch_keep.h"
#include "batch/batch_table.h"
#include "core/bytes.h"
#include "run/scene_run.h"
#include "setup/vessel_load.h"

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace seldinger {

/// Where the scenes of a batch come from.
struct BatchSource {
    std::string scene_text;
    std::filesystem::path scene_file;
    std::vector<std::string> overrides;  // of --set, before the sweep's
    Sweep sweep;
    bool bands = false;  // each run a second time with half the step: items run_count() to 2 run_count()
    std::int64_t seed = 0;  // of the sweep's draws

    /// Runs to compute. An item below sweep.run_count() is that run of the sweep.
    [[nodiscard]] std::size_t item_count() const { return (bands ? 2 : 1) * sweep.run_count(); }
    /// The scene of one item. @throws Error that names the sweep's line and the run
    [[nodiscard]] Scene scene(std::size_t item) const;
    /// What the table of the batch has: plan_worlds() holds all runs to the first one's instruments.
    [[nodiscard]] BatchLayout layout() const;
};

/// @param sweep_file  names the sweep in messages  @throws Error
[[nodiscard]] BatchSource make_source(std::string scene_text, const std::filesystem::path& scene_file,
                                      std::vector<std::string> overrides, const std::string& sweep_text,
                                      const std::filesystem::path& sweep_file);

/// The part that two scenes must share to be systems of one world, as text. Left out are the wire, its holds and feed, and the
/// numbers of contact that are kept per sample or edge. `first` gives the parts that may differ.
[[nodiscard]] std::string shared_part(Scene scene, const Scene& first);

/// What tells apart the worlds of several scenes: shared_part(). Scenes with an elastic wall whose edge is chosen are alone, each
/// with its number.
[[nodiscard]] std::string world_kind(Scene scene, const Scene& first, std::size_t number);

inline constexpr std::size_t most_wires = 96;  // of a world; the records of more do not fit a core's caches: 10 % slower at 1,000

/// Reads the scene of every run, so that a mistake in any of them comes before the first step. Sorts them into worlds of at
/// most `most_wires`: runs in increasing order, worlds by their first run. Runs with an elastic wall whose edge is chosen are
/// alone.
/// @param begin,end  only these runs   @param warnings  out, may be null: those of the scenes, each once, with the runs that it
/// is of
/// @param ramp  the first world of a kind has one run, each later one twice as many as the one before. So a batch that a limit
/// stops has a good third of its work as finished runs
[[nodiscard]] std::vector<std::vector<std::size_t>> plan_worlds(const BatchSource& source, std::size_t begin = 0,
                                                                std::size_t end = std::numeric_limits<std::size_t>::max(),
                                                                bool ramp = false, std::vector<std::string>* warnings = nullptr);

/// One world of a batch and how its systems fare.
class BatchWorld : RunHooks {
public:
    BatchWorld(const BatchSource& source, std::span<const std::size_t> runs, LoadedVessel vessel, int device);

    /// One step of every run that is not finished (the first settles, where the scene asks for it). @return rows of those that
    /// ended
    std::vector<BatchRow> step();
    /// Files of runs that have ended since the last call, where the scene keeps any.
    [[nodiscard]] KeptFiles take_kept() { return std::exchange(kept_, {}); }
    [[nodiscard]] bool finished() const { return running() == 0; }
    [[nodiscard]] std::size_t running() const { return static_cast<std::size_t>(loop_->running()); }
    [[nodiscard]] long step_count() const { return world_->step_count(); }
    [[nodiscard]] long steps_in_all() const { return scene_.steps(); }
    [[nodiscard]] const StageTimes& stages() const { return stages_; }  // sums since construction [s]
    [[nodiscard]] const World& world() const { return *world_; }

    void save(std::vector<std::uint8_t>& bytes) const;
    void restore(const std::uint8_t*& at, const std::uint8_t* end);

private:
    struct Run {
        std::int64_t index = 0;
        RunTally tally;
        std::string trace;  // of output.keep_traces
    };
    void settled(int system, const WireReport& report) override;
    bool stepped(int system, const WireReport& report, double dt) override;
    void ended(int system, RunStatus status) override;
    void begin();
    void take_loads(int system);
    void take_greatest_loads(int system);
    void take_wall(int system, unsigned parts);
    void keep_row(int system);
    void keep_files(int system);

    void follow_tips(int system);

    Scene scene_;            // of the first run: what they share
    std::vector<Run> runs_;  // in the order of the world's systems
    std::unique_ptr<World> world_;
    std::optional<SceneRun> loop_;
    std::vector<BatchRow> rows_;  // of the systems that have ended in this step
    VesselPlaces places_;
    std::vector<Vec3> tips_;  // scratch of follow_tips
    std::int64_t sweep_runs_ = 0;  // later items are of half the step, and nothing is kept of them
    KeptFiles kept_;
    std::optional<ScoreWatch> score_;  // of [task]
    StageTimes stages_;
    Output loads_;  // contacts of the step
    std::vector<WireOutput> greatest_;  // scratch of take_greatest_loads
    long loads_read_at_ = -1;
    Output wall_;  // of the step
    GridErrorGauge gauge_;
    long wall_read_at_ = -1;
};

/// All worlds of a batch, one after the other. @param progress  may be empty; called every few steps with the number of rows
[[nodiscard]] std::vector<BatchRow> run_all(const BatchSource& source, int device,
                                            const std::function<void(std::size_t)>& progress);

}  // namespace seldinger

#pragma once
// Everything that `seldinger run` writes into its folder (docs/command-line.md): the tables, the ParaView series, the summary and
// the checkpoint. It records Output, which is read from the world between steps.
//
// Frames are named after their step (wire_000120.vtp), so that a resumed run writes the same files again. Rows of trace.csv hold
// the accepted state of their step; newton, flags and step_ms are the worst, the union and the mean since the row before. With
// [[instrument]] tables, trace.csv reads all instruments as one (joint_readings.h); trace_NAME.csv, NAME.csv and the series
// NAME.pvd show each one alone. Sensors (Force::record) that the world has when the run begins have sensor_NAME.csv.

#include "bands/grid_error.h"
#include "core/file_io.h"
#include "record/checkpoint.h"
#include "run/closed_ends.h"

#include <filesystem>
#include <string>

namespace seldinger {

/// What to do about a folder that holds a run already.
enum class FolderUse { Refuse, Overwrite, Resume };

/// Whether any of a run's own files is there.
[[nodiscard]] bool holds_a_run(const Folder& dir);

/// Removes a run's own files. @throws Error BadFile
void remove_old_run(const Folder& dir);

/// Before anything is loaded. @throws Error BadScene when `dir` holds a run and `use` is Refuse, when the run that is to be
/// resumed began with another scene, or when the scene file itself would be overwritten
void check_run_folder(const std::filesystem::path& dir, FolderUse use, const Scene& scene);

class Recorder {
public:
    /// Starts a new run in `dir`, whose old run, if any, is removed. @throws Error BadFile
    Recorder(const Scene& scene, const RepairReport& vessel, const World& world, std::filesystem::path dir);

    /// Resumes at `checkpoint`: restores the world and cuts later output. @throws Error BadFile
    Recorder(const Scene& scene, const RepairReport& vessel, World& world, std::filesystem::path dir,
             const Checkpoint& checkpoint);

    /// Before readings of an elastic wall are taken in: the error of its load by the wire's nodes, if one is the largest so far.
    /// It is found for each per cent that the largest grows by; in between it is that of the last one, as a share.
    void gauge(const World& world, const Output& now);
    /// At an intermediate equilibrium of a static run: takes its readings in, and writes a row. @param now  Output::Everything
    void passed(const Output& now);
    /// After settle(): takes its readings in, and writes row 0. @param now  Output::Everything
    void settled(const Output& now, const StepReport& report);
    /// Where settle() found nothing: the frame of the wires as they were placed. @param now  Output::Everything
    void placed(const Output& now);
    /// What the record of the step that the world has just taken needs, of Output::Parts.
    [[nodiscard]] unsigned wants(const World& world) const;
    /// After an accepted step. @param now  of the parts that were wanted  @param seconds  that the step took
    /// @param rest_steps  SceneRun::rest_steps, from which a saved run resumes
    void stepped(const Output& now, const StepReport& report, double seconds, long rest_steps = 0);

    /// After a step, or where the task begins: what the task has come to.
    void scored(const ScoreNumbers& score) { tally_.score = score; }

    /// Saves where the run stands. @param wall  of the loop so far [s]
    void checkpoint(const World& world, RunStatus status, double wall);
    /// Writes final tables, summary and, unless the simulation failed, the checkpoint. @return the summary
    std::string finish(const World& world, RunStatus status, double wall);

    [[nodiscard]] const RunTally& tally() const { return tally_; }
    [[nodiscard]] const WireReadings& readings() const { return readings_; }
    void estimated(const ErrorEstimate& estimate) { estimate_ = estimate; }
    void warn(const std::string& sentence) { warnings_.push_back(sentence); }

private:
    void forget_lost_frames();
    void take_in(const Output& now, const StepReport& report, double dt);
    [[nodiscard]] bool may_bear_most(const World& world) const;
    void take_greatest(const Output& now);
    void begin_traces(const World& world, const std::vector<std::uint64_t>& kept);
    void write_samples(const Output& now);
    void write_row(const Output& now);
    [[nodiscard]] std::string row_of(const WireReadings& r, const WireOutput& wire, const Output& now,
                                     const std::string& contact);
    void write_wire_frame(const Output& now);
    void write_contact_frame(const Output& now);
    void write_collections();
    void write_shapes();
    [[nodiscard]] unsigned frame_parts() const;
    [[nodiscard]] std::string wall_fields(const Output& now);
    [[nodiscard]] std::string energy_fields(const EnergyLedger& ledger);
    [[nodiscard]] std::string patch_fields(double area, double pressure);
    [[nodiscard]] std::string along_fields(const ContactAlong& wall, const ContactAlong& instruments);
    void write_wire_table(const WireOutput& wire, const std::string& name);
    void write_contact_table(const Output& now);
    [[nodiscard]] std::string csv(double value);

    const Scene& scene_;
    const RepairReport& vessel_;
    std::vector<Vec3> tips_;  // scratch of take_in
    const WallMesh& mesh_;  // of the world
    std::filesystem::path dir_;
    std::uint64_t vessel_hash_ = 0;
    std::string resolved_;  // the scene as the checkpoint carries it
    bool has_wall_ = false;
    ClosedEnds closed_ends_;
    bool elastic_ = false;             // and it is elastic
    double move_nodes_ = 0, stress_nodes_ = 0;  // error of its load by nodes, as a share of what it does
    std::vector<AppendFile> traces_;  // trace.csv, of several instruments each one's, of sensors
    std::vector<double> sensed_;      // first number of each sensor's last row
    RunTally tally_;
    long passed_ = 0;        // equilibria on the way of a static run
    WireReadings readings_;  // of all instruments, in the last accepted step
    std::vector<FrameMark> wire_frames_, contact_frames_;
    std::vector<std::string> warnings_;
    std::optional<ErrorEstimate> estimate_;
};

}  // namespace seldinger

#pragma once
// The results of a batch: one row per run, as CSV and as NumPy's .npz.

#include "batch/sweep.h"
#include "record/wire_shapes.h"
#include "run/exits.h"
#include "run/summary.h"
#include "vessel/branches.h"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

/// What a column is of: the groups of results.csv, in their order.
enum class ColumnKind { Outcome, Largest, Last, Effort };
[[nodiscard]] const char* column_kind_word(ColumnKind kind);

/// Names as in summary.json; `whole` ones are counts. Maxima are over all steps, those of regions and their extent over each
/// record_every-th and the last.
struct BatchColumn {
    std::string_view name;
    bool whole;
    ColumnKind kind = ColumnKind::Last;
    bool banded = false;   // has NAME_band, where bands are asked for
    bool of_task = false;  // only where the scene has a target
    bool of_wall = false;  // ± of the column before, by all but the step
};
inline constexpr BatchColumn batch_columns[] = {{"branch", true, ColumnKind::Outcome},
                                                {"branch_depth_m", false, ColumnKind::Outcome, true},
                                                {"left_through", true, ColumnKind::Outcome},
                                                {"reached", true, ColumnKind::Outcome, false, true},
                                                {"passed", true, ColumnKind::Outcome, false, true},
                                                {"reached_at_m", false, ColumnKind::Outcome, true, true},
                                                {"reached_at_s", false, ColumnKind::Outcome, true, true},
                                                {"distance_m", false, ColumnKind::Outcome, true, true},
                                                {"until_patch_force_max_n", false, ColumnKind::Outcome, true, true},
                                                {"until_patch_force_max_s", false, ColumnKind::Outcome, false, true},
                                                {"until_wall_force_max_n", false, ColumnKind::Outcome, true, true},
                                                {"until_hand_force_max_n", false, ColumnKind::Outcome, true, true},
                                                {"time_above_limit_s", false, ColumnKind::Outcome, true, true},
                                                {"patch_force_max_n", false, ColumnKind::Largest, true},
                                                {"force_per_length_max_n_per_m", false, ColumnKind::Largest, true},
                                                {"hand_force_max_n", false, ColumnKind::Largest, true},
                                                {"friction_max_n", false, ColumnKind::Largest, true},
                                                {"contacts_max", true, ColumnKind::Largest},
                                                {"contact_regions_max", true, ColumnKind::Largest},
                                                {"contact_extent_max_m", false, ColumnKind::Largest, true},
                                                {"overlap_max_m", false, ColumnKind::Largest},
                                                {"outside_max_m", false, ColumnKind::Largest},
                                                {"wall_move_max_m", false, ColumnKind::Largest},
                                                {"wall_move_max_band_m", false, ColumnKind::Largest, false, false, true},
                                                {"wall_stress_max_pa", false, ColumnKind::Largest},
                                                {"wall_stress_max_band_pa", false, ColumnKind::Largest, false, false, true},
                                                {"simulated_s", false},
                                                {"inserted_m", false},
                                                {"turned_rad", false},
                                                {"hand_force_n", false, ColumnKind::Last, true},
                                                {"hand_force_mean_n", false, ColumnKind::Last, true},
                                                {"hand_torque_nm", false, ColumnKind::Last, true},
                                                {"normal_n", false, ColumnKind::Last, true},
                                                {"friction_n", false, ColumnKind::Last, true},
                                                {"friction_mean_n", false, ColumnKind::Last, true},
                                                {"contacts", true},
                                                {"contact_length_m", false, ColumnKind::Last, true},
                                                {"tip_x_m", false, ColumnKind::Last, true},
                                                {"tip_y_m", false, ColumnKind::Last, true},
                                                {"tip_z_m", false, ColumnKind::Last, true},
                                                {"base_force_x_n", false},
                                                {"base_force_y_n", false},
                                                {"base_force_z_n", false},
                                                {"energy_j", false},
                                                {"kinetic_j", false},
                                                {"elastic_j", false},
                                                {"gravitational_j", false},
                                                {"remesh_energy_j", false},
                                                {"nodes", true, ColumnKind::Effort},
                                                {"steps", true, ColumnKind::Effort},
                                                {"newton_max", true, ColumnKind::Effort},
                                                {"halved_steps", true, ColumnKind::Effort}};
/// Index of a column in BatchRow::numbers.
[[nodiscard]] constexpr std::size_t column_index(std::string_view name)
{
    std::size_t k = 0;
    while (k < std::size(batch_columns) && batch_columns[k].name != name) ++k;
    return k;
}

/// Columns of each [[instrument]], as `NAME.COLUMN`; the final state.
inline constexpr BatchColumn instrument_columns[] = {{"inserted_m", false},     {"turned_rad", false}, {"nodes", true},
                                                     {"hand_force_n", false},   {"hand_torque_nm", false},
                                                     {"tip_x_m", false},        {"tip_y_m", false},    {"tip_z_m", false}};

/// One finished run.
struct BatchRow {
    using OfInstrument = std::array<double, std::size(instrument_columns)>;
    std::int64_t run = 0;                                    // from 0
    RunStatus status = RunStatus::Done;                      // or Stopped: no state was found, the last good one is shown
    std::array<double, std::size(batch_columns)> numbers{};  // in the order of batch_columns
    std::array<char, 16> state_hash{};                       // as summary.json of the run alone
    std::string branch_path;                                 // likewise; empty: no centreline
    std::vector<OfInstrument> instruments;                   // of the system's, in the order of instrument_columns
    /// Final shape of each instrument: x, y, z of `stations` points at even arc lengths, tip first [m].
    static constexpr std::size_t stations = shape_stations;
    std::vector<float> shape;
};

/// Rows to and from the bytes of a checkpoint or a farm's file. @throws Error BadFile: the bytes end before the rows do
void put_rows(std::vector<std::uint8_t>& bytes, std::span<const BatchRow> rows);
[[nodiscard]] std::vector<BatchRow> take_rows(const std::uint8_t*& at, const std::uint8_t* end);

/// Whether rows that were read from a file are of runs from `begin` to before `end`, none twice, and each says what a run of so
/// many instruments can come to.
[[nodiscard]] bool are_sound(std::span<const BatchRow> rows, std::size_t begin, std::size_t end, std::size_t instruments);

/// What a batch's table has beside the columns that all have.
struct BatchLayout {
    std::vector<std::string> instruments;  // names of [[instrument]] tables; none: of [wire]
    bool task = false, bands = false;
    std::size_t runs = 0;                  // of the sweep; rows from there on are of half the step
    std::string target;                    // what the task's target is called
    double patch = 0;                      // that the force on a patch is of [m]
    bool limits = false;                   // the task has some
};

/// What a vessel's places are called.
struct VesselPlaces {
    WorldBranches branches;
    std::vector<BoundaryLoop> openings;
    std::vector<int> inlet;  // [openings] number, from 1, of the inlet through each
    VesselPlaces() = default;
    VesselPlaces(const World& world, std::vector<BoundaryLoop> loops);
};

/// @param system  of the world, in the state that the row is to show; tip and hand of `numbers` are its first instrument's
[[nodiscard]] BatchRow make_row(std::int64_t run, RunStatus status, const World& world, int system, const RunTally& tally,
                                const VesselPlaces& places);

/// The rows of a batch in the order of their runs, and of each the one with half the step, null where there is none.
struct RunRows {
    const BatchRow* row = nullptr;
    const BatchRow* half = nullptr;
};

/// What half the step changes in a number, as a band: safety 2 |Q(h) - Q(h/2)|, of a scheme of first order (bands/error_band.h).
/// NaN where there is no such run or it stopped, or, of what happens until the target is reached, where only one of the two
/// reaches it.
[[nodiscard]] double band_of(const RunRows& of, std::size_t column);

[[nodiscard]] std::vector<RunRows> rows_by_run(const BatchLayout& layout, const std::vector<BatchRow>& rows);

/// The numbers of a row by their names in the table.
[[nodiscard]] std::map<std::string, double> numbers_of(const BatchLayout& layout, const RunRows& of);

/// Rows by run: run, the varied keys, status, batch_columns with their bands, instrument_columns of each name, branch_path,
/// state_hash. A number that is not finite is an empty field.
[[nodiscard]] std::string batch_csv(const Sweep& sweep, const BatchLayout& layout, const std::vector<BatchRow>& rows);
/// The same columns as arrays; a varied key whose values are all numbers is float64, any other is text.
[[nodiscard]] std::string batch_npz(const Sweep& sweep, const BatchLayout& layout, const std::vector<BatchRow>& rows);
/// One row per column of the table: its name, unit and group.
[[nodiscard]] std::string batch_units_csv(const Sweep& sweep, const BatchLayout& layout);
/// Final shapes: run, instrument, station from the tip, x, y, z.
[[nodiscard]] std::string batch_shapes_csv(const BatchLayout& layout, const std::vector<BatchRow>& rows);
/// "wire.preset=bentson-035, wire.mu_sliding=0.1"; of one key whose value is a word, the word alone. Long values are shortened.
[[nodiscard]] std::string label_of(const Sweep& sweep, std::size_t run);
/// "run 3 (bentson-035)".
[[nodiscard]] std::string run_name(const Sweep& sweep, std::size_t run);

/// A comma and a number; the comma alone where there is none.
[[nodiscard]] std::string number_field(double value);

}  // namespace seldinger

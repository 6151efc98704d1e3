#pragma once
// The results of a batch: one row per run, as CSV and as NumPy's .npz.

#include "scene/summary.h"
#include "study/sweep.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

/// Names as in summary.json; `whole` ones are counts. Maxima are over all steps, those of regions and their extent over each
/// record_every-th and the last; the rest is the final state.
struct BatchColumn {
    std::string_view name;
    bool whole;
};
inline constexpr BatchColumn batch_columns[] = {{"steps", true},
                                                {"simulated_s", false},
                                                {"inserted_m", false},
                                                {"turned_rad", false},
                                                {"nodes", true},
                                                {"contacts", true},
                                                {"contacts_max", true},
                                                {"contact_length_m", false},
                                                {"force_per_length_max_n_per_m", false},
                                                {"patch_force_max_n", false},
                                                {"contact_regions_max", true},
                                                {"contact_extent_max_m", false},
                                                {"normal_n", false},
                                                {"friction_n", false},
                                                {"friction_max_n", false},
                                                {"hand_force_n", false},
                                                {"hand_torque_nm", false},
                                                {"base_force_x_n", false},
                                                {"base_force_y_n", false},
                                                {"base_force_z_n", false},
                                                {"overlap_max_m", false},
                                                {"outside_max_m", false},
                                                {"newton_max", true},
                                                {"halved_steps", true},
                                                {"energy_j", false},
                                                {"kinetic_j", false},
                                                {"elastic_j", false},
                                                {"gravitational_j", false},
                                                {"remesh_energy_j", false},
                                                {"tip_x_m", false},
                                                {"tip_y_m", false},
                                                {"tip_z_m", false}};

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
    std::vector<OfInstrument> instruments;                   // of the system's, in the order of instrument_columns
};

/// Rows to and from the bytes of a checkpoint or a farm's file. @throws Error BadFile: the bytes end before the rows do
void put_rows(std::vector<std::uint8_t>& bytes, std::span<const BatchRow> rows);
[[nodiscard]] std::vector<BatchRow> take_rows(const std::uint8_t*& at, const std::uint8_t* end);

/// Whether rows that were read from a file are of runs from `begin` to before `end`, none twice, and each says what a run of so many
/// instruments can come to.
[[nodiscard]] bool are_sound(std::span<const BatchRow> rows, std::size_t begin, std::size_t end, std::size_t instruments);

/// @param system  of the world, in the state that the row is to show; tip and hand of `numbers` are its first instrument's
[[nodiscard]] BatchRow make_row(std::int64_t run, RunStatus status, const World& world, int system, const RunTally& tally);

/// Rows by run: run, the varied keys, status, batch_columns, instrument_columns of each name, state_hash. A number that is not finite
/// is an empty field. @param instruments  names of the scene's [[instrument]] tables; none: of [wire]
[[nodiscard]] std::string batch_csv(const Sweep& sweep, std::span<const std::string> instruments, std::vector<BatchRow> rows);
/// The same columns as arrays; a varied key whose values are all numbers is float64, any other is text.
[[nodiscard]] std::string batch_npz(const Sweep& sweep, std::span<const std::string> instruments, std::vector<BatchRow> rows);

}  // namespace seldinger

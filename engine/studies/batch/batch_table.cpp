// Makes a result row from a wire's readings, and writes the rows as CSV and as arrays of an .npz.
#include "batch/batch_table.h"

#include "bands/error_band.h"
#include "io/npz_write.h"
#include "setup/joint_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

namespace seldinger {
namespace {

std::string quoted(const std::string& text)  // RFC 4180
{
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
    return out + "\"";
}

std::optional<double> as_number(const std::string& text)
{
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size()) return value;
    return std::nullopt;
}

/// "capsule" without its quotes; anything else as it is in TOML.
std::string plain(const std::string& value)
{
    return value.size() >= 2 && value.front() == '"' && value.back() == '"' ? value.substr(1, value.size() - 2) : value;
}

std::string text_of(const std::array<char, 16>& hash) { return {hash.begin(), hash.end()}; }

std::string column_of(const std::string& instrument, const BatchColumn& column)
{
    return fmt::format("{}.{}", instrument, column.name);
}

BatchRow::OfInstrument read_instrument(const World& world, int wire)
{
    const WireReadings r = world.readings(wire);
    const Vec3 tip = world.rod(wire).pos(0);
    return {r.inserted, r.turned, static_cast<double>(r.nodes), r.hand_force, r.hand_torque, tip.x(), tip.y(), tip.z()};
}

/// Points at even arc lengths along a wire, tip first.
void put_shape(const ConstRodView& rod, std::vector<float>& to)
{
    std::vector<Vec3> line;
    for (int i = 0; i < rod.n; ++i) line.push_back(rod.pos(i));
    std::vector<double> points;
    put_stations(line, BatchRow::stations, points);
    for (const double x : points) to.push_back(static_cast<float>(x));
}

/// "_n_per_m", "_m2" and the like at a name's end.
std::string unit_of(std::string_view name)
{
    constexpr std::pair<std::string_view, std::string_view> ends[] = {
        {"_n_per_m", "N/m"}, {"_nm2", "N m^2"}, {"_nm", "N m"},  {"_kg_m3", "kg/m^3"}, {"_1_m", "1/m"},
        {"_1_s", "1/s"},     {"_pa", "Pa"},     {"_rad", "rad"}, {"_deg", "deg"},      {"_m", "m"},
        {"_s", "s"},         {"_n", "N"},       {"_j", "J"},     {"density", "kg/m^3"}};
    if (name.ends_with("_band")) name.remove_suffix(5);
    for (const auto& [end, unit] : ends)
        if (name.ends_with(end)) return std::string(unit);
    return {};
}

std::vector<std::string> varied(const Sweep& sweep, std::size_t run)
{
    std::vector<std::string> values;
    const std::vector<std::size_t> index = sweep.indices(run);
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) values.push_back(plain(sweep.axes[a].values[index[a]]));
    return values;
}

/// The band of an elastic wall's reading, which is the column before, with the step's share.
double wall_band(const RunRows& of, std::size_t c) { return std::hypot(of.row->numbers[c], band_of(of, c - 1)); }

bool is_shown(const BatchColumn& column, const BatchLayout& layout) { return layout.task || !column.of_task; }

/// `one(name, kind, is_whole, value)` for every number of a row, in the table's order; value(RunRows) -> double.
template <class One>
void for_each_number(const BatchLayout& layout, One one)
{
    for (std::size_t c = 0; c < std::size(batch_columns); ++c) {
        const BatchColumn& column = batch_columns[c];
        if (!is_shown(column, layout)) continue;
        if (layout.bands && column.of_wall)
            one(std::string(column.name), column.kind, false, [c](const RunRows& of) { return wall_band(of, c); });
        else one(std::string(column.name), column.kind, column.whole, [c](const RunRows& of) { return of.row->numbers[c]; });
        if (layout.bands && column.banded)
            one(std::string(column.name) + "_band", column.kind, false,
                [c](const RunRows& of) { return band_of(of, c); });
    }
    for (std::size_t k = 0; k < layout.instruments.size(); ++k)
        for (std::size_t c = 0; c < std::size(instrument_columns); ++c)
            one(column_of(layout.instruments[k], instrument_columns[c]), ColumnKind::Last, instrument_columns[c].whole,
                [k, c](const RunRows& of) { return of.row->instruments[k][c]; });
}

}  // namespace

std::string number_field(double value) { return std::isfinite(value) ? fmt::format(",{}", value) : ","; }

const char* column_kind_word(ColumnKind kind)
{
    switch (kind) {
        case ColumnKind::Outcome: return "outcome";
        case ColumnKind::Largest: return "largest";
        case ColumnKind::Last: return "last";
        case ColumnKind::Effort: return "effort";
    }
    return "";
}

VesselPlaces::VesselPlaces(const World& world, std::vector<BoundaryLoop> loops) : branches(world), openings(std::move(loops))
{
    for (std::size_t k = 0; k < openings.size(); ++k)
        inlet.push_back(inlet_through(openings, world.setup().centreline, static_cast<int>(k)));
}

BatchRow make_row(std::int64_t run, RunStatus status, const World& world, int system, const RunTally& tally,
                  const VesselPlaces& places)
{
    BatchRow row;
    row.run = run;
    row.status = status;
    const WireReadings r = joint_readings(world, system);
    const auto [first, end] = world.wires_of(system);
    const Vec3 tip = world.rod(first).pos(0);
    const int leading = leading_wire(world, system);
    const Branches::Place place = places.branches.tip(world, system);
    row.branch_path = places.branches.of(system).path(place);
    const int opening = outside_through(tally.exits, leading - first);
    const ScoreNumbers& score = tally.score;
    const double never = std::nan("");
    const EndMean::Mean mean = tally.at_end(r);
    const auto whole = [](std::int64_t count) { return static_cast<double>(count); };
    row.numbers = {whole(place.branch),
                   place.depth,
                   whole(opening < 0 ? 0 : places.inlet[static_cast<std::size_t>(opening)]),
                   whole(score.reached),
                   whole(score.reached && !score.failed),
                   score.reached ? score.reached_at_m : never,
                   score.reached ? score.reached_at_s : never,
                   score.distance,
                   score.patch_force_max,
                   score.patch_force_max_time,
                   score.wall_force_max,
                   score.hand_force_max,
                   score.time_above,
                   tally.on_wall.patch_force,
                   tally.on_wall.per_length,
                   tally.hand_force_max,
                   tally.friction_max,
                   whole(tally.contacts_max),
                   whole(tally.on_wall.regions),
                   tally.on_wall.extent,
                   tally.overlap_max,
                   tally.outside_max,
                   tally.wall_move.value,
                   tally.wall_move.band.sum(),
                   tally.wall_stress.value,
                   tally.wall_stress.band.sum(),
                   world.time(first),
                   r.inserted,
                   r.turned,
                   r.hand_force,
                   mean.hand,
                   r.hand_torque,
                   r.normal,
                   r.friction,
                   mean.friction,
                   whole(r.contacts),
                   r.contact_length,
                   tip.x(),
                   tip.y(),
                   tip.z(),
                   r.base_force.x(),
                   r.base_force.y(),
                   r.base_force.z(),
                   r.kinetic + r.elastic + r.gravitational,
                   r.kinetic,
                   r.elastic,
                   r.gravitational,
                   r.remesh_energy,
                   whole(r.nodes),
                   whole(tally.steps),
                   whole(tally.newton_max),
                   whole(tally.halved_steps)};
    const std::string hash = world.state_hash(system);
    std::copy_n(hash.begin(), row.state_hash.size(), row.state_hash.begin());
    for (int w = first; w < end; ++w) {
        row.instruments.push_back(read_instrument(world, w));
        put_shape(world.rod(w), row.shape);
    }
    return row;
}

double band_of(const RunRows& of, std::size_t column)
{
    constexpr double margin = bands::safety * 2;
    if (!of.half) return std::nan("");
    const BatchRow &row = *of.row, &half = *of.half;
    if (row.status != RunStatus::Done || half.status != RunStatus::Done) return std::nan("");
    const auto differs = [&](std::string_view outcome) {
        return row.numbers[column_index(outcome)] != half.numbers[column_index(outcome)];
    };
    if (batch_columns[column].of_task && differs("reached")) return std::nan("");
    if (batch_columns[column].name == "branch_depth_m" && row.branch_path != half.branch_path) return std::nan("");
    return margin * std::abs(row.numbers[column] - half.numbers[column]);
}

std::vector<RunRows> rows_by_run(const BatchLayout& layout, const std::vector<BatchRow>& rows)
{
    std::vector<RunRows> runs(layout.runs);
    for (const BatchRow& row : rows) {
        const auto item = static_cast<std::size_t>(row.run);
        (item < layout.runs ? runs[item].row : runs[item - layout.runs].half) = &row;
    }
    std::erase_if(runs, [](const RunRows& of) { return of.row == nullptr; });
    return runs;
}

std::map<std::string, double> numbers_of(const BatchLayout& layout, const RunRows& of)
{
    std::map<std::string, double> numbers;
    for_each_number(layout, [&](const std::string& name, ColumnKind, bool, auto&& value) { numbers[name] = value(of); });
    return numbers;
}

std::string label_of(const Sweep& sweep, std::size_t run)
{
    constexpr std::size_t longest = 48;  // bytes of a value
    std::vector<std::string> values = varied(sweep, run);
    for (std::string& value : values) {
        if (value.size() <= longest) continue;
        std::size_t end = longest;
        while (end > 0 && (value[end] & 0xc0) == 0x80) --end;  // not within a letter
        value.resize(end);
        value += " ...";
    }
    // a word is a label, a number or a list is not
    const bool is_word =
        values.size() == 1 && !as_number(values.front()) && values.front().find_first_of("[{") == std::string::npos;
    if (is_word) return values.front();
    std::string text;
    for (std::size_t a = 0; a < values.size(); ++a) text += fmt::format("{}{}={}", a ? ", " : "", sweep.axes[a].key, values[a]);
    return text;
}

std::string run_name(const Sweep& sweep, std::size_t run) { return fmt::format("run {} ({})", run, label_of(sweep, run)); }

// ---- tables -----------------------------------------------------------------------------------------------------------------

std::string batch_csv(const Sweep& sweep, const BatchLayout& layout, const std::vector<BatchRow>& rows)
{
    std::string text = "run";
    for (const SweepAxis& axis : sweep.axes) text += "," + quoted(axis.key);
    text += ",status";
    for_each_number(layout, [&](const std::string& name, auto&&...) { text += "," + name; });
    text += ",branch_path,state_hash\n";
    for (const RunRows& of : rows_by_run(layout, rows)) {
        text += fmt::format("{}", of.row->run);
        for (const std::string& value : varied(sweep, static_cast<std::size_t>(of.row->run))) text += "," + quoted(value);
        text += fmt::format(",{}", status_word(of.row->status));
        for_each_number(layout, [&](const std::string&, ColumnKind, bool, auto&& value) { text += number_field(value(of)); });
        text += "," + of.row->branch_path + "," + text_of(of.row->state_hash) + "\n";
    }
    return text;
}

std::string batch_shapes_csv(const BatchLayout& layout, const std::vector<BatchRow>& rows)
{
    std::string text = "run,instrument,station,x_m,y_m,z_m\n";
    for (const RunRows& of : rows_by_run(layout, rows)) {
        const std::vector<float>& shape = of.row->shape;
        for (std::size_t p = 0; 3 * p + 2 < shape.size(); ++p) {
            const std::size_t k = p / BatchRow::stations;
            text +=
                fmt::format("{},{},{},{},{},{}\n", of.row->run, k < layout.instruments.size() ? layout.instruments[k] : "wire",
                            p % BatchRow::stations, shape[3 * p], shape[3 * p + 1], shape[3 * p + 2]);
        }
    }
    return text;
}

std::string batch_units_csv(const Sweep& sweep, const BatchLayout& layout)
{
    std::string text = "column,unit,group\nrun,,\n";
    for (const SweepAxis& axis : sweep.axes) text += fmt::format("{},{},varied\n", quoted(axis.key), unit_of(axis.key));
    text += "status,,outcome\n";
    for_each_number(layout, [&](const std::string& name, ColumnKind kind, auto&&...) {
        text += fmt::format("{},{},{}\n", name, unit_of(name), column_kind_word(kind));
    });
    return text + "branch_path,,outcome\nstate_hash,,effort\n";
}

std::string batch_npz(const Sweep& sweep, const BatchLayout& layout, const std::vector<BatchRow>& rows)
{
    const std::vector<RunRows> runs = rows_by_run(layout, rows);
    NpzWriter file;
    std::vector<std::int64_t> whole(runs.size());
    std::vector<double> numbers(runs.size());
    std::vector<std::string> texts(runs.size());
    const auto fill = [&](auto& array, auto&& value) { std::transform(runs.begin(), runs.end(), array.begin(), value); };
    fill(whole, [](const RunRows& of) { return of.row->run; });
    file.add("run", whole);
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
        const SweepAxis& axis = sweep.axes[a];
        const auto value = [&](const RunRows& of) { return varied(sweep, static_cast<std::size_t>(of.row->run))[a]; };
        const bool numeric =
            std::all_of(axis.values.begin(), axis.values.end(), [](const std::string& v) { return as_number(v).has_value(); });
        if (numeric) {
            fill(numbers, [&](const RunRows& of) { return *as_number(value(of)); });
            file.add(axis.key, numbers);
        } else {
            fill(texts, value);
            file.add(axis.key, texts);
        }
    }
    fill(texts, [](const RunRows& of) { return std::string(status_word(of.row->status)); });
    file.add("status", texts);
    for_each_number(layout, [&](const std::string& name, ColumnKind, bool is_whole, auto&& value) {
        if (is_whole) {
            fill(whole, [&](const RunRows& of) { return static_cast<std::int64_t>(value(of)); });
            file.add(name, whole);
        } else {
            fill(numbers, value);
            file.add(name, numbers);
        }
    });
    fill(texts, [](const RunRows& of) { return of.row->branch_path; });
    file.add("branch_path", texts);
    fill(texts, [](const RunRows& of) { return text_of(of.row->state_hash); });
    file.add("state_hash", texts);
    return file.finish();
}

}  // namespace seldinger

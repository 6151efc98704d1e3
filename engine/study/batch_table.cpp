// Makes a result row from a wire's readings, and writes the rows as CSV and as arrays of an .npz.
#include "study/batch_table.h"

#include "io/npz_write.h"
#include "scene/joint_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

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

void sort_by_run(std::vector<BatchRow>& rows)
{
    std::sort(rows.begin(), rows.end(), [](const BatchRow& a, const BatchRow& b) { return a.run < b.run; });
}

std::string text_of(const std::array<char, 16>& hash) { return {hash.begin(), hash.end()}; }

std::string field(double value) { return std::isfinite(value) ? fmt::format(",{}", value) : ","; }

std::string column_of(const std::string& instrument, const BatchColumn& column) { return fmt::format("{}.{}", instrument, column.name); }

BatchRow::OfInstrument read_instrument(const World& world, int wire)
{
    const WireReadings r = world.readings(wire);
    const Vec3 tip = world.rod(wire).pos(0);
    return {r.inserted, r.turned, static_cast<double>(r.nodes), r.hand_force, r.hand_torque, tip.x(), tip.y(), tip.z()};
}

}  // namespace

BatchRow make_row(std::int64_t run, RunStatus status, const World& world, int system, const RunTally& tally)
{
    BatchRow row;
    row.run = run;
    row.status = status;
    const WireReadings r = joint_readings(world, system);
    const auto [first, end] = world.wires_of(system);
    const Vec3 tip = world.rod(first).pos(0);
    row.numbers = {static_cast<double>(tally.steps),
                   world.time(first),
                   r.inserted,
                   r.turned,
                   static_cast<double>(r.nodes),
                   static_cast<double>(r.contacts),
                   static_cast<double>(tally.contacts_max),
                   r.contact_length,
                   tally.on_wall.per_length,
                   tally.on_wall.patch_force,
                   static_cast<double>(tally.on_wall.regions),
                   tally.on_wall.extent,
                   r.normal,
                   r.friction,
                   tally.friction_max,
                   r.hand_force,
                   r.hand_torque,
                   r.base_force.x(),
                   r.base_force.y(),
                   r.base_force.z(),
                   tally.overlap_max,
                   tally.outside_max,
                   static_cast<double>(tally.newton_max),
                   static_cast<double>(tally.halved_steps),
                   r.kinetic + r.elastic + r.gravitational,
                   r.kinetic,
                   r.elastic,
                   r.gravitational,
                   r.remesh_energy,
                   tip.x(),
                   tip.y(),
                   tip.z()};
    const std::string hash = world.state_hash(system);
    std::copy_n(hash.begin(), row.state_hash.size(), row.state_hash.begin());
    for (int w = first; w < end; ++w) row.instruments.push_back(read_instrument(world, w));
    return row;
}

// ---- tables -----------------------------------------------------------------------------------------------------------------

std::string batch_csv(const Sweep& sweep, std::span<const std::string> instruments, std::vector<BatchRow> rows)
{
    sort_by_run(rows);
    std::string text = "run";
    for (const SweepAxis& axis : sweep.axes) text += "," + quoted(axis.key);
    text += ",status";
    for (const BatchColumn& column : batch_columns) text += fmt::format(",{}", column.name);
    for (const std::string& name : instruments)
        for (const BatchColumn& column : instrument_columns) text += "," + column_of(name, column);
    text += ",state_hash\n";
    for (const BatchRow& row : rows) {
        text += fmt::format("{}", row.run);
        const std::vector<std::size_t> index = sweep.indices(static_cast<std::size_t>(row.run));
        for (std::size_t a = 0; a < sweep.axes.size(); ++a) text += "," + quoted(plain(sweep.axes[a].values[index[a]]));
        text += fmt::format(",{}", status_word(row.status));
        for (const double value : row.numbers) text += field(value);
        for (std::size_t k = 0; k < instruments.size(); ++k)
            for (const double value : row.instruments[k]) text += field(value);
        text += "," + text_of(row.state_hash) + "\n";
    }
    return text;
}

std::string batch_npz(const Sweep& sweep, std::span<const std::string> instruments, std::vector<BatchRow> rows)
{
    sort_by_run(rows);
    NpzWriter file;
    std::vector<std::int64_t> whole(rows.size());
    std::vector<double> numbers(rows.size());
    std::vector<std::string> texts(rows.size());
    const auto fill = [&](auto& array, auto&& value) { std::transform(rows.begin(), rows.end(), array.begin(), value); };
    fill(whole, [](const BatchRow& row) { return row.run; });
    file.add("run", whole);
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
        const SweepAxis& axis = sweep.axes[a];
        const auto value = [&](const BatchRow& row) {
            return plain(axis.values[sweep.indices(static_cast<std::size_t>(row.run))[a]]);
        };
        const bool numeric =
            std::all_of(axis.values.begin(), axis.values.end(), [](const std::string& v) { return as_number(v).has_value(); });
        if (numeric) {
            fill(numbers, [&](const BatchRow& row) { return *as_number(value(row)); });
            file.add(axis.key, numbers);
        } else {
            fill(texts, value);
            file.add(axis.key, texts);
        }
    }
    fill(texts, [](const BatchRow& row) { return std::string(status_word(row.status)); });
    file.add("status", texts);
    const auto add = [&](const std::string& name, bool is_whole, auto&& value) {
        if (is_whole) {
            fill(whole, [&](const BatchRow& row) { return static_cast<std::int64_t>(value(row)); });
            file.add(name, whole);
        } else {
            fill(numbers, value);
            file.add(name, numbers);
        }
    };
    for (std::size_t c = 0; c < std::size(batch_columns); ++c)
        add(std::string(batch_columns[c].name), batch_columns[c].whole, [&](const BatchRow& row) { return row.numbers[c]; });
    for (std::size_t k = 0; k < instruments.size(); ++k)
        for (std::size_t c = 0; c < std::size(instrument_columns); ++c)
            add(column_of(instruments[k], instrument_columns[c]), instrument_columns[c].whole,
                [&](const BatchRow& row) { return row.instruments[k][c]; });
    fill(texts, [](const BatchRow& row) { return text_of(row.state_hash); });
    file.add("state_hash", texts);
    return file.finish();
}

}  // namespace seldinger

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

}  // namespace

BatchRow make_row(std::int64_t run, RunStatus status, const World& world, int system, const RunTally& tally)
{
    BatchRow row;
    row.run = run;
    row.status = status;
    const WireReadings r = joint_readings(world, system);
    const int first = world.wires_of(system).first;
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
    return row;
}

std::string batch_csv(const Sweep& sweep, std::vector<BatchRow> rows)
{
    sort_by_run(rows);
    std::string text = "run";
    for (const SweepAxis& axis : sweep.axes) text += "," + quoted(axis.key);
    text += ",status";
    for (const BatchColumn& column : batch_columns) text += fmt::format(",{}", column.name);
    text += ",state_hash\n";
    for (const BatchRow& row : rows) {
        text += fmt::format("{}", row.run);
        const std::vector<std::size_t> index = sweep.indices(static_cast<std::size_t>(row.run));
        for (std::size_t a = 0; a < sweep.axes.size(); ++a) text += "," + quoted(plain(sweep.axes[a].values[index[a]]));
        text += fmt::format(",{}", status_word(row.status));
        for (const double value : row.numbers) text += std::isfinite(value) ? fmt::format(",{}", value) : ",";
        text += "," + text_of(row.state_hash) + "\n";
    }
    return text;
}

std::string batch_npz(const Sweep& sweep, std::vector<BatchRow> rows)
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
    for (std::size_t c = 0; c < std::size(batch_columns); ++c) {
        if (batch_columns[c].whole) {
            fill(whole, [&](const BatchRow& row) { return static_cast<std::int64_t>(row.numbers[c]); });
            file.add(std::string(batch_columns[c].name), whole);
        } else {
            fill(numbers, [&](const BatchRow& row) { return row.numbers[c]; });
            file.add(std::string(batch_columns[c].name), numbers);
        }
    }
    fill(texts, [](const BatchRow& row) { return text_of(row.state_hash); });
    file.add("state_hash", texts);
    return file.finish();
}

}  // namespace seldinger

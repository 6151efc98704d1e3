// Tables of measurements: their columns, their rows, and what becomes of them.
#include "scene/scene_tables.h"

#include "core/error.h"
#include "core/printable.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

constexpr double most_change = 0.1;       // ln of a property's change within one section
constexpr double most_noise = 0.5e-3;     // of an encoder, taken for noise [m]
constexpr double noise_shares = 3;        // standard deviations that keys may pass a row at
constexpr double turn_per_metre = 20;     // the same of turns: 0.3 mm goes with 0.3 degrees [rad/m]
constexpr double least_tolerance = 1e-6;  // [m]

/// The column `name` in one of several units, in SI. @return null: there is none
const std::vector<double>* in_si(NumberTable& table, std::initializer_list<std::pair<std::string_view, double>> units)
{
    const std::vector<double>* found = nullptr;
    for (const auto& [name, unit] : units) {
        if (!table.column(name)) continue;
        if (found)
            throw Error(ErrorKind::BadFile, fmt::format("{}: got {} and {}; expected one of them. Fix: take one out",
                                                        table.file.string(), units.begin()->first, name));
        std::vector<double>& values =
            table.columns[static_cast<std::size_t>(std::ranges::find(table.names, name) - table.names.begin())];
        for (double& value : values) value *= unit;
        found = &values;
    }
    return found;
}

[[noreturn]] void fail_missing(const NumberTable& table, std::string_view names)
{
    throw Error(ErrorKind::BadFile, fmt::format("{}: got the columns {}; expected {}. Fix: name them in the first line",
                                                table.file.string(), fmt::join(table.names, ", "), names));
}

void need_known(const NumberTable& table, std::initializer_list<std::string_view> known)
{
    for (const std::string& name : table.names)
        if (std::ranges::find(known, name) == known.end())
            throw Error(ErrorKind::BadFile, fmt::format("{}: got the column {}; expected {}. Fix: take it out",
                                                        table.file.string(), name, fmt::join(known, ", ")));
}

/// Value of a piecewise linear column in the interval that begins at row k.
double between(const BendTable& t, const std::vector<double>& of, std::size_t k, double s)
{
    const double span = t.from_tip[k + 1] - t.from_tip[k];
    return of[k] + (of[k + 1] - of[k]) * (s - t.from_tip[k]) / span;
}

/// 1/mean of 1/v over a piece in which v is linear.
double series_mean(double a, double b) { return std::abs(b / a - 1) < 1e-6 ? 0.5 * (a + b) : (b - a) / std::log(b / a); }

struct Piece {
    double begin, end;
    double bend, twist, stretch, mass;  // 0: as it is
};

/// Pieces of the table, from the tip on, without what is before its first and behind its last row.
std::vector<Piece> pieces_of(const BendTable& t)
{
    std::vector<Piece> pieces;
    for (std::size_t k = 0; k + 1 < t.from_tip.size(); ++k) {
        if (t.from_tip[k + 1] == t.from_tip[k]) continue;
        const std::vector<double>* steepest = &t.bend;
        double change = 0;
        for (const auto* column : {&t.bend, &t.twist, &t.stretch, &t.mass}) {
            if (column->empty()) continue;
            const double own = std::abs(std::log((*column)[k + 1] / (*column)[k]));
            if (own > change) change = own, steepest = column;
        }
        const int parts = std::max(1, static_cast<int>(std::ceil(change / most_change)));
        const double first = (*steepest)[k], last = (*steepest)[k + 1], from = t.from_tip[k], span = t.from_tip[k + 1] - from;
        const auto cut = [&](int p) {  // equal ratios
            if (p == 0 || p == parts) return p == 0 ? from : t.from_tip[k + 1];
            return from + span * (first * std::pow(last / first, static_cast<double>(p) / parts) - first) / (last - first);
        };
        for (int p = 0; p < parts; ++p) {
            const double a = cut(p), b = cut(p + 1);
            const auto mean = [&](const std::vector<double>& of) {
                return of.empty() ? 0.0 : series_mean(between(t, of, k, a), between(t, of, k, b));
            };
            const double mass = t.mass.empty() ? 0.0 : 0.5 * (between(t, t.mass, k, a) + between(t, t.mass, k, b));
            pieces.push_back({a, b, mean(t.bend), mean(t.twist), mean(t.stretch), mass});
        }
    }
    return pieces;
}

/// 1.48 times the median of how far rows are off the line between their neighbours, over sqrt(3/2): the standard deviation of
/// noise that is independent from row to row, whatever else the drive does at times.
double noise_of(const std::vector<double>& t, const std::vector<double>& x)
{
    std::vector<double> off;
    for (std::size_t i = 1; i + 1 < x.size(); ++i)
        off.push_back(std::abs(x[i] - x[i - 1] - (x[i + 1] - x[i - 1]) * (t[i] - t[i - 1]) / (t[i + 1] - t[i - 1])));
    if (off.empty()) return 0;
    std::ranges::nth_element(off, off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2));
    return 1.4826 * off[off.size() / 2] / std::sqrt(1.5);
}

/// The fewest rows, one after the other, from each of which a line to the next passes all in between within the tolerances.
std::vector<FeedKey> thinned(const std::vector<FeedKey>& all, double advance, double turn)
{
    std::vector<FeedKey> kept = {all.front()};
    for (std::size_t from = 0, at = 1; at < all.size();) {
        double low[2] = {-INFINITY, -INFINITY}, high[2] = {INFINITY, INFINITY};
        std::size_t last = from + 1;  // the farthest that a line may go to
        for (at = from + 1; at < all.size(); ++at) {
            const double span = all[at].t - all[from].t;
            const double rise[2] = {all[at].advance - all[from].advance, all[at].turn - all[from].turn},
                         within[2] = {advance, turn};
            bool open = true, reached = true;
            for (int c = 0; c < 2; ++c) {
                const double slope = rise[c] / span;
                reached = reached && slope >= low[c] && slope <= high[c];
                low[c] = std::max(low[c], (rise[c] - within[c]) / span);
                high[c] = std::min(high[c], (rise[c] + within[c]) / span);
                open = open && low[c] <= high[c];
            }
            if (reached) last = at;
            if (!open) break;
        }
        kept.push_back(all[last]);
        from = last;
        at = last + 1;
    }
    return kept;
}

}  // namespace

BendTable read_bend_table(const std::filesystem::path& file, double length)
{
    NumberTable table = read_number_table(file);
    need_known(table, {"from_tip_mm", "from_tip_m", "bend_nm2", "twist_nm2", "stretch_n", "mass_kg_m"});
    const std::vector<double>* at = in_si(table, {{"from_tip_mm", 1e-3}, {"from_tip_m", 1}});
    if (!at || !table.column("bend_nm2")) fail_missing(table, "from_tip_mm (or from_tip_m) and bend_nm2");
    for (std::size_t k = 0; k < table.rows(); ++k) {
        if (!((*at)[k] >= 0 && (*at)[k] <= length * (1 + 1e-9)))
            table.fail(k, "from_tip",
                       fmt::format("got {:g} m; expected 0 to the wire's length, {:g} m. Fix: length_m, or take the row out",
                                   (*at)[k], length));
        if (k > 0 && (*at)[k] < (*at)[k - 1])
            table.fail(k, "from_tip",
                       fmt::format("got {:g} m after {:g} m; expected places from the tip on. Fix: sort the rows", (*at)[k],
                                   (*at)[k - 1]));
        for (std::size_t c = 0; c < table.names.size(); ++c)
            if (&table.columns[c] != at && !(table.columns[c][k] >= 1e-30 && table.columns[c][k] <= 1e18))
                table.fail(k, table.names[c], fmt::format("got {:g}; expected a number above 0", table.columns[c][k]));
    }
    const auto column = [&](std::string_view name) { return table.column(name) ? *table.column(name) : std::vector<double>{}; };
    return {*at, column("bend_nm2"), column("twist_nm2"), column("stretch_n"), column("mass_kg_m")};
}

void take_bend_table(const BendTable& table, double begin, double end, WireSpec& wire)
{
    std::vector<Piece> pieces = pieces_of(table);
    const auto row = [&](std::size_t k, double from, double to) {
        const auto of = [k](const std::vector<double>& column) { return column.empty() ? 0.0 : column[k]; };
        return Piece{from, to, table.bend[k], of(table.twist), of(table.stretch), of(table.mass)};
    };
    pieces.insert(pieces.begin(), row(0, 0, table.from_tip.front()));
    pieces.push_back(row(table.from_tip.size() - 1, table.from_tip.back(), wire.length));
    std::vector<double> cuts;
    wire.for_each_end([&](double at) { cuts.push_back(at); });
    std::ranges::sort(cuts);
    std::vector<WireSectionRange> added;
    for (const Piece& piece : pieces) {
        double from = std::max(piece.begin, begin);
        const double to = std::min(piece.end, end);
        while (from < to) {
            const auto next = std::ranges::upper_bound(cuts, from);
            const double until = next == cuts.end() ? to : std::min(*next, to);
            WireSection section = wire.at(0.5 * (from + until));
            section.bend_stiffness = piece.bend;
            if (piece.twist > 0) section.twist_stiffness = piece.twist;
            if (piece.stretch > 0) section.stretch_stiffness = piece.stretch;
            if (piece.mass > 0) section.density = piece.mass / (std::numbers::pi * section.radius * section.radius);
            added.push_back({from, until, section});
            from = until;
        }
    }
    wire.sections.insert(wire.sections.end(), added.begin(), added.end());
}

std::vector<FeedKey> read_feed_log(const std::filesystem::path& file, double length, std::string& said)
{
    NumberTable table = read_number_table(file);
    const std::vector<double>* time = table.column("time_s");
    const std::vector<double>* advance = in_si(table, {{"advance_mm", 1e-3}, {"advance_m", 1}});
    const std::vector<double>* turn = in_si(table, {{"turn_deg", std::numbers::pi / 180}, {"turn_rad", 1}});
    if (!time || !advance) fail_missing(table, "time_s and advance_mm (or advance_m), and turn_deg (or turn_rad) where it turns");
    std::vector<std::string> remarks;
    std::vector<FeedKey> rows;
    std::vector<std::size_t> from;  // row of the table
    std::size_t equal = 0;
    for (std::size_t k = 0; k < table.rows(); ++k) {
        const FeedKey key{(*time)[k] - time->front(), (*advance)[k], turn ? (*turn)[k] : 0.0};
        if (!rows.empty() && key.t < rows.back().t)
            table.fail(k, "time_s",
                       fmt::format("got {} s after {} s; expected times that do not fall. Fix: sort the rows", (*time)[k],
                                   (*time)[k - 1]));
        if (!rows.empty() && key.t == rows.back().t) ++equal, rows.pop_back(), from.pop_back();
        rows.push_back(key);
        from.push_back(k);
    }
    std::vector<double> t, x, a;
    for (const FeedKey& key : rows) t.push_back(key.t), x.push_back(key.advance), a.push_back(key.turn);
    const double noise = std::min(noise_of(t, x), most_noise);
    const double within = std::max(noise_shares * noise, least_tolerance);
    const double turned =
        std::max(noise_shares * std::min(noise_of(t, a), turn_per_metre * most_noise), turn_per_metre * least_tolerance);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (!(rows[k].advance >= -within && rows[k].advance <= length + within))
            table.fail(from[k], "advance",
                       fmt::format("got {:g} m; expected 0 to the wire's length, {:g} m. Fix: the unit in the column's "
                                   "name, length_m, or the log's zero",
                                   rows[k].advance, length));
        rows[k].advance = std::clamp(rows[k].advance, 0.0, length);
    }
    std::vector<FeedKey> keys = thinned(rows, within, turned);
    if (time->front() != 0) remarks.push_back(fmt::format("its first time, {} s, is 0 here", time->front()));
    if (equal > 0) remarks.push_back(fmt::format("of {} at the time of another the last counts", count_of(equal, "row", "rows")));
    if (noise > least_tolerance)
        remarks.push_back(fmt::format("noise of {:.2g} mm (standard deviation), which the keys pass through", 1e3 * noise));
    for (const std::string& name : table.names)
        if (name != "time_s" && table.column(name) != advance && table.column(name) != turn)
            remarks.push_back(fmt::format("column {} is not used", name));
    said = fmt::format("{} of {} as {}, within {:.2g} mm", count_of(table.rows(), "row", "rows"), file.filename().string(),
                       count_of(keys.size(), "key", "keys"), 1e3 * within);
    for (const std::string& remark : remarks) said += "; " + remark;
    return keys;
}

}  // namespace seldinger

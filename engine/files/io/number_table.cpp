// Reads a table of numbers, and says where it is wrong.
#include "io/number_table.h"

#include "core/error.h"
#include "core/file_io.h"
#include "io/text_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr std::uint64_t most_bytes = 64u << 20;

std::vector<std::string_view> cells_of(std::string_view line)
{
    std::vector<std::string_view> cells;
    for (std::size_t from = 0; from <= line.size();) {
        const std::size_t comma = std::min(line.find(',', from), line.size());
        cells.push_back(trimmed(line.substr(from, comma - from)));
        from = comma + 1;
    }
    return cells;
}

[[noreturn]] void fail_at_line(const std::filesystem::path& file, int line, const std::string& message)
{
    throw Error(ErrorKind::BadFile, fmt::format("{}:{}: {}", file.string(), line, message));
}

void take_names(const std::filesystem::path& file, int line, std::string_view text, std::vector<std::string>& names)
{
    for (const std::string_view name : cells_of(text)) {
        if (name.empty() || number(name) || name.find_first_of(";\t ") != std::string_view::npos)
            fail_at_line(file, line,
                         fmt::format("got \"{}\"; expected the columns' names, separated by commas. Fix: a first line as "
                                     "time_s,advance_mm",
                                     excerpt(text)));
        if (std::ranges::find(names, name) != names.end())
            fail_at_line(file, line, fmt::format("got the column {} twice; expected it once. Fix: take one out", excerpt(name)));
        names.emplace_back(name);
    }
}

}  // namespace

const std::vector<double>* NumberTable::column(std::string_view name) const
{
    const auto found = std::ranges::find(names, name);
    return found == names.end() ? nullptr : &columns[static_cast<std::size_t>(found - names.begin())];
}

void NumberTable::fail(std::size_t row, std::string_view column, std::string_view message) const
{
    fail_at_line(file, lines[row], fmt::format("{}: {}", column, message));
}

NumberTable read_number_table(const std::filesystem::path& file)
{
    const std::string text = read_file(file, most_bytes);
    TextWords lines(without_mark(text));
    NumberTable table;
    table.file = file;
    int at = 0;
    while (!lines.at_end()) {
        const std::string_view line = trimmed(lines.line());
        ++at;
        if (line.empty() || line.front() == '#') continue;
        if (table.names.empty()) {
            take_names(file, at, line, table.names);
            table.columns.resize(table.names.size());
            continue;
        }
        const std::vector<std::string_view> cells = cells_of(line);
        if (cells.size() != table.names.size())
            fail_at_line(file, at,
                         fmt::format("got {} values; expected {}, one for each column of the first line. Fix: commas "
                                     "between values, and points in numbers",
                                     cells.size(), table.names.size()));
        for (std::size_t k = 0; k < cells.size(); ++k) {
            const std::optional<double> value = number(cells[k]);
            if (!value || !std::isfinite(*value))
                fail_at_line(file, at, fmt::format("{}: got \"{}\"; expected a number", table.names[k], excerpt(cells[k])));
            table.columns[k].push_back(*value);
        }
        table.lines.push_back(at);
    }
    if (table.rows() == 0)
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: got no rows; expected a line of names and at least one row", file.string()));
    return table;
}

}  // namespace seldinger

// Reads, looks up and appends rows of a results CSV (RFC 4180).
#include "models/result_table.h"

#include "core/check.h"
#include "core/error.h"

#include <fmt/format.h>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace seldinger {

ResultTable::ResultTable(std::filesystem::path path, std::vector<std::string> columns, std::size_t keys)
    : columns_(std::move(columns)), keys_(keys)
{
    const std::string header = csv_line(columns_);
    std::size_t whole = 0;
    if (std::filesystem::exists(path)) {
        const std::string text = read_file(path);
        for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', whole)) {
            const std::string_view line = std::string_view(text).substr(whole, end + 1 - whole);
            if (whole == 0 && line != header)
                throw Error(ErrorKind::BadFile,
                            fmt::format("{}: has other columns; it was written by another version, choose another "
                                        "folder with -o or delete it",
                                        path.string()));
            Row row = csv_fields(line.substr(0, line.size() - 1));
            if (whole > 0 && row.size() == columns_.size()) take_in(std::move(row));
            whole = end + 1;
        }
    }
    file_ = AppendFile(path, whole);
    if (whole == 0) file_.append(header);
}

const ResultTable::Row* ResultTable::find(const Row& keys) const
{
    const auto found = index_.find(keys);
    return found == index_.end() ? nullptr : &rows_[found->second];
}

void ResultTable::append(const Row& row)
{
    SEL_ASSERT(row.size() == columns_.size());
    file_.append(csv_line(row));
    take_in(row);
}

void ResultTable::take_in(Row row)
{
    const Row keys(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys_));
    const auto [place, is_new] = index_.try_emplace(keys, rows_.size());
    if (is_new) rows_.push_back(std::move(row));
    else rows_[place->second] = std::move(row);
}

std::string csv_line(const ResultTable::Row& row)
{
    std::string line;
    for (const std::string& field : row) {
        if (&field != &row.front()) line += ',';
        if (field.find_first_of(",\"") == std::string::npos) {
            line += field;
            continue;
        }
        line += '"';
        for (const char c : field) line += c == '"' ? std::string("\"\"") : std::string(1, c);
        line += '"';
    }
    return line + '\n';
}

ResultTable::Row csv_fields(std::string_view line)
{
    ResultTable::Row row(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"') {
            if (quoted && i + 1 < line.size() && line[i + 1] == '"') row.back() += line[i++];
            else quoted = !quoted;
        } else if (line[i] == ',' && !quoted) {
            row.emplace_back();
        } else {
            row.back() += line[i];
        }
    }
    return row;
}

std::string csv_number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string(); }

double number_in(const std::string& text)
{
    return text.empty() ? std::numeric_limits<double>::quiet_NaN() : std::strtod(text.c_str(), nullptr);
}

int count_in(const std::string& text)
{
    const double value = number_in(text);
    return value >= 0 && value <= std::numeric_limits<int>::max() ? static_cast<int>(value) : 0;
}

}  // namespace seldinger

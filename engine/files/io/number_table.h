#pragma once
// Tables of numbers in a text file: a line of names, then rows, separated by commas. Empty lines do not count, nor do lines that
// begin with #.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

struct NumberTable {
    std::filesystem::path file;
    std::vector<std::string> names;            // of the columns
    std::vector<std::vector<double>> columns;  // finite numbers
    std::vector<int> lines;                    // of each row, from 1
    [[nodiscard]] std::size_t rows() const { return lines.size(); }
    /// Its numbers; null: there is no such column.
    [[nodiscard]] const std::vector<double>* column(std::string_view name) const;
    /// @throws Error BadFile: "file:line: column: got X; expected Y"
    [[noreturn]] void fail(std::size_t row, std::string_view column, std::string_view message) const;
};

/// @throws Error BadFile: no such file, no rows, a row of another length, something that is no number, a name twice
[[nodiscard]] NumberTable read_number_table(const std::filesystem::path& file);

}  // namespace seldinger

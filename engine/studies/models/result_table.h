#pragma once
// A CSV table of finished runs that can be interrupted and resumed at any moment: one row per run, each written in one go.

#include "core/file_io.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace seldinger {

class ResultTable {
public:
    using Row = std::vector<std::string>;  // one text per column; may hold commas and quotes, no line ends

    /// Opens the table, or starts it. Rows of a table that is there are read; a last row that was cut off is dropped.
    /// @param keys  the first so many columns tell rows apart
    /// @throws Error BadFile: unreadable, or its header is another (written by another version: choose another folder)
    ResultTable(std::filesystem::path file, std::vector<std::string> columns, std::size_t keys);

    /// The last row with these keys; null when there is none. Valid until the next append.
    [[nodiscard]] const Row* find(const Row& keys) const;
    /// Adds a row; one with the same keys is superseded. @throws Error BadFile
    void append(const Row& row);
    /// In the order of their first appearance, superseded ones left out.
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
    [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }

private:
    void take_in(Row row);
    std::vector<std::string> columns_;
    std::size_t keys_;
    std::vector<Row> rows_;
    std::map<Row, std::size_t> index_;
    AppendFile file_;
};

/// A row as a CSV line (RFC 4180), line end included, and back.
[[nodiscard]] std::string csv_line(const ResultTable::Row& row);
[[nodiscard]] ResultTable::Row csv_fields(std::string_view line);
/// The shortest text that reads back to the same bits; empty for NaN and infinities: a table holds no such words.
[[nodiscard]] std::string csv_number(double value);
/// NaN for an empty text.
[[nodiscard]] double number_in(const std::string& text);
/// 0 for a value that is no valid int: anyone may have written the table.
[[nodiscard]] int count_in(const std::string& text);

}  // namespace seldinger

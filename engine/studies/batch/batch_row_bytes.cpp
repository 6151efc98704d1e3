// Rows of a batch as bytes, to a file and back from one of unknown origin.
#include "batch/batch_table.h"

#include "core/bytes.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// What a row of no instruments takes in a file.
constexpr std::size_t least_row = sizeof BatchRow::run + sizeof BatchRow::status + sizeof BatchRow::numbers +
                                  sizeof BatchRow::state_hash + 3 * sizeof(std::uint64_t);

bool is_hex(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

/// Counts stand in whole columns of the table; the other numbers may be any, and none too.
bool are_sound_counts(std::span<const BatchColumn> columns, std::span<const double> numbers)
{
    for (std::size_t c = 0; c < columns.size(); ++c)
        if (columns[c].whole && !(std::abs(numbers[c]) <= 0x1p53)) return false;
    return true;
}

bool has_sound_counts(const BatchRow& row)
{
    return are_sound_counts(batch_columns, row.numbers) &&
           std::all_of(row.instruments.begin(), row.instruments.end(),
                       [](const BatchRow::OfInstrument& of) { return are_sound_counts(instrument_columns, of); });
}

template <class Row>
void each_row_field(Row& row, auto& take)
{
    take(row.run), take(row.status), take(row.numbers), take(row.state_hash), take(row.branch_path), take(row.instruments);
    take(row.shape);
}

}  // namespace

void put_rows(std::vector<std::uint8_t>& bytes, std::span<const BatchRow> rows)
{
    ByteWriter put{bytes};
    put(std::uint64_t{rows.size()});
    for (const BatchRow& row : rows) each_row_field(row, put);
}

std::vector<BatchRow> take_rows(const std::uint8_t*& at, const std::uint8_t* end)
{
    ByteReader take{at, end};
    std::vector<BatchRow> rows(take.count(least_row));
    for (BatchRow& row : rows) each_row_field(row, take);
    at = take.at;
    return rows;
}

bool are_sound(std::span<const BatchRow> rows, std::size_t begin, std::size_t end, std::size_t instruments)
{
    std::vector<bool> seen(end - begin);
    for (const BatchRow& row : rows) {
        const auto run = static_cast<std::size_t>(row.run);  // a negative one is beyond every end
        if (run < begin || run >= end || seen[run - begin]) return false;
        if (row.instruments.size() != instruments || row.shape.size() != 3 * BatchRow::stations * instruments) return false;
        if (!std::all_of(row.shape.begin(), row.shape.end(), [](float x) { return std::isfinite(x); })) return false;
        if (row.status != RunStatus::Done && row.status != RunStatus::Stopped) return false;
        if (row.branch_path.find_first_not_of("0123456789.+") != std::string::npos) return false;
        if (!has_sound_counts(row) || !std::all_of(row.state_hash.begin(), row.state_hash.end(), is_hex)) return false;
        seen[run - begin] = true;
    }
    return true;
}

}  // namespace seldinger

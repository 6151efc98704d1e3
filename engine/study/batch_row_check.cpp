// Rows of a batch from a file that anyone may have written.
#include "study/batch_table.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

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

}  // namespace

bool are_sound(std::span<const BatchRow> rows, std::size_t begin, std::size_t end, std::size_t instruments)
{
    std::vector<bool> seen(end - begin);
    for (const BatchRow& row : rows) {
        const auto run = static_cast<std::size_t>(row.run);  // a negative one is beyond every end
        if (run < begin || run >= end || seen[run - begin]) return false;
        if (row.instruments.size() != instruments) return false;
        if (row.status != RunStatus::Done && row.status != RunStatus::Stopped) return false;
        if (!has_sound_counts(row) || !std::all_of(row.state_hash.begin(), row.state_hash.end(), is_hex)) return false;
        seen[run - begin] = true;
    }
    return true;
}

}  // namespace seldinger

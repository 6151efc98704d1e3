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

}  // namespace

void put_rows(std::vector<std::uint8_t>& bytes, std::span<const BatchRow> rows)
{
    const std::uint64_t count = rows.size();
    put_bytes(bytes, &count, 1);
    for (const BatchRow& row : rows) {
        const std::uint64_t instruments = row.instruments.size();
        put_bytes(bytes, &row.run, 1);
        put_bytes(bytes, &row.status, 1);
        put_bytes(bytes, row.numbers.data(), row.numbers.size());
        put_bytes(bytes, row.state_hash.data(), row.state_hash.size());
        const std::uint64_t letters = row.branch_path.size();
        put_bytes(bytes, &letters, 1);
        put_bytes(bytes, row.branch_path.data(), row.branch_path.size());
        put_bytes(bytes, &instruments, 1);
        put_bytes(bytes, row.instruments.data(), row.instruments.size());
        const std::uint64_t coordinates = row.shape.size();
        put_bytes(bytes, &coordinates, 1);
        put_bytes(bytes, row.shape.data(), row.shape.size());
    }
}

std::vector<BatchRow> take_rows(const std::uint8_t*& at, const std::uint8_t* end)
{
    // a count is no reason to ask for memory: rows are made as bytes are there for them
    const auto take_count = [&](std::size_t size) {
        std::uint64_t count = 0;
        take_bytes(at, end, &count, 1);
        if (count > static_cast<std::uint64_t>(end - at) / size)
            throw Error(ErrorKind::BadFile, "a list is longer than the file");
        return static_cast<std::size_t>(count);
    };
    std::vector<BatchRow> rows(take_count(least_row));
    for (BatchRow& row : rows) {
        take_bytes(at, end, &row.run, 1);
        take_bytes(at, end, &row.status, 1);
        take_bytes(at, end, row.numbers.data(), row.numbers.size());
        take_bytes(at, end, row.state_hash.data(), row.state_hash.size());
        row.branch_path.resize(take_count(1));
        take_bytes(at, end, row.branch_path.data(), row.branch_path.size());
        row.instruments.resize(take_count(sizeof(BatchRow::OfInstrument)));
        take_bytes(at, end, row.instruments.data(), row.instruments.size());
        row.shape.resize(take_count(sizeof(float)));
        take_bytes(at, end, row.shape.data(), row.shape.size());
    }
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

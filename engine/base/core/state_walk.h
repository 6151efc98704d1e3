#pragma once
// The table of the state: all data that must survive a step. The owner of such data lists it in one function, row by row, and a
// walk does the same with every row: saves, hashes, restores with a check, keeps for an attempt, puts back.

#include "core/bytes.h"
#include "core/fnv1a.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>

namespace seldinger {

/// A row of the table. Its contents are given beside it, as a span of numbers.
struct StateRow {
    const char* name;    // of one of its numbers, as an error says it
    const char* unit;    // "": none, or several
    const char* writer;  // stage of step.cpp
    // bounds of a sound number. They are wide: no run gets near them, and values beyond would overflow in an index, or make a
    // step without end
    double least = -1e18, most = 1e18;
};

class StateWalk {
public:
    /// State: what a run resumes from. Attempt: of one wire, what a step that has failed returns to.
    enum class Of { State, Attempt };
    /// Appends every row to `to`.
    explicit StateWalk(std::vector<std::uint8_t>& to, Of of = Of::State) : to_(&to), of_(of) {}
    /// Takes every row from `from` on. @param trusted  written by this world a moment ago: nothing is checked
    StateWalk(std::span<const std::uint8_t> from, bool trusted, Of of = Of::State)
        : at_(from.data()), end_(from.data() + from.size()), trusted_(trusted), of_(of)
    {
    }
    /// Continues a hash over every row.
    explicit StateWalk(std::uint64_t& hash) : hash_(&hash) {}

    [[nodiscard]] bool reads() const { return !to_ && !hash_; }
    /// Whether rows that are read must be checked: others may have written them.
    [[nodiscard]] bool checks() const { return reads() && !trusted_; }
    [[nodiscard]] bool of_attempt() const { return of_ == Of::Attempt; }
    /// Bytes that no row has taken.
    [[nodiscard]] std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }

    /// @param used  of the values, from the first on: the others are carried along, whatever they are
    /// @throws Error BadFile: fewer bytes are left, or a number is out of its row's bounds
    template <class T, std::size_t Extent>
    void operator()(const StateRow& row, std::span<T, Extent> values, std::size_t used)
    {
        if (to_) return put_bytes(*to_, values.data(), values.size());
        if (hash_) {
            static_assert(std::is_trivially_copyable_v<T>);
            *hash_ = fnv1a(values.data(), values.size_bytes(), *hash_);
            return;
        }
        take_bytes(at_, end_, values.data(), values.size());
        if constexpr (std::is_arithmetic_v<T>) {
            const auto sound = [&](double value) { return value >= row.least && value <= row.most; };  // false for NaN
            const auto first = values.first(used);
            need(trusted_ || std::all_of(first.begin(), first.end(), [&](T value) { return sound(static_cast<double>(value)); }),
                 row.name);
        }
    }
    template <class T, std::size_t Extent>
    void operator()(const StateRow& row, std::span<T, Extent> values)
    {
        (*this)(row, values, values.size());
    }
    template <class T>
    void operator()(const StateRow& row, T& value)
    {
        (*this)(row, std::span(&value, 1));
    }
    /// A struct, or an array of them, that holds nothing but doubles.
    template <class T, std::size_t Extent>
    void numbers(const StateRow& row, std::span<T, Extent> values)
    {
        static_assert(sizeof(T) % sizeof(double) == 0 && alignof(T) == alignof(double));
        (*this)(row, std::span(reinterpret_cast<double*>(values.data()), values.size_bytes() / sizeof(double)));
    }
    template <class T>
    void numbers(const StateRow& row, T& value)
    {
        numbers(row, std::span(&value, 1));
    }
    /// A list whose length is part of the state. @param most  of it
    template <class Count, class T>
    void list(const StateRow& row, std::vector<T>& values, std::size_t most = std::numeric_limits<std::size_t>::max())
    {
        auto count = static_cast<Count>(values.size());
        (*this)({row.name, "", row.writer}, count);
        if (reads()) {
            need(count >= 0 && static_cast<std::size_t>(count) <= std::min(most, left() / sizeof(T)), row.name);
            values.resize(static_cast<std::size_t>(count));
        }
        (*this)(row, std::span(values));
    }
    /// @throws Error BadFile where it is not sound
    static void need(bool sound, const char* what)
    {
        if (!sound) throw Error(ErrorKind::BadFile, fmt::format("the saved state is damaged: {} is out of bounds", what));
    }

private:
    std::vector<std::uint8_t>* to_ = nullptr;
    std::uint64_t* hash_ = nullptr;
    const std::uint8_t *at_ = nullptr, *end_ = nullptr;
    bool trusted_ = false;
    Of of_ = Of::State;
};

}  // namespace seldinger

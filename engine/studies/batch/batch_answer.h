#pragma once
// What a batch answers: how many runs reached the target, and which of them did it with the least force on the wall.

#include "batch/batch_table.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

struct BatchAnswer {
    struct Ranked {
        std::size_t run = 0;
        double value = 0, band = 0;  // largest force on a patch of the wall until the target was reached; NaN: no band [N]
    };
    std::size_t runs = 0, reached = 0, passed = 0;  // that ended; within the limits, too
    std::vector<Ranked> ranking;                    // of those that passed, the least force first, then by run
    std::vector<std::size_t> rising;                // of those, whose force still rose when the target was reached
    struct Ends {
        std::map<int, std::size_t> branches;        // runs whose tip ended in a branch, 0: before any
        std::map<std::pair<int, std::string>, std::size_t> places;  // the same by number and path
        std::map<int, std::size_t> left;            // runs whose tip is outside, by the inlet that it left through
        void take_in(const BatchRow& row);
    };
    Ends ends, missed;                              // of all; without the ones that reached the target
    std::optional<std::size_t> nearest;             // run whose tip ended nearest to the target, where none reached it
    double nearest_distance = 0;                    // [m]
};

[[nodiscard]] BatchAnswer answer_of(const BatchLayout& layout, const std::vector<BatchRow>& rows);

/// One line: "2 of 3 reached left subclavian; least peak on 5 mm of wall: run 0 (bentson-035), 0.10 ± 0.01 N". Empty where there
/// is nothing to say.
[[nodiscard]] std::string answer_line(const Sweep& sweep, const BatchLayout& layout, const BatchAnswer& answer);

}  // namespace seldinger

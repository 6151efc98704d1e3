#pragma once
// The refusal of a file whose contents contradict each other.

#include "core/error.h"

#include <string>

namespace seldinger {

/// @param what  "got X; expected Y"
[[noreturn]] inline void refuse_damaged(const std::string& name, const std::string& what)
{
    throw Error(ErrorKind::BadFile, name + ": " + what + ": the file is truncated or damaged. Fix: copy or export it again");
}

/// The refusal of a word that is no number. Programs write decimal commas where the system's language has them.
/// @param where  "facet 1: "  @param word  short enough for a message
[[noreturn]] inline void refuse_number(const std::string& name, const std::string& where, const std::string& word)
{
    const std::size_t comma = word.find(',');
    const auto is_digit = [&](std::size_t k) { return k < word.size() && word[k] >= '0' && word[k] <= '9'; };
    if (comma != std::string::npos && comma > 0 && is_digit(comma - 1) && is_digit(comma + 1))
        throw Error(ErrorKind::BadFile, name + ": " + where + "got \"" + word +
                                            "\"; expected a number with a decimal point, not a comma. Fix: export it again with "
                                            "the system's language set to English");
    refuse_damaged(name, where + "got \"" + word + "\"; expected a number");
}

}  // namespace seldinger

#pragma once
// Output on stderr beside the work: notes, progress, the last line of an error.

#include <cstdio>
#include <string_view>

namespace seldinger {

/// If stderr cannot take it (its disk is full, its reader has gone), the note is lost, and the work continues. fmt::print would
/// throw, and end the process while an error is being printed.
inline void note(std::string_view text) { (void)std::fwrite(text.data(), 1, text.size(), stderr); }

}  // namespace seldinger

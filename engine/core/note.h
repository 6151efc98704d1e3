#pragma once
// Output on stderr beside the work: notes, progress, the last line of an error.

#include <cstdio>
#include <string_view>

namespace seldinger {

/// Where stderr cannot take it (its disk is full, its reader has gone) it is lost, and the work goes on: fmt::print would throw,
/// and from where an error is being said end the process.
inline void note(std::string_view text) { (void)std::fwrite(text.data(), 1, text.size(), stderr); }

}  // namespace seldinger

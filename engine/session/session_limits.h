#pragma once
// How much of anything a live session takes; what comes from outside is cut off here.

namespace seldinger {

inline constexpr int most_instruments = 8;  // of the world's first system
inline constexpr int most_view_nodes = 4096;  // of one instrument, shown to a page

}  // namespace seldinger

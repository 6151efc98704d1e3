#pragma once
// Limits of a live session; excess input from outside is cut off here.

#include <cstddef>

namespace seldinger {

inline constexpr int most_instruments = 8;  // of the world's first system
inline constexpr int most_view_nodes = 4096;  // of one instrument, shown to a page
inline constexpr std::size_t most_connections = 64, most_connections_of_one = 16, most_sockets = 8;  // of pages; of one address
inline constexpr std::size_t most_header_bytes = 8192,
                             most_message_bytes = 1024;  // of a page's requests, and of what it says then

}  // namespace seldinger

#pragma once
// Messages of a page over its WebSocket.

#include <cstdint>
#include <string_view>

namespace seldinger {

/// What a page wants; the newest counts.
struct PageWish {
    int instrument = 0;
    double push = 0, turn = 0;  // [m/s], [rad/s]
    double until = 0;           // on the session's clock: a page that falls silent pushes no more [s]
    bool fluoroscopy = false, contrast = false, paused = false;
    std::uint32_t resets = 0;  // asked for so far
};

/// Applies a page's message: its named values change; an invalid message changes nothing.
/// @return false: not one
[[nodiscard]] bool read_wish(std::string_view text, PageWish& wish, bool& reset);

}  // namespace seldinger

// Reads a page's messages: JSON from outside, every value held against its bounds.
#include "session/page_wish.h"

#include "session/session_limits.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace seldinger {

bool read_wish(std::string_view text, PageWish& wish, bool& reset)
{
    const auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object()) return false;
    const auto number = [&](const char* key, double limit, double& value) {
        const auto found = json.find(key);
        if (found == json.end()) return true;
        if (!found->is_number() || !(std::abs(found->get<double>()) <= limit)) return false;
        value = found->get<double>();
        return true;
    };
    const auto flag = [&](const char* key, bool& value) {
        const auto found = json.find(key);
        if (found == json.end()) return true;
        if (!found->is_boolean()) return false;
        value = found->get<bool>();
        return true;
    };
    PageWish said = wish;
    double instrument = wish.instrument;
    bool again = false;
    const bool good = number("push", 0.2, said.push) && number("turn", 20, said.turn) &&
                      number("instrument", most_instruments - 1, instrument) && flag("fluoro", said.fluoroscopy) &&
                      flag("contrast", said.contrast) && flag("pause", said.paused) && flag("reset", again);
    if (!good || instrument < 0 || instrument != std::floor(instrument)) return false;
    said.instrument = static_cast<int>(instrument);
    wish = said;
    reset = again;
    return true;
}

}  // namespace seldinger

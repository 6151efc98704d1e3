// Walks UTF-8 by its lead bytes and lets printable characters through.
#include "core/printable.h"

#include <algorithm>
#include <cstdint>

namespace seldinger {
namespace {

/// Bytes of the UTF-8 character at the front of `text`, 0 when there is none. @param code  out, its number
std::size_t utf8_character(std::string_view text, std::uint32_t& code)
{
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned char lead = byte(0);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xc2 && lead < 0xe0 ? 2
                               : lead >= 0xe0 && lead < 0xf0 ? 3
                               : lead >= 0xf0 && lead < 0xf5 ? 4
                                                             : 0;
    if (length == 0 || length > text.size()) return 0;
    code = length == 1 ? lead : lead & (0x7fu >> length);
    for (std::size_t k = 1; k < length; ++k) {
        if ((byte(k) & 0xc0) != 0x80) return 0;
        code = code << 6 | (byte(k) & 0x3fu);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xd800 && code < 0xe000;
    return code < least[length] || code > 0x10ffff || surrogate ? 0 : length;
}

bool can_be_seen(std::uint32_t code)
{
    if (code == '\n') return true;
    if (code < 0x20 || (code >= 0x7f && code < 0xa0)) return false;  // C0, DEL and C1: ESC and its one-byte forms
    if (code == 0xad || code == 0x061c || code == 0xfeff) return false;
    if (code >= 0x200b && code <= 0x200f) return false;                                          // without width; direction
    if ((code >= 0x2028 && code <= 0x202e) || (code >= 0x2060 && code <= 0x206f)) return false;  // line ends; direction
    return code < 0xe0000;                                                                       // tags, private use
}

}  // namespace

std::string printable(std::string_view text, std::size_t most)
{
    std::string shown;
    shown.reserve(std::min(text.size(), most));
    while (!text.empty()) {
        std::uint32_t code = 0;
        const std::size_t length = utf8_character(text, code);
        if (most - shown.size() < std::max<std::size_t>(length, 1)) return shown + "...";
        if (length > 0 && code == '\t') shown += ' ';
        else if (length > 0 && can_be_seen(code)) shown += text.substr(0, length);
        else shown += '?';
        text.remove_prefix(length > 0 ? length : 1);
    }
    return shown;
}

std::string with_short_words(std::string_view text, std::size_t most)
{
    std::string shown;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
        const std::string_view word = text.substr(at, end - at);
        if (word.size() <= most) shown += word;
        else {
            const std::string said = "[..." + std::to_string(word.size()) + " characters...]";
            const auto inside = [&](std::size_t k) {
                return (static_cast<unsigned char>(word[k]) & 0xc0) == 0x80;
            };  // of a UTF-8 character
            std::size_t front = (most - said.size()) / 2, back = word.size() - front;
            while (front > 0 && inside(front)) --front;
            while (back < word.size() && inside(back)) ++back;
            shown.append(word.substr(0, front)).append(said).append(word.substr(back));
        }
        if (end < text.size()) shown += text[end];
        at = end + 1;
    }
    return shown;
}

std::string one_line(std::string text)
{
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
    return text;
}

std::string count_of(std::size_t n, std::string_view one, std::string_view many)
{
    return std::to_string(n) + " " + std::string(n == 1 ? one : many);
}

}  // namespace seldinger

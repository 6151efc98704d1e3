// Strings of TOML, escaped.
#include "scene/toml_text.h"

#include <fmt/format.h>

namespace seldinger {

std::string toml_quoted(std::string_view text)
{
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\', out += c;
        else if (static_cast<unsigned char>(c) < 32 || c == 127) out += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
        else out += c;
    }
    return out + '"';
}

}  // namespace seldinger

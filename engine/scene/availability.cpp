// The list of choices that the scene file names and this build does not have, each with what to use instead.
#include "scene/availability.h"

#include "scene/toml_table.h"

#include <fmt/format.h>

#include <array>

namespace seldinger {
namespace {

struct NotBuilt {
    const char *key, *word, *instead;
};

constexpr std::array<NotBuilt, 0> not_built = {};  // at present everything is there

}  // namespace

void refuse_what_is_not_built(const toml::table& root)
{
    for (const NotBuilt& entry : not_built) {
        const auto node = root.at_path(entry.key);
        if (node.value<std::string>() != entry.word) continue;
        fail_at(node.node()->source(), entry.key,
                fmt::format("\"{}\" is not available yet; use \"{}\"", entry.word, entry.instead));
    }
}

}  // namespace seldinger

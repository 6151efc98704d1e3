// Reads a run's scene from its open folder.
#include "scene/run_scene.h"

#include "scene/toml_parse.h"
#include "scene/toml_table.h"

namespace seldinger {

Scene read_run_scene(const Folder& run, std::span<const std::string> overrides)
{
    const FilePlace file = run / "scene.toml";
    const std::string text = read_scene_file(file);
    const toml::table root = parse_toml(text, file.path());
    if (const toml::node* include = root.get("include"))
        fail_at(include->source(), "include",
                "the scene of a run is whole and includes nothing; take it out, or run the scene again");
    return read_scene_text(text, file.path(), overrides);
}

}  // namespace seldinger

// Tables of state hashes: parsing, and running what a row describes as `seldinger run` and `seldinger batch` do.
#include "golden/golden_table.h"

#include "engine.h"
#include "run/scene_run.h"
#include "setup/scene_setup.h"
#include "setup/vessel_load.h"
#include "support/shared_folder.h"

#include <doctest/doctest.h>

#include <fstream>
#include <sstream>

namespace seldinger::test {
namespace {

namespace fs = std::filesystem;

const std::string shared_mark = "$SHARED";

std::string with_shared_folder(std::string text)
{
    if (const auto at = text.find(shared_mark); at != std::string::npos)
        text.replace(at, shared_mark.size(), shared_folder().value().string());
    return text;
}

Scene scene_of(const GoldenRow& row)
{
    std::vector<std::string> overrides;
    for (const std::string& setting : row.settings) overrides.push_back(with_shared_folder(setting));
    if (row.duration != "whole") overrides.push_back("scene.duration_s=" + row.duration);
    const fs::path file = with_shared_folder(row.scene);
    return read_scene(file.is_absolute() ? file : fs::path(SEL_SOURCE_DIR) / file, overrides);
}

void check_world(const std::vector<GoldenRow>& rows, int device_index)
{
    CAPTURE(rows.front().line());
    std::vector<Scene> scenes;
    for (const GoldenRow& row : rows) scenes.push_back(scene_of(row));
    World world(make_setup(scenes, load_vessel(scenes.front().vessel), device_index));
    const bool done = SceneRun(world, scenes).run() == RunStatus::Done;
    CHECK_MESSAGE(done, "stopped at " << world.time() << " s");
    if (!done) return;
    for (std::size_t w = 0; w < rows.size(); ++w) {
        GoldenRow found = rows[w];
        found.hash = world.state_hash(static_cast<int>(w));
        const std::string line = (w > 0 ? "  " : "") + found.line();
        CHECK_MESSAGE(found.hash == rows[w].hash,
                      "if the change of bits is meant (docs/determinism.md), the line becomes\n" << line);
    }
}

}  // namespace

std::string GoldenRow::line() const
{
    std::string text = hash + " " + duration + " " + scene;
    for (const std::string& setting : settings) text += " " + setting;
    return text;
}

bool GoldenRow::needs_shared() const { return line().find(shared_mark) != std::string::npos; }

std::vector<std::vector<GoldenRow>> read_golden_table(const fs::path& file)
{
    std::vector<std::vector<GoldenRow>> worlds;
    std::ifstream in(file);
    REQUIRE_MESSAGE(in.good(), file.string());
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        GoldenRow row;
        if (!(words >> row.hash) || row.hash.front() == '#') continue;
        REQUIRE_MESSAGE((words >> row.duration >> row.scene && row.hash.size() == 16), file.string() << ": " << line);
        for (std::string setting; words >> setting;) row.settings.push_back(setting);
        if (line.front() != ' ') worlds.emplace_back();
        REQUIRE_MESSAGE(!worlds.empty(), file.string() << ": the first row is indented");
        worlds.back().push_back(std::move(row));
    }
    return worlds;
}

void check_golden_table(const std::string& name, int device_index)
{
    for (const auto& rows : read_golden_table(fs::path(SEL_SOURCE_DIR) / "tests/golden" / name)) {
        if (rows.front().needs_shared() && !shared_folder_or_skip()) continue;
        check_world(rows, device_index);
    }
}

}  // namespace seldinger::test

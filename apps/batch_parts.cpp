// Begins a batch in parts, and merges its parts.
#include "batch_loop.h"
#include "core/file_io.h"
#include "io/json_text.h"

#include <fmt/format.h>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

/// All that a part's result depends on besides its number.
std::string batch_key(const BatchSource& source, const std::string& sweep_text)
{
    std::vector<std::string> texts = {version(), resolved_scene(source, fs::absolute(source.scene_file).parent_path()),
                                      sweep_text};
    if (const Scene scene = source.scene(0); !scene.vessel.mesh.empty()) texts.push_back(read_file(scene.vessel.mesh));
    return plan_key(texts);
}

/// The part from the first folder that has all of it.
std::optional<SavedBatch> find_part(const std::vector<Folder>& folders, const PartPlan& plan, std::size_t part)
{
    for (const Folder& folder : folders)
        if (std::optional<SavedBatch> saved = read_part(folder, plan, part); saved && saved->rows.size() == plan.size(part))
            return saved;
    return std::nullopt;
}

/// What parts leave beside their rows, from the folder of some to that of the merge.
void copy_files(const Folder& from, const Folder& to)
{
    copy_kept(from, to);
    if (from.has("vessel.vtp") && !to.has("vessel.vtp")) write_file(to / "vessel.vtp", read_file(from / "vessel.vtp"));
}

}  // namespace

PartPlan begin_parts(const BatchSource& source, const std::string& sweep_text, std::size_t parts, const fs::path& dir)
{
    PartPlan plan;
    plan.items = source.item_count(), plan.parts = parts;
    if (parts > plan.items)
        throw Error(ErrorKind::BadScene,
                    fmt::format("got {} parts, where there are only {} runs. Fix: take that many or fewer", parts, plan.items));
    plan.key = batch_key(source, sweep_text);
    make_folder(dir);
    const Folder folder(dir);
    // in this order: another part may begin meanwhile
    if (holds_a_batch(folder) && !folder.has("parts.json") && !folder.has("farm.json"))
        throw Error(ErrorKind::BadScene, dir.string() + ": holds a batch, a run or a scene; choose another folder with -o");
    write_plan(folder, plan);
    return plan;
}

void say_missing(const Folder& dir, const PartPlan& plan, const std::vector<std::size_t>& parts)
{
    std::vector<std::size_t> items;
    for (const std::size_t part : parts)
        for (std::size_t i = plan.range(part).begin; i < plan.range(part).end; ++i) items.push_back(plan.first + i);
    throw Error(
        ErrorKind::BadFile,
        fmt::format("{}: {} of {} parts are missing: {} ({}s {}). Fix: run the same command again, and merge then",
                    dir.path().string(), parts.size(), plan.parts, list_ranges(parts), plan.item_word(), list_ranges(items)));
}

RunOutcome merge_parts(const std::vector<fs::path>& dirs)
{
    const std::vector<Folder> folders(dirs.begin(), dirs.end());
    const Folder& folder = folders.front();
    const PartPlan plan = read_plan(folder);
    for (const Folder& other : folders)
        if (const PartPlan its = read_plan(other); its.key != plan.key || its.parts != plan.parts || its.items != plan.items)
            throw Error(ErrorKind::BadScene, fmt::format("{}: holds parts of another batch than {}. Fix: merge the parts of one",
                                                        other.path().string(), folder.path().string()));
    SavedBatch all;
    std::vector<std::size_t> missing;
    for (std::size_t part = 1; part <= plan.parts; ++part) {
        std::optional<SavedBatch> saved = find_part(folders, plan, part);
        if (!saved) {
            missing.push_back(part);
            continue;
        }
        if (all.rows.empty()) std::swap(all, *saved);
        else if (saved->sweep == all.sweep && saved->instruments == all.instruments)
            all.rows.insert(all.rows.end(), saved->rows.begin(), saved->rows.end());
    }
    if (!missing.empty()) say_missing(folder, plan, missing);
    const Sweep sweep = read_sweep_text(all.sweep, folder.path() / "sweep.toml", all.seed);
    if (all.rows.size() != plan.items || all.layout.runs != sweep.run_count() ||
        plan.items != (all.layout.bands ? 2 : 1) * sweep.run_count())
        throw Error(ErrorKind::BadFile,
                    (folder.path() / "parts").string() + ": the parts do not fit together. Fix: begin again in another folder");
    for (const Folder& other : folders)
        if (&other != &folder) copy_files(other, folder);
    const BatchTable table{sweep, all.layout};
    Json summary;
    summary["name"] = all.name;
    summary["status"] = "done";
    add_answer(summary, table, all.rows);
    summary["results"] = "results.csv";
    summary["version"] = version();
    summary["parts"] = plan.parts;
    write_file(folder / "summary.json", json_text(summary, 2) + "\n");
    write_tables(folder, table, all.rows);
    return {summary["stopped"].get<long>() > 0 ? ErrorKind::Stopped : ErrorKind::None, json_text(summary, 2) + "\n", {}};
}

}  // namespace seldinger::apps

// seldinger dataset SCENE.toml --vary SWEEP.toml --frames N -o DIR [--format folder|coco] [--backend ...] [options of render]
//
// A farm whose tasks run, draw and label. Each run of the sweep is a scene of its own and leaves runs/run_######.json when all of
// its pictures are there, so the bytes do not depend on how the runs are divided.
#include "dataset.h"

#include "batch/batch.h"
#include "child_process.h"
#include "command_line.h"
#include "commands.h"
#include "core/exit_code.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "core/fnv1a.h"
#include "core/parallel.h"
#include "engine.h"
#include "farm.h"
#include "io/json_text.h"
#include "render_frames.h"
#include "run_loop.h"
#include "scene/toml_parse.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <memory>

#ifdef SEL_WITH_VIEW
    #include "view/run_folder.h"
#endif

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// All that the pictures depend on; every task reads it from the folder.
struct Settings {
    fs::path scene;  // where it lies: paths in it start there
    std::vector<std::string> overrides, render;
    int frames = 0;
    std::string format, licence;
    fs::path views;  // sweep of them; tasks read the folder's copy

    /// Whether an option of render was given, as --name or --name=value.
    [[nodiscard]] bool draws_with(const std::string& option) const
    {
        return std::any_of(render.begin(), render.end(),
                           [&](const std::string& word) { return word == option || word.starts_with(option + "="); });
    }
    /// The words of render that say what the pictures look like.
    [[nodiscard]] std::vector<std::string> look() const
    {
        std::vector<std::string> words;
        if (!draws_with("--view")) words = {"--view", "fluoro"};
        if (!views.empty()) words.insert(words.end(), {"--views", views.string()});
        words.insert(words.end(), render.begin(), render.end());
        return words;
    }
};

struct DatasetArguments : Settings {
    fs::path sweep, dir, part_of, preview;
    std::string count;  // --frames: of each run; of a task FIRST:LAST of the runs
    int parent = 0;
    FarmBackend backend;
};

std::string as_json(const Settings& s)
{
    return json_text(Json{{"scene", s.scene.string()},
                          {"set", s.overrides},
                          {"render", s.render},
                          {"frames", s.frames},
                          {"format", s.format},
                          {"licence", s.licence}},
                     2) +
           "\n";
}

Settings read_settings(const Folder& dir)
{
    const Folder parts = dir.inner("parts");
    const Json in = Json::parse(read_file(parts / "dataset.json"));
    Settings s{
        in.at("scene").get<std::string>(), in.at("set"), in.at("render"), in.at("frames"), in.at("format"), in.at("licence"), {}};
    if (parts.has("views.toml")) s.views = dir.path() / "parts/views.toml";
    return s;
}

/// The runs, from the folder's copies of scene and sweep.
BatchSource read_source(const Folder& dir, const Settings& settings)
{
    const Folder parts = dir.inner("parts");
    return make_source(read_file(parts / "scene.toml"), settings.scene, settings.overrides, read_file(parts / "sweep.toml"),
                       parts.path() / "sweep.toml");
}

/// A run with as many frames as asked for, spread evenly, the last at its end; each with contacts and forces.
Scene scene_of(const BatchSource& source, std::size_t run, int frames)
{
    Scene scene = source.scene(run);
    const long every = scene.steps() / frames;
    if (every < 1)
        throw Error(ErrorKind::BadScene, fmt::format("--frames {}: run {} has only {} steps. Fix: fewer frames, or a longer run",
                                                     frames, run, scene.steps()));
    scene.record_every = scene.wire_every = scene.contacts_every = static_cast<int>(every);
    return scene;
}

/// Vessels as far as pictures show them: two runs of one key must not lie in different splits.
class VesselKeys {
public:
    [[nodiscard]] std::string of(const Scene& scene)
    {
        const VesselSpec& v = scene.vessel;
        if (!v.mesh.empty()) {
            std::string& content = meshes_[v.mesh];
            if (content.empty()) content = plan_key({read_file(v.mesh)});
            return plan_key({content, v.units, v.label_text()});
        }
        const std::string text = write_scene(scene, {});
        const std::size_t begin = text.find("[vessel]");
        return plan_key({begin == std::string::npos ? "" : text.substr(begin, text.find("\n[", begin) - begin)});
    }

private:
    std::map<fs::path, std::string> meshes_;  // each is read once
};

/// Noise of its own for each run, whichever task draws it.
std::string seed_of(const Scene& scene, std::size_t run)
{
    const std::uint64_t number = run;
    return std::to_string(fnv1a(&number, sizeof number, fnv1a(&scene.seed, sizeof scene.seed)) >> 34);
}

/// Frames by `seldinger render`, in a process whose memory goes with it. @return the first and the last of them
std::pair<std::size_t, std::size_t> draw(const Settings& settings, const fs::path& run, const Scene& scene, std::size_t number,
                                         std::vector<std::string> words)
{
#ifdef SEL_WITH_VIEW
    const std::size_t all = read_run_folder(run).frames.size();
#else
    const std::size_t all = 1;
#endif
    const std::size_t last = std::min<std::size_t>(static_cast<std::size_t>(settings.frames), all - 1);
    const std::size_t first = std::min<std::size_t>(1, last);  // frame 0 is before the first step
    words.insert(words.begin(), {"render", run.string(), "--frames", fmt::format("{}:{}", first, last)});
    const std::vector<std::string> look = settings.look();
    words.insert(words.end(), look.begin(), look.end());
    if (!settings.draws_with("--view") && !settings.draws_with("--seed"))
        words.insert(words.end(), {"--seed", seed_of(scene, number)});
    if (const ChildEnd end = run_self(words, ""); end.code != 0)
        throw Error(kind_of_exit_code(end.code), fmt::format("run {}: its pictures were not made; see above", number));
    return {first, last};
}

std::string run_name(std::size_t run) { return fmt::format("run_{:06}", run); }

/// Runs it in DIR/work. @return what summary.json says
Json simulate(const Scene& scene, const fs::path& work, int device)
{
    RunOptions options;
    options.dir = work;
    options.use = FolderUse::Resume;  // one that was stopped goes on
    options.estimate = false, options.quiet = true, options.device = device;
    const RunOutcome outcome = run_scene(scene, options);
    if (outcome.code != ErrorKind::None && outcome.code != ErrorKind::Stopped) throw Error(outcome.code, outcome.message);
    return Json::parse(outcome.summary);
}

/// Pictures, labels and the file that says so.
void make_run(const Folder& dir, const Settings& settings, const BatchSource& source, std::size_t run,
              const std::vector<std::string>& patterns, VesselKeys& vessels, const LocalBackend& backend)
{
    const std::string name = run_name(run);
    const Folder runs = dir.make("runs");
    if (runs.has(name + ".json")) return;
    const Scene scene = scene_of(source, run, settings.frames);
    const fs::path work = dir.make("work").path() / name;
    const Json summary = simulate(scene, work, backend.device);
    Json out = {{"run", run},
                {"status", summary.at("status")},
                {"values", source.sweep.overrides(run)},
                {"vessel", vessels.of(scene)},
                {"state_hash", summary.at("state_hash")},
                {"pictures", Json::array()}};
    if (out["status"] == "done") {
        std::vector<std::string> words = {"-o",         (dir.make("images").path() / (name + ".png")).string(),
                                          "--labels",   dir.make("labels").path().string(),
                                          "--numbered", "--resume"};
        if (run > 0) words.emplace_back("--quiet");  // what render warns of is said once
        if (backend.threads > 0) words.insert(words.end(), {"--threads", std::to_string(backend.threads)});
        const auto [first, last] = draw(settings, work, scene, run, words);
        for (const std::string& pattern : patterns)
            for (std::size_t frame = first; frame <= last; ++frame) out["pictures"].push_back(frame_file(name + pattern, frame));
    }
    write_file(runs / (name + ".json"), json_text(out, 2) + "\n", Durable::Yes);
    fs::remove_all(work);
}

/// What follows run_000012 in the names of a run's pictures: "_######.png", or "_v2_######.png" of each view.
std::vector<std::string> picture_patterns(const Settings& settings)
{
    std::vector<std::string> patterns;
    for (const std::string& file : files_of_frame(settings.look())) patterns.push_back(file.substr(std::string("frame").size()));
    return patterns;
}

ErrorKind make_part(const DatasetArguments& options)
{
    if (options.parent > 0) end_with_parent(options.parent, SIGTERM);
    if (options.backend.local.threads > 0) set_thread_count(options.backend.local.threads);
    const Folder dir(options.part_of);
    const Settings settings = read_settings(dir);
    const BatchSource source = read_source(dir, settings);
    const auto [first, last] = two_numbers(options.count, ':', "--frames", "FIRST:LAST of the runs");
    const std::vector<std::string> patterns = picture_patterns(settings);
    const StopSignal listening("run the same command again");
    VesselKeys vessels;
    for (int run = first; run <= last; ++run) {
        if (const int asked = stop_asked_for(); asked != 0)
            return asked == SIGINT ? ErrorKind::Interrupted : ErrorKind::TimeLimit;
        make_run(dir, settings, source, static_cast<std::size_t>(run), patterns, vessels, options.backend.local);
    }
    return ErrorKind::None;
}

// ---------------------------------------------------------------- what describes all of it

struct Split {
    const char* name;
    std::vector<std::string> vessels, pictures;
};

/// By vessel, in the order of their keys: a tenth each for val and test, at least one where there are three.
std::vector<Split> split(const std::map<std::string, std::vector<std::string>>& pictures_of)
{
    const std::size_t all = pictures_of.size(), each = all < 3 ? 0 : std::max<std::size_t>(1, (all + 5) / 10);
    std::vector<Split> splits = {{"train", {}, {}}, {"val", {}, {}}, {"test", {}, {}}};
    std::size_t k = 0;
    for (const auto& [vessel, pictures] : pictures_of) {
        Split& into = splits[k < each ? 2 : k < 2 * each ? 1 : 0];
        into.vessels.push_back(vessel);
        into.pictures.insert(into.pictures.end(), pictures.begin(), pictures.end());
        ++k;
    }
    for (Split& s : splits) std::sort(s.pictures.begin(), s.pictures.end());
    return splits;
}

std::string card(const Json& about, const Settings& settings, const std::vector<Split>& splits)
{
    std::string text = fmt::format("# {}: labelled pictures of simulated instruments\n\n", about.at("scene").get<std::string>());
    text += fmt::format("Made by Seldinger {}: {} runs, {} pictures. Runs that ended early and have none: {}.\n\n", version(),
                        about.at("runs").get<std::size_t>(), about.at("pictures").get<std::size_t>(),
                        about.at("stopped").get<std::size_t>());
    text += fmt::format("Licence: {}\n\n| varied | values |\n|---|---|\n",
                        settings.licence.empty() ? "not stated" : settings.licence);
    for (const auto& [key, values] : about.at("varied").items())
        text += fmt::format("| `{}` | {} |\n", key, values.get<std::string>());
    text += "\n| split | vessels | pictures |\n|---|---|---|\n";
    for (const Split& s : splits) text += fmt::format("| {} | {} | {} |\n", s.name, s.vessels.size(), s.pictures.size());
    text +=
        "\nNo vessel is in two splits. Files of one picture: `images/NAME.png`, `labels/NAME.json`, `labels/NAME_mask.png`; what "
        "they hold is on "
        "the page on labels of Seldinger's documentation.\n";
    return text + fmt::format("\nOptions of the pictures: `{}`. Hash of all files: `{}`.\n", shell_text(settings.render),
                              about.at("hash").get<std::string>());
}

/// "0.02 to 0.3, 50 drawn", or the list.
std::string values_in_words(const SweepAxis& axis)
{
    if (!axis.drawn) return fmt::format("{}", fmt::join(axis.values, ", "));
    const auto number = [](const std::string& text) { return std::strtod(text.c_str(), nullptr); };
    const auto [low, high] = std::minmax_element(axis.values.begin(), axis.values.end(),
                                                 [&](const auto& a, const auto& b) { return number(a) < number(b); });
    return fmt::format("{} to {}, {} drawn", *low, *high, axis.values.size());
}

}  // namespace

ErrorKind finish_dataset(const fs::path& path, bool quiet)
{
    const Folder dir(path), runs = dir.inner("runs");
    const PartPlan plan = read_plan(dir);
    const Settings settings = read_settings(dir);
    std::map<std::string, std::vector<std::string>> pictures_of;  // by vessel
    const Folder images = dir.make("images"), labels_dir = dir.make("labels");
    FieldCuts cuts;
    std::size_t stopped = 0, pictures = 0;
    std::uint64_t hash = fnv1a_start;
    const auto take_in = [&](const std::string& bytes) { hash = fnv1a(bytes.data(), bytes.size(), hash); };
    for (std::size_t run = 0; run < plan.items; ++run) {
        const std::string text = read_file(runs / (run_name(run) + ".json"));
        const Json in = Json::parse(text);
        take_in(text);
        stopped += in.at("status") != "done";
        auto& of = pictures_of[in.at("vessel")];
        for (const std::string name : in.at("pictures")) {
            of.push_back(name), ++pictures;
            const std::string stem = fs::path(name).stem().string();
            const std::string truth = read_file(labels_dir / (stem + ".json"));
            take_in(read_file(images / name)), take_in(truth), take_in(read_file(labels_dir / (stem + "_mask.png")));
            cuts.take_in(nlohmann::json::parse(truth).at("instruments"));
        }
    }
    const std::vector<Split> splits = split(pictures_of);
    Json about = {{"scene", settings.scene.stem().string()},
                  {"version", version()},
                  {"runs", plan.items},
                  {"stopped", stopped},
                  {"pictures", pictures},
                  {"frames_of_a_run", settings.frames},
                  {"render", settings.render},
                  {"licence", settings.licence},
                  {"hash", fmt::format("{:016x}", hash)}};
    for (const SweepAxis& axis : read_source(dir, settings).sweep.axes) about["varied"][axis.key] = values_in_words(axis);
    for (const Split& s : splits) {
        about["splits"][s.name] = {{"vessels", s.vessels}, {"pictures", s.pictures.size()}};
        std::string list;
        std::vector<fs::path> labels;
        for (const std::string& name : s.pictures) {
            list += name + "\n";
            labels.push_back(path / "labels" / (fs::path(name).stem().string() + ".json"));
        }
        write_file(dir / (std::string(s.name) + ".txt"), list);
        if (settings.format == "coco" && !labels.empty()) write_coco(labels, dir / fmt::format("coco_{}.json", s.name), true);
    }
    write_file(dir / "dataset.json", json_text(about, 2) + "\n");
    write_file(dir / "card.md", card(about, settings, splits));
    (void)dir.remove("work");
    if (!quiet)
        print(fmt::format("{}: {} pictures of {} runs; train, val, test: {}, {}, {} pictures of {}, {}, {} vessels\n",
                          path.string(), pictures, plan.items, splits[0].pictures.size(), splits[1].pictures.size(),
                          splits[2].pictures.size(), splits[0].vessels.size(), splits[1].vessels.size(),
                          splits[2].vessels.size()));
    if (!quiet) cuts.warn();
    return stopped > 0 ? ErrorKind::Stopped : ErrorKind::None;
}

namespace {

/// One run's pictures on one sheet, to look at before the others are made.
ErrorKind show(const DatasetArguments& options, const BatchSource& source)
{
    const fs::path work = options.preview.string() + ".run";
    fs::remove_all(work);
    const Scene scene = scene_of(source, 0, options.frames);
    (void)simulate(scene, work, options.backend.local.device);
    draw(options, work, scene, 0, {"--preview", options.preview.string()});
    fs::remove_all(work);
    return ErrorKind::None;
}

ErrorKind dataset(DatasetArguments& options)
{
#ifndef SEL_WITH_VIEW
    throw Error(ErrorKind::BadScene, "dataset: this build has no renderer; configure with -DSELDINGER_VIEW=ON");
#endif
    if (!options.part_of.empty()) return make_part(options);
    if (options.scene.empty() || options.sweep.empty())
        throw Error(ErrorKind::BadScene, "dataset: got no runs; expected SCENE.toml and --vary SWEEP.toml. Fix: give both");
    const char* const end = options.count.data() + options.count.size();
    if (std::from_chars(options.count.data(), end, options.frames).ptr != end || options.frames < 1)
        throw Error(
            ErrorKind::BadScene,
            fmt::format("--frames: got \"{}\"; expected how many pictures of a run each view has, from 1", options.count));
    options.scene = fs::absolute(options.scene).lexically_normal();
    const std::string scene_text = read_scene_file(options.scene),
                      sweep_text = with_designs(read_scene_file(options.sweep), options.sweep);
    const BatchSource source = make_source(scene_text, options.scene, options.overrides, sweep_text, options.sweep);
    const std::string views = options.views.empty() ? "" : read_file(options.views);
    (void)picture_patterns(options);
    std::vector<std::string> texts = {version(), scene_text, sweep_text, views, as_json(options)};
    VesselKeys vessels;
    for (std::size_t run = 0; run < source.item_count(); ++run)
        texts.push_back(vessels.of(scene_of(source, run, options.frames)));
    if (!options.preview.empty()) return show(options, source);
    if (options.dir.empty()) throw Error(ErrorKind::BadScene, "dataset: give a folder for pictures and labels with -o DIR");
    options.dir = fs::absolute(options.dir).lexically_normal();
    options.backend.check(options.dir);
    PartPlan plan;
    plan.frames = true, plan.rate = 1, plan.files = {PartPlan::dataset_file};
    plan.items = source.item_count();
    plan.parts = options.backend.part_count(options.dir, plan.items, "run");
    plan.key = plan_key(texts);
    make_folder(options.dir);
    const Folder dir(options.dir);
    write_plan(dir, plan);
    const Folder parts = dir.make("parts");
    for (const auto& [name, text] : std::initializer_list<std::pair<const char*, std::string>>{
             {"scene.toml", scene_text}, {"sweep.toml", sweep_text}, {"views.toml", views}, {"dataset.json", as_json(options)}})
        if (!text.empty() && !parts.has(name)) write_file(parts / name, text);
    return options.backend.run(options.dir, plan, {{"dataset", "--part-of", options.dir.string()}, "--frames"},
                               [&] { return finish_dataset(options.dir, options.backend.local.quiet); });
}

}  // namespace

void add_dataset(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<DatasetArguments>();
    CommandLine* command =
        app.add_subcommand("dataset", "run a sweep and make labelled pictures of all of its runs, split by vessel");
    command->allow_extras();
    command->add_option("SCENE", options->scene, "scene file (TOML), or the name of a scene of the program")->scene();
    command->add_option("--vary", options->sweep, "sweep file, as for batch")->type_name("SWEEP.toml");
    command
        ->add_option("--frames", options->count,
                     "pictures of each run and view, spread evenly; options of render may follow (--size ...)")
        ->type_name("N");
    command->add_option("-o", options->dir, "folder for pictures and labels, which all machines share")->type_name("DIR");
    command->add_option("--set", options->overrides, "change a key of the scene for all runs; repeats")
        ->type_name("table.key=value")
        ->allow_extra_args(false);
    command
        ->add_option("--views", options->views, "a view for each run of this sweep of [carm] and [contrast] keys, as of render")
        ->type_name("VIEWS.toml");
    options->format = "folder";
    command->add_option("--format", options->format, "folder, or coco: an annotation file of each split beside it")
        ->check(one_of({"folder", "coco"}));
    command->add_option("--licence", options->licence, "what card.md says of it")->type_name("TEXT");
    command
        ->add_option("--preview", options->preview,
                     "pictures of the first run with their labels on one sheet; nothing else is made")
        ->type_name("SHEET.png");
    command->add_option("--part-of", options->part_of)->hidden();
    command->add_option("--parent", options->parent)->hidden();
    options->backend.declare(*command);
    command->callback([options, command, &chosen] {
        options->render = command->remaining();
        chosen = [options] { return dataset(*options); };
    });
}

}  // namespace seldinger::apps

// Plan of a batch in parts, and what is there of each.
#include "batch/parts.h"

#include "core/error.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "core/fnv1a.h"
#include "io/json_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>

namespace seldinger {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* plan_file = "parts.json";
// beyond what any study has, and little enough to be listed in memory
constexpr std::size_t most_parts = 1'000'000, most_items = 10'000'000, last_frame = 1'000'000'000;

std::string as_json(const PartPlan& plan)
{
    Json out;
    out[plan.frames ? "frames" : "runs"] = plan.items;
    out["parts"] = plan.parts;
    out["key"] = plan.key;
    if (plan.frames) out["first"] = plan.first, out["rate"] = plan.rate, out["files"] = plan.files;
    return json_text(out, 2) + "\n";
}

[[noreturn]] void refuse(const std::string& what)
{
    throw Error(ErrorKind::BadFile, what + ". Fix: begin again in another folder");
}

void refuse_old(const Folder& dir)
{
    if (dir.has("farm.json"))
        throw Error(ErrorKind::BadScene,
                    dir.path().string() +
                        ": got a farm of an earlier version (farm.json, todo/, done/); expected parts.json. Fix: end it with "
                        "that version, or begin again in another folder with -o");
}

}  // namespace

std::string plan_key(const std::vector<std::string>& texts)
{
    std::uint64_t hash = fnv1a_start;
    for (const std::string& text : texts) {
        const std::uint64_t size = text.size();  // so that "ab", "c" is not "a", "bc"
        hash = fnv1a(text.data(), text.size(), fnv1a(&size, sizeof size, hash));
    }
    return fmt::format("{:016x}", hash);
}

void write_plan(const Folder& dir, const PartPlan& plan)
{
    refuse_old(dir);
    const FileLock one_at_a_time = FileLock::of_file(dir / plan_file, std::chrono::hours(1));
    if (!dir.has(plan_file)) return write_file(dir / plan_file, as_json(plan), Durable::Yes);
    if (read_file(dir / plan_file) != as_json(plan))
        throw Error(
            ErrorKind::BadScene,
            fmt::format(
                "{}: holds {} parts of another scene, sweep, vessel, options, version or number of parts. Fix: give the same "
                "again to continue, or another folder with -o",
                dir.path().string(), read_plan(dir).parts));
}

PartPlan read_plan(const Folder& dir)
{
    refuse_old(dir);
    const std::string file = (dir.path() / plan_file).string();
    if (!dir.has(plan_file))
        throw Error(ErrorKind::BadFile,
                    file + ": is not there. Fix: give the folder of `seldinger farm -o` or `batch --part -o`");
    try {
        const Json in = Json::parse(read_file(dir / plan_file));
        const auto count = [&](const char* key, std::size_t least, std::size_t most) {
            const Json& value = in.at(key);
            if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least || value.get<std::uint64_t>() > most)
                refuse(fmt::format("{}: {} is out of range", file, key));
            return value.get<std::size_t>();
        };
        PartPlan plan;
        plan.frames = in.contains("frames");
        plan.items = count(plan.frames ? "frames" : "runs", 1, most_items);
        plan.parts = count("parts", 1, std::min(plan.items, most_parts));
        plan.key = in.at("key").get<std::string>();
        if (!plan.frames) return plan;
        plan.first = count("first", 0, last_frame);
        plan.rate = in.at("rate").get<double>();
        plan.files = in.at("files").get<std::vector<std::string>>();
        if (!(plan.rate >= 0.1 && plan.rate <= 240)) refuse(file + ": rate is out of range");
        if (plan.files.empty() || !std::all_of(plan.files.begin(), plan.files.end(), leads_below))
            refuse(file + ": got files outside of its folder; expected names below it");
        return plan;
    } catch (const nlohmann::json::exception& error) {
        refuse(fmt::format("{}: is damaged ({})", file, error.what()));
    }
}

FilePlace part_file(const Folder& dir, const PartPlan& plan, std::size_t part)
{
    return dir.make("parts") / (plan.name(part) + ".bin");
}

std::optional<SavedBatch> read_part(const Folder& dir, const PartPlan& plan, std::size_t part)
{
    if (!dir.has_below("parts/" + plan.name(part) + ".bin")) return std::nullopt;
    std::vector<std::uint8_t> world;
    const FilePlace file = part_file(dir, plan, part);
    SavedBatch saved = read_saved(file, world);
    const auto [begin, end] = plan.range(part);
    if (saved.scene != plan.key || saved.begin != begin || saved.end != end)
        throw Error(ErrorKind::BadFile,
                    file.path().string() + ": is a part of another batch. Fix: move it away, and run that part again");
    return saved;
}

std::string frame_file(const std::string& pattern, std::size_t frame)
{
    constexpr std::string_view digits = "######";
    std::string name = pattern;
    if (const std::size_t at = name.find(digits); at != std::string::npos)
        name.replace(at, digits.size(), fmt::format("{:06}", frame));
    return name;
}

std::size_t items_there(const Folder& dir, const PartPlan& plan, std::size_t part)
{
    const auto [begin, end] = plan.range(part);
    std::size_t there = 0;
    for (std::size_t i = begin; plan.frames && i < end; ++i)
        there += std::all_of(plan.files.begin(), plan.files.end(),
                             [&](const std::string& pattern) { return dir.has_below(frame_file(pattern, plan.first + i)); });
    if (plan.frames) return there;
    try {
        const std::optional<SavedBatch> saved = read_part(dir, plan, part);
        return saved ? saved->rows.size() : 0;
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::BadFile) throw;
        return 0;
    }
}

std::string list_ranges(const std::vector<std::size_t>& numbers, const char* between)
{
    std::string text;
    for (std::size_t k = 0, end = 0; k < numbers.size(); k = end) {
        for (end = k + 1; end < numbers.size() && numbers[end] == numbers[end - 1] + 1;) ++end;
        if (!text.empty()) text += between;
        text += end - k == 1 ? fmt::format("{}", numbers[k]) : fmt::format("{}-{}", numbers[k], numbers[end - 1]);
    }
    return text;
}

}  // namespace seldinger

// Fuzz targets of what a run, a live session and a farm save: their checksums are put right, so that the code behind them is
// reached.
#include "fuzz_saved.h"
#include "fuzz_support.h"

#include "batch/parts.h"
#include "models/errors.h"
#include "models/result_table.h"
#include "record/checkpoint.h"
#include "scene/scene.h"
#include "session/session_record.h"
#include "support/temporary_folder.h"

#include <cmath>

namespace seldinger::fuzz {
namespace {

namespace fs = std::filesystem;

const Scene& known_scene()
{
    static const Scene scene = read_scene_text(saved_scene, "saved.toml");
    return scene;
}

const fs::path& folder()
{
    static const TemporaryFolder made;
    return made.path();
}

/// The first bytes of a file that the engine's own writer has just made: written down here, they would be those of an older
/// version one day, and nothing behind them would be reached.
std::string magic_in(const fs::path& file)
{
    std::string magic(8, '\0');
    std::ifstream(file, std::ios::binary).read(magic.data(), static_cast<std::streamsize>(magic.size()));
    return magic;
}

void read_parts_json(const std::string& json)
{
    put_file(folder() / "parts.json", json);
    answer([&] {
        const PartPlan plan = read_plan(folder());
        require(plan.parts >= 1 && plan.range(plan.parts).end == plan.items);
        if (plan.parts > 1000 || plan.items > 1000) return;  // each is looked for in the folder
        for (std::size_t part = 1; part <= plan.parts; ++part) (void)items_there(folder(), plan, part);
    });
}

/// A part of a batch; of the plan that it names, too, since no mutation finds a key.
void read_a_part(const std::string& payload)
{
    PartPlan plan;
    plan.items = 5, plan.parts = 2;
    plan.key = std::string(16, '0');
    const FilePlace file = part_file(folder(), plan, 2);
    static const std::string magic = (write_saved(file, {}), magic_in(file.path()));
    put_file(file.path(), sealed(magic, payload));
    answer([&] {
        std::vector<std::uint8_t> world;
        plan.key = read_saved(file, world).scene;
        const auto saved = read_part(folder(), plan, 2);
        require(saved && saved->rows.size() <= 3 && saved->layout.instruments.size() <= saved->instruments);
        for (const BatchRow& row : saved->rows)
            require(row.run >= 2 && row.run < 5 && std::isalnum(row.state_hash[0]) &&
                    row.instruments.size() == saved->instruments);
    });
}

}  // namespace

/// The payload; taken for one of its own scene, too, since no mutation finds the words of a scene.
void checkpoint(Bytes bytes)
{
    const fs::path file = folder() / "checkpoint.bin";
    static const std::string magic = (write_checkpoint(file, {}), magic_in(file));
    put_file(file, sealed(magic, text_of(bytes)));
    std::optional<Checkpoint> saved;
    answer([&] { saved = read_checkpoint(file); });
    if (!saved) return;
    static const std::string words = write_scene(known_scene(), folder());
    answer([&] { check_checkpoint(file, *saved, known_scene(), words); });
    answer([&] {
        check_checkpoint(file, *saved, known_scene(), saved->scene);
        require(is_sound(saved->tally, known_scene().steps()) && std::isfinite(saved->tally.friction_max));
    });
}

/// A record without the checksums of its blocks.
void record(Bytes bytes)
{
    const fs::path file = folder() / "live.rec";
    put_file(file, with_sums(text_of(bytes)));
    answer([&] {
        const SessionRecord record = read_record(file);
        const std::size_t hubs = static_cast<std::size_t>(2 * record.header.instruments);
        for (const RecordEntry& entry : record.entries) {
            if (entry.kind == RecordEntry::Kind::Step) require(entry.hubs.size() == hubs);
            for (const double value : entry.hubs) require(std::isfinite(value));
        }
        require(record.steps() <= static_cast<long>(record.entries.size()));
        check_record(record, file, known_scene(), 0);
    }, ErrorKind::BadScene);
}

/// parts.json, or, after a first byte of 'r', the payload of a part.
void farm(Bytes bytes)
{
    if (!bytes.empty() && bytes[0] == 'r') return read_a_part(text_of(bytes.subspan(1)));
    read_parts_json(text_of(bytes));
}

/// Saved files of a study: a trajectory without its checksum, compared with itself, or, after a first byte of 'r', a table of
/// results.
void kept(Bytes bytes)
{
    const bool is_table = !bytes.empty() && bytes[0] == 'r';
    const fs::path file = folder() / (is_table ? "runs.csv" : "run.trajectory");
    std::string content = text_of(is_table ? bytes.subspan(1) : bytes);
    if (!is_table) append(content, fnv1a(content.data(), content.size()));
    put_file(file, content);
    answer([&] {
        Trajectory trajectory;
        if (is_table) {
            const ResultTable table(file, {"scene", "model", "nodes"}, 2);
            for (const ResultTable::Row& row : table.rows()) require(table.find({row[0], row[1]}) && count_in(row[2]) >= 0);
        } else if (load_trajectory(file, trajectory)) {
            require(trajectory_errors(trajectory, trajectory, {}).samples <= static_cast<int>(trajectory.samples.size()));
        }
    });
}

}  // namespace seldinger::fuzz

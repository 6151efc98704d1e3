// fuzz_seeds DIR: files to begin fuzzing with that only the engine's own writers can make; the others are make_seeds.py's.
#include "fuzz_saved.h"
#include "fuzz_support.h"

#include "batch/parts.h"
#include "engine.h"
#include "models/trajectory.h"
#include "record/checkpoint.h"
#include "session/hand_packet.h"
#include "session/session_record.h"
#include "support/temporary_folder.h"

namespace seldinger::fuzz {
namespace {

namespace fs = std::filesystem;

std::string slurp(const fs::path& path)
{
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void put_seed(const fs::path& dir, const char* target, const char* name, const std::string& content)
{
    fs::create_directories(dir / target);
    put_file(dir / target / name, content);
}

void make_checkpoints(const fs::path& dir, const fs::path& scratch)
{
    Checkpoint saved;
    saved.version = version();
    saved.device = "a device";
    saved.trace_bytes = {1000};
    write_checkpoint(scratch, saved);
    put_seed(dir, "checkpoint", "empty", unsealed(slurp(scratch)));
    saved.scene = write_scene(read_scene_text(saved_scene, "saved.toml"), scratch.parent_path());
    saved.tally.steps = 120;
    saved.tally.exits.count = 1;
    saved.wire_frames = saved.contact_frames = {{0, 0}, {100, 0.1}};
    saved.state.assign(64, 1);
    write_checkpoint(scratch, saved);
    put_seed(dir, "checkpoint", "full", unsealed(slurp(scratch)));
}

void make_records(const fs::path& dir, const fs::path& scratch)
{
    const Scene scene = read_scene_text(saved_scene, "saved.toml");
    RecordWriter writer(scratch, {version(), "a scene", "a device", record_hash(scene), 0, 0.001, 1});
    const double hubs[2] = {0.01, -0.5};
    std::vector<std::uint8_t> entries;
    put_step(entries, 0, hubs, 1);
    put_reset(entries);
    put_step(entries, RecordEntry::contrast, hubs, 1);
    writer.append(entries);
    writer.finish(std::string(16, 'a'));
    put_seed(dir, "record", "short", without_sums(slurp(scratch)));
}

void make_farms(const fs::path& dir, const fs::path& folder)
{
    PartPlan plan;
    plan.items = 5, plan.parts = 2;
    plan.key = std::string(16, '0');
    write_plan(folder, plan);
    put_seed(dir, "farm", "sweep", slurp(folder / "parts.json"));
    SavedBatch saved;
    saved.scene = plan.key, saved.sweep = "[vary]\n", saved.name = "two", saved.device = "host";
    saved.layout.instruments = {"catheter", "wire"}, saved.layout.runs = 5, saved.layout.target = "the middle";
    saved.instruments = 2, saved.begin = 2, saved.end = 5;
    saved.rows.resize(3);
    for (std::size_t k = 0; k < saved.rows.size(); ++k)
        saved.rows[k].run = static_cast<std::int64_t>(2 + k), saved.rows[k].state_hash.fill('a'),
        saved.rows[k].instruments.resize(2), saved.rows[k].shape.resize(2 * 3 * BatchRow::stations);
    const FilePlace file = part_file(folder, plan, 2);
    write_saved(file, saved);
    put_seed(dir, "farm", "rows", "r" + unsealed(slurp(file.path())));
    plan.frames = true, plan.rate = 15, plan.files = {"frame_######.png"};
    fs::remove(folder / "parts.json");
    write_plan(folder, plan);
    put_seed(dir, "farm", "frames", slurp(folder / "parts.json"));
}

void make_kept(const fs::path& dir, const fs::path& scratch)
{
    Trajectory run;
    run.wire_length = 0.3;
    for (const double t : {0.1, 0.2, 0.3}) {
        Sample& sample = run.samples.emplace_back();
        sample.t = t;
        sample.shape = {{0, t, 0}, {0.1, t, 0}, {0.3, 0, t}};
        sample.contact_up_to = {0, t, 1};
    }
    save_trajectory(scratch, run);
    const std::string file = slurp(scratch);
    put_seed(dir, "kept", "trajectory", file.substr(0, file.size() - 8));
    put_seed(dir, "kept", "table", "rscene,model,nodes\na,\"x, \"\"y\"\"\",41\nb,z,\na,z,1e300\n");
}

void make_packets(const fs::path& dir)
{
    std::string packets;
    for (std::uint64_t k = 1; k <= 4; ++k) {
        const SelHandRequest request{static_cast<std::uint16_t>(k % 2), k,   0.01 * static_cast<double>(k),
                                     1e-3 * static_cast<double>(k),     0.1, k == 3 ? SEL_HAND_REBASE : 0};
        unsigned char bytes[SEL_HAND_REQUEST_BYTES];
        sel_write_request(&request, bytes);
        packets += std::string{'\x20', '\1'};
        packets.append(reinterpret_cast<const char*>(bytes), sizeof bytes);
    }
    put_seed(dir, "hand", "four", packets);
}

}  // namespace
}  // namespace seldinger::fuzz

int main(int count, char** words)
{
    if (count != 2) return 2;
    const seldinger::TemporaryFolder scratch;
    seldinger::fuzz::make_checkpoints(words[1], scratch.path() / "checkpoint.bin");
    seldinger::fuzz::make_records(words[1], scratch.path() / "live.rec");
    std::filesystem::create_directories(scratch.path() / "farm");
    seldinger::fuzz::make_farms(words[1], scratch.path() / "farm");
    seldinger::fuzz::make_kept(words[1], scratch.path() / "run.trajectory");
    seldinger::fuzz::make_packets(words[1]);
}

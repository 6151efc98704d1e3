// A batch from its first world to its last, for programs that keep no state on disk.
#include "batch/run_batch.h"

#include "batch/batch.h"
#include "batch/batch_answer.h"
#include "core/assets.h"
#include "scene/toml_parse.h"

namespace seldinger {

std::vector<BatchRow> run_all(const BatchSource& source, int device, const std::function<void(std::size_t)>& progress)
{
    constexpr long often = 16;  // steps
    std::vector<BatchRow> rows;
    for (const std::vector<std::size_t>& runs : plan_worlds(source)) {
        BatchWorld world(source, runs, load_vessel(source.scene(runs.front()).vessel), device);
        for (long k = 0; !world.finished(); ++k) {
            for (BatchRow& row : world.step()) rows.push_back(std::move(row));
            if (progress && k % often == 0) progress(rows.size());
        }
    }
    return rows;
}

BatchResult run_batch(const std::filesystem::path& scene, const std::string& sweep, const std::vector<std::string>& overrides,
                      const std::function<void(std::size_t)>& progress)
{
    const std::filesystem::path file = scene_file(scene.string());
    const BatchSource source = make_source(read_scene_file(file), file, overrides, sweep, "sweep");
    const std::vector<BatchRow> rows = run_all(source, -1, progress);
    const BatchLayout layout = source.layout();
    const BatchAnswer answer = answer_of(layout, rows);
    BatchResult result;
    for (const RunRows& of : rows_by_run(layout, rows))
        result.runs.push_back({source.sweep.overrides(static_cast<std::size_t>(of.row->run)), status_word(of.row->status),
                               numbers_of(layout, of), {of.row->state_hash.begin(), of.row->state_hash.end()}});
    for (const BatchAnswer::Ranked& one : answer.ranking) result.ranking.push_back(one.run);
    result.answer = answer_line(source.sweep, layout, answer);
    result.csv = batch_csv(source.sweep, layout, rows);
    return result;
}

}  // namespace seldinger

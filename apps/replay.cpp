// Steps a run through a recorded session.
#include "replay.h"

#include "core/check.h"
#include "core/file_io.h"
#include "record/checkpoint.h"
#include "session/coupling.h"

#include <fmt/format.h>

namespace seldinger::apps {

Replay::Replay(const std::filesystem::path& record) : path_(record), record_(read_record(record))
{
    if (record_.steps() == 0) throw Error(ErrorKind::BadFile, fmt::format("{}: holds no step", record.string()));
}

Scene Replay::scene(Scene of_session) const
{
    of_session.dt = record_.header.dt;
    of_session.duration = static_cast<double>(record_.steps()) * of_session.dt;
    of_session.until = Until::Time;
    return of_session;
}

void Replay::check(const Scene& scene, const WorldSetup& setup) const
{
    check_record(record_, path_, scene, hash_of(setup.mesh));
    if (record_.header.instruments != static_cast<int>(setup.wires.size()))
        throw Error(ErrorKind::BadScene, fmt::format("{}: is of {} instruments, the scene has {}", path_.string(),
                                                    record_.header.instruments, setup.wires.size()));
}

void Replay::begin(const Scene& scene, const World& world)
{
    initial_ = world.save_state();
    watch_.emplace(scene, world, ScoreWatch::Patch::Always);
    watch_->begin(world, 0, score_);
}

void Replay::take_resets(World& world)
{
    for (; at_ < record_.entries.size() && record_.entries[at_].kind != RecordEntry::Kind::Step; ++at_) {
        if (record_.entries[at_].kind != RecordEntry::Kind::Reset) continue;
        world.restore_state(initial_);
        watch_->begin(world, 0, score_);
    }
}

void Replay::stepped(const World& world)
{
    const std::uint8_t flags = record_.entries[at_ - 1].flags;
    watch_->stepped(world, 0, record_.header.dt, flags & RecordEntry::fluoroscopy, flags & RecordEntry::contrast, score_);
}

void Replay::write_score(const Scene& scene, const std::filesystem::path& dir) const
{
    write_file(dir / "score.json", score_json(scene, score_));
    write_file(dir / "score.html", score_page(scene, score_));
}

const Control& Replay::next(World& world)
{
    take_resets(world);
    SEL_ASSERT(at_ < record_.entries.size());
    const RecordEntry& entry = record_.entries[at_++];
    const bool cut = at_ < record_.entries.size() && record_.entries[at_].kind == RecordEntry::Kind::CutShort;
    if (cut) world.cut_when([asked = 0u, at = record_.entries[at_].trials]() mutable { return ++asked >= at; });
    else world.cut_when({});
    for (int w = 0; w < world.wire_count(); ++w) {
        if (!world.setup().wires[static_cast<std::size_t>(w)].feed.on || world.system_of(w) != 0) continue;
        const std::size_t hub = 2 * static_cast<std::size_t>(w);
        const bool driven = world.setup().wires[static_cast<std::size_t>(w)].feed.hub.driven();
        if (driven) control_.push(w, entry.hubs[hub], entry.hubs[hub + 1], spring_of(advance_coupling, record_.header.dt));
        else control_.move_to(w, entry.hubs[hub], entry.hubs[hub + 1]);
    }
    return control_;
}

}  // namespace seldinger::apps

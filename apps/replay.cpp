// Steps a run through a recorded session.
#include "replay.h"

#include "core/check.h"
#include "scene/checkpoint.h"

#include <fmt/format.h>

namespace seldinger::apps {

Replay::Replay(const std::filesystem::path& record) : path_(record), record_(read_record(record))
{
    if (record_.steps() == 0) throw Error(ExitCode::BadFile, fmt::format("{}: holds no step", record.string()));
}

Scene Replay::scene(Scene of_session) const
{
    of_session.dt = record_.header.dt;
    of_session.duration = static_cast<double>(record_.steps()) * of_session.dt;
    of_session.until = Until::Time;
    return of_session;
}

void Replay::begin(const Scene& scene, const World& world)
{
    check_record(record_, path_, scene, hash_of(world.setup().mesh));
    if (record_.header.instruments != world.wire_count())
        throw Error(ExitCode::BadScene, fmt::format("{}: is of {} instruments, the scene has {}", path_.string(),
                                                    record_.header.instruments, world.wire_count()));
    initial_ = world.save_state();
}

void Replay::take_resets(World& world)
{
    for (; at_ < record_.entries.size() && record_.entries[at_].kind != RecordEntry::Kind::Step; ++at_)
        if (record_.entries[at_].kind == RecordEntry::Kind::Reset) world.restore_state(initial_);
}

const Control& Replay::next(World& world)
{
    take_resets(world);
    SEL_ASSERT(at_ < record_.entries.size());
    const RecordEntry& entry = record_.entries[at_++];
    for (int w = 0; w < world.wire_count(); ++w) {
        if (!world.setup().wires[static_cast<std::size_t>(w)].feed.on || world.system_of(w) != 0) continue;
        const std::size_t hub = 2 * static_cast<std::size_t>(w);
        control_.move_to(w, entry.hubs[hub], entry.hubs[hub + 1]);
    }
    return control_;
}

}  // namespace seldinger::apps

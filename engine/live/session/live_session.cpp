// Session, device and page of one scene, put together for programs.
#include "session/live_session.h"

#include "core/assets.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "run/ready.h"
#include "session/session.h"
#include "session/web_server.h"

#include <fmt/format.h>

#include <optional>

namespace seldinger {
namespace {

/// Path of the file beside the record that `ending` names.
std::filesystem::path beside(const std::filesystem::path& record, const char* ending) { return record.string() + ending; }

Scene at_rate(Scene scene, const LiveOptions& options)
{
    if (!(options.rate >= 1 && options.rate <= 10000))
        throw Error(ErrorKind::BadScene,
                    fmt::format("LiveOptions: rate: got {}; expected 1 to 10000 steps a second", options.rate));
    if (!(options.deadline >= 0 && options.deadline <= 1))
        throw Error(ErrorKind::BadScene,
                    fmt::format("LiveOptions: deadline: got {}; expected a share from 0 to 1", options.deadline));
    scene.dt = 1 / options.rate;
    return scene;
}

SessionOptions of_session(const LiveOptions& options)
{
    SessionOptions session;
    session.rate = options.rate, session.duration = options.duration, session.deadline = options.deadline;
    session.lockstep = options.lockstep, session.record = options.record;
    session.advance.stiffness = options.coupling_stiffness, session.advance.damping = options.coupling_damping;
    return session;
}

std::optional<FileLock> locked(const std::filesystem::path& record)
{
    return record.empty() ? std::nullopt : std::optional<FileLock>(FileLock::of_file(record));
}

}  // namespace

struct LiveSession::Parts {
    Parts(const Scene& scene, const LiveOptions& options)
        : record(options.record),
          lock(locked(record)),
          setup(ready_setup(scene, options.device)),
          hand(options.hand_address, options.hand_port, static_cast<int>(live_instruments(setup).size())),
          session(scene, std::move(setup), of_session(options), &hand),
          lockstep(options.lockstep)
    {
        if (!record.empty())  // the one that is played: with overrides, and the model that was chosen
            write_file(beside(record, ".scene.toml"), write_scene(scene, std::filesystem::absolute(record).parent_path()));
        if (options.page_port >= 0)
            page.emplace(WebOptions{options.page_address, options.page_token, options.page_port}, scene, session);
    }

    std::filesystem::path record;
    std::optional<FileLock> lock;
    WorldSetup setup;  // until the session has it
    HandChannel hand;
    Session session;
    std::optional<WebServer> page;
    bool lockstep;
};

LiveSession::LiveSession(const std::filesystem::path& scene, const LiveOptions& options,
                         const std::vector<std::string>& overrides)
    : LiveSession(at_rate(read_scene(scene_file(scene.string()), overrides), options), options)
{
}
LiveSession::LiveSession(const Scene& scene, const LiveOptions& options)
    : parts_(std::make_unique<Parts>(scene, options))
{
}
LiveSession::~LiveSession()
{
    stop();
    parts_->hand.stop();  // its thread asks the session for the time
}

int LiveSession::hand_port() const { return parts_->hand.port(); }
int LiveSession::page_port() const { return parts_->page ? parts_->page->port() : -1; }

void LiveSession::start()
{
    parts_->hand.start([this] { return parts_->session.clock(); }, parts_->lockstep);
    if (parts_->page) parts_->page->start();
    parts_->session.start();
}

bool LiveSession::running() const { return parts_->session.running(); }
std::uint64_t LiveSession::steps() const { return parts_->session.steps_so_far(); }
void LiveSession::stop() { parts_->session.stop(); }

std::string LiveSession::finish()
{
    Session& session = parts_->session;
    session.finish();
    if (parts_->page) parts_->page->stop();
    parts_->hand.stop();
    const std::string summary = session.summary();
    if (const std::filesystem::path& record = parts_->record; !record.empty()) {
        write_file(beside(record, ".summary.json"), summary);
        write_file(beside(record, ".score.json"), score_json(session.scene(), session.score()));
        write_file(beside(record, ".score.html"), score_page(session.scene(), session.score()));
    }
    return summary;
}

std::string LiveSession::failure() const { return parts_->session.failure(); }
std::string LiveSession::state_hash() const { return parts_->session.world().state_hash(); }
const Session& LiveSession::session() const { return parts_->session; }

}  // namespace seldinger

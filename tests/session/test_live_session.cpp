// A live session as a program of its own has it (session/live_session.h).

#include "session/live_session.h"
#include "session/session_fixture.h"
#include "core/error.h"
#include "core/file_io.h"
#include "support/temporary_folder.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace seldinger::test::test_live_session {

TEST_SUITE("session/live_session")
{
    TEST_CASE("property: session, device and page of one scene; each request makes a step, and the files lie beside the record")
    {
        const TemporaryFolder folder;
        write_file(folder.path() / "live.toml", live_scene);
        LiveOptions options;
        options.lockstep = true, options.duration = 0.02, options.rate = 500, options.hand_port = 0, options.page_port = 0;
        options.record = folder.path() / "s.record";
        LiveSession live(folder.path() / "live.toml", options, {"wire.nodes=31"});
        CHECK(live.page_port() > 0);
        live.start();
        const Line line(SOCK_DGRAM, live.hand_port());
        SelHandAnswer answer{};
        for (std::uint64_t k = 1; k <= 10; ++k) REQUIRE(line.ask(k, 1e-4 * static_cast<double>(k), 0, answer));
        CHECK(answer.step == 10);
        const nlohmann::json summary = nlohmann::json::parse(live.finish());
        CHECK(summary["steps"] == 10);
        CHECK(live.steps() == 10);
        CHECK(live.failure().empty());
        CHECK(live.state_hash().size() == 16);
        for (const char* ending : {"", ".scene.toml", ".summary.json", ".score.json", ".score.html"})
            CHECK(std::filesystem::file_size(options.record.string() + ending) > 0);
        CHECK(read_file(options.record.string() + ".scene.toml").find("nodes = 31") != std::string::npos);
    }

    TEST_CASE("property: without a page, a record or a start nothing is left behind; options that cannot be are refused")
    {
        const TemporaryFolder folder;
        write_file(folder.path() / "live.toml", live_scene);
        LiveOptions options;
        options.hand_port = 0, options.page_port = -1;
        {
            const LiveSession live(folder.path() / "live.toml", options);
            CHECK(live.page_port() == -1);
            CHECK(!live.running());
        }
        CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
        options.rate = 0;
        CHECK_THROWS_WITH_AS(LiveSession(folder.path() / "live.toml", options),
                             "LiveOptions: rate: got 0; expected 1 to 10000 steps a second", Error);
        options.rate = 1000, options.deadline = 2;
        CHECK_THROWS_WITH_AS(LiveSession(folder.path() / "live.toml", options),
                             "LiveOptions: deadline: got 2; expected a share from 0 to 1", Error);
        options.deadline = 0, options.page_port = 0, options.page_address = "0.0.0.0";
        CHECK_THROWS_AS(LiveSession(folder.path() / "live.toml", options), Error);  // others reach it, without a token
    }
}

}  // namespace seldinger::test::test_live_session

// The real `seldinger live`: what it leaves on disk, its replay, a kill in the middle, and what it refuses, in one line each.

#include "apps/app_fixture.h"
#include "session/session_fixture.h"
#include "support/skip.h"

using namespace seldinger;
using namespace seldinger::test;

namespace {

bool has_page() { return fs::exists("/usr/share/javascript/three/three.min.js"); }

void refuses(const ScratchFolder& folder, const std::string& arguments, int code, const std::string& said)
{
    CAPTURE(arguments);
    const AppResult result = run_app(folder, arguments);
    CAPTURE(result.err);
    CHECK(result.code == code);
    CHECK(result.error_lines() == 1);
    CHECK(result.err.find(said) != std::string::npos);
}

}  // namespace

TEST_SUITE("apps/live")
{
    TEST_CASE("property: --duration ends with 0, record, score and summary on disk, and the record replays to the same hash")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder;
        folder.write("t.toml", live_scene);
        const AppResult result = run_app(folder, "live t.toml --port 0 --udp 0 --duration 0.5 --record s.record --json");
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        const auto summary = nlohmann::json::parse(result.out);
        CHECK(summary["steps"] == 500);
        CHECK(summary["session_s"].get<double>() == doctest::Approx(0.5));
        for (const char* key : {"late", "late_share", "stretched_s", "step", "input_to_force", "packets", "coupling", "score", "state_hash"})
            CHECK(summary.contains(key));
        CHECK(nlohmann::json::parse(slurp(folder.path / "s.record.score.json"))["verdict"] == "open");
        CHECK(slurp(folder.path / "s.record.score.html").find("Three centimetres in.") != std::string::npos);
        CHECK(nlohmann::json::parse(slurp(folder.path / "s.record.summary.json")) == summary);
        const AppResult replay = run_app(folder, "run t.toml --replay s.record -o D --json");
        CAPTURE(replay.err);
        REQUIRE(replay.code == 0);
        CHECK(nlohmann::json::parse(replay.out)["state_hash"] == summary["state_hash"]);
        CHECK(run_app(folder, "report D -o r.html").code == 0);
        CHECK(slurp(folder.path / "r.html").find("live tube") != std::string::npos);
        refuses(folder, "run t.toml --set wire.radius_m=0.0005 --replay s.record -o E", 2, "another scene");
        refuses(folder, "run t.toml --replay t.toml -o E", 3, "is no record");
        refuses(folder, "run t.toml --replay none.record -o E", 3, "none.record");
        refuses(folder, "live t.toml --port 0 --udp 0 --duration 0.1 --record t.toml", 2, "is no record");
        std::string other = slurp(folder.path / "s.record");
        const std::size_t at = other.find("\"version\":\"0");
        REQUIRE(at != std::string::npos);
        other[at + 11] = '9';
        folder.write("other.record", other);
        refuses(folder, "run t.toml --replay other.record -o E", 2, "version");
    }

    TEST_CASE("property: the scene beside a record replays it, with what was set and the model that was chosen")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder;
        folder.write("t.toml", live_scene);
        const auto replays = [&](const std::string& options, const std::string& where) {
            CAPTURE(options);
            const AppResult live = run_app(folder, "live t.toml --port 0 --udp 0 --duration 0.3 --record " + where + "/s.record --json " + options);
            CAPTURE(live.err);
            REQUIRE(live.code == 0);
            const AppResult replay = run_app(folder, "run " + where + "/s.record.scene.toml --replay " + where + "/s.record -o " + where + "/D --json");
            CAPTURE(replay.err);
            REQUIRE(replay.code == 0);
            CHECK(nlohmann::json::parse(replay.out)["state_hash"] == nlohmann::json::parse(live.out)["state_hash"]);
            return live.err;
        };
        fs::create_directories(folder.path / "a");
        fs::create_directories(folder.path / "b");
        replays("--set wire.radius_m=0.0004", "a");
        CHECK(replays("--tolerance 1mm", "b").find("model: ") == 0);
        CHECK(fs::exists(folder.path / "b/s.record.pilots"));
        CHECK(!fs::exists(folder.path / "t-live.pilots"));
    }

    TEST_CASE("property: what a killed session leaves replays")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder;
        folder.write("t.toml", live_scene);
        const AppResult begun = run_app(folder, "live t.toml --port 0 --udp 0 --record s.record", "timeout -s KILL 4");
        CHECK(begun.code != 0);
        const AppResult replay = run_app(folder, "run t.toml --replay s.record -o D --json");
        CAPTURE(replay.err);
        REQUIRE(replay.code == 0);
        CHECK(nlohmann::json::parse(replay.out)["steps"].get<int>() > 100);
    }

    TEST_CASE("property: refusals are one line with the code that is documented")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder;
        folder.write("t.toml", live_scene);
        folder.write("free.toml", free_scene());
        refuses(folder, "live t.toml --bind 0.0.0.0 --port 0 --udp 0 --duration 0.1", 2, "--token");
        refuses(folder, "live t.toml --bind nowhere --port 0 --udp 0 --duration 0.1", 2, "--bind");
        refuses(folder, "live t.toml --udp-bind nowhere --port 0 --udp 0 --duration 0.1", 2, "--udp-bind");
        refuses(folder, "live free.toml --port 0 --udp 0 --duration 0.1", 2, "[feed]");
        refuses(folder, "live t.toml --rate 0 --duration 0.1", 2, "--rate");
        refuses(folder, "live t.toml --set task.target.branch=7 --set task.target.point=[0.0,0.0,0.0] --duration 0.1", 2, "task.target");
        refuses(folder, "live none.toml", 3, "none.toml");
        refuses(folder, "report .", 3, "neither a run");
        const int taken = ::socket(AF_INET, SOCK_DGRAM, 0);
        sockaddr_in own{};
        own.sin_family = AF_INET;
        own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        REQUIRE(::bind(taken, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0);
        socklen_t size = sizeof own;
        getsockname(taken, reinterpret_cast<sockaddr*>(&own), &size);
        refuses(folder, fmt::format("live t.toml --port 0 --udp {} --duration 0.1", ntohs(own.sin_port)), 3, "--udp");
        close(taken);
    }
}

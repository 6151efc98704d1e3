// The real `seldinger live`: its files, its replay, a kill in the middle, and refusals, in one line each.

#include "apps/background_app.h"
#include "session/session.h"
#include "session/session_fixture.h"
#include "support/approx.h"
#include "support/skip.h"

namespace seldinger::test::test_live_command {

namespace {

bool has_page() { return fs::exists("/usr/share/javascript/three/three.min.js"); }

}  // namespace

TEST_SUITE("apps/live")
{
    TEST_CASE("property: --duration ends with 0, record, score and summary on disk, and the record replays to the same hash")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", live_scene}};
        const AppResult result = run_ok(folder, "live t.toml --port 0 --udp 0 --duration 0.5 --record s.record --json");
        const auto summary = nlohmann::json::parse(result.out);
        CHECK(summary["steps"] == 500);
        CHECK(summary["session_s"].get<double>() == about(0.5));
        for (const char* key : {"late", "woken_late", "late_share", "stretched_s", "step", "input_to_force", "packets",
                                "coupling", "score", "state_hash"})
            CHECK(summary.contains(key));
        CHECK(nlohmann::json::parse(slurp(folder.path / "s.record.score.json"))["verdict"] == "open");
        CHECK(has(slurp(folder.path / "s.record.score.html"), "Three centimetres in."));
        CHECK(nlohmann::json::parse(slurp(folder.path / "s.record.summary.json")) == summary);
        const AppResult replay = run_ok(folder, "run t.toml --replay s.record -o D --json");
        CHECK(nlohmann::json::parse(replay.out)["state_hash"] == summary["state_hash"]);
        run_ok(folder, "report D -o r.html");
        CHECK(has(slurp(folder.path / "r.html"), "live tube"));
        check_refused(folder, "run t.toml --set wire.radius_m=0.0005 --replay s.record -o E", 2, "another scene");
        check_refused(folder, "run t.toml --replay t.toml -o E", 3, "is no record");
        check_refused(folder, "run t.toml --replay none.record -o E", 3, "none.record");
        check_refused(folder, "live t.toml --port 0 --udp 0 --duration 0.1 --record t.toml", 2, "is not a record");
        std::string other = slurp(folder.path / "s.record");
        const std::size_t at = other.find("\"version\":\"0");
        REQUIRE(at != std::string::npos);
        other[at + 11] = '9';
        folder.write("other.record", other);
        check_refused(folder, "run t.toml --replay other.record -o E", 2, "version");
    }

    TEST_CASE("property: the scene beside a record replays it, with what was set and the model that was chosen")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", live_scene}};
        const auto replays = [&](const std::string& options, const std::string& where) {
            CAPTURE(options);
            const AppResult live =
                run_ok(folder, "live t.toml --port 0 --udp 0 --duration 0.3 --record " + where + "/s.record --json " + options);
            const AppResult replay =
                run_ok(folder, "run " + where + "/s.record.scene.toml --replay " + where + "/s.record -o " + where + "/D --json");
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

    TEST_CASE("property: what choosing the model took in memory is the system's again when the session begins")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", live_scene}};
        // kernels are built in here, which takes more memory than all the rest
        const std::string cache = "POCL_CACHE_DIR=" + (folder.path / "cache").string();
        fs::create_directories(folder.path / "cache");
        const auto memory = [&](std::vector<std::string> more) {
            std::vector<std::string> arguments = {"live", "t.toml", "--port", "0", "--udp", "0", "--record", "s.record"};
            arguments.insert(arguments.end(), more.begin(), more.end());
            fs::remove(folder.path / ".out-background");  // of the session before
            BackgroundApp live(folder.path, arguments, {cache});
            REQUIRE(live.wait_for_rows(folder.path / ".out-background", 0));
            std::this_thread::sleep_for(std::chrono::milliseconds(1000));
            const std::string status = slurp(fmt::format("/proc/{}/status", live.pid()));
            live.send(SIGTERM);
            CHECK(live.result().code == 75);
            const std::size_t at = status.find("VmRSS:");
            REQUIRE(at != std::string::npos);
            return std::atof(status.c_str() + at + 6) / 1e3;  // [MB]
        };
        const double chosen = memory({"--tolerance", "1mm"}), plain = memory({});
        CAPTURE(chosen);
        CAPTURE(plain);
        CHECK(chosen < 1.3 * plain);
    }

    TEST_CASE("property: a siphon that is lost by its limit of force is lost in the replay too: the same sheet, the same hash")
    {
        const ScratchFolder folder;
        const fs::path file = fs::path(SEL_SOURCE_DIR) / "assets/scenes/training/siphon.toml", record = folder.path / "s.record";
        const Scene scene = read_scene(file);
        SessionOptions options{.lockstep = true, .record = record};
        HandSession live(scene, options);
        auto& [hand, session] = live;
        {
            const Line line(SOCK_DGRAM, hand.port());
            SelHandAnswer answer{};
            for (std::uint64_t k = 1; k <= 257; ++k)  // 30 cm/s, too fast
                REQUIRE(line.ask(k, 3e-4 * static_cast<double>(k), 0, answer, k < 200 ? SEL_HAND_FLUOROSCOPY : 0));
        }
        session.stop();
        session.finish();
        const std::string sheet = score_json(scene, session.score());
        const auto score = nlohmann::json::parse(sheet);
        CHECK(score["verdict"] == "failed");
        CHECK(score["wall_force_max_n"].get<double>() > score["limits"]["wall_force_n"].get<double>());
        CHECK(score["time_s"].get<double>() < score["limits"]["time_s"].get<double>());
        CHECK(score["fluoroscopy_s"].get<double>() == about(0.199));
        const AppResult replay =
            run_ok(folder, "run '" + file.string() + "' --replay s.record -o D --json --set scene.record_every=100");
        CHECK(nlohmann::json::parse(replay.out)["state_hash"] == session.world().state_hash());
        CHECK(slurp(folder.path / "D/score.json") == sheet);
        CHECK(slurp(folder.path / "D/score.html") == score_page(scene, session.score()));
        run_ok(folder, "run '" + file.string() + "' -o D --overwrite --quiet --set scene.duration_s=0.01");
        CHECK_FALSE(fs::exists(folder.path / "D/score.json"));  // key frames are not scored
    }

    TEST_CASE("property: what a killed session leaves replays")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", live_scene}};
        const AppResult begun = run_app(folder, "live t.toml --port 0 --udp 0 --record s.record", "timeout -s KILL 4");
        CHECK(begun.code != 0);
        const AppResult replay = run_ok(folder, "run t.toml --replay s.record -o D --json");
        CHECK(nlohmann::json::parse(replay.out)["steps"].get<int>() > 100);
    }

    TEST_CASE("property: a scene that cannot keep the rate starts, says so in one line, and stretches time")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", live_scene}};
        const AppResult result =
            run_ok(folder,
                   "live t.toml --port 0 --udp 0 --rate 2000 --set wire.nodes=1601 --set feed.direction=[1.0,0.0,0.0] "
                   "--set feed.keys.0.advance_m=0.08 --duration 1.1 --record s.record --json");
        CHECK(result.error_lines() == 1);
        CHECK(has(result.err, "cannot keep 2000 steps a second here: time stretches"));
        const auto summary = nlohmann::json::parse(result.out);
        CHECK(summary["late_share"].get<double>() > 0.5);
        CHECK(summary["wall_s"].get<double>() > 1.1 * summary["session_s"].get<double>());
        CHECK(summary["stretched_s"].get<double>() ==
              about(summary["wall_s"].get<double>() - summary["session_s"].get<double>()).epsilon(0.1));
    }

    TEST_CASE("property: the client of the documents pushes and feels, as it stands there")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        if (!fs::exists("/usr/bin/python3")) return skip("no /usr/bin/python3");
        const std::string text = slurp(fs::path(SEL_SOURCE_DIR) / "docs/live.md"), fence = "```python\n";
        const std::size_t begin = text.find(fence);
        REQUIRE(begin != std::string::npos);
        std::string client = text.substr(begin + fence.size(), text.find("```", begin + fence.size()) - begin - fence.size());
        const ScratchFolder folder{{"t.toml", live_scene}};
        BackgroundApp live(folder.path, {"live", "t.toml", "--port", "0", "--udp", "0", "--lockstep", "--record", "s.record"});
        REQUIRE(live.wait_for_rows(folder.path / ".out-background", 0));
        const std::string said = slurp(folder.path / ".out-background");
        const std::size_t at = said.find("hand UDP 127.0.0.1:");
        REQUIRE(at != std::string::npos);
        const std::string port = std::to_string(std::atoi(said.c_str() + at + 19));
        REQUIRE(has(client, "9090"));
        client.replace(client.find("9090"), 4, port);
        REQUIRE(has(client, "5001"));
        client.replace(client.find("5001"), 4, "2001");  // 4 cm of the tube
        folder.write("client.py", client);
        CHECK(std::system(
                  fmt::format("cd '{}' && timeout 60 /usr/bin/python3 client.py >said.txt", folder.path.string()).c_str()) == 0);
        const std::string felt = slurp(folder.path / "said.txt");
        CHECK(std::count(felt.begin(), felt.end(), '\n') == 2000);
        live.send(SIGTERM);
        CHECK(live.result().code == 75);
        const auto summary = nlohmann::json::parse(slurp(folder.path / "s.record.summary.json"));
        CHECK(summary["packets"]["accepted"] == 2000);
        CHECK(summary["score"]["reached"] == true);
    }

    TEST_CASE("property: where others reach the page a token is made, another one each time, and its address says it")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", live_scene}};
        std::string last;
        for (int k = 0; k < 2; ++k) {
            const AppResult live = run_ok(folder, "live t.toml --bind 0.0.0.0 --port 0 --udp 0 --duration 0.1");
            const std::size_t at = live.out.find("/?token=");
            REQUIRE(at != std::string::npos);
            const std::string token = live.out.substr(at + 8, live.out.find(' ', at) - at - 8);
            CHECK(token.size() == 32);
            CHECK(token != last);
            last = token;
        }
        CHECK_FALSE(has(run_app(folder, "live t.toml --port 0 --udp 0 --duration 0.1").out, "token"));
    }

    TEST_CASE("property: refusals are one line with the code that is documented")
    {
        if (!has_page()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", live_scene}, {"free.toml", free_scene()}};
        for (const char* silent : {"--quiet", "--json"})  // nobody would learn the token that is made
            check_refused(folder, fmt::format("live t.toml --bind 0.0.0.0 --port 0 --udp 0 --duration 0.1 {}", silent), 2,
                          "--token");
        check_refused(folder, "live t.toml --token short --port 0 --udp 0 --duration 0.1", 2, "--token: got 5 characters");
        check_refused(folder, "live t.toml --bind nowhere --port 0 --udp 0 --duration 0.1", 2, "--bind");
        check_refused(folder, "live t.toml --udp-bind nowhere --port 0 --udp 0 --duration 0.1", 2, "--udp-bind");
        check_refused(folder, "live free.toml --port 0 --udp 0 --duration 0.1", 2, "[feed]");
        check_refused(folder, "live t.toml --rate 0 --duration 0.1", 2, "--rate");
        check_refused(folder, "live t.toml --set task.target.branch=7 --set task.target.point=[0.0,0.0,0.0] --duration 0.1", 2,
                      "task.target");
        check_refused(folder, "live none.toml", 3, "none.toml");
        check_refused(folder, "report .", 3, "neither a run");
        const int taken = ::socket(AF_INET, SOCK_DGRAM, 0);
        sockaddr_in own{};
        own.sin_family = AF_INET;
        own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        REQUIRE(::bind(taken, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0);
        socklen_t size = sizeof own;
        getsockname(taken, reinterpret_cast<sockaddr*>(&own), &size);
        check_refused(folder, fmt::format("live t.toml --port 0 --udp {} --duration 0.1", ntohs(own.sin_port)), 3, "--udp");
        close(taken);
    }
}

}  // namespace seldinger::test::test_live_command

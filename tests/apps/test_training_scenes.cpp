// The training scenes as a hand plays them, in lockstep: each can be won, and each is lost by the mistake that it is there for.

#include "scene/scene.h"
#include "session/session.h"
#include "session/session_fixture.h"

namespace seldinger::test::test_training_scenes {

namespace {

/// Where the hand is from a time on; steadily from one to the next.
struct Key {
    double t, advance, turn;  // [s], [m], [rad]
};

Key along(const std::vector<Key>& way, double t)
{
    Key before{0, 0, 0};
    for (const Key& key : way) {
        if (t < key.t) {
            const double share = (t - before.t) / (key.t - before.t);
            return {t, before.advance + share * (key.advance - before.advance), before.turn + share * (key.turn - before.turn)};
        }
        before = key;
    }
    return way.back();
}

/// Ends where the target is reached.
ScoreNumbers played(const std::string& name, const std::vector<Key>& way)
{
    const Scene scene = read_scene(std::filesystem::path(SEL_SOURCE_DIR) / "assets/scenes/training" / (name + ".toml"));
    SessionOptions options;
    options.lockstep = true;
    HandSession live(scene, options);
    auto& [hand, session] = live;
    const Line line(SOCK_DGRAM, hand.port());
    SelHandAnswer answer{};
    for (std::uint64_t k = 1; k <= static_cast<std::uint64_t>(1000 * way.back().t) && !(answer.flags & SEL_HAND_REACHED); ++k) {
        const Key at = along(way, 1e-3 * static_cast<double>(k));
        if (line.ask(k, at.advance, at.turn, answer)) continue;
        session.stop();
        session.finish();
        FAIL("no answer in step " << k << ": " << session.failure());
    }
    session.stop();
    session.finish();
    CHECK(session.failure().empty());
    return session.score();
}

struct Play {
    const char* scene;
    const char* what;
    std::vector<Key> way;
    bool won;
};

}  // namespace

TEST_SUITE("apps/training")
{
    TEST_CASE("property: every training scene is won as its text says, and lost by force where it is pushed on without care")
    {
        const std::vector<Play> plays = {
            {"left-subclavian", "turned, then pushed gently", {{2, 0.05, 2.8}, {14, 0.28, 2.8}}, true},
            {"left-subclavian", "pushed straight on", {{20, 0.4, 0}}, false},
            {"siphon", "slowly", {{11, 0.066, 0}}, true},
            {"siphon", "fast", {{0.257, 0.077, 0}}, false},
            {"renal", "turned back, pushed past, pulled back", {{1, 0.01, -2}, {4, 0.085, -2}, {8, 0.05, -2}}, true},
            {"renal", "hook to the front", {{4, 0.095, 0}, {8, 0.05, 0}}, false},
        };
        for (const Play& play : plays) {
            CAPTURE(std::string(play.scene));
            CAPTURE(std::string(play.what));
            const ScoreNumbers score = played(play.scene, play.way);
            CAPTURE(score.time);
            CAPTURE(score.wall_force_max);
            CAPTURE(score.distance);
            CHECK((score.reached && !score.failed) == play.won);
            CHECK(score.failed == !play.won);
            if (!play.won) CHECK(score.time_above > 0);
        }
    }
}

}  // namespace seldinger::test::test_training_scenes

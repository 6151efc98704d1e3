// Whole sessions in this process: a hand over UDP, hostile datagrams, reset, record and replay, the score, and what the hub says
// of its own stiffness.

#include "session/session.h"

#include "session/session_fixture.h"
#include "setup/scene_setup.h"
#include "support/approx.h"
#include "support/temporary_folder.h"
#include "support/tries.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <thread>

namespace seldinger::test::test_session {

namespace {

Scene scene_of(const std::string& text = live_scene) { return read_scene_text(text, "live.toml"); }

void rest(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

/// The same inputs once more, without a clock. @return the state's hash
std::string replayed(const std::filesystem::path& path, const Scene& scene)
{
    const SessionRecord record = read_record(path);
    World world(make_setup(scene));
    check_record(record, path, scene, record.header.vessel_hash);
    const auto initial = world.save_state();
    Control control;
    for (std::size_t k = 0; k < record.entries.size(); ++k) {
        const RecordEntry& entry = record.entries[k];
        if (entry.kind == RecordEntry::Kind::Reset) world.restore_state(initial);
        if (entry.kind != RecordEntry::Kind::Step) continue;
        const bool cut = k + 1 < record.entries.size() && record.entries[k + 1].kind == RecordEntry::Kind::CutShort;
        world.cut_when([asked = 0u, at = cut ? record.entries[k + 1].trials : ~0u]() mutable { return ++asked >= at; });
        if (scene.feed.hub.driven()) control.push(0, entry.hubs[0], entry.hubs[1], spring_of(advance_coupling, record.header.dt));
        else control.move_to(0, entry.hubs[0], entry.hubs[1]);
        (void)step(world, control, record.header.dt);
    }
    return world.state_hash();
}

}  // namespace

TEST_SUITE("session/session")
{
    TEST_CASE(
        "property: a hand over UDP moves the instrument, is answered, and the record replays to the same bits, reset included")
    {
        const TemporaryFolder folder;
        const Scene scene = scene_of();
        SessionOptions options;
        options.record = folder.path() / "s.record";
        HandSession live(scene, options);
        auto& [hand, session] = live;
        const Line line(SOCK_DGRAM, hand.port());
        SelHandAnswer answer{};
        int answered = 0;
        for (std::uint64_t k = 1; k <= 700; ++k) {
            answered += line.ask(k, 0.06 * std::sin(0.004 * static_cast<double>(k)), 0.01 * static_cast<double>(k), answer);
            CHECK(answer.sequence == k);
            if (k == 350) {
                PageWish wish;
                wish.resets = 1;
                session.page.put(wish);
            }
            rest(1e-3);
        }
        REQUIRE(answered == 700);
        CHECK(answer.step > 0);
        CHECK(std::isfinite(answer.force_n));
        session.stop();
        session.finish();
        const std::string hash = session.world().state_hash();
        CHECK(replayed(options.record, scene) == hash);
        CHECK(read_record(options.record).whole);
        CHECK(read_record(options.record).entries.back().hash == hash);
        const auto summary = nlohmann::json::parse(session.summary());
        CHECK(summary["packets"]["accepted"] == 700);
        CHECK(summary["resets"] == 1);
        CHECK(summary["state_hash"] == hash);
        // The energy brought in is never less than the energy stored and dissipated, except for a contact that was not foreseen:
        // in the step that meets it, it gives the wire's mass m an impulse of m v at most, over a way of v T. At the hub's
        // largest speed, where a late packet makes the hand jump, m v^2 is 0.12 mJ.
        const WireSection& shaft = scene.wire.shaft;
        const double mass = shaft.density * std::numbers::pi * shaft.radius * shaft.radius * scene.wire.length;
        const double speed = advance_coupling.speed_limit;
        CHECK(summary["coupling"][0]["advance_energy_lowest_j"].get<double>() > -mass * speed * speed);
    }

    TEST_CASE(
        "property: in lockstep each request makes one step and is answered by it, and the session does not depend on the clock")
    {
        const Scene scene = scene_of();
        const auto played = [&](int pause_every) {
            SessionOptions options;
            options.lockstep = true;
            HandSession live(scene, options);
            auto& [hand, session] = live;
            const Line line(SOCK_DGRAM, hand.port());
            SelHandAnswer answer{};
            for (std::uint64_t k = 1; k <= 400; ++k) {
                REQUIRE(line.ask(k, 2e-4 * static_cast<double>(k), 0.01 * static_cast<double>(k),
                                 answer));  // 0.2 m/s of session time
                CHECK(answer.step == k);
                CHECK(answer.time_s == about(1e-3 * static_cast<double>(k)));
                if (k % static_cast<std::uint64_t>(pause_every) == 0) rest(3e-3);
            }
            session.stop();
            session.finish();
            const auto summary = nlohmann::json::parse(session.summary());
            CHECK(summary["late"] == 0);
            CHECK(summary["steps"] == 400);
            return session.world().state_hash();
        };
        CHECK(played(7) == played(1000));
    }

    // With the hand still, the spring pulls until what is left is less than friction holds: at 500 N/m micrometres.
    TEST_CASE(
        "property: a hub that a force drives follows the hand by the spring, without energy from nowhere; the record replays")
    {
        const TemporaryFolder folder;
        const std::vector<std::string> driven{"feed.hub_mass_kg=0.02", "feed.keys=[{t_s=0.0, force_n=0.0}]"};
        const Scene scene = read_scene_text(live_scene, "live.toml", driven);
        SessionOptions options{.lockstep = true, .record = folder.path() / "s.record"};
        HandSession live(scene, options);
        auto& [hand, session] = live;
        const Line line(SOCK_DGRAM, hand.port());
        SelHandAnswer answer{};
        for (std::uint64_t k = 1; k <= 500; ++k)
            REQUIRE(line.ask(k, std::min(0.04, 2e-4 * static_cast<double>(k)), 0.002 * static_cast<double>(k), answer));
        session.stop();
        session.finish();
        CHECK(replayed(options.record, scene) == session.world().state_hash());
        const WireReadings r = session.world().readings(0);
        CHECK(std::abs(r.inserted - 0.04) < 1e-3);
        CHECK(r.hub.work > 0);
        CHECK(std::abs(r.hub.open()) < 1e-3 * r.hub.work);
        const auto summary = nlohmann::json::parse(session.summary());
        CHECK(summary["coupling"][0]["advance_energy_lowest_j"].get<double>() > -1e-12);
    }

    TEST_CASE("property: steps that a deadline cuts short are told of, counted, and replayed to the same bits")
    {
        const TemporaryFolder folder;
        const Scene scene = scene_of();
        SessionOptions options{.lockstep = true, .record = folder.path() / "s.record"};
        options.due = [](std::uint32_t trials) { return trials >= 2; };
        HandSession live(scene, options);
        auto& [hand, session] = live;
        const Line line(SOCK_DGRAM, hand.port());
        SelHandAnswer answer{};
        std::uint64_t told = 0;
        for (std::uint64_t k = 1; k <= 400; ++k) {
            REQUIRE(line.ask(k, 2e-4 * static_cast<double>(k), 0.0, answer));
            CHECK((answer.flags & SEL_HAND_STOPPED) == 0);
            told += (answer.flags & SEL_HAND_SHORT) != 0;
        }
        session.stop();
        session.finish();
        const auto summary = nlohmann::json::parse(session.summary());
        CHECK(told > 10);
        CHECK(told < 400);
        CHECK(summary["cut_short"] == told);
        CHECK(session.world().readings(0).outside == 0);
        CHECK(replayed(options.record, scene) == session.world().state_hash());
    }

    TEST_CASE("property: a session in lockstep ends while it waits for the hand")
    {
        const Scene scene = scene_of();
        SessionOptions options;
        options.lockstep = true;
        HandSession live(scene, options);
        Session& session = live.session;
        session.stop();
        session.finish();
        CHECK(session.steps_so_far() == 0);
        CHECK_THROWS_AS(Session(scene, make_setup(scene), options, nullptr), Error);
    }

    TEST_CASE("property: hostile datagrams move nothing and are counted")
    {
        const Scene scene = scene_of();
        HandSession live(scene);
        auto& [hand, session] = live;
        const Line line(SOCK_DGRAM, hand.port());
        SelHandAnswer answer{};
        REQUIRE(line.ask(5, 0.001, 0, answer));
        std::string junk(2000, 'x');
        const int n = 20000;
        for (int k = 0; k < n; ++k) {
            line.send(junk.data(), static_cast<std::size_t>(k % 2000));
            if (k % 200 == 0) rest(1e-3);  // what the socket has no room for is lost before it is counted
        }
        // what follows must find room
        for (auto seen = hand.count(HandGate::Verdict::Malformed) - 1; seen != hand.count(HandGate::Verdict::Malformed);
             rest(0.05))
            seen = hand.count(HandGate::Verdict::Malformed);
        const SelHandRequest bad{0, 6, 0, std::nan(""), 0, 0}, jump{0, 7, 0, 5.0, 0, 0};
        for (const SelHandRequest& r : {bad, jump}) {
            unsigned char bytes[SEL_HAND_REQUEST_BYTES];
            sel_write_request(&r, bytes);
            line.send(bytes, sizeof bytes);
        }
        REQUIRE(line.ask(8, 0.002, 0, answer));
        CHECK(answer.sequence == 8);
        CHECK(hand.count(HandGate::Verdict::Malformed) > n / 20);  // the socket holds a hundred of them
        CHECK(hand.count(HandGate::Verdict::NotFinite) == 1);
        CHECK(hand.count(HandGate::Verdict::Jump) == 1);
        CHECK(hand.count(HandGate::Verdict::Accepted) == 2);
        rest(0.2);
        session.stop();
        session.finish();
        CHECK(session.failure().empty());
        CHECK(session.world().readings(0).inserted == about(0.002).epsilon(0.05));
    }

    TEST_CASE("property: a page pushes the wire to the target, falls silent and is still, and the score says what was done")
    {
        const Scene scene = scene_of();
        SessionOptions options;
        options.duration = 2.5;
        Session session(scene, make_setup(scene), options, nullptr);
        PageWish wish;
        wish.push = 0.03;
        wish.until = session.clock() + 1.2;  // 0.004 + 0.036 m
        wish.fluoroscopy = true;
        session.page.put(wish);
        session.start();
        while (session.running()) rest(0.01);
        session.finish();
        const ScoreNumbers& score = session.score();
        CHECK(session.steps_so_far() == 2500);
        CHECK(score.reached);
        CHECK_FALSE(score.failed);
        CHECK(score.pushes == 1);
        CHECK(score.pull_backs == 0);
        CHECK(score.path_length == about(score.advanced).epsilon(0.1));  // it slides along a straight floor
        CHECK(score.fluoroscopy == about(score.time));
        CHECK(session.world().readings(0).inserted < 0.04);
        const auto sheet = nlohmann::json::parse(score_json(scene, score));
        CHECK(sheet["verdict"] == "passed");
        CHECK(score_page(scene, score).find("Three centimetres in.") != std::string::npos);
    }

    TEST_CASE("property: a record that was cut off anywhere is read up to its last whole block")
    {
        const TemporaryFolder folder;
        const auto path = folder.path() / "cut.record";
        {
            RecordWriter writer(path, {version(), "n", "d", 1, 2, 1e-3, 1});
            for (int block = 0; block < 3; ++block) {
                std::vector<std::uint8_t> bytes;
                const double hubs[] = {0.1 * block, 0.2};
                for (int k = 0; k < 10; ++k) put_step(bytes, 0, hubs, 1);
                writer.append(bytes);
            }
        }
        const std::string text = read_file(path);
        CHECK(read_record(path).steps() == 30);
        CHECK_FALSE(read_record(path).whole);
        const std::size_t block = 12 + 10 * 18;
        for (std::size_t cut = 1; cut < block; cut += 7) {
            write_file(path, text.substr(0, text.size() - cut));
            CHECK(read_record(path).steps() == 20);
        }
        std::string flipped = text;
        flipped[text.size() - block - 1] ^= 1;  // in the second block: it and what follows is not believed
        write_file(path, flipped);
        CHECK(read_record(path).steps() == 10);
        write_file(path, "no record");
        CHECK_THROWS_WITH_AS((void)read_record(path), doctest::Contains("is no record"), Error);
    }

    TEST_CASE("property: a record that asks for what is no number, or no length, is refused although its blocks are sealed")
    {
        const TemporaryFolder folder;
        const auto path = folder.path() / "odd.record";
        for (const double odd : {std::nan(""), HUGE_VAL, -1e300}) {
            RecordWriter writer(path, {version(), "n", "d", 1, 2, 1e-3, 1});
            std::vector<std::uint8_t> bytes;
            const double hubs[] = {0.1, odd};
            put_step(bytes, 0, hubs, 1);
            writer.append(bytes);
            CHECK_THROWS_WITH_AS((void)read_record(path), doctest::Contains("has a damaged block"), Error);
        }
    }

    TEST_CASE("property: a record with any byte of it altered and sealed anew is refused in one line, or holds what can be asked")
    {
        const TemporaryFolder folder;
        const auto path = folder.path() / "mutant.record";
        std::mt19937 random(3);
        for (long k = 0, n = tries("SELDINGER_MUTANTS", 2000); k < n; ++k) {
            CAPTURE(k);
            std::filesystem::remove(path);  // what is no record is not written over
            RecordWriter writer(path, {version(), "n", "d", 1, 2, 1e-3, static_cast<int>(1 + random() % 3)});
            std::vector<std::uint8_t> bytes;
            const double hubs[] = {0.1, 0.2, 0, 0, 0, 0};
            for (int step = 0; step < 4; ++step) put_step(bytes, 0, hubs, 1 + static_cast<int>(random() % 3));
            put_reset(bytes);
            for (unsigned times = random() % 4; times > 0; --times)
                bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
            if (random() % 8 == 0) bytes.resize(random() % bytes.size());
            writer.append(bytes);  // sealed
            if (random() % 2) {    // and a byte anywhere, its head too
                std::string text = read_file(path);
                text[random() % text.size()] = static_cast<char>(random());
                write_file(path, text);
            }
            try {
                const SessionRecord record = read_record(path);
                CHECK(record.header.dt > 0);
                for (const RecordEntry& entry : record.entries)
                    for (const double asked : entry.hubs) CHECK(std::abs(asked) <= 1e9);
            } catch (const Error& error) {
                CHECK(error.kind() == ErrorKind::BadFile);
                CHECK(std::string(error.what()).find('\n') == std::string::npos);
            }
        }
    }

    // a page cannot ask for this; steps of 1e-151 s make of a way that it can ask for energies that are no numbers
    TEST_CASE("property: a session whose step ends in what is no number stops, says so and shows numbers")
    {
        std::string text = live_scene;
        text.replace(text.find("length_m = 0.1"), 14, "length_m = 1e4");
        text.erase(text.find("[vessel]"), text.find("[feed]") - text.find("[vessel]"));
        text.erase(text.find("[task]"));
        const Scene scene = scene_of(text);
        SessionOptions options;
        options.rate = 1e151;
        options.advance.speed_limit = 1e300;
        Session session(scene, make_setup(scene), options, nullptr);
        PageWish wish{.push = 1e155, .until = session.clock() + 1e3};
        session.page.put(wish);
        session.start();
        for (int k = 0; k < 1000 && session.running() && session.steps_so_far() < 1; ++k) rest(0.01);
        rest(0.1);
        session.stop();
        session.finish();
        CHECK(session.failure().find("found no state") != std::string::npos);
        REQUIRE(session.view.take());
        for (const auto& nodes : session.view.front().nodes)
            for (const auto& node : nodes) CHECK(std::isfinite(node.x + node.y + node.z));
    }

    TEST_CASE("derivative: hand_stiffness is how the hand's force grows with what is fed within a step")
    {
        Scene scene = scene_of();
        World world(make_setup(scene));
        world.watch_hand_stiffness();
        Control control;
        double at = 0.004;
        for (int k = 0; k < 1200; ++k) (void)step(world, control.move_to(0, at += 2e-5, 0.0), 1e-3);
        REQUIRE(world.readings(0).contacts > 0);
        const auto state = world.save_state();
        const double d = 1e-8;
        double force[2], stiffness = 0;
        for (const int side : {0, 1}) {
            world.restore_state(state);
            (void)step(world, control.move_to(0, at + 2e-5 + (side ? d : -d), 0.0), 1e-3);
            force[side] = world.readings(0).hand_force;
            stiffness = world.readings(0).hand_stiffness;
        }
        const double measured = (force[1] - force[0]) / (2 * d);
        CAPTURE(stiffness);
        REQUIRE(measured > 10);
        // its factors are those of the last Newton iteration but one, and the curvature of the hub's own cell is left out
        CHECK(stiffness == about(measured).epsilon(0.05));
    }

    TEST_CASE("property: watching the stiffness and reading snapshots changes no bit")
    {
        const Scene scene = scene_of();
        std::string hash[2];
        for (const int watched : {0, 1}) {
            World world(make_setup(scene));
            if (watched) world.watch_hand_stiffness();
            Control control;
            for (int k = 0; k < 400; ++k) (void)step(world, control.move_to(0, 0.004 + 1e-4 * k, 1e-3 * k), 1e-3);
            hash[watched] = world.state_hash();
        }
        CHECK(hash[0] == hash[1]);
    }

    TEST_CASE("regression: a hand that was away and comes back elsewhere meets no jump: the hub eases in")
    {
        const Scene scene = scene_of();
        SessionOptions options;
        options.lockstep = true;
        HandSession live(scene, options);
        auto& [hand, session] = live;
        SelHandAnswer answer{};
        double most = 0;
        {
            const Line line(SOCK_DGRAM, hand.port());
            for (std::uint64_t k = 1; k <= 200; ++k) {
                REQUIRE(line.ask(k, 5e-5 * static_cast<double>(k), 0.001 * static_cast<double>(k), answer));
                most = std::max(most, std::abs(answer.force_n));
            }
        }
        CHECK(answer.advance_m == about(0.01).epsilon(0.02));
        CHECK(most < 0.2);
        rest(1.5 * HandGate::silence);
        // on another port, 20 mm and half a turn farther: 10 N of the coupling's 500 N/m, had the hub to follow at once
        const Line back(SOCK_DGRAM, hand.port());
        double before = answer.advance_m, fastest = 0;
        for (std::uint64_t k = 1; k <= 600; ++k) {
            REQUIRE(back.ask(k, 0.03, 3.3, answer));
            most = std::max(most, std::abs(answer.force_n));
            fastest = std::max(fastest, (answer.advance_m - before) / 1e-3);
            before = answer.advance_m;
        }
        CHECK(most < 1.1);     // the ease ends at 1 N, and a step's growth
        CHECK(fastest < 0.1);  // it goes at 0.05 m/s; the coupling swings in
        CHECK(answer.advance_m == about(0.03).epsilon(0.02));
        session.stop();
        session.finish();
    }
}

}  // namespace seldinger::test::test_session

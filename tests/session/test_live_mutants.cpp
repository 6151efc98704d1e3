// What a live session receives, altered: requests, WebSocket frames and packets of a hand. The session continues.
// SELDINGER_MUTANTS=N sends so many of each.

#include "session/hand_channel.h"
#include "session/session.h"
#include "session/web_server.h"

#include "session/session_fixture.h"
#include "setup/scene_setup.h"
#include "support/tries.h"

#include <cmath>
#include <limits>
#include <random>

namespace seldinger::test::test_live_mutants {

namespace {

/// Some bytes changed, lost, doubled or put in.
std::string spoiled(std::string text, std::mt19937& random)
{
    for (unsigned times = 1 + random() % 4; times > 0 && !text.empty(); --times) {
        const std::size_t at = random() % text.size();
        switch (random() % 5) {
            case 0: text[at] = static_cast<char>(random()); break;
            case 1: text.erase(at, 1 + random() % 20); break;
            case 2: text.insert(at, text.substr(at, random() % 40)); break;
            case 3: text.insert(at, std::string(1 + random() % 300, static_cast<char>(random()))); break;
            default: text.resize(at);
        }
    }
    return text;
}

std::string request(int port, const std::string& more)
{
    return "GET /ws HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + more + "\r\n";
}

const std::string upgrade =
    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n";

/// A text frame as a browser masks it, by a mask of zeros.
std::string frame(const std::string& text)
{
    return std::string{'\x81', static_cast<char>(0x80 | text.size()), 0, 0, 0, 0} + text;
}

}  // namespace

TEST_SUITE("session/live mutants")
{
    TEST_CASE("property: a server that is sent altered requests and frames still serves")
    {
        const Scene scene = read_scene_text(live_scene, "live.toml");
        Session session{scene, make_setup(scene), {}, nullptr};
        WebServer web({"127.0.0.1", "", 0}, scene, session);
        web.start();
        session.start();
        std::mt19937 random(5);
        const std::string said[] = {R"({"type":"reset"})", R"({"type":"hand","instrument":0,"advance":0.01,"turn":0.5})",
                                    R"({"type":"pause","on":true})"};
        for (long k = 0, n = tries("SELDINGER_MUTANTS", 150); k < n; ++k) {
            const Line line(SOCK_STREAM, web.port());
            if (random() % 2) {
                line.send(spoiled(request(web.port(), upgrade), random));
            } else {
                line.send(request(web.port(), upgrade));
                (void)line.receive();
                for (int frames = 0; frames < 5; ++frames) line.send(spoiled(frame(said[random() % 3]), random));
            }
        }
        const Line line(SOCK_STREAM, web.port());
        line.send(request(web.port(), upgrade));
        CHECK(line.receive().find("101") != std::string::npos);
        CHECK(session.running());
        CHECK(session.failure().empty());
        session.stop();
        session.finish();
        web.stop();
    }

    TEST_CASE(
        "property: packets of a hand that were altered, or ask for what is no number, leave a session whose numbers are numbers")
    {
        const Scene scene = read_scene_text(live_scene, "live.toml");
        HandSession live(scene);
        auto& [hand, session] = live;
        const Line line(SOCK_DGRAM, hand.port());
        std::mt19937 random(6);
        constexpr double odd[] = {
            std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300, -1e300, -1, 5};
        for (long k = 0, n = tries("SELDINGER_MUTANTS", 500); k < n; ++k) {
            const auto number = [&] { return odd[random() % 6]; };
            const SelHandRequest wish{0, static_cast<std::uint64_t>(k + 1), number(), number(), number(), 0};
            unsigned char bytes[SEL_HAND_REQUEST_BYTES];
            sel_write_request(&wish, bytes);
            std::string packet(reinterpret_cast<const char*>(bytes), sizeof bytes);
            if (random() % 2) packet = spoiled(packet, random);
            line.send(packet);
        }
        CHECK(session.running());
        CHECK(session.failure().empty());
        session.stop();
        session.finish();
        hand.stop();
        for (const double place : {session.world().readings(0).inserted, session.world().readings(0).hand_force})
            CHECK(std::isfinite(place));
    }
}

}  // namespace seldinger::test::test_live_mutants

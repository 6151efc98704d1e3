// Admission, messages of a page, and the server's refusals over a real socket.

#include "session/web_content.h"
#include "session/web_policy.h"
#include "session/web_server.h"

#include "session/session.h"
#include "session/session_fixture.h"
#include "setup/scene_setup.h"
#include "support/skip.h"

#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <thread>

namespace seldinger::test::test_web {

namespace {

std::string get(int port, const std::string& target, const std::string& more = "", const std::string& host = "127.0.0.1")
{
    const Line line(SOCK_STREAM, port);
    line.send("GET " + target + " HTTP/1.1\r\nHost: " + host + ":" + std::to_string(port) + "\r\n" + more +
              "Connection: close\r\n\r\n");
    std::string all;
    for (std::string part = line.receive(); !part.empty(); part = line.receive()) all += part;
    return all;
}

const std::string upgrade =
    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n";

std::string open_socket(const Line& line, int port, const std::string& origin = "", const std::string& target = "/ws")
{
    line.send("GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + upgrade +
              (origin.empty() ? "" : "Origin: " + origin + "\r\n") + "\r\n");
    return line.receive();
}

struct Served {
    Scene scene = read_scene_text(live_scene, "live.toml");
    Session session{scene, make_setup(scene), {}, nullptr};
    WebServer web;
    explicit Served(const std::string& token = "") : web({"127.0.0.1", token, 0}, scene, session)
    {
        web.start();
        session.start();
    }
    ~Served()
    {
        session.stop();
        session.finish();
        web.stop();
    }
};

}  // namespace

TEST_SUITE("session/web")
{
    TEST_CASE("property: who is admitted")
    {
        using enum Admission;
        const auto here = "127.0.0.1";
        CHECK(admit({"/", "127.0.0.1:8080", "", ""}, here, "") == Welcome);
        CHECK(admit({"/", "localhost:8080", "http://localhost:8080", ""}, here, "") == Welcome);
        CHECK(admit({"/", "[::1]:8080", "", ""}, here, "") == Welcome);
        CHECK(admit({"/", "[::1]:8080", "http://[::1]:8080", ""}, "::1", "") == Welcome);
        CHECK(admit({"/", "evil.example:8080", "", ""}, here, "") == WrongHost);  // its name points here
        for (const char* name : {"127.evil.example", "127.0.0.1.evil.example", "127.0.0.1evil", "127.0.0.1.", "127.1"}) {
            CAPTURE(name);  // names of others, too, that a page's script asks by: they may point here
            CHECK(admit({"/ws", name, std::string("http://") + name, ""}, here, "") == WrongHost);
        }
        CHECK(admit({"/", "127.8.9.10:8080", "", ""}, here, "") == Welcome);
        CHECK(admit({"/", "", "", ""}, here, "") == WrongHost);
        CHECK(admit({"/ws", "127.0.0.1:8080", "http://evil.example", ""}, here, "") == WrongOrigin);
        CHECK(admit({"/ws", "127.0.0.1:8080", "http://127.0.0.1:9999", ""}, here, "") == WrongOrigin);
        CHECK(admit({"/ws", "127.0.0.1:8080", "null", ""}, here, "") == WrongOrigin);
        CHECK(admit({"/", "192.168.1.5:8080", "", ""}, "0.0.0.0", "secret") == WrongToken);
        CHECK(admit({"/?token=secre", "192.168.1.5:8080", "", ""}, "0.0.0.0", "secret") == WrongToken);
        CHECK(admit({"/?token=secrets", "192.168.1.5:8080", "", ""}, "0.0.0.0", "secret") == WrongToken);
        CHECK(admit({"/?a=b&token=secret", "192.168.1.5:8080", "", ""}, "0.0.0.0", "secret") == Welcome);
        CHECK(admit({"/ws", "192.168.1.5:8080", "", "x=y; seldinger_token=secret"}, "0.0.0.0", "secret") == Welcome);
        CHECK(is_loopback("127.0.0.1"));
        CHECK_FALSE(is_loopback("0.0.0.0"));
        CHECK_FALSE(is_loopback("10.0.0.1"));
    }

    TEST_CASE(
        "property: a token is sixteen characters that an address and a cookie carry as they are; one that is made is such a one")
    {
        CHECK(is_token("abcdefghABCDEFGH"));
        CHECK(is_token("0123456789-._~aZ"));
        CHECK_FALSE(is_token("abcdefghABCDEFG"));
        for (const char* text : {" ", ";", "&", "=", "%", "#", "+", "\"", ",", "\n", "\xc3\xa4"}) {
            CAPTURE(text);
            CHECK_FALSE(is_token(std::string("abcdefghABCDEFGH") + text));
        }
        const std::string one = make_token(), other = make_token();
        CHECK(is_token(one));
        CHECK(one.size() == 32);
        CHECK(one != other);
        // accepted requests come through an address and a cookie
        for (const std::string& token : {one, std::string("0123456789-._~aZ")}) {
            CHECK(admit({"/?token=" + token, "192.168.1.5:8080", "", ""}, "0.0.0.0", token) == Admission::Welcome);
            CHECK(admit({"/ws", "192.168.1.5:8080", "", "a=b; seldinger_token=" + token}, "0.0.0.0", token) ==
                  Admission::Welcome);
        }
    }

    TEST_CASE("property: an address of version 6 stands in brackets in a URL")
    {
        CHECK(in_url("127.0.0.1") == "127.0.0.1");
        CHECK(in_url("::1") == "[::1]");
        CHECK(in_url("[::1]") == "[::1]");
    }

    TEST_CASE("property: wrong tokens of an address are tried so many a second, however many come; others are not kept waiting")
    {
        WrongTokens wrong;
        int tried = 0;
        const auto guess = [&](const std::string& who, double now) {
            if (!wrong.may_try(who, now)) return false;
            wrong.count(who, now);
            return true;
        };
        for (int k = 0; k < 71'000; ++k) tried += guess("10.0.0.1", 1.0 + k / 7100.0);  // ten seconds of 7,100 a second
        CHECK(tried >= 68);  // 20 at once and five a second
        CHECK(tried <= 70);
        CHECK(wrong.may_try("10.0.0.2", 11.0));
        CHECK_FALSE(wrong.may_try("10.0.0.1", 11.0));
        CHECK(wrong.may_try("10.0.0.1", 12.0));
        for (int k = 0; k < 100'000; ++k)
            (void)guess(std::to_string(k), 12.0 + 1e-5 * k);  // remembers so many, and forgets the oldest
        CHECK(guess("10.0.0.1", 13.0));
    }

    TEST_CASE("property: what a page may say")
    {
        PageWish wish;
        bool reset = false;
        CHECK(read_wish(R"({"push": 0.03, "turn": -2, "instrument": 1, "fluoro": true})", wish, reset));
        CHECK(wish.push == 0.03);
        CHECK(wish.instrument == 1);
        CHECK(wish.fluoroscopy);
        CHECK(read_wish(R"({"reset": true})", wish, reset));
        CHECK(reset);
        CHECK(wish.push == 0.03);  // what is not said stays
        for (const char* bad :
             {"", "[]", "7", "{", R"({"push": "far"})", R"({"push": 1e9})", R"({"push": null})", R"({"instrument": -1})",
              R"({"instrument": 0.5})", R"({"instrument": 99})", R"({"pause": 1})", "\xff\xfe"}) {
            CAPTURE(bad);
            const PageWish before = wish;
            CHECK_FALSE(read_wish(bad, wish, reset));
            CHECK(wish.push == before.push);
            CHECK(wish.instrument == before.instrument);
        }
    }

    TEST_CASE("property: more messages than a page sends are not allowed, as many are")
    {
        RateLimit limit(100);
        int allowed = 0;
        for (int k = 0; k < 1000; ++k) allowed += limit.allow(1.0);
        CHECK(allowed == 100);
        for (int k = 1; k <= 1000; ++k) CHECK(limit.allow(1.0 + 0.011 * k));
    }

    TEST_CASE("property: an address that others reach needs a token, and a port that is taken is one line")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        Served served;
        CHECK_THROWS_WITH_AS(WebServer({"0.0.0.0", "", 0}, served.scene, served.session), doctest::Contains("--token"), Error);
        CHECK_THROWS_WITH_AS(WebServer({"127.0.0.1", "", served.web.port()}, served.scene, served.session),
                             doctest::Contains("--port"), Error);
        for (const char* weak : {"x", "fifteen-letters", "a token with blanks in it", "a;b&c-0123456789abcdef"})
            for (const char* address : {"0.0.0.0", "127.0.0.1"}) {
                CAPTURE(weak);
                CHECK_THROWS_WITH_AS(WebServer({address, weak, 0}, served.scene, served.session),
                                     doctest::Contains("--token: got"), Error);
            }
        CHECK_THROWS_WITH_AS(WebServer({"nowhere", "", 0}, served.scene, served.session), doctest::Contains("--bind"), Error);
    }

    TEST_CASE("property: pages, refusals and hostile bytes over a socket")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        Served served;
        const int port = served.web.port();
        CHECK(get(port, "/").find("200 OK") != std::string::npos);
        CHECK(get(port, "/scene.json").find("\"live tube\"") != std::string::npos);
        CHECK(get(port, "/mesh.bin").find("200 OK") != std::string::npos);
        CHECK(get(port, "/../CMakeLists.txt").find("404") != std::string::npos);
        CHECK(get(port, "/", "", "evil.example").find("403") != std::string::npos);
        CHECK(get(port, "/", "X: " + std::string(20000, 'x') + "\r\n").find("200") == std::string::npos);
        {
            const Line foreign(SOCK_STREAM, port), own(SOCK_STREAM, port);
            CHECK(open_socket(foreign, port, "http://evil.example").find("403") != std::string::npos);
            CHECK(open_socket(own, port, "http://127.0.0.1:" + std::to_string(port)).find("101") != std::string::npos);
            CHECK_FALSE(own.receive().empty());  // frames come
        }
        for (int k = 0; k < 200; ++k) {  // frames that are none: unmasked, too long, of no kind
            const Line line(SOCK_STREAM, port);
            (void)open_socket(line, port);
            const std::string bad[] = {std::string("\x81\x05hello", 7),
                                       std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff", 10),
                                       std::string("\xbf\x80zzzz", 6), std::string(3000, static_cast<char>(k))};
            line.send(bad[k % 4]);
        }
        CHECK(get(port, "/").find("200 OK") != std::string::npos);
        CHECK(served.session.running());
        // a text that anyone may put into a link becomes no cookie where the session has no token
        CHECK(get(port, "/?token=x;%20Path=/").find("Set-Cookie") == std::string::npos);
    }

    TEST_CASE("regression: while there is no descriptor for who connects, the server waits and does not ask again and again")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        Served served;
        const int port = served.web.port();
        REQUIRE(get(port, "/").find("200 OK") != std::string::npos);  // accepting
        const int waiting = ::socket(AF_INET, SOCK_STREAM, 0);
        rlimit before{};
        REQUIRE(::getrlimit(RLIMIT_NOFILE, &before) == 0);
        rlimit none = before;
        none.rlim_cur = 3;  // those that are open stay open
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<std::uint16_t>(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        REQUIRE(::setrlimit(RLIMIT_NOFILE, &none) == 0);
        const auto start = std::chrono::steady_clock::now();
        const int connected = ::connect(waiting, reinterpret_cast<const sockaddr*>(&address), sizeof address);
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
        REQUIRE(::setrlimit(RLIMIT_NOFILE, &before) == 0);
        REQUIRE(connected == 0);
        CHECK(get(port, "/").find("200 OK") != std::string::npos);  // and goes on
        ::close(waiting);
        served.web.stop();
        // one look in 25 ms of whatever time it was, and one that was under way; it was some 10^5 a second
        CHECK(served.web.counts().not_accepted >= 1);
        CHECK(static_cast<double>(served.web.counts().not_accepted) <= 2 + waited.count() / 0.025);
    }

    TEST_CASE("property: no more sockets than there may be")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        Served served;
        std::vector<std::unique_ptr<Line>> lines;
        int open = 0, refused = 0;
        for (int k = 0; k < 12; ++k) {
            lines.push_back(std::make_unique<Line>(SOCK_STREAM, served.web.port()));
            const std::string answer = open_socket(*lines.back(), served.web.port());
            open += answer.find("101") != std::string::npos;
            refused += answer.find("503") != std::string::npos;
        }
        CHECK(open == 8);
        CHECK(refused == 4);
    }

    TEST_CASE("regression: requests that are never finished do not keep a page out, from however many connections")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        Served served;
        const int port = served.web.port();
        std::vector<std::unique_ptr<Line>> halves;
        for (int k = 0; k < 80; ++k) {
            halves.push_back(std::make_unique<Line>(SOCK_STREAM, port));
            halves.back()->send("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ");
        }
        CHECK(get(port, "/").find("200 OK") != std::string::npos);
        // those that came last still wait, and the first were closed for them
        CHECK(halves.front()->receive() == "");
        halves.back()->send("y\r\nConnection: close\r\n\r\n");
        CHECK(halves.back()->receive().find("200 OK") != std::string::npos);
        served.web.stop();
        CHECK(served.web.counts().gave_way == 80 - 16 + 1);
        CHECK(served.web.counts().refused == 0);
    }

    TEST_CASE("regression: a request with two hosts or two origins is none")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        Served served;
        const int port = served.web.port();
        const std::string own = "127.0.0.1:" + std::to_string(port);
        CHECK(get(port, "/", "Host: evil.example\r\n").find("HTTP/1.1 400") == 0);
        CHECK(get(port, "/", "Host: " + own + "\r\n").find("HTTP/1.1 400") == 0);
        CHECK(get(port, "/", "Origin: http://" + own + "\r\nOrigin: http://evil.example\r\n").find("HTTP/1.1 400") == 0);
        CHECK(get(port, "/", "Origin: http://" + own + "\r\n").find("200 OK") != std::string::npos);
        const Line line(SOCK_STREAM, port);
        line.send("GET / HTTP/1.1\r\nConnection: close\r\n\r\n");
        CHECK(line.receive().find("HTTP/1.1 400") == 0);
    }

    TEST_CASE("regression: wrong tokens are not looked at as fast as they come")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        const std::string token = make_token();
        Served served(token);
        const int port = served.web.port();
        const auto begun = std::chrono::steady_clock::now();
        int wrong = 0, put_off = 0;
        for (int k = 0; k < 200; ++k) {
            const std::string answer = get(port, "/?token=" + make_token());
            wrong += answer.find("HTTP/1.1 403") == 0;
            put_off += answer.find("HTTP/1.1 429") == 0;
        }
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
        CHECK(wrong + put_off == 200);
        CHECK(wrong <= WrongTokens::at_once + WrongTokens::per_second * took.count() + 1);
    }

    TEST_CASE("property: an address of version 6 is taken with and without brackets")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        Served served;
        const int probe = ::socket(AF_INET6, SOCK_STREAM, 0);
        sockaddr_in6 own{};
        own.sin6_family = AF_INET6;
        own.sin6_addr = in6addr_loopback;
        const bool has_version_6 = probe >= 0 && ::bind(probe, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0;
        if (probe >= 0) ::close(probe);
        if (!has_version_6) return skip("no address of version 6 here");
        for (const char* address : {"::1", "[::1]"}) CHECK_NOTHROW(WebServer({address, "", 0}, served.scene, served.session));
    }

    TEST_CASE("property: with a token, nothing without it")
    {
        if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) return skip("libjs-three is not installed");
        const std::string token = make_token();
        Served served(token);
        const int port = served.web.port();
        CHECK(get(port, "/").find("403") != std::string::npos);
        CHECK(get(port, "/mesh.bin?token=wrong").find("403") != std::string::npos);
        CHECK(get(port, "/?token=" + token).find("seldinger_token=" + token + "; HttpOnly") != std::string::npos);
        CHECK(get(port, "/live.js", "Cookie: seldinger_token=" + token + "\r\n").find("200 OK") != std::string::npos);
        const Line line(SOCK_STREAM, port);
        CHECK(open_socket(line, port).find("403") != std::string::npos);
    }
}

}  // namespace seldinger::test::test_web

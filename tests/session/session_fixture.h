#pragma once
// A small scene for live sessions, and a hand and a browser's end of a line as plain sockets.

#include "scene/scene.h"
#include "session/hand_channel.h"
#include "session/hand_packet.h"
#include "session/session.h"
#include "setup/scene_setup.h"
#include "support/scenes.h"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <string>

namespace seldinger::test {

/// A wire fed into a straight tube that ends at a slanting angle to it; target 3 cm in.
inline const std::string live_scene =
    shared_scene("[scene]\nname = \"live tube\"\nduration_s = 1.0\ndt_s = 0.001\n", "tube") +
    "keys = [ {t_s = 0.0, advance_m = 0.004}, {t_s = 1.0, advance_m = 0.084} ]\n[task]\ntext = \"Three centimetres in.\"\n"
    "target = { point = [0.03, 0.0, -0.0045], radius_m = 0.002 }\n";

class Line {
public:
    Line(int type, int port) : socket_(::socket(AF_INET, type, 0))
    {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(static_cast<std::uint16_t>(port));
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const timeval patience{2, 0};
        setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        REQUIRE(connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
    }
    ~Line() { close(socket_); }
    Line(const Line&) = delete;
    Line& operator=(const Line&) = delete;

    void send(const void* bytes, std::size_t size) const { (void)::send(socket_, bytes, size, MSG_NOSIGNAL); }
    void send(const std::string& text) const { send(text.data(), text.size()); }
    /// What arrives next; empty: nothing did, or the line is closed.
    [[nodiscard]] std::string receive() const
    {
        char bytes[65536];
        const ssize_t got = recv(socket_, bytes, sizeof bytes, 0);
        return got > 0 ? std::string(bytes, static_cast<std::size_t>(got)) : "";
    }

    /// @return whether it was answered
    bool ask(std::uint64_t sequence, double advance, double rotation, SelHandAnswer& answer, std::uint32_t flags = 0) const
    {
        const SelHandRequest request{0, sequence, 1e-3 * static_cast<double>(sequence), advance, rotation, flags};
        unsigned char bytes[SEL_HAND_REQUEST_BYTES];
        sel_write_request(&request, bytes);
        send(bytes, sizeof bytes);
        const std::string got = receive();
        return sel_read_answer(reinterpret_cast<const unsigned char*>(got.data()), got.size(), &answer) == 1;
    }

private:
    int socket_;
};

/// A session that has begun, and a hand's channel to it.
struct HandSession {
    explicit HandSession(const Scene& scene, const SessionOptions& options = {})
        : session(scene, make_setup(scene), options, &hand)
    {
        hand.start([this] { return session.clock(); }, options.lockstep);
        session.start();
    }
    HandChannel hand{"127.0.0.1", 0, 1};
    Session session;
};

}  // namespace seldinger::test

// A live session with a device of its own: it pushes for half a second, over UDP as any device does, and feels the wire.

#include <seldinger/core/error.h>
#include <seldinger/session/hand_packet.h>
#include <seldinger/session/live_session.h>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>

using namespace seldinger;

namespace {

/// One request and its answer. @return false: none came in a second
bool ask(int socket, const SelHandRequest& request, SelHandAnswer& answer)
{
    unsigned char bytes[SEL_HAND_ANSWER_BYTES];
    sel_write_request(&request, bytes);
    if (send(socket, bytes, SEL_HAND_REQUEST_BYTES, 0) != SEL_HAND_REQUEST_BYTES) return false;
    const ssize_t size = recv(socket, bytes, sizeof bytes, 0);
    return size > 0 && sel_read_answer(bytes, static_cast<size_t>(size), &answer) == 1;
}

int connected(int port)
{
    const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval second{1, 0};
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &second, sizeof second);
    if (connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) std::perror("connect");
    return socket;
}

}  // namespace

int main()
{
    try {
        LiveOptions options;
        options.lockstep = true;  // a step for each request: the same on any machine
        options.duration = 0.5;
        options.hand_port = 0;
        options.page_port = -1;
        LiveSession session("training/left-subclavian", options);
        session.start();
        const int device = connected(session.hand_port());
        SelHandRequest request{};
        SelHandAnswer answer{};
        for (int k = 1; k <= 500; ++k) {
            request.sequence = static_cast<uint64_t>(k);
            request.time_s = 1e-3 * k;
            request.advance_m = 4e-5 * k;
            if (!ask(device, request, answer)) {
                std::fprintf(stderr, "no answer to request %d\n", k);
                return 1;
            }
        }
        close(device);
        session.finish();
        std::printf("%.1f mm in, %.2f mN against the hand, state %s\n", 1e3 * answer.advance_m, 1e3 * answer.force_n,
                    session.state_hash().c_str());
        return 0;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.kind());
    }
}

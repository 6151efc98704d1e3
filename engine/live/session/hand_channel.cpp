// The UDP socket of the hand channel: one thread that receives, judges and answers.
#include "session/hand_channel.h"

#include "core/clock.h"
#include "core/error.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>
#include <cerrno>
#include <algorithm>
#include <chrono>
#include <cstring>

namespace seldinger {
namespace {

constexpr double largest_force = 20, largest_torque = 0.2;  // sent to a device [N], [N m]

[[noreturn]] void fail_channel(const std::string& address, int port, const char* what)
{
    const int error = errno;
    const char* advice = error == EADDRINUSE ? "another session listens there; choose another with --udp"
                                             : "choose an address of this machine and a port above 1023";
    throw Error(ErrorKind::BadFile, fmt::format("UDP {}:{}: {}: {}; {}", address, port, what, std::strerror(error), advice));
}

sockaddr_in address_of(const std::string& text, int port)
{
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    if (inet_pton(AF_INET, text.c_str(), &address.sin_addr) != 1)
        throw Error(ErrorKind::BadScene, fmt::format("--udp-bind: \"{}\": expected an address such as 127.0.0.1", text));
    return address;
}

std::uint64_t number_of(const sockaddr_in& sender)
{
    return static_cast<std::uint64_t>(sender.sin_addr.s_addr) << 16 | sender.sin_port;
}

}  // namespace

HandChannel::HandChannel(const std::string& address, int port, int instruments) : gate_(instruments)
{
    sockaddr_in own = address_of(address, port);
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (socket_ < 0) fail_channel(address, port, "no socket");
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
        const int error = errno;
        ::close(socket_);
        errno = error;
        fail_channel(address, port, "cannot be opened");
    }
    socklen_t size = sizeof own;
    getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size);
    port_ = ntohs(own.sin_port);
    const timeval wake{0, 100000};  // to see that it is to stop
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wake, sizeof wake);
}

HandChannel::~HandChannel()
{
    stop();
    ::close(socket_);
}

void HandChannel::start(std::function<double()> clock, bool lockstep)
{
    lockstep_ = lockstep;
    unsigned char early;
    while (recv(socket_, &early, 1, MSG_DONTWAIT) >= 0) {}  // sent before there was anyone to take it
    thread_ = std::thread([this, clock = std::move(clock)] { listen(clock); });
}

void HandChannel::stop()
{
    stop_ = true;
    if (thread_.joinable()) thread_.join();
}

void HandChannel::listen(const std::function<double()>& clock)
{
    unsigned char bytes[SEL_HAND_REQUEST_BYTES + 1];  // one more than a request has: what is longer shows
    unsigned char reply[SEL_HAND_ANSWER_BYTES];
    std::uint64_t requests = 0;
    while (!stop_.load(std::memory_order_relaxed)) {
        sockaddr_in sender{};
        socklen_t size = sizeof sender;
        const ssize_t got = recvfrom(socket_, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&sender), &size);
        if (got < 0) continue;
        SelHandRequest request;
        const HandGate::Now now(clock(), seconds_of_the_clock());
        const auto verdict = gate_.take(bytes, static_cast<std::size_t>(got), number_of(sender), now, request);
        auto& counter = counts_[static_cast<std::size_t>(verdict)];
        counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        if (verdict != HandGate::Verdict::Accepted) continue;
        HandInput& hands = input.back();
        for (int k = 0; k < most_instruments; ++k) hands.hand[static_cast<std::size_t>(k)] = gate_.hand(k);
        hands.number = ++requests;
        input.publish();
        wake();
        if (lockstep_) wait_for_step(requests);
        answer(request, reply);
        (void)sendto(socket_, reply, sizeof reply, MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&sender), size);
    }
}

void HandChannel::wait_for_request()
{
    events_.wait(events_seen_, std::memory_order_acquire);
    events_seen_ = events_.load(std::memory_order_acquire);
}

void HandChannel::wake()
{
    events_.fetch_add(1, std::memory_order_release);
    events_.notify_one();
}

void HandChannel::wait_for_step(std::uint64_t request)
{
    for (newest.take(); newest.front().request < request && !stop_.load(std::memory_order_relaxed); newest.take())
        std::this_thread::sleep_for(std::chrono::microseconds(10));
}

void HandChannel::answer(const SelHandRequest& request, unsigned char* bytes)
{
    newest.take();
    const StepNumbers& now = newest.front();
    const InstrumentNumbers& it = now.instrument[request.instrument];
    SelHandAnswer answer{};
    answer.instrument = request.instrument;
    answer.sequence = request.sequence;
    answer.step = now.step;
    answer.time_s = now.time;
    answer.force_n = std::clamp(it.force, -largest_force, largest_force);
    answer.torque_nm = std::clamp(it.torque, -largest_torque, largest_torque);
    answer.force_per_advance_n_m = it.force_per_advance;
    answer.advance_m = it.advance;
    answer.late = static_cast<std::uint32_t>(now.late);
    const bool cut = answer.force_n != it.force || answer.torque_nm != it.torque;
    answer.flags = (now.paused ? SEL_HAND_PAUSED : 0) | (now.stopped ? SEL_HAND_STOPPED : 0) |
                   (now.was_late ? SEL_HAND_LATE : 0) | (now.was_cut_short ? SEL_HAND_SHORT : 0) | (cut ? SEL_HAND_CUT : 0) |
                   (now.score.reached ? SEL_HAND_REACHED : 0);
    sel_write_answer(&answer, bytes);
}

}  // namespace seldinger

#pragma once
// The hand's UDP port and its thread: takes requests through the gate, hands the newest hands to the physics, answers from its
// newest step. No packet makes it wait or allocate.

#include "session/hand_gate.h"
#include "session/snapshot.h"
#include "session/triple_buffer.h"

#include <atomic>
#include <functional>
#include <string>
#include <thread>

namespace seldinger {

/// What the hands want, all instruments together; the newest wins.
struct HandInput {
    std::array<HandState, most_instruments> hand{};
    std::uint64_t number = 0;  // of the request that it ends with, counted from 1
};

class HandChannel {
public:
    /// Opens the port. @param port  0: any that is free  @throws Error BadFile: in use, not allowed
    HandChannel(const std::string& address, int port, int instruments);
    ~HandChannel();
    HandChannel(const HandChannel&) = delete;
    HandChannel& operator=(const HandChannel&) = delete;

    [[nodiscard]] int port() const { return port_; }
    /// Listens from now on. @param clock  the session's [s]  @param lockstep  each answer waits for the step that its request
    /// makes
    void start(std::function<double()> clock, bool lockstep = false);
    void stop();
    /// Waits for a request that `input` does not hold yet, or for wake(). One reader.
    void wait_for_request();
    void wake();

    TripleBuffer<HandInput> input;       // to the physics
    TripleBuffer<StepNumbers> newest;    // from the physics
    /// Datagrams so far, by what became of them.
    [[nodiscard]] std::uint64_t count(HandGate::Verdict verdict) const
    {
        return counts_[static_cast<std::size_t>(verdict)].load(std::memory_order_relaxed);
    }

private:
    void listen(const std::function<double()>& clock);
    void wait_for_step(std::uint64_t request);
    void answer(const SelHandRequest& request, unsigned char* bytes);

    int socket_ = -1, port_ = 0;
    HandGate gate_;
    std::array<std::atomic<std::uint64_t>, HandGate::verdict_count> counts_{};
    std::atomic<bool> stop_{false};
    std::atomic<std::uint32_t> events_{0};  // requests accepted and calls of wake()
    std::uint32_t events_seen_ = 0;
    bool lockstep_ = false;
    std::thread thread_;
};

}  // namespace seldinger

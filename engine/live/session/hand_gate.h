#pragma once
// Accepts the datagrams of a device; all others are counted and ignored. Knows packets and times, no sockets.
//
// A device, told apart by its address, owns an instrument while it is heard. After a silence another device may take over, and so
// may the same one with any sequence number: it was restarted. Sequence numbers of the owner rise, from 2^64 - 1 on to 0 [RFC
// 1982, 3.2]. On average a hand goes no faster than speed_limit. Each instrument has an allowance of travel, filled at that speed
// up to allowance_time's worth; every move is taken off. So late packets in a bunch are as good as prompt ones, and a jump is
// not.

#include "session/hand_packet.h"
#include "session/session_limits.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace seldinger {

/// Where an instrument's hand is, as it was last believed.
struct HandState {
    double advance = 0, turn = 0;  // since the start [m], [rad]
    std::uint32_t flags = 0;
    double arrived = 0;  // on the session's clock [s]
    bool heard = false;  // at all
    std::uint32_t returns = 0;  // times that it came from a silence or was another device's: it may be anywhere then
};

class HandGate {
public:
    static constexpr double speed_limit = 1.0, turn_speed_limit = 100.0;  // [m/s], [rad/s]
    static constexpr double allowance_time = 0.25;                        // [s]
    static constexpr double silence = 0.1;  // without an accepted request, after which an instrument has no owner [s]

    enum class Verdict { Accepted, Malformed, Instrument, NotFinite, NotOwner, Sequence, Jump };
    static constexpr int verdict_count = 7;

    explicit HandGate(int instruments) : instruments_(instruments) {}

    /// When a datagram came [s], both rising. In lockstep session time stands still while requests are refused, so that silence
    /// is measured by the clock.
    struct Now {
        double session, clock;
        Now(double both) : session(both), clock(both) {}  // NOLINT(google-explicit-constructor)
        Now(double session_time, double clock_time) : session(session_time), clock(clock_time) {}
    };

    /// @param sender  any number that tells devices apart
    /// @param out     the request, where it was accepted
    Verdict take(const unsigned char* bytes, std::size_t size, std::uint64_t sender, Now now, SelHandRequest& out);

    [[nodiscard]] const HandState& hand(int instrument) const { return owners_[static_cast<std::size_t>(instrument)].hand; }
    [[nodiscard]] std::uint64_t count(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }

private:
    struct Owner {
        HandState hand;
        std::uint64_t sender = 0, sequence = 0;
        double heard_at = 0;                     // by the clock [s]
        double advance_zero = 0, turn_zero = 0;  // what the device's own zero is here
        double travel = speed_limit * allowance_time, turning = turn_speed_limit * allowance_time;  // allowances left
    };
    [[nodiscard]] Verdict judge(const SelHandRequest& request, std::uint64_t sender, Now now);
    [[nodiscard]] static bool within(Owner& owner, const HandState& to, double now);

    int instruments_;
    std::array<Owner, most_instruments> owners_{};
    std::array<std::uint64_t, verdict_count> counts_{};
};

[[nodiscard]] const char* name_of(HandGate::Verdict verdict);

}  // namespace seldinger

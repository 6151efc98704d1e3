// Checks requests of devices: form, sender, sequence, values, speed.
#include "session/hand_gate.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

const char* name_of(HandGate::Verdict verdict)
{
    static constexpr const char* names[] = {"accepted",  "malformed", "no_such_instrument", "not_finite",
                                            "not_owner", "sequence",  "jump"};
    return names[static_cast<int>(verdict)];
}

HandGate::Verdict HandGate::take(const unsigned char* bytes, std::size_t size, std::uint64_t sender, Now now, SelHandRequest& out)
{
    const Verdict verdict = sel_read_request(bytes, size, &out) ? judge(out, sender, now) : Verdict::Malformed;
    ++counts_[static_cast<std::size_t>(verdict)];
    return verdict;
}

HandGate::Verdict HandGate::judge(const SelHandRequest& request, std::uint64_t sender, Now now)
{
    if (request.instrument >= instruments_) return Verdict::Instrument;
    if (!std::isfinite(request.time_s) || !std::isfinite(request.advance_m) || !std::isfinite(request.rotation_rad))
        return Verdict::NotFinite;
    Owner& owner = owners_[request.instrument];
    const bool owned = owner.hand.heard && now.clock - owner.heard_at < silence;
    const bool rises = static_cast<std::int64_t>(request.sequence - owner.sequence) > 0;  // also past 2^64 - 1
    if (owned && owner.sender != sender) return Verdict::NotOwner;
    if (owned && !rises) return Verdict::Sequence;
    const bool same = owner.hand.heard && owner.sender == sender && rises;  // else another device, or this one restarted
    Owner next = owner;
    if (!same) next.advance_zero = next.turn_zero = 0;
    if (request.flags & SEL_HAND_REBASE) {
        next.advance_zero = owner.hand.advance - request.advance_m;
        next.turn_zero = owner.hand.turn - request.rotation_rad;
    }
    const bool returns = !same || (!owned && now.session - owner.hand.arrived >= silence);
    const HandState to{
        request.advance_m + next.advance_zero, request.rotation_rad + next.turn_zero, request.flags, now.session, true,
        owner.hand.returns + (returns ? 1 : 0)};
    if (!within(next, to, now.session)) return Verdict::Jump;
    next.hand = to;
    next.sender = sender;
    next.sequence = request.sequence;
    next.heard_at = now.clock;
    owner = next;
    return Verdict::Accepted;
}

/// Takes a move off the allowances, unless it is more than they are.
bool HandGate::within(Owner& owner, const HandState& to, double now)
{
    const double passed = owner.hand.heard ? now - owner.hand.arrived : allowance_time;
    const auto filled = [&](double left, double speed) { return std::min(left + speed * passed, speed * allowance_time); };
    owner.travel = filled(owner.travel, speed_limit) - std::abs(to.advance - owner.hand.advance);
    owner.turning = filled(owner.turning, turn_speed_limit) - std::abs(to.turn - owner.hand.turn);
    return owner.travel >= 0 && owner.turning >= 0;
}

}  // namespace seldinger

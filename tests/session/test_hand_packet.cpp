// The packets of the hand channel byte by byte, as section 15 of the contract has them, and what the gate lets through.

#include "session/hand_gate.h"
#include "support/approx.h"

#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace seldinger::test::test_hand_packet {

namespace {

using Bytes = std::array<unsigned char, SEL_HAND_REQUEST_BYTES>;

SelHandRequest request(std::uint64_t sequence, double advance, double rotation = 0)
{
    return {0, sequence, 0.001 * static_cast<double>(sequence), advance, rotation, 0};
}

Bytes bytes_of(const SelHandRequest& r)
{
    Bytes bytes;
    sel_write_request(&r, bytes.data());
    return bytes;
}

HandGate::Verdict give(HandGate& gate, const SelHandRequest& r, double now, std::uint64_t sender = 7)
{
    const Bytes bytes = bytes_of(r);
    SelHandRequest out;
    return gate.take(bytes.data(), bytes.size(), sender, now, out);
}

}  // namespace

TEST_SUITE("session/hand_packet")
{
    TEST_CASE("property: a request has the contract's bytes")
    {
        const SelHandRequest r{3, 0x0102030405060708ull, 1.0, -2.0, 0.5, SEL_HAND_CONTRAST};
        const Bytes bytes = bytes_of(r);
        const unsigned char expected[] = {'S', 'E', 'L', 'H', 1,    0,    3,    0,    8, 7, 6, 5, 4,    3,    2,    1,
                                          0,   0,   0,   0,   0,    0,    0xF0, 0x3F, 0, 0, 0, 0, 0,    0,    0,    0xC0,
                                          0,   0,   0,   0,   0,    0,    0xE0, 0x3F, 2, 0, 0, 0, 0,    0,    0,    0};
        REQUIRE(sizeof expected == bytes.size());
        CHECK(std::memcmp(expected, bytes.data(), sizeof expected) == 0);
        SelHandRequest back;
        REQUIRE(sel_read_request(bytes.data(), bytes.size(), &back) == 1);
        CHECK(back.instrument == r.instrument);
        CHECK(back.sequence == r.sequence);
        CHECK(back.advance_m == r.advance_m);
        CHECK(back.flags == r.flags);
    }

    TEST_CASE("property: an answer reads back as it was written, and stands where the contract says")
    {
        const SelHandAnswer a{1, 11, 12, 0.013, 1.4, -0.15, 160, 0.17, 18, SEL_HAND_LATE};
        unsigned char bytes[SEL_HAND_ANSWER_BYTES];
        sel_write_answer(&a, bytes);
        CHECK(std::memcmp(bytes, "SELF\1\0\1\0\13\0\0\0\0\0\0\0\14", 17) == 0);
        double force;
        std::memcpy(&force, bytes + 32, 8);
        CHECK(force == 1.4);
        SelHandAnswer back;
        REQUIRE(sel_read_answer(bytes, sizeof bytes, &back) == 1);
        CHECK(back.sequence == 11);
        CHECK(back.step == 12);
        CHECK(back.torque_nm == -0.15);
        CHECK(back.force_per_advance_n_m == 160);
        CHECK(back.advance_m == 0.17);
        CHECK(back.late == 18);
        CHECK(back.flags == SEL_HAND_LATE);
        CHECK(sel_read_answer(bytes, sizeof bytes - 1, &back) == 0);
    }

    TEST_CASE("property: the header is plain C")
    {
        const std::string header = std::string(SEL_SOURCE_DIR) + "/engine/include/seldinger/session/hand_packet.h";
        CHECK(std::system(("cc -std=c99 -Wall -Wextra -Werror -x c -fsyntax-only " + header).c_str()) == 0);
    }

    TEST_CASE("property: what is no request, or not a hand's, is counted and ignored")
    {
        using enum HandGate::Verdict;
        HandGate gate(1);
        REQUIRE(give(gate, request(10, 0.01), 0.0) == Accepted);
        SelHandRequest out;
        Bytes bytes = bytes_of(request(11, 0.01));
        CHECK(gate.take(bytes.data(), 47, 7, 0.05, out) == Malformed);
        CHECK(gate.take(bytes.data(), 49, 7, 0.05, out) == Malformed);
        for (const int place : {0, 4, 44}) {  // magic, version, the zero at the end
            Bytes wrong = bytes;
            wrong[static_cast<std::size_t>(place)] ^= 1;
            CHECK(gate.take(wrong.data(), wrong.size(), 7, 0.05, out) == Malformed);
        }
        CHECK(give(gate, request(10, 0.01), 0.05) == Sequence);
        CHECK(give(gate, request(9, 0.01), 0.05) == Sequence);
        SelHandRequest other = request(11, 0.01);
        other.instrument = 1;
        CHECK(give(gate, other, 0.05) == Instrument);
        for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
            CHECK(give(gate, request(11, bad), 0.05) == NotFinite);
            CHECK(give(gate, request(11, 0.01, bad), 0.05) == NotFinite);
        }
        CHECK(gate.hand(0).advance == 0.01);
        CHECK(gate.count(Malformed) == 5);
        CHECK(gate.count(NotFinite) == 4);
        CHECK(give(gate, request(11, 0.011), 0.05) == Accepted);
    }

    TEST_CASE("property: a hand at the speed limit passes however its packets bunch, a faster one does not")
    {
        using enum HandGate::Verdict;
        const double limit = HandGate::speed_limit;
        HandGate bunched(1);
        std::uint64_t sequence = 0;
        for (int bunch = 1; bunch <= 20; ++bunch)  // ten packets at a time, all of a tenth of a second
            for (int k = 1; k <= 10; ++k)
                REQUIRE(give(bunched, request(++sequence, 0.99 * limit * (0.1 * (bunch - 1) + 0.01 * k)), 0.1 * bunch) ==
                        Accepted);
        HandGate fast(1);
        int refused = 0;
        for (int k = 1; k <= 1000; ++k) refused += give(fast, request(k, 1.5 * limit * 0.001 * k), 0.001 * k) == Jump;
        // the allowance lasts for 0.25/(1.5 - 1) = 0.5 s; from then on each packet is farther ahead than the one before
        CHECK(refused >= 450);
        HandGate jump(1);
        REQUIRE(give(jump, request(1, 0.0), 1.0) == Accepted);
        CHECK(give(jump, request(2, 1.0), 100.0) == Jump);  // however long it has been silent
        CHECK(give(jump, request(3, 0.0, 1000.0), 100.0) == Jump);
        CHECK(give(jump, request(4, 0.1), 100.0) == Accepted);
    }

    TEST_CASE("property: a device keeps its instrument until it falls silent, and one that begins anew may say so")
    {
        using enum HandGate::Verdict;
        HandGate gate(1);
        REQUIRE(give(gate, request(1000, 0.2), 1.0, 1) == Accepted);
        CHECK(give(gate, request(1, 0.2), 1.05, 2) == NotOwner);
        CHECK(give(gate, request(1, 0.2), 1.2, 2) == Accepted);
        SelHandRequest rebased = request(1, 0.0);
        rebased.flags = SEL_HAND_REBASE;
        REQUIRE(give(gate, rebased, 2.0, 3) == Accepted);
        CHECK(gate.hand(0).advance == 0.2);
        REQUIRE(give(gate, request(2, 0.01), 2.1, 3) == Accepted);
        CHECK(gate.hand(0).advance == test::about(0.21).epsilon(1e-12));
    }

    TEST_CASE("regression: a device that was restarted on its own port is heard after a silence, and not before")
    {
        using enum HandGate::Verdict;
        HandGate gate(1);
        REQUIRE(give(gate, request(100'000, 0.2), 1.0) == Accepted);
        CHECK(give(gate, request(1, 0.2), 1.05) == Sequence);  // a packet that was overtaken
        CHECK(give(gate, request(2, 0.2), 1.0 + HandGate::silence + 1e-6) == Accepted);
        CHECK(give(gate, request(2, 0.2), 1.15) == Sequence);  // its numbers rise from there
        CHECK(give(gate, request(3, 0.201), 1.15) == Accepted);
        CHECK(gate.hand(0).advance == 0.201);
        // it starts at zero again, and says so; once it is restarted its values are its own
        SelHandRequest rebased = request(1, 0.0);
        rebased.flags = SEL_HAND_REBASE;
        REQUIRE(give(gate, rebased, 2.0) == Accepted);
        CHECK(gate.hand(0).advance == 0.201);
        CHECK(give(gate, request(1, 0.3), 3.0) == Accepted);
        CHECK(gate.hand(0).advance == 0.3);
        // requests that are refused are no sign of life of the owner's: their sender may not keep it out for ever
        for (int k = 1; k <= 99; ++k) CHECK(give(gate, request(1, 0.3), 3.0 + 0.001 * k) == Sequence);
        CHECK(give(gate, request(1, 0.3), 3.0 + HandGate::silence + 1e-6) == Accepted);
    }

    TEST_CASE("property: a hand that comes from a silence, or is another one, is counted as returned")
    {
        using enum HandGate::Verdict;
        HandGate gate(1);
        REQUIRE(give(gate, request(1, 0.001), 1.0) == Accepted);
        CHECK(gate.hand(0).returns == 1);  // the first one may be anywhere, too
        REQUIRE(give(gate, request(2, 0.002), 1.05) == Accepted);
        CHECK(gate.hand(0).returns == 1);
        REQUIRE(give(gate, request(3, 0.02), 1.45) == Accepted);  // away for 0.4 s
        CHECK(gate.hand(0).returns == 2);
        REQUIRE(give(gate, request(1, 0.03), 1.6, 3) == Accepted);
        CHECK(gate.hand(0).returns == 3);
        // in lockstep a slow device is not away: no session time has passed
        const auto give_at = [&](std::uint64_t sequence, HandGate::Now now) {
            const Bytes bytes = bytes_of(request(sequence, 0.03));
            SelHandRequest out;
            return gate.take(bytes.data(), bytes.size(), 3, now, out);
        };
        REQUIRE(give_at(2, {1.601, 30.0}) == Accepted);
        CHECK(gate.hand(0).returns == 3);
    }

    TEST_CASE("regression: sequence numbers go on from 2^64 - 1 to 0")
    {
        using enum HandGate::Verdict;
        const std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
        HandGate gate(1);
        REQUIRE(give(gate, {0, last - 1, 0, 0.01, 0, 0}, 1.000) == Accepted);
        CHECK(give(gate, {0, last, 0, 0.011, 0, 0}, 1.001) == Accepted);
        CHECK(give(gate, {0, 0, 0, 0.012, 0, 0}, 1.002) == Accepted);
        CHECK(give(gate, {0, last, 0, 0.012, 0, 0}, 1.003) == Sequence);
        CHECK(give(gate, {0, 1, 0, 0.013, 0, 0}, 1.004) == Accepted);
        CHECK(gate.hand(0).advance == 0.013);
    }

    TEST_CASE("regression: in lockstep, where refused requests make no step, silence ends by the clock")
    {
        using enum HandGate::Verdict;
        HandGate gate(1);
        const auto give_at = [&](std::uint64_t sequence, HandGate::Now now, std::uint64_t sender) {
            const Bytes bytes = bytes_of(request(sequence, 0.0));
            SelHandRequest out;
            return gate.take(bytes.data(), bytes.size(), sender, now, out);
        };
        REQUIRE(give_at(50, {1.0, 10.0}, 1) == Accepted);
        CHECK(give_at(1, {1.0, 10.05}, 1) == Sequence);
        CHECK(give_at(1, {1.0, 10.05}, 2) == NotOwner);
        CHECK(give_at(1, {1.0, 10.2}, 1) == Accepted);
        CHECK(give_at(1, {1.0, 10.4}, 2) == Accepted);
    }

    TEST_CASE("property: a million random datagrams move nothing")
    {
        HandGate gate(8);
        std::mt19937_64 draw(1);
        std::vector<unsigned char> bytes(64);
        SelHandRequest out;
        const std::uint64_t n = 1'000'000;
        for (std::uint64_t k = 0; k < n; ++k) {
            for (std::size_t at = 0; at < bytes.size(); at += 8) {
                const std::uint64_t word = draw();
                std::memcpy(bytes.data() + at, &word, 8);
            }
            // every fourth has the form of a request, with anything in it
            if (k % 4 == 0) std::memcpy(bytes.data(), "SELH\1\0\0\0", 8), std::memset(bytes.data() + 44, 0, 4);
            (void)gate.take(bytes.data(), k % 4 == 0 ? 48 : draw() % 65, draw() % 3, 1e-5 * static_cast<double>(k), out);
        }
        std::uint64_t counted = 0;
        for (int v = 0; v < HandGate::verdict_count; ++v) counted += gate.count(static_cast<HandGate::Verdict>(v));
        CHECK(counted == n);
        // doubles of random bits are tiny as often as huge: what passes is within the allowance
        CHECK(std::abs(gate.hand(0).advance) <= HandGate::speed_limit * (10 + HandGate::allowance_time));
    }
}

}  // namespace seldinger::test::test_hand_packet

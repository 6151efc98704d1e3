// One walk, four uses: rows that are saved, hashed, taken back with a check, taken back without.
#include "core/state_walk.h"

#include <doctest/doctest.h>

#include <cmath>

namespace seldinger::test::test_state_walk {

namespace {

struct Owner {
    double force[3] = {1, -2, 3};
    std::uint8_t held = 1;
    std::vector<double> list = {4, 5};
    std::array<double, 4> nodes = {6, 7, NAN, 9};  // the last two are not used
    double speed = 8;                              // of attempts

    void walk(StateWalk& walk)
    {
        walk({"a force", "N", "accept"}, std::span(force));
        walk({"a flag", "", "accept", 0, 1}, held);
        walk.list<std::int32_t>({"a list", "m", "accept", -10, 10}, list, 3);
        walk({"a node", "m", "solve", -10, 10}, std::span(nodes), 2);
        if (walk.of_attempt()) walk({"a speed", "m/s", "feed_hubs"}, speed);
    }
    [[nodiscard]] std::vector<std::uint8_t> bytes(StateWalk::Of of = StateWalk::Of::State)
    {
        std::vector<std::uint8_t> to;
        StateWalk out(to, of);
        walk(out);
        return to;
    }
};

}  // namespace

TEST_SUITE("core/state walk")
{
    TEST_CASE("property: what is saved comes back, a hash is that of the saved bytes, and an attempt has its own rows too")
    {
        Owner one, other{{0, 0, 0}, 0, {}, {}, 0};
        const std::vector<std::uint8_t> saved = one.bytes(), kept = one.bytes(StateWalk::Of::Attempt);
        CHECK(saved.size() == 3 * 8 + 1 + 4 + 2 * 8 + 4 * 8);
        CHECK(kept.size() == saved.size() + 8);
        std::uint64_t hash = fnv1a_start;
        StateWalk hashing(hash);
        one.walk(hashing);
        CHECK(hash == fnv1a(saved.data(), saved.size()));

        StateWalk in(saved, false);
        other.walk(in);
        CHECK(in.left() == 0);
        CHECK(other.bytes() == saved);
        CHECK(other.speed == 0);
        StateWalk back(kept, true, StateWalk::Of::Attempt);
        other.walk(back);
        CHECK(other.speed == 8);
    }

    TEST_CASE("bad input: a number out of its row's bounds is named, unless this world wrote it a moment ago")
    {
        const auto refuses = [](const Owner& wrong, const char* name) {
            const std::vector<std::uint8_t> bytes = Owner(wrong).bytes();
            Owner into;
            StateWalk checked(bytes, false);
            CHECK_THROWS_WITH_AS(into.walk(checked), doctest::Contains(name), Error);
            StateWalk trusted(bytes, true);
            CHECK_NOTHROW(into.walk(trusted));
        };
        Owner wrong;
        wrong.force[1] = NAN;
        refuses(wrong, "a force");
        wrong = {};
        wrong.held = 2;
        refuses(wrong, "a flag");
        wrong = {};
        wrong.list[1] = -11;
        refuses(wrong, "a list");
        wrong = {};
        wrong.nodes[1] = INFINITY;
        refuses(wrong, "a node");
    }

    TEST_CASE("bad input: bytes that end early, and a list longer than it may be or than the bytes are")
    {
        Owner one;
        std::vector<std::uint8_t> bytes = one.bytes();
        bytes.pop_back();
        StateWalk early(bytes, false);
        CHECK_THROWS_WITH_AS(one.walk(early), doctest::Contains("shorter"), Error);
        one.list = {1, 2, 3, 4};
        bytes = one.bytes();
        StateWalk longer(bytes, false);
        CHECK_THROWS_WITH_AS(one.walk(longer), doctest::Contains("a list"), Error);
        for (const std::int32_t count : {-1, 1 << 30}) {
            one.list = {};
            bytes = one.bytes();
            std::memcpy(bytes.data() + 25, &count, sizeof count);
            StateWalk wrong(bytes, true);
            CHECK_THROWS_WITH_AS(one.walk(wrong), doctest::Contains("a list"), Error);
        }
    }
}

}  // namespace seldinger::test::test_state_walk

// SHA-256 against its standard's examples, at every length around a block's end.
#include "core/sha256.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string>

namespace seldinger::test::test_sha256 {

namespace {

std::string hex(std::string_view text)
{
    std::string digits;
    for (const std::uint8_t byte : sha256(text)) digits += fmt::format("{:02x}", byte);
    return digits;
}

}  // namespace

TEST_SUITE("core/sha256")
{
    TEST_CASE("analytic: the examples of the standard [FIPS 180-4; NIST, Cryptographic Standards and Guidelines, SHA256.pdf]")
    {
        CHECK(hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        CHECK(hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
        CHECK(hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
        CHECK(hex(std::string(1'000'000, 'a')) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    }

    // where the bit and the length behind a text still fit into its last block, and where they do not
    TEST_CASE("analytic: lengths around a block's end, by coreutils' sha256sum")
    {
        CHECK(hex(std::string(55, 'x')) == "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072");
        CHECK(hex(std::string(56, 'x')) == "04c26261370ee7541549d16dee320c723e3fd14671e66a099afe0a377c16888e");
        CHECK(hex(std::string(63, 'x')) == "75220b47218278e656f2013bb8f0c455a25eaf01e86c64924e9d48d89776d6f2");
        CHECK(hex(std::string(64, 'x')) == "7ce100971f64e7001e8fe5a51973ecdfe1ced42befe7ee8d5fd6219506b5393c");
        CHECK(hex(std::string(65, 'x')) == "9537c5fdf120482f7d58d25e9ed583f52c02b4e304ea814db1633ad565aed7e9");
    }
}

}  // namespace seldinger::test::test_sha256

// SHA-256 in the letters of its standard [FIPS 180-4], for texts in memory. For texts that lie in memory.
#include "core/sha256.h"

#include <bit>
#include <string>

namespace seldinger {
namespace {

// the first 32 bits of the fractional parts of the cube roots of the first 64 primes [4.2.2]
constexpr std::array<std::uint32_t, 64> K = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5, 0xd807aa98, 0x12835b01,
    0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc,
    0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147,
    0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116, 0x1e376c08,
    0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3, 0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208,
    0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

using Hash = std::array<std::uint32_t, 8>;

std::uint32_t rotr(std::uint32_t x, int n) { return std::rotr(x, n); }

/// One block of 64 bytes [6.2.2].
void add_block(Hash& H, const char* block)
{
    std::array<std::uint32_t, 64> W{};
    for (std::size_t t = 0; t < 16; ++t)
        for (std::size_t k = 0; k < 4; ++k) W[t] = W[t] << 8 | static_cast<unsigned char>(block[4 * t + k]);
    for (std::size_t t = 16; t < 64; ++t) {
        const std::uint32_t s0 = rotr(W[t - 15], 7) ^ rotr(W[t - 15], 18) ^ W[t - 15] >> 3;
        const std::uint32_t s1 = rotr(W[t - 2], 17) ^ rotr(W[t - 2], 19) ^ W[t - 2] >> 10;
        W[t] = s1 + W[t - 7] + s0 + W[t - 16];
    }
    auto [a, b, c, d, e, f, g, h] = H;
    for (std::size_t t = 0; t < 64; ++t) {
        const std::uint32_t S1 = rotr(e, 6) ^ rotr(e, 11) ^ rotr(e, 25), ch = (e & f) ^ (~e & g);
        const std::uint32_t T1 = h + S1 + ch + K[t] + W[t];
        const std::uint32_t S0 = rotr(a, 2) ^ rotr(a, 13) ^ rotr(a, 22), maj = (a & b) ^ (a & c) ^ (b & c);
        h = g, g = f, f = e, e = d + T1, d = c, c = b, b = a, a = T1 + S0 + maj;
    }
    const Hash made = {a, b, c, d, e, f, g, h};
    for (std::size_t k = 0; k < 8; ++k) H[k] += made[k];
}

}  // namespace

std::array<std::uint8_t, 32> sha256(std::string_view text)
{
    Hash H = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    const std::size_t whole = text.size() / 64 * 64;
    for (std::size_t at = 0; at < whole; at += 64) add_block(H, text.data() + at);
    // the remaining bytes, a bit, zeros, and the length in bits [5.1.1]
    std::string end(text.substr(whole));
    end += static_cast<char>(0x80);
    end.resize((end.size() + 8 + 63) / 64 * 64 - 8, '\0');
    for (int shift = 56; shift >= 0; shift -= 8) end += static_cast<char>(std::uint64_t{text.size()} * 8 >> shift & 255);
    for (std::size_t at = 0; at < end.size(); at += 64) add_block(H, end.data() + at);
    std::array<std::uint8_t, 32> out{};
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<std::uint8_t>(H[k / 4] >> (24 - 8 * (k % 4)) & 255);
    return out;
}

}  // namespace seldinger

#pragma once
// Elementary functions of single precision made of arithmetic alone: loops of them become vector code, which loops of std::exp do
// not, and give the same bits for any width of vector.

#include <algorithm>
#include <bit>
#include <cstdint>

namespace seldinger {

/// exp(-x), x >= -19.4: 2^n times a polynomial, relative error at most 3e-7 + 1e-7 |x|. Beyond x = 87: 2^-126.
inline float exp_minus(float x)
{
    const float y = std::max(-126.0f, std::min(28.0f, x * -1.44269504f));
    const float n = static_cast<float>(static_cast<int>(y + 1024.5f) - 1024), f = y - n;  // |f| <= 1/2
    const float p =
        1.0f + f * (0.693147182f +
                    f * (0.240226463f + f * (0.0555032530f + f * (0.00961817370f + f * (0.00133983510f + f * 0.000154353160f)))));
    return p * std::bit_cast<float>((static_cast<std::int32_t>(n) + 127) << 23);
}

/// ln x of a normal x > 0, error at most 2e-7 of max(1, |ln x|): polynomial of Moshier's Cephes.
inline float log_of(float x)
{
    constexpr std::int32_t root_half = 0x3f3504f3;  // x = 2^n m, m from sqrt(1/2) to sqrt(2)
    const auto bits = std::bit_cast<std::int32_t>(x);
    const std::int32_t n = (bits - root_half) >> 23;
    const float f = std::bit_cast<float>(bits - (n << 23)) - 1.0f, square = f * f;
    const float p =
        3.3333331174e-1f +
        f * (-2.4999993993e-1f +
             f * (2.0000714765e-1f +
                  f * (-1.6668057665e-1f +
                       f * (1.4249322787e-1f +
                            f * (-1.2420140846e-1f + f * (1.1676998740e-1f + f * (-1.1514610310e-1f + f * 7.0376836292e-2f)))))));
    return static_cast<float>(n) * 0.693147181f + (f + square * (f * p - 0.5f));
}

/// Sine and cosine of 2 pi t, |t| <= 1/2, error at most 1e-6: series of pi t, doubled.
inline void sine_cosine_turns(float t, float& sine, float& cosine)
{
    const float x = 3.14159265f * t, q = x * x;
    const float s =
        x *
        (1.0f + q * (-1.66666667e-1f + q * (8.33333333e-3f + q * (-1.98412698e-4f + q * (2.75573192e-6f - q * 2.50521084e-8f)))));
    const float c =
        1.0f + q * (-0.5f + q * (4.16666667e-2f +
                                 q * (-1.38888889e-3f + q * (2.48015873e-5f + q * (-2.75573192e-7f + q * 2.08767570e-9f)))));
    sine = 2.0f * s * c;
    cosine = 1.0f - 2.0f * s * s;
}

}  // namespace seldinger

#pragma once
// Several numbers side by side, for loops over the nodes of a wire: the vectors of GCC and clang, which become whatever the
// processor has (AVX-512, AVX, SSE2). Every lane does the operations of a scalar, in the same order, so that results do not
// depend on the number of lanes. For source files of the library only: the width is that of the file that includes this.

#include <cmath>
#include <cstring>

#if defined(__AVX512F__)
    #include <immintrin.h>
#endif

namespace seldinger {

#if defined(__AVX512F__)
inline constexpr int lane_count = 8;
#elif defined(__AVX__)
inline constexpr int lane_count = 4;
#else
inline constexpr int lane_count = 2;
#endif

typedef double Lanes __attribute__((vector_size(lane_count * sizeof(double)), may_alias));
typedef long LaneMask __attribute__((vector_size(lane_count * sizeof(double)), may_alias));

inline Lanes all_lanes(double value) { return value - Lanes{}; }

inline Lanes load_lanes(const double* p)
{
    Lanes v;
    std::memcpy(&v, p, sizeof v);
    return v;
}

inline void store_lanes(double* p, const Lanes& v) { std::memcpy(p, &v, sizeof v); }

/// The first `count` of them, `other` in the rest: for arrays that end there.
inline Lanes load_lanes(const double* p, int count, double other)
{
    if (count >= lane_count) return load_lanes(p);
#if defined(__AVX512F__)
    return _mm512_mask_loadu_pd(all_lanes(other), static_cast<__mmask8>((1u << (count > 0 ? count : 0)) - 1), p);
#else
    Lanes v = all_lanes(other);
    for (int l = 0; l < count; ++l) v[l] = p[l];
    return v;
#endif
}

#if defined(__AVX512F__)
inline constexpr LaneMask lane_index = {0, 1, 2, 3, 4, 5, 6, 7};
#elif defined(__AVX__)
inline constexpr LaneMask lane_index = {0, 1, 2, 3};
#else
inline constexpr LaneMask lane_index = {0, 1};
#endif

/// All ones in the first `count` lanes.
inline LaneMask first_lanes(int count) { return lane_index < count; }

/// Whether the first `count` lanes are all set.
inline bool all_set(const LaneMask& mask, int count)
{
    const LaneMask fine = mask | (lane_index >= count);
    long all = -1;
    for (int l = 0; l < lane_count; ++l) all &= fine[l];
    return all != 0;
}

/// The last lane of `before`, then all but the last of `now`.
inline Lanes shifted(const Lanes& before, const Lanes& now)
{
#if defined(__AVX512F__)
    return __builtin_shufflevector(before, now, 7, 8, 9, 10, 11, 12, 13, 14);
#elif defined(__AVX__)
    return __builtin_shufflevector(before, now, 3, 4, 5, 6);
#else
    return __builtin_shufflevector(before, now, 1, 2);
#endif
}

inline Lanes sqrt_lanes(const Lanes& v)
{
#if defined(__AVX512F__)
    return _mm512_sqrt_pd(v);
#else
    Lanes root{};
    for (int l = 0; l < lane_count; ++l) root[l] = std::sqrt(v[l]);
    return root;
#endif
}

/// A vector in space per lane.
struct Lanes3 {
    Lanes v[3];
    Lanes& operator[](int c) { return v[c]; }
    const Lanes& operator[](int c) const { return v[c]; }
};

/// From and to something with an array per component.
template <class Array>
Lanes3 load_lanes3(const Array& array, int i)
{
    return {{load_lanes(array.component(0) + i), load_lanes(array.component(1) + i), load_lanes(array.component(2) + i)}};
}

template <class Array>
void store_lanes3(Array& array, int i, const Lanes3& v)
{
    for (int c = 0; c < 3; ++c) store_lanes(array.component(c) + i, v[c]);
}

inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}}; }
inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}}; }
inline Lanes3 operator*(const Lanes& s, const Lanes3& a) { return {{s * a[0], s * a[1], s * a[2]}}; }
inline Lanes3 operator/(const Lanes3& a, const Lanes& s) { return {{a[0] / s, a[1] / s, a[2] / s}}; }
inline Lanes dot(const Lanes3& a, const Lanes3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Lanes3 cross(const Lanes3& a, const Lanes3& b)
{
    return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

}  // namespace seldinger

#pragma once
// A node's four unknowns as one SIMD vector. All loads and stores are whole aligned blocks, so a store is always forwarded whole
// to the next step's load. A column-by-column factorisation shifts its window by one entry each time, which defeats store
// forwarding. For source files of the library only.

#include <algorithm>
#include <cstring>

namespace seldinger {

typedef double Vec4d __attribute__((vector_size(32), may_alias));

inline Vec4d& block(double* p) { return *reinterpret_cast<Vec4d*>(p); }
inline const Vec4d& block(const double* p) { return *reinterpret_cast<const Vec4d*>(p); }

/// From anywhere. (Not returned: without AVX there is no register for it, and g++ warns.)
inline void read_block(const double* p, Vec4d& to) { std::memcpy(&to, p, sizeof to); }

// how a vector is returned depends on the processor that a file is compiled for
inline __attribute__((always_inline)) Vec4d magnitude(const Vec4d& v) { return v < 0 ? -v : v; }

inline double largest(const Vec4d& v) { return std::max(std::max(v[0], v[2]), std::max(v[1], v[3])); }

inline double sum(const Vec4d& v) { return (v[0] + v[2]) + (v[1] + v[3]); }

/// Rows become columns.
inline void transpose(Vec4d (&m)[4])
{
    const Vec4d a = __builtin_shufflevector(m[0], m[1], 0, 4, 2, 6), b = __builtin_shufflevector(m[0], m[1], 1, 5, 3, 7);
    const Vec4d c = __builtin_shufflevector(m[2], m[3], 0, 4, 2, 6), d = __builtin_shufflevector(m[2], m[3], 1, 5, 3, 7);
    m[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    m[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    m[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    m[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

}  // namespace seldinger

#pragma once
// Numbers as files hold them.

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace seldinger::test {

template <class T>
std::string as_bytes(const std::vector<T>& values, bool big_endian = false)
{
    std::string bytes;
    for (const T& value : values) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        if (big_endian) std::reverse(raw, raw + sizeof(T));
        bytes.append(raw, sizeof(T));
    }
    return bytes;
}

}  // namespace seldinger::test

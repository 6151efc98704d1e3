#pragma once
// A force with its band, for people.

#include <string>

namespace seldinger {

/// "0.103 ± 0.013 N", "3.4 mN": as many digits as the band leaves. @param band  NaN: not known
[[nodiscard]] std::string newtons(double value, double band);

}  // namespace seldinger

// Sections of a wire, looked up by material coordinate.
#include "rod/wire_spec.h"

#include <algorithm>

namespace seldinger {

const WireSection& WireSpec::at(double s) const
{
    s = std::clamp(s, 0.0, length);
    for (auto range = sections.rbegin(); range != sections.rend(); ++range) {
        // half open, so that neighbours do not compete for their common point; but the hub belongs to the last stretch
        const bool inside = s >= range->begin && (s < range->end || (s == length && range->end >= length));
        if (inside) return range->section;
    }
    return shaft;
}

double WireSpec::least_radius() const
{
    double radius = shaft.radius;
    for (const WireSectionRange& range : sections) radius = std::min(radius, range.section.radius);
    return radius;
}

double WireSpec::largest_radius() const
{
    double radius = shaft.radius;
    for (const WireSectionRange& range : sections) radius = std::max(radius, range.section.radius);
    return radius;
}

}  // namespace seldinger

// Compares ends by width, height and the vessel behind them.
#include "setup/access.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double aortic_radius = 6e-3;  // an abdominal aorta has 7 to 10 mm, a common iliac artery 4 to 6 [m]
constexpr double sheath_radius = 1.5e-3;  // the least lumen that takes a sheath of 6 F and its wire [m]
constexpr double alike = 0.15;            // of a width or of the vessel's height: ends that differ by less are alike

struct End {
    double length = 0;     // of the longest way from here [m]
    double width = 0;      // mean lumen radius of the first six radii [m]
    double narrowest = 0;  // from one to four widths in [m]
    double height = 0, depth = 0;  // towards the head, towards the back [m]
    std::string out;               // why it is no candidate
};

End measure(const Inlet& inlet, const Centreline& line, const Vec3& head, const Vec3& back)
{
    const WayThrough way = way_through(line, inlet);
    End end;
    end.length = way.length;
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < way.at.size(); ++i)
        if (way.at[i] <= 6 * inlet.radius) sum += way.radius[i], ++count;
    end.width = count > 0 ? sum / count : inlet.radius;
    end.narrowest = end.width;
    double widest = 0;
    for (std::size_t i = 0; i < way.at.size(); ++i) {
        if (way.at[i] <= inlet.radius) widest = std::max(widest, way.radius[i]);
        if (way.at[i] > inlet.radius && way.at[i] <= 4 * inlet.radius) end.narrowest = std::min(end.narrowest, way.radius[i]);
    }
    end.width = std::max(end.width, 0.0);
    if (inlet.opening < 0 && end.narrowest < 0.5 * std::max(widest, inlet.radius))
        end.out = "a pocket: the lumen narrows behind it";
    end.height = inlet.point.dot(head), end.depth = inlet.point.dot(back);
    return end;
}

bool is_aorta(const Centreline& line)
{
    double length = 0, wide = 0;
    for (std::size_t i = 0; i < line.points.size(); ++i) {
        if (line.parent[i] < 0) continue;
        const double step = (line.points[i] - line.points[static_cast<std::size_t>(line.parent[i])]).norm();
        length += step;
        if (line.radius[i] >= aortic_radius) wide += step;
    }
    return wide >= 0.1 * length && wide >= 0.03;
}

std::string mm(double metres) { return fmt::format("{:.3g} mm", 1e3 * metres); }

}  // namespace

Access choose_access(const std::vector<Inlet>& inlets, const std::vector<int>& part, const Centreline& line, const Vec3& head,
                     const Vec3& back)
{
    Access access;
    access.reason.resize(inlets.size());
    if (inlets.empty()) return access;
    const bool aorta = is_aorta(line);
    Box3 box;
    for (const Vec3& p : line.points) box.extend(p);
    std::vector<End> ends;
    double longest = 0, low = 1e300, high = -1e300;
    for (std::size_t k = 0; k < inlets.size(); ++k) {
        ends.push_back(measure(inlets[k], line, head, back));
        if (part[k] == 0) longest = std::max(longest, ends[k].length);
    }
    for (const Vec3& p : line.points) low = std::min(low, p.dot(head)), high = std::max(high, p.dot(head));
    const double height = std::max(high - low, 1e-9);
    const bool upright = height >= 0.5 * box.diagonal().norm();
    std::vector<std::size_t> candidates;
    for (std::size_t k = 0; k < ends.size(); ++k) {
        if (part[k] != 0) ends[k].out = "it leads into a smaller part of the surface";
        else if (ends[k].out.empty() && ends[k].length < 0.4 * longest)
            ends[k].out = fmt::format("the longest way from here is only {}", mm(ends[k].length));
        else if (ends[k].out.empty() && aorta && ends[k].width < sheath_radius) ends[k].out = "too narrow for a sheath";
        if (ends[k].out.empty()) candidates.push_back(k);
    }
    if (candidates.empty()) candidates.push_back(0);
    std::size_t best = candidates[0];
    for (const std::size_t k : candidates) {
        if (aorta && !upright) break;
        const End &a = ends[k], &b = ends[best];
        const bool level = std::abs(a.height - b.height) < alike * height;
        const bool lower = a.height < b.height;
        if (aorta) {
            const bool beside = std::abs(a.depth - b.depth) < alike * height;
            if (level ? (beside ? a.width > 1.05 * b.width : a.depth > b.depth) : lower) best = k;
        } else {
            const bool as_wide = std::abs(a.width - b.width) < alike * b.width;
            if (as_wide ? lower && !level : a.width > b.width) best = k;
        }
    }
    access.inlet = static_cast<int>(best) + 1;
    for (std::size_t k = 0; k < ends.size(); ++k) {
        const End &a = ends[k], &b = ends[best];
        std::string& text = access.reason[k];
        if (k == best)
            text = aorta && upright
                       ? fmt::format("femoral access to an aorta: the lowest end wide enough, {} in radius", mm(a.width))
                   : aorta ? "the first of the list: this aorta does not lie along the head's direction, so that none of its "
                             "ends is known as the lower one"
                           : fmt::format("the widest end, {} in radius", mm(a.width));
        else if (!a.out.empty()) text = a.out;
        else if (aorta && !upright) text = fmt::format("{} in radius", mm(a.width));
        else if (aorta && a.height > b.height + alike * height)
            text = fmt::format("{} nearer to the head", mm(a.height - b.height));
        else if (aorta && a.depth < b.depth - alike * height)
            text = fmt::format("at the same height, {} nearer to the front", mm(b.depth - a.depth));
        else if (a.width < (1 - alike) * b.width) text = fmt::format("narrower, {} in radius", mm(a.width));
        else text = fmt::format("about as wide, {} in radius, and not lower", mm(a.width));
    }
    return access;
}

}  // namespace seldinger

// The implicit function of blended tubes.
#include "shapes/swept_lumen.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {

SweptLumen::SweptLumen(std::vector<SweptTube> tubes, double fillet)
    : tubes_(std::move(tubes)), chunks_(tubes_.size()), fillet_(fillet)
{
    constexpr std::size_t kRun = 12;
    for (std::size_t t = 0; t < tubes_.size(); ++t) {
        const SweptTube& tube = tubes_[t];
        for (std::size_t first = 0; first + 1 < tube.points.size(); first += kRun) {
            const std::size_t last = std::min(first + kRun, tube.points.size() - 1);
            Chunk chunk{first, last, 0.5 * (tube.points[first] + tube.points[last]), 0};
            for (std::size_t i = first; i <= last; ++i)
                chunk.reach = std::max(chunk.reach, (tube.points[i] - chunk.centre).norm() + tube.radius[i]);
            chunks_[t].push_back(chunk);
        }
    }
}

namespace {

/// The nearest point of a segment's axis, and the lumen's radius there.
struct AxisFoot {
    Vec3 away;  // from there to p [m]
    double distance, radius;
};

inline AxisFoot foot_of(const SweptTube& tube, std::size_t segment, const Vec3& p)
{
    const Vec3 &a = tube.points[segment], &b = tube.points[segment + 1];
    const Vec3 ab = b - a;
    const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    const Vec3 away = p - (a + t * ab);
    return {away, away.norm(), tube.radius[segment] + t * (tube.radius[segment + 1] - tube.radius[segment])};
}

}  // namespace

double SweptLumen::value_of(const SweptTube& tube, std::size_t segment, const Vec3& p)
{
    const AxisFoot foot = foot_of(tube, segment, p);
    return foot.distance - foot.radius;
}

FieldValue SweptLumen::of_segment(const SweptTube& tube, std::size_t segment, const Vec3& p)
{
    const AxisFoot foot = foot_of(tube, segment, p);
    // the radius' own slope (a few percent) is left out of the gradient: Newton steps along it still converge
    return {foot.distance - foot.radius, foot.distance > 0
                                             ? Vec3(foot.away / foot.distance)
                                             : Vec3((tube.points[segment + 1] - tube.points[segment]).unitOrthogonal())};
}

FieldValue SweptLumen::blend(const FieldValue& a, const FieldValue& b) const
{
    const double h = std::max(0.0, fillet_ - std::abs(a.value - b.value)) / fillet_;
    const FieldValue &low = a.value < b.value ? a : b, &high = a.value < b.value ? b : a;
    return {low.value - 0.25 * fillet_ * h * h, (1 - 0.5 * h) * low.gradient + 0.5 * h * high.gradient};
}

FieldValue SweptLumen::at(const Vec3& p) const
{
    FieldValue result{std::numeric_limits<double>::infinity(), Vec3::Zero()};
    for (std::size_t t = 0; t < tubes_.size(); ++t) {
        double least = std::numeric_limits<double>::infinity();
        std::size_t nearest = 0;
        for (const Chunk& chunk : chunks_[t]) {
            // nothing in the chunk is below its distance; beyond the fillet it cannot matter to the blend either
            const double bound = (p - chunk.centre).norm() - chunk.reach;
            if (bound >= least || bound > result.value + fillet_) continue;
            for (std::size_t i = chunk.first; i < chunk.last; ++i) {
                const double value = value_of(tubes_[t], i, p);
                if (!(value < least)) continue;
                least = value;
                nearest = i;
            }
        }
        if (std::isinf(least)) continue;
        const FieldValue tube = of_segment(tubes_[t], nearest, p);
        result = std::isinf(result.value) ? tube : blend(result, tube);
    }
    return result;
}

}  // namespace seldinger

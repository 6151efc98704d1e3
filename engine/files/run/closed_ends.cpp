// Tips against the closed ends of a vessel.
#include "run/closed_ends.h"

#include "scene/scene.h"
#include "vessel/shared_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

constexpr double facing = 0.7;  // cosine: within 45 degrees of straight into the vessel

/// Whether the wall is near in all directions out of the vessel: in a tube's round or flat end it is 2.2 radii away at most,
/// straight into the corner; twice that for ends that are not round. Beside the edge of a flat lumen, which is near in all these
/// too, the lumen is wide to both sides.
bool is_closed(const WallTree& tree, const Inlet& end)
{
    constexpr double reach = 4.5;
    const CrossFrame side = cross_frame(end.direction, end.direction.unitOrthogonal());
    const auto is_far = [&](const Vec3& way) { return first_hit(tree, end.point, way) > reach * end.radius; };
    for (int k = 0; k < 12; ++k) {
        const double turn = 2 * std::numbers::pi * k / 12;
        const Vec3 aside = std::cos(turn) * side.u + std::sin(turn) * side.v;
        if (is_far(-0.6 * end.direction + 0.8 * aside) || (is_far(aside) && is_far(-aside))) return false;
    }
    return !is_far(-end.direction);
}

bool is_near(const Vec3& p, const Inlet& way, double radii) { return (p - way.point).norm() < radii * way.radius; }

}  // namespace

ClosedEnds::ClosedEnds(const std::vector<BoundaryLoop>& openings, const WallMesh& mesh, const Centreline& centreline,
                       const std::vector<Vec3>& inlets)
{
    if (centreline.points.size() < 2) return;
    const auto is_way = [&](const Inlet& end) {
        return std::any_of(openings.begin(), openings.end(), [&](const BoundaryLoop& o) { return is_near(o.centre, end, 2); }) ||
               std::any_of(inlets.begin(), inlets.end(), [&](const Vec3& p) { return is_near(p, end, 2); });
    };
    for (const Inlet& end : find_inlets({}, centreline))
        if (!is_way(end)) ends_.push_back(end);
    if (ends_.empty() || mesh.triangles.empty()) return;
    const std::shared_ptr<const WallTree> tree = shared_wall_tree(mesh);
    std::erase_if(ends_, [&](const Inlet& end) { return !is_closed(*tree, end); });
}

void ClosedEnds::watch(EndTouch& touch, const Output& now) const
{
    for (const Inlet& end : ends_)
        for (const ContactRow& contact : now.contacts) {
            if (contact.b.kind != BodyKind::Wall || !(contact.normal_force > 0) || contact.along_a > end.radius) continue;
            const Vec3 tip = now.wires[static_cast<std::size_t>(contact.a.body)].tip, from = tip - end.point;
            const double out = -from.dot(end.direction);  // an end lies one radius out from its point
            const bool is_at_end = out > 0.3 * end.radius && from.norm() < 2 * end.radius;
            if (!is_at_end || contact.normal.dot(end.direction) < facing) continue;
            if (++touch.rows > 1) return;
            touch.wire = contact.a.body;
            touch.time = now.time;
            for (int d = 0; d < 3; ++d) touch.tip[d] = tip[d];
            return;
        }
}

std::string describe(const EndTouch& touch, const Scene& scene)
{
    if (touch.rows == 0) return {};
    const std::string& label = scene.instrument(static_cast<int>(touch.wire)).label;
    return fmt::format(
        "the tip{} pressed on a closed end of the vessel from {:.4g} s on, near [{:.4g}, {:.4g}, {:.4g}] m: forces from then on "
        "come "
        "from the end of the mesh. Cut the mesh open there, or stop the feed before",
        label.empty() ? "" : " of " + label, touch.time, touch.tip[0], touch.tip[1], touch.tip[2]);
}

}  // namespace seldinger

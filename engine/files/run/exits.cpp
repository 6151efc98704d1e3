// Tips that cross the rims of openings.
#include "run/exits.h"

#include "run/frames.h"
#include "scene/scene.h"
#include "vessel/inlets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {

static_assert(ExitTally::most_wires >= most_scene_instruments);

namespace {

/// Whether a point of its plane lies within the rim: its corners go round it once.
bool within(const BoundaryLoop& rim, const WallMesh& mesh, const Vec3& p)
{
    double turned = 0;
    for (std::size_t k = 0; k < rim.vertices.size(); ++k) {
        const auto corner = [&](std::size_t i) -> Vec3 {
            const Vec3 to = mesh.vertices[static_cast<std::size_t>(rim.vertices[i % rim.vertices.size()])] - p;
            return to - to.dot(rim.inward) * rim.inward;
        };
        const Vec3 a = corner(k), b = corner(k + 1);
        turned += std::atan2(a.cross(b).dot(rim.inward), a.dot(b));
    }
    return std::abs(turned) > std::numbers::pi;
}

/// +1: the path from a to b leads out through the opening, -1: in, 0: neither.
int crossing(const BoundaryLoop& rim, const WallMesh& mesh, const Vec3& a, const Vec3& b)
{
    const double from = (a - rim.centre).dot(rim.inward), to = (b - rim.centre).dot(rim.inward);
    if ((from >= 0) == (to >= 0)) return 0;
    return within(rim, mesh, a + from / (from - to) * (b - a)) ? (from >= 0 ? 1 : -1) : 0;
}

void note(ExitTally& tally, int wire, int opening, int way, double time)
{
    ExitTally::Exit* open = nullptr;
    for (int k = 0; k < tally.count; ++k)
        if (tally.exit[k].wire == wire && tally.exit[k].opening == opening && tally.exit[k].back == 0) open = &tally.exit[k];
    if (way < 0 && open) open->back = time;
    if (way > 0 && !open && tally.count < ExitTally::most_exits) tally.exit[tally.count++] = {wire, opening, time, 0};
}

}  // namespace

void watch_exits(ExitTally& tally, std::span<const Vec3> tips, std::span<const BoundaryLoop> openings, const WallMesh& mesh,
                 double time)
{
    if (openings.empty()) return;
    for (std::size_t w = 0; w < std::min<std::size_t>(tips.size(), ExitTally::most_wires); ++w) {
        const Vec3 before(tally.tip[w][0], tally.tip[w][1], tally.tip[w][2]), now = tips[w];
        for (std::size_t k = 0; k < openings.size() && tally.seen[w]; ++k)
            if (const int way = crossing(openings[k], mesh, before, now))
                note(tally, static_cast<int>(w), static_cast<int>(k), way, time);
        tally.seen[w] = 1;
        for (int c = 0; c < 3; ++c) tally.tip[w][c] = now[c];
    }
}

int outside_through(const ExitTally& tally, int wire)
{
    for (int k = tally.count - 1; k >= 0; --k)
        if (tally.exit[k].wire == wire && tally.exit[k].back == 0) return tally.exit[k].opening;
    return -1;
}

std::vector<std::string> exit_sentences(const ExitTally& tally, const std::vector<BoundaryLoop>& openings,
                                        const Centreline& centreline, const Scene& scene)
{
    std::vector<std::string> list;
    for (int k = 0; k < tally.count; ++k) {
        const ExitTally::Exit& exit = tally.exit[k];
        const BoundaryLoop& rim = openings[static_cast<std::size_t>(exit.opening)];
        const std::string& label = scene.instrument(exit.wire).label;
        const int inlet = inlet_through(openings, centreline, exit.opening);
        std::string text =
            fmt::format("the tip{} left through {} ([{:.4g}, {:.4g}, {:.4g}] m, radius {:.3g} mm) at {:.4g} s",
                        label.empty() ? "" : " of " + label, inlet > 0 ? fmt::format("inlet {}", inlet) : "an opening",
                        rim.centre.x(), rim.centre.y(), rim.centre.z(), 1e3 * rim.radius, exit.left);
        if (exit.back > 0) text += fmt::format(" and came back at {:.4g} s", exit.back);
        else text += ": the part beyond the opening touches nothing";
        list.push_back(std::move(text));
    }
    return list;
}

}  // namespace seldinger

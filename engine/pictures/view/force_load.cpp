// Finds each contact's place along the wire and spreads its force.
#include "view/force_load.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// Arc length of the point of the wire nearest to `p`.
double place_of(const std::vector<Vec3>& nodes, const std::vector<double>& arc, const Vec3& p)
{
    double best = std::numeric_limits<double>::infinity(), at = 0;
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
        const Vec3 edge = nodes[i + 1] - nodes[i];
        const double square = edge.squaredNorm();
        const double s = square > 0 ? std::clamp((p - nodes[i]).dot(edge) / square, 0.0, 1.0) : 0.0;
        const double far = (nodes[i] + s * edge - p).squaredNorm();
        if (far < best) best = far, at = arc[i] + s * (arc[i + 1] - arc[i]);
    }
    return at;
}

struct Place {
    double at, force;
};

/// Sum of f (1 - |s - at|/w)/w over the forces within w; `places` are sorted.
double load_at(const std::vector<Place>& places, double s)
{
    constexpr double w = load_window;
    double sum = 0;
    auto p = std::lower_bound(places.begin(), places.end(), s - w, [](const Place& a, double from) { return a.at < from; });
    for (; p != places.end() && p->at < s + w; ++p) sum += p->force * (1 - std::abs(s - p->at) / w) / w;
    return sum;
}

}  // namespace

FrameLoads loads_of(const WireFrame& frame)
{
    FrameLoads loads;
    if (frame.wires.size() != 1 || frame.contacts.empty() || frame.wires[0].nodes.size() < 2) return loads;
    const std::vector<Vec3>& nodes = frame.wires[0].nodes;
    std::vector<double> arc(nodes.size(), 0.0), own;
    for (std::size_t i = 1; i < nodes.size(); ++i) arc[i] = arc[i - 1] + (nodes[i] - nodes[i - 1]).norm();
    std::vector<Place> places;
    for (const ContactMark& c : frame.contacts) places.push_back({place_of(nodes, arc, c.point), c.force});
    for (const Place& p : places) own.push_back(p.at);
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.at < b.at; });
    for (const double s : arc) loads.nodes.push_back(load_at(places, s));
    for (const double s : own) loads.contacts.push_back(load_at(places, s));
    for (const auto* list : {&loads.nodes, &loads.contacts})
        for (const double load : *list) loads.largest = std::max(loads.largest, load);
    return loads;
}

}  // namespace seldinger

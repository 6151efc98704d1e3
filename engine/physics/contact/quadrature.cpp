// Quadrature points: made for a wire, placed on its edges.
#include "contact/quadrature.h"

#include "contact/wall_law.h"
#include "core/check.h"
#include "rod/place.h"
#include "vessel/ridges.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// What the user left open of the lengths in kernels/shared/multiplier_law.h, the same all along the wire.
ContactSpec with_lengths(ContactSpec contact, double radius)
{
    if (contact.overlap == 0)
        contact.overlap = (contact.normal == NormalLaw::Constraint ? constraint_overlap : augmented_overlap) * radius;
    if (contact.barrier_distance == 0) contact.barrier_distance = barrier_distance * radius;
    return contact;
}

// See quadrature.h. Up to smooth_ridge the axial part of a ridge's force is at most half of it, less than friction. A spacing of
// 1/4 radius puts five quadrature points on a ridge that is pressed in by 0.02 radii, and is reached at twice smooth_ridge.
constexpr double smooth_ridge = 0.12;   // [rad]
constexpr double least_spacing = 0.25;  // of the radius

/// The mesh's ridges as wires see them, one look for all wires of a radius.
class Ridges {
public:
    explicit Ridges(const WallMesh& mesh) : mesh_(mesh) {}
    double angle(double radius)
    {
        if (radius != radius_) angle_ = mean_ridge_angle(mesh_, 2 * (radius_ = radius));
        return angle_;
    }

private:
    const WallMesh& mesh_;
    double radius_ = -1, angle_ = 0;
};

double quadrature_spacing(const WireSpec& spec, const ContactSpec& contact, Ridges& ridges)
{
    if (contact.detection == Detection::Nodes) return uniform_edge(spec);
    if (contact.samples_per_edge > 0 && spec.nodes > 1) return spec.length / (spec.nodes - 1) / contact.samples_per_edge;
    const double radius = spec.least_radius(), ridge = ridges.angle(radius);
    const double fineness = smooth_ridge / ridge;
    return ridge > smooth_ridge ? std::max(fineness * fineness, least_spacing) * radius : radius;
}

}  // namespace

QuadratureSet make_quadrature(const ContactSetup& setup)
{
    const std::vector<WireSpec>& specs = setup.wires;
    const std::vector<ContactSpec>& contacts = setup.contacts;
    const WallModel& wall = setup.wall;
    QuadratureSet set;
    Ridges ridges(wall.mesh);
    for (std::size_t w = 0; w < specs.size(); ++w) {
        const WireSpec& spec = specs[w];
        WireQuadrature points;
        const int stretches =
            std::max(1, static_cast<int>(std::lround(spec.length / quadrature_spacing(spec, contacts[w], ridges))));
        points.spacing = spec.length / stretches;
        points.begin = set.total();
        points.capacity = stretches + 1;
        points.s.push_back(0);
        const ContactSpec contact = with_lengths(contacts[w], spec.least_radius());
        const auto add_model = [&, reach = contact_reach * spec.least_radius()](QuadratureModel model) {
            model.reach = reach;  // the same all along the wire
            set.models.push_back(model);
        };
        // `nodes`: one quadrature point at each control node, with its Voronoi length (the tip's is half an edge)
        const bool at_nodes = contacts[w].detection == Detection::Nodes;
        add_model(tip_model(spec.at(0), contact, wall.spec, wall.typical_lumen_radius));
        WireSection last;
        QuadratureModel line{};
        for (int k = 0; k < stretches; ++k) {
            const double s = (at_nodes ? k : k + 0.5) * points.spacing;
            const double weight = at_nodes && k == 0 ? points.spacing / 2 : points.spacing;
            points.s.push_back(s);
            const WireSection section = spec.at(s);
            if (k < 2 || section != last)
                line = line_model(last = section, contact, wall.spec, wall.typical_lumen_radius, weight);
            add_model(line);
        }
        set.wires.push_back(std::move(points));
    }
    set.places.assign(set.models.size(), QuadraturePlace{0, SEL_NO_EDGE, 0, 0, 0, 0, 0});
    return set;
}

namespace {

// Quadrature points from the k-th on, by material coordinate; @return how many are inside
int place_from(QuadratureSet& set, int wire, const RodView& rod, int begin, int k)
{
    const WireQuadrature& points = set.wires[wire];
    const double end = std::min(rod.material_s[rod.n - 1] + points.offset, points.exposed);
    int edge = 0;
    // a stretch counts once its middle is inside; the base's last half spacing is in the clamp's shadow
    for (; k < points.capacity && points.s[k] <= end; ++k) {
        const double s = points.s[k] - points.offset;
        while (edge < rod.n - 2 && s > rod.material_s[edge + 1]) ++edge;
        const double length = rod.material_s[edge + 1] - rod.material_s[edge];
        QuadraturePlace& place = set.places[points.begin + k];
        place.edge = static_cast<uint>(begin + edge);
        place.epoch = points.epoch;
        place.bary = std::clamp((s - rod.material_s[edge]) / length, 0.0, 1.0);
    }
    return k;
}

}  // namespace

void place_quadrature(QuadratureSet& set, int wire, const RodView& rod, int begin, bool start)
{
    WireQuadrature& points = set.wires[wire];
    points.live = place_from(set, wire, rod, begin, 0);
    points.placed_to = rod.material_s[rod.n - 2];
    points.placed_offset = points.offset;
    for (int i = 0; i < points.capacity && start; ++i) {
        QuadraturePlace& place = set.places[points.begin + i];
        place.edge_t0 = i < points.live ? place.edge : SEL_NO_EDGE;
        place.bary_t0 = place.bary;
    }
}

void place_new_quadrature(QuadratureSet& set, int wire, const RodView& rod, int begin)
{
    WireQuadrature& points = set.wires[wire];
    // still in the introducer, or sliding along others
    if (points.placed_to != rod.material_s[rod.n - 2] || points.placed_offset != points.offset ||
        points.exposed < std::numeric_limits<double>::infinity())
        return place_quadrature(set, wire, rod, begin, false);
    const auto first = std::upper_bound(points.s.begin(), points.s.end(), rod.material_s[rod.n - 2] + points.offset);
    points.live = place_from(set, wire, rod, begin, static_cast<int>(first - points.s.begin()));
}

}  // namespace seldinger

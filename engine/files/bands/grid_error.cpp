// Errors of forces by edges and facets, from bending energy and contacts.
#include "bands/grid_error.h"

#include "nodes/adapt.h"
#include "vessel/wall_mesh.h"
#include "world/node_errors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

namespace seldinger {
namespace {

/// Angle at the first of three points.
double angle_at(const Vec3& a, const Vec3& b, const Vec3& c)
{
    const Vec3 u = b - a, v = c - a;
    return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Unit normal.
Vec3 normal_of(const WallMesh& mesh, const std::array<std::int32_t, 3>& triangle)
{
    const Vec3& a = mesh.vertices[triangle[0]];
    return (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).normalized();
}

/// Barycentric coordinates of the point of a triangle's plane nearest to x, drawn into the triangle.
Vec3 barycentric(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x)
{
    const Vec3 normal = (b - a).cross(c - a);
    const double area = normal.squaredNorm();
    if (!(area > 0)) return Vec3::Constant(1.0 / 3);
    Vec3 at(normal.dot((c - b).cross(x - b)) / area, normal.dot((a - c).cross(x - c)) / area,
            normal.dot((b - a).cross(x - a)) / area);
    at = at.cwiseMax(Vec3::Zero());
    return at / at.sum();
}

constexpr double neighbouring = 1.5;  // edges between two loads that may be one

/// At most 1: an error as large as what it is of tells no more.
double relative(double error, double of) { return of > 0 ? std::min(1.0, error / of) : error > 0 ? 1 : 0; }

/// The wires' weight [N].
double weight_of(const World& run, int first, int end)
{
    double mass = 0;
    for (int w = first; w < end; ++w)
        for (const double m : run.rod(w).mass) mass += m;
    return mass * run.setup().gravity.norm();
}

double longest_edge(const ConstRodView& rod)
{
    const auto edges = rod.rest_length.first(static_cast<std::size_t>(rod.n - 1));
    return *std::max_element(edges.begin(), edges.end());
}

/// Length of a wire from the hub to the contact nearest to it [m].
double free_span(const World& run, int wire)
{
    const ConstRodView rod = run.rod(wire);
    double place = 0;
    for (const ContactRow& row : run.contacts())
        if (row.b.kind == BodyKind::Wall && row.a.body == wire && row.normal_force > 0) place = std::max(place, row.along_a);
    return std::max(0.0, rod.material_s[rod.n - 1] - place);
}

/// The angle that a wire turns by [rad].
double turning_of(const ConstRodView& rod)
{
    double sum = 0;
    for (int j = 1; j < rod.n - 1; ++j)
        sum += std::atan2(rod.tangent(j - 1).cross(rod.tangent(j)).norm(), rod.tangent(j - 1).dot(rod.tangent(j)));
    return sum;
}

/// GridErrors::tip of a wire on these regions, from the tip on. @param rise  mean distance of facets and smooth wall [m]
double tip_on(const ConstRodView& rod, std::span<const TouchedRegion> regions, double rise)
{
    if (regions.empty()) return 0;
    const TouchedRegion& first = regions[0];
    const TouchedRegion* next = regions.size() > 1 ? &regions[1] : nullptr;
    const double span = (next ? next->at() : rod.material_s[rod.n - 1]) - first.at();
    const double turned = span > 0 ? 1.5 * first.at() / span : 0;
    return std::hypot((1 + turned) * first.by(), next ? turned * next->by() : 0, rise * turning_of(rod));
}

/// GridErrors::split of the region with the largest load of these, of one wire.
double split_load(const World& run, const ConstRodView& rod, std::span<const TouchedRegion> regions, const TouchedRegion& most)
{
    const double place = most.at();
    int j = 0;  // the edge that it is on
    while (j + 2 < rod.n && rod.material_s[j + 1] <= place) ++j;
    const double edge = rod.rest_length[j];
    if (edge <= run.setup().force_patch) return 0;
    double beside = 0;
    for (const TouchedRegion& region : regions)
        if (&region != &most && std::abs(region.at() - place) < neighbouring * edge) beside = std::max(beside, region.load);
    return beside / most.load;
}

}  // namespace

GridShare times(const GridShare& share, double force) { return {share.nodes * std::abs(force), share.facets * std::abs(force)}; }

GridShare of_hand(const GridErrors& e, double hand, double friction)
{
    const double back = std::abs(std::abs(hand) - friction);
    return {e.energy.nodes * back + e.pressed.nodes * friction, e.energy.facets * back + e.pressed.facets * friction};
}

double of_hand_at(const GridErrors& e, std::size_t instrument) { return instrument < e.hands.size() ? e.hands[instrument] : 0; }

void add_places(ErrorBand& band, const GridErrors& e)
{
    band.nodes = std::hypot(band.nodes, e.placed.nodes * band.value) + e.split * band.value;
    band.facets = std::hypot(band.facets, e.placed.facets * band.value);
    band.sum_up();
}

void GridErrors::widen(const GridErrors& other)
{
    for (double GridErrors::*entry :
         {&GridErrors::axial, &GridErrors::normal, &GridErrors::rise, &GridErrors::tip, &GridErrors::split})
        this->*entry = std::max(this->*entry, other.*entry);
    for (GridShare GridErrors::*share :
         {&GridErrors::energy, &GridErrors::missed, &GridErrors::pressed, &GridErrors::patch, &GridErrors::placed}) {
        (this->*share).nodes = std::max((this->*share).nodes, (other.*share).nodes);
        (this->*share).facets = std::max((this->*share).facets, (other.*share).facets);
    }
    hands.resize(std::max(hands.size(), other.hands.size()));
    for (std::size_t k = 0; k < other.hands.size(); ++k) hands[k] = std::max(hands[k], other.hands[k]);
}

void GridErrorGauge::find_normals(const WallMesh& mesh)
{
    if (!normals_.empty()) return;
    normals_.assign(mesh.vertices.size(), Vec3::Zero());
    for (const auto& triangle : mesh.triangles) {
        const Vec3 corner[] = {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]};
        const Vec3 normal = normal_of(mesh, triangle);
        for (int k = 0; k < 3; ++k)
            normals_[triangle[k]] += angle_at(corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]) * normal;
    }
    for (Vec3& normal : normals_) normal.normalize();
}

GridErrors GridErrorGauge::of(const World& run, int system)
{
    GridErrors errors;
    const auto [first, end] = run.wires_of(system);
    BendingError whole;
    for (int w = first; w < end; ++w) {
        errors.hands.push_back(hand_error(run, w));
        const BendingError bending = run.bending_error(w);
        whole.energy += bending.energy;
        whole.missed += bending.missed;
        const WireReadings r = run.readings(w);
        errors.normal += r.normal - r.normal_between;
    }
    if (!(whole.energy > 0)) return errors;  // nothing is bent
    errors.energy.nodes = relative(whole.missed, whole.energy);
    const ConstRodView rod = run.rod(first);
    const double weight = weight_of(run, first, end), h = longest_edge(rod), length = rod.material_s[rod.n - 1];
    if (!(errors.normal > 0)) {  // nothing touches
        errors.energy.nodes = std::min(1.0, errors.energy.nodes + h / length);
        errors.missed.nodes = errors.energy.nodes * whole.energy;
        return errors;
    }
    const double part = std::max(0.0, 1 - weight / errors.normal);  // of the normal forces that is not the wires' own weight
    const double shared = weight / length * h * std::min(1.0, h / free_span(run, first)) / 2;
    find_regions(run, first, end, errors);
    add_spans(run, first, end, whole, errors);
    const double by_weight = shared / errors.normal;
    for (GridShare* share : {&errors.energy, &errors.pressed, &errors.patch}) {
        share->nodes = std::min(1.0, part * share->nodes + by_weight);
        share->facets = std::min(1.0, part * share->facets + creases_);
    }
    errors.missed = {std::max(whole.missed, errors.energy.nodes * whole.energy), part * errors.missed.facets};
    errors.placed = {part * errors.placed.nodes, part * errors.placed.facets};
    for (GridShare* share : {&errors.energy, &errors.pressed}) {
        share->nodes = std::min(1.0, std::hypot(share->nodes, part * places_.nodes));
        share->facets = std::min(1.0, std::hypot(share->facets, part * places_.facets));
    }
    return errors;
}

/// The regions of contact of all wires, those of the first from the tip on; and pushes along it.
void GridErrorGauge::find_regions(const World& run, int first, int end, GridErrors& errors)
{
    const WallMesh& mesh = run.setup().mesh;
    const bool faceted = !run.setup().vessel.elastic && !mesh.triangles.empty();
    if (faceted) find_normals(mesh);
    std::map<std::pair<int, int>, TouchedRegion> found;  // by wire and number
    double axial = 0, creases = 0;
    for (const ContactRow& row : run.contacts()) {
        if (row.b.kind != BodyKind::Wall || row.a.body < first || row.a.body >= end || !(row.normal_force > 0)) continue;
        TouchedRegion& region = found[{row.a.body, row.region}];
        region.wire = row.a.body;
        region.load += row.normal_force;
        region.along += row.normal_force * row.along_a;
        const ConstRodView rod = run.rod(row.a.body);
        const int edge = std::clamp(row.a.element, 0, rod.n - 2);
        if (row.length > 0) region.half_edge += row.normal_force * std::max(rod.rest_length[edge], row.length) / 2;
        if (!faceted) continue;
        const auto& triangle = mesh.triangles[static_cast<std::size_t>(row.b.element)];
        const Vec3 at =
            barycentric(mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]], row.point);
        Vec3 smooth = Vec3::Zero();
        double offset = 0;
        for (int k = 0; k < 3; ++k) {
            smooth += at[k] * normals_[triangle[k]];
            offset += at[k] * (row.point - mesh.vertices[triangle[k]]).dot(normals_[triangle[k]]) / 2;
        }
        if (!(smooth.norm() > 0)) continue;
        smooth.normalize();
        const Vec3 tangent = rod.tangent(edge);
        axial += row.normal_force * (row.normal - smooth).dot(tangent);
        creases += row.normal_force * std::min(1.0, 1 / std::max(0.5, normal_of(mesh, triangle).dot(row.normal)) - 1);
        region.inwards += row.normal_force * std::abs(offset);
        region.sideways += row.normal_force * sideways(mesh, triangle, row.normal - smooth, tangent.cross(smooth));
        region.lengthways += row.normal_force * sideways(mesh, triangle, row.normal - smooth, tangent);
    }
    regions_.clear();
    for (const auto& [key, region] : found) regions_.push_back(region);
    std::ranges::sort(regions_, [](const TouchedRegion& a, const TouchedRegion& b) {
        return std::pair(a.wire, a.at()) < std::pair(b.wire, b.at());
    });
    creases_ = creases / errors.normal;
    places_ = {};
    errors.axial = std::abs(axial) / errors.normal;
}

GridShare GridErrorGauge::beside(const World& run, int wire, std::size_t k) const
{
    const double length = run.rod(wire).material_s[run.rod(wire).n - 1];
    BendingError sum;
    double work = 0;
    const auto take_in = [&](std::size_t spans, double weight) {
        const std::size_t first = k >= spans ? k - spans : 0, last = std::min(k + spans, regions_.size() - 1);
        const BendingError bending = bending_error_between(run, wire, k >= spans ? regions_[first].at() : 0,
                                                           k + spans == last ? regions_[last].at() : length);
        sum.energy += weight * bending.energy;
        sum.missed += weight * bending.missed;
        for (std::size_t r = first; r <= last; ++r) work += weight * regions_[r].inwards;
    };
    take_in(1, 1 - passes_span);
    take_in(2, passes_span);  // which has the others in it
    return {relative(sum.missed, sum.energy), relative(work, 2 * sum.energy)};
}

GridShare GridErrorGauge::placed(const World& run, int wire, std::size_t k) const
{
    const TouchedRegion& region = regions_[k];
    const double at = region.at(), by_nodes = region.half_edge / region.load,
                 by_facets = std::abs(region.lengthways) / region.load;
    const double same = neighbouring * 2 * by_nodes;
    double before = 0, after = run.rod(wire).material_s[run.rod(wire).n - 1] - at;  // spans; 0: none
    for (const TouchedRegion& other : regions_) {
        const double span = other.at() - at;
        if (span > same) after = std::min(after, span);
        if (-span > same) before = before > 0 ? std::min(before, -span) : -span;
    }
    const double per_metre = (before > 0 ? 1 / before : 0) + (after > 0 ? 1 / after : 0);
    return {std::min(1.0, per_metre * by_nodes), std::min(1.0, per_metre * by_facets)};
}

/// The shares of forces by the energy of all, and of each region by that of the spans beside it.
void GridErrorGauge::add_spans(const World& run, int first, int end, const BendingError& whole, GridErrors& errors)
{
    double work = 0, load = 0, most = 0;
    for (const TouchedRegion& region : regions_) work += region.inwards, load += region.load;
    errors.missed.facets = work;
    errors.energy.facets = relative(work, 2 * whole.energy);
    errors.rise = work / errors.normal;
    errors.pressed = errors.patch = errors.energy;
    if (regions_.empty()) return;
    const auto of_first =
        std::span(regions_).first(static_cast<std::size_t>(std::ranges::count(regions_, first, &TouchedRegion::wire)));
    errors.tip = tip_on(run.rod(first), of_first, errors.rise);
    if (end - first > 1) {  // instruments that bend together have no spans of their own
        const auto largest = std::ranges::max_element(regions_, {}, &TouchedRegion::load);
        const auto wire = std::ranges::equal_range(regions_, largest->wire, {}, &TouchedRegion::wire);
        errors.split = split_load(run, run.rod(largest->wire), wire, *largest);
        return;
    }
    errors.pressed = {};
    GridShare squares;
    for (std::size_t k = 0; k < regions_.size(); ++k) {
        const TouchedRegion& region = regions_[k];
        const GridShare own = beside(run, first, k);
        errors.pressed.nodes += own.nodes * region.load / load;
        errors.pressed.facets += own.facets * region.load / load;
        const GridShare place = placed(run, first, k);
        squares.nodes += std::pow(place.nodes * region.load / load, 2);
        squares.facets += std::pow(place.facets * region.load / load, 2);
        if (region.load <= most) continue;
        most = region.load;
        errors.patch = own;
        errors.placed = place;
        errors.split = split_load(run, run.rod(first), regions_, region);
    }
    places_ = {std::sqrt(squares.nodes / 3),
               std::sqrt(squares.facets / 3)};  // a place that is as likely anywhere within half an edge
}

double GridErrorGauge::sideways(const WallMesh& mesh, const std::array<std::int32_t, 3>& triangle, const Vec3& off,
                                const Vec3& across) const
{
    double turns = 0, spans = 0, widest = 0;  // curvature across, by least squares over the edges
    for (int k = 0; k < 3; ++k) {
        const auto a = triangle[k], b = triangle[(k + 1) % 3];
        const double span = (mesh.vertices[b] - mesh.vertices[a]).dot(across);
        turns += span * (normals_[b] - normals_[a]).dot(across);
        spans += span * span;
        widest = std::max(widest, std::abs(span));
    }
    const double wrong = off.dot(across) * spans;
    if (std::abs(wrong) >= widest * std::abs(turns)) return std::copysign(turns != 0 ? widest : 0.0, wrong);
    return wrong / std::abs(turns);
}

}  // namespace seldinger

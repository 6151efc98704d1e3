// Errors of forces by edges and facets, from bending energy and contacts.
#include "run/grid_error.h"

#include "world/node_errors.h"
#include "vessel/wall_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
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
    Vec3 at(normal.dot((c - b).cross(x - b)) / area, normal.dot((a - c).cross(x - c)) / area, normal.dot((b - a).cross(x - a)) / area);
    at = at.cwiseMax(Vec3::Zero());
    return at / at.sum();
}

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

/// What the facets of a region of contact move its place by: sums over its samples, weighted by normal forces.
struct Moved {
    double load = 0, along = 0, inwards = 0, sideways = 0;  // [N], [N m]
    [[nodiscard]] double at() const { return along / load; }
    [[nodiscard]] double by() const { return std::hypot(inwards, sideways) / load; }
};

/// The angle that a wire turns by [rad].
double turning_of(const ConstRodView& rod)
{
    double sum = 0;
    for (int j = 1; j < rod.n - 1; ++j) sum += std::atan2(rod.tangent(j - 1).cross(rod.tangent(j)).norm(), rod.tangent(j - 1).dot(rod.tangent(j)));
    return sum;
}

/// GridErrors::tip of a wire on these regions. @param rise  mean distance of facets and smooth wall [m]
double tip_on(const ConstRodView& rod, const std::map<int, Moved>& regions, double rise)
{
    const Moved *first = nullptr, *next = nullptr;  // from the tip
    for (const auto& [number, region] : regions) {
        if (!first || region.at() < first->at()) next = std::exchange(first, &region);
        else if (!next || region.at() < next->at()) next = &region;
    }
    if (!first) return 0;
    const double span = (next ? next->at() : rod.material_s[rod.n - 1]) - first->at();
    const double turned = span > 0 ? 1.5 * first->at() / span : 0;
    return std::hypot((1 + turned) * first->by(), next ? turned * next->by() : 0, rise * turning_of(rod));
}

/// GridErrors::split of the system's wires.
double split_load(const World& run, int first, int end)
{
    struct Region {
        double load = 0, moment = 0;  // [N], and times the place [N m]
        [[nodiscard]] double at() const { return moment / load; }
    };
    std::map<std::pair<int, int>, Region> regions;  // by wire and number
    for (const ContactRow& row : run.contacts()) {
        if (row.b.kind != BodyKind::Wall || row.a.body < first || row.a.body >= end || !(row.normal_force > 0)) continue;
        Region& region = regions[{row.a.body, row.region}];
        region.load += row.normal_force;
        region.moment += row.normal_force * row.along_a;
    }
    if (regions.empty()) return 0;
    const auto most = std::max_element(regions.begin(), regions.end(), [](const auto& a, const auto& b) { return a.second.load < b.second.load; });
    const ConstRodView rod = run.rod(most->first.first);
    const double place = most->second.at();
    int j = 0;  // the edge that it is on
    while (j + 2 < rod.n && rod.material_s[j + 1] <= place) ++j;
    const double edge = rod.rest_length[j];
    double beside = 0;
    for (const auto& [key, region] : regions)
        if (key.first == most->first.first && key != most->first && edge > run.setup().force_patch && std::abs(region.at() - place) < 1.5 * edge)
            beside = std::max(beside, region.load);
    return beside / most->second.load;
}

}  // namespace

void GridErrors::widen(const GridErrors& other)
{
    for (double GridErrors::*entry : {&GridErrors::nodes, &GridErrors::facets, &GridErrors::axial, &GridErrors::normal, &GridErrors::rise, &GridErrors::tip, &GridErrors::split})
        this->*entry = std::max(this->*entry, other.*entry);
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
        for (int k = 0; k < 3; ++k) normals_[triangle[k]] += angle_at(corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]) * normal;
    }
    for (Vec3& normal : normals_) normal.normalize();
}

GridErrors GridErrorGauge::of(const World& run)
{
    GridErrors errors;
    const auto [first, end] = run.wires_of(0);
    double energy = 0, missed = 0;
    for (int w = first; w < end; ++w) errors.hands.push_back(hand_error(run, w));
    errors.split = split_load(run, first, end);
    for (int w = first; w < end; ++w) {
        const BendingError bending = run.bending_error(w);
        energy += bending.energy;
        missed += bending.missed;
        const WireReadings r = run.readings(w);
        errors.normal += r.normal - r.normal_between;
    }
    if (!(energy > 0)) return errors;  // nothing is bent
    const ConstRodView rod = run.rod(first);
    const double weight = weight_of(run, first, end), h = longest_edge(rod), length = rod.material_s[rod.n - 1], bent = std::min(1.0, missed / energy);
    if (!(errors.normal > 0)) {  // nothing touches
        errors.nodes = std::min(1.0, bent + h / (2 * length));
        return errors;
    }
    const double part = std::max(0.0, 1 - weight / errors.normal);  // of the normal forces that is not the wires' own weight
    const double shared = weight / length * h * std::min(1.0, h / free_span(run, first)) / 2;
    errors.nodes = std::min(1.0, part * bent + shared / errors.normal);
    if (!run.setup().vessel.elastic && !run.setup().mesh.triangles.empty()) add_facets(run, first, end, part, energy, errors);
    return errors;
}

void GridErrorGauge::add_facets(const World& run, int first, int end, double part, double energy, GridErrors& errors)
{
    const WallMesh& mesh = run.setup().mesh;
    find_normals(mesh);
    std::map<int, Moved> regions;  // of the first wire
    double work = 0, axial = 0, creases = 0;
    for (const ContactRow& row : run.contacts()) {
        if (row.b.kind != BodyKind::Wall || row.a.body < first || row.a.body >= end || !(row.normal_force > 0)) continue;
        const auto& triangle = mesh.triangles[static_cast<std::size_t>(row.b.element)];
        const Vec3 at = barycentric(mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]], row.point);
        Vec3 smooth = Vec3::Zero();
        double offset = 0;
        for (int k = 0; k < 3; ++k) {
            smooth += at[k] * normals_[triangle[k]];
            offset += at[k] * (row.point - mesh.vertices[triangle[k]]).dot(normals_[triangle[k]]) / 2;
        }
        if (!(smooth.norm() > 0)) continue;
        smooth.normalize();
        const ConstRodView rod = run.rod(row.a.body);
        const Vec3 tangent = rod.tangent(std::clamp(row.a.element, 0, rod.n - 2));
        axial += row.normal_force * (row.normal - smooth).dot(tangent);
        work += row.normal_force * std::abs(offset);
        creases += row.normal_force * std::min(1.0, 1 / std::max(0.5, normal_of(mesh, triangle).dot(row.normal)) - 1);
        if (row.a.body != first) continue;
        Moved& region = regions[row.region];
        region.load += row.normal_force;
        region.along += row.normal_force * row.along_a;
        region.inwards += row.normal_force * std::abs(offset);
        region.sideways += row.normal_force * sideways(mesh, triangle, row.normal - smooth, tangent.cross(smooth));
    }
    errors.facets = part * std::min(1.0, work / (2 * energy)) + creases / errors.normal;
    errors.axial = std::abs(axial) / errors.normal;
    errors.rise = work / errors.normal;
    errors.tip = tip_on(run.rod(first), regions, errors.rise);
}

double GridErrorGauge::sideways(const WallMesh& mesh, const std::array<std::int32_t, 3>& triangle, const Vec3& off, const Vec3& across) const
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

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

/// Part of the normal forces that is not the wire's own weight.
double elastic_part(const World& run, double normal, int first, int end)
{
    double mass = 0;
    for (int w = first; w < end; ++w)
        for (const double m : run.rod(w).mass) mass += m;
    return normal > 0 ? std::max(0.0, 1 - mass * run.setup().gravity.norm() / normal) : 0;
}

/// Half of the longest edge over the length of a wire.
double hub_share(const ConstRodView& rod)
{
    const auto edges = rod.rest_length.first(static_cast<std::size_t>(rod.n - 1));
    return *std::max_element(edges.begin(), edges.end()) / (2 * rod.material_s[rod.n - 1]);
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
    for (double GridErrors::*entry : {&GridErrors::nodes, &GridErrors::facets, &GridErrors::axial, &GridErrors::normal, &GridErrors::offset, &GridErrors::split})
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
        const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
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
    if (!(energy > 0) || !(errors.normal > 0)) return errors;  // nothing is bent, or nothing touches
    const double part = elastic_part(run, errors.normal, first, end);
    errors.nodes = part * std::min(1.0, missed / energy) + (1 - part) * hub_share(run.rod(first));
    const WorldSetup& setup = run.setup();
    if (setup.vessel.elastic || setup.mesh.triangles.empty()) return errors;
    find_normals(setup.mesh);
    double work = 0, axial = 0;
    for (const ContactRow& row : run.contacts()) {
        if (row.b.kind != BodyKind::Wall || row.a.body < first || row.a.body >= end || !(row.normal_force > 0)) continue;
        const auto& triangle = setup.mesh.triangles[static_cast<std::size_t>(row.b.element)];
        const Vec3 at = barycentric(setup.mesh.vertices[triangle[0]], setup.mesh.vertices[triangle[1]], setup.mesh.vertices[triangle[2]], row.point);
        Vec3 smooth = Vec3::Zero();
        double offset = 0;
        for (int k = 0; k < 3; ++k) {
            smooth += at[k] * normals_[triangle[k]];
            offset += at[k] * (row.point - setup.mesh.vertices[triangle[k]]).dot(normals_[triangle[k]]) / 2;
        }
        if (!(smooth.norm() > 0)) continue;
        const ConstRodView rod = run.rod(row.a.body);
        const Vec3 tangent = rod.tangent(std::clamp(row.a.element, 0, rod.n - 2));
        axial += row.normal_force * (row.normal - smooth.normalized()).dot(tangent);
        work += row.normal_force * std::abs(offset);
        errors.offset = std::max(errors.offset, std::abs(offset));
    }
    errors.facets = part * std::min(1.0, work / (2 * energy));
    errors.axial = std::abs(axial) / errors.normal;
    return errors;
}

}  // namespace seldinger

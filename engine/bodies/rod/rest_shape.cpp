// Rest shape, stiffness and mass of nodes and edges: integrals of the wire's description over the material of each.
//
// A node has its Voronoi cell, from the middle of one edge to the middle of the next; an edge its own length.
// Stiffnesses in series add their compliances, so a node at a jump of stiffness turns by M int ds/B under the moment M. B =
// length / int ds/B keeps a jump of 1000:1 as accurate as a uniform wire wherever it lies in the cell.
#include "rod/elastic.h"

#include "core/check.h"
#include "rod/curvature.h"
#include "rod/rest_shape.h"
#include "rod/transport.h"

#include <algorithm>
#include <numbers>

namespace seldinger {
namespace {

/// Calls visit(section, length) for each uniform piece of [begin, end], material beyond the wire's ends being like that at them.
template <class Visit>
void for_each_piece(const WireSpec& spec, double begin, double end, Visit visit)
{
    for (double from = begin; from < end;) {
        double to = end;
        spec.for_each_end([&](double jump) {
            if (jump > from && jump < to) to = jump;
        });
        visit(spec.at(0.5 * (from + to)), to - from);
        from = to;
    }
}

struct CellIntegrals {
    double bend_compliance = 0, twist_compliance = 0, mass = 0;  // int ds/B, int ds/C, [kg]
    Vec2 rest_kappa = Vec2::Zero();
};

CellIntegrals integrate_cell(const WireSpec& spec, double begin, double end)
{
    CellIntegrals sum;
    for_each_piece(spec, begin, end, [&](const WireSection& section, double length) {
        sum.bend_compliance += length / section.bend_stiffness;
        sum.twist_compliance += length / section.twist_stiffness;
        sum.mass += section.density * std::numbers::pi * section.radius * section.radius * length;
        sum.rest_kappa += section.rest_curvature * length;
    });
    return sum;
}

/// Curvature and twist of the accepted state at inner node i become its rest values.
void rest_from_shape(const RodView& rod, int i)
{
    const Vec3 te = rod.tangent(i - 1), tf = rod.tangent(i);
    const double chi = one_plus_cos(te, tf);
    const Vec3 curvature = (2 / chi * curvature_factor(curvature_q(rod.curvature), chi)) * te.cross(tf);
    const double twist = rod.theta[i] - rod.theta[i - 1] + rod.ref_twist[i];
    const Vec3 n1 = turned(rod.ref_d1(i - 1), te, rod.theta[i - 1] + 0.5 * twist);  // frame of kappa, see rod/pair.h
    rod.rest_kappa1[i] = curvature.dot(te.cross(n1));
    rod.rest_kappa2[i] = -curvature.dot(n1);
    rod.rest_twist[i] = twist;
}

/// Rest values of an end's half cell [begin, end], whose shape no turning angle tells: per length, that of the next two nodes
/// continued linearly to the middle of the half cell.
void rest_from_neighbours(const RodView& rod, int end, int next, int after)
{
    if (rod.n < 3) return;
    const double length = rod.voronoi_length(end), l1 = rod.voronoi_length(next);
    const double inwards = end == 0 ? 1 : -1;
    const double middle = rod.material_s[end] + inwards * 0.5 * length;
    const double weight = rod.n > 3 ? (rod.material_s[next] - middle) / (rod.material_s[after] - rod.material_s[next]) : 0;
    const auto extend = [&](std::span<double> rest) {
        const double first = rest[next] / l1;
        const double slope = rod.n > 3 ? first - rest[after] / rod.voronoi_length(after) : 0;
        rest[end] = length * (first + weight * slope);
    };
    extend(rod.rest_kappa1);
    extend(rod.rest_kappa2);
    extend(rod.rest_twist);
}

}  // namespace

double edge_stretch_stiffness(const WireSpec& spec, double begin, double end)
{
    double compliance = 0;
    for_each_piece(spec, begin, end,
                   [&](const WireSection& section, double length) { compliance += length / section.stretch_stiffness; });
    return (end - begin) / compliance;
}

EdgeOffset edge_offset(const RodView& rod, const WireSpec& spec, int j)
{
    EdgeOffset offset;
    const double begin = rod.material_s[j], end = rod.material_s[j + 1], middle = 0.5 * (begin + end);
    for (const bool away : {false, true}) {
        double from = away ? middle : begin;
        const double placed = away ? end : begin;
        for_each_piece(spec, from, away ? end : middle, [&](const WireSection& section, double length) {
            const double moment = length * (from + 0.5 * length - placed);
            if (!spec.place.rest_is_placed) offset.natural += moment * section.rest_curvature;
            offset.compliance += moment / section.bend_stiffness;
            from += length;
        });
    }
    return offset;
}

void set_rest_edge(const RodView& rod, const WireSpec& spec, int j)
{
    const double begin = rod.material_s[j], end = rod.material_s[j + 1];
    SEL_ASSERT(end > begin);
    double radius = 0, inertia = 0;
    for_each_piece(spec, begin, end, [&](const WireSection& section, double length) {
        const double r2 = section.radius * section.radius;
        radius += section.radius * length;
        inertia += section.density * (0.5 * std::numbers::pi * r2 * r2) * length;
    });
    rod.rest_length[j] = end - begin;
    rod.stretch_stiffness[j] = edge_stretch_stiffness(spec, begin, end);
    rod.radius[j] = radius / (end - begin);
    rod.spin_inertia[j] = inertia;
}

void set_rest_node(const RodView& rod, const WireSpec& spec, int i, bool keep_shape)
{
    const double s = rod.material_s[i];
    const double begin = i > 0 ? 0.5 * (rod.material_s[i - 1] + s) : s;
    const double end = i < rod.n - 1 ? 0.5 * (s + rod.material_s[i + 1]) : s;
    const CellIntegrals cell = integrate_cell(spec, begin, end);
    rod.bend_stiffness[i] = (end - begin) / cell.bend_compliance;
    rod.twist_stiffness[i] = (end - begin) / cell.twist_compliance;
    rod.mass[i] = cell.mass;
    if (keep_shape) return;
    rod.rest_kappa1[i] = cell.rest_kappa[0];
    rod.rest_kappa2[i] = cell.rest_kappa[1];
    rod.rest_twist[i] = 0;
}

void set_rest_shape(const RodView& rod, const WireSpec& spec, bool rest_is_placed)
{
    for (int j = 0; j < rod.n - 1; ++j) set_rest_edge(rod, spec, j);
    for (int i = 0; i < rod.n; ++i) set_rest_node(rod, spec, i, false);
    if (!rest_is_placed) return;
    for (int i = 1; i < rod.n - 1; ++i) rest_from_shape(rod, i);
    rest_from_neighbours(rod, 0, 1, 2);
    rest_from_neighbours(rod, rod.n - 1, rod.n - 2, rod.n - 3);
}

}  // namespace seldinger

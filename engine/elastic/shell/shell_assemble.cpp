// The shell's matrices, triangle by triangle.
#include "core/error.h"
#include "shell/block_pattern.h"
#include "shell/shell.h"
#include "shell/shell_strain.h"

#include <cmath>

namespace seldinger {

using namespace shell_detail;

namespace {

/// N^ab in the frame of a point: 11, 22, 12 [N/m].
Vec3 prestress_in_frame(const ShellPoint& q, const Prestress& prestress, double pressure)
{
    const Vec2 along(prestress.axis.dot(q.e1), prestress.axis.dot(q.e2));
    const double hoop = pressure * prestress.radius, axial = prestress.axial_part * hoop;
    const double length = along.norm();
    // where the wall faces the axis (a cap) both directions are alike
    if (!(length > 1e-9 * prestress.axis.norm())) return {axial, axial, 0};
    const Vec2 z = along / length, t(-z.y(), z.x());
    return {hoop * t.x() * t.x() + axial * z.x() * z.x(), hoop * t.y() * t.y() + axial * z.y() * z.y(),
            hoop * t.x() * t.y() + axial * z.x() * z.y()};
}

}  // namespace

/// int C H eps eps + D H rho rho over a triangle: bending point by point, the membrane of the triangle's strain.
template <class Add>
void Shell::add_elastic(std::size_t first, const Add& add) const
{
    const Mat3 h = law();
    const double d = std::pow(spec_.thickness, 3) / 12;
    const auto eps = membrane(first);
    const std::size_t count = eps.size();
    std::vector<Mat3> bending(count);  // change of curvature under unit displacements of a control vertex
    std::vector<Mat3> stress(count);
    double area = 0;
    for (const ShellPoint& q : std::span(points_).subspan(first, per_triangle)) {
        const auto w = weights(q);
        for (std::size_t k = 0; k < count; ++k) {
            const Mat3 stretched = stretch(q, w[k].n_1, w[k].n_2);
            const Vec3 bent(w[k].n_11, w[k].n_22, 2 * w[k].n_12);
            for (std::size_t axis = 0; axis < 3; ++axis)
                bending[k].col(axis) = join(q, stretched.col(axis), q.normal[axis] * bent).bending;
            stress[k] = q.area * d * h * bending[k];
        }
        area += q.area;
        add([&](std::size_t i, std::size_t j) { return bending[i].transpose() * stress[j]; });
    }
    for (std::size_t k = 0; k < count; ++k) stress[k] = spec_.thickness * area * h * eps[k];
    add([&](std::size_t i, std::size_t j) { return eps[i].transpose() * stress[j]; });
}

/// Geometric stiffness of the pre-stress, and the load that follows the wall, at one point.
template <class Add>
void Shell::add_pressure(const ShellPoint& q, const Prestress& prestress, const Add& add) const
{
    const auto w = weights(q);
    const Vec3 n = prestress_in_frame(q, prestress, spec_.pressure);
    const Mat3 by_1 = -skew(q.e2), by_2 = skew(q.e1);
    add([&](std::size_t i, std::size_t j) {
        // the mesh faces the lumen: the volume's variation has the opposite sign of that with the outward normal
        const double geometric =
            n[0] * w[i].n_1 * w[j].n_1 + n[1] * w[i].n_2 * w[j].n_2 + n[2] * (w[i].n_1 * w[j].n_2 + w[i].n_2 * w[j].n_1);
        const Mat3 live = w[i].n * (w[j].n_1 * by_1 + w[j].n_2 * by_2) -
                                     w[j].n * (w[i].n_1 * by_1 + w[i].n_2 * by_2);  // + transpose; both are skew
        return q.area * (geometric * Mat3::Identity() + 0.5 * spec_.pressure * live);
    });
}

BlockPattern Shell::pattern() const
{
    std::vector<std::vector<std::int32_t>> stencils;
    for (std::size_t q = 0; q < points_.size(); q += per_triangle) {
        stencils.emplace_back();
        for (const Weight& w : weights(points_[q])) stencils.back().push_back(w.vertex);
    }
    return {static_cast<std::int32_t>(surface_.control().vertices.size()), stencils};
}

ShellMatrices Shell::assemble(const PrestressAt& prestress) const
{
    const std::size_t vertices = surface_.control().vertices.size();
    if (spec_.pressure != 0 && !prestress)
        throw Error(ErrorKind::BadScene,
                    "vessel.pressure_pa: expected 0 where the vessel has no axis (a plane, or no centreline was found); give "
                    "vessel.centreline");
    const BlockPattern pattern = this->pattern();
    std::vector<double> elastic(9 * pattern.block_count(), 0), pressure(spec_.pressure != 0 ? elastic.size() : 0, 0),
        area(pattern.block_count(), 0);
    for (std::size_t first = 0; first < points_.size(); first += per_triangle) {
        const std::span<const ShellPoint> points(points_.data() + first, per_triangle);
        const auto w = weights(points[0]);
        const StencilBlocks blocks(pattern, w);
        add_elastic(first, [&](const auto& block) { blocks.add<3>(elastic, w.size(), block); });
        for (const ShellPoint& q : points) {
            const auto n = weights(q);
            blocks.add<1>(area, n.size(),
                          [&](std::size_t i, std::size_t j) { return q.area * n[i].n * n[j].n; });
            if (spec_.pressure != 0)
                add_pressure(q, prestress(q.position), [&](const auto& block) { blocks.add<3>(pressure, n.size(), block); });
        }
    }
    ShellMatrices m;
    m.elastic = pattern.matrix(elastic, 3);
    m.pressure = spec_.pressure != 0 ? pattern.matrix(pressure, 3) : SparseMatrix(m.elastic.rows(), m.elastic.cols());
    m.area = pattern.matrix(area, 1);
    m.held.assign(vertices, 0);
    if (spec_.rims_held)
        for (std::size_t v = 0; v < vertices; ++v) m.held[v] = surface_.topology().kind[v] != LoopVertex::Inner;
    return m;
}

}  // namespace seldinger

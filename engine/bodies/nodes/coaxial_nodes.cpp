// Moments and torques of instruments that share a centreline, and what nodes/split.cpp asks of them.
#include "nodes/coaxial_nodes.h"

#include "nodes/adapt.h"
#include "rod/coaxial_stencil.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

using namespace coaxial;

namespace {

/// A complex curvature in the frame (n1, te x n1), as a vector along its binormal (the signs of rod/pair.h).
Vec3 as_vector(Complex kappa, const Stencil& s) { return kappa.real() * s.pair.te.cross(s.n1) - kappa.imag() * s.n1; }

/// dE/d(integrated curvature) of a cell: f S (f kappa - sum r_k).
Vec3 moment_of(const CoaxialCell& cell, const Stencil& s, int instruments)
{
    if (s.end || !(cell.covered > 0)) return Vec3::Zero();
    const double part = cell.covered / cell.length;
    Complex strain = part * s.kappa;
    for (int k = 0; k < instruments; ++k) strain -= s.phase[k] * cell.rest[k];
    return part / cell.compliance * as_vector(strain, s);
}

/// Torque of instrument k in a cell, dE/d(twist); 0 where it is not.
double torque_of(const CoaxialCell& cell, const Stencil& s, int k)
{
    if (s.end || !(cell.twist_covered[k] > 0)) return 0;
    const double part = cell.twist_covered[k] / cell.length;
    return part * part * s.twist[k] / cell.twist_compliance[k];
}

int count_in(const CoaxialCell& cell, int instruments)
{
    int count = 0;
    for (int k = 0; k < instruments; ++k) count += cell.twist_covered[k] > 0;
    return count;
}

/// Adds what instrument k's torques make of the tip's error.
void add_turning(const CoaxialShape& shape, int k, std::span<double> turning)
{
    const CoaxialRod& rod = shape.rod;
    const RodView& line = shape.line;
    const double tip = -rod.instrument[k].offset;
    const auto torque_at = [&](int i) { return torque_of(rod.cells[i], stencil_at(shape, i), k); };
    int end = 0;  // node whose distance from the tangent counts
    double last = 0, slope = 0;
    for (int i = 0; i + 1 < line.n; ++i) {
        const double next = torque_at(i + 1), after = (next - last) / line.rest_length[i];
        const CoaxialCell& cell = rod.cells[i];
        if (i > 0 && cell.twist_covered[k] > 0 && count_in(cell, rod.instruments) > 1) {
            const double from = std::max(tip, line.material_s[i] - longest_lever);
            while (end < i && line.material_s[end] < from) ++end;
            const double off = (line.pos(end) - line.pos(i)).cross(line.tangent(i)).norm();
            const double compliance = cell.twist_compliance[k] / cell.twist_covered[k];
            turning[i] += off * std::abs(after - slope) * compliance;
        }
        last = next, slope = after;
    }
}

}  // namespace

void measure_coaxial(const CoaxialShape& shape, std::span<Vec3> moment, std::span<double> turning)
{
    const CoaxialRod& rod = shape.rod;
    const RodView& line = shape.line;
    for (int i = 0; i < line.n; ++i)
        moment[i] = moment_of(rod.cells[i], stencil_at(shape, i), rod.instruments);
    std::fill_n(turning.begin(), line.n, 0.0);
    if (rod.instruments < 2) return;
    for (int k = 0; k < rod.instruments; ++k) add_turning(shape, k, turning);
}

void prepare_group(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod)
{
    const RodView line = rods.view(wires[0]);
    prepare_coaxial(rod, line);
    for (std::size_t k = 0; k < wires.size(); ++k) {
        const RodView own = rods.view(wires[k]);
        for (int j = 0; j < line.n - 1; ++j) own.spin_inertia[j] = rod.spin_inertia[k][j];
        if (k == 0) continue;
        for (int i = 0; i < line.n; ++i) {
            own.material_s[i] = line.material_s[i];
            own.rest_length[i] = line.rest_length[i];
            own.bend_stiffness[i] = line.bend_stiffness[i];
            own.radius[i] = rod.instrument[k].spec->shaft.radius;
            own.stretch_stiffness[i] = own.twist_stiffness[i] = own.mass[i] = 0;
            own.rest_kappa1[i] = own.rest_kappa2[i] = own.rest_twist[i] = 0;
        }
    }
}

CoaxialTrial accepted_trial(RodArrays& rods, std::span<const int> wires)
{
    const RodView line = rods.view(wires[0]);
    CoaxialTrial now{line.x, line.y, line.z, {}};
    for (std::size_t k = 0; k < wires.size(); ++k) now.theta[k] = rods.view(wires[k]).theta;
    return now;
}

void follow_line(RodArrays& rods, std::span<const int> wires)
{
    const RodView line = rods.view(wires[0]);
    for (const int w : wires.subspan(1)) {
        const RodView own = rods.view(w);
        for (int i = 0; i < line.n; ++i) {
            own.set_pos(i, line.pos(i));
            own.set_vel(i, line.vel(i));
            own.set_tangent(i, line.tangent(i));
            own.set_ref_d1(i, line.ref_d1(i));
            own.ax[i] = line.ax[i], own.ay[i] = line.ay[i], own.az[i] = line.az[i];
            own.ref_twist[i] = line.ref_twist[i];
            own.clamp_twist_a[i] = line.clamp_twist_a[i];
            own.clamp_twist_b[i] = 0;
        }
    }
}

CoaxialNodes::CoaxialNodes(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base,
                           RodFrames& frames)
    : RodNodes(rods, wires, {&sleeve_, 1}, false), rod_(rod), base_(base), frames_(frames), sleeve_(base.clamp(line().n))
{
}

double CoaxialNodes::stretch_stiffness(double begin, double end) const { return coaxial_stretch_stiffness(rod_, begin, end); }

void CoaxialNodes::refresh_rest(int) const { prepare_group(rods_, wires(), rod_); }

// At the tip, where nothing bends it: sum B_k R_k kappa_k / sum B_k. The hub is in its sleeve.
Vec3 CoaxialNodes::natural_at_end(int j) const
{
    if (j > 0) return Vec3::Zero();
    const RodView line = RodNodes::line();
    const double s = line.material_s[0] + 0.25 * line.rest_length[0];  // the middle of the tip's half cell
    const Vec3 t = line.tangent(0);
    Vec3 moment = Vec3::Zero();
    double stiffness = 0;
    for (int k = 0; k < instruments(); ++k) {
        const CoaxialInstrument& one = rod_.instrument[k];
        const double material = s + one.offset;
        if (material < 0) continue;
        const WireSection& section = one.spec->at(std::min(material, one.spec->length));
        const Vec3 n1 = turned(line.ref_d1(0), t, instrument(k).theta[0]);
        moment += section.bend_stiffness * (section.rest_curvature[0] * t.cross(n1) - section.rest_curvature[1] * n1);
        stiffness += section.bend_stiffness;
    }
    return stiffness > 0 ? Vec3(moment / stiffness) : Vec3::Zero();
}

bool CoaxialNodes::pull_at_base(SplitScratch& scratch, Vec3& pull, Vec3& tangent) const
{
    const RodView line = RodNodes::line();
    const int m = line.n - 2;
    const CoaxialTrial now = accepted_trial(rods_, wires());
    if (!update_coaxial(rod_, line, now, base_, frames_)) return false;
    const std::span<double> gradient = std::span(scratch.gradient).first(static_cast<std::size_t>(rod_.dofs().count(line.n)));
    std::fill(gradient.begin(), gradient.end(), 0.0);
    add_coaxial({rod_, line, now, base_, frames_}, gradient, nullptr, HessianMode::None);
    for (int c = 0; c < 3; ++c) pull[c] = gradient[rod_.dofs().position(m, c)];
    tangent = frames_.tangent[m];
    return true;
}

void CoaxialNodes::follow_line() const { seldinger::follow_line(rods_, wires()); }

}  // namespace seldinger

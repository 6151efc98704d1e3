// Energy of instruments that share a centreline and its derivatives, stencil by stencil, and what the hands feel.
//
// In a cell, with complex numbers for the two components of curvature in the frame midway between the edges' reference frames:
// phase_k = exp(i phi_k), phi_k the mean of the angles of instrument k on both edges, r_k = phase_k rest_k:
//     E = 1/2 S |f kappa - sum r_k|^2 + forced - sum_{k<l} Re(conj(phase_k) phase_l couple_kl),   S = 1/compliance
//       = S f^2 |kappa|^2/2 - sum S f kappa.r_k + sum_{k<l} Re(conj(phase_k) phase_l G_kl) + const,
//     G_kl = S conj(rest_k) rest_l - couple_kl
// The first two are rod/pair.h's; the third knows angles only.

#include "rod/coaxial.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

using Complex = CoaxialCell::Complex;

/// What a stencil's energy depends on.
struct Stencil {
    Pair pair;
    Vec3 n1 = Vec3::Zero();  // first director of the midway reference frame, at te
    Complex kappa;           // in it
    bool end = false;        // the tip's half cell: it has the curvature it likes, and only turning the instruments costs
    std::array<double, most_coaxial> phi{}, twist{};
    std::array<Complex, most_coaxial> phase{};
};

/// Gradient and Hessian of a stencil. What instruments have in common lies in `common`; of `own` count only what has an angle in
/// it.
struct StencilTerms {
    PairTerms common;
    std::array<PairTerms, most_coaxial> own;
    double cross[most_coaxial][most_coaxial] = {};  // each second derivative by an angle of k and one of l
};

Complex complex(const Eigen::Vector2d& v) { return {v[0], v[1]}; }
/// conj(a) b's real part is the scalar product.
double dot(Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); }

/// The sleeve, as a clamp of a wire: reference twist between it and the base edge is kept as that is.
RodClamp sleeve(const RodView& line, const CoaxialBase& base)
{
    RodClamp clamp;
    clamp.node = line.n - 1;
    clamp.spin = true;
    clamp.tangent = base.tangent;
    clamp.director = base.director;
    return clamp;
}

void set_angle(Stencil& s, int k, double phi)
{
    s.phi[k] = phi;
    s.phase[k] = {std::cos(phi), std::sin(phi)};
}

/// Of node i: inner, the hub with the clamp as hub-side partner, or the tip.
Stencil stencil_at(const CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialBase& base,
                   const CoaxialFrames& frames, int i)
{
    if (i == 0) {
        Stencil tip;
        tip.end = true;
        for (int k = 0; k < rod.instruments; ++k) set_angle(tip, k, trial.theta[k][0]);
        return tip;
    }
    const RodFrames& f = frames.line;
    const bool hub = i == line.n - 1;
    Stencil s;
    Pair& pair = s.pair;
    pair.te = f.tangent[i - 1];
    pair.tf = hub ? base.tangent : f.tangent[i];
    pair.inv_e = 1 / f.edge_length[i - 1];
    pair.inv_f = hub ? 0 : 1 / f.edge_length[i];
    pair.chi = hub ? one_plus_cos(pair.te, pair.tf) : f.chi[i];
    pair.kb = hub ? Vec3((2 / pair.chi) * pair.te.cross(pair.tf)) : f.kb[i];
    pair.q = curvature_q(line.curvature);
    const double ref_twist = hub ? f.clamp_ref_twist[0] : f.ref_twist[i];
    s.n1 = turned(f.d1[i - 1], pair.te, 0.5 * ref_twist);
    s.kappa = complex(kappa_in(pair, s.n1));
    for (int k = 0; k < rod.instruments; ++k) {
        const double a = trial.theta[k][i - 1], b = trial.theta[k][i];
        set_angle(s, k, 0.5 * (a + b));
        s.twist[k] = b - a + ref_twist;
    }
    return s;
}

/// f kappa - sum r_k
Complex bend_strain(const CoaxialCell& cell, const Stencil& s, int instruments)
{
    if (s.end) return 0;
    Complex strain = cell.covered / cell.length * s.kappa;
    for (int k = 0; k < instruments; ++k) strain -= s.phase[k] * cell.rest[k];
    return strain;
}

double cell_energy(const CoaxialCell& cell, const Stencil& s, int instruments)
{
    if (!(cell.covered > 0)) return 0;
    double energy = 0.5 / cell.compliance * std::norm(bend_strain(cell, s, instruments)) + cell.forced;
    for (int k = 0; k < instruments; ++k) {
        for (int l = k + 1; l < instruments; ++l) energy -= dot(s.phase[k], s.phase[l] * cell.couple[coaxial_pair(k, l)]);
        if (s.end || !(cell.twist_covered[k] > 0)) continue;
        const double twist = cell.twist_covered[k] / cell.length * s.twist[k];
        energy += 0.5 * twist * twist / cell.twist_compliance[k];
    }
    return energy;
}

/// d(cell_energy) when the integrals change by `rate`.
double cell_energy_rate(const CoaxialCell& cell, const CoaxialCell& rate, const Stencil& s, int instruments)
{
    if (!(cell.covered > 0)) return 0;
    const auto part_rate = [&](double covered, double gained) {
        return (gained - covered / cell.length * rate.length) / cell.length;
    };
    const Complex strain = bend_strain(cell, s, instruments);
    Complex strain_rate = part_rate(cell.covered, rate.covered) * s.kappa;  // of no account at the tip
    for (int k = 0; k < instruments; ++k) strain_rate -= s.phase[k] * rate.rest[k];
    double energy = (dot(strain, strain_rate) - 0.5 * std::norm(strain) * rate.compliance / cell.compliance) / cell.compliance;
    energy += rate.forced;
    for (int k = 0; k < instruments; ++k) {
        for (int l = k + 1; l < instruments; ++l) energy -= dot(s.phase[k], s.phase[l] * rate.couple[coaxial_pair(k, l)]);
        if (s.end || !(cell.twist_covered[k] > 0)) continue;
        const double twist = cell.twist_covered[k] / cell.length * s.twist[k], inv = 1 / cell.twist_compliance[k];
        energy += inv * twist * part_rate(cell.twist_covered[k], rate.twist_covered[k]) * s.twist[k];
        energy -= 0.5 * twist * twist * inv * inv * rate.twist_compliance[k];
    }
    return energy;
}

/// The term that knows angles only; exact, or its share that is never negative without what Gauss-Newton has.
void add_coupling(const CoaxialCell& cell, const Stencil& s, int k, int l, HessianMode mode, StencilTerms& out)
{
    const Complex product = std::conj(cell.rest[k]) * cell.rest[l] / cell.compliance;
    const Complex turning = std::conj(s.phase[k]) * s.phase[l], couple = cell.couple[coaxial_pair(k, l)];
    const Complex energy = turning * (product - couple);  // its real part
    const double slope = -0.5 * energy.imag();
    out.own[k].ga -= slope;
    out.own[k].gb -= slope;
    out.own[l].ga += slope;
    out.own[l].gb += slope;
    if (mode == HessianMode::None) return;
    const double second = 0.25 * (mode == HessianMode::Exact ? -energy.real() : std::max(0.0, (turning * couple).real()));
    for (PairTerms* own : {&out.own[k], &out.own[l]}) {
        own->aa += second;
        own->ab += second;
        own->bb += second;
    }
    out.cross[k][l] -= second;
}

/// Bending's positive semidefinite Hessian: the wire's, blended by how much natural curvature is felt (rod/pair.h), and for the
/// share (1 - blend) the angles' part of Gauss-Newton with the residual f kappa - sum r_k in the reference frame.
void add_bend_safe(const CoaxialCell& cell, const Stencil& s, int instruments, StencilTerms& out)
{
    const Pair& p = s.pair;
    const double part = cell.covered / cell.length, square = part * std::norm(s.kappa), stiffness = 1 / cell.compliance;
    Complex rest = 0;
    for (int k = 0; k < instruments; ++k) rest += s.phase[k] * cell.rest[k];
    double blend = 1;
    if (rest != 0.0) blend = square > 0 ? std::clamp(1 - dot(s.kappa, rest) / square, 0.0, 1.0) : 0.0;
    add_bend_hessian_safe(p, part * part * stiffness, blend, 1, out.common);
    if (blend == 1) return;

    const Vec3 tt = (p.te + p.tf) / p.chi, n2 = p.te.cross(s.n1);
    const Vec3 chi_e = p.inv_e * (p.tf - (p.chi - 1) * p.te), chi_f = p.inv_f * (p.te - (p.chi - 1) * p.tf);
    const double g = curvature_factor(p.q, p.chi), g1 = 0.25 * p.q / g, scaled = (1 - blend) * stiffness;
    for (int k = 0; k < instruments; ++k) {
        if (cell.rest[k] == 0.0) continue;
        const Complex turning = Complex(0, 1) * s.phase[k] * cell.rest[k];  // d r_k / d phi_k
        const FrameDot along(p, turning.real() * n2 - turning.imag() * s.n1, tt);
        const Vec3 e = (-0.5 * scaled * part) * (g * along.grad_e + (along.value * g1) * chi_e);
        const Vec3 f = (-0.5 * scaled * part) * (g * along.grad_f + (along.value * g1) * chi_f);
        PairTerms& own = out.own[k];
        own.ea += e;
        own.eb += e;
        own.fa += f;
        own.fb += f;
        for (int l = 0; l <= k; ++l) {
            const double second = 0.25 * scaled * dot(s.phase[k] * cell.rest[k], s.phase[l] * cell.rest[l]);
            if (l < k) {
                out.cross[l][k] += second;
                continue;
            }
            own.aa += second;
            own.ab += second;
            own.bb += second;
        }
    }
}

/// The tip's half cell: where its bending has relaxed, what forcing costs is left, of the angles of the first edge.
void add_end(const CoaxialCell& cell, const Stencil& s, int instruments, HessianMode mode, StencilTerms& out)
{
    for (int l = 0; l < instruments; ++l)
        for (int k = 0; k < l; ++k) {
            const Complex energy = std::conj(s.phase[k]) * s.phase[l] * cell.couple[coaxial_pair(k, l)];  // minus its real part
            out.own[k].gb -= energy.imag();
            out.own[l].gb += energy.imag();
            if (mode == HessianMode::None) continue;
            const double second = mode == HessianMode::Exact ? energy.real() : std::max(0.0, energy.real());
            out.own[k].bb += second;
            out.own[l].bb += second;
            out.cross[k][l] -= second;
        }
}

void add_cell(const CoaxialCell& cell, const Stencil& s, int instruments, HessianMode mode, StencilTerms& out)
{
    if (!(cell.covered > 0)) return;
    const double part = cell.covered / cell.length, stiffness = 1 / cell.compliance;
    add_bend_gradient(s.pair, part * part * stiffness, out.common);
    if (mode == HessianMode::Exact) add_bend_hessian_exact(s.pair, part * part * stiffness, out.common);
    for (int k = 0; k < instruments; ++k) {
        PairTerms& own = out.own[k];
        if (cell.rest[k] != 0.0) {
            const RestBend rest{cell.rest[k].real(), cell.rest[k].imag(), turned(s.n1, s.pair.te, s.phi[k])};
            add_rest_bend(s.pair, part * stiffness, rest, mode, own);
        }
        for (int l = k + 1; l < instruments; ++l)
            if (cell.rest[k] != 0.0 && cell.rest[l] != 0.0) add_coupling(cell, s, k, l, mode, out);
        if (!(cell.twist_covered[k] > 0)) continue;
        const double twist_part = cell.twist_covered[k] / cell.length;
        add_twist(s.pair, twist_part * twist_part / cell.twist_compliance[k], s.twist[k], mode, own);
    }
    if (mode == HessianMode::Projected) add_bend_safe(cell, s, instruments, out);
    for (int k = 0; k < instruments; ++k) {
        const PairTerms& own = out.own[k];
        out.common.ge += own.ge;
        out.common.gf += own.gf;
        out.common.ee += own.ee;
        out.common.ef += own.ef;
        out.common.ff += own.ff;
    }
}

// ---- where stencils go --------------------------------------------------------------------------------------------------------

void put_gradient(const CoaxialDofs& dofs, const StencilTerms& t, int i, bool hub, std::span<double> gradient)
{
    for (int c = 0; c < 3; ++c) {
        gradient[dofs.position(i - 1, c)] -= t.common.ge[c];
        gradient[dofs.position(i, c)] += t.common.ge[c] - t.common.gf[c];
        if (!hub) gradient[dofs.position(i + 1, c)] += t.common.gf[c];
    }
    for (int k = 0; k < dofs.instruments; ++k) {
        gradient[dofs.spin(i - 1, k)] += t.own[k].ga;
        gradient[dofs.spin(i, k)] += t.own[k].gb;
    }
}

/// Adds m to a block at (row, column), of blocks `width` wide.
void put(double* block, int width, int row, int column, const Mat3& m)
{
    for (int c = 0; c < 3; ++c)
        for (int d = 0; d < 3; ++d) block[(row + c) * width + column + d] += m(c, d);
}

/// Hessian of positions: e = x_i - x_{i-1}, f = x_{i+1} - x_i.
void put_positions(const PairTerms& t, int width, int i, bool hub, CoaxialHessian& hessian)
{
    put(hessian.block(i - 1, 0), width, 0, 0, t.ee);
    put(hessian.block(i - 1, 1), width, 0, 0, t.ef - t.ee);
    put(hessian.block(i, 0), width, 0, 0, t.ee - t.ef - t.ef.transpose() + t.ff);
    if (hub) return;
    put(hessian.block(i - 1, 2), width, 0, 0, -t.ef);
    put(hessian.block(i, 1), width, 0, 0, t.ef - t.ff);
    put(hessian.block(i + 1, 0), width, 0, 0, t.ff);
}

void put_angles(const StencilTerms& t, const CoaxialDofs& dofs, int i, bool hub, CoaxialHessian& hessian)
{
    const int width = dofs.per_node();
    double *first = hessian.block(i - 1, 0), *join = hessian.block(i - 1, 1), *second = hessian.block(i, 0);
    const auto both = [&](double* block, int p, int q, double value) {  // of a diagonal block
        block[p * width + q] += value;
        block[q * width + p] += value;
    };
    for (int k = 0; k < dofs.instruments; ++k) {
        const PairTerms& own = t.own[k];
        const int spin = CoaxialDofs::coordinates + k;
        for (int c = 0; c < 3; ++c) {
            both(first, c, spin, -own.ea[c]);
            join[c * width + spin] -= own.eb[c];
            join[spin * width + c] += own.ea[c] - own.fa[c];
            both(second, c, spin, own.eb[c] - own.fb[c]);
            if (hub) continue;
            hessian.block(i - 1, 2)[spin * width + c] += own.fa[c];
            hessian.block(i, 1)[spin * width + c] += own.fb[c];
        }
        first[spin * width + spin] += own.aa;
        join[spin * width + spin] += own.ab;
        second[spin * width + spin] += own.bb;
        for (int l = k + 1; l < dofs.instruments; ++l) {
            const int other = CoaxialDofs::coordinates + l;
            both(first, spin, other, t.cross[k][l]);
            both(join, spin, other, t.cross[k][l]);
            both(second, spin, other, t.cross[k][l]);
        }
    }
}

// ---- stretch (D1) -------------------------------------------------------------------------------------------------------------

double stretch_strain(const RodView& line, const CoaxialFrames& frames, int j)
{
    return (frames.line.edge_length[j] - line.rest_length[j]) / line.rest_length[j];
}

/// Energy 1/2 (covered strain)^2 / compliance, prepared as a stiffness of the whole edge (RodView::stretch_stiffness).
void add_stretch(const CoaxialDofs& dofs, const RodView& line, const CoaxialFrames& frames, int j, HessianMode mode,
                 std::span<double> gradient, CoaxialHessian* hessian)
{
    const Vec3 t = frames.line.tangent[j];
    const double force = line.stretch_stiffness[j] * stretch_strain(line, frames, j);
    for (int c = 0; c < 3 && !gradient.empty(); ++c) {
        gradient[dofs.position(j, c)] -= force * t[c];
        gradient[dofs.position(j + 1, c)] += force * t[c];
    }
    if (mode == HessianMode::None) return;
    const double lateral = (mode == HessianMode::Projected ? std::max(force, 0.0) : force) / frames.line.edge_length[j];
    const Mat3 block = lateral * Mat3::Identity() + (line.stretch_stiffness[j] / line.rest_length[j] - lateral) * outer(t, t);
    put(hessian->block(j, 0), dofs.per_node(), 0, 0, block);
    put(hessian->block(j, 1), dofs.per_node(), 0, 0, -block);
    put(hessian->block(j + 1, 0), dofs.per_node(), 0, 0, block);
}

/// The tip's half cell, into its place.
void put_end(const CoaxialDofs& dofs, const StencilTerms& t, std::span<double> gradient, CoaxialHessian* hessian)
{
    for (int k = 0; k < dofs.instruments; ++k) {
        if (!gradient.empty()) gradient[dofs.spin(0, k)] += t.own[k].gb;
        for (int l = 0; l < dofs.instruments && hessian; ++l)
            hessian->block(0, 0)[(3 + k) * dofs.per_node() + 3 + l] +=
                k == l ? t.own[k].bb : t.cross[std::min(k, l)][std::max(k, l)];
    }
}

}  // namespace

// ---- what is called from outside ----------------------------------------------------------------------------------------------

CoaxialHessian::CoaxialHessian(int nodes, int instruments) : width_(CoaxialDofs{instruments}.per_node())
{
    blocks_.resize(static_cast<std::size_t>(3 * nodes * width_ * width_));
}

void CoaxialHessian::reset(int nodes)
{
    nodes_ = nodes;
    SEL_ASSERT(static_cast<std::size_t>(3 * nodes * width_ * width_) <= blocks_.size());
    std::fill_n(blocks_.begin(), 3 * nodes * width_ * width_, 0.0);
}

double CoaxialHessian::at(int i, int j) const
{
    if (i > j) std::swap(i, j);
    const int node = i / width_, ahead = j / width_ - node;
    if (ahead > CoaxialDofs::reach) return 0;
    return blocks_[static_cast<std::size_t>(((3 * node + ahead) * width_ + i % width_) * width_ + j % width_)];
}

bool update_coaxial(const CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialBase& base,
                    CoaxialFrames& frames)
{
    for (int k = 0; k < rod.instruments; ++k)
        for (int j = 0; j < line.n; ++j)
            if (!std::isfinite(trial.theta[k][j])) return false;
    frames.line.material = false;  // each instrument has directors of its own
    const RodClamp clamp = sleeve(line, base);
    return update_frames(line, {trial.x, trial.y, trial.z, trial.theta[0]}, {&clamp, 1}, frames.line);
}

void accept_coaxial(CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialFrames& frames)
{
    for (int k = 0; k < rod.instruments; ++k) std::copy_n(trial.theta[k].begin(), line.n, rod.theta[k].begin());
    accept_frames(line, {trial.x, trial.y, trial.z, trial.theta[0]}, frames.line);
}

double coaxial_energy(const CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialBase& base,
                      const CoaxialFrames& frames)
{
    double energy = 0;
    for (int j = 0; j < line.n - 1; ++j) {
        const double strain = stretch_strain(line, frames, j);
        energy += 0.5 * line.stretch_stiffness[j] * strain * strain * line.rest_length[j];
    }
    for (int i = 0; i < line.n; ++i)
        energy += cell_energy(rod.cells[i], stencil_at(rod, line, trial, base, frames, i), rod.instruments);
    for (int k = 0; k < rod.instruments; ++k) {
        const double turn = base.hand[k] - trial.theta[k][line.n - 1];
        if (base.behind[k] > 0) energy += 0.5 * turn * turn / base.behind[k];
    }
    return energy;
}

void add_coaxial(const CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialBase& base,
                 const CoaxialFrames& frames, std::span<double> gradient, CoaxialHessian* hessian, HessianMode mode)
{
    const CoaxialDofs dofs = rod.dofs();
    if (!hessian) mode = HessianMode::None;
    SEL_ASSERT(mode == HessianMode::None || hessian->size() == dofs.count(line.n));
    for (int j = 0; j < line.n - 1; ++j) add_stretch(dofs, line, frames, j, mode, gradient, hessian);
    StencilTerms tip;
    add_end(rod.cells[0], stencil_at(rod, line, trial, base, frames, 0), rod.instruments, mode, tip);
    put_end(dofs, tip, gradient, mode == HessianMode::None ? nullptr : hessian);
    for (int i = 1; i < line.n; ++i) {
        const bool hub = i == line.n - 1;
        StencilTerms terms;
        add_cell(rod.cells[i], stencil_at(rod, line, trial, base, frames, i), rod.instruments, mode, terms);
        if (!gradient.empty()) put_gradient(dofs, terms, i, hub, gradient);
        if (mode == HessianMode::None) continue;
        put_positions(terms.common, dofs.per_node(), i, hub, *hessian);
        put_angles(terms, dofs, i, hub, *hessian);
    }
    const int end = line.n - 1;
    for (int k = 0; k < rod.instruments; ++k) {
        if (!(base.behind[k] > 0)) continue;
        if (!gradient.empty()) gradient[dofs.spin(end, k)] += (trial.theta[k][end] - base.hand[k]) / base.behind[k];
        const int spin = CoaxialDofs::coordinates + k;
        if (mode != HessianMode::None) hessian->block(end, 0)[spin * dofs.per_node() + spin] += 1 / base.behind[k];
    }
}

// ---- hands --------------------------------------------------------------------------------------------------------------------

namespace {

double stretch_stiffness_of(const CoaxialRod& rod, const std::array<const WireSection*, most_coaxial>& section)
{
    double sum = 0;
    for (int k = 0; k < rod.instruments; ++k) sum += section[k] ? section[k]->stretch_stiffness : 0;
    return sum;
}

/// What hands feel at a configuration.
struct HandForces {
    const CoaxialRod& rod;
    const RodView& line;
    const CoaxialTrial& trial;
    const CoaxialBase& base;
    const CoaxialFrames& frames;

    /// Energy per length that cell i gains when it gains `factor` of such material per length.
    [[nodiscard]] double cell_gain(int i, const CoaxialCell& rate) const
    {
        return cell_energy_rate(rod.cells[i], rate, stencil_at(rod, line, trial, base, frames, i), rod.instruments);
    }
    /// The same of an edge's stretching. @param grow  d(rest length)
    [[nodiscard]] double edge_gain(int j, double covered, double compliance, double grow) const
    {
        if (!(rod.stretch_covered[j] > 0)) return 0;
        const double strain = stretch_strain(line, frames, j), rest = line.rest_length[j], inv = 1 / rod.stretch_compliance[j];
        const double pull = rod.stretch_covered[j] * strain * inv;  // force
        return pull * (strain * covered - rod.stretch_covered[j] * (1 + strain) / rest * grow) - 0.5 * pull * pull * compliance;
    }

    /// At s material `right` takes the place of `left`, one length of it per length that it moves tipwards.
    [[nodiscard]] double change_gain(double s, const std::array<const WireSection*, most_coaxial>& left,
                                     const std::array<const WireSection*, most_coaxial>& right) const
    {
        const auto nodes = line.material_s.first(line.n);
        const int j = static_cast<int>(std::ranges::upper_bound(nodes, s) - nodes.begin()) - 1;  // edge it is on
        const int i = s < 0.5 * (nodes[j] + nodes[j + 1]) ? j : j + 1;                           // cell it is in
        const auto count = static_cast<std::size_t>(rod.instruments);
        CoaxialCell rate;
        rate.add({right.data(), count}, 1);
        rate.add({left.data(), count}, -1);
        const double stiff_l = stretch_stiffness_of(rod, left), stiff_r = stretch_stiffness_of(rod, right);
        const auto inverse = [](double stiffness) { return stiffness > 0 ? 1 / stiffness : 0; };
        const double covered = (stiff_r > 0 ? 1 : 0) - (stiff_l > 0 ? 1 : 0);
        return cell_gain(i, rate) + edge_gain(j, covered, inverse(stiff_r) - inverse(stiff_l), 0);
    }

    [[nodiscard]] double offset_force(int k) const
    {
        double force = 0;
        for (std::size_t p = 0; p + 1 < rod.pieces.size(); ++p) {
            const auto &left = rod.pieces[p].section, &right = rod.pieces[p + 1].section;
            if (left[k] == right[k]) continue;
            // where others change at the same place the two sides differ: the mean
            auto only_k = left, all_but_k = right;
            only_k[k] = right[k];
            all_but_k[k] = left[k];
            const double s = rod.pieces[p].end;
            force += only_k == right ? change_gain(s, left, right)
                                     : 0.5 * (change_gain(s, left, only_k) + change_gain(s, all_but_k, right));
        }
        return force;
    }

    /// Half of what is gained goes to the cell before the hub's, half to the hub's, whose other end moves on.
    [[nodiscard]] double line_force() const
    {
        const int hub = line.n - 1;
        const double middle = 0.5 * (line.material_s[hub - 1] + line.material_s[hub]);
        const auto holds = [&](const CoaxialPiece& piece) { return middle < piece.end; };
        const auto at_middle = std::ranges::find_if(rod.pieces, holds);
        const auto& in = at_middle == rod.pieces.end() ? rod.pieces.back().section : at_middle->section;
        const auto& fed = rod.pieces.back().section;
        const auto count = static_cast<std::size_t>(rod.instruments);
        CoaxialCell before, end;
        before.length = end.length = 0.5;
        before.add({in.data(), count}, 0.5);
        end.add({in.data(), count}, -0.5);
        end.add({fed.data(), count}, 1);
        const double stiffness = stretch_stiffness_of(rod, fed);
        double force = edge_gain(hub - 1, stiffness > 0 ? 1 : 0, stiffness > 0 ? 1 / stiffness : 0, 1) + cell_gain(hub, end);
        if (hub > 1) force += cell_gain(hub - 1, before);
        return force;
    }

    [[nodiscard]] double torque(int k) const
    {
        const int hub = line.n - 1;
        if (base.behind[k] > 0) return (base.hand[k] - trial.theta[k][hub]) / base.behind[k];
        StencilTerms terms;
        add_cell(rod.cells[hub], stencil_at(rod, line, trial, base, frames, hub), rod.instruments, HessianMode::None, terms);
        return terms.own[k].gb;
    }
};

}  // namespace

CoaxialHands coaxial_hands(const CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialBase& base,
                           const CoaxialFrames& frames)
{
    const HandForces forces{rod, line, trial, base, frames};
    CoaxialHands hands;
    hands.line_force = forces.line_force();
    for (int k = 0; k < rod.instruments; ++k) {
        hands.offset_force[k] = forces.offset_force(k);
        hands.torque[k] = forces.torque(k);
    }
    return hands;
}

}  // namespace seldinger

// Energy of instruments that share a centreline and its derivatives: stencils (rod/coaxial_stencil.h) put in their places.
#include "rod/coaxial_stencil.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

using namespace coaxial;

namespace {

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

/// Energy 1/2 (covered strain)^2 / compliance, prepared as a stiffness of the whole edge (RodView::stretch_stiffness).
void add_stretch(const CoaxialDofs& dofs, const RodView& line, const RodFrames& frames, int j, HessianMode mode,
                 std::span<double> gradient, CoaxialHessian* hessian)
{
    const Vec3 t = frames.tangent[j];
    const double force = line.stretch_stiffness[j] * stretch_strain(line, frames, j);
    for (int c = 0; c < 3 && !gradient.empty(); ++c) {
        gradient[dofs.position(j, c)] -= force * t[c];
        gradient[dofs.position(j + 1, c)] += force * t[c];
    }
    if (mode == HessianMode::None) return;
    const double lateral = (mode == HessianMode::Projected ? std::max(force, 0.0) : force) / frames.edge_length[j];
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

// ---- interface -----------------------------------------------------------------------------------------------------------------

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
                    RodFrames& frames)
{
    for (int k = 0; k < rod.instruments; ++k)
        for (int j = 0; j < line.n; ++j)
            if (!std::isfinite(trial.theta[k][j])) return false;
    SEL_ASSERT(!frames.material);
    const RodClamp clamp = base.clamp(line.n);  // reference twist between it and the base edge is kept as a wire's is
    return update_frames(line, {trial.x, trial.y, trial.z, trial.theta[0]}, {&clamp, 1}, frames);
}

double coaxial_energy(const CoaxialShape& shape)
{
    const auto& [rod, line, trial, base, frames] = shape;
    double energy = 0;
    for (int j = 0; j < line.n - 1; ++j) {
        const double strain = stretch_strain(line, frames, j);
        energy += 0.5 * line.stretch_stiffness[j] * strain * strain * line.rest_length[j];
    }
    for (int i = 0; i < line.n; ++i)
        energy += cell_energy(rod.cells[i], stencil_at(shape, i), rod.instruments);
    for (int k = 0; k < rod.instruments; ++k) {
        const double turn = base.hand[k] - trial.theta[k][line.n - 1];
        if (base.behind[k] > 0) energy += 0.5 * turn * turn / base.behind[k];
    }
    return energy;
}

void add_coaxial(const CoaxialShape& shape, std::span<double> gradient, CoaxialHessian* hessian, HessianMode mode)
{
    const auto& [rod, line, trial, base, frames] = shape;
    const CoaxialDofs dofs = rod.dofs();
    if (!hessian) mode = HessianMode::None;
    SEL_ASSERT(mode == HessianMode::None || hessian->size() == dofs.count(line.n));
    for (int j = 0; j < line.n - 1; ++j) add_stretch(dofs, line, frames, j, mode, gradient, hessian);
    StencilTerms tip;
    add_end(rod.cells[0], stencil_at(shape, 0), rod.instruments, mode, tip);
    put_end(dofs, tip, gradient, mode == HessianMode::None ? nullptr : hessian);
    for (int i = 1; i < line.n; ++i) {
        const bool hub = i == line.n - 1;
        StencilTerms terms;
        add_cell(rod.cells[i], stencil_at(shape, i), rod.instruments, mode, terms);
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

}  // namespace seldinger

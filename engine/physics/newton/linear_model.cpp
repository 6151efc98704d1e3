// Choice of the matrix, Levenberg-Marquardt shift, corrections.
#include "newton/linear_model.h"

#include "core/prefetch.h"

#include <algorithm>

namespace seldinger {

LinearModel::LinearModel(SystemProblem& problem)
    : problem_(problem), coupling_(problem.capacity()), shift_weight_(problem.capacity())
{
}

void LinearModel::start(bool shifted, double first_shift)
{
    unsymmetric_ = false;
    projected_steps_ = 0;
    shift = first_shift;
    if (shifted) set_shift_weights();
}

void LinearModel::prefetch() const { seldinger::prefetch(coupling_, problem_.size()); }

/// The shift's unit is B/L^3 per node, so that 1 doubles a cantilever's stiffness or so.
void LinearModel::set_shift_weights()
{
    for (const WireProblem* wire : problem_.solved()) {
        const RodView& rod = wire->rod;
        double length = 0, bend = 0;
        for (int j = 0; j < rod.n - 1; ++j) length += rod.rest_length[j];
        for (int i = 0; i < rod.n; ++i) bend = std::max(bend, rod.bend_stiffness[i]);
        const double unit = 3 * bend / (length * length * length * rod.n);
        double* weight = shift_weight_.data() + problem_.first_of(*wire);
        for (int i = 0; i < wire->size(); ++i)
            weight[i] = RodDofs::is_spin(i) ? unit * wire->length_scale * wire->length_scale : unit;
    }
}

// After a shortened step, the symmetric tangent, which goes downhill. Not with half of EA on the edges' mean directions and
// half on those of their ends, where a symmetric tangent is wrong.
void LinearModel::factorise(bool shortened, const ForceTerms& terms)
{
    bool loaded = problem_.unsymmetric();
    for (const WireProblem* wire : problem_.solved()) loaded = loaded || wire->terms.unsymmetric;
    const bool whole = loaded && (!shortened || problem_.conserving());
    projected_steps_ = shortened ? 0 : projected_steps_;
    unsymmetric_ = whole || projected_steps_ >= newton_constants.projected_in_a_row;
    const int indefinite = factorise_with(HessianMode::Exact, terms);
    if (indefinite == 0 || (projected_steps_ >= newton_constants.projected_in_a_row && indefinite < problem_.size())) return;
    ++projected_steps_;
    for (const WireProblem* wire : problem_.solved()) terms.make_positive(wire->wire);
    unsymmetric_ = whole;
    if (factorise_with(HessianMode::Projected, terms) < problem_.size() || !unsymmetric_) return;
    unsymmetric_ = false;
    (void)factorise_with(HessianMode::Projected, terms);
}

void LinearModel::factorise_shifted(const ForceTerms& terms)
{
    unsymmetric_ = problem_.unsymmetric();
    int raised = factorise_with(HessianMode::Exact, terms);
    for (int attempt = 0; attempt < newton_constants.most_shifts && raised > 0; ++attempt)
        raised = raise_shift(std::max(4 * shift, newton_constants.smallest_shift));
    if (raised > 0) (void)factorise_with(HessianMode::Projected, terms);
}

bool LinearModel::stable(const ForceTerms& terms)
{
    unsymmetric_ = problem_.unsymmetric();
    shift = newton_constants.smallest_shift;
    return factorise_with(HessianMode::Exact, terms) == 0;
}

int LinearModel::raise_shift(double larger)
{
    add_shift(larger - shift);
    shift = larger;
    return factorise_matrix();
}

/// @return pivots that were not positive; all of them when LU fails
int LinearModel::factorise_with(HessianMode mode, const ForceTerms& terms)
{
    problem_.assemble_tangent(mode, !unsymmetric_, terms);
    // prescribed unknowns move by a known amount, which loads the others
    BandedSolver& linear = problem_.linear;
    const int size = problem_.size();
    std::fill_n(coupling_.begin(), size, 0.0);
    for (int i = 0; i < size; ++i) {
        if (!problem_.prescribed[i] || problem_.trial[i] == problem_.prescribed_value[i]) continue;
        linear.add_column(i, problem_.prescribed_value[i] - problem_.trial[i], coupling_);
    }
    // spin angles that are left out take no part in the band's factors, and need not be fixed there
    for (int i = 0; i < size; ++i)
        if (problem_.prescribed[i] && !(problem_.without_spins() && RodDofs::is_spin(i))) linear.fix(i);
    add_shift(shift);
    return factorise_matrix();
}

/// The matrix as it stands. @return as factorise_with
int LinearModel::factorise_matrix()
{
    return unsymmetric_ ? problem_.linear.factor_unsymmetric() : problem_.linear.factor_symmetric();
}

void LinearModel::add_shift(double amount)
{
    if (amount == 0) return;
    for (int i = 0; i < problem_.size(); ++i)
        if (!problem_.prescribed[i]) problem_.linear.band.add(i, i, amount * shift_weight_[i]);
}

void LinearModel::correction(std::span<const double> residual, std::span<double> out, double prescribed_left)
{
    for (int i = 0; i < problem_.size(); ++i)
        out[i] = problem_.prescribed[i] ? problem_.prescribed_value[i] - problem_.trial[i]
                                        : -residual[i] - prescribed_left * coupling_[i];
    solve(out);
}

}  // namespace seldinger

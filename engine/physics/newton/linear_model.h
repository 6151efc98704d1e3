#pragma once
// The linear equations of a Newton iteration: which matrix is factorised, and which systems are solved with it.
//
// Takes the exact Hessian if its matrix is positive definite, else its projection to positive semidefinite stencils, contact's
// edges included (ridges pull a wire on that lies on them). After three
// full steps by the projected one it takes the exact one again, by LU: near the root that converges where the projected one
// crawls. With sliding friction, dead moments or energy-momentum steps the full, unsymmetric tangent and LU, which cost the same.
// Statics: a Levenberg-Marquardt shift on the diagonal, as little as makes the exact matrix positive definite.

#include "newton/options.h"
#include "newton/system_problem.h"

#include <vector>

namespace seldinger {

class LinearModel {
public:
    explicit LinearModel(SystemProblem& problem);

    /// @param shifted  for statics, starting from `shift`
    void start(bool shifted, double shift);
    void prefetch() const;

    /// Factors at the trial. @param shortened  the last step had to be: the symmetric tangent is taken, which goes downhill
    void factorise(bool shortened, const ForceTerms& terms);
    /// The same with as little shift as makes the exact matrix positive definite: then the direction goes down, and away from
    /// saddles. Under dead moments, which have no potential, as little as leaves its pivots positive.
    void factorise_shifted(const ForceTerms& terms);
    /// Whether the exact matrix at the trial is positive definite, but for a shift far below any real stiffness (a wire that
    /// nothing holds is neither).
    [[nodiscard]] bool stable(const ForceTerms& terms);
    /// More shift on the matrix that is assembled. @return pivots that are not positive
    int raise_shift(double larger);

    /// x = A^-1 b with the last factors.
    void solve(std::span<double> rhs_to_x) { problem_.linear.solve(rhs_to_x); }
    /// -A^-1 `residual` at the trial; prescribed unknowns go to their values.
    /// @param prescribed_left  how much of the prescribed unknowns' move at the base is still to be made
    void correction(std::span<const double> residual, std::span<double> out, double prescribed_left);
    /// Weights of the shift: it is a stiffness of weight * shift on each unknown.
    void set_shift_weights();
    [[nodiscard]] double shift_weight(int i) const { return shift_weight_[i]; }

    /// Full steps in a row with the projected Hessian.
    [[nodiscard]] int projected_steps() const { return projected_steps_; }
    void forget_projected_steps() { projected_steps_ = 0; }

    double shift = 0;  // [-] of the weights

private:
    [[nodiscard]] int factorise_with(HessianMode mode, const ForceTerms& terms);
    [[nodiscard]] int factorise_matrix();
    void add_shift(double amount);

    SystemProblem& problem_;
    bool unsymmetric_ = false;
    int projected_steps_ = 0;
    std::vector<double> coupling_;      // [unknowns] what the move of prescribed unknowns does to the others' equations
    std::vector<double> shift_weight_;  // [unknowns]
};

}  // namespace seldinger

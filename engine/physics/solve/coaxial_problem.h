#pragma once
// The equations of instruments that share a centreline (solve/coaxial_group.h): their elastic forces and tangent (rod/coaxial.h)
// in the unknowns of the system, and how passengers follow the line.
//
// A passenger's positions are no unknowns: they are the line's at every trial, x_k = x. A force f_k(x_k, theta_k) on it is one on
// (x, theta_k). Its positions' part of residual and tangent is added to the line's, and between the line's positions and its own
// angles there are entries far from the band.

#include "math/banded_solver.h"
#include "solve/coaxial_group.h"
#include "solve/wire_problem.h"

#include <span>

namespace seldinger {

class CoaxialProblem {
public:
    /// @param wires  the group's, in its order
    CoaxialProblem(CoaxialGroup& group, std::vector<WireProblem*> wires);

    [[nodiscard]] WireProblem& line() const { return *wires_.front(); }
    /// After the wires have begun: prescribed angles, and what passengers take over from the line.
    void begin();
    /// Takes a passenger's positions from the line, at the trial.
    void mirror();
    /// Elastic forces at the trial into the wires' residuals, and the torques of dead moments on passengers' spins.
    void add_residual();
    /// Forces on passengers' positions go to the line's.
    void fold_residual();
    /// So does what these may be off by.
    void fold_rounding() const;
    /// Elastic tangent into band and far entries of the system. @param all  start of the system's vector of unknowns
    /// @param symmetric  the symmetric part of what dead moments do
    void add_tangent(HessianMode mode, bool symmetric, const double* all, BandMatrix& band, FarEntries& far);
    /// The same of what force terms have put into passengers' tangents.
    void fold_tangent(const BandMatrix& of_terms, const double* all, BandMatrix& band, FarEntries& far) const;
    /// The same of unknowns beside the band that passengers' positions are joined with.
    void fold_condensed(const double* all, Condensed& condensed) const;
    /// Positions and frames of the line into the passengers' arrays, once the line's are the accepted ones.
    void commit();

    /// At the trial [J].
    [[nodiscard]] double energy() const;
    /// Elastic force at the trial times the move of the step, but for clamps that are turned [J].
    [[nodiscard]] double strain_work();
    [[nodiscard]] CoaxialHands hands() const;

private:
    [[nodiscard]] CoaxialTrial trial() const;
    /// @param at  outlives it
    [[nodiscard]] CoaxialShape shape(const CoaxialTrial& at) const
    {
        return {group_.rod, line().rod, at, group_.base, line().frames};
    }
    void evaluate();
    void add_moments(bool symmetric, const double* all, FarEntries& far) const;

    CoaxialGroup& group_;
    std::vector<WireProblem*> wires_;  // in the group's order
    CoaxialHessian hessian_;
    std::vector<double> gradient_;       // [unknowns of CoaxialDofs]
    mutable std::vector<double> trial_;  // the trial as separate x, y, z, angles
};

}  // namespace seldinger

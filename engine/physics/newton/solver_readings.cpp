// Readings of a solve, per wire.
#include "newton/solver_work.h"

#include <algorithm>

namespace seldinger {

const WireProblem& Solver::problem_of(int wire) const { return work_[system_of_[wire]]->newton.problem.wire(wire); }

const RodFrames& Solver::frames(int wire) const { return problem_of(wire).frames; }

const TrialState& Solver::trial() const { return trial_; }

double Solver::reaction(int wire, int unknown) const { return problem_of(wire).q.residual[unknown]; }

double Solver::compliance(int wire, int node, const Vec3& direction)
{
    if (spec_.scheme == Scheme::Linearised || spec_.scheme == Scheme::Explicit) return 0;
    NewtonSystem& newton = newton_of(system_of_[wire]);
    SystemProblem& problem = newton.problem;
    const auto solved = problem.solved();
    const auto is_wire = [&](const WireProblem* p) { return p->wire == wire; };
    const auto found = std::find_if(solved.begin(), solved.end(), is_wire);
    if (found == solved.end() || node >= (*found)->rod.n || problem.linear.band.size() != problem.size()) return 0;
    const int at = problem.map.position(static_cast<int>(found - solved.begin()), node, 0);
    response_.assign(static_cast<std::size_t>(problem.size()), 0.0);
    for (int k = 0; k < 3; ++k) response_[at + k] = direction[k];
    problem.linear.solve(response_);
    double along = 0;
    for (int k = 0; k < 3; ++k) along += response_[at + k] * direction[k];
    return along;
}

double Solver::base_tension_excess(int wire) const { return problem_of(wire).base_tension_excess; }

Vec3 Solver::load_force(int wire) const { return problem_of(wire).load_force(); }

double Solver::displacement(int wire, int unknown) const
{
    const WireUnknowns& q = problem_of(wire).q;
    return q.trial[unknown] - q.start[unknown];
}

double Solver::residual_work(int wire) const
{
    const WireUnknowns& q = problem_of(wire).q;
    double work = 0;
    for (std::size_t i = 0; i < q.trial.size(); ++i)
        if (!q.prescribed[i]) work += q.residual[i] * (q.trial[i] - q.start[i]);
    return work;
}

Vec3 Solver::force_left(int wire, int node) const
{
    const WireUnknowns& q = problem_of(wire).q;
    Vec3 force;
    for (int c = 0; c < RodDofs::coordinates; ++c) {
        if (q.prescribed[RodDofs::position(node, c)]) return Vec3::Zero();
        force[c] = q.residual[RodDofs::position(node, c)];
    }
    return force;
}

StepLosses Solver::losses(int wire) const { return work_[system_of_[wire]]->newton.problem.losses(problem_of(wire)); }

CoaxialHands Solver::coaxial_hands(int line) const { return work_[system_of_[line]]->newton.problem.coaxial_hands(line); }

double Solver::elastic_energy(int wire) const
{
    return work_[system_of_[wire]]->newton.problem.elastic_energy(problem_of(wire));
}

double Solver::kinetic_energy(int wire) const
{
    const RodView rod = rods_.view(wire);
    double twice = 0;
    for (int i = 0; i < rod.n; ++i) twice += rod.mass[i] * rod.vel(i).squaredNorm();
    for (int j = 0; j < rod.n - 1; ++j) twice += rod.spin_inertia[j] * rod.spin_rate[j] * rod.spin_rate[j];
    return 0.5 * twice;
}

double Solver::potential_energy(int wire) const
{
    const RodView rod = rods_.view(wire);
    double energy = 0;
    for (int i = 0; i < rod.n; ++i) energy -= rod.mass[i] * gravity_.dot(rod.pos(i));
    return energy;
}

}  // namespace seldinger

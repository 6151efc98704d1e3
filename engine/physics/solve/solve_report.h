#pragma once
// Report on the solve of a wire.

namespace seldinger {

struct SolveReport {
    bool converged = true;
    bool non_finite = false;
    bool best_effort = false;  // the tolerance was not met: this is the last trial that was taken (see Solver::set_best_effort)
    bool cut_short = false;    // likewise, because its time was up (see Solver::cut_when)
    int iterations = 0;        // Newton iterations
    int evaluations = 0;       // residual evaluations, line search included
    double residual = 0;       // largest force residual left on a free unknown [N]; moments over the mean edge length
    double tolerance = 0;      // that it was compared with [N]: IntegratorSpec::tolerance * force_scale + rounding noise
    double force_scale = 0;    // largest of weight, loads, stretched links, B/L^2 (wire_scales.cpp) [N]
};

/// Energy of one step from other sources than external forces [J].
struct StepLosses {
    double strain_work = 0;  // elastic force at the end times the move: what backward Euler makes of the change of elastic energy
    double inertia = 0;      // (1/2) m (v - v_0)^2: what backward Euler takes of the kinetic one
    double damping = 0;      // by mass and stiffness
};

}  // namespace seldinger

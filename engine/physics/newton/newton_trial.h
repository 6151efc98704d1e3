#pragma once
// What became of one trial of Newton's method: told to those who look for slow steps (bench/late_steps.cpp).

namespace seldinger {

struct NewtonTrial {
    enum class End {
        Taken,    // it is the base of a new direction
        Refused,  // not admissible, or not finite: a force term does not allow it
        TooLong,  // neither test of acceptance.h holds: a shorter one follows
        Solved,   // the equations hold
        Settled,  // at a kink or a jump: the position is known, the equations do not hold
        GivenUp,  // nothing left to try
    };
    End end = End::Taken;
    int iteration = 0;       // of the direction that led to it; 0: the first guess
    double residual = 0;     // of the tolerance [-]; of the last one that was evaluated where the trial was refused
    bool projected = false;  // the direction is that of a Hessian made positive
};

}  // namespace seldinger

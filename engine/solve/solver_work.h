#pragma once
// What the solver keeps per wire; private to solve/.

#include "solve/newton.h"
#include "solve/newton_wire.h"

namespace seldinger {

struct Solver::Work {
    Work(int capacity, const IntegratorSpec& spec) : newton(capacity, spec) {}
    NewtonWire newton;
};

}  // namespace seldinger

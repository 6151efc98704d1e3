#pragma once
// What the solver keeps per wire; private to solve/.

#include "core/parallel.h"
#include "solve/newton.h"
#include "solve/newton_wire.h"

namespace seldinger {

struct Solver::Work {
    Work(int capacity, const IntegratorSpec& spec) : newton(capacity, spec) {}
    NewtonWire newton;
};

/// Scratch of the threads.
struct Solver::Workspaces {
    explicit Workspaces(int most_nodes) : capacity(most_nodes) { provide(); }
    /// One for each thread that may take part in a loop that begins here. Allocates when these are more than ever before.
    void provide()
    {
        while (static_cast<int>(of_thread.size()) < thread_slot_count())
            of_thread.push_back(std::make_unique<WireProblem::Workspace>(capacity));
    }
    [[nodiscard]] WireProblem::Workspace& here() { return *of_thread[thread_slot()]; }
    int capacity;  // nodes of the longest wire
    std::vector<std::unique_ptr<WireProblem::Workspace>> of_thread;
};

}  // namespace seldinger

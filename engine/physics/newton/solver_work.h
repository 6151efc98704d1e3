#pragma once
// The solver's data per system, and the loop over systems; private to newton/.

#include "core/parallel.h"
#include "newton/newton_system.h"
#include "newton/solver.h"

namespace seldinger {

struct Solver::Work {
    Work(int first_wire, std::span<const int> capacities, const IntegratorSpec& spec) : newton(first_wire, capacities, spec) {}
    NewtonSystem newton;
};

/// Scratch of the threads.
struct Solver::Workspaces {
    explicit Workspaces(int most_nodes) : capacity(most_nodes) { provide(); }
    /// One for each thread that may take part in a loop that begins here. Allocates when these are more than ever before.
    void provide()
    {
        while (static_cast<int>(of_thread.size()) < thread_slot_count())
            of_thread.push_back(std::make_unique<SystemProblem::Workspace>(capacity));
    }
    [[nodiscard]] SystemProblem::Workspace& here() { return *of_thread[thread_slot()]; }
    int capacity;  // nodes of the largest system
    std::vector<std::unique_ptr<SystemProblem::Workspace>> of_thread;
};

void Solver::for_each_system(SolveStage stage, const auto& body)
{
    for_each_piece(system_count(), wire_grain, [&](int begin, int end) {
        // what begins is laid out anew: the first system of the next piece may be another thread's, which is at it
        const int in_order = stage == SolveStage::Begin ? end : system_count();
        for (int s = begin; s < end; ++s) {
            prefetch_after(s, in_order, stage);
            body(s);
        }
    });
}

}  // namespace seldinger

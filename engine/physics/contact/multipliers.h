#pragma once
// The outer loop of augmented, constraint and impulse (D8): Newton solves with fixed multipliers, then these are updated, until
// none changes by more than the length allowed. The laws and the update are in kernels/shared/multiplier_law.h and
// multipliers.h.

#include "contact/quadrature.h"
#include "contact/quadrature_buffers.h"

namespace seldinger {

class Multipliers {
public:
    Multipliers(device::Context& context, int points);

    /// The next evaluation is the first of a solve: multipliers start from the last accepted step.
    void begin() { fresh_ = true; }
    /// Before an evaluation. @param par  of the evaluation: the stiffness of a multiplier follows the step
    void before_evaluation(device::Queue at, ContactParams par, const QuadratureBuffers& buffers);
    /// Multipliers after a solve, for wires with solved[w]. Multipliers outside the tolerance get new values, and again[w] = 1.
    /// @return whether any did
    bool update(device::Queue at, ContactParams par, const QuadratureBuffers& buffers, const QuadratureSet& points,
                std::span<const std::uint8_t> solved, std::span<std::uint8_t> again);
    /// [points][2], for contact_evaluate
    [[nodiscard]] const device::Buffer& states() const { return states_; }
    void warm_up(device::Queue at, ContactParams none, const QuadratureBuffers& buffers);

private:
    device::Context& context_;
    std::size_t points_;
    bool fresh_ = true;
    device::Kernel start_, next_;
    device::Buffer states_, next_states_, ratio_buffer_;
    std::vector<real> ratios_;
};

}  // namespace seldinger

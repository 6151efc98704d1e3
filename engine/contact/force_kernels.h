#pragma once
// The kernels that make forces of quadrature points (kernels/contact/evaluation.cl): one where an item is a work-group, that is on a
// CPU; else a chain of stages over the points that are not clear of the wall (kernels/shared/contact_stages.h). The bits are the same.

#include "device/device.h"

#include <string>
#include <vector>

namespace seldinger {

/// Memory of the stages of `points` points; little where an item is a work-group, which has no stages.
[[nodiscard]] device::Buffer stage_records(device::Context& context, std::size_t points);

class ForceKernels {
public:
    /// @param program  with contact/evaluation.cl     points  listed at most     rolling  whether some model rolls: has a stage of its own
    ForceKernels(device::Context& context, const std::string& program, std::size_t points, bool rolling);

    /// @param arguments  SEL_FORCE_ARGUMENTS of evaluation.cl
    template <class... Arguments>
    void launch(device::Queue queue, std::size_t items, const Arguments&... arguments)
    {
        if (stages_.empty()) return whole_.launch(queue, items, arguments...);
        if (items == 0) return;
        context_->write(queue, todo_, &nothing_, sizeof nothing_);
        for (Stage& stage : stages_) stage.kernel.launch(queue, items, arguments..., records_, todo_, stage.side);
    }
    /// Launches of one evaluation.
    [[nodiscard]] std::size_t launches() const { return stages_.empty() ? 1 : stages_.size(); }

private:
    struct Stage {
        device::Kernel kernel;
        cl_uint side;
    };
    static constexpr cl_uint nothing_ = 0;
    device::Context* context_;
    device::Kernel whole_;
    std::vector<Stage> stages_;
    device::Buffer records_, todo_;
};

}  // namespace seldinger

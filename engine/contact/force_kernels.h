#pragma once
// Kernels that are one where an item is a work-group, that is on a CPU; else a chain of stages, the later ones over the items that the
// first has put on a list. The bits are the same.
//   ForceKernels       forces of quadrature points (kernels/contact/evaluation.cl, kernels/shared/contact_stages.h)
//   InstrumentKernels  forces between instruments (kernels/contact/instruments.cl, kernels/shared/instrument_stages.h)

#include "device/device.h"

#include <string>
#include <vector>

namespace seldinger {

/// Memory of the stages of `points` points; little where an item is a work-group, which has no stages.
[[nodiscard]] device::Buffer stage_records(device::Context& context, std::size_t points);

/// A whole kernel, or its stages.
class StagedKernel {
public:
    /// @param arguments  of the whole; stages have three more: records, list, side
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

protected:
    struct Stage {
        device::Kernel kernel;
        cl_uint side;
    };
    StagedKernel(device::Context& context, const std::string& program, const char* whole);
    [[nodiscard]] bool is_whole() const;
    void add(const char* name, cl_uint side = 0);

    device::Context* context_;
    std::string program_;
    device::Kernel whole_;
    std::vector<Stage> stages_;
    device::Buffer records_, todo_;

private:
    static constexpr cl_uint nothing_ = 0;
};

class ForceKernels : public StagedKernel {
public:
    /// @param program  with contact/evaluation.cl     points  listed at most     rolling  some model rolls, which is a separate stage
    ForceKernels(device::Context& context, const std::string& program, std::size_t points, bool rolling);
};

class InstrumentKernels : public StagedKernel {
public:
    /// @param program  with contact/instruments.cl
    InstrumentKernels(device::Context& context, const std::string& program);
    /// Items for so many slots.
    [[nodiscard]] std::size_t items(std::size_t slots) const;
    /// Before a launch over so many slots.
    void provide(std::size_t slots);
};

}  // namespace seldinger

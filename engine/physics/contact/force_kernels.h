#pragma once
// Kernels that are one where an item is a work-group, that is on a CPU; else a chain of stages, the later ones over the items
// that the first has put on a list. The bits are the same.
//   ForceKernels       forces of quadrature points (kernels/contact/evaluation.cl, kernels/shared/contact_stages.h)
//   GapKernels         gaps of quadrature points: contact_clearance, or the stages of forces that find the wall
//   InstrumentKernels  forces between instruments (kernels/contact/instruments.cl, kernels/shared/instrument_slot.h)

#include "device/device.h"

#include <string>
#include <vector>

namespace seldinger {

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
    void add_geometry();
    /// Memory of the stages of `points` quadrature points.
    void provide_records(std::size_t points);

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
    /// @param program  with contact/evaluation.cl     points  listed at most     rolling  some model rolls, which is a separate
    /// stage
    ForceKernels(device::Context& context, const std::string& program, std::size_t points, bool rolling);
};

class GapKernels : public StagedKernel {
public:
    /// @param points  listed at most
    GapKernels(device::Context& context, std::size_t points);
    /// Gaps of the quadrature points in `list`, where `nodes` are: kernels/contact/barrier_path.cl.
    template <class Params, class Wall, class Nodes>
    void launch(device::Queue queue, std::size_t items, const Params& par, const device::Buffer& list,
                const device::Buffer& models, const device::Buffer& places, const device::Buffer& near_cells,
                const device::Buffer& counts, const Wall& wall, const Nodes& nodes, const device::Buffer& states_t0,
                const device::Buffer& gaps)
    {
        const auto with = [&](const auto&... more) {
            StagedKernel::launch(queue, items, par, list, models, places, near_cells, counts, wall, nodes, more...);
        };
        if (launches() == 1) return with(states_t0, gaps);
        // moves of nothing; and these stages touch no states, forces, multipliers, clearances or memories
        with(nodes, states_t0, states_t0, gaps, gaps, states_t0, states_t0, states_t0);
    }
};

class InstrumentKernels : public StagedKernel {
public:
    enum class Of { Others, Itself };  // with what an instrument is in contact
    /// @param program  with contact/instruments.cl
    InstrumentKernels(device::Context& context, const std::string& program, Of of);
    /// Before a launch over so many slots.
    void provide(std::size_t slots);

private:
    Of of_;
};

// Kernels of contact between instruments, compiled before a run needs them.

/// On both queues of the device, as `seldinger devices` numbers it; -1: the default.
void warm_instrument_kernels(int device_index);

}  // namespace seldinger

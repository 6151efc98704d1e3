// Launches of every kernel on the load; compiled in double and in float, see kernel_bench_load.h.
#include "roofline/kernel_bench_load.h"

namespace {

using sel_bench::ForceKernels;
using sel_bench::GapKernels;
using sel_bench::KernelBenchOptions;
using sel_bench::KernelTiming;
using sel_device::Buffer;
using sel_device::Context;
using sel_device::Kernel;
using sel_device::Queue;

template <class T>
Buffer upload(Context& context, const std::vector<T>& from)
{
    Buffer buffer(context, std::max<std::size_t>(from.size(), 1) * sizeof(T));
    context.enter(Queue::Inline);
    context.write(Queue::Inline, buffer, from.data(), from.size() * sizeof(T));
    context.finish(Queue::Inline);
    return buffer;
}

/// Buffers of a wall or of nodes, as one argument of a launch.
struct Together {
    const Buffer &first, &second, &third;
    template <class F>
    void for_each_argument(const F& f) const
    {
        f(first);
        f(second);
        f(third);
    }
};

/// Everything that the kernels take, on the device.
class Bench {
public:
    Bench(Context& context, const BenchWall& wall, std::size_t points, Queue queue, const KernelBenchOptions& options,
          const std::vector<KernelWork>& work, std::vector<KernelTiming>& out)
        : context_(context),
          load_(wall, points),
          queue_(queue),
          options_(options),
          work_(work),
          out_(out),
          n_(load_.models.size()),
          tree_(upload(context, load_.nodes)),
          vertices_(upload(context, wall.vertices)),
          boundary_(upload(context, wall.boundary)),
          hi_(upload(context, load_.hi)),
          lo_(upload(context, load_.lo)),
          theta_(upload(context, load_.theta)),
          hi_t0_(upload(context, load_.hi_t0)),
          lo_t0_(upload(context, load_.lo_t0)),
          theta_t0_(upload(context, load_.theta_t0)),
          models_(upload(context, load_.models)),
          places_(upload(context, load_.places)),
          list_(upload(context, load_.list)),
          first_(upload(context, load_.first)),
          states_t0_(upload(context, load_.states_t0)),
          states_(upload(context, load_.states_t0)),
          multipliers_(upload(context, load_.multipliers)),
          next_multipliers_(upload(context, load_.multipliers)),
          candidates_(context, n_ * slots * sizeof(uint)),
          counts_(context, n_ * sizeof(uint)),
          forces_(context, n_ * sizeof(ContactForce)),
          barys_(context, n_ * sizeof(real)),
          ratios_(context, n_ * sizeof(real)),
          found_(context, n_ * sizeof(uint)),
          clearances_(context, n_ * sizeof(Clearance)),
          memories_(context, n_ * sizeof(WallMemory))
    {
        context_.enter(queue);
    }

    void capsule()
    {
        ContactParams par = load_.par;
        par.item_count = static_cast<uint>(n_);
        const std::size_t record = sizeof(QuadratureModel) + sizeof(QuadraturePlace), states = 4 * sizeof(ContactState);
        const double pairs = per_item("contact_evaluate").pairs, lists = pairs * 2 * sizeof(uint);
        run("near_wall.cl", "contact_find", n_, record + 2 * sizeof(uint) + lists / 2, [&](Kernel& k) {
            k.launch(queue_, n_, par, real(slack), list_, models_, places_, hi_, lo_, theta_, tree_, vertices_, boundary_,
                     candidates_, counts_, found_, clearances_);
        });
        run("near_wall.cl", "contact_distance", n_, sizeof(QuadraturePlace) + sizeof(uint) + sizeof(real), [&](Kernel& k) {
            k.launch(queue_, n_, static_cast<uint>(n_), real(1), list_, places_, hi_, lo_, theta_, tree_, vertices_, boundary_,
                     ratios_);
        });
        ForceKernels forces(context_, "contact/evaluation.cl", n_, true);
        time(forces, "contact_evaluate", n_, record + states + sizeof(ContactForce) + sizeof(real) + lists, [&](ForceKernels& k) {
            k.launch(queue_, n_, par, list_, models_, places_, candidates_, counts_, tree_, vertices_, boundary_, hi_, lo_,
                     theta_, hi_t0_, lo_t0_, theta_t0_, states_t0_, states_, forces_, barys_, multipliers_, clearances_,
                     memories_);
        });
        const std::size_t edges = load_.layer_edges.size();
        const Buffer sums(context_, edges * sizeof(EdgeForce));
        run("edge_sums.cl", "contact_reduce", edges, samples_per_edge * (sizeof(ContactForce) + sizeof(real)) + sizeof(EdgeForce),
            [&](Kernel& k) { k.launch(queue_, edges, static_cast<uint>(edges), first_, forces_, barys_, sums); });
        par.normal_law = SEL_NORMAL_AUGMENTED;
        run("multipliers.cl", "contact_start", n_, record + states / 2 + 2 * sizeof(MultiplierState),
            [&](Kernel& k) { k.launch(queue_, n_, par, models_, places_, states_t0_, next_multipliers_); });
        run("multipliers.cl", "contact_multipliers", n_, record + states + 4 * sizeof(MultiplierState), [&](Kernel& k) {
            k.launch(queue_, n_, par, models_, places_, counts_, states_t0_, states_, multipliers_, next_multipliers_, ratios_);
        });
        par.normal_law = SEL_NORMAL_BARRIER;
        GapKernels gaps(context_, n_);
        time(gaps, "contact_clearance", n_, record + states / 2 + lists, [&](GapKernels& k) {
            k.launch(queue_, n_, par, list_, models_, places_, candidates_, counts_, Together{tree_, vertices_, boundary_},
                     Together{hi_, lo_, theta_}, states_t0_, ratios_);
        });
        run("barrier_path.cl", "contact_sweep", n_, record + lists, [&](Kernel& k) {
            k.launch(queue_, n_, par, list_, models_, places_, candidates_, counts_, tree_, vertices_, boundary_, hi_t0_, lo_t0_,
                     theta_t0_, hi_, lo_, theta_, ratios_);
        });
    }

    void layer()
    {
        const std::size_t edges = load_.layer_edges.size();
        const Buffer edge_list = upload(context_, load_.layer_edges);
        const Buffer counts(context_, edges * sizeof(uint)), touching(context_, edges * sizeof(real));
        context_.enter(queue_);
        ContactParams par = load_.par;
        par.item_count = static_cast<uint>(edges);
        run("layer.cl", "layer_find", edges, sizeof(LayerEdge) + sizeof(uint) + sizeof(real), [&](Kernel& k) {
            k.launch(queue_, edges, par, edge_list, hi_, lo_, theta_, tree_, vertices_, boundary_, candidates_, counts, touching);
        });
        std::vector<uint> how_many(edges), found(edges * slots);
        context_.read(queue_, counts, how_many.data(), edges * sizeof(uint));
        context_.read(queue_, candidates_, found.data(), found.size() * sizeof(uint));
        std::vector<LayerPair> pairs;
        for (std::size_t e = 0; e < edges; ++e)
            for (uint k = 0; k < std::min(how_many[e], slots) && pairs.size() < n_; ++k)
                pairs.push_back({static_cast<uint>(e), found[e * slots + k], static_cast<uint>(pairs.size()), 0});
        if (pairs.empty()) return;
        const Buffer pair_list = upload(context_, pairs);
        context_.enter(queue_);
        par.item_count = static_cast<uint>(pairs.size());
        run("layer.cl", "layer_evaluate", pairs.size(),
            sizeof(LayerPair) + sizeof(LayerEdge) + 2 * sizeof(ContactState) + sizeof(ContactForce), [&](Kernel& k) {
                k.launch(queue_, pairs.size(), par, pair_list, edge_list, tree_, vertices_, boundary_, hi_, lo_, theta_, hi_t0_,
                         lo_t0_, theta_t0_, states_t0_, states_, forces_, barys_);
            });
    }

private:
    [[nodiscard]] const KernelWork& per_item(const char* kernel) const { return work_of(work_, kernel); }

    /// @param bytes  of an item beside the floats that were counted
    template <class Launch>
    void run(const char* file, const char* name, std::size_t items, double bytes, const Launch& launch)
    {
        Kernel kernel(context_, std::string("contact/") + file, name);
        time(kernel, name, items, bytes, launch);
    }

    template <class Kernels, class Launch>
    void time(Kernels& kernels, const char* name, std::size_t items, double bytes, const Launch& launch)
    {
        const KernelWork& work = per_item(name);
        KernelTiming timing;
        timing.kernel = name;
        timing.queue = queue_ == Queue::Inline ? "light" : "heavy";
        timing.float32 = context_.float32();
        timing.items = items;
        timing.time = sel_device::median_time(
            [&] {
                launch(kernels);
                context_.finish(queue_);
            },
            options_.repeats, options_.least);
        const double n = static_cast<double>(items);
        timing.pairs = n * work.pairs;
        timing.flops = n * work.flops;
        timing.bytes = n * (bytes + 4 * work.floats);
        out_.push_back(timing);
    }

    Context& context_;
    Load load_;
    Queue queue_;
    const KernelBenchOptions& options_;
    const std::vector<KernelWork>& work_;
    std::vector<KernelTiming>& out_;
    std::size_t n_;
    Buffer tree_, vertices_, boundary_, hi_, lo_, theta_, hi_t0_, lo_t0_, theta_t0_, models_, places_, list_, first_, states_t0_,
        states_, multipliers_, next_multipliers_, candidates_, counts_, forces_, barys_, ratios_, found_, clearances_, memories_;
};

std::vector<KernelTiming> time_all(Context& context, const BenchWall& wall, const std::vector<KernelWork>& work,
                                   const KernelBenchOptions& options)
{
    std::vector<KernelTiming> out;
    for (const Queue queue : {Queue::Inline, Queue::Pool})
        for (const std::size_t points : queue == Queue::Inline ? options.light : options.heavy) {
            Bench bench(context, wall, points, queue, options, work, out);
            bench.capsule();
            bench.layer();
        }
    return out;
}

}  // namespace

// The project's kernels, through the device: PoCL's threaded one.
#include "peers.h"

#include "device/device.h"
#include "wide/bench_kernels.h"
#include "wide/wide_tree.h"

#include <cmath>

namespace peers {

namespace {

namespace device = seldinger::device;

/// Grows as needed, as a program's buffers would over its first steps.
constexpr std::uint32_t first_slots = 16;

/// The default device, where the bench's kernels are known.
int device_with_bench_kernels()
{
    seldinger::add_bench_kernels();
    return -1;
}

class Ours final : public Peer {
public:
    explicit Ours(bool float32)
        : context_(device_with_bench_kernels(), float32),
          capsule_(context_, "wide/queries.cl", "query_capsule", device::Items::Short),
          nearest_(context_, "wide/queries.cl", "query_nearest", device::Items::Short)
    {
        name = float32 ? "seldinger, float32" : "seldinger";
    }

    void build(const Problem& problem) override
    {
        // the binary tree is the problem's, and main measures its build time; here it is widened and goes to the device
        const seldinger::WideTree tree = seldinger::build_wide_tree(*problem.tree);
        nodes_ = upload(tree.nodes.data(), tree.nodes.size() * sizeof(tree.nodes[0]));
        vertices_ = upload(tree.vertices.data(), tree.vertices.size() * sizeof(float));
        counts_ = device::Buffer(context_, problem.capsules.size() * sizeof(std::uint32_t));
        const std::size_t real = context_.float32() ? 4 : 8;
        queries_ = device::Buffer(context_, problem.capsules.size() * 8 * real);
        points_ = device::Buffer(context_, problem.points.size() * 3 * real);
        closest_ = device::Buffer(context_, problem.points.size() * 3 * real);
        triangles_ = device::Buffer(context_, problem.points.size() * sizeof(std::uint32_t));
        slots_ = first_slots;
        found_ = device::Buffer(context_, problem.capsules.size() * slots_ * sizeof(std::uint32_t));
    }

    void sets(const Problem& problem, Sets& out) override
    {
        context_.float32() ? sets_in<float>(problem, out) : sets_in<double>(problem, out);
    }

    void nearest(const Problem& problem, Distances& out) override
    {
        context_.float32() ? nearest_in<float>(problem, out) : nearest_in<double>(problem, out);
    }

private:
    device::Buffer upload(const void* data, std::size_t bytes)
    {
        device::Buffer buffer(context_, bytes);
        context_.enter(lane);
        context_.write(lane, buffer, data, bytes);
        context_.finish(lane);
        return buffer;
    }

    template <class Real>
    void sets_in(const Problem& problem, Sets& out)
    {
        const std::size_t n = problem.capsules.size();
        std::vector<Real> queries(8 * n);
        for (std::size_t k = 0; k < n; ++k) {
            const Capsule& c = problem.capsules[k];
            for (std::size_t i = 0; i < 3; ++i)
                queries[8 * k + i] = static_cast<Real>(c.a[i]), queries[8 * k + 3 + i] = static_cast<Real>(c.b[i]);
            queries[8 * k + 6] = static_cast<Real>(c.radius);
        }
        std::vector<std::uint32_t> counts(n);
        context_.enter(lane);
        context_.write(lane, queries_, queries.data(), queries.size() * sizeof(Real));
        for (;;) {
            capsule_.launch(lane, n, static_cast<cl_uint>(n), slots_, queries_, nodes_, vertices_, found_, counts_);
            context_.read(lane, counts_, counts.data(), n * sizeof(std::uint32_t));
            const std::uint32_t most = *std::max_element(counts.begin(), counts.end());
            if (most <= slots_) break;
            slots_ = most + most / 4;
            found_ = device::Buffer(context_, n * slots_ * sizeof(std::uint32_t));
        }
        all_.resize(n * slots_);
        context_.read(lane, found_, all_.data(), all_.size() * sizeof(std::uint32_t));
        for (std::size_t k = 0; k < n; ++k) out[k].assign(&all_[k * slots_], &all_[k * slots_] + counts[k]);
    }

    template <class Real>
    void nearest_in(const Problem& problem, Distances& out)
    {
        const std::size_t n = problem.points.size();
        std::vector<Real> points(3 * n), closest(3 * n);
        for (std::size_t k = 0; k < 3 * n; ++k) points[k] = static_cast<Real>(problem.points[k / 3][k % 3]);
        context_.enter(lane);
        context_.write(lane, points_, points.data(), points.size() * sizeof(Real));
        nearest_.launch(lane, n, static_cast<cl_uint>(n), points_, nodes_, vertices_, closest_, triangles_);
        context_.read(lane, closest_, closest.data(), closest.size() * sizeof(Real));
        for (std::size_t k = 0; k < n; ++k) {
            double d2 = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const double d = problem.points[k][i] - static_cast<double>(closest[3 * k + i]);
                d2 += d * d;
            }
            out[k] = std::sqrt(d2);
        }
    }

    static constexpr device::Queue lane = device::Queue::Pool;
    device::Context context_;
    device::Kernel capsule_, nearest_;
    device::Buffer nodes_, vertices_, queries_, points_, found_, counts_, closest_, triangles_;
    std::uint32_t slots_ = first_slots;
    std::vector<std::uint32_t> all_;
};

}  // namespace

std::unique_ptr<Peer> make_ours(bool float32) { return std::make_unique<Ours>(float32); }

}  // namespace peers

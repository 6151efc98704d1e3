// The load of the kernel bench: compiled in double, in float, and with numbers that count, each under a namespace of its own
// (kernel_bench_double.cpp, kernel_bench_float32.cpp, kernel_bench_work.cpp).
#include "shared/barrier_path.h"
#include "shared/edge_sums.h"
#include "shared/layer.h"
#include "shared/multipliers.h"
#include "shared/sweep.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace {

using namespace seldinger;
using sel_bench::BenchWall;
using sel_bench::KernelWork;

constexpr uint samples_per_edge = 5, edges_per_wire = 60, slots = 32;
constexpr double wire_radius = 0.4445e-3, reach = 0.1 * wire_radius, slack = 0.4 * wire_radius;

/// Even in [lo, hi), the k-th of a sequence that is the same in every build.
double draw(uint k, double lo, double hi)
{
    uint h = k * 2654435769u;
    h = (h ^ (h >> 15)) * 2246822519u;
    h = (h ^ (h >> 13)) * 3266489917u;
    return lo + (hi - lo) * ((h ^ (h >> 16)) / 4294967296.0);
}

struct Load {
    std::vector<float> hi, hi_t0;
    std::vector<real> lo, lo_t0, theta, theta_t0;
    std::vector<uint> list, first;  // quadrature points in order; of each edge its first
    std::vector<QuadratureModel> models;
    std::vector<QuadraturePlace> places;
    std::vector<ContactState> states_t0;
    std::vector<MultiplierState> multipliers;
    std::vector<LayerEdge> layer_edges;
    std::vector<TreeNode> nodes;
    ContactParams par{};

    Load(const BenchWall& wall, std::size_t points)
    {
        nodes.resize(wall.nodes.size() / sizeof(TreeNode));
        std::memcpy(nodes.data(), wall.nodes.data(), wall.nodes.size());
        const uint wires =
            static_cast<uint>((points + samples_per_edge * edges_per_wire - 1) / (samples_per_edge * edges_per_wire));
        for (uint w = 0; w < wires; ++w) add_wire(wall, w, points);
        first.push_back(static_cast<uint>(models.size()));
        par.slots = slots;
        par.friction = SEL_FRICTION_STICK_SLIP;
        par.inv_dt = static_cast<real>(1000.0);
        par.smoothing = static_cast<real>(0.002);
        par.smooth_speed = static_cast<real>(1e-3);
    }

    [[nodiscard]] WallView view(const BenchWall& wall) const
    {
        return wall_view(nodes.data(), wall.vertices.data(), wall.boundary.data());
    }
    [[nodiscard]] NodeView now() const { return node_view(hi.data(), lo.data(), theta.data()); }
    [[nodiscard]] NodeView before() const { return node_view(hi_t0.data(), lo_t0.data(), theta_t0.data()); }

    void add_wire(const BenchWall& wall, uint w, std::size_t points)
    {
        const uint base = static_cast<uint>(theta.size());
        const double turn = draw(3 * w + 1, 0, 6.283), twist = draw(3 * w + 2, -6, 6), spacing = wire_radius;
        const double from = draw(3 * w + 3, -0.48, 0.48) * (wall.length - edges_per_wire * samples_per_edge * spacing);
        // 9 um: half of what the facets' middles stand in from the circle through their corners
        const double rho = wall.radius - wire_radius - 9e-6;
        const double start = from - edges_per_wire * samples_per_edge * spacing / 2;
        for (uint i = 0; i <= edges_per_wire; ++i) {
            const double along = i * samples_per_edge * spacing, a = turn + twist * along;
            for (const double p : {start + along, rho * std::cos(a), rho * std::sin(a)}) {
                for (const bool now : {true, false}) {
                    const double q = p + (now ? 0 : 2e-6);
                    (now ? hi : hi_t0).push_back(static_cast<float>(q));
                    (now ? lo : lo_t0).push_back(static_cast<real>(q - static_cast<double>(static_cast<float>(q))));
                }
            }
            theta.push_back(static_cast<real>(1e-3 * i));
            theta_t0.push_back(static_cast<real>(1e-3 * i - 1e-4));
        }
        for (uint e = 0; e < edges_per_wire && models.size() < points; ++e) {
            first.push_back(static_cast<uint>(models.size()));
            LayerEdge edge{};
            edge.node = base + e;
            edge.epoch = 9;
            edge.model = model(1e-3);
            edge.reach = static_cast<real>(wire_radius / 2);
            edge.width = static_cast<real>(wire_radius * (0.25 + 1.75 * wire_radius / wall.radius));
            edge.height = static_cast<real>(1.5 * wire_radius);
            layer_edges.push_back(edge);
            for (uint k = 0; k < samples_per_edge && models.size() < points; ++k)
                add_point(base + e, (k + 0.5) / samples_per_edge, turn + twist * (e * samples_per_edge + k) * spacing);
        }
    }

    static QuadratureModel model(double weight)
    {
        QuadratureModel m{};
        m.weight = m.length = static_cast<real>(weight);
        m.radius = static_cast<real>(wire_radius);
        m.reach = static_cast<real>(reach);
        m.stiffness = static_cast<real>(1.5e8);
        m.exponent = static_cast<real>(1.5);
        m.friction_stiffness = static_cast<real>(1e5);
        m.mu_static = static_cast<real>(0.12);
        m.mu_sliding = static_cast<real>(0.1);
        m.speed_floor = static_cast<real>(1e-4);
        m.depth_limit = static_cast<real>(wire_radius / 2);
        m.damping = static_cast<real>(1.43);
        m.roll_arm = static_cast<real>(0.04);
        m.roll_depth = static_cast<real>(2 * wire_radius);
        m.penalty_stiffness = static_cast<real>(1e5);
        m.law_length = static_cast<real>(1e-5);
        m.line_mass = static_cast<real>(5e-3);
        m.restitution = static_cast<real>(0.5);
        return m;
    }

    void add_point(uint edge, double bary, double angle)
    {
        list.push_back(static_cast<uint>(models.size()));
        models.push_back(model(wire_radius));
        QuadraturePlace p{};
        p.edge = p.edge_t0 = edge;
        p.bary = p.bary_t0 = static_cast<real>(bary);
        p.epoch = 9;
        p.radius_reduction = static_cast<real>(0.0);
        places.push_back(p);
        for (int side = 0; side < 2; ++side) {
            ContactState t{};
            t.normal[1] = static_cast<real>(-std::cos(angle));
            t.normal[2] = static_cast<real>(-std::sin(angle));
            t.slip[0] = static_cast<real>(1e-7);
            t.gap = static_cast<real>(-1e-6);
            t.approach = static_cast<real>(1e-3);
            t.normal_force = static_cast<real>(1e-3);
            t.flags = SEL_CONTACT_ACTIVE | SEL_CONTACT_STUCK;
            t.epoch = side == 0 ? 8 : 3;  // one contact point lives, as in a wide lumen
            states_t0.push_back(t);
            MultiplierState h{};
            for (int i = 0; i < 3; ++i) h.normal[i] = t.normal[i];
            h.force = static_cast<real>(0.5);
            h.stiffness = static_cast<real>(1e6);
            h.live = side == 0;
            multipliers.push_back(h);
        }
    }
};

/// Rates of a launch from the work of one item.
[[maybe_unused]] const KernelWork& work_of(const std::vector<KernelWork>& list, const std::string& kernel)
{
    return *std::find_if(list.begin(), list.end(), [&](const KernelWork& w) { return w.kernel == kernel; });
}

}  // namespace

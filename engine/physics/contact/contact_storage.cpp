// Upper bound of the energy that contacts can return.
#include "contact/contact_storage.h"

#include "shared/contact_law.h"

#include <algorithm>

namespace seldinger {
namespace {

/// Energy of the static law, per unit of weight.
double static_energy(double depth, const QuadratureModel& m)
{
    if (depth <= 0) return 0;
    real slope;
    return elastic_normal(depth, m, &slope) * depth / (m.exponent + 1);
}

}  // namespace

ContactStorage::ContactStorage(std::span<const QuadratureModel> models, uint normal_law) : law_(normal_law)
{
    tip_ = models.front();
    line_ = models.back();
    for (const QuadratureModel& m : models.subspan(models.size() > 1 ? 1 : 0)) {
        line_.stiffness = std::max(line_.stiffness, m.stiffness);
        line_.depth_limit = std::min(line_.depth_limit, m.depth_limit);
        line_.law_length = std::max(line_.law_length, m.law_length);
        line_.weight = std::min(line_.weight, m.weight);
        line_.radius = std::min(line_.radius, m.radius);
        line_.friction_stiffness = std::min(line_.friction_stiffness, m.friction_stiffness);
    }
}

double ContactStorage::normal(const EdgeForce& sum, double length, bool tip) const
{
    switch (law_) {
        case SEL_NORMAL_DAMPED: return length * static_energy(sum.depth, line_) + (tip ? static_energy(sum.depth, tip_) : 0.0);
        case SEL_NORMAL_BARRIER: return sum.normal_sum * line_.law_length;
        case SEL_NORMAL_IMPULSE:  // law_length is a speed there
            return sum.normal_sum * std::max<double>(sum.depth, 0);
        default:
            return sum.normal_sum * (std::max<double>(sum.depth, 0) + line_.law_length);
    }
}

double ContactStorage::most(const EdgeSums& sums, int wire, int begin, const RodView& rod) const
{
    double energy = 0;
    for (int e = sums.wire_edges[wire]; e < sums.wire_edges[wire + 1]; ++e) {
        const EdgeForce& sum = sums.edges[e];
        const int edge = static_cast<int>(sums.edge_node[e]) - begin;
        energy += normal(sum, rod.rest_length[edge] + line_.weight, edge == 0);
        const double rolling = sum.rolling_sum / line_.radius, stiffness = line_.friction_stiffness * line_.weight;
        if (stiffness > 0) energy += (sum.friction_sum * sum.friction_sum + rolling * rolling) / (2 * stiffness);
    }
    return energy;
}

}  // namespace seldinger

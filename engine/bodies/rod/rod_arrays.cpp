// Memory of all wires, and the order of its arrays.
#include "rod/rod_arrays.h"

#include "core/check.h"
#include "core/state_walk.h"

#include <algorithm>
#include <limits>

namespace seldinger {
namespace {

constexpr double positive = std::numeric_limits<double>::denorm_min(), most_length = 1e4, most_angle = 1e9;  // [m], [rad]

struct RodRow {
    std::span<double> RodView::*array;
    bool of_edges;  // else of nodes
    StateRow row;
};

// The order fixes the layout of checkpoints and of the state hash: append, never reorder.
constexpr RodRow members[] = {
    {&RodView::material_s, false, {"a material coordinate", "m", "feed_hubs, adapt_nodes", -most_length, most_length}},
    {&RodView::rest_length, true, {"an edge's length", "m", "feed_hubs, adapt_nodes", positive, most_length}},
    {&RodView::stretch_stiffness, true, {"a stiffness", "N", "feed_hubs, adapt_nodes", positive}},
    {&RodView::bend_stiffness, false, {"a stiffness", "N m^2", "feed_hubs, adapt_nodes", positive}},
    {&RodView::twist_stiffness, false, {"a stiffness", "N m^2", "feed_hubs, adapt_nodes", positive}},
    {&RodView::rest_kappa1, false, {"an angle", "", "feed_hubs, adapt_nodes", -most_angle, most_angle}},
    {&RodView::rest_kappa2, false, {"an angle", "", "feed_hubs, adapt_nodes", -most_angle, most_angle}},
    {&RodView::rest_twist, false, {"an angle", "rad", "feed_hubs, adapt_nodes", -most_angle, most_angle}},
    {&RodView::mass, false, {"a mass", "kg", "feed_hubs, adapt_nodes", positive}},
    {&RodView::spin_inertia, true, {"an inertia", "kg m^2", "feed_hubs, adapt_nodes", positive}},
    {&RodView::radius, true, {"a radius", "m", "feed_hubs, adapt_nodes", positive, most_length}},
    {&RodView::x, false, {"a node's place", "m", "solve", -most_length, most_length}},
    {&RodView::y, false, {"a node's place", "m", "solve", -most_length, most_length}},
    {&RodView::z, false, {"a node's place", "m", "solve", -most_length, most_length}},
    {&RodView::theta, true, {"an angle", "rad", "solve", -most_angle, most_angle}},
    {&RodView::vx, false, {"a speed", "m/s", "solve"}},
    {&RodView::vy, false, {"a speed", "m/s", "solve"}},
    {&RodView::vz, false, {"a speed", "m/s", "solve"}},
    {&RodView::spin_rate, true, {"a speed", "rad/s", "solve"}},
    {&RodView::ax, false, {"an acceleration", "m/s^2", "solve"}},
    {&RodView::ay, false, {"an acceleration", "m/s^2", "solve"}},
    {&RodView::az, false, {"an acceleration", "m/s^2", "solve"}},
    {&RodView::spin_acc, true, {"an acceleration", "rad/s^2", "solve"}},
    {&RodView::tx, true, {"a director", "", "solve", -2, 2}},
    {&RodView::ty, true, {"a director", "", "solve", -2, 2}},
    {&RodView::tz, true, {"a director", "", "solve", -2, 2}},
    {&RodView::d1x, true, {"a director", "", "solve", -2, 2}},
    {&RodView::d1y, true, {"a director", "", "solve", -2, 2}},
    {&RodView::d1z, true, {"a director", "", "solve", -2, 2}},
    {&RodView::ref_twist, false, {"an angle", "rad", "solve", -most_angle, most_angle}},
    {&RodView::clamp_twist_a, false, {"an angle", "rad", "solve", -most_angle, most_angle}},
    {&RodView::clamp_twist_b, false, {"an angle", "rad", "solve", -most_angle, most_angle}},
};

}  // namespace

// A span that is added to RodView and forgotten above would silently stay out of checkpoints. (Spans are two words and
// RodView opens with two ints, one word.)
static_assert(sizeof(RodView) == sizeof(void*) + std::size(members) * sizeof(std::span<double>),
              "every span of RodView is listed above");

RodArrays::RodArrays(std::span<const int> capacity)
{
    static_assert(std::size(members) == array_count);
    begin_.push_back(0);
    for (const int nodes : capacity) {
        SEL_ASSERT(nodes >= 2);
        begin_.push_back(begin_.back() + nodes);
        count_.push_back(nodes);
        curvature_.push_back(CurvatureMeasure::Angle);
    }
    for (std::vector<double>& array : storage_) array.assign(begin_.back(), 0.0);
}

void RodArrays::set_node_count(int wire, int n)
{
    SEL_ASSERT(n >= 2 && n <= capacity(wire));
    count_[wire] = n;
}

void RodArrays::insert_node(int wire, int index)
{
    const int n = count_[wire];
    SEL_ASSERT(index >= 1 && index < n);
    set_node_count(wire, n + 1);
    for (std::vector<double>& array : storage_) {
        const auto first = array.begin() + begin_[wire];
        std::copy_backward(first + index, first + n, first + n + 1);
    }
}

void RodArrays::erase_node(int wire, int index)
{
    const int n = count_[wire];
    SEL_ASSERT(index >= 1 && index < n - 1);
    for (std::vector<double>& array : storage_) {
        const auto first = array.begin() + begin_[wire];
        std::copy(first + index + 1, first + n, first + index);
    }
    set_node_count(wire, n - 1);
}

RodView RodArrays::view(int wire)
{
    RodView rod;
    rod.n = count_[wire];
    rod.curvature = curvature_[wire];
    for (int k = 0; k < array_count; ++k) rod.*members[k].array = std::span<double>(storage_[k]).subspan(begin_[wire], rod.n);
    return rod;
}

std::array<std::span<double>, RodArrays::array_count> RodArrays::arrays(int wire)
{
    std::array<std::span<double>, array_count> result;
    for (int k = 0; k < array_count; ++k) result[k] = std::span<double>(storage_[k]).subspan(begin_[wire], count_[wire]);
    return result;
}

void RodArrays::walk_state(StateWalk& walk, int wire, bool own)
{
    const auto spans = arrays(wire);
    const auto n = static_cast<std::size_t>(node_count(wire));
    for (std::size_t k = 0; k < spans.size(); ++k) {
        const StateRow& row = members[k].row;
        if (own) walk(row, spans[k], members[k].of_edges ? n - 1 : n);
        else walk({row.name, row.unit, row.writer}, spans[k]);
    }
}

}  // namespace seldinger

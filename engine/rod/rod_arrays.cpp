// Storage of the wires' per-node arrays: views of one wire, nodes inserted and erased in all arrays at once.
#include "rod/rod_arrays.h"

#include "core/check.h"

#include <algorithm>
#include <array>

namespace seldinger {

namespace {

// The order fixes the layout of checkpoints and of the state hash: append, never reorder.
constexpr std::array members = {
    &RodView::material_s,
    &RodView::rest_length,
    &RodView::stretch_stiffness,
    &RodView::bend_stiffness,
    &RodView::twist_stiffness,
    &RodView::rest_kappa1,
    &RodView::rest_kappa2,
    &RodView::rest_twist,
    &RodView::mass,
    &RodView::spin_inertia,
    &RodView::radius,
    &RodView::x,
    &RodView::y,
    &RodView::z,
    &RodView::theta,
    &RodView::vx,
    &RodView::vy,
    &RodView::vz,
    &RodView::spin_rate,
    &RodView::ax,
    &RodView::ay,
    &RodView::az,
    &RodView::spin_acc,
    &RodView::tx,
    &RodView::ty,
    &RodView::tz,
    &RodView::d1x,
    &RodView::d1y,
    &RodView::d1z,
    &RodView::ref_twist,
    &RodView::clamp_twist_a,
    &RodView::clamp_twist_b,
};

}  // namespace

// A span that is added to RodView and forgotten above would silently stay out of checkpoints. (Spans are two words and
// RodView opens with two ints, one word.)
static_assert(sizeof(RodView) == sizeof(void*) + members.size() * sizeof(std::span<double>),
              "every span of RodView is listed above");

RodArrays::RodArrays(std::span<const int> capacity)
{
    static_assert(members.size() == array_count);
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
    for (int k = 0; k < array_count; ++k) rod.*members[k] = std::span<double>(storage_[k]).subspan(begin_[wire], rod.n);
    return rod;
}

std::array<std::span<double>, RodArrays::array_count> RodArrays::arrays(int wire)
{
    std::array<std::span<double>, array_count> result;
    for (int k = 0; k < array_count; ++k) result[k] = std::span<double>(storage_[k]).subspan(begin_[wire], count_[wire]);
    return result;
}

}  // namespace seldinger

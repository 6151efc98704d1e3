#pragma once
// Contacts that Newton's method has carried over a valley of the wall, from one facet to another.
//
// Between two facets that meet in a valley the force turns from f n_a to f n_b within a micron (smooth_maximum.h), and a wire
// that lies in the valley finds its balance there. From a trial on facet b the tangent knows nothing of a: the next trial is on a
// again, and so on until a shortened one happens to end in the valley. But both facets are planes, known from the two trials.
// With the smooth maximum of these two continued without bounds,
//
//     f(p) = f (n_b + z w),   w = n_a - n_b,   z = (eps - (depth_b - depth_a)) / (2 eps),
//
// with the eps of these facets, which is the law itself for 0 < z < 1, the direction leads into the valley. What the law lacks of
// it (z < 0) is added to the residual that the direction is taken from, and f w w^T / (2 eps) to the tangent. Whether the balance
// is there is for the next trial to say; residuals of trials, and so results, are those of the law. If that trial is beyond the
// valley again, the balance is not there, and the direction from it is that of its facet alone.

#include "contact/device_views.h"
#include "contact/edge_sums.h"
#include "contact/quadrature.h"
#include "solve/force_term.h"

#include <span>
#include <vector>

namespace seldinger {

struct ActiveList;

class Valleys {
public:
    /// All must outlive this. @param nodes  at the trial
    Valleys(const QuadratureSet& quadrature, const DeviceNodes& nodes, EdgeSums& sums)
        : quadrature_(quadrature), nodes_(nodes), sums_(sums), wires_(quadrature.wires.size())
    {
        // the step loop allocates where a wire touches more often than ever before, and than most do
        for (Wire& wire : wires_) {
            wire.base.reserve(128);
            wire.crossings.reserve(16);
            wire.kinks.reserve(16);
        }
    }

    /// A wire's trial is the base from now on. @param states  [points][2] of its evaluation     @param list  of all wires
    void take(int wire, std::span<const ContactState> states, const ActiveList& list);
    /// Forgets the base.
    void start(int wire) { wires_[static_cast<std::size_t>(wire)].base.clear(); }
    /// Whether contacts at the trial have gone over a valley since the base, or into one. Share: of the way there at which the
    /// one with the largest turn of its force has.
    KinksPassed crossed(int wire, std::span<const ContactState> states, const ActiveList& list, double smoothing);
    /// The valleys that crossed() found, as the base sees them; valid until the next call.
    [[nodiscard]] std::span<const Kink> from_base(int wire, int first_node);
    /// Adds the valleys that crossed() found: the missing forces to the residual, tangents to the sums.
    void admit(int wire, int first_node, std::span<double> residual);

private:
    struct Touch {
        std::uint32_t record;
        Vec3 normal, axis;
        double depth, force;
        bool admitted;  // the direction from here knows of its valley
    };
    struct Crossing {
        std::uint32_t record;
        int edge;  // among the sums
        double bary;
        Vec3 force;                      // that is missing [N]
        Vec3 across;                     // w
        double stiffness;                // along w w^T [N/m]
        double base_force, rest, width;  // as the base sees it: see Kink
    };
    struct Wire {
        std::vector<Touch> base;  // in order of their records
        std::vector<Crossing> crossings;
        std::vector<Kink> kinks;
        bool admitted = false;
    };
    [[nodiscard]] Touch touch_of(std::uint32_t record, const ContactState& state) const;
    template <class F>
    void for_each_touch(int wire, std::span<const ContactState> states, const ActiveList& list, const F& f) const;

    const QuadratureSet& quadrature_;
    const DeviceNodes& nodes_;
    EdgeSums& sums_;
    std::vector<Wire> wires_;
};

}  // namespace seldinger

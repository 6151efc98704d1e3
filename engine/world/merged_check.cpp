// Checks which instruments can share one centreline.

#include "core/error.h"
#include "world/merged.h"
#include "world/setup_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace seldinger {

namespace {

[[noreturn]] void refuse_merged(std::string_view where, std::string_view what)
{
    throw Error(ExitCode::BadScene, fmt::format("{}: {}", where, what));
}

void check_member(const WorldSetup& setup, const CoaxialSpec& spec, int w)
{
    const WireSetup &wire = setup.wires[w], &first = setup.wires[spec.order[0]];
    const std::string where = fmt::format("wires[{}]", w);
    if (!wire.feed.on) refuse_merged(where + ".feed.on", "got false; expected true, as instruments of one centreline (merged) are fed");
    if ((wire.feed.point - first.feed.point).norm() > 0 || (wire.feed.direction - first.feed.direction).norm() > 0)
        refuse_merged(where + ".feed", "got another inlet than the outermost instrument has; expected the same (merged)");
    if (!(wire.feed.behind >= 0 && std::isfinite(wire.feed.behind)))
        refuse_merged(where + ".feed.behind", fmt::format("got {} m; expected a number, 0 or more", wire.feed.behind));
    if (wire.wire.curvature != first.wire.curvature)
        refuse_merged(where + ".wire.curvature", "got another value than the outermost instrument has; expected the same (merged)");
}

/// The lumen presses on its contents, which deviate by the clearance.
void check_room(const WorldSetup& setup, const CoaxialSpec& spec)
{
    for (std::size_t k = 1; k < spec.order.size() && spec.lumen_friction; ++k) {
        const double lumen = setup.wires[spec.order[k - 1]].wire.lumen_radius;
        const double radius = setup.wires[spec.order[k]].wire.largest_radius();
        if (!(lumen > radius))
            refuse_merged(fmt::format("wires[{}].wire.lumen_radius", spec.order[k - 1]),
                   fmt::format("got {} m; expected more than the radius of the instrument inside, {} m, with lumen_friction", lumen,
                               radius));
    }
}

void check_scheme(const WorldSetup& setup)
{
    const IntegratorSpec& integrator = setup.integrator;
    const bool newton = integrator.scheme == Scheme::Newton && !integrator.conserve;
    if (!newton && integrator.scheme != Scheme::Static)
        refuse_merged("integrator",
               "got another scheme; expected newton (backward Euler or Newmark's) or static with instruments of one centreline (merged)");
    for (std::size_t w = 0; w < setup.wires.size() && newton && integrator.newmark; ++w)
        if (!setup.wires[w].holds.empty() && merged_spec_of(setup, static_cast<int>(w)))
            refuse_merged(fmt::format("wires[{}].holds", w),
                   "got holds; expected none on instruments of one centreline (merged) with Newmark's steps, where a velocity that a hold removes "
                   "changes its sign at every step. Fix: take backward Euler, or a stiff link");
    if (integrator.damping_stiffness > 0)
        refuse_merged("integrator.damping_stiffness", "got another value than 0; expected 0 with instruments of one centreline (merged)");
    if (setup.instruments_touch)
        refuse_merged("instruments_touch",
               "got true; expected false with instruments of one centreline (merged). Fix: give each a rod (separate)");
    const Detection detection = setup.wires[0].contact.detection;
    if (!setup.mesh.triangles.empty() && detection != Detection::Swept && detection != Detection::Capsule)
        refuse_merged("contact.detection", "got another method; expected swept or capsule with instruments of one centreline (merged)");
}

}  // namespace

void check_merged(const WorldSetup& setup)
{
    std::vector<int> seen(setup.wires.size(), 0);
    bool any = false;
    for (std::size_t c = 0; c < setup.coaxial.size(); ++c) {
        const CoaxialSpec& spec = setup.coaxial[c];
        if (spec.model != CoaxialSpec::Model::Merged) continue;
        const std::string where = fmt::format("coaxial[{}]", c);
        if (spec.order.size() > most_coaxial)
            refuse_merged(where + ".order", fmt::format("got {} instruments; expected at most {}", spec.order.size(), most_coaxial));
        for (const int w : spec.order) {
            if (++seen[w] > 1) refuse_merged(where + ".order", fmt::format("got wire {}, which is in another one already; expected it in one", w));
            check_member(setup, spec, w);
        }
        check_room(setup, spec);
        any = true;
    }
    if (any) check_scheme(setup);
    for (std::size_t w = 0; w < setup.wires.size(); ++w)
        if (setup.wires[w].feed.behind != 0 && !merged_spec_of(setup, static_cast<int>(w)))
            refuse_merged(fmt::format("wires[{}].feed.behind", w),
                   "got another value than 0; expected 0 except for instruments of one centreline (merged)");
}

}  // namespace seldinger

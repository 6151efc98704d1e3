#pragma once
// Worlds of instruments that share one centreline, without a vessel: from the origin along +x. An instrument that is not turned
// and curved by (k, 0) bends towards +z; turned by `a` towards (-sin a, cos a) in (y, z).

#include "engine.h"
#include "support/approx.h"
#include "support/steps.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace seldinger::test {

inline constexpr double bend = 2e-4, twist = 1e-4;  // of usual instruments, the outer one where both differ [N m^2]

using std::numbers::pi;

/// Section of one stiffness and curvature, tip first. [m], [N m^2], [1/m]
struct Part {
    double length, bend, curvature;
};

inline WireSection section_of(double bend, double twist, double curvature)
{
    WireSection section{.radius = 0.5e-3, .density = 6500, .bend_stiffness = bend, .twist_stiffness = twist};
    section.stretch_stiffness = 4 * bend / (section.radius * section.radius);  // of a round wire
    section.rest_curvature = {curvature, 0};
    return section;
}

inline WireSpec instrument_of(const std::vector<Part>& parts, double twist_over_bend)
{
    WireSpec spec;
    spec.length = 0;
    for (const Part& part : parts) {
        const WireSection section = section_of(part.bend, twist_over_bend * part.bend, part.curvature);
        spec.sections.push_back({spec.length, spec.length + part.length, section});
        spec.length += part.length;
        spec.shaft = section;
    }
    return spec;
}

inline WireSpec instrument_of(double length, double bend, double twist, double curved, double curvature)
{
    WireSpec spec;
    spec.length = length;
    spec.shaft = section_of(bend, twist, 0);
    spec.sections.push_back({0, curved, section_of(bend, twist, curvature)});
    return spec;
}

/// One group, outer first, each so far in. @param edge  of the line [m]
inline WorldSetup merged_setup(const std::vector<WireSpec>& specs, const std::vector<double>& inserted, double edge,
                               Scheme scheme = Scheme::Static)
{
    WorldSetup setup;
    setup.gravity = Vec3::Zero();
    setup.integrator.scheme = scheme;
    setup.integrator.tolerance = 1e-8;
    CoaxialSpec group;
    group.model = CoaxialSpec::Model::Merged;
    for (std::size_t k = 0; k < specs.size(); ++k) {
        WireSetup wire;
        wire.wire = specs[k];
        wire.wire.nodes = static_cast<int>(std::lround(specs[k].length / edge)) + 1;
        wire.feed.on = true;
        wire.feed.advance = inserted[k];
        setup.wires.push_back(wire);
        group.order.push_back(static_cast<int>(k));
    }
    setup.systems = {static_cast<int>(specs.size())};
    setup.coaxial.push_back(group);
    return setup;
}

/// One setup stepped by on(world, from, to): in one piece; until `middle`; and on from what that had saved then, which must make
/// no difference to any bit.
struct TakenUp {
    template <class On>
    TakenUp(const WorldSetup& setup, const On& on, int middle, int end) : whole(setup), first(setup), second(setup)
    {
        on(whole, 0, end);
        on(first, 0, middle);
        second.restore_state(first.save_state());
        CHECK(second.state_hash() == first.state_hash());
        on(second, middle, end);
        CHECK(second.state_hash() == whole.state_hash());
    }
    World whole, first, second;
};

/// Turns one hub to `turn` [rad] in equal parts, at rest in each.
inline void turn_slowly(World& world, int wire, double advance, double from, double to, int parts)
{
    for (int k = 1; k <= parts; ++k) {
        Control control;
        control.move_to(wire, advance, from + (to - from) * k / parts);
        REQUIRE_FALSE(step(world, control, 0.01).failed());
    }
}

/// Both of a pair, 50 and 60 mm in, swing along by `outer` and 20 mm to each side and turn through each other, in steps of 1 ms.
/// @param period  of the swing [steps]     @return the largest error of momentum [N]
inline double swing_through_each_other(World& world, int steps, int period, double outer)
{
    double most = 0;
    for (int k = 1; k <= steps; ++k) {
        const double phase = 2 * pi * k / period;
        step_to(world, 1e-3,
                {{0.05 + outer * (1 - std::cos(phase)), 0.5 * std::sin(phase)}, {0.06 + 0.02 * std::sin(phase), 0.004 * k}});
        most = std::max(most, world.readings(0).momentum.error().norm());
    }
    return most;
}

/// Angle of an instrument about the direction of insertion, relative to a director carried along in parallel from the inlet, at a
/// length from its own tip [deg].
inline double angle_deg(const World& world, int wire, double s)
{
    const ConstRodView rod = world.rod(wire);
    std::vector<double> angle(static_cast<std::size_t>(rod.n));
    angle[rod.n - 1] = rod.theta[rod.n - 1];
    double ref = 0;
    for (int j = rod.n - 2; j >= 0; --j) {
        ref += j == rod.n - 2 ? rod.clamp_twist_a[rod.n - 1] : rod.ref_twist[j + 1];
        angle[j] = rod.theta[j] - ref;
    }
    // an edge's angle is that of the middle of the line's own edge, of which the first edge here is a part
    const auto middle = [&](int j) {
        if (j == rod.n - 1) return rod.material_s[j];
        const double begin = j == 0 ? rod.material_s[1] - (rod.material_s[2] - rod.material_s[1]) : rod.material_s[j];
        return 0.5 * (begin + rod.material_s[j + 1]);
    };
    int j = 0;
    while (j + 2 < rod.n && middle(j + 1) <= s) ++j;
    const double w = std::max(0.0, (s - middle(j)) / (middle(j + 1) - middle(j)));
    return -180 / pi * ((1 - w) * angle[j] + w * angle[j + 1]);
}

/// A place of the references, whose instruments bend towards +y and turn from +y to +z.
inline Vec3 from_reference(const Vec3& p) { return {p.x(), -p.z(), p.y()}; }

}  // namespace seldinger::test

// A virtual three-point bend of every instrument of the catalogue gives its own bending stiffness.

#include "scene/instruments.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"

#include <fmt/format.h>

#include <cmath>

namespace seldinger::test::test_three_point_bend {

namespace {

constexpr double span = 0.1, overhang = 0.6;  // the shaft lies on the supports, all tips hang out beyond one of them [m]

/// @param force  in the middle of the span [N]
Scene bend_of(const std::string& preset, double force)
{
    return read_scene_text(fmt::format(R"([scene]
gravity = [0.0, 0.0, 0.0]
[wire]
preset = "{}"
length_m = {}
nodes = 281
[integrator]
scheme = "static"
[[hold]]
at = "base"
position = true
spin = true
[[hold]]
at = {}
position = ["y", "z"]
[[load]]
at = {}
force_n = [0.0, {}, 0.0]
)",
                                       preset, overhang + span, overhang, overhang + span / 2, force),
                           "bend.toml");
}

}  // namespace

// delta = F L^3/(48 EI) [Gere & Goodno, Mechanics of materials, table of beam deflections]. Edges of 2.5 mm take the moment as
// linear over an edge, which is exact under point loads on nodes; sums over nodes miss 2 (h/L)^2 = 0.13 % of the integral. The
// force makes deflections of 1 % of the span, whose slope of 3 % changes the stiffness by its square.
TEST_CASE("analytic: a three-point bend of each instrument's shaft gives its own EI")
{
    const std::vector<std::string> names = instrument_names();
    REQUIRE(names.size() >= 13);
    for (const std::string& name : names) {
        CAPTURE(name);
        const double own = bend_of(name, 0).wire.shaft.bend_stiffness;
        const double force = 48 * own * 0.01 / (span * span);
        World world(make_setup(bend_of(name, force)));
        REQUIRE(!settle(world).failed());
        const ConstRodView rod = world.rod(0);
        int middle = 0;
        for (int i = 0; i < rod.n; ++i)
            if (std::abs(rod.material_s[i] - overhang - span / 2) < std::abs(rod.material_s[middle] - overhang - span / 2))
                middle = i;
        const double deflection = rod.pos(middle).y();
        CHECK(force * span * span * span / (48 * deflection) == test::about(own).epsilon(0.005));
    }
}

}  // namespace seldinger::test::test_three_point_bend

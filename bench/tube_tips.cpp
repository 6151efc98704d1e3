// Tips of three nested precurved tubes (D12) at the joints of a table: time after time at rest, by the engine as a user has it.
//
//   tube_tips joints.csv [edge_mm]     lines of six numbers: rotation 1..3 [rad], translation 1..3 [mm]
//
// Writes a line for each: x, y, z of the innermost tube's tip [mm], z along the tubes' axis from where tube 1 begins. The tubes
// are those of the phantom's table (nominal): only ratios of stiffness matter, 1 : 1 : 2/7, nu = 0.3.

#include "engine.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace {

using namespace seldinger;

struct Tube {
    double straight, curved, curvature, bend;  // [m], [1/m], [N m^2]
};

constexpr double unit = 0.05;  // stiffness of the outermost [N m^2]
constexpr Tube tubes[] = {
    {0, 0.15, 1000.0 / 265, unit}, {0.017, 0.15, 1000.0 / 265, unit}, {0.184, 0.0863938, 1000.0 / 55, unit * 2 / 7}};

WireSetup tube_of(const Tube& tube, double translation, double edge)
{
    WireSetup made;
    WireSection section;
    section.radius = 1e-3;
    section.density = 6500;
    section.bend_stiffness = tube.bend;
    section.twist_stiffness = tube.bend / 1.3;
    section.stretch_stiffness = 4 * tube.bend / (section.radius * section.radius);
    made.wire.length = tube.straight + tube.curved;
    made.wire.shaft = section;
    section.rest_curvature = {tube.curvature, 0};
    made.wire.sections.push_back({0, tube.curved, section});
    made.wire.nodes = static_cast<int>(std::ceil(made.wire.length / edge)) + 1;
    made.feed.on = true;
    made.feed.behind = -translation;
    made.feed.advance = made.wire.length + translation;
    return made;
}

/// @param joints  rotations [rad], translations [m]
Vec3 tip_of(const double* joints, double edge)
{
    WorldSetup setup;
    setup.gravity = Vec3::Zero();
    setup.integrator.scheme = Scheme::Static;
    setup.systems = {3};
    CoaxialSpec group;
    group.model = CoaxialSpec::Model::Merged;
    double most = 0;
    for (int k = 0; k < 3; ++k) {
        setup.wires.push_back(tube_of(tubes[k], joints[3 + k], edge));
        group.order.push_back(k);
        most = std::max(most, std::abs(joints[k]));
    }
    setup.coaxial.push_back(group);
    World world(setup);
    const int parts = std::max(1, static_cast<int>(std::ceil(most / 0.3)));
    bool failed = settle(world).failed();
    for (int part = 1; part <= parts; ++part) {
        Control control;
        for (int k = 0; k < 3; ++k) control.move_to(k, setup.wires[k].feed.advance, joints[k] * part / parts);
        failed = step(world, control, 0.01).failed() || failed;
    }
    if (failed) std::fprintf(stderr, "no equilibrium at %g %g %g\n", joints[1], joints[2], joints[5]);
    // (k, 0) bends towards +z and turns from +z to -y
    const Vec3 tip = 1e3 * world.rod(2).pos(0);
    return {tip.z(), -tip.y(), tip.x()};
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc < 2) return std::fprintf(stderr, "tube_tips: expected a file of joints\n"), 2;
    const double edge = argc > 2 ? 1e-3 * std::atof(argv[2]) : 1.5e-3;
    std::ifstream in(argv[1]);
    for (std::string line; std::getline(in, line);) {
        std::istringstream numbers(line);
        double joints[6];
        for (double& joint : joints)
            if (!(numbers >> joint)) return std::fprintf(stderr, "tube_tips: expected six numbers in \"%s\"\n", line.c_str()), 2;
        for (int k = 3; k < 6; ++k) joints[k] *= 1e-3;
        const Vec3 tip = tip_of(joints, edge);
        std::printf("%.9g %.9g %.9g\n", tip.x(), tip.y(), tip.z());
    }
    return 0;
}

#pragma once
// Contact force of straight wires held in a given place, by any detection: nothing moves and nothing gives way.

#include "contact/contact_system.h"
#include "rod/place.h"
#include "support/world_fixture.h"
#include "world/world.h"

namespace seldinger::test {

struct Push {
    double normal = 0;  // sum of magnitudes [N]
    Vec3 force = Vec3::Zero();
    int contacts = 0;
};

struct Pose {
    double y, z;  // of the axis, which lies along x from 0.01 m on [m]
};

/// Contact of the wires as they are placed: one evaluation at rest, nothing moves. All have the same number of nodes.
inline std::vector<Push> pushes_of(device::Context& context, const TestSetup& setup)
{
    const int count = static_cast<int>(setup.wires.size()), nodes = setup.wires[0].wire.nodes;
    RodArrays rods(std::vector<int>(setup.wires.size(), nodes));
    for (int w = 0; w < count; ++w) place_wire(rods, w, setup.wires[w].wire, setup.centreline.main_points());
    const WallModel wall(setup.vessel, setup.mesh, setup.centreline);
    const auto contact = make_contact(context, contact_setup(setup, wall), rods);
    TrialState here;
    for (int w = 0; w < count; ++w) {
        const RodView rod = rods.view(w);
        here.x.insert(here.x.end(), rod.x.begin(), rod.x.end());
        here.y.insert(here.y.end(), rod.y.begin(), rod.y.end());
        here.z.insert(here.z.end(), rod.z.begin(), rod.z.end());
    }
    here.theta.assign(here.x.size(), 0.0);
    const std::vector<std::uint8_t> on(setup.wires.size(), 1);
    contact->begin_step(rods, Settling::Off);
    contact->prepare(rods, on);
    contact->evaluate({here, 0, on});
    std::vector<Push> pushes(setup.wires.size());
    for (int w = 0; w < count; ++w) {
        pushes[w].normal = contact->totals(w).normal;
        pushes[w].contacts = contact->totals(w).contacts;
        std::vector<Vec3> nodal(nodes, Vec3::Zero());
        contact->add_nodal_forces(w, nodal);
        for (const Vec3& f : nodal) pushes[w].force += f;
    }
    return pushes;
}

inline Push push_of(device::Context& context, const TestSetup& setup) { return pushes_of(context, setup)[0]; }

/// Contact of wires in these poses, which do not feel each other: one evaluation at rest, nothing moves.
inline std::vector<Push> push_at(device::Context& context, const WallMesh& mesh, const Centreline& centreline,
                                 Detection detection, const std::vector<Pose>& poses)
{
    constexpr int nodes = 21;
    TestSetup setup;
    setup.mesh = mesh;
    setup.centreline = centreline;
    for (const Pose& pose : poses) {
        setup.wires.push_back(placed_wire(steel_wire(0.08, nodes), {0.01, pose.y, pose.z}));
        setup.wires.back().contact.detection = detection;
        setup.wires.back().contact.friction = FrictionLaw::None;
    }
    return pushes_of(context, setup);
}

}  // namespace seldinger::test

#pragma once
// Worlds whose wires are fed by key frames, as most tests want them: the setup carries the keys, and a step follows them.

#include "engine.h"
#include "setup/key_frames.h"
#include "solve/feed.h"

#include <utility>
#include <vector>

namespace seldinger::test {

struct TestFeed : FeedSpec {
    std::vector<FeedKey> keys;
};

/// WireSetup with keys.
struct TestWire {
    WireSpec wire;
    TestFeed feed;
    ContactSpec contact;
    std::vector<HoldSpec> holds;
    std::vector<LoadSpec> loads;
    std::vector<LinkSpec> links;

    [[nodiscard]] WireSetup setup() const
    {
        FeedSpec inlet = feed;
        if (!feed.keys.empty()) {
            const FeedKey start = HubPath(feed.keys).at(0);
            inlet.advance = start.advance;
            inlet.turn = start.turn;
        }
        return {wire, inlet, contact, holds, loads, links, {}};
    }
};

/// WorldSetup of such wires.
struct TestSetup {
    Vec3 gravity = {0, 0, -9.81};
    bool start_settled = false;
    std::vector<TestWire> wires;
    std::vector<int> systems;
    IntegratorSpec integrator;
    VesselSpec vessel;
    WallMesh mesh;
    Centreline centreline;
    int device_index = -1;

    operator WorldSetup() const
    {
        WorldSetup made{gravity, start_settled, {}, systems, integrator, vessel, mesh, centreline};
        made.device_index = device_index;
        for (const TestWire& wire : wires) made.wires.push_back(wire.setup());
        return made;
    }
    [[nodiscard]] std::vector<std::vector<FeedKey>> keys() const
    {
        std::vector<std::vector<FeedKey>> all;
        for (const TestWire& wire : wires) all.push_back(wire.feed.keys);
        return all;
    }
};

/// A world that follows its keys in every step.
class FedWorld : public World {
public:
    explicit FedWorld(const TestSetup& setup) : World(WorldSetup(setup)), keys(setup.keys()) {}
    KeyFrames keys;
};

[[nodiscard]] inline StepReport step(FedWorld& world, double dt) { return seldinger::step(world, world.keys.control(), dt); }

}  // namespace seldinger::test

#pragma once
// What a world is made of, constant from then on.

#include "contact/contact_spec.h"
#include "rod/wire_spec.h"
#include "solve/solve_spec.h"
#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"

#include <string>
#include <vector>

namespace seldinger {

/// One instrument: a wire, how it is held, loaded and fed, and how it touches the wall.
struct WireSetup {
    WireSpec wire;
    FeedSpec feed;
    ContactSpec contact;  // detection, laws and precision must agree between the wires of a world; coefficients may differ
    std::vector<HoldSpec> holds;
    std::vector<LoadSpec> loads;
    std::vector<LinkSpec> links;
    std::string start;  // what was done to have it start inside the lumen, for World::model(); empty: nothing
};

/// What a world is made from. The vessel has been read and repaired already (io/mesh_file.h, vessel/repair.h, vessel/shapes.h).
struct WorldSetup {
    Vec3 gravity = {0, 0, -9.81};  // [m/s^2]
    bool start_settled = false;    // the first settle() lets every contact stick: the wire rests where it lies
    std::vector<WireSetup> wires;  // the instruments of all systems, at least one
    /// Instruments in each system, in the order of `wires`: those of one system are solved, halved and retired together. Empty:
    /// each is a system of its own.
    std::vector<int> systems;
    IntegratorSpec integrator;
    VesselSpec vessel;  // what the wall is made of; shape None: no wall
    WallMesh mesh;      // repaired, normals into the lumen; empty without a vessel
    Centreline centreline;
    int device_index = -1;  // of list_devices(); -1: the default device
};

}  // namespace seldinger

#pragma once
// The constant parts of a world.

#include "contact/contact_spec.h"
#include "rod/wire_spec.h"
#include "solve/solve_spec.h"
#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace seldinger {

class Force;  // solve/force.h

/// One instrument: a wire, how it is held, loaded and fed, and how it touches the wall.
struct WireSetup {
    WireSpec wire;
    FeedSpec feed;
    ContactSpec contact;  // detection, laws and precision must agree between the wires of a world; coefficients may differ
    std::vector<HoldSpec> holds;
    std::vector<LoadSpec> loads;
    std::vector<LinkSpec> links;
    std::vector<std::shared_ptr<const Force>> forces;  // solve/force.h; World::add_force puts them here, too
    std::string start;  // what was done to have it start inside the lumen, for World::model(); empty: nothing
    std::string inlet;  // the inlet and why it was taken, for World::model(); empty: none
    std::string name;   // in messages and files; empty: the only one, or told apart by its number
};

/// Instruments inside each other: catheter over wire, sheath over both. All of one system, fed at one inlet.
struct CoaxialSpec {
    enum class Model {
        Merged,   // one centreline for all, no clearance (D12)
        Separate  // a rod each, the inner one touches the lumen of the next outer one (D13)
    };
    std::vector<int> order;  // places in WorldSetup::wires, outer first, two at least
    int exchanged = 1;       // the last so many of `order` take turns next inside the one before them all; the others are out
    /// Place in `order` of the one that its k-th is next inside of, -1: of none.
    [[nodiscard]] int around(std::size_t k) const
    {
        return std::min(static_cast<int>(k), static_cast<int>(order.size()) - exchanged) - 1;
    }
    /// Wires that take turns; a single one always may be inside.
    [[nodiscard]] std::span<const int> turns() const { return std::span(order).last(static_cast<std::size_t>(exchanged)); }
    Model model = Model::Merged;  // as in scene files
    double mu_static = 0.06, mu_sliding = 0.05;  // between an instrument and the lumen that it is in [-]
    double stiffness = 0;  // of that contact, force per metre and depth^1.5 [N/m^2.5]; 0: from the outer one's wall
    // Merged, between instruments next to each other and per length of overlap: dry friction [N/m], resistance of a film
    // [N s/m per m]
    double drag = 0, viscous = 0;
    // merged: also mu times the force between them at their clearance (contact/rods/coaxial_friction.h)
    bool lumen_friction = false;
};

/// What a world is made from. The vessel has been read and repaired already (io/mesh_file.h, repair/repair.h, shapes/shapes.h).
struct WorldSetup {
    Vec3 gravity = {0, 0, -9.81};  // [m/s^2]
    bool start_settled = false;    // the first settle() lets every contact stick: the wire rests where it lies
    std::vector<WireSetup> wires;  // the instruments of all systems, at least one
    /// Instruments in each system, in the order of `wires`: those of one system are solved, halved and retired together. Empty:
    /// each is its own system.
    std::vector<int> systems;
    IntegratorSpec integrator;
    VesselSpec vessel;  // what the wall is made of; shape None: no wall
    WallMesh mesh;      // repaired, normals into the lumen; empty without a vessel
    Centreline centreline;
    double force_window = 0;    // of readings per length [m]; 0: each wire's diameter
    double force_patch = 5e-3;  // length of the patch that a force is read on [m]
    int device_index = -1;  // of list_devices(); -1: the default device
    std::vector<CoaxialSpec> coaxial;
    bool instruments_touch = false;  // contact from outside between the instruments of a system, and of each with itself
};

}  // namespace seldinger

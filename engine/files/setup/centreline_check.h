#pragma once
// A centreline against the mesh that it belongs to: its points lie in the lumen, and its radii are the distances to the wall.

#include "setup/vessel_load.h"

namespace seldinger {

/// Reads VesselSpec::centreline into the axes and the unit of the mesh. These are the ones that the scene says, else the header
/// of the centreline's file, where they make it fit. A centreline that fits only otherwise (x and y turned round, another unit)
/// is refused with the key that says so; one that fits in no way, without. Adds what was done, and points outside of the lumen,
/// to the notes of `vessel`.
/// @param vessel  its mesh and report are there
/// @throws Error BadFile, BadScene
void read_given_centreline(const VesselSpec& spec, LoadedVessel& vessel);

/// The same check of the centreline that was found in `vessel`: notes name its points outside of the lumen. Both add notes of
/// rims with a flap, openings and branches that the centreline does not reach (RepairReport::unreached, which has the branches of
/// a found one already).
void check_found_centreline(LoadedVessel& vessel);

}  // namespace seldinger

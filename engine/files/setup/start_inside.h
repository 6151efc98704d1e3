#pragma once
// A placed wire whose axis begins beyond the wall, as measured shapes do, put into the lumen before anything moves.
//
// Contact cannot undo such a start. A wall seen from behind does not push (contact_gap.h). An axis that pierces the wall is
// pushed only at its samples on the lumen's side, at depths far beyond the range of the law. One face pushes along the wire, the
// other against it. So no step converges, and each is halved down to the limit.
//
// The parts on either side of the piercing stretch show on which side of the wall the wire belongs. The stretch moves as
// one, along the mean of the directions into the lumen: off a face along its normal, off the ridge between two vessels across it.
// A smooth step over ten radii on each side carries the rest of the wire along. Nodes are then laid along the moved axis with
// their rest lengths, so the start is as free of stretch as any (rod/place.h).

#include "rod/wire_spec.h"
#include "vessel/centreline.h"
#include "vessel/inside.h"

#include <string>

namespace seldinger {

struct StartInside {
    std::string refused;  // why the wire cannot start; empty: it can
    std::string moved;    // what was done; empty: nothing
};

/// Sees to it that a wire which is not fed starts inside the lumen; wire.place becomes the moved shape where it does not.
/// These are refused: a base beyond the wall, where the user put it; an axis beyond the wall by more than the wire's thickness;
/// and a wire that cannot be brought clear of the wall.
/// @param lumen  past its openings, and beside the border of a wall that has no lumen, the wire is free
[[nodiscard]] StartInside start_inside(WireSpec& wire, const Centreline& centreline, const LumenQuery& lumen);

}  // namespace seldinger

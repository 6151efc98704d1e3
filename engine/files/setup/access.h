#pragma once
// Which of a vessel's inlets a physician would take, and why.

#include "setup/first_scene.h"
#include "vessel/inlets.h"

#include <string>
#include <vector>

namespace seldinger {

/// An inlet, and why it was taken or left.
struct Access {
    int inlet = 1;                    // counted from 1
    std::vector<std::string> reason;  // of each inlet: why it was taken, or why not
};

/// An aorta is a lumen of 6 mm radius or more along 10 % of its axis and 30 mm. It is entered from below, as by femoral access:
/// by the lowest wide end. If ends are at one height, the one nearer to the back is taken (a descending aorta beside an
/// ascending one), else the wider one. An aorta across the head's direction, as in a file of other axes, is entered by the
/// first of the list. Another vessel is entered by its widest end, of ends as wide by the lowest. Inlets of side pockets, short
/// ways and smaller parts are left out unless there is nothing else.
/// @param part  of each inlet, of the vessel's separate parts: 0 is the largest
/// @param head,back  directions of the patient, unit
[[nodiscard]] Access choose_access(const std::vector<Inlet>& inlets, const std::vector<int>& part, const Centreline& line,
                                   const Vec3& head, const Vec3& back);

}  // namespace seldinger

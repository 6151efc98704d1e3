#pragma once
// Closed ends of a vessel, and tips that press on them: forces there come from where the mesh was cut, not from the anatomy.

#include "output.h"
#include "vessel/inlets.h"

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace seldinger {

struct Scene;

/// The first tip that pressed on a closed end. Plain bytes, so that a checkpoint carries it.
struct EndTouch {
    std::int64_t rows = 0;         // that were read with a tip on an end
    std::int64_t wire = 0;         // the first one
    double time = 0, tip[3] = {};  // [s], [m]
};
static_assert(std::is_trivially_copyable_v<EndTouch>);

class ClosedEnds {
public:
    ClosedEnds() = default;
    /// Tips of the centreline where the lumen ends without an opening, except where instruments enter. Of a lumen that goes on
    /// beyond the tip (the rim of a tear, the edge of a flat lumen) it is no end. @param inlets  points [m]
    ClosedEnds(const std::vector<BoundaryLoop>& openings, const WallMesh& mesh, const Centreline& centreline,
               const std::vector<Vec3>& inlets);

    /// A tip presses on an end if it is within a radius of it and a contact near the tip faces into the vessel there.
    /// @param now  with Output::Contacts
    void watch(EndTouch& touch, const Output& now) const;
    [[nodiscard]] bool empty() const { return ends_.empty(); }

private:
    std::vector<Inlet> ends_;
};

/// The warning; empty without a touch.
[[nodiscard]] std::string describe(const EndTouch& touch, const Scene& scene);

}  // namespace seldinger

#pragma once
// Records tips that left the vessel through an opening, with the time. A tip that leaves through a side branch has left the
// model, not passed its wall.
//
// A tip leaves through an opening when its path since the last check crosses the polygon of the opening's rim from inside to
// outside, and comes back when it crosses it the other way. A tip that enters at an inlet has not left before.

#include "engine.h"
#include "repair/repair.h"

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace seldinger {

struct Scene;

/// Plain bytes, so that a checkpoint carries it as it is.
struct ExitTally {
    static constexpr int most_wires = 16, most_exits = 16;  // of a scene; further exits are not kept
    struct Exit {
        std::int32_t wire = 0, opening = 0;
        double left = 0, back = 0;  // [s]; back 0: it has not come back
    };
    double tip[most_wires][3] = {};  // where it was last seen [m]
    std::uint8_t seen[most_wires] = {};
    std::int32_t count = 0, unused = 0;  // a checkpoint has no bytes that nobody sets
    Exit exit[most_exits] = {};
};
static_assert(std::is_trivially_copyable_v<ExitTally>);

/// @param tips  of each wire [m]  @param openings  of `mesh`, before it has moved
void watch_exits(ExitTally& tally, std::span<const Vec3> tips, std::span<const BoundaryLoop> openings, const WallMesh& mesh,
                 double time);

/// Opening beyond which a wire's tip is, -1: none.
[[nodiscard]] int outside_through(const ExitTally& tally, int wire);

/// One sentence for each, with the inlet that it left through, place and time.
[[nodiscard]] std::vector<std::string> exit_sentences(const ExitTally& tally, const std::vector<BoundaryLoop>& openings,
                                                      const Centreline& centreline, const Scene& scene);

}  // namespace seldinger

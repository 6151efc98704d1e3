// In place of engine/elastic, of a program that was built without it.
#include "contact/wall_body.h"
#include "core/error.h"

namespace seldinger {
namespace {

[[noreturn]] void refuse()
{
    throw Error(ErrorKind::BadScene,
                "vessel.wall: got \"elastic\"; expected \"rigid\": this program was built without walls that deform. "
                "Fix: vessel.wall = \"rigid\", or build it with -DSELDINGER_ELASTIC=ON");
}

}  // namespace

std::shared_ptr<const WallBody> make_wall_body(const WallModel& /*wall*/) { refuse(); }
void check_wall_body(const WallModel& /*wall*/) { refuse(); }
WallMechanics expected_mechanics(const VesselSpec& /*spec*/, const WallMesh& /*mesh*/, const Centreline& /*centreline*/)
{
    return {};
}

DefaultEdge default_wall_edge(const WallModel& /*wall*/) { return {}; }

}  // namespace seldinger

// The version that the build was configured with; by itself, since what reads files asks for it and for nothing else of a world.
#include "engine.h"

namespace seldinger {

const char* version() { return SELDINGER_VERSION; }

}  // namespace seldinger

// The version of the build; a separate file, since readers of files need it and nothing else of a world.
#include "engine.h"

namespace seldinger {

const char* version() { return SELDINGER_VERSION; }

}  // namespace seldinger

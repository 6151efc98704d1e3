// An error's text may quote a file: it is made printable here, once, for all its readers.
#include "core/error.h"

#include "core/printable.h"

namespace seldinger {

Error::Error(ErrorKind kind, const std::string& message) : std::runtime_error(printable(message)), kind_(kind) {}

}  // namespace seldinger

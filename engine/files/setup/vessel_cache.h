#pragma once
// Prepared vessels (repaired mesh, openings, centreline, tree) kept on disk, so that the next start with the same mesh skips the
// work.
//
// An entry belongs to the content of the mesh file, its unit, and this very build of the program: another build makes its own.
// Its bytes carry the key and a checksum; an entry that is damaged or not ours is removed with a note and made again.

#include "setup/vessel_load.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace seldinger {

/// Off until a program turns it on: a library writes nothing into its user's home. The environment variable
/// SELDINGER_VESSEL_CACHE has the last word: "off", or the most megabytes that the entries may take (2000 without it).
void use_vessel_cache(bool on);

/// @throws Error BadScene: SELDINGER_VESSEL_CACHE is neither "off" nor a number
[[nodiscard]] std::uint64_t vessel_cache_limit();  // [bytes], 0: off

/// What an entry depends on. @param bytes  of the mesh file. Empty where the program's build cannot be told
[[nodiscard]] std::string vessel_key(std::string_view bytes, const std::string& extension, const std::string& units,
                                     bool with_centreline);

[[nodiscard]] std::optional<LoadedVessel> find_prepared(const std::string& key);
/// Failures are silent: the vessel is there.
void keep_prepared(const std::string& key, const LoadedVessel& vessel);

}  // namespace seldinger

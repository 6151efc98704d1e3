#pragma once
// Options of the commands that take a mesh: its unit, the label of a map, and a centreline of its own.

#include "command_line.h"
#include "setup/vessel_load.h"

namespace seldinger::apps {

struct MeshOptions {
    std::filesystem::path centreline;
    std::string units, label, centreline_units, centreline_space;  // empty: not given

    /// @param units_help  of --units
    void add_to(CommandLine& command, const std::string& units_help);
    /// The first option that was given, "--units"; empty: none.
    [[nodiscard]] std::string first_given() const;
    [[nodiscard]] bool has_centreline() const { return !(centreline.string() + centreline_units + centreline_space).empty(); }
    /// The vessel of a mesh. Messages name options, not keys of a scene.
    /// @throws Error of load_vessel
    [[nodiscard]] LoadedVessel load(const std::filesystem::path& mesh, const std::string& unit) const;
};

}  // namespace seldinger::apps

#pragma once
// A first scene for a mesh without further information: its unit by its sizes, an inlet, a wire of the catalogue that fits.

#include "setup/vessel_load.h"
#include "vessel/inlets.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

/// A unit that a mesh may be in, and the sizes that its vessel would have.
struct UnitGuess {
    std::string unit;
    double lumen = 0, extent = 0;  // median lumen radius along the axis; diagonal of the box [m]
    double low = 0, high = 0;      // lumen radius that 10 and 90 % of the axis stay below [m]
    bool plausible = false;        // 0.3 to 20 mm along most of the axis, and 5 mm to 1.5 m across
    double misfit = 0;             // how unusual, as a logarithm of a ratio
};

/// Every known unit, the most likely one first. Lumens of 0.3 to 20 mm with a median of 1.2 to 13 mm, in a box of 18 to 500 mm,
/// cost nothing. Sizes outside of these ranges cost the logarithm of their ratio to the bound. Millimetres are preferred.
/// @throws Error BadFile: no mesh, or no vessel
/// @param vessel  out: loaded in `said`, or in the first of them where that is empty  @param label  of a label map
[[nodiscard]] std::vector<UnitGuess> guess_units(const std::filesystem::path& mesh, LoadedVessel& vessel,
                                                 const std::string& said = {}, const std::string& label = {});

/// The unit, its sizes and the doubt, one line. @param source  "given", "guessed from its size", ...
[[nodiscard]] std::string describe_unit(const std::vector<UnitGuess>& guesses, const UnitGuess& taken, const std::string& source);

/// Why the mesh is the surface of no vessel: openings that are nearly all holes in a side, or an axis hardly longer than the
/// lumen is wide. Empty: it may be one. A check of shape, without units.
[[nodiscard]] std::string describe_no_vessel(const LoadedVessel& vessel);

/// The longest way through the tree from an inlet.
struct WayThrough {
    std::vector<double> at;      // [P] from the inlet [m]
    std::vector<double> radius;  // [P] of the lumen [m]
    double length = 0;           // [m]
    double narrowest = 0;        // but for the last diameter before its end [m]
    double narrowest_at = 0;     // from the inlet [m]
    Vec3 narrowest_place = Vec3::Zero();
    /// How far something of this diameter gets before the lumen is too narrow for it [m].
    [[nodiscard]] double reach(double diameter) const;
};
[[nodiscard]] WayThrough way_through(const Centreline& line, const Inlet& inlet);

/// A wire of the catalogue and how far it goes.
struct WireChoice {
    std::string name, why;  // why: one line
    double diameter = 0, reach = 0;  // [m]
};
/// @param asked  of the catalogue; empty: the thickest of the usual guidewires that passes the way, else the thinnest.
/// @throws Error BadScene: no such instrument; too thick for the inlet
[[nodiscard]] WireChoice choose_wire(const WayThrough& way, const std::string& asked);

/// What the scene is written from.
struct FirstScene {
    std::filesystem::path mesh, file;  // file: where the text is to be saved
    std::string unit, unit_why, label;
    std::filesystem::path centreline;                // empty: found from the mesh
    std::string centreline_units, centreline_space;  // empty: as vessel.centreline_units, ..._space left out
    Vec3 head = Vec3::UnitZ(), back = Vec3::UnitY();  // the patient's directions
    std::string axes_why;
    std::vector<Inlet> inlets;
    int inlet = 1;  // counted from 1
    std::string inlet_why;
    WayThrough way;
    WireChoice wire;
};
/// The scene with its comments.
[[nodiscard]] std::string first_scene_text(const FirstScene& first);

}  // namespace seldinger

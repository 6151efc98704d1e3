#pragma once
// A first scene for a mesh without further information: its unit by its sizes, a way in, a wire of the catalogue that fits.

#include "scene/vessel_load.h"
#include "vessel/inlets.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

/// A unit that a mesh may be in, and the sizes that its vessel would have.
struct UnitGuess {
    std::string unit;
    double lumen = 0, extent = 0;  // median lumen radius; diagonal of the box [m]
    bool plausible = false;        // a lumen radius of 0.3 ... 20 mm and 20 ... 1000 mm across
};

/// Every known unit, the most likely one first: among plausible ones that which is nearest, by ratio, to a lumen of 3 mm in 250 mm;
/// millimetres are the habit, so that another unit has to be much nearer. @throws Error BadFile: no mesh, or no vessel
/// @param vessel  out: loaded in the first of them
[[nodiscard]] std::vector<UnitGuess> guess_units(const std::filesystem::path& mesh, LoadedVessel& vessel);

/// The longest way through the tree from a way in.
struct WayThrough {
    std::vector<double> at;      // [P] from the way in [m]
    std::vector<double> radius;  // [P] of the lumen [m]
    double length = 0;           // [m]
    double narrowest = 0;        // but for the last diameter before its end [m]
    double narrowest_at = 0;     // from the way in [m]
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
/// @throws Error BadScene: no such instrument; too thick for the way in
[[nodiscard]] WireChoice choose_wire(const WayThrough& way, const std::string& asked);

/// What the scene is written from.
struct FirstScene {
    std::filesystem::path mesh, file;  // file: where the text is to be saved
    std::string unit, unit_why;
    std::vector<Inlet> inlets;
    int inlet = 1;  // counted from 1
    WayThrough way;
    WireChoice wire;
};
/// The scene with its comments.
[[nodiscard]] std::string first_scene_text(const FirstScene& first);

}  // namespace seldinger

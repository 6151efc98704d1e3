#pragma once
// The cases of references.json, which are solved without the engine, for tests of what shares one centreline.

#include "math/vec3.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <string>
#include <vector>

namespace seldinger::test {

/// Tips, angles [deg] and torque of two instruments that are turned against each other; torsion only: the last three and the
/// lengths before the curve, in it, and of the inner one beyond the outer.
struct CoaxialReference {
    double outer, inner, alpha;
    Vec3 tip_outer, tip_inner;
    double straight, curved, beyond, outer_angle, inner_angle, torque;
};

/// Relative angle at the tip of two equal instruments, turned against each other at the base [m], [deg].
struct LagReference {
    double overlap, base, tip;
};

inline const nlohmann::json& coaxial_references()
{
    static const auto read = nlohmann::json::parse(std::ifstream(SEL_SOURCE_DIR "/tests/coaxial/references.json"));
    return read;
}

inline std::vector<CoaxialReference> coaxial_rows(const std::string& name)
{
    const auto& of = coaxial_references().at(name);
    const auto point = [](const nlohmann::json& p) { return Vec3(p.at(0), p.at(1), p.at(2)); };
    std::vector<CoaxialReference> rows;
    for (const auto& row : of.at("rows")) {
        const double straight = of.value("straight", 0.0), curved = of.value("curved", 0.0), beyond = of.value("beyond", 0.0);
        const auto inserted = row.value("inserted", std::vector<double>{straight + curved, straight + curved + beyond});
        rows.push_back({inserted.at(0), inserted.at(1), row.value("alpha_deg", 0.0), point(row.at("tip_outer")),
                        point(row.at("tip_inner")), straight, curved, beyond, row.value("outer_angle_deg", 0.0),
                        row.value("inner_angle_deg", 0.0), row.value("torque", 0.0)});
    }
    return rows;
}

inline std::vector<CoaxialReference> torsion_rows()
{
    std::vector<CoaxialReference> rows;
    for (const char* name : {"torsion_short", "torsion_transmission", "torsion_snap"})
        for (const CoaxialReference& row : coaxial_rows(name)) rows.push_back(row);
    return rows;
}

inline std::vector<LagReference> lag_rows()
{
    std::vector<LagReference> rows;
    for (const auto& row : coaxial_references().at("lag").at("rows"))
        rows.push_back({row.at("overlap"), row.at("base_deg"), row.at("tip_deg")});
    return rows;
}

}  // namespace seldinger::test

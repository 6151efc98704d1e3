#pragma once
// Views of the public reference [17_xray/carm]: an arm each, and points with the pixels that they are seen at.

#include "xray/c_arm.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

namespace seldinger::test {

struct ReferenceView {
    CArm arm;
    nlohmann::json points;  // each: point [m], column, row, magnification
};

/// @param shared  the folder with the reference data
inline std::vector<ReferenceView> reference_views(const std::filesystem::path& shared)
{
    constexpr double degree = std::numbers::pi / 180;
    const auto reference = nlohmann::json::parse(std::ifstream(shared / "reference/17_xray.json"));
    std::vector<ReferenceView> views;
    for (const auto& c : reference["cases"]) {
        if (c["kind"] != "carm") continue;
        for (const auto& view : c["expected"]["views"]) {
            CArm arm;
            arm.sid = c["inputs"]["SID"], arm.sod = c["inputs"]["SOD"];
            arm.rows = c["inputs"]["rows_columns"][0], arm.columns = c["inputs"]["rows_columns"][1];
            arm.field = c["inputs"]["pixel"].get<double>() * arm.columns;
            arm.primary = view["primary_deg"].get<double>() * degree,
            arm.secondary = view["secondary_deg"].get<double>() * degree;
            views.push_back({arm, view["points"]});
        }
    }
    return views;
}

}  // namespace seldinger::test

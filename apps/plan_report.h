#pragma once
// A plan in words, as JSON, and as scene files that `run` takes.

#include "plan/planner.h"

#include <filesystem>
#include <string>

namespace seldinger::apps {

struct PlanFiles {
    std::filesystem::path plan;      // planned.toml
    std::filesystem::path accurate;  // planned.accurate.toml, of a plan that does not meet both
    std::filesystem::path fast;      // planned.fast.toml
};
[[nodiscard]] PlanFiles plan_files(const std::filesystem::path& plan);

/// Writes what the plan has and removes what an earlier plan left there. @throws Error BadFile
void write_plan(const Plan& plan, const PlanGoals& goals, const PlanFiles& files);

[[nodiscard]] std::string plan_report(const Plan& plan, const PlanGoals& goals, const PlanFiles& files);
[[nodiscard]] std::string plan_json(const Plan& plan, const PlanGoals& goals, const PlanFiles& files);

}  // namespace seldinger::apps

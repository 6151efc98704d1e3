// What `seldinger plan` tells: the choice and its reasons in words and JSON, and the scene files of the plan.
#include "plan_report.h"

#include "core/file_io.h"
#include "io/json_text.h"
#include "scene/scene_names.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace seldinger::apps {
namespace {

using Json = nlohmann::ordered_json;

std::string length(double metres)
{
    return metres < 1e-5 ? fmt::format("{:.2g} um", 1e6 * metres) : fmt::format("{:.2g} mm", 1e3 * metres);
}

std::string percent(double share) { return fmt::format("{:.2g} %", 100 * share); }

std::string goals_text(const PlanGoals& goals)
{
    std::string text = fmt::format("shape within {} rms", length(goals.tolerance));
    if (goals.force_tolerance > 0)
        text += goals.force_is_relative ? fmt::format(", hand force within {}", percent(goals.force_tolerance))
                                        : fmt::format(", hand force within {:.3g} mN", 1e3 * goals.force_tolerance);
    if (goals.peaks.asked())
        text += goals.peaks.is_relative ? fmt::format(", peaks of force within {}", percent(goals.peaks.tolerance))
                                        : fmt::format(", peaks of force within {:.3g} mN", 1e3 * goals.peaks.tolerance);
    if (goals.rate > 0) text += fmt::format(", {:g} steps a second or more in real time", goals.rate);
    return text;
}

/// Steps of real time that could be had in a second, in the slowest stretch.
double steps_per_second(const PlannedModel& m) { return m.slowest > 0 ? 1 / (m.slowest * m.scene.dt) : 0; }

struct Band {
    double low = 0, high = 0;
};
Band band(double error, double uncertainty) { return {std::max(0.0, error - uncertainty), error + uncertainty}; }

Band shape_band(const Plan& plan, const PlannedModel& m)
{
    return band(m.error, at(plan.reference.uncertainty, Observable::Shape));
}
Band force_band(const Plan& plan, const PlannedModel& m)
{
    Band b = band(m.force_error, at(plan.reference.uncertainty, Observable::HandForce));
    return {b.low / plan.reference.force_scale, b.high / plan.reference.force_scale};
}

std::string expected(const Plan& plan, const PlannedModel& m)
{
    const Band shape = shape_band(plan, m), force = force_band(plan, m);
    return fmt::format("shape {} ({} to {}), hand force {} ({} to {})", length(m.error), length(shape.low), length(shape.high),
                       percent(m.force_error / plan.reference.force_scale), percent(force.low), percent(force.high));
}

/// "hand force 101 mN to 1.2 % (± 0.5 %)": for each peak the reference's value, the model's error and the uncertainty of both.
std::string peaks_text(const Plan& plan, const PlannedModel& m)
{
    std::string text;
    for (std::size_t k = 0; k < peak_words.size(); ++k) {
        const double right = plan.reference.values.peaks[k], share = right > 0 ? 1 / right : 0;
        text += fmt::format("{}{} {:.3g} {} to {} (+- {})", k > 0 ? ", " : "", peak_words[k].says, k == 2 ? right : 1e3 * right,
                            k == 2 ? "N/m" : "mN", percent(share * m.peak_error[k]),
                            percent(share * plan.reference.peak_uncertainty[k]));
    }
    return text;
}

Json peaks_json(const Peaks& peaks)
{
    Json json;
    for (std::size_t k = 0; k < peak_words.size(); ++k) json[std::string(peak_words[k].word)] = peaks[k];
    return json;
}

std::string speed(const PlannedModel& m)
{
    if (m.seconds == 0) return "not timed";
    if (m.scene.integrator.scheme == Scheme::Static) return fmt::format("{:.3g} ms a solution", 1e3 * m.seconds);
    return fmt::format("{:.3g} x real time ({:.3g} x in the slowest stretch)", 1 / m.seconds,
                       m.slowest > 0 ? 1 / m.slowest : 0.0);
}

/// What `run` says of a planned scene in its summary.
std::string plan_origin(const Plan& plan, const PlanGoals& goals, const PlannedModel& m, bool meets)
{
    return fmt::format("by seldinger plan for {}{}: expected {}", goals_text(goals), meets ? "" : " (which it does not meet)",
                       expected(plan, m));
}

void write_or_remove(const std::optional<PlannedModel>& model, const Plan& plan, const PlanGoals& goals,
                     const std::filesystem::path& file, bool meets)
{
    const auto folder = std::filesystem::absolute(file).parent_path();
    make_folder(folder);
    if (!model) {  // of an earlier plan
        (void)Folder(folder).remove(file.filename().string());
        return;
    }
    Scene scene = model->scene;
    scene.planned = plan_origin(plan, goals, *model, meets);
    write_file(file, write_scene(scene, folder));
}

/// Reasons for the choice of wall, from measurements.
std::string wall_reason(const Plan& plan, const PlanGoals& goals)
{
    const WallChoice& wall = *plan.wall;
    const auto off = [&] {
        return fmt::format("{} and the hand force by {}", length(wall.other_tip),
                           percent(wall.other_force / plan.reference.force_scale));
    };
    if (wall.elastic) {
        const std::string text = fmt::format("elastic, edge {}: ", length(wall.edge));
        return text + (wall.other_known
                           ? fmt::format("a rigid wall changes the tip by {}, at {:.2g} x the cost", off(), wall.cost_ratio)
                           : "with a rigid wall the run does not finish");
    }
    std::string text = fmt::format("rigid: the wall would move {}", length(wall.move));
    if (wall.move <= goals.tolerance) text += ", below the tolerance";
    if (wall.other_known)
        text += fmt::format("; an elastic one is {:.2g} x the cost and changes the tip by {}", wall.cost_ratio, off());
    return text;
}

Json model_json(const Plan& plan, const PlanGoals& goals, const PlannedModel& m, const std::filesystem::path& file)
{
    const Band shape = shape_band(plan, m), force = force_band(plan, m);
    const Scene& s = m.scene;
    Json json;
    json["file"] = file.string();
    json["model"] = label(m.model);
    if (s.wire.nodes > 0) json["nodes"] = s.wire.nodes;
    else json["nodes"] = "adaptive", json["min_edge_m"] = s.wire.min_edge, json["max_edge_m"] = s.wire.max_edge;
    json["dt_s"] = s.dt;
    json["scheme"] = word_of(scheme_words, s.integrator.scheme);
    if (s.vessel.shape != VesselShape::None) {
        json["detection"] = word_of(detection_words, s.contact.detection);
        json["normal"] = word_of(normal_words, s.contact.normal);
        json["friction"] = word_of(friction_words, s.contact.friction);
        json["rolling"] = s.contact.rolling;
        if (plan.wall) json["wall"] = word_of(wall_words, s.vessel.elastic);
    }
    json["error_m"] = m.error;
    json["error_low_m"] = shape.low;
    json["error_high_m"] = shape.high;
    json["error_worst_m"] = m.worst;
    json["force_error"] = m.force_error / plan.reference.force_scale;
    json["force_error_low"] = force.low;
    json["force_error_high"] = force.high;
    if (goals.peaks.asked()) json["peak_error"] = peaks_json(m.peak_error);
    json["outcome"] = name(m.outcome);
    json["seconds_per_second"] = m.seconds;
    json["slowest_seconds_per_second"] = m.slowest;
    json["steps_per_second"] = steps_per_second(m);
    return json;
}

const char* status_of(PlanStatus status)
{
    switch (status) {
        case PlanStatus::Planned:
            return "planned";
        case PlanStatus::NotBoth:
            return "not-both";
        case PlanStatus::BelowReference:
            return "below-reference";
        case PlanStatus::NoReference:
            return "no-reference";
        case PlanStatus::NothingHolds:
            return "nothing-holds";
        case PlanStatus::Interrupted:
            return "interrupted";
    }
    return "unknown";
}

std::string reference_text(const Plan& plan)
{
    const Reference& r = plan.reference;
    if (r.levels.empty()) return "none";
    return fmt::format("{}, after {} refinements; known to {} and {} of the hand force ({:.3g} mN rms)", label(r.model),
                       r.levels.size() - 1, length(at(r.uncertainty, Observable::Shape)),
                       percent(at(r.uncertainty, Observable::HandForce) / r.force_scale), 1e3 * r.force_scale);
}

std::string omissions(const Plan& plan)
{
    if (plan.left_out.empty()) return {};
    std::string text = fmt::format("  {:<44}{:>10}  {:>22}  {:>18}\n", "left out", "cost", "shape error", "hand force error");
    for (const Omission& o : plan.left_out) {
        const double scale = plan.reference.force_scale;
        text += o.holds ? fmt::format(
                              "    {:<42}{:>8.2f} x  {:>22}  {:>18}\n", o.what, o.cost_ratio,
                              fmt::format("{} -> {}", length(plan.chosen->error), length(o.error)),
                              fmt::format("{} -> {}", percent(plan.chosen->force_error / scale), percent(o.force_error / scale)))
                        : fmt::format("    {:<42}{}\n", o.what,
                                      o.too_dear ? "many times the cost: not run to its end"
                                                 : "stops early, or its error is more than twice the tolerance");
    }
    return text;
}

}  // namespace

PlanFiles plan_files(const std::filesystem::path& plan)
{
    const auto beside = [&](const char* word) {
        return plan.parent_path() / (plan.stem().string() + word + plan.extension().string());
    };
    return {plan, beside(".accurate"), beside(".fast")};
}

void write_plan(const Plan& plan, const PlanGoals& goals, const PlanFiles& files)
{
    write_or_remove(plan.chosen, plan, goals, files.plan, true);
    const bool planned = plan.status == PlanStatus::Planned;
    write_or_remove(planned ? std::nullopt : plan.accurate, plan, goals, files.accurate, false);
    write_or_remove(planned ? std::nullopt : plan.fast, plan, goals, files.fast, false);
}

std::string plan_report(const Plan& plan, const PlanGoals& goals, const PlanFiles& files)
{
    std::string text = fmt::format("asked      {}\n", goals_text(goals));
    const auto describe = [&](const char* what, const PlannedModel& m, const std::filesystem::path& file) {
        text += fmt::format("{:<11}{}\n", what, label(m.model));
        text += fmt::format("  expected {}{}\n", expected(plan, m),
                            m.worst > 0 ? fmt::format("; worst moment {}", length(m.worst)) : "");
        if (goals.peaks.asked()) text += fmt::format("  peaks    {}\n", peaks_text(plan, m));
        text += fmt::format("  speed    {}\n", speed(m));
        if (m.outcome == Outcome::Jitter) text += fmt::format("  hand     jitters by {} from step to step\n", percent(m.jitter));
        text += fmt::format("  written  {}\n", file.string());
    };
    if (plan.chosen) {
        describe("chosen", *plan.chosen, files.plan);
        if (goals.rate > 0)
            text +=
                fmt::format("  head-room {:.3g}: {:.4g} steps a second are possible where it is slowest, {:g} were requested\n",
                            1 / plan.chosen->slowest, steps_per_second(*plan.chosen), goals.rate);
        if (plan.wall) text += fmt::format("  wall     {}\n", wall_reason(plan, goals));
        text += omissions(plan);
    }
    if (plan.status != PlanStatus::Planned) {
        if (plan.accurate) describe("accurate", *plan.accurate, files.accurate);
        if (plan.fast) describe("fast", *plan.fast, files.fast);
    }
    text += fmt::format("reference  {}\n", reference_text(plan));
    text += fmt::format("trial runs {}, {:.1f} s\n", plan.trials, plan.spent);
    for (const std::string& note : plan.notes) text += fmt::format("note       {}\n", note);
    return text;
}

std::string plan_json(const Plan& plan, const PlanGoals& goals, const PlanFiles& files)
{
    Json json;
    json["status"] = status_of(plan.status);
    if (!plan.message.empty()) json["message"] = plan.message;
    json["tolerance_m"] = goals.tolerance;
    if (goals.force_tolerance > 0)
        json[goals.force_is_relative ? "force_tolerance" : "force_tolerance_n"] = goals.force_tolerance;
    if (goals.peaks.asked())
        json[goals.peaks.is_relative ? "peak_force_tolerance" : "peak_force_tolerance_n"] = goals.peaks.tolerance;
    if (goals.rate > 0) json["rate"] = goals.rate;
    if (plan.chosen) json["chosen"] = model_json(plan, goals, *plan.chosen, files.plan);
    if (plan.chosen && goals.rate > 0) json["head_room"] = 1 / plan.chosen->slowest;
    if (plan.status != PlanStatus::Planned) {
        if (plan.accurate) json["accurate"] = model_json(plan, goals, *plan.accurate, files.accurate);
        if (plan.fast) json["fast"] = model_json(plan, goals, *plan.fast, files.fast);
    }
    if (plan.wall) {
        const WallChoice& wall = *plan.wall;
        json["wall"] = {{"chosen", word_of(wall_words, wall.elastic)},
                        {"edge_m", wall.edge},
                        {"move_m", wall.move},
                        {"beyond_linear", wall.far},
                        {"other_known", wall.other_known},
                        {"other_cost_ratio", wall.cost_ratio},
                        {"other_tip_error_m", wall.other_tip},
                        {"other_error_m", wall.other_error},
                        {"other_force_error", wall.other_force / plan.reference.force_scale},
                        {"reason", wall_reason(plan, goals)}};
    }
    json["left_out"] = Json::array();
    for (const Omission& o : plan.left_out)
        json["left_out"].push_back({{"what", o.what},
                                    {"holds", o.holds},
                                    {"too_dear", o.too_dear},
                                    {"cost_ratio", o.cost_ratio},
                                    {"error_m", o.error},
                                    {"force_error", o.force_error / plan.reference.force_scale}});
    if (!plan.reference.levels.empty()) {
        json["reference"] = {
            {"model", label(plan.reference.model)},
            {"refinements", plan.reference.levels.size() - 1},
            {"nodes", plan.reference.model.nodes.value_or(0)},
            {"dt_s", plan.reference.model.dt.value_or(0)},
            {"uncertainty_m", at(plan.reference.uncertainty, Observable::Shape)},
            {"force_uncertainty", at(plan.reference.uncertainty, Observable::HandForce) / plan.reference.force_scale},
            {"hand_force_rms_n", plan.reference.force_scale}};
        if (goals.peaks.asked()) {
            json["reference"]["peaks"] = peaks_json(plan.reference.values.peaks);
            json["reference"]["peak_uncertainty"] = peaks_json(plan.reference.peak_uncertainty);
        }
    }
    json["touches"] = plan.touches;
    json["search_complete"] = plan.search_complete;
    json["pilots"] = plan.trials;
    json["wall_s"] = plan.spent;
    json["notes"] = plan.notes;
    return json_text(json, 2) + "\n";
}

}  // namespace seldinger::apps

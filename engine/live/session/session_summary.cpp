// Files of a session beside its record: summary and score sheet.
#include "session/session.h"

#include "io/json_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace seldinger {
namespace {

nlohmann::json quantiles(const TimeHistogram& times)
{
    return {{"count", times.count()},
            {"p50_ms", 1e3 * times.quantile(0.5)},
            {"p99_ms", 1e3 * times.quantile(0.99)},
            {"p999_ms", 1e3 * times.quantile(0.999)},
            {"worst_ms", 1e3 * times.worst()}};
}

nlohmann::json score_object(const Scene& scene, const ScoreNumbers& s)
{
    nlohmann::json limits = nlohmann::json::object();
    const TaskSpec& task = scene.task;
    if (task.wall_force > 0) limits["wall_force_n"] = task.wall_force;
    if (task.patch_force > 0) limits["patch_force_n"] = task.patch_force;
    if (task.time > 0) limits["time_s"] = task.time;
    if (task.fluoroscopy > 0) limits["fluoroscopy_s"] = task.fluoroscopy;
    return {{"task", task.text},
            {"verdict", verdict_of(task, s)},
            {"reached", s.reached != 0},
            {"limits", limits},
            {"time_s", s.time},
            {"path_length_m", s.path_length},
            {"advanced_m", s.advanced},
            {"pulled_back_m", s.pulled_back},
            {"advances", s.pushes},
            {"pull_backs", s.pull_backs},
            {"wall_force_mean_n", s.wall_force_mean},
            {"wall_force_max_n", s.wall_force_max},
            {"patch_force_max_n", s.patch_force_max},
            {"force_patch_m", scene.force_patch},
            {"time_above_limit_s", s.time_above},
            {"fluoroscopy_s", s.fluoroscopy},
            {"contrast_ml", s.contrast},
            {"distance_m", s.distance >= 0 ? nlohmann::json(s.distance) : nlohmann::json()}};
}

std::string escaped(const std::string& text)
{
    std::string out;
    for (const char c : text) {
        if (c == '<') out += "&lt;";
        else if (c == '&') out += "&amp;";
        else out += c;
    }
    return out;
}

std::string row(const char* what, const std::string& value, const std::string& limit = "")
{
    return fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td></tr>\n", what, value, limit);
}

std::string limit(double value, const char* form)
{
    return value > 0 ? fmt::format("at most {}", fmt::format(fmt::runtime(form), value)) : "";
}

}  // namespace

std::vector<int> live_instruments(const WorldSetup& setup)
{
    const int of_first = setup.systems.empty() ? 1 : setup.systems.front();
    std::vector<int> fed;
    for (int w = 0; w < of_first && static_cast<int>(fed.size()) < most_instruments; ++w)
        if (setup.wires[static_cast<std::size_t>(w)].feed.on) fed.push_back(w);
    return fed;
}

std::string score_json(const Scene& scene, const ScoreNumbers& score) { return json_text(score_object(scene, score), 2) + "\n"; }

std::string score_page(const Scene& scene, const ScoreNumbers& s)
{
    const TaskSpec& task = scene.task;
    std::string rows = row("Time", fmt::format("{:.1f} s", s.time), limit(task.time, "{:.0f} s"));
    rows += row("Path of the tip", fmt::format("{:.1f} cm", 100 * s.path_length));
    rows += row("Pushed", fmt::format("{:.1f} cm in {} strokes", 100 * s.advanced, s.pushes));
    rows += row("Pulled back", fmt::format("{:.1f} cm in {} strokes", 100 * s.pulled_back, s.pull_backs));
    rows += row("Wall force, mean", fmt::format("{:.2f} N", s.wall_force_mean));
    rows += row("Wall force, peak", fmt::format("{:.2f} N", s.wall_force_max), limit(task.wall_force, "{:.2f} N"));
    rows += row("Force on one patch, peak", fmt::format("{:.2f} N on {:.3g} mm", s.patch_force_max, 1e3 * scene.force_patch),
                limit(task.patch_force, "{:.2f} N"));
    rows += row("Time above a limit of force", fmt::format("{:.2f} s", s.time_above));
    rows += row("Fluoroscopy", fmt::format("{:.1f} s", s.fluoroscopy), limit(task.fluoroscopy, "{:.0f} s"));
    rows += row("Contrast", fmt::format("{:.1f} ml", s.contrast));
    rows += row("Target", s.reached ? "reached" : s.distance < 0 ? "none" : fmt::format("{:.1f} mm away", 1e3 * s.distance));
    return fmt::format(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta http-equiv=\"Content-Security-Policy\" "
        "content=\"default-src 'none'; style-src 'unsafe-inline'\"><meta name=\"viewport\" content=\"width=device-width\">"
        "<title>{0}: {1}</title><style>:root{{color-scheme:light dark}}body{{font:16px system-ui,sans-serif;max-width:40rem;"
        "margin:2rem auto;padding:0 1rem}}th,td{{text-align:left;padding:.3rem 1rem .3rem 0;font-weight:normal}}"
        "td{{font-variant-numeric:tabular-nums}}</style><h1>{0}: {1}</h1><p>{2}</p><table>\n{3}</table></html>\n",
        escaped(scene.name), verdict_of(task, s), escaped(task.text), rows);
}

std::string Session::summary() const
{
    const double session = static_cast<double>(pacer_.steps()) * dt_;
    nlohmann::json packets = nlohmann::json::object();
    for (int k = 0; hand_ && k < HandGate::verdict_count; ++k) {
        const auto verdict = static_cast<HandGate::Verdict>(k);
        packets[name_of(verdict)] = hand_->count(verdict);
    }
    nlohmann::json couplings = nlohmann::json::array();
    for (const Instrument& it : instruments_)
        couplings.push_back({{"energy_j", it.advance.energy() + it.turn.energy()},
                             {"advance_energy_lowest_j", it.advance.lowest_energy()},
                             {"turn_energy_lowest_j", it.turn.lowest_energy()}});
    nlohmann::json attempts = nlohmann::json::array();
    for (const ScoreNumbers& ended : attempts_) attempts.push_back(score_object(scene_, ended));
    if (score_.begun) attempts.push_back(score_object(scene_, score_));
    const Branches::Place place = watch_.branches().tip(*world_, 0);
    const double steps = static_cast<double>(std::max<std::uint64_t>(1, pacer_.steps()));
    return json_text(nlohmann::json{{"scene", scene_.name},
                                    {"version", version()},
                                    {"device", world_->device_name()},
                                    {"rate_hz", options_.rate},
                                    {"steps", pacer_.steps()},
                                    {"session_s", session},
                                    {"wall_s", ended_ - began_},
                                    {"stretched_s", pacer_.stretched()},
                                    {"late", pacer_.late()},
                                    {"woken_late", pacer_.woken_late()},
                                    {"late_share", static_cast<double>(pacer_.late()) / steps},
                                    {"cut_short", cut_short_.load()},
                                    {"step", quantiles(step_times)},
                                    {"wake_up", quantiles(wake_times)},
                                    {"input_to_force", quantiles(latencies)},
                                    {"scheduling", scheduling_},
                                    {"packets", packets},
                                    {"coupling", couplings},
                                    {"resets", resets_},
                                    {"record", options_.record.string()},
                                    {"failure", failure_},
                                    {"score", score_object(scene_, score_)},
                                    {"attempts", attempts},
                                    {"branch", place.branch},
                                    {"branch_depth_m", place.depth},
                                    {"branch_path", branches().path(place)},
                                    {"state_hash", world_->state_hash()}}, 2) + "\n";
}

}  // namespace seldinger

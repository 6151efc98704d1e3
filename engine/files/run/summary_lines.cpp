// The lines of summary.json that a run prints: forces, tip and wall with their bands, warnings, files, the answer.
#include "bands/error_band.h"
#include "run/frames.h"
#include "run/summary.h"

#include "core/error.h"

#include <fmt/format.h>
#include <cmath>
#include <nlohmann/json.hpp>

namespace seldinger {
namespace {

using Json = nlohmann::ordered_json;

/// The bands, against the same windows with shorter steps.
std::string estimate_for_people(const Json& e)
{
    if (e.at("windows").get<long>() == 0)
        return "  error of the step: not known, no window could be taken again with shorter ones\n";
    const double shortest = e.at("shortest_step_s").get<double>();
    const char* more = shortest > 1e-3 ? "; --error-estimate on takes the largest again with steps of 1 ms or less" : "";
    return fmt::format(
        "  error of the step: {} windows of {} steps taken again with steps down to {:.3g} ms; tip ± {:.2g} mm{}\n",
        e.at("windows").get<long>(), e.at("window_steps").get<int>(), 1e3 * shortest, 1e3 * e.at("tip_band_m").get<double>(),
        more);
}

/// The span of the means in the closing line, and the largest source of their bands.
std::string means_for_people(double end_seconds, const Json* estimate)
{
    if (end_seconds == 0 && !estimate) return "equilibrium; error not estimated";
    if (end_seconds == 0 && estimate->at("hand_force_peak_n").at("band").get<double>() == 0)
        return "equilibrium; no error by nodes or facets where nothing presses";
    if (end_seconds == 0)
        return fmt::format("equilibrium; ± by nodes and facets, mostly the {}: less with {}",
                           estimate->at("largest_source").get<std::string>(), estimate->at("advice").get<std::string>());
    const std::string at_end = fmt::format("{:.3g} ms", 1e3 * end_seconds);
    if (!estimate) return fmt::format("at the end the mean of {}, largest of single steps; error not estimated", at_end);
    const std::string largest = fmt::format("{:.3g} ms", 1e3 * bands::mean_time);
    return fmt::format("means of {}{}; ± mostly by the {}: less with {}", largest,
                       at_end == largest ? "" : ", at the end of " + at_end, estimate->at("largest_source").get<std::string>(),
                       estimate->at("advice").get<std::string>());
}

/// The tip's band, its largest source and what shrinks that.
std::string tip_for_people(const Json& s)
{
    const Json& e = s.at("error_estimate");
    return fmt::format("; tip ± {:.2g} mm, mostly by the {} (less with {}{})", 1e3 * e.at("tip_band_m").get<double>(),
                       e.at("tip_largest_source").get<std::string>(), e.at("tip_advice").get<std::string>(),
                       s.contains("wall_move_max_m") ? "; facets of an elastic wall are not counted" : "");
}

/// Whether bands are known: from windows, or of an equilibrium.
bool has_bands_of(const Json& s)
{
    return s.contains("error_estimate") &&
           (s.at("error_estimate").at("windows").get<long>() > 0 || s.at("error_estimate").value("equilibrium", false));
}

/// Hand and friction, with their bands where the run has any.
std::string forces_for_people(const Json& s)
{
    const bool has_bands = has_bands_of(s);
    const auto force = [&](const char* banded, const char* plain) {
        if (!has_bands)
            return s.at(plain).is_number() ? newtons(s.at(plain).get<double>(), std::nan("")) : std::string("not finite");
        const Json& e = s.at("error_estimate").at(banded);
        return newtons(e.at("value").get<double>(), e.at("band").get<double>());
    };
    const bool is_release = has_bands && s.at("error_estimate").at("hand_force_peak_n").value("sudden_release", false);
    const double span = s.value("end_mean_s", 0.0);
    return fmt::format("  hand force {} at the end, largest {}{}; friction largest {} ({}){}\n",
                       force("hand_force_n", "hand_force_mean_n"), force("hand_force_peak_n", "hand_force_max_n"),
                       is_release ? " as the wire springs free" : "", force("friction_peak_n", "friction_max_n"),
                       means_for_people(span, has_bands ? &s.at("error_estimate") : nullptr),
                       has_bands ? tip_for_people(s) : "");
}

/// Hands of the instruments but the first, a line each.
std::string other_hands_for_people(const Json& s)
{
    if (!has_bands_of(s)) return "";
    std::string text;
    for (const Json& hand : s.at("error_estimate").at("other_hands")) {
        const auto force = [&](const char* key) {
            return newtons(hand.at(key).at("value").get<double>(), hand.at(key).at("band").get<double>());
        };
        text += fmt::format("  hand force of {}: {} at the end, largest {}\n", hand.at("name").get<std::string>(),
                            force("hand_force_n"), force("hand_force_peak_n"));
    }
    return text;
}

/// The band of the largest force on a patch; NaN where it has none.
double patch_band_of(const Json& s)
{
    if (!s.contains("error_estimate")) return std::nan("");
    const Json& band = s.at("error_estimate").at("patch_force_max_n").at("band");
    return band.is_number() && band.get<double>() > 0 ? band.get<double>() : std::nan("");
}

/// The branch, or the vessel between branches, that the tip is in.
std::string place_for_people(const Json& s)
{
    const Stretch in{s.at("branch_path").get<std::string>(), "", s.at("branch").get<int>(), -1, 0, {}};
    const std::string name = s.at("branch_name").is_string() ? fmt::format(" ({})", s.at("branch_name").get<std::string>()) : "";
    const int count = s.at("branches").get<int>();
    const double depth = 1e3 * s.at("branch_depth_m").get<double>();
    if (in.path == "0" && name.empty()) return fmt::format("tip before any of {} branches", count);
    if (in.path == "0" || in.path.ends_with('+')) return fmt::format("tip in {}{}, {:.3g} mm on", in.words(), name, depth);
    return fmt::format("tip in {}{}{}, {:.3g} mm beyond its mouth", in.words(), in.number > 0 ? fmt::format(" of {}", count) : "",
                       name, depth);
}

/// What became of the task, or where the tip is.
std::string answer_for_people(const Json& s)
{
    std::string text;
    if (s.contains("task") && s.at("task").at("target").is_string()) {
        const Json& task = s.at("task");
        const std::string target = task.at("target").get<std::string>();
        if (task.at("reached").get<bool>())
            text = fmt::format("reached {} at {:.4g} mm, {:.4g} s; until then at most {} on {:.3g} mm of wall{}", target,
                               1e3 * task.at("reached_at_m").get<double>(), task.at("reached_at_s").get<double>(),
                               newtons(task.at("until_patch_force_max_n").get<double>(), std::nan("")),
                               1e3 * s.at("force_patch_m").get<double>(),
                               is_rising(task.at("until_patch_force_max_s").get<double>(), task.at("reached_at_s").get<double>())
                                   ? ", still rising"
                                   : "");
        else
            text = fmt::format("{} {}: {:.3g} mm away",
                               s.at("status").get<std::string>() == status_word(RunStatus::Done) ? "did not reach"
                                                                                                 : "not finished, on the way to",
                               target, 1e3 * task.at("distance_m").get<double>());
        if (task.at("verdict").get<std::string>() == "failed") text += "; a limit was exceeded";
    }
    if (s.contains("branch") && (text.empty() || !s.at("task").at("reached").get<bool>())) {
        text += text.empty() ? "" : "; ";
        text += place_for_people(s);
    }
    return text.empty() ? "" : text + "\n";
}

/// Displacement and stress of an elastic wall, with their bands, the largest source of these and what shrinks it.
std::string wall_for_people(const Json& s)
{
    const auto number = [&](const char* key) { return s.at(key).is_number() ? s.at(key).get<double>() : std::nan(""); };
    const auto by = [&](const char* key) {
        const Json& shares = s.at(key);
        const std::string source = shares.at("largest_source").get<std::string>(),
                          advice = shares.at("advice").get<std::string>();
        return fmt::format("mostly by {}{}", source == "linear theory" ? source : "the " + source,
                           advice.empty() ? "" : ": less with " + advice);
    };
    const bool moving = s.value("end_mean_s", 0.0) > 0, known = s.at("wall_move_max_band").at("step").is_number();
    return fmt::format(
        "  wall moves at most {:.3g} ± {:.1g} mm ({}), von Mises stress at most {:.3g} ± {:.1g} kPa ({}); control edges of "
        "{:.2g} mm where touched{}\n",
        1e3 * number("wall_move_max_m"), 1e3 * number("wall_move_max_band_m"), by("wall_move_max_band"),
        1e-3 * number("wall_stress_max_pa"), 1e-3 * number("wall_stress_max_band_pa"), by("wall_stress_max_band"),
        1e3 * number("wall_edge_touched_m"), moving && !known ? "; the step is not in the bands" : "");
}

/// Lines that `--verbose` adds: the model's size, the inlet, the bands' origin, numerics and hash.
std::string more_lines_of(const Json& s)
{
    const auto number = [&](const char* key) { return s.at(key).is_number() ? s.at(key).get<double>() : std::nan(""); };
    std::string text =
        fmt::format("  {} steps ({:.0f} a second); inserted {:.4g} cm, {} nodes, at most {} contacts; hand torque {:.4g} N m\n",
                    s.at("steps").get<long>(), number("steps_per_s"), 1e2 * number("inserted_m"), s.at("nodes").get<int>(),
                    s.at("contacts_max").get<long>(), number("hand_torque_nm"));
    if (s.contains("model") && s.at("model").contains("inlet"))
        text += "  entered at " + s.at("model").at("inlet").get<std::string>() + "\n";
    if (s.contains("error_estimate")) text += estimate_for_people(s.at("error_estimate"));
    const double share = s.contains("overlap_share_max") ? number("overlap_share_max") : 0.0;  // of overlaps with the wall
    text += fmt::format("  overlap at most {:.3g} um{}, beyond the wall {:.3g} um; Newton at most {} iterations\n",
                        1e6 * number("overlap_max_m"), share > 0 ? fmt::format(" ({:.2g} of the radius)", share) : "",
                        1e6 * number("outside_max_m"), s.at("newton_max").get<long>());
    return text + fmt::format("  state {} on {}\n", s.at("state_hash").get<std::string>(), s.at("device").get<std::string>());
}

std::string lines_of(const std::string& json, const std::filesystem::path& dir, bool verbose)
{
    const Json s = Json::parse(json);
    const auto number = [&](const char* key) { return s.at(key).is_number() ? s.at(key).get<double>() : std::nan(""); };
    std::string text =
        fmt::format("{}: {}, {:.4g} s simulated in {:.3g} s ({:.3g} x real time)\n", s.at("name").get<std::string>(),
                    s.at("status").get<std::string>(), number("simulated_s"), number("wall_s"), number("realtime_factor"));
    if (verbose) text += more_lines_of(s);
    text += forces_for_people(s) + other_hands_for_people(s);
    if (number("patch_force_max_n") > 0)
        text += fmt::format(
            "  on the wall: at most {:.4g} N/m (over {:.3g} mm), {} on {:.3g} mm of wire; {:.4g} mm in contact at most\n",
            number("force_per_length_max_n_per_m"), 1e3 * number("force_window_m"),
            newtons(number("patch_force_max_n"), patch_band_of(s)), 1e3 * number("force_patch_m"),
            1e3 * number("contact_extent_max_m"));
    if (s.contains("wall_move_max_m")) text += wall_for_people(s);
    for (const Json& warning : s.at("warnings")) text += "  note: " + warning.get<std::string>() + "\n";
    std::string files;
    for (const char* name :
         {"summary.json", "trace.csv", "wire.csv", "contacts.csv", "wire.pvd", "wire.npz", "vessel.vtp", "scene.toml"})
        if (std::filesystem::exists(dir / name)) files += fmt::format("{}{}", files.empty() ? "" : ", ", name);
    return text + fmt::format("  {}: {}\n", dir.string(), files) + answer_for_people(s);
}

}  // namespace

std::string summary_for_people(const std::string& json, const std::filesystem::path& dir, bool verbose)
{
    try {
        return lines_of(json, dir, verbose);
    } catch (const Json::exception&) {  // of a run that was done before, whose file somebody has changed
        throw Error(ErrorKind::BadFile, (dir / "summary.json").string() + ": is damaged; run again with --overwrite");
    }
}

}  // namespace seldinger

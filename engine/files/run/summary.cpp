// Assembles summary.json: model, forces, energies, stages, vessel, warnings.
#include "run/summary.h"

#include "core/error.h"
#include "io/json_text.h"
#include "bands/error_band.h"
#include "run/frames.h"
#include "setup/vessel_load.h"
#include "vessel/inlets.h"
#include "wall/wall_resolution.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace seldinger {
namespace {

using Json = nlohmann::ordered_json;

Json exits_json(const ExitTally& exits, const std::vector<BoundaryLoop>& openings, const Centreline& centreline,
                const Scene& scene)
{
    Json list = Json::array();
    for (int k = 0; k < exits.count; ++k) {
        const ExitTally::Exit& exit = exits.exit[k];
        const BoundaryLoop& rim = openings[static_cast<std::size_t>(exit.opening)];
        list.push_back({{"instrument", series_of(scene, exit.wire)},
                        {"inlet", inlet_through(openings, centreline, exit.opening)},
                        {"centre_m", {rim.centre.x(), rim.centre.y(), rim.centre.z()}},
                        {"radius_m", rim.radius},
                        {"left_s", exit.left},
                        {"back_s", exit.back > 0 ? Json(exit.back) : Json()}});
    }
    return list;
}

Json estimate_json(const ErrorEstimate& e)
{
    const auto band = [](const ErrorBand& b) -> Json {
        // let_go: the old name of sudden_release, until 0.3.0
        return {{"value", b.value},
                {"twin", b.twin},
                {"parts", b.parts},
                {"band", b.known ? Json(b.band) : Json()},
                {"step", b.step},
                {"nodes", b.nodes},
                {"facets", b.facets},
                {"largest_source", b.largest_source()},
                {"resolved", b.resolved},
                {"let_go", b.let_go},
                {"sudden_release", b.let_go}};
    };
    Json others = Json::array();
    for (const HandBands& hand : e.others)
        others.push_back({{"name", hand.name}, {"hand_force_n", band(hand.end)}, {"hand_force_peak_n", band(hand.peak)}});
    const char* of_tip = largest_share(e.tip, e.tip_nodes, e.tip_facets);
    return {{"equilibrium", e.equilibrium},
            {"windows", e.windows},
            {"failed_windows", e.failed},
            {"window_steps", e.window_steps},
            {"peak_mean_s", bands::mean_time},
            {"end_mean_s", e.end_seconds},
            {"steps", e.steps},
            {"shortest_step_s", e.dt / e.finest},
            {"from_step", e.from_step},
            {"seconds", e.seconds},
            {"hand_force_n", band(e.hand)},
            {"hand_force_peak_n", band(e.hand_peak)},
            {"friction_n", band(e.friction)},
            {"friction_peak_n", band(e.friction_peak)},
            {"patch_force_max_n", band(e.patch)},
            {"hand_work_j", band(e.work)},
            {"other_hands", others},
            {"tip_band_m", e.tip_band()},
            {"tip_step_band_m", e.tip},
            {"tip_nodes_band_m", e.tip_nodes},
            {"tip_facets_band_m", e.tip_facets},
            {"tip_largest_source", of_tip},
            {"tip_advice", advice_for(e, of_tip)},
            {"largest_source", e.hand_peak.largest_source()},
            {"advice", advice_for(e, e.hand_peak.largest_source())}};
}

/// Null where the number is not finite; its key is remembered.
class Numbers {
public:
    explicit Numbers(Json& out) : out_(out) {}
    void set(const std::string& key, double value)
    {
        if (std::isfinite(value)) out_[key] = value;
        else out_[key] = nullptr, lost_.emplace_back(key);
    }
    [[nodiscard]] const std::vector<std::string>& lost() const { return lost_; }

private:
    Json& out_;
    std::vector<std::string> lost_;
};

Json task_of(const World& world, const Scene& scene, const ScoreNumbers& s)
{
    const TaskTarget target(scene.task, WorldBranches(world).of(0), scene.source);
    const bool some = scene.task.target != TaskSpec::Target::None;
    const Vec3 at = target.mark();
    Json task = {{"target", some ? Json(target_name(scene.task)) : Json()},
                 {"target_at_m", some ? Json{at.x(), at.y(), at.z()} : Json()},
                 {"target_radius_m", some ? Json(target.mark_radius()) : Json()},
                 {"verdict", verdict_of(scene.task, s)},
                 {"reached", s.reached != 0},
                 {"reached_at_m", s.reached ? Json(s.reached_at_m) : Json()},
                 {"reached_at_s", s.reached ? Json(s.reached_at_s) : Json()},
                 {"distance_m", s.distance >= 0 ? Json(s.distance) : Json()}};
    task["until_patch_force_max_n"] = s.patch_force_max;
    task["until_patch_force_max_s"] = s.patch_force_max_time;
    task["until_wall_force_max_n"] = s.wall_force_max;
    task["until_hand_force_max_n"] = s.hand_force_max;
    task["time_above_limit_s"] = s.time_above;
    return task;
}

/// One name may have several entries: they are joined.
Json model_of(const World& world, const Scene& scene)
{
    Json model = Json::object();
    auto add = [&](const std::string& name, const std::string& value) {
        if (model.contains(name)) model[name] = model[name].get<std::string>() + "; " + value;
        else model[name] = value;
    };
    for (const auto& [name, value] : world.model()) add(name, value);
    for (const auto& [name, value] : scene.notes) add(name, value);
    if (!scene.planned.empty()) add("planned", scene.planned);
    return model;
}

Json stages_of(const RunTally& tally)
{
    const double to_ms = 1e3 / static_cast<double>(std::max<std::int64_t>(tally.steps, 1));
    const StageTimes& s = tally.stages;
    return {{"detect", s.detect * to_ms},    {"evaluate", s.evaluate * to_ms}, {"reduce", s.reduce * to_ms},
            {"solve", s.solve * to_ms},      {"wall", s.wall * to_ms},         {"adapt", s.adapt * to_ms},
            {"record", tally.record * to_ms}};
}

Json vessel_of(const RepairReport& report)
{
    Json unreached = Json::array();
    for (const Vec3& p : report.unreached) unreached.push_back({p.x(), p.y(), p.z()});
    return {{"triangles_read", report.triangles_read},
            {"triangles", report.triangles},
            {"vertices", report.vertices},
            {"openings", report.loops.size()},
            {"unreached", unreached},
            {"notes", report.notes}};
}

/// What lay on the wall, or instruments on each other.
void set_loads(Numbers& number, Json& out, const std::string& of, const LoadTally& loads)
{
    number.set(of + "force_per_length_max_n_per_m", loads.per_length);
    number.set(of + "force_per_length_max_at_m", loads.per_length_at);
    number.set(of + "force_per_length_max_at_s", loads.per_length_time);
    number.set(of + "force_window_m", loads.window);
    number.set(of + "patch_force_max_n", loads.patch_force);
    number.set(of + "patch_force_max_at_m", loads.patch_at);
    number.set(of + "patch_force_max_at_s", loads.patch_time);
    number.set(of + "force_patch_m", loads.patch);
    out[of + "contact_regions_max"] = loads.regions;
    number.set(of + "contact_extent_max_m", loads.extent);
}

void set_forces_and_energies(Numbers& number, Json& out, const RunTally& tally, const WireReadings& r)
{
    out["contacts_max"] = tally.contacts_max;
    number.set("friction_max_n", tally.friction_max);
    number.set("hand_force_n", r.hand_force);
    const EndMean::Mean end = tally.at_end(r);
    number.set("hand_force_mean_n", end.hand);
    number.set("friction_mean_n", end.friction);
    number.set("end_mean_s", end.seconds);
    number.set("hand_force_max_n", tally.hand_force_max);
    number.set("hand_force_max_at_s", tally.hand_force_time);
    number.set("hand_torque_nm", r.hand_torque);
    out["base_force_n"] = {r.base_force.x(), r.base_force.y(), r.base_force.z()};  // the JSON writer makes null of NaN
    number.set("remesh_energy_j", r.remesh_energy);
    number.set("energy_made_j", r.energy_made);
    number.set("overlap_max_m", tally.overlap_max);
    number.set("overlap_share_max", tally.overlap_share);
    number.set("outside_max_m", tally.outside_max);
    number.set("contact_area_max_m2", tally.contact_area_max);
    number.set("contact_pressure_max_pa", tally.contact_pressure_max);
    set_loads(number, out, "", tally.on_wall);
    if (tally.on_instruments.patch_force > 0) set_loads(number, out, "instruments_", tally.on_instruments);
    out["newton_max"] = tally.newton_max;
    for (const EnergyEntry& entry : energy_entries(r.energy)) number.set(entry.name, entry.value);
    number.set("energy_j", r.kinetic + r.elastic + r.gravitational);
    number.set("kinetic_j", r.kinetic);
    number.set("elastic_j", r.elastic);
    number.set("gravitational_j", r.gravitational);
}

/// The shares of a wall's band by their sources, the largest of these, and what makes it smaller.
Json shares_json(const WallBand& band, const ErrorEstimate& steps)
{
    struct Source {
        const char *name, *advice;
        double share;
    };
    const Source sources[] = {{"control mesh", "smaller vessel.wall_edge_m", band.mesh},
                              {"linear theory", "", band.geometry},
                              {"nodes", advice_for(steps, "nodes"), band.nodes},
                              {"step", advice_for(steps, "step"), band.step}};
    const Source& largest = *std::max_element(std::begin(sources), std::end(sources),
                                              [](const Source& a, const Source& b) { return a.share < b.share; });
    Json by = {{"mesh", band.mesh},
               {"geometry", band.geometry},
               {"nodes", band.nodes},
               {"step", steps.wall_known ? Json(band.step) : Json()}};
    by["largest_source"] = largest.name;
    by["advice"] = largest.advice;
    return by;
}

/// Readings of an elastic wall; a rigid one has none of these.
void set_wall(Numbers& number, Json& out, const RunTally& tally, const World& world, const ErrorEstimate& steps)
{
    const WallMechanics made = world.wall_mechanics();
    if (made.vertices == 0) return;
    const WallReadings now = world.wall_readings();
    out["wall_vertices"] = made.vertices;
    number.set("wall_edge_m", made.edge);
    number.set("wall_decay_m", made.decay);
    number.set("wall_setup_s", made.made_in);
    number.set("wall_made_s", made.made_in);  // its old name, until 0.3.0
    number.set("wall_factor_s", made.factor);
    out["wall_columns"] = made.columns;
    number.set("wall_memory_mb", 1e-6 * static_cast<double>(made.bytes));
    number.set("wall_edge_touched_m", made.edge_touched);
    const auto set_greatest = [&](const std::string& name, const std::string& unit, Greatest most, double value,
                                  const double(&at)[3], const WallBand& band, double by_step) {
        most.take_in(value, at, band, world.time());
        most.band.step = by_step;
        number.set(name + "_max_" + unit, most.value);
        number.set(name + "_max_band_" + unit, most.band.sum());
        out[name + "_max_band"] = shares_json(most.band, steps);
        out[name + "_max_at_m"] = {most.at[0], most.at[1], most.at[2]};
        number.set(name + "_max_at_s", most.time);
    };
    set_greatest("wall_move", "m", tally.wall_move, now.move_max, now.move_at, now.move_band, steps.wall_move);
    set_greatest("wall_stress", "pa", tally.wall_stress, now.stress_max, now.stress_at, now.stress_band, steps.wall_stress);
    number.set("wall_energy_j", now.energy);
    number.set("wall_loss_j", now.loss);
    out["wall_nonlinear_steps"] = tally.far_steps;
    out["wall_far_steps"] = tally.far_steps;  // its old name, until 0.3.0
}

/// Each instrument of [[instrument]] tables alone.
Json instruments_of(const World& world, const Scene& scene, std::vector<std::string>& lost)
{
    Json list = Json::array();
    for (int k = 0; k < scene.instrument_count(); ++k) {
        const WireReadings r = world.readings(k);
        const Vec3 tip = world.rod(k).pos(0);
        Json one = {{"name", scene.instrument(k).label}};
        Numbers number(one);
        number.set("inserted_m", r.inserted);
        number.set("turned_rad", r.turned);
        one["nodes"] = r.nodes;
        number.set("hand_force_n", r.hand_force);
        number.set("hand_torque_nm", r.hand_torque);
        one["tip_m"] = {tip.x(), tip.y(), tip.z()};
        for (const std::string& key : number.lost()) lost.push_back(scene.instrument(k).label + "." + key);
        list.push_back(std::move(one));
    }
    return list;
}

/// Each hub that a force drives, with its energy balance.
Json hubs_of(const World& world, const Scene& scene, std::vector<std::string>& lost)
{
    Json list = Json::array();
    for (int k = 0; k < scene.instrument_count(); ++k) {
        if (!scene.instrument(k).feed.hub.driven()) continue;
        const HubReadings r = world.readings(k).hub;
        Json one = {{"name", series_of(scene, k)}};
        Numbers number(one);
        const std::pair<const char*, double> entries[] = {
            {"speed_m_s", r.speed},        {"force_n", r.force},       {"work_j", r.work},
            {"instrument_work_j", r.wire}, {"kinetic_j", r.kinetic},   {"friction_loss_j", r.friction},
            {"damping_loss_j", r.damping}, {"stop_loss_j", r.stopped}, {"scheme_loss_j", r.scheme},
            {"energy_open_j", r.open()}};
        for (const auto& [key, value] : entries) number.set(key, value);
        for (const std::string& key : number.lost()) lost.push_back(series_of(scene, k) + ".hub." + key);
        list.push_back(std::move(one));
    }
    return list;
}

/// The wall with the edges at the place of its largest displacement; 0: it has not moved.
WallMechanics wall_where_read(const World& world, const Greatest& move)
{
    WallMechanics wall = world.wall_mechanics();
    const bool plane = world.setup().vessel.shape == VesselShape::Plane;
    wall.edge_touched = move.value > 0 ? edge_of_band(move.band.mesh / move.value, wall.decay, plane) : 0;
    return wall;
}

std::vector<std::string> all_warnings(const World& world, const RunTally& tally, const SummaryNotes& notes,
                                      const std::vector<std::string>& lost)
{
    std::vector<std::string> list = notes.scene->warnings;
    list.insert(list.end(), notes.warnings.begin(), notes.warnings.end());
    const auto share = [&](std::int64_t count) { return fmt::format("{} of {} steps", count, tally.steps); };
    if (tally.on_wall.widened)
        list.push_back(fmt::format("contact samples are {:.3g} mm apart: force per length is taken over {:.3g} mm, twice that; "
                                   "more samples (contact.samples_per_edge) make it finer",
                                   5e2 * tally.on_wall.window, 1e3 * tally.on_wall.window));
    // Divided steps are solved as well as others. But half the step has nothing to compare in them. Bands allow for that
    // (bands/step_twin.h); without bands, this share of them makes a difference too small by the factor of their safety.
    const bool has_windows = notes.estimate && notes.estimate->windows > 0;
    const double frequent = has_windows ? bands::most_divided : 1 - 1 / bands::safety;
    if (static_cast<double>(tally.halved_steps) > frequent * static_cast<double>(tally.steps))
        list.push_back(
            share(tally.halved_steps) +
            " were halved to converge: a comparison with half the step says little of the error. Fix: a smaller scene.dt_s");
    // a snap multiplies the error of float (docs/performance.md): bands are wider than that, but what is read at one instant has
    // none
    if (notes.scene->contact.precision == Precision::Float32 && tally.halved_steps > 0)
        list.push_back(fmt::format(
            "contact in float32 and {} divided steps: where a wire snaps, readings of one instant without a band, such as "
            "contact_pressure_max_pa, may be off by a quarter. Fix: take contact.precision out",
            tally.halved_steps));
    if (tally.missed_steps > 0)
        list.push_back(
            share(tally.missed_steps) +
            " missed the tolerance even in the smallest parts: their forces are not in equilibrium. Fix: a smaller scene.dt_s");
    // of the radius: at half of it the hardening law has its pole, and what is read follows the step
    constexpr double deep = 0.45;
    if (tally.overlap_share > deep)
        list.push_back(
            fmt::format("the wire overlapped the wall by {:.3g} of its radius at {:.4g} s near [{:.4g}, {:.4g}, {:.4g}] m: "
                        "what it weighs on there is not resolved; make scene.dt_s smaller, or look for a crease of the "
                        "mesh at that place",
                        tally.overlap_share, tally.overlap_time, tally.overlap_at[0], tally.overlap_at[1], tally.overlap_at[2]));
    // a wall whose stiffness the scene gives is as soft as it is meant to be
    constexpr double felt = 0.1;  // of the forces
    const double sunk = tally.normal_max > 0 ? tally.sunk_force / tally.normal_max : 0;
    if (!notes.scene->vessel.elastic && !notes.scene->vessel.youngs_given && notes.scene->contact.stiffness_from_wall &&
        sunk > felt && tally.overlap_share <= deep)
        list.push_back(fmt::format(
            "the wire sinks into the rigid wall by up to {:.2g} of its radius ({:.3g} um), at {:.4g} s near [{:.4g}, {:.4g}, "
            "{:.4g}] m. That is much of the deflection that the wall gives it: forces are too small by up to {:.0f} %. Fix: "
            "vessel.youngs_pa above its "
            "default of {:g}, with a smaller scene.dt_s; or the wall's own modulus, if it is meant to be soft",
            tally.overlap_share, 1e6 * tally.overlap_max, tally.overlap_time, tally.overlap_at[0], tally.overlap_at[1],
            tally.overlap_at[2], 1e2 * std::min(sunk, 1.0), notes.scene->vessel.youngs));
    if (notes.vessel)
        for (const std::string& sentence :
             exit_sentences(tally.exits, notes.vessel->loops, world.setup().centreline, *notes.scene))
            list.push_back(sentence);
    if (const std::string touch = describe(tally.end_touch, *notes.scene); !touch.empty()) list.push_back(touch);
    if (notes.estimate)
        for (const std::string& sentence : unresolved(*notes.estimate)) list.push_back(sentence);
    if (notes.estimate && notes.estimate->from_step > 0)
        list.push_back(
            fmt::format("bands, and the largest forces as means of 20 ms, are those from step {} on, where the run was resumed; "
                        "hand_force_max_n and friction_max_n are of all steps",
                        notes.estimate->from_step));
    if (tally.outside_steps > 0)
        list.push_back(
            share(tally.outside_steps) +
            fmt::format(" had a point of the wire's axis beyond the wall (through it, not out of an opening), {:.3g} mm at most",
                        1e3 * tally.outside_max) +
            (tally.far_steps > 0 ? ". Where a wire fills an elastic lumen, its nearest side of the wall is not unique: do not "
                                   "use this run's numbers. Fix: "
                                   "vessel.wall = \"rigid\", or a wire that fits the narrowest place (docs/failures.md)"
                                 : ""));
    if (const std::string thick = describe_thick_wall(world.setup().vessel, world.setup().centreline); !thick.empty())
        list.push_back(thick);
    if (const std::string coarse = describe_coarse_wall(wall_where_read(world, tally.wall_move), world.setup().vessel);
        !coarse.empty())
        list.push_back(coarse);
    if (tally.unequal_steps > 0)
        list.push_back(
            share(tally.unequal_steps) +
            " have contact samples that do not add up to the forces on the nodes: do not trust readings of contact in this "
            "run, and report it with the scene");
    if (tally.far_steps > 0)
        list.push_back((tally.steps > 0 ? share(tally.far_steps) : std::string("contact")) +
                       " moved the wall by more than 20 % of the lumen's radius, or its large displacements did not "
                       "settle (docs/wall.md, Large displacements and Limits)");
    if (tally.non_finite > 0)
        list.push_back(fmt::format("{} numbers were not finite: their CSV fields are empty", tally.non_finite));
    for (const std::string& key : lost) list.push_back(key + " is not finite and written as null");
    return list;
}

}  // namespace

std::array<EnergyEntry, 10> energy_entries(const EnergyLedger& ledger)
{
    return {{{"hand_work_j", ledger.hand},
             {"outside_work_j", ledger.outside + ledger.forces},
             {"material_j", ledger.material},
             {"remesh_j", ledger.remesh},
             {"friction_loss_j", ledger.friction},
             {"contact_loss_j", ledger.contact},
             {"wall_work_j", ledger.wall},
             {"damping_loss_j", ledger.damping},
             {"scheme_loss_j", ledger.scheme},
             {"energy_open_j", ledger.open()}}};
}

std::string task_json(const World& world, const Scene& scene, const ScoreNumbers& score)
{
    return json_text(task_of(world, scene, score));
}

EndMean::Mean RunTally::at_end(const WireReadings& last) const
{
    const EndMean::Mean mean = end.mean();
    return mean.seconds > 0 ? mean : EndMean::Mean{last.hand_force, last.friction, 0};
}

void RunTally::take_in(const WireReadings& readings, unsigned flags, int newton_iterations, double dt)
{
    if (dt > 0) end.add(readings.hand_force, readings.friction, dt);
    contacts_max = std::max<std::int64_t>(contacts_max, readings.contacts);
    newton_max = std::max<std::int64_t>(newton_max, newton_iterations);
    halved_steps += (flags & StepHalved) != 0;
    far_steps += (flags & StepWallFar) != 0;
    unequal_steps += (flags & StepContactSums) != 0;
    outside_steps += (flags & StepWallPenetration) != 0;
    missed_steps += (flags & StepBestEffort) != 0;
    friction_max = std::max(friction_max, readings.friction);
    hand_force_max = std::max(hand_force_max, std::abs(readings.hand_force));
    overlap_max = std::max(overlap_max, readings.overlap);
    normal_max = std::max(normal_max, readings.normal);
    constexpr double hard = 0.025;  // of the radius, of which the default wall aims at 0.02
    if (readings.overlap_share > hard && readings.elastic > 0)
        sunk_force =
            std::max(sunk_force, readings.normal * std::min(1.0, readings.normal * readings.overlap / (2 * readings.elastic)));
    outside_max = std::max(outside_max, readings.outside);
}

void Greatest::take_in(double now, const double (&where)[3], const WallBand& band_there, double when)
{
    if (!(now > value)) return;
    value = now;
    std::copy(std::begin(where), std::end(where), at);
    time = when;
    band = band_there;
}

void LoadTally::take_in(const ContactAlong& now, double time)
{
    if (now.per_length_max > per_length) {
        per_length = now.per_length_max;
        per_length_at = now.per_length_at;
        per_length_time = time;
    }
    if (now.patch_force > patch_force) {
        patch_force = now.patch_force;
        patch_at = now.patch_at;
        patch_time = time;
    }
    extent = std::max(extent, now.extent);
    regions = std::max<std::int64_t>(regions, now.regions);
    window = std::max(window, now.window);
    patch = now.patch;
    widened |= now.widened ? 1 : 0;
}

void RunTally::note_read(unsigned flags)
{
    const unsigned fresh = flags & ~static_cast<unsigned>(row_flags);
    far_steps += (fresh & StepWallFar) != 0;
    unequal_steps += (fresh & StepContactSums) != 0;
    row_flags |= fresh & (StepWallFar | StepContactSums);
}

std::string summary_json(const World& world, const RunTally& tally, const SummaryNotes& notes)
{
    Json out;
    Numbers number(out);
    const WireReadings& r = notes.readings;
    out["name"] = notes.scene->name;
    out["status"] = status_word(notes.status);
    out["steps"] = tally.steps;
    number.set("simulated_s", world.time());
    number.set("wall_s", tally.wall);
    const double wall = std::max(tally.wall, 1e-9);  // a run of no steps takes no time
    number.set("steps_per_s", static_cast<double>(tally.steps) / wall);
    number.set("realtime_factor", world.time() / wall);
    number.set("inserted_m", r.inserted);
    number.set("turned_rad", r.turned);
    out["nodes"] = r.nodes;
    if (notes.tip.stretch >= 0) {
        const Stretch& in = notes.branches.stretch(notes.tip.stretch);
        out["branch"] = notes.tip.branch;
        number.set("branch_depth_m", notes.tip.depth);
        out["branches"] = notes.branches.count();
        out["branch_path"] = in.path;
        out["branch_name"] = in.name.empty() ? Json() : Json(in.name);
    }
    if (notes.scene->task.on) out["task"] = task_of(world, *notes.scene, tally.score);
    set_forces_and_energies(number, out, tally, r);
    ErrorEstimate none;
    none.adaptive = notes.scene->wire.nodes == 0;
    set_wall(number, out, tally, world, notes.estimate.value_or(none));
    if (notes.vessel) out["left_through"] = exits_json(tally.exits, notes.vessel->loops, world.setup().centreline, *notes.scene);
    if (notes.estimate) out["error_estimate"] = estimate_json(*notes.estimate);
    std::vector<std::string> lost;
    if (!notes.scene->label.empty()) out["instruments"] = instruments_of(world, *notes.scene, lost);
    if (Json hubs = hubs_of(world, *notes.scene, lost); !hubs.empty()) out["hubs"] = std::move(hubs);
    out["halved_steps"] = tally.halved_steps;
    out["at_rest"] = world.at_rest();
    out["stage_ms"] = stages_of(tally);
    out["state_hash"] = world.state_hash();
    out["model"] = model_of(world, *notes.scene);
    if (notes.vessel && notes.vessel->triangles > 0) out["vessel"] = vessel_of(*notes.vessel);
    out["device"] = world.device_name();
    out["version"] = version();
    out["resumes"] = tally.resumes;
    lost.insert(lost.begin(), number.lost().begin(), number.lost().end());
    out["warnings"] = all_warnings(world, tally, notes, lost);
    // names may hold bytes that are not UTF-8: replaced, never a crash
    return json_text(out, 2) + "\n";
}

}  // namespace seldinger

// Windows of a run, some computed again with shorter steps.
#include "bands/step_twin.h"

#include "core/clock.h"
#include "math/end_mean.h"
#include "scene/scene.h"
#include "setup/joint_readings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace seldinger {
namespace {

/// Steps that mean_time takes.
long mean_steps(double dt) { return std::max(1L, std::lround(std::ceil(bands::mean_time / dt - 1e-9))); }

double mean(const std::vector<double>& values)
{
    double sum = 0;
    for (const double value : values) sum += value;
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// The largest mean magnitude over mean_time, or over all where they are shorter.
/// @param parts, last  the last so many steps are shorter than dt by that factor: a run ends at its time
double largest_mean(const std::vector<double>& values, double dt, int parts, double last)
{
    const std::size_t whole = values.size() - std::min<std::size_t>(parts, values.size());
    SpanMeans means(bands::mean_time);
    for (std::size_t k = 0; k < values.size(); ++k) means.add(std::abs(values[k]), k < whole ? dt : last * dt);
    return means.largest();
}

/// What a difference from steps that are shorter by a ratio is multiplied by.
double margin(double ratio)
{
    return bands::safety * std::max(ratio, bands::least_ratio) / (std::max(ratio, bands::least_ratio) - 1);
}

}  // namespace

StepTwin::StepTwin(const Scene& scene, const World& run, long taken, double spend)
    : scene_(scene),
      run_(run),
      spend_(spend),
      key_frames_(scene),
      forces_(static_cast<std::size_t>(run.wire_count()) + 1),
      friction_(forces_.size() - 1),
      patch_(forces_.size())
{
    estimate_.from_step = taken;
    estimate_.dt = scene.dt;
    estimate_.window_steps = std::max(std::isfinite(spend) ? few_steps : least_steps, mean_steps(scene.dt));
    estimate_.adaptive = scene.wire.nodes == 0;
    estimate_.others.resize(friction_ - 1);
    for (std::size_t k = 1; k < friction_; ++k)
        estimate_.others[k - 1].name = scene.instrument(static_cast<int>(k)).label;
    open(run, taken);
}

void StepTwin::open(const World& run, long taken)
{
    window_ = {};
    window_.state = run.save_state();
    window_.earlier = last_.state;
    window_.lead = last_.steps;
    window_.first = taken;
    window_.forces.resize(forces_.size());
    window_.peaks.assign(forces_.size() + 1, 0.0);
}

void StepTwin::stepped(const World& run, const WireReadings& readings, long taken, const LargestReadings& largest)
{
    const auto begun = Clock::now();
    if (seen_ > 0 || estimate_.from_step == 0) {
        window_.has_patch |= largest.patch > largest_.patch;
        window_.has_wall |= largest.wall_move > largest_.wall_move || largest.wall_stress > largest_.wall_stress;
        const double way = readings.inserted - inserted_;
        path_ += std::abs(way);
        pushed_ += std::abs(readings.hand_force * way);
        rubbed_ += readings.friction * std::abs(way);
    }
    largest_ = window_.largest = largest;
    inserted_ = readings.inserted;
    work_ = readings.energy.hand;
    motion_loss_ = readings.energy.scheme + readings.energy.contact + readings.energy.damping;
    ++window_.steps, ++seen_, ++ungauged_;
    window_.lengths += 1.0 / joint_report(run, 0).sub_steps;
    const double dt = scene_.step_length(taken - 1);
    window_.struck.add(readings.normal, dt);
    for (std::size_t k = 0; k < forces_.size(); ++k) {
        const double force = k == friction_ ? readings.friction : run.readings(static_cast<int>(k)).hand_force;
        window_.forces[k].push_back(force);
        forces_[k].falls.add(std::abs(force), dt);
        forces_[k].release.add(std::abs(force), dt);
    }
    window_.tip = run.rod(0).pos(0);
    if (estimate_.from_step == 0 && seen_ == std::min(2 * mean_steps(scene_.dt), estimate_.window_steps)) {
        start_ = window_;
        set_peaks(start_);
    }
    if (taken % estimate_.window_steps == 0) {
        close();
        open(run, taken);
    }
    estimate_.seconds += seconds_since(begun);
}

void StepTwin::gauge(const World& run)
{
    const GridErrors now = gauge_.of(run);
    if (now.normal > 0) axial_.add(now.axial), rise_.add(now.rise), tip_facets_.add(now.tip);
    window_.grid = grid_;
    window_.grid.widen(now);
    grid_ = now;
    for (double GridShare::*by : {&GridShare::nodes, &GridShare::facets})
        work_errors_.*by += window_.grid.pressed.*by * rubbed_;
    rubbed_ = 0;
    if (closed_ > 0) work_errors_.nodes += std::max(0.0, motion_loss_ - motion_loss_then_);
    motion_loss_then_ = motion_loss_;
    ungauged_ = 0;
}

double StepTwin::last_length(const Window& window) const
{
    return scene_.step_length(window.first + window.steps - 1) / scene_.dt;
}

void StepTwin::set_peaks(Window& window) const
{
    for (std::size_t k = 0; k < forces_.size(); ++k)
        window.peaks[k] = largest_mean(window.forces[k], scene_.dt, 1, last_length(window));
}

/// The window is over: compared now, or kept for the end if it may be among the compared ones.
void StepTwin::close()
{
    if (window_.steps == 0) return;
    set_peaks(window_);
    const auto leads = [&](std::size_t k) {
        const Window& best = forces_[k].best;
        return best.steps > 0 ? window_.peaks[k] > best.peaks[k] : window_.peaks[k] > 0 || (k > 0 && k < friction_);
    };
    bool leading = window_.has_patch;
    for (std::size_t k = 0; k < forces_.size(); ++k) leading |= leads(k);
    const bool is_due = leading && (2 * ungauged_ >= least_steps || !(grid_.normal > 0));
    if (ungauged_ >= least_steps || (ungauged_ > 0 && is_due)) gauge(run_);
    else if (ungauged_ > 0) window_.grid = grid_;
    if (++closed_ % periodic == 0 && affords(2 * window_.steps, spend_ / 2)) (void)examine_halved(window_);
    for (std::size_t k = 0; k < forces_.size(); ++k)
        if (leads(k)) forces_[k].best = window_;
    if (window_.has_patch) best_patch_ = window_;
    if (window_.has_wall) best_wall_ = window_;
    if (window_.struck.largest() > best_strike_.struck.largest()) best_strike_ = window_;
    last_ = std::move(window_);
}

bool StepTwin::affords(long steps, double share) const
{
    return static_cast<double>(estimate_.steps + steps) <= share * static_cast<double>(seen_);
}

const StepTwin::Examined* StepTwin::known(const Window& window, int parts, long lead) const
{
    for (const std::unique_ptr<Examined>& one : examined_)
        if (one->first == window.first && one->steps == window.steps && one->parts == parts && one->lead == lead)
            return one.get();
    return nullptr;
}

const StepTwin::Examined& StepTwin::examine(const Window& window, int parts, long lead)
{
    if (const Examined* before = known(window, parts, lead)) return *before;
    examined_.push_back(std::make_unique<Examined>(take_again(window, parts, lead)));
    return *examined_.back();
}

const StepTwin::Examined& StepTwin::examine_halved(const Window& window, bool anyway)
{
    static const Examined too_dear{.looked = false};
    const int parts = window.lengths < bands::much_divided * static_cast<double>(window.steps) ? 4 : 2;
    const bool is_done = anyway || known(window, parts, 0) || affords(parts * window.steps, spend_);
    return is_done ? examine(window, parts, 0) : too_dear;
}

StepTwin::Examined StepTwin::take_again(const Window& window, int parts, long lead)
{
    // no window: the run has none, or was never above zero, which a twin of nothing says too
    Examined twin;
    twin.first = window.first;
    twin.steps = window.steps;
    twin.run = twin.peaks = window.steps > 0 ? window.peaks : std::vector<double>(forces_.size() + 1);
    twin.lead = lead;
    twin.parts = parts;
    twin.found = window.steps == 0 && closed_ > 0;
    if (window.steps == 0) return twin;
    if (!world_) {
        world_ = std::make_unique<World>(run_.twin());
        world_->stop_when(stop_asked_);
    }
    twin.forces.resize(forces_.size());
    double lengths = 0;
    LargestFall struck(bands::mean_time), swing(bands::mean_time);
    world_->restore_state(lead > 0 ? window.earlier : window.state);
    for (long k = -lead * parts; k < parts * window.steps; ++k) {
        const double dt = scene_.step_length(window.first + (k + lead * parts) / parts - lead) / parts;
        const StepReport report = step(*world_, key_frames_.control(), dt);
        ++estimate_.steps;
        if (report.failed() || (report.flags & StepStopped)) {
            ++estimate_.failed;
            return twin;
        }
        if (k < 0) continue;
        lengths += 1.0 / joint_report(*world_, 0).sub_steps;
        const WireReadings now = joint_readings(*world_, 0);
        for (std::size_t f = 0; f < forces_.size(); ++f)
            twin.forces[f].push_back(f == friction_ ? now.friction : world_->readings(static_cast<int>(f)).hand_force);
        if (window.has_wall) {
            world_->read(under_, Output::WallUnder);  // stress everywhere takes as long as some steps
            const WallReadings& wall = under_.walls.front().readings;
            twin.largest.wall_move = std::max(twin.largest.wall_move, wall.move_max);
            twin.largest.wall_stress = std::max(twin.largest.wall_stress, wall.stress_max);
        }
        double patch = 0;
        WireOutput loads;
        for (int w = 0; w < world_->wire_count(); ++w) {
            world_->read_loads(w, loads);
            patch = std::max(patch, loads.on_wall.patch_force);
        }
        twin.largest.patch = std::max(twin.largest.patch, patch);
        struck.add(now.normal, dt);
        swing.add(patch, dt);
    }
    twin.found = true;
    twin.ratio = window.lengths * parts * parts / lengths;
    twin.tip = (world_->rod(0).pos(0) - window.tip).norm();
    swing_ = std::max(swing_, twin.swing = swing.largest());
    for (std::size_t f = 0; f < forces_.size(); ++f)
        twin.peaks[f] = largest_mean(twin.forces[f], scene_.dt / parts, parts, last_length(window));
    twin.peaks[patch_] = twin.largest.patch;
    // a window that has not the run's largest has one that differs from the twin's as far as its strikes do
    const double by_strikes = twin.largest.patch + window.struck.largest() - struck.largest();
    twin.run[patch_] = window.has_patch ? window.largest.patch : std::clamp(by_strikes, 0.0, window.largest.patch);
    if (!window.is(start_)) compare(window, twin);  // that of the start tells of largest values, nothing of other windows
    return twin;
}

/// A history that differs is seen in other windows, too: the last one alone gives bands that do not hold.
void StepTwin::compare(const Window& window, Examined& twin)
{
    ++estimate_.windows;
    const double times = margin(twin.ratio);
    for (std::size_t f = 0; f < forces_.size(); ++f) {
        const double now = mean(window.forces[f]), off = times * (now - mean(twin.forces[f]));
        forces_[f].means.add(off);
        forces_[f].peaks.add(times * (window.peaks[f] - twin.peaks[f]));
        if (std::abs(now) > bands::least_force) forces_[f].relative.add(std::min(1.0, std::abs(off / now)));
        if (f == 0) mean_differences_ += std::abs(off);
    }
}

const StepTwin::Examined& StepTwin::examine_largest(const Window& window, Finer finer)
{
    const Examined& halved = examine_halved(window);
    const int parts = static_cast<int>(
        std::clamp(std::lround(scene_.dt / bands::fine_step), 2L, static_cast<long>(bands::most_parts)));
    const long cost = parts * (window.lead + window.steps);
    const bool is_cheap = static_cast<double>(cost) <= bands::cheap * static_cast<double>(seen_) && affords(cost, spend_);
    if (!halved.looked || parts == 2 || !(finer == Finer::Always || (finer == Finer::WhereCheap && is_cheap))) return halved;
    const Examined& fine = examine(window, parts, window.lead);
    if (!fine.found) return halved;
    estimate_.finest = parts;
    return fine;
}

double StepTwin::end_of(const Window& window, const std::vector<double>& force, int parts, double* seconds) const
{
    EndMean mean;
    for (std::size_t k = 0; k < force.size(); ++k)
        mean.add(force[k], 0, scene_.step_length(window.first + static_cast<long>(k) / parts) / parts);
    if (seconds) *seconds = mean.mean().seconds;
    return mean.mean().hand;
}

ErrorBand StepTwin::band_of(double value, double of_twin, const Examined& twin, double least, double history) const
{
    if (twin.looked && !twin.found) return {value, 0, 0, false};
    ErrorBand made{value, twin.looked ? of_twin : value};
    made.parts = twin.parts;
    made.step = std::max({margin(twin.ratio) * std::abs(value - made.twin), least, history * std::abs(value)});
    made.band = made.step;
    made.resolved = made.is_resolved();
    return made;
}

ErrorBand StepTwin::end_band(std::size_t f, const Window& end, const Examined& twin) const
{
    return band_of(end_of(end, end.forces[f], 1), twin.found ? end_of(end, twin.forces[f], twin.parts) : 0, twin,
                   forces_[f].means.root(), forces_[f].history);
}

double StepTwin::bound_by(const Examined& twin, std::size_t which)
{
    return twin.run[which] + margin(twin.ratio) * (twin.peaks[which] - twin.run[which]);
}

/// Reaches up to the largest that the value may be with any step in a window that was compared, by the finest twin of each.
ErrorBand StepTwin::peak_band(double value, const Examined& twin, std::size_t which, double least, double history) const
{
    ErrorBand band = band_of(value, twin.found ? twin.peaks[which] : 0, twin, least, history);
    if (twin.looked && !twin.found) return band;
    double expected = band.step_part * band.step, bound = 0, largest = 0;
    for (const std::unique_ptr<Examined>& one : examined_) {
        const auto is_finer = [&](const std::unique_ptr<Examined>& other) {
            return other->found && other->first == one->first && other->steps == one->steps && other->parts > one->parts;
        };
        if (!one->found || std::ranges::any_of(examined_, is_finer)) continue;
        bound = std::max(bound, bound_by(*one, which));
        largest = std::max(largest, one->peaks[which]);
    }
    if (bound - value > band.step) {
        expected = std::max(expected, largest - value);
        band.step = band.band = bound - value;
        band.twin = std::max(band.twin, largest);
    }
    // single values of a wire that sticks, slips and strikes have no order in the step
    if (which == patch_) expected = std::abs(band.twin - value);
    if (band.step > 0) band.step_part = expected / band.step;
    band.resolved = band.is_resolved();
    return band;
}

ErrorBand StepTwin::force_peak(std::size_t f, const Examined& twin) const
{
    const Force& force = forces_[f];
    const double peak = force.best.steps > 0 ? force.best.peaks[f] : 0;
    ErrorBand band = peak_band(peak, twin, f, std::max(force.peaks.root(), twin.looked ? 0 : force.relative.root() * peak),
                               force.history);
    band.let_go = (twin.found || !twin.looked) && force.release.bound() > band.step;
    if (band.let_go) band.widen(force.release.bound());
    return band;
}

void StepTwin::complete(ErrorBand& band, const GridShare& grid, double pushing, double more) const
{
    const bool step_known = band.resolved || band.band > 0;
    const double distance = seen_ > 0 ? path_ * bands::mean_time / (static_cast<double>(seen_) * scene_.dt) : 0;
    const double push = distance > 0 ? std::min(axial_.root(), rise_.root() / distance) : axial_.root();
    band.nodes = grid.nodes + more;
    band.facets = grid.facets + push * std::abs(pushing);
    band.sum_up();
    band.resolved = step_known && band.is_resolved();
}

void StepTwin::set_hand(std::size_t k, const Window& end, const Examined& of_end, Finer finer)
{
    ErrorBand& at_end = k == 0 ? estimate_.hand : estimate_.others[k - 1].end;
    ErrorBand& at_peak = k == 0 ? estimate_.hand_peak : estimate_.others[k - 1].peak;
    const Window& best = forces_[k].best;
    if (k > 0 && best.steps == 0) return;
    at_end = end_band(k, end, of_end);
    at_peak = force_peak(k, examine_largest(best, finer));
    // of the first hand, friction and what pushes the wire back are known apart
    const auto share = [&](const GridErrors& e, double force, double friction) {
        return k == 0 ? of_hand(e, force, friction) : times(e.energy, force);
    };
    const double rubs = end_of(end, end.forces[friction_], 1), rubbed = best.steps > 0 ? best.peaks[friction_] : 0;
    complete(at_end, share(end.grid, at_end.value, rubs), end.grid.normal, of_hand_at(end.grid, k));
    complete(at_peak, share(best.grid, at_peak.value, rubbed), best.grid.normal, of_hand_at(best.grid, k));
}

void StepTwin::set_friction(const Window& end, const Examined& of_end, Finer finer)
{
    const Window& best = forces_[friction_].best;
    ErrorBand &at_end = estimate_.friction, &at_peak = estimate_.friction_peak;
    at_end = end_band(friction_, end, of_end);
    at_peak = force_peak(friction_, examine_largest(best, finer));
    complete(at_end, times(end.grid.pressed, at_end.value), at_end.value);
    complete(at_peak, times(best.grid.pressed, at_peak.value), at_peak.value);
}

void StepTwin::set_patch()
{
    ErrorBand& band = estimate_.patch;
    if (best_patch_.steps == 0) {  // none, or one from before the run was resumed
        band.value = largest_.patch;
        band.known = largest_.patch == 0;
        return;
    }
    const double patch = largest_.patch;
    const Examined& twin = examine_halved(best_patch_);
    band = peak_band(patch, twin, patch_, 0, forces_[0].history);
    if (twin.found || !twin.looked) band.widen(twin.found ? twin.swing : swing_);
    const bool strikes = best_strike_.struck.largest() > bands::least_strike * patch;
    if (strikes && affords(bands::strike_parts * best_strike_.steps, spend_)) {
        const Examined& strike = examine(best_strike_, bands::strike_parts, 0);
        if (strike.found) band.widen(bound_by(strike, patch_) - patch);
    } else if (strikes) {  // not taken again, it is believed to be off by all of itself
        band.widen(bands::safety * best_strike_.struck.largest());
    }
    complete(band, times(best_patch_.grid.patch, patch), patch);
    add_places(band, best_patch_.grid);
}

void StepTwin::set_wall()
{
    if (best_wall_.steps == 0) return;
    const Examined& twin = examine_halved(best_wall_, true);
    if (!twin.found) return;
    estimate_.wall_known = true;
    // no window knows of another history before it; where nothing has touched the wall there is none
    const double history = largest_.patch > 0 ? forces_[friction_].history : 0;
    const auto share = [&](double run, double of_twin) {
        return std::max(margin(twin.ratio) * std::abs(run - of_twin), history * run);
    };
    estimate_.wall_move = share(largest_.wall_move, twin.largest.wall_move);
    estimate_.wall_stress = share(largest_.wall_stress, twin.largest.wall_stress);
}

/// A sum: the mean difference of forces over the whole path; the histories of n windows add up to sqrt(n) times that of one.
void StepTwin::set_work()
{
    ErrorBand& band = estimate_.work;
    band.value = work_;
    band.known = run_.wire_count() == 1 && estimate_.from_step == 0 && estimate_.windows > 0;
    if (!band.known) return;
    const long alike_for = std::max(least_steps, mean_steps(scene_.dt));
    const double alike = std::max(1.0, static_cast<double>(seen_) / static_cast<double>(alike_for));
    band.step = std::max(path_ * mean_differences_ / static_cast<double>(estimate_.windows),
                         forces_[0].history * pushed_ / std::sqrt(alike));
    band.nodes = grid_.missed.nodes + work_errors_.nodes;
    band.facets = grid_.missed.facets + work_errors_.facets;
    band.sum_up();
    band.resolved = band.expected() <= std::max(bands::wanted * std::abs(work_), bands::least_force * path_);
}

ErrorEstimate StepTwin::finish(Finer finer)
{
    const auto begun = Clock::now();
    // a few steps say little of the end: the whole window before them is added
    const bool short_end = window_.steps < estimate_.window_steps / 2 || window_.steps < mean_steps(scene_.dt);
    if (window_.steps > 0) gauge(run_);
    Window end = short_end && last_.steps > 0 ? last_ : window_;
    if (short_end && last_.steps > 0 && window_.steps > 0) {
        end.steps += window_.steps;
        for (std::size_t k = 0; k < forces_.size(); ++k)
            end.forces[k].insert(end.forces[k].end(), window_.forces[k].begin(), window_.forces[k].end());
        end.lengths += window_.lengths;
        end.tip = window_.tip;
        end.has_patch |= window_.has_patch;
        end.has_wall |= window_.has_wall;
        end.largest = window_.largest;
        end.grid.widen(window_.grid);
    }
    set_peaks(end);
    if (window_.steps > 0) {  // alone it may be shorter than a mean
        window_ = end;
        close();
    }
    for (std::size_t k = 0; k < forces_.size(); ++k)
        forces_[k].history = (k == friction_ ? bands::friction_history : bands::hand_history) *
                             std::max(bands::least_history, forces_[k].falls.share());
    if (end.is(start_)) start_ = {};
    const Examined& of_end = examine_halved(end, true);
    // the most telling first, while the run's share of steps lasts
    if (forces_[0].best.steps > 0) (void)examine_halved(forces_[0].best);
    if (best_patch_.steps > 0) (void)examine_halved(best_patch_);
    if (start_.steps > 0) (void)examine_halved(start_);
    estimate_.tip = of_end.found ? margin(of_end.ratio) * of_end.tip : 0;
    estimate_.tip_nodes = run_.node_error(0);
    estimate_.tip_facets = std::max(end.grid.tip, tip_facets_.root());  // swings from facet to facet
    (void)end_of(end, end.forces[0], 1, &estimate_.end_seconds);
    for (std::size_t k = 0; k < friction_; ++k) set_hand(k, end, of_end, finer);
    set_friction(end, of_end, finer);
    set_patch();
    set_work();
    set_wall();
    estimate_.seconds += seconds_since(begun);
    return estimate_;
}

}  // namespace seldinger

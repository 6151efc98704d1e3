// Windows of a run, some computed again with shorter steps.
#include "bands/step_twin.h"

#include "core/clock.h"
#include "setup/joint_readings.h"
#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace seldinger {

namespace {

/// Steps that mean_time takes.
long mean_steps(double dt) { return std::max(1L, std::lround(std::ceil(StepTwin::mean_time / dt - 1e-9))); }

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
    SpanMeans means(StepTwin::mean_time);
    for (std::size_t k = 0; k < values.size(); ++k) means.add(std::abs(values[k]), k < whole ? dt : last * dt);
    return means.largest();
}

/// Root mean square of differences between means over mean_time of a run and of a twin with steps of 1/parts as long.
double usual_difference(const std::vector<double>& run, const std::vector<double>& twin, double dt, int parts)
{
    const auto p = static_cast<std::size_t>(parts);
    SpanMeans means(StepTwin::mean_time);
    MeanSquare all;
    for (std::size_t k = 0; k < run.size(); ++k) {
        double difference = run[k];
        for (std::size_t j = 0; j < p; ++j) difference -= twin[p * k + j] / parts;
        means.add(difference, dt);
        if (means.full() || k + 1 == run.size()) all.add(means.mean());
    }
    return all.root();
}

// No band is narrower than this share of its value. Windows begin at the state of the run. They see neither the effect of its
// history nor slips that come earlier or later. The shares are calibrated, not derived, on the scenes of bench/readings.py and of
// the tests. There, windows of some runs agreed to 0.1 %. Their 20 ms means still differed by up to 2.6 % (hand force) and 6.6 %
// (friction) from those with 4 to 67 x shorter steps.
// Where forces only rise there is no history to differ: with less falling than the largest value itself, the shares are in
// proportion.
constexpr double hand_history = 0.03, friction_history = 0.07;

/// What a difference from steps that are shorter by a ratio is multiplied by.
double margin(double ratio)
{
    return StepTwin::safety * std::max(ratio, StepTwin::least_ratio) / (std::max(ratio, StepTwin::least_ratio) - 1);
}

ErrorBand band_of(double value, double twin, int parts, double ratio, double least, double history)
{
    ErrorBand made{value, twin, margin(ratio) * std::abs(value - twin), true, false, parts};
    made.step = made.band = std::max({made.band, least, history * std::abs(value)});
    made.resolved = StepTwin::is_resolved(made);
    return made;
}

void widen(ErrorBand& band, double bound)
{
    if (bound <= band.step) return;
    band.step_part *= band.step / bound;
    band.step = band.band = bound;
}

/// The band of a force that lets go at its largest is what the time of the release leaves, where that is more: a bound, of which
/// no more is expected than before.
void widen(ErrorBand& band, const ReleaseWatch& release)
{
    if (release.bound() <= band.step) return;
    widen(band, release.bound());
    band.let_go = true;
}

/// Where along the wire the load lies, and whether that of the next node lies on the same patch: the band holds all of it. These
/// are bounds and no expected errors, and so no reason for a warning.
void add_places(ErrorBand& band, const GridErrors& e)
{
    band.nodes = std::hypot(band.nodes, e.placed.nodes * band.value) + e.split * band.value;
    band.facets = std::hypot(band.facets, e.placed.facets * band.value);
    band.sum_up();
}

/// Of a hand force of which `friction` is friction and the rest what pushes the wire back.
GridShare of_hand(const GridErrors& e, double hand, double friction)
{
    const double back = std::abs(std::abs(hand) - friction);
    return {e.energy.nodes * back + e.pressed.nodes * friction, e.energy.facets * back + e.pressed.facets * friction};
}

GridShare times(const GridShare& share, double force) { return {share.nodes * std::abs(force), share.facets * std::abs(force)}; }

/// What nodes do to the hand of an instrument besides.
double of_hand_at(const GridErrors& e, std::size_t instrument) { return instrument < e.hands.size() ? e.hands[instrument] : 0; }

}  // namespace

StepTwin::StepTwin(const Scene& scene, const World& run, long taken)
    : scene_(scene),
      run_(run),
      key_frames_(scene)
{
    estimate_.from_step = taken;
    estimate_.dt = scene.dt;
    estimate_.window_steps = std::max(least_steps, mean_steps(scene.dt));
    estimate_.adaptive = scene.wire.nodes == 0;
    estimate_.others.resize(static_cast<std::size_t>(run.wire_count() - 1));
    for (std::size_t k = 0; k < estimate_.others.size(); ++k)
        estimate_.others[k].name = scene.instrument(static_cast<int>(k) + 1).label;
    others_.resize(estimate_.others.size());
    open(run, taken);
}

void StepTwin::open(const World& run, long taken)
{
    window_ = {};
    window_.state = run.save_state();
    window_.earlier = last_.state;
    window_.lead = last_.steps;
    window_.first = taken;
    window_.others.resize(others_.size());
    window_.peaks.others.assign(others_.size(), 0.0);
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
        window_rubbed_ += readings.friction * std::abs(way);
    }
    largest_ = window_.largest = largest;
    inserted_ = readings.inserted;
    work_ = readings.energy.hand;
    motion_loss_ = readings.energy.scheme + readings.energy.contact + readings.energy.damping;
    ++window_.steps;
    ++seen_;
    window_.lengths += 1.0 / joint_report(run, 0).sub_steps;
    window_.hand.push_back(readings.hand_force);
    window_.friction.push_back(readings.friction);
    const double dt = scene_.step_length(taken - 1);
    window_.struck.add(readings.normal, dt);
    hand_falls_.add(std::abs(readings.hand_force), dt);
    friction_falls_.add(readings.friction, dt);
    hand_release_.add(std::abs(readings.hand_force), dt);
    friction_release_.add(readings.friction, dt);
    for (std::size_t k = 0; k < others_.size(); ++k) {
        window_.others[k].push_back(run.readings(static_cast<int>(k) + 1).hand_force);
        others_[k].add(window_.others[k].back(), dt);
    }
    window_.tip = run.rod(0).pos(0);
    if (estimate_.from_step == 0 && seen_ == std::min(2 * mean_steps(scene_.dt), estimate_.window_steps)) {
        Window start = window_;
        set_peaks(start);
        starting_ = true;
        (void)examine_halved(start);
        starting_ = false;
    }
    if (taken % estimate_.window_steps == 0) {
        gauge(run);
        close();
        open(run, taken);
    }
    estimate_.seconds += seconds_since(begun);
}

void StepTwin::gauge(const World& run)
{
    const GridErrors now = gauge_.of(run);
    estimate_.tip_nodes = std::max(estimate_.tip_nodes, run.node_error(0));
    estimate_.tip_facets = std::max(estimate_.tip_facets, now.tip);
    if (now.normal > 0) axial_.add(now.axial), rise_.add(now.rise);
    window_.grid = grid_;
    window_.grid.widen(now);
    grid_ = now;
    for (double GridShare::*by : {&GridShare::nodes, &GridShare::facets})
        work_errors_.*by += window_.grid.pressed.*by * window_rubbed_;
    window_rubbed_ = 0;
    if (closed_ > 0) work_errors_.nodes += std::max(0.0, motion_loss_ - motion_loss_then_);
    motion_loss_then_ = motion_loss_;
}

double StepTwin::last_length(const Window& window) const
{
    return scene_.step_length(window.first + window.steps - 1) / scene_.dt;
}

void StepTwin::set_peaks(Window& window) const
{
    const auto peak_of = [&, last = last_length(window)](const std::vector<double>& values) {
        return largest_mean(values, scene_.dt, 1, last);
    };
    window.peaks.hand = peak_of(window.hand);
    window.peaks.friction = peak_of(window.friction);
    for (std::size_t k = 0; k < window.others.size(); ++k) window.peaks.others[k] = peak_of(window.others[k]);
}

/// The window is over: compared now, or kept for the end if it may be among the compared ones.
void StepTwin::close()
{
    if (window_.steps == 0) return;
    set_peaks(window_);
    if (++closed_ % periodic == 0) (void)examine_halved(window_);
    if (window_.peaks.hand > best_hand_.peaks.hand) best_hand_ = window_;
    if (window_.peaks.friction > best_friction_.peaks.friction) best_friction_ = window_;
    if (window_.has_patch) best_patch_ = window_;
    if (window_.has_wall) best_wall_ = window_;
    if (window_.struck.largest() > best_strike_.struck.largest()) best_strike_ = window_;
    for (std::size_t k = 0; k < others_.size(); ++k)
        if (others_[k].best.steps == 0 || window_.peaks.others[k] > others_[k].best.peaks.others[k]) others_[k].best = window_;
    last_ = std::move(window_);
}

const StepTwin::Examined& StepTwin::examine(const Window& window, int parts, long lead)
{
    for (const std::unique_ptr<Examined>& known : examined_)
        if (known->first == window.first && known->steps == window.steps && known->parts == parts && known->lead == lead)
            return *known;
    examined_.push_back(std::make_unique<Examined>(take_again(window, parts, lead)));
    return *examined_.back();
}

const StepTwin::Examined& StepTwin::examine_halved(const Window& window)
{
    return examine(window, window.lengths < much_divided * static_cast<double>(window.steps) ? 4 : 2, 0);
}

StepTwin::Examined StepTwin::take_again(const Window& window, int parts, long lead)
{
    // no window: the run has none, or was never above zero, which a twin of nothing says too
    Examined twin;
    twin.first = window.first;
    twin.steps = window.steps;
    twin.run = window.peaks;
    twin.lead = lead;
    twin.parts = parts;
    twin.found = window.steps == 0 && closed_ > 0;
    if (window.steps == 0) return twin;
    if (!world_) {
        world_ = std::make_unique<World>(run_.twin());
        world_->stop_when(stop_asked_);
    }
    twin.others.resize(others_.size());
    double lengths = 0;
    LargestFall struck(mean_time), swing(mean_time);
    world_->restore_state(lead > 0 ? window.earlier : window.state);
    for (long k = -lead * parts; k < parts * window.steps; ++k) {
        const long of_run = window.first + (k + lead * parts) / parts - lead;
        const StepReport report = step(*world_, key_frames_.control(), scene_.step_length(of_run) / parts);
        ++estimate_.steps;
        if (report.failed() || (report.flags & StepStopped)) {
            ++estimate_.failed;
            return twin;
        }
        if (k < 0) continue;
        lengths += 1.0 / joint_report(*world_, 0).sub_steps;
        const WireReadings now = joint_readings(*world_, 0);
        twin.hand.push_back(now.hand_force);
        twin.friction.push_back(now.friction);
        for (std::size_t o = 0; o < others_.size(); ++o)
            twin.others[o].push_back(world_->readings(static_cast<int>(o) + 1).hand_force);
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
        const double dt = scene_.step_length(of_run) / parts;
        struck.add(now.normal, dt);
        swing.add(patch, dt);
    }
    twin.swing = swing.largest();
    // a window that has not the run's largest has one that differs from the twin's as far as its strikes do
    twin.run.patch = window.has_patch
                         ? window.largest.patch
                         : std::clamp(twin.largest.patch + window.struck.largest() - struck.largest(), 0.0, window.largest.patch);
    const auto peak_of = [&, last = last_length(window)](const std::vector<double>& values) {
        return largest_mean(values, scene_.dt / parts, parts, last);
    };
    twin.peaks.hand = peak_of(twin.hand);
    twin.peaks.friction = peak_of(twin.friction);
    twin.peaks.patch = twin.largest.patch;
    twin.ratio = window.lengths * parts * parts / lengths;
    twin.tip = (world_->rod(0).pos(0) - window.tip).norm();
    twin.found = true;
    if (starting_) {
        for (const std::vector<double>& other : twin.others) twin.peaks.others.push_back(peak_of(other));
        return twin;
    }
    ++estimate_.windows;
    const double times = margin(twin.ratio);
    // a history that differs is seen in other windows, too: the last one alone gives bands that do not hold
    const double of_mean = times * (mean(window.hand) - mean(twin.hand));
    hand_.add(of_mean);
    friction_.add(times * (mean(window.friction) - mean(twin.friction)));
    hand_peaks_.add(times * (window.peaks.hand - twin.peaks.hand));
    friction_peaks_.add(times * (window.peaks.friction - twin.peaks.friction));
    for (std::size_t k = 0; k < others_.size(); ++k) {
        twin.peaks.others.push_back(peak_of(twin.others[k]));
        others_[k].means.add(times * (mean(window.others[k]) - mean(twin.others[k])));
        others_[k].peaks.add(times * (window.peaks.others[k] - twin.peaks.others[k]));
    }
    mean_differences_ += std::abs(of_mean);
    tips_.add(times * twin.tip);
    return twin;
}

const StepTwin::Examined& StepTwin::examine_largest(const Window& window, Finer finer)
{
    const Examined& halved = examine_halved(window);
    const int parts = static_cast<int>(std::clamp(std::lround(scene_.dt / fine_step), 2L, static_cast<long>(most_parts)));
    const double cost = static_cast<double>(parts * (window.lead + window.steps));
    const bool affordable = finer == Finer::Always || (finer == Finer::WhereCheap && cost <= cheap * static_cast<double>(seen_));
    if (parts == 2 || !affordable) return halved;
    const Examined& fine = examine(window, parts, window.lead);
    if (!fine.found) return halved;
    estimate_.finest = parts;
    return fine;
}

EndMean::Mean StepTwin::end_of(const Window& window, const std::vector<double>& hand, const std::vector<double>& friction,
                               int parts) const
{
    EndMean mean;
    for (std::size_t k = 0; k < hand.size(); ++k)
        mean.add(hand[k], friction[k], scene_.step_length(window.first + static_cast<long>(k) / parts) / parts);
    return mean.mean();
}

void StepTwin::set_end(const Window& end, const Examined& twin)
{
    const EndMean::Mean value = end_of(end, end.hand, end.friction, 1);
    estimate_.end_seconds = value.seconds;
    const EndMean::Mean other = end_of(end, twin.hand, twin.friction, twin.parts);
    set_end_band(estimate_.hand, value.hand, other.hand, twin, end.hand, twin.hand, hand_, hand_history * hand_falls_.share());
    set_end_band(estimate_.friction, value.friction, other.friction, twin, end.friction, twin.friction, friction_,
                 friction_history * friction_falls_.share());
}

void StepTwin::set_end_band(ErrorBand& band, double of_run, double of_twin, const Examined& twin, const std::vector<double>& run,
                            const std::vector<double>& fine, const MeanSquare& others, double history) const
{
    const double usual = twin.found ? margin(twin.ratio) * usual_difference(run, fine, scene_.dt, twin.parts) : 0;
    band = twin.found ? band_of(of_run, of_twin, twin.parts, twin.ratio, std::max(others.root(), usual), history)
                      : ErrorBand{of_run, 0, 0, false};
}

double StepTwin::bound_by(const Examined& twin, const Reading& reading)
{
    const double run = reading(twin.run);
    return run + margin(twin.ratio) * (reading(twin.peaks) - run);
}

StepTwin::Reached StepTwin::reached(const Reading& reading) const
{
    Reached most;
    for (const std::unique_ptr<Examined>& twin : examined_) {
        const auto is_finer = [&](const std::unique_ptr<Examined>& other) {
            return other->found && other->first == twin->first && other->steps == twin->steps && other->parts > twin->parts;
        };
        if (!twin->found || std::ranges::any_of(examined_, is_finer)) continue;
        most.bound = std::max(most.bound, bound_by(*twin, reading));
        most.twin = std::max(most.twin, reading(twin->peaks));
    }
    return most;
}

ErrorBand StepTwin::peak_band(double value, const Examined& twin, const Reading& reading, Kind kind, const MeanSquare& windows,
                              double history) const
{
    if (!twin.found) return {value, 0, 0, false};
    ErrorBand band = band_of(value, reading(twin.peaks), twin.parts, twin.ratio, windows.root(), history);
    const Reached other = reached(reading);
    double expected = band.step_part * band.step;
    if (other.bound - value > band.step) {
        expected = std::max(expected, other.twin - value);
        band.step = band.band = other.bound - value;
        band.twin = std::max(band.twin, other.twin);
    }
    if (kind == Kind::Single) expected = std::abs(band.twin - value);
    if (band.step > 0) band.step_part = expected / band.step;
    band.resolved = is_resolved(band);
    return band;
}

void StepTwin::set_other(std::size_t k, const Window& end, const Examined& of_end, const Examined& of_hand, Finer finer)
{
    OtherHand& other = others_[k];
    HandBands& bands = estimate_.others[k];
    if (other.best.steps == 0) return;
    const double history = hand_history * other.falls.share();
    const auto at_end = [&](const std::vector<double>& force, int parts) { return end_of(end, force, force, parts).hand; };
    set_end_band(bands.end, at_end(end.others[k], 1), of_end.found ? at_end(of_end.others[k], of_end.parts) : 0, of_end,
                 end.others[k], of_end.found ? of_end.others[k] : end.others[k], other.means, history);
    const bool same = best_hand_.steps > 0 && other.best.is(best_hand_);
    const Examined& of_peak = same ? of_hand : examine_largest(other.best, finer);
    const double peak = other.best.peaks.others[k];
    bands.peak = peak_band(
        peak, of_peak, [k](const Peaks& peaks) { return k < peaks.others.size() ? peaks.others[k] : 0; }, Kind::Mean, other.peaks,
        history);
    if (of_peak.found) widen(bands.peak, other.release);
    complete(bands.end, times(end.grid.energy, bands.end.value), end.grid.normal, of_hand_at(end.grid, k + 1));
    complete(bands.peak, times(other.best.grid.energy, peak), other.best.grid.normal, of_hand_at(other.best.grid, k + 1));
}

void StepTwin::complete(ErrorBand& band, const GridShare& grid, double pushing, double more) const
{
    const bool step_known = band.resolved || band.band > 0;
    const double distance = seen_ > 0 ? path_ * mean_time / (static_cast<double>(seen_) * scene_.dt) : 0;
    const double push = distance > 0 ? std::min(axial_.root(), rise_.root() / distance) : axial_.root();
    band.nodes = grid.nodes + more;
    band.facets = grid.facets + push * std::abs(pushing);
    band.sum_up();
    band.resolved = step_known && is_resolved(band);
}

void StepTwin::set_patch(const Examined& hand, const Examined& friction)
{
    ErrorBand& band = estimate_.patch;
    if (best_patch_.steps == 0) {  // none, or one from before the run was resumed
        band.value = largest_.patch;
        band.known = largest_.patch == 0;
        return;
    }
    const Examined& twin = best_patch_.is(best_hand_)       ? hand
                           : best_patch_.is(best_friction_) ? friction
                                                            : examine_halved(best_patch_);
    const double patch = largest_.patch;
    band = peak_band(patch, twin, &Peaks::patch, Kind::Single, {}, hand_history * hand_falls_.share());
    if (twin.found) widen(band, twin.swing);
    if (best_strike_.struck.largest() > least_strike * patch) {
        const Examined& strike = examine(best_strike_, strike_parts, 0);
        if (strike.found) widen(band, bound_by(strike, &Peaks::patch) - patch);
    }
    complete(band, times(best_patch_.grid.patch, patch), patch);
    add_places(band, best_patch_.grid);
}

void StepTwin::set_wall()
{
    if (best_wall_.steps == 0) return;
    const Examined& twin = examine_halved(best_wall_);
    if (!twin.found) return;
    estimate_.wall_known = true;
    // no window knows of another history before it; where nothing has touched the wall there is none
    const double history = largest_.patch > 0 ? friction_history * friction_falls_.share() : 0;
    const auto share = [&](double run, double of_twin) {
        return std::max(margin(twin.ratio) * std::abs(run - of_twin), history * run);
    };
    estimate_.wall_move = share(largest_.wall_move, twin.largest.wall_move);
    estimate_.wall_stress = share(largest_.wall_stress, twin.largest.wall_stress);
}

void StepTwin::set_work()
{
    ErrorBand& band = estimate_.work;
    band.value = work_;
    band.known = run_.wire_count() == 1 && estimate_.from_step == 0 && estimate_.windows > 0;
    if (!band.known) return;
    const double history = hand_history * hand_falls_.share() * pushed_ / std::sqrt(static_cast<double>(std::max(closed_, 1L)));
    band.step = std::max(path_ * mean_differences_ / static_cast<double>(estimate_.windows), history);
    band.nodes = grid_.missed.nodes + work_errors_.nodes;
    band.facets = grid_.missed.facets + work_errors_.facets;
    band.sum_up();
    band.resolved = band.expected() <= std::max(wanted * std::abs(work_), least_force * path_);
}

ErrorEstimate StepTwin::finish(Finer finer)
{
    const auto begun = Clock::now();
    if (window_.steps > 0) gauge(run_);
    // a few steps say little of the end: the whole window before them is added
    const bool short_end = window_.steps < estimate_.window_steps / 2 || window_.steps < mean_steps(scene_.dt);
    Window end = short_end && last_.steps > 0 ? last_ : window_;
    if (short_end && last_.steps > 0 && window_.steps > 0) {
        end.steps += window_.steps;
        end.hand.insert(end.hand.end(), window_.hand.begin(), window_.hand.end());
        end.friction.insert(end.friction.end(), window_.friction.begin(), window_.friction.end());
        for (std::size_t k = 0; k < others_.size(); ++k)
            end.others[k].insert(end.others[k].end(), window_.others[k].begin(), window_.others[k].end());
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
    const Examined& of_end = examine_halved(end);
    const Examined& twin_of_hand = examine_largest(best_hand_, finer);
    const bool same = best_friction_.is(best_hand_);
    const Examined& of_friction = same ? twin_of_hand : examine_largest(best_friction_, finer);
    estimate_.tip = std::max(tips_.root(), of_end.found ? margin(of_end.ratio) * of_end.tip : 0.0);
    set_end(end, of_end);
    estimate_.hand_peak =
        peak_band(best_hand_.peaks.hand, twin_of_hand, &Peaks::hand, Kind::Mean, hand_peaks_, hand_history * hand_falls_.share());
    estimate_.friction_peak = peak_band(best_friction_.peaks.friction, of_friction, &Peaks::friction, Kind::Mean, friction_peaks_,
                                        friction_history * friction_falls_.share());
    if (twin_of_hand.found) widen(estimate_.hand_peak, hand_release_);
    if (of_friction.found) widen(estimate_.friction_peak, friction_release_);
    const GridErrors &at_end = end.grid, &at_hand = best_hand_.grid, &at_friction = best_friction_.grid;
    complete(estimate_.hand, of_hand(at_end, estimate_.hand.value, estimate_.friction.value), at_end.normal,
             of_hand_at(at_end, 0));
    complete(estimate_.hand_peak, of_hand(at_hand, best_hand_.peaks.hand, best_hand_.peaks.friction), at_hand.normal,
             of_hand_at(at_hand, 0));
    for (std::size_t k = 0; k < others_.size(); ++k) set_other(k, end, of_end, twin_of_hand, finer);
    complete(estimate_.friction, times(at_end.pressed, estimate_.friction.value), estimate_.friction.value);
    complete(estimate_.friction_peak, times(at_friction.pressed, best_friction_.peaks.friction), best_friction_.peaks.friction);
    set_patch(twin_of_hand, of_friction);
    set_work();
    set_wall();
    estimate_.seconds += seconds_since(begun);
    return estimate_;
}

ErrorEstimate equilibrium_estimate(const Scene& scene, const World& run, const WireReadings& readings, double hand,
                                   double friction, double patch)
{
    ErrorEstimate estimate;
    estimate.equilibrium = true;
    estimate.adaptive = scene.wire.nodes == 0;
    const GridErrors e = GridErrorGauge().of(run);
    const auto band_of_grid = [&](double value, const GridShare& grid, double pushing, double more) {
        ErrorBand band;
        band.value = band.twin = value;
        band.nodes = grid.nodes + more;
        band.facets = grid.facets + e.axial * pushing;
        band.sum_up();
        band.resolved = StepTwin::is_resolved(band);
        return band;
    };
    estimate.hand =
        band_of_grid(readings.hand_force, of_hand(e, readings.hand_force, readings.friction), e.normal, of_hand_at(e, 0));
    estimate.hand_peak = band_of_grid(hand, of_hand(e, hand, friction), e.normal, of_hand_at(e, 0));
    estimate.friction = band_of_grid(readings.friction, times(e.pressed, readings.friction), readings.friction, 0);
    estimate.friction_peak = band_of_grid(friction, times(e.pressed, friction), friction, 0);
    estimate.patch = band_of_grid(patch, times(e.patch, patch), patch, 0);
    add_places(estimate.patch, e);
    estimate.work.known = false;
    const auto [first, end] = run.wires_of(0);
    for (int w = first + 1; w < end; ++w) {
        const double force = run.readings(w).hand_force;
        const ErrorBand band =
            band_of_grid(force, times(e.energy, force), e.normal, of_hand_at(e, static_cast<std::size_t>(w - first)));
        estimate.others.push_back({scene.instrument(w - first).label, band, band});
    }
    estimate.tip_nodes = run.node_error(first);
    estimate.tip_facets = e.tip;
    return estimate;
}

const char* advice_for(const ErrorEstimate& e, const char* source)
{
    const std::string_view name = source;
    if (name == "step") return "smaller scene.dt_s";
    if (name == "facets") return "a finer mesh of the vessel";
    return e.adaptive ? "smaller wire.edge_error_m" : "wire.nodes = \"adaptive\" or more nodes";
}

std::vector<std::string> unresolved(const ErrorEstimate& e)
{
    std::vector<std::string> list;
    const auto look = [&](const std::string& what, const ErrorBand& band) {
        if (band.resolved || !band.known) return;
        const std::string_view source = band.largest_source();
        if (band.band == 0 || StepTwin::is_resolved(band))  // what is known of it would not be said
            list.push_back(fmt::format("{} of {:.3g} N: its error is unknown, because shorter steps did not converge there", what,
                                       band.value));
        else if (source != "step")
            list.push_back(
                fmt::format("{} of {:.3g} N is not resolved by the {}: the band is +- {:.2g} N, {:.2g} N of it by them. Fix: {}",
                            what, band.value, source == "nodes" ? "wire's nodes" : "wall's facets", band.band,
                            source == "nodes" ? band.nodes : band.facets, advice_for(e, band.largest_source())));
        else
            list.push_back(fmt::format(
                "{} of {:.3g} N is not resolved by steps of {:.3g} ms: steps of {:.3g} ms give {:.3g} N from the same "
                "state, the band is +- {:.2g} N; make scene.dt_s smaller",
                what, band.value, 1e3 * e.dt, 1e3 * e.dt / band.parts, band.twin, band.band));
    };
    look("the hand force at the end (20 ms mean)", e.hand);
    look("the largest hand force (20 ms mean)", e.hand_peak);
    for (const HandBands& hand : e.others) {
        look(fmt::format("the hand force of {} at the end (20 ms mean)", hand.name), hand.end);
        look(fmt::format("the largest hand force of {} (20 ms mean)", hand.name), hand.peak);
    }
    look("the friction at the end (20 ms mean)", e.friction);
    look("the largest friction (20 ms mean)", e.friction_peak);
    look("the largest force on a patch of wall", e.patch);
    return list;
}

}  // namespace seldinger

// Windows of a run, some computed again with shorter steps.
#include "run/step_twin.h"

#include "core/clock.h"
#include "run/joint_readings.h"
#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace seldinger {

namespace {

/// Steps that mean_time is.
long mean_steps(double dt) { return std::max(1L, std::lround(StepTwin::mean_time / dt)); }

double mean(const std::vector<double>& values)
{
    double sum = 0;
    for (const double value : values) sum += value;
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// The largest mean magnitude over mean_time, or over all where they are shorter.
double largest_mean(const std::vector<double>& values, double dt)
{
    RunningPeak peak(static_cast<std::size_t>(mean_steps(dt)));
    for (const double value : values) peak.add(std::abs(value));
    return peak.value();
}

/// The largest difference between means over mean_time of a run and of a twin with steps of 1/parts as long.
double largest_difference(const std::vector<double>& run, const std::vector<double>& twin, double dt, int parts)
{
    const std::size_t wide = std::min(static_cast<std::size_t>(mean_steps(dt)), run.size());
    const auto p = static_cast<std::size_t>(parts);
    double sum = 0, most = 0;  // of run - twin over the last `wide` steps
    const auto difference = [&](std::size_t k) {
        double of_step = run[k];
        for (std::size_t j = 0; j < p; ++j) of_step -= twin[p * k + j] / parts;
        return of_step;
    };
    for (std::size_t k = 0; k < run.size(); ++k) {
        sum += difference(k);
        if (k >= wide) sum -= difference(k - wide);
        if (k + 1 >= wide) most = std::max(most, std::abs(sum) / static_cast<double>(wide));
    }
    return most;
}

// No band is narrower than this share of its value. Windows begin at the state of the run. They see neither the effect of its
// history nor slips that come earlier or later. The shares are calibrated, not derived, on the scenes of bench/readings.py and of
// the tests. There, windows of some runs agreed to 0.1 %. Their 20 ms means still differed by up to 2.6 % (hand force) and 6.6 %
// (friction) from those with 4 to 67 x shorter steps.
// Where forces only rise there is no history to differ: with less falling than the largest value itself, the shares are in proportion.
constexpr double hand_history = 0.03, friction_history = 0.07;

// Part of the push by normals of facets that a mean over 20 ms keeps, since the wire gives way and crosses them. Calibrated, not derived: with 16 x as
// many triangles, hand forces on the generated arch and on five arcs of bench/audit.py moved by 0.07 to 0.6 of it; in each, the whole band held it.
constexpr double push_in_mean = 0.25;

/// What a difference from steps of 1/parts as long is multiplied by. @param divided  part of the run's steps that were, in which a twin has nothing
/// to compare: the difference is that of the rest
double margin(int parts, double divided) { return StepTwin::safety * parts / (parts - 1.0) / (1 - std::min(divided, StepTwin::most_divided)); }

ErrorBand band_of(double value, double twin, int parts, double divided, double least, double history)
{
    ErrorBand made{value, twin, margin(parts, divided) * std::abs(value - twin), true, false, parts};
    made.band = std::max({made.band, least, history * std::abs(value)});
    made.resolved = StepTwin::is_resolved(made);
    return made;
}

/// The band of a force that lets go at its largest is what the time of the release leaves, where that is more.
void widen(ErrorBand& band, const ReleaseWatch& release)
{
    if (release.bound() <= band.band) return;
    band.band = release.bound();
    band.let_go = true;
    band.resolved = StepTwin::is_resolved(band);
}

/// @param more  the largest of a twin elsewhere: where that is more, the largest is not known better
ErrorBand peak_band(const ErrorBand& so_far, bool found, int parts, double divided, double value, double twin, double more, double history)
{
    return found ? band_of(value, twin, parts, divided, std::max(so_far.band, more - value), history) : ErrorBand{value, 0, 0, false};
}

/// The load of the next node may lie on the same patch, or not: the band holds both. It is no expected error, and so no reason for a warning.
void add_split(ErrorBand& band, const GridErrors& e)
{
    band.nodes += e.split * band.value;
    band.band += e.split * band.value;
}

/// What nodes do to the hand of an instrument besides.
double of_hand_at(const GridErrors& e, std::size_t instrument) { return instrument < e.hands.size() ? e.hands[instrument] : 0; }

}  // namespace

StepTwin::OtherHand::OtherHand(double dt) : release(dt, mean_time), falls(static_cast<std::size_t>(mean_steps(dt))) {}

void StepTwin::OtherHand::add(double force)
{
    falls.add(std::abs(force));
    release.add(std::abs(force));
}

StepTwin::StepTwin(const Scene& scene, const World& run, long taken)
    : scene_(scene),
      run_(run),
      key_frames_(scene),
      hand_release_(scene.dt, mean_time),
      friction_release_(scene.dt, mean_time),
      hand_falls_(static_cast<std::size_t>(mean_steps(scene.dt))),
      friction_falls_(static_cast<std::size_t>(mean_steps(scene.dt)))
{
    estimate_.from_step = taken;
    estimate_.dt = scene.dt;
    estimate_.window_steps = std::max(least_steps, mean_steps(scene.dt));
    estimate_.adaptive = scene.wire.nodes == 0;
    estimate_.others.resize(static_cast<std::size_t>(run.wire_count() - 1));
    for (std::size_t k = 0; k < estimate_.others.size(); ++k) estimate_.others[k].name = scene.instrument(static_cast<int>(k) + 1).label;
    others_.assign(estimate_.others.size(), OtherHand(scene.dt));
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
    window_.others_peak.assign(others_.size(), 0.0);
}

void StepTwin::stepped(const World& run, const WireReadings& readings, long taken, const LargestReadings& largest)
{
    const auto begun = Clock::now();
    if (seen_ > 0 || estimate_.from_step == 0) {
        window_.has_patch |= largest.patch > largest_.patch;
        window_.has_wall |= largest.wall_move > largest_.wall_move || largest.wall_stress > largest_.wall_stress;
        const double way = readings.inserted - inserted_;
        path_ += std::abs(way);
        window_pushed_ += std::abs(readings.hand_force * way);
    }
    largest_ = window_.largest = largest;
    inserted_ = readings.inserted;
    work_ = readings.energy.hand;
    ++window_.steps;
    ++seen_;
    window_.divided += (joint_report(run, 0).flags & StepHalved) != 0;
    window_.hand.push_back(readings.hand_force);
    window_.friction.push_back(readings.friction);
    hand_falls_.add(std::abs(readings.hand_force));
    friction_falls_.add(readings.friction);
    hand_release_.add(std::abs(readings.hand_force));
    friction_release_.add(readings.friction);
    for (std::size_t k = 0; k < others_.size(); ++k) {
        window_.others[k].push_back(run.readings(static_cast<int>(k) + 1).hand_force);
        others_[k].add(window_.others[k].back());
    }
    window_.tip = run.rod(0).pos(0);
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
    estimate_.tip_facets = std::max(estimate_.tip_facets, now.offset);
    axial_squares_ += now.axial * now.axial;
    axial_count_ += now.normal > 0;
    window_.grid = grid_;
    window_.grid.widen(now);
    grid_ = now;
    pushed_ += window_pushed_;
    work_nodes_ += window_.grid.nodes * window_pushed_;
    work_facets_ += window_.grid.facets * window_pushed_;
    window_pushed_ = 0;
}

/// The window is over: compared now, or kept for the end if it may be among the compared ones.
void StepTwin::close()
{
    if (window_.steps == 0) return;
    window_.hand_peak = largest_mean(window_.hand, scene_.dt);
    window_.friction_peak = largest_mean(window_.friction, scene_.dt);
    for (std::size_t k = 0; k < others_.size(); ++k) window_.others_peak[k] = largest_mean(window_.others[k], scene_.dt);
    if (++closed_ % periodic == 0) (void)examine(window_, 2);
    if (window_.hand_peak > best_hand_.hand_peak) best_hand_ = window_;
    if (window_.friction_peak > best_friction_.friction_peak) best_friction_ = window_;
    if (window_.has_patch) best_patch_ = window_;
    if (window_.has_wall) best_wall_ = window_;
    for (std::size_t k = 0; k < others_.size(); ++k)
        if (others_[k].best.steps == 0 || window_.others_peak[k] > others_[k].best.others_peak[k]) others_[k].best = window_;
    last_ = std::move(window_);
}

StepTwin::Examined StepTwin::examine(const Window& window, int parts)
{
    // no window: the run has none, or was never above zero, which a twin of nothing says too
    Examined twin;
    twin.parts = parts;
    twin.divided = window.steps > 0 ? static_cast<double>(window.divided) / static_cast<double>(window.steps) : 0;
    twin.found = window.steps == 0 && closed_ > 0;
    if (window.steps == 0) return twin;
    if (!world_) {
        world_ = std::make_unique<World>(run_.setup());
        world_->stop_when(stop_asked_);
    }
    twin.others.resize(others_.size());
    const long lead = parts > 2 ? window.lead : 0;
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
        const WireReadings now = joint_readings(*world_, 0);
        twin.hand.push_back(now.hand_force);
        twin.friction.push_back(now.friction);
        for (std::size_t o = 0; o < others_.size(); ++o) twin.others[o].push_back(world_->readings(static_cast<int>(o) + 1).hand_force);
        if (window.has_wall) {
            const WallReadings wall = world_->wall_readings();
            twin.largest.wall_move = std::max(twin.largest.wall_move, wall.move_max);
            twin.largest.wall_stress = std::max(twin.largest.wall_stress, wall.stress_max);
        }
        if (!window.has_patch) continue;
        WireOutput loads;
        for (int w = 0; w < world_->wire_count(); ++w) {
            world_->read_loads(w, loads);
            twin.largest.patch = std::max(twin.largest.patch, loads.on_wall.patch_force);
        }
    }
    twin.hand_peak = largest_mean(twin.hand, scene_.dt / parts);
    twin.friction_peak = largest_mean(twin.friction, scene_.dt / parts);
    twin.found = true;
    ++estimate_.windows;
    const auto worst = [&](ErrorBand& so_far, double value, double other) {
        so_far.band = std::max(so_far.band, margin(parts, twin.divided) * std::abs(value - other));
    };
    // a history that differs is seen in other windows, too: the last one alone gives bands that do not hold
    worst(estimate_.hand, mean(window.hand), mean(twin.hand));
    worst(estimate_.friction, mean(window.friction), mean(twin.friction));
    worst(estimate_.hand_peak, window.hand_peak, twin.hand_peak);
    worst(estimate_.friction_peak, window.friction_peak, twin.friction_peak);
    for (std::size_t k = 0; k < others_.size(); ++k) {
        twin.others_peak.push_back(largest_mean(twin.others[k], scene_.dt / parts));
        worst(estimate_.others[k].end, mean(window.others[k]), mean(twin.others[k]));
        worst(estimate_.others[k].peak, window.others_peak[k], twin.others_peak[k]);
        others_[k].twins_peak = std::max(others_[k].twins_peak, twin.others_peak[k]);
    }
    mean_differences_ += margin(parts, twin.divided) * std::abs(mean(window.hand) - mean(twin.hand));
    other_hand_peak_ = std::max(other_hand_peak_, twin.hand_peak);
    other_friction_peak_ = std::max(other_friction_peak_, twin.friction_peak);
    estimate_.tip = std::max(estimate_.tip, margin(parts, twin.divided) * (world_->rod(0).pos(0) - window.tip).norm());
    return twin;
}

StepTwin::Examined StepTwin::examine_largest(const Window& window, Finer finer)
{
    const Examined halved = examine(window, 2);
    const int parts = static_cast<int>(std::clamp(std::lround(scene_.dt / fine_step), 2L, static_cast<long>(most_parts)));
    const double cost = static_cast<double>(parts * (window.lead + window.steps));
    const bool affordable = finer == Finer::Always || (finer == Finer::WhereCheap && cost <= cheap * static_cast<double>(seen_));
    if (parts == 2 || !affordable) return halved;
    const Examined fine = examine(window, parts);
    if (!fine.found) return halved;
    estimate_.finest = parts;
    return fine;
}

EndMean::Mean StepTwin::end_of(const Window& window, const std::vector<double>& hand, const std::vector<double>& friction, int parts) const
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
    set_end_band(estimate_.hand, value.hand, other.hand, twin, end.hand, twin.hand, hand_history * hand_falls_.share());
    set_end_band(estimate_.friction, value.friction, other.friction, twin, end.friction, twin.friction, friction_history * friction_falls_.share());
}

void StepTwin::set_end_band(ErrorBand& band, double of_run, double of_twin, const Examined& twin, const std::vector<double>& run,
                            const std::vector<double>& fine, double history) const
{
    const double least = twin.found ? margin(twin.parts, twin.divided) * largest_difference(run, fine, scene_.dt, twin.parts) : 0;
    band = twin.found ? band_of(of_run, of_twin, twin.parts, twin.divided, std::max(band.band, least), history) : ErrorBand{of_run, 0, 0, false};
}

void StepTwin::set_other(std::size_t k, const Window& end, const Examined& of_end, const Examined& of_hand, Finer finer)
{
    OtherHand& other = others_[k];
    HandBands& bands = estimate_.others[k];
    if (other.best.steps == 0) return;
    const double history = hand_history * other.falls.share();
    const auto at_end = [&](const std::vector<double>& force, int parts) { return end_of(end, force, force, parts).hand; };
    set_end_band(bands.end, at_end(end.others[k], 1), of_end.found ? at_end(of_end.others[k], of_end.parts) : 0, of_end, end.others[k],
                 of_end.found ? of_end.others[k] : end.others[k], history);
    const bool same = best_hand_.steps > 0 && other.best.first == best_hand_.first;
    const Examined of_peak = same ? of_hand : examine_largest(other.best, finer);
    const double peak = other.best.others_peak[k];
    bands.peak = peak_band(bands.peak, of_peak.found, of_peak.parts, of_peak.divided, peak, of_peak.found ? of_peak.others_peak[k] : 0, other.twins_peak, history);
    if (of_peak.found) widen(bands.peak, other.release);
    complete(bands.end, bands.end.value, end.grid, end.grid.normal, of_hand_at(end.grid, k + 1));
    complete(bands.peak, peak, other.best.grid, other.best.grid.normal, of_hand_at(other.best.grid, k + 1));
}

void StepTwin::complete(ErrorBand& band, double force, const GridErrors& e, double pushing, double more) const
{
    const bool step_known = band.resolved || band.band > 0;
    // normals of facets turn as the wire goes on: their push is that of all windows
    const double push = axial_count_ > 0 ? std::sqrt(axial_squares_ / static_cast<double>(axial_count_)) : 0;
    band.step = band.band;
    band.nodes = grid_safety * e.nodes * std::abs(force) + more;
    band.facets = grid_safety * e.facets * std::abs(force) + push_in_mean * push * std::abs(pushing);
    band.band = band.step + band.nodes + band.facets;
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
    const Examined twin = best_patch_.first == best_hand_.first ? hand : best_patch_.first == best_friction_.first ? friction : examine(best_patch_, 2);
    const double patch = largest_.patch;
    band = twin.found ? band_of(patch, twin.largest.patch, twin.parts, twin.divided, 0, friction_history * friction_falls_.share()) : ErrorBand{patch, 0, 0, false};
    complete(band, patch, best_patch_.grid, patch);
    add_split(band, best_patch_.grid);
}

void StepTwin::set_wall()
{
    if (best_wall_.steps == 0) return;
    const Examined twin = examine(best_wall_, 2);
    if (!twin.found) return;
    const double history = friction_history * friction_falls_.share();
    const auto share = [&](double run, double of_twin) { return std::max(margin(twin.parts, twin.divided) * std::abs(run - of_twin), history * run); };
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
    band.nodes = grid_safety * work_nodes_;
    band.facets = grid_safety * work_facets_;
    band.band = band.step + band.nodes + band.facets;
    band.resolved = band.band <= wanted * std::abs(work_) || band.band <= least_force * path_;
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
        end.divided += window_.divided;
        end.tip = window_.tip;
        end.has_patch |= window_.has_patch;
        end.has_wall |= window_.has_wall;
        end.largest = window_.largest;
        end.grid.widen(window_.grid);
    }
    end.hand_peak = largest_mean(end.hand, scene_.dt);
    end.friction_peak = largest_mean(end.friction, scene_.dt);
    for (std::size_t k = 0; k < end.others.size(); ++k) end.others_peak[k] = largest_mean(end.others[k], scene_.dt);
    close();
    const Examined of_end = examine(end, 2), of_hand = examine_largest(best_hand_, finer);
    const bool same = best_friction_.first == best_hand_.first && best_friction_.steps == best_hand_.steps;
    const Examined of_friction = same ? of_hand : examine_largest(best_friction_, finer);
    // until here each band is the largest that any window has shown
    set_end(end, of_end);
    estimate_.hand_peak = peak_band(estimate_.hand_peak, of_hand.found, of_hand.parts, of_hand.divided, best_hand_.hand_peak, of_hand.hand_peak, other_hand_peak_,
                                    hand_history * hand_falls_.share());
    estimate_.friction_peak = peak_band(estimate_.friction_peak, of_friction.found, of_friction.parts, of_friction.divided, best_friction_.friction_peak, of_friction.friction_peak,
                                        other_friction_peak_, friction_history * friction_falls_.share());
    if (of_hand.found) widen(estimate_.hand_peak, hand_release_);
    if (of_friction.found) widen(estimate_.friction_peak, friction_release_);
    const double end_force = std::max(std::abs(estimate_.hand.value), std::abs(estimate_.friction.value));  // of which a small sum is made
    complete(estimate_.hand, end_force, end.grid, end.grid.normal, of_hand_at(end.grid, 0));
    complete(estimate_.hand_peak, best_hand_.hand_peak, best_hand_.grid, best_hand_.grid.normal, of_hand_at(best_hand_.grid, 0));
    for (std::size_t k = 0; k < others_.size(); ++k) set_other(k, end, of_end, of_hand, finer);
    complete(estimate_.friction, estimate_.friction.value, end.grid, estimate_.friction.value);
    complete(estimate_.friction_peak, best_friction_.friction_peak, best_friction_.grid, best_friction_.friction_peak);
    set_patch(of_hand, of_friction);
    set_work();
    set_wall();
    estimate_.seconds += seconds_since(begun);
    return estimate_;
}

ErrorEstimate equilibrium_estimate(const Scene& scene, const World& run, const WireReadings& readings, double hand, double friction, double patch)
{
    ErrorEstimate estimate;
    estimate.equilibrium = true;
    estimate.adaptive = scene.wire.nodes == 0;
    const GridErrors e = GridErrorGauge().of(run);
    const auto band_of_grid = [&](double value, double pushing, double more) {
        ErrorBand band;
        band.value = band.twin = value;
        band.nodes = StepTwin::grid_safety * e.nodes * std::abs(value) + more;
        band.facets = StepTwin::grid_safety * e.facets * std::abs(value) + e.axial * pushing;
        band.band = band.nodes + band.facets;
        band.resolved = StepTwin::is_resolved(band);
        return band;
    };
    estimate.hand = band_of_grid(readings.hand_force, e.normal, of_hand_at(e, 0));
    estimate.hand_peak = band_of_grid(hand, e.normal, of_hand_at(e, 0));
    estimate.friction = band_of_grid(readings.friction, readings.friction, 0);
    estimate.friction_peak = band_of_grid(friction, friction, 0);
    estimate.patch = band_of_grid(patch, patch, 0);
    add_split(estimate.patch, e);
    estimate.work.known = false;
    const auto [first, end] = run.wires_of(0);
    for (int w = first + 1; w < end; ++w) {
        const ErrorBand band = band_of_grid(run.readings(w).hand_force, e.normal, of_hand_at(e, static_cast<std::size_t>(w - first)));
        estimate.others.push_back({scene.instrument(w - first).label, band, band});
    }
    estimate.tip_nodes = run.node_error(first);
    estimate.tip_facets = e.offset;
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
            list.push_back(fmt::format("{} of {:.3g} N: its error is unknown, because shorter steps did not converge there", what, band.value));
        else if (source != "step")
            list.push_back(fmt::format("{} of {:.3g} N is not resolved by the {}: the band is +- {:.2g} N, {:.2g} N of it by them. Fix: {}", what, band.value,
                                       source == "nodes" ? "wire's nodes" : "wall's facets", band.band, source == "nodes" ? band.nodes : band.facets,
                                       advice_for(e, band.largest_source())));
        else if (band.let_go)
            list.push_back(fmt::format("{} of {:.3g} N is a sudden release, after a rise of {:.2g} N in {:.2g} s: its time "
                                       "differs from run to run and is not resolved by steps of {:.3g} ms, the band is +- {:.2g} N; "
                                       "compare with other scene.dt_s",
                                       what, band.value, band.band, ReleaseWatch::release_time, 1e3 * e.dt, band.band));
        else
            list.push_back(fmt::format("{} of {:.3g} N is not resolved by steps of {:.3g} ms: steps of {:.3g} ms give {:.3g} N from the same "
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

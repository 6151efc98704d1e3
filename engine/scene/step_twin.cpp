// Windows of a run, some computed again with shorter steps.
#include "scene/step_twin.h"

#include "core/clock.h"
#include "scene/joint_readings.h"
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

/// What a difference from steps of 1/parts as long is multiplied by.
double margin(int parts) { return StepTwin::safety * parts / (parts - 1.0); }

bool is_resolved(const ErrorBand& band) { return band.band <= std::max(StepTwin::wanted * std::abs(band.value), StepTwin::least_force); }

ErrorBand band_of(double value, double twin, int parts, double least, double history)
{
    ErrorBand made{value, twin, margin(parts) * std::abs(value - twin), true, false, parts};
    made.band = std::max({made.band, least, history * std::abs(value)});
    made.resolved = is_resolved(made);
    return made;
}

/// The band of a force that lets go at its largest is what the time of the release leaves, where that is more.
void widen(ErrorBand& band, const ReleaseWatch& release)
{
    if (release.bound() <= band.band) return;
    band.band = release.bound();
    band.let_go = true;
    band.resolved = is_resolved(band);
}

}  // namespace

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
    open(run, taken);
}

void StepTwin::open(const World& run, long taken)
{
    window_ = {};
    window_.state = run.save_state();
    window_.earlier = last_.state;
    window_.lead = last_.steps;
    window_.first = taken;
}

void StepTwin::stepped(const World& run, const WireReadings& readings, long taken, double patch)
{
    const auto begun = Clock::now();
    if (seen_ > 0 || estimate_.from_step == 0) {
        window_.has_patch |= patch > patch_;
        const double way = readings.inserted - inserted_;
        path_ += std::abs(way);
        window_pushed_ += std::abs(readings.hand_force * way);
    }
    patch_ = patch;
    inserted_ = readings.inserted;
    work_ = readings.energy.hand;
    ++window_.steps;
    ++seen_;
    window_.hand.push_back(readings.hand_force);
    window_.friction.push_back(readings.friction);
    hand_falls_.add(std::abs(readings.hand_force));
    friction_falls_.add(readings.friction);
    hand_release_.add(std::abs(readings.hand_force));
    friction_release_.add(readings.friction);
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
    if (++closed_ % periodic == 0) (void)examine(window_, 2);
    if (window_.hand_peak > best_hand_.hand_peak) best_hand_ = window_;
    if (window_.friction_peak > best_friction_.friction_peak) best_friction_ = window_;
    if (window_.has_patch) best_patch_ = window_;
    last_ = std::move(window_);
}

StepTwin::Examined StepTwin::examine(const Window& window, int parts)
{
    // no window: the run has none, or was never above zero, which a twin of nothing says too
    Examined twin;
    twin.parts = parts;
    twin.found = window.steps == 0 && closed_ > 0;
    if (window.steps == 0) return twin;
    if (!world_) {
        world_ = std::make_unique<World>(run_.setup());
        world_->stop_when(stop_asked_);
    }
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
        if (!window.has_patch) continue;
        WireOutput loads;
        for (int w = 0; w < world_->wire_count(); ++w) {
            world_->read_loads(w, loads);
            twin.patch = std::max(twin.patch, loads.on_wall.patch_force);
        }
    }
    twin.hand_peak = largest_mean(twin.hand, scene_.dt / parts);
    twin.friction_peak = largest_mean(twin.friction, scene_.dt / parts);
    twin.found = true;
    ++estimate_.windows;
    const auto worst = [&](ErrorBand& so_far, double value, double other) {
        so_far.band = std::max(so_far.band, margin(parts) * std::abs(value - other));
    };
    // a history that differs is seen in other windows, too: the last one alone gives bands that do not hold
    worst(estimate_.hand, mean(window.hand), mean(twin.hand));
    worst(estimate_.friction, mean(window.friction), mean(twin.friction));
    worst(estimate_.hand_peak, window.hand_peak, twin.hand_peak);
    worst(estimate_.friction_peak, window.friction_peak, twin.friction_peak);
    mean_differences_ += margin(parts) * std::abs(mean(window.hand) - mean(twin.hand));
    other_hand_peak_ = std::max(other_hand_peak_, twin.hand_peak);
    other_friction_peak_ = std::max(other_friction_peak_, twin.friction_peak);
    estimate_.tip = std::max(estimate_.tip, margin(parts) * (world_->rod(0).pos(0) - window.tip).norm());
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
    const auto set = [&](ErrorBand& band, double of_run, double of_twin, const std::vector<double>& run, const std::vector<double>& fine, double history) {
        const double least = twin.found ? margin(twin.parts) * largest_difference(run, fine, scene_.dt, twin.parts) : 0;
        band = twin.found ? band_of(of_run, of_twin, twin.parts, std::max(band.band, least), history) : ErrorBand{of_run, 0, 0, false};
    };
    set(estimate_.hand, value.hand, other.hand, end.hand, twin.hand, hand_history * hand_falls_.share());
    set(estimate_.friction, value.friction, other.friction, end.friction, twin.friction, friction_history * friction_falls_.share());
}

void StepTwin::complete(ErrorBand& band, double force, const GridErrors& e, double pushing) const
{
    const bool step_known = band.resolved || band.band > 0;
    // normals of facets turn as the wire goes on: their push is that of all windows
    const double push = axial_count_ > 0 ? std::sqrt(axial_squares_ / static_cast<double>(axial_count_)) : 0;
    band.step = band.band;
    band.nodes = grid_safety * e.nodes * std::abs(force);
    band.facets = grid_safety * e.facets * std::abs(force) + push_in_mean * push * std::abs(pushing);
    band.band = band.step + band.nodes + band.facets;
    band.resolved = step_known && is_resolved(band);
}

void StepTwin::set_patch(const Examined& hand, const Examined& friction)
{
    ErrorBand& band = estimate_.patch;
    if (best_patch_.steps == 0) {  // none, or one from before the run was resumed
        band.value = patch_;
        band.known = patch_ == 0;
        return;
    }
    const Examined twin = best_patch_.first == best_hand_.first ? hand : best_patch_.first == best_friction_.first ? friction : examine(best_patch_, 2);
    band = twin.found ? band_of(patch_, twin.patch, twin.parts, 0, friction_history * friction_falls_.share()) : ErrorBand{patch_, 0, 0, false};
    complete(band, patch_, best_patch_.grid, patch_);
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
        end.tip = window_.tip;
        end.has_patch |= window_.has_patch;
        end.grid.widen(window_.grid);
    }
    end.hand_peak = largest_mean(end.hand, scene_.dt);
    end.friction_peak = largest_mean(end.friction, scene_.dt);
    close();
    const Examined of_end = examine(end, 2), of_hand = examine_largest(best_hand_, finer);
    const bool same = best_friction_.first == best_hand_.first && best_friction_.steps == best_hand_.steps;
    const Examined of_friction = same ? of_hand : examine_largest(best_friction_, finer);
    // until here each band is the largest that any window has shown; a twin that has more elsewhere shows that the largest is not
    // known better than that
    const auto set = [](ErrorBand& band, const Examined& of, double value, double twin, double more, double history) {
        band = of.found ? band_of(value, twin, of.parts, std::max(band.band, more - value), history) : ErrorBand{value, 0, 0, false};
    };
    set_end(end, of_end);
    set(estimate_.hand_peak, of_hand, best_hand_.hand_peak, of_hand.hand_peak, other_hand_peak_, hand_history * hand_falls_.share());
    set(estimate_.friction_peak, of_friction, best_friction_.friction_peak, of_friction.friction_peak, other_friction_peak_,
        friction_history * friction_falls_.share());
    if (of_hand.found) widen(estimate_.hand_peak, hand_release_);
    if (of_friction.found) widen(estimate_.friction_peak, friction_release_);
    const double end_force = std::max(std::abs(estimate_.hand.value), std::abs(estimate_.friction.value));  // of which a small sum is made
    complete(estimate_.hand, end_force, end.grid, end.grid.normal);
    complete(estimate_.hand_peak, best_hand_.hand_peak, best_hand_.grid, best_hand_.grid.normal);
    complete(estimate_.friction, estimate_.friction.value, end.grid, estimate_.friction.value);
    complete(estimate_.friction_peak, best_friction_.friction_peak, best_friction_.grid, best_friction_.friction_peak);
    set_patch(of_hand, of_friction);
    set_work();
    estimate_.seconds += seconds_since(begun);
    return estimate_;
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
    const auto look = [&](const char* what, const ErrorBand& band) {
        if (band.resolved) return;
        const std::string_view source = band.largest_source();
        if (band.band == 0)
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
    look("the friction at the end (20 ms mean)", e.friction);
    look("the largest friction (20 ms mean)", e.friction_peak);
    return list;
}

}  // namespace seldinger

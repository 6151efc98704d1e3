#pragma once
// Error bands of a run's forces and tip (D17): the share of the step, by windows of the run that are computed again with shorter
// ones.
//
// The run is cut into windows of least_steps steps, or of mean_time where that is longer. Computed again, in a world of its own
// and from the state at their beginning, are: every periodic-th window, the last, those with the largest hand force and friction
// so far, and the run's first 2 mean_time. A twin has the run's nodes and wall and half its step. The windows of the largest
// forces are taken again with fine_step too, from one window earlier: halved steps agree where both damp the oscillations after a
// slip. The window in which the sum of normal forces falls most within mean_time is taken again with quarters of the step, for
// strikes.
//
// The shares of nodes and facets come from the state at the end of each window (bands/grid_error.h); a release has a bound of its
// own (bands/release_watch.h). Of several instruments the first one's hand is read (setup/joint_readings.h), the others' from the
// same windows.
//
// A band cannot see a history that differed before the window began. `seldinger plan`, or a run with a shorter step, does.

#include "engine.h"
#include "math/end_mean.h"
#include "math/span_means.h"
#include "bands/grid_error.h"
#include "setup/key_frames.h"
#include "bands/release_watch.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace seldinger {

struct Scene;

/// What the shares of a band are together: independent errors, with the safety that shares by nodes do not have (those by the
/// step do), and a coverage factor. Both are calibrated by bench/audit.py: of 490 readings of 70 draws 95.5 % lie inside, 92.6 %
/// without them.
inline constexpr double band_coverage = 1.1, node_safety = 1.5;
[[nodiscard]] inline double band_of_shares(double step, double nodes, double facets)
{
    return band_coverage * std::hypot(step, node_safety * nodes, facets);
}
/// The one that counts most in that band.
[[nodiscard]] inline const char* largest_share(double step, double nodes, double facets)
{
    return node_safety * nodes > std::max(step, facets) ? "nodes" : facets > step ? "facets" : "step";
}

/// One reading with its band.
struct ErrorBand {
    double value = 0, twin = 0;  // with the run's step, with 1/parts of it
    double band = 0;
    bool resolved = true;  // the expected error is at most a third of the value, or below what is told apart
    bool let_go = false;   // the band is that of a release
    int parts = 2;
    double step = 0, nodes = 0, facets = 0;  // shares of the band
    double step_part =
        1 /
        1.5;  // of `step`, that the value is believed to be off by: without StepTwin::safety, and without what a release may do
    bool known = true;                       // the run has seen where the value comes from
    void sum_up() { band = band_of_shares(step, nodes, facets); }
    [[nodiscard]] double expected() const;   // what the value is believed to be off by
    [[nodiscard]] const char* largest_source() const { return largest_share(step, nodes, facets); }
};

/// The hand of an instrument: at the end, and the largest mean over 20 ms [N].
struct HandBands {
    std::string name;
    ErrorBand end, peak;
};

struct ErrorEstimate {
    bool equilibrium = false;      // no windows: shares of nodes and facets are all there is
    long windows = 0, failed = 0;  // compared; that found no state with shorter steps
    long steps = 0, from_step = 0; // of the twin; of the run when it began (after --resume)
    double seconds = 0;            // that it took
    double dt = 0;                 // of the run [s]
    int finest = 2;                // parts of a step of the run in the shortest of a twin
    long window_steps = 0;
    double end_seconds = 0;        // that the means at the end span
    ErrorBand hand, hand_peak, friction, friction_peak;  // 20 ms means: at the end, signed; the largest [N]
    std::vector<HandBands> others;                       // hands of the instruments but the first
    ErrorBand patch, work;                               // largest force on a patch of wall [N]; work of the hand's push [J]
    double wall_move = 0, wall_stress = 0;               // of the largest of an elastic wall, by the step [m], [Pa]
    bool wall_known = false;                             // these two are
    double tip = 0;                                      // by the step [m]
    double tip_nodes = 0;   // by the length of edges, largest at the ends of windows (World::node_error) [m]
    double tip_facets = 0;  // by the facets of the wall, largest at the ends of windows (GridErrors::tip) [m]
    bool adaptive = false;                               // the wire's nodes
    /// Of the tip's position, by all of them [m].
    [[nodiscard]] double tip_band() const { return band_of_shares(tip, tip_nodes, tip_facets); }
};

/// What makes the share of a source smaller.
[[nodiscard]] const char* advice_for(const ErrorEstimate& estimate, const char* source);

/// One sentence for each reading that is not resolved.
[[nodiscard]] std::vector<std::string> unresolved(const ErrorEstimate& estimate);

/// How much a force falls in all, as means over a time, against its largest.
class FallSum {
public:
    explicit FallSum(double mean_time) : mean_(mean_time) {}
    void add(double value, double dt)
    {
        mean_.add(value, dt);
        if (!mean_.full()) return;
        const double now = mean_.mean();
        fallen_ += std::max(0.0, last_ - now);
        last_ = now;
        most_ = std::max(most_, now);
    }
    /// 1 for falls of the largest value or more.
    [[nodiscard]] double share() const { return most_ > 0 ? std::min(1.0, fallen_ / most_) : 1; }

private:
    SpanMeans mean_;
    double last_ = 0, most_ = 0, fallen_ = 0;
};

/// Of a static run: what nodes and facets do to the readings of its last equilibrium, which no step has made. Larger ones on its
/// way have the relative bands of that. @param hand, friction, patch  the largest on its way [N]
[[nodiscard]] ErrorEstimate equilibrium_estimate(const Scene& scene, const World& run, const WireReadings& readings, double hand,
                                                 double friction, double patch);

/// The largest fall of a force of single steps within a time. A strike rises and falls within one; a force that only rises has
/// none.
class LargestFall {
public:
    explicit LargestFall(double time) : span_(time) {}
    void add(double value, double dt)
    {
        time_ += dt;
        while (!tops_.empty() && tops_.back().second <= value) tops_.pop_back();
        tops_.emplace_back(time_, value);
        while (tops_.front().first < time_ - (1 + 1e-9) * span_) tops_.pop_front();
        most_ = std::max(most_, tops_.front().second - value);
    }
    [[nodiscard]] double largest() const { return most_; }

private:
    double span_, time_ = 0, most_ = 0;
    std::deque<std::pair<double, double>> tops_;  // time and value of those that no later one exceeds
};

class MeanSquare {
public:
    void add(double value) { sum_ += value * value, ++count_; }
    [[nodiscard]] double root() const { return count_ > 0 ? std::sqrt(sum_ / static_cast<double>(count_)) : 0; }

private:
    double sum_ = 0;
    long count_ = 0;
};

/// Largest values of single steps: force on a patch [N], displacement [m] and stress [Pa] of an elastic wall.
struct LargestReadings {
    double patch = 0, wall_move = 0, wall_stress = 0;
};

class StepTwin {
public:
    /// Whether the largest forces are taken again with fine_step too: a run of a thousand steps of 17 ms costs two to three times
    /// as much with it.
    enum class Finer { Never, WhereCheap, Always };
    static constexpr long least_steps = 50;  // of a window
    static constexpr int periodic = 20;  // a twin of a window costs two: a tenth of the run's time
    static constexpr double safety = 1.5;           // times r/(r - 1)
    static constexpr double fine_step = 2.5e-4;     // [s]
    static constexpr int most_parts = 16;
    static constexpr double most_divided = 0.9;  // part of the run's steps: beyond it a warning says so
    static constexpr int strike_parts = 4;       // of a step, in the window with the largest strike
    static constexpr double least_strike = 0.1;  // of the largest force on a patch: smaller falls of the normal forces are none
    static constexpr double least_ratio = 1.1;   // of steps that differ: closer ones tell nothing
    static constexpr double much_divided = 0.8;  // mean length of steps over dt: below it a twin takes quarters
    static constexpr double cheap = 0.1;            // of the run's steps
    static constexpr double mean_time = EndMean::span;  // [s]
    // Resolved is what is believed to be off by less than that
    // bench/audit.py: of readings that are believed to be off by 20 to 33 % one in seven was off by more than 20 %, by 33 to 100
    // % two in five
    static constexpr double wanted = 1.0 / 3;     // of the value
    static constexpr double least_force = 1e-3;   // forces that no hand feels [N]
    // Shares of GridErrors are bounds of errors that swing with the place of a load in its edge or facet. Where the place is as
    // likely as any other, their root mean square is that part of the bound
    static constexpr double usual_share = 0.57735026918962576;  // 1/sqrt(3)

    /// Whether what a reading is believed to be off by is at most `wanted` or `least_force`.
    [[nodiscard]] static bool is_resolved(const ErrorBand& band)
    {
        return band.expected() <= std::max(wanted * std::abs(band.value), least_force);
    }

    /// @param scene, run  outlive this   @param taken  steps of the run so far
    StepTwin(const Scene& scene, const World& run, long taken);

    /// Ends its steps as World::stop_when() does: a window in which one is ended tells nothing.
    void stop_when(std::function<bool()> asked) { stop_asked_ = std::move(asked); }

    /// After each accepted step. @param readings  of all instruments as one   @param taken  steps of the run with this one
    /// @param largest  so far
    void stepped(const World& run, const WireReadings& readings, long taken, const LargestReadings& largest = {});
    /// Checks the remaining windows. @return the estimate over all
    [[nodiscard]] ErrorEstimate finish(Finer finer);

private:
    /// Largest values in a window: means of hand force and friction, force on a patch if it is the largest so far, hands of the
    /// other instruments [N].
    struct Peaks {
        double hand = 0, friction = 0, patch = 0;
        std::vector<double> others;
    };
    struct Window {
        std::vector<std::uint8_t> state, earlier;  // at its beginning; at that of the window before it
        long first = 0, steps = 0, lead = 0;       // lead: steps of the window before it
        [[nodiscard]] bool is(const Window& other) const { return first == other.first && steps == other.steps; }
        double lengths = 0;                        // sum over its steps of the length of the parts they were taken in, over dt
        std::vector<double> hand, friction;       // of each step, a pull is negative [N]
        Peaks peaks;                              // but for the patch
        Vec3 tip = Vec3::Zero();                  // at its end [m]
        LargestFall struck{mean_time};            // of the sum of normal forces
        bool has_patch = false;                   // the largest force on a patch has risen in it
        bool has_wall = false;                    // the largest displacement or stress of the wall has
        LargestReadings largest;                          // so far, at its end
        GridErrors grid;                          // larger of those at its beginning and end
        std::vector<std::vector<double>> others;  // hands of the instruments but the first, of each step [N]
    };
    /// The hand of an instrument that is not the first.
    struct OtherHand {
        void add(double force, double dt)
        {
            falls.add(std::abs(force), dt);
            release.add(std::abs(force), dt);
        }
        ReleaseWatch release{mean_time};
        FallSum falls{mean_time};
        Window best;            // with its largest force
        MeanSquare means, peaks;
    };
    struct Examined {
        Peaks run, peaks;  // in the same window, of the run and of the twin
        long first = -1, steps = 0, lead = 0;  // of its window
        int parts = 2;
        double ratio = 2;  // of the lengths of steps
        double tip = 0;    // from that of the run [m]
        double swing = 0;  // largest fall of the force on a patch [N]
        LargestReadings largest;
        bool found = false;
        std::vector<double> hand, friction;  // of each of its steps
        std::vector<std::vector<double>> others;
    };
    void open(const World& run, long taken);
    void set_peaks(Window& window) const;
    /// Of a window's last step, over dt: less than 1 where the run ends in it.
    [[nodiscard]] double last_length(const Window& window) const;
    [[nodiscard]] EndMean::Mean end_of(const Window& window, const std::vector<double>& hand, const std::vector<double>& friction,
                                       int parts) const;
    /// At the end: a force of the run against that of the twin. @param history  least share of it that the band is
    void set_end_band(ErrorBand& band, double of_run, double of_twin, const Examined& twin, const std::vector<double>& run,
                      const std::vector<double>& fine, const MeanSquare& others, double history) const;
    /// Hand force and friction at the end, with their bands.
    void set_end(const Window& end, const Examined& twin);
    void close();
    /// Errors by nodes and facets at the end of the present window.
    void gauge(const World& run);
    /// The shares of nodes and facets, and the sum. @param grid  by the wire's energy [N]
    /// @param pushing  force that pushes by normals of facets are relative to
    /// @param more  by nodes besides [N]
    void complete(ErrorBand& band, const GridShare& grid, double pushing, double more = 0) const;
    using Reading = std::function<double(const Peaks&)>;
    enum class Kind { Mean, Single };  // single values of a wire that sticks, slips and strikes have no order in the step
    /// Over all windows compared, with the finest twin of each: the largest that a reading may be with any step, its value in the
    /// run plus margin times the difference of the twin; and the largest of the twins.
    struct Reached {
        double bound = 0, twin = 0;
    };
    [[nodiscard]] Reached reached(const Reading& reading) const;
    /// The largest that a reading may be with any step in a window.
    [[nodiscard]] static double bound_by(const Examined& twin, const Reading& reading);
    /// @param twin  of the window with the largest value   @param windows  differences of all windows
    [[nodiscard]] ErrorBand peak_band(double value, const Examined& twin, const Reading& reading, Kind kind,
                                      const MeanSquare& windows, double history) const;
    void set_patch(const Examined& hand, const Examined& friction);
    void set_wall();
    void set_other(std::size_t k, const Window& end, const Examined& of_end, const Examined& of_hand, Finer finer);
    void set_work();
    /// Once for each window, number of parts and lead. @param parts  of each of the run's steps   @param lead  steps of the
    /// window before that are taken again too
    const Examined& examine(const Window& window, int parts, long lead);
    [[nodiscard]] Examined take_again(const Window& window, int parts, long lead);
    /// Half the step, or a quarter where many were divided.
    const Examined& examine_halved(const Window& window);
    /// At half the step, and finer where that is wanted and the step is a long one. @return the finest that found its states
    const Examined& examine_largest(const Window& window, Finer finer);

    const Scene& scene_;
    const World& run_;
    KeyFrames key_frames_;
    std::unique_ptr<World> world_;  // made when first needed
    Output under_;                  // of it, readings of an elastic wall
    std::function<bool()> stop_asked_;
    Window window_, last_, best_hand_, best_friction_, best_patch_, best_wall_, best_strike_;
    GridErrorGauge gauge_;
    GridErrors grid_;           // at the end of the last window
    MeanSquare axial_, rise_;  // at the ends of windows with contact, GridErrors
    LargestReadings largest_;       // so far
    double inserted_ = 0;  // so far [m]
    double path_ = 0, work_ = 0, pushed_ = 0;  // of the hand: its length [m], its work, the sum of magnitudes of that [J]
    GridShare work_errors_;                    // of the loss by friction, and all that springing took [J]
    double window_rubbed_ = 0;                 // the first within the window [J]
    double motion_loss_ = 0,
           motion_loss_then_ = 0;              // to scheme, contacts and damping: so far, at the beginning of the window [J]
    double mean_differences_ = 0;              // sum over compared windows of margin |mean - mean of the twin| [N]
    bool starting_ = false;  // the twin is of the run's start: it tells of largest values, nothing of other windows
    std::vector<std::unique_ptr<Examined>> examined_;
    // over compared windows, of margin times the difference
    MeanSquare hand_, friction_, hand_peaks_, friction_peaks_, tips_;
    ReleaseWatch hand_release_{mean_time}, friction_release_{mean_time};
    FallSum hand_falls_{mean_time}, friction_falls_{mean_time};
    std::vector<OtherHand> others_;
    long closed_ = 0, seen_ = 0;  // windows, steps
    ErrorEstimate estimate_;
};

inline double ErrorBand::expected() const
{
    return std::hypot(step_part * step, StepTwin::usual_share * nodes, StepTwin::usual_share * facets);
}

}  // namespace seldinger

#pragma once
// A reading with its band, and all bands of a run (D17): band = coverage x hypot(step, by_nodes nodes, by_facets facets).

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace seldinger {

class World;
struct Scene;
struct WireReadings;

/// The constants of bands. What is not derived is calibrated by bench/audit.py on the seeds of bench/results/bands.md.
namespace bands {
inline constexpr double coverage = 1.1;      // calibrated: of the sum of shares
inline constexpr double by_nodes = 1.5;      // calibrated: of a bound by nodes, part of it
inline constexpr double by_facets = 1.0;     // calibrated: of a bound by facets
inline constexpr double safety = 1.5;        // [Roache94], times r/(r - 1), r: ratio of the steps
inline constexpr double least_ratio = 1.1;   // closer steps tell nothing
inline constexpr double usual = 0.57735026918962576;  // 1/sqrt(3): root mean square of what is as likely anywhere within a bound
inline constexpr double wanted = 1.0 / 3;    // calibrated: resolved is what is believed to be off by less, of the value
inline constexpr double least_force = 1e-3;  // forces that no hand feels [N]
// calibrated: windows see no history before them, and slips that come earlier or later; least share of the value
inline constexpr double hand_history = 0.03, friction_history = 0.07;
inline constexpr double least_history = 0.3;  // calibrated: of these, for a force that only rises
inline constexpr double mean_time = 0.02;    // of means: what a hand tells apart [s]
inline constexpr double most_spent = 0.1;    // of the run's steps, on windows: the goal
inline constexpr double cheap = 0.1;         // of the run's steps, on one window with fine_step
inline constexpr double fine_step = 2.5e-4;  // [s] resolves oscillations after a slip, which whole and half steps may both damp
inline constexpr int most_parts = 16;        // of a step
inline constexpr int strike_parts = 4;       // of a step, in the window with the largest strike
inline constexpr double least_strike = 0.1;  // of the largest force on a patch: smaller falls of the normal forces are none
inline constexpr double much_divided = 0.8;  // mean length of steps over dt: below it a twin takes quarters
inline constexpr double most_divided = 0.9;  // part of the run's steps: beyond it a warning says so
}  // namespace bands

[[nodiscard]] inline double band_of_shares(double step, double nodes, double facets)
{
    return bands::coverage * std::hypot(step, bands::by_nodes * nodes, bands::by_facets * facets);
}
/// The one that counts most in that band.
[[nodiscard]] inline const char* largest_share(double step, double nodes, double facets)
{
    nodes *= bands::by_nodes, facets *= bands::by_facets;
    return nodes > std::max(step, facets) ? "nodes" : facets > step ? "facets" : "step";
}

/// One reading with its band.
struct ErrorBand {
    double value = 0, twin = 0;  // with the run's step, with 1/parts of it
    double band = 0;
    bool resolved = true;  // the expected error is at most bands::wanted of the value, or bands::least_force
    bool let_go = false;   // the band is that of a release
    int parts = 2;
    double step = 0, nodes = 0, facets = 0;  // shares of the band
    double step_part = 1 / bands::safety;    // of `step`, that the value is believed to be off by
    bool known = true;                       // the run has seen where the value comes from
    void sum_up() { band = band_of_shares(step, nodes, facets); }
    /// What the value is believed to be off by.
    [[nodiscard]] double expected() const { return std::hypot(step_part * step, bands::usual * nodes, bands::usual * facets); }
    [[nodiscard]] bool is_resolved() const
    {
        return expected() <= std::max(bands::wanted * std::abs(value), bands::least_force);
    }
    [[nodiscard]] const char* largest_source() const { return largest_share(step, nodes, facets); }
    /// The step's share is at least that: a bound, of which no more is expected than before.
    void widen(double bound)
    {
        if (bound <= step) return;
        step_part *= step / bound;
        step = band = bound;
    }
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
    double tip = 0, tip_nodes = 0, tip_facets = 0;       // of the tip's position at the end, by each source [m]
    bool adaptive = false;                               // the wire's nodes
    [[nodiscard]] double tip_band() const { return band_of_shares(tip, tip_nodes, tip_facets); }
};

/// Of a static run: what nodes and facets do to the readings of its last equilibrium, which no step has made. Larger ones on its
/// way have the relative bands of that. @param hand, friction, patch  the largest on its way [N]
[[nodiscard]] ErrorEstimate equilibrium_estimate(const Scene& scene, const World& run, const WireReadings& readings, double hand,
                                                 double friction, double patch);

/// What makes the share of a source smaller.
[[nodiscard]] const char* advice_for(const ErrorEstimate& estimate, const char* source);

/// One sentence for each reading that is not resolved.
[[nodiscard]] std::vector<std::string> unresolved(const ErrorEstimate& estimate);

// A force with its band, for people.

/// "0.103 ± 0.013 N", "3.4 mN": as many digits as the band leaves. @param band  NaN: not known
[[nodiscard]] std::string newtons(double value, double band);

}  // namespace seldinger

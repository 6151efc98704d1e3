#pragma once
// Error bands of a run's forces and tip (D17): windows of the run taken again, in a world of its own, with shorter steps.
//
// A window begins at the run's state and has its nodes and wall. Taken again are the last one and those with the largest means,
// then the run's first 2 mean_time, then the one with the largest strike; and every periodic-th. The run's share of steps that is
// to be spent on them decides how many: what is not compared has the differences of those that are. Without a limit windows are
// longer, and the largest forces are taken again with fine_step too, from one window earlier.
// Shares of nodes and facets come from states at the ends of windows (bands/grid_error.h).

#include "bands/error_band.h"
#include "bands/force_watch.h"
#include "bands/grid_error.h"
#include "engine.h"
#include "setup/key_frames.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace seldinger {

struct Scene;

/// Largest values of single steps: force on a patch [N], displacement [m] and stress [Pa] of an elastic wall.
struct LargestReadings {
    double patch = 0, wall_move = 0, wall_stress = 0;
};

class StepTwin {
public:
    /// Whether the largest forces are taken again with fine_step too: a run of a thousand steps of 17 ms costs two to three times
    /// as much with it.
    enum class Finer { Never, WhereCheap, Always };
    static constexpr long least_steps = 50, few_steps = 12;  // of a window: without a limit, with one
    static constexpr double unlimited = std::numeric_limits<double>::infinity();
    static constexpr int periodic = 20;  // a twin of a window costs two: a tenth of the run's time, with a limit half of that

    /// @param scene, run  outlive this   @param taken  steps of the run so far
    /// @param spend  of the run's steps, on twins; the last window is compared anyway
    StepTwin(const Scene& scene, const World& run, long taken, double spend = unlimited);

    /// Ends its steps as World::stop_when() does: a window in which one is ended tells nothing.
    void stop_when(std::function<bool()> asked) { stop_asked_ = std::move(asked); }

    /// After each accepted step. @param readings  of all instruments as one   @param taken  steps of the run with this one
    /// @param largest  so far
    void stepped(const World& run, const WireReadings& readings, long taken, const LargestReadings& largest = {});
    /// Checks the remaining windows. @return the estimate over all
    [[nodiscard]] ErrorEstimate finish(Finer finer);

private:
    // Forces are numbered: the hands of the instruments, then friction. Lists of largest values have that on a patch of wall last
    using Forces = std::vector<std::vector<double>>;  // of each force, of each step; a pull is negative [N]
    struct Window {
        std::vector<std::uint8_t> state, earlier;  // at its beginning; at that of the window before it
        long first = 0, steps = 0, lead = 0;       // lead: steps of the window before it
        [[nodiscard]] bool is(const Window& other) const { return first == other.first && steps == other.steps; }
        double lengths = 0;                        // sum over its steps of the length of the parts they were taken in, over dt
        Forces forces;
        std::vector<double> peaks;  // largest means [N]; that on a patch stays 0
        Vec3 tip = Vec3::Zero();    // at its end [m]
        LargestFall struck{bands::mean_time};           // of the sum of normal forces
        bool has_patch = false, has_wall = false;       // a largest value has risen in it
        LargestReadings largest;                        // so far, at its end
        GridErrors grid;                                // larger of those at its beginning and end
    };
    struct Force {
        ReleaseWatch release{bands::mean_time};
        FallSum falls{bands::mean_time};
        Window best;                       // with its largest mean
        MeanSquare means, peaks, relative;  // over compared windows, of margin times the difference [N]; of the means, over them
        double history = 0;                // least share of it that a band is
    };
    struct Examined {
        std::vector<double> run = {}, peaks = {};  // largest values of the same window, of the run and of the twin
        long first = -1, steps = 0, lead = 0;  // of its window
        int parts = 2;
        double ratio = 2;  // of the lengths of steps
        double tip = 0;    // from that of the run [m]
        double swing = 0;  // largest fall of the force on a patch [N]
        LargestReadings largest = {};
        bool looked = true, found = false;  // looked: it was not too dear
        Forces forces = {};
    };
    void open(const World& run, long taken);
    void set_peaks(Window& window) const;
    /// Of a window's last step, over dt: less than 1 where the run ends in it.
    [[nodiscard]] double last_length(const Window& window) const;
    [[nodiscard]] double end_of(const Window& window, const std::vector<double>& force, int parts,
                                double* seconds = nullptr) const;
    void close();
    /// Errors by nodes and facets at the end of the present window.
    void gauge(const World& run);
    [[nodiscard]] const Examined* known(const Window& window, int parts, long lead) const;
    /// Once for each window, number of parts and lead. @param parts  of each of the run's steps   @param lead  steps of the
    /// window before that are taken again too
    const Examined& examine(const Window& window, int parts, long lead);
    [[nodiscard]] Examined take_again(const Window& window, int parts, long lead);
    void compare(const Window& window, Examined& twin);
    [[nodiscard]] bool affords(long steps, double share) const;
    /// Half the step, or a quarter where many were divided; not where that is too dear.
    const Examined& examine_halved(const Window& window, bool anyway = false);
    /// At half the step, and finer where that is wanted and the step is a long one. @return the finest that found its states
    const Examined& examine_largest(const Window& window, Finer finer);
    [[nodiscard]] ErrorBand band_of(double value, double of_twin, const Examined& twin, double least, double history) const;
    /// Mean of a force at the end.
    [[nodiscard]] ErrorBand end_band(std::size_t force, const Window& end, const Examined& twin) const;
    /// @param which  of the largest values   @param least  [N]
    [[nodiscard]] ErrorBand peak_band(double value, const Examined& twin, std::size_t which, double least, double history) const;
    [[nodiscard]] ErrorBand force_peak(std::size_t force, const Examined& twin) const;
    /// The largest that a value may be with any step in a window.
    [[nodiscard]] static double bound_by(const Examined& twin, std::size_t which);
    /// The shares of nodes and facets, and the sum. @param grid  by the wire's energy [N]
    /// @param pushing  force that pushes by normals of facets are relative to
    /// @param more  by nodes besides [N]
    void complete(ErrorBand& band, const GridShare& grid, double pushing, double more = 0) const;
    void set_hand(std::size_t k, const Window& end, const Examined& of_end, Finer finer);
    void set_friction(const Window& end, const Examined& of_end, Finer finer);
    void set_patch();
    void set_wall();
    void set_work();

    const Scene& scene_;
    const World& run_;
    double spend_;
    KeyFrames key_frames_;
    std::unique_ptr<World> world_;  // made when first needed
    Output under_;                  // of it, readings of an elastic wall
    std::function<bool()> stop_asked_;
    Window window_, last_, start_, best_patch_, best_wall_, best_strike_;
    std::vector<Force> forces_;
    std::size_t friction_, patch_;  // numbers
    GridErrorGauge gauge_;
    GridErrors grid_;          // when it was gauged last
    long ungauged_ = 0;        // steps since then
    MeanSquare axial_, rise_, tip_facets_;  // at the ends of windows with contact, GridErrors
    LargestReadings largest_;  // so far
    double inserted_ = 0;      // so far [m]
    double path_ = 0, work_ = 0, pushed_ = 0;        // of the hand: its length [m], its work, the sum of magnitudes of that [J]
    GridShare work_errors_;                          // of the loss by friction, and all that springing took [J]
    double rubbed_ = 0;                              // since the last gauge, the first [J]
    double motion_loss_ = 0, motion_loss_then_ = 0;  // to scheme, contacts and damping: so far, at the last gauge [J]
    double mean_differences_ = 0;                    // sum over compared windows of margin |mean - mean of the twin| [N]
    double swing_ = 0;                               // largest of twins [N]
    std::vector<std::unique_ptr<Examined>> examined_;
    long closed_ = 0, seen_ = 0;  // windows, steps
    ErrorEstimate estimate_;
};

}  // namespace seldinger

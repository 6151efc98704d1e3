#pragma once
// Errors of a run: its observables against those of a reference, sample by sample.

#include "models/trajectory.h"

#include <array>
#include <limits>
#include <string_view>

namespace seldinger {

/// Tip: distance of the tips. Shape: Fréchet distance of the whole axis. Hand force and friction: difference of their 20 ms
/// means. Contact: distribution of the normal force along the wire, (1/L) ∫ |F(s) - F_ref(s)| ds with F(s) the force between tip
/// and s. A force f that is misplaced by a distance d counts f d / L; a missing one counts as if it had been moved out at an end.
/// For equal totals this is the Wasserstein-1 distance times total force over length.
enum class Observable { Tip, Shape, HandForce, Friction, Contact };
inline constexpr int observable_count = 5;

struct ObservableWord {
    std::string_view word;  // in tables, without unit
    std::string_view unit;  // SI
    std::string_view says;  // on axes
};
inline constexpr std::array<ObservableWord, observable_count> observable_words = {{
    {"tip", "m", "tip position"},
    {"shape", "m", "shape (Fréchet distance)"},
    {"hand_force", "n", "hand force"},
    {"friction", "n", "total friction"},
    {"contact", "n", "contact force distribution"},
}};

/// Indexed by Observable. NaN: not known.
using PerObservable = std::array<double, observable_count>;
[[nodiscard]] inline double& at(PerObservable& values, Observable which) { return values[static_cast<std::size_t>(which)]; }
[[nodiscard]] inline double at(const PerObservable& values, Observable which) { return values[static_cast<std::size_t>(which)]; }

/// Which samples count.
struct Window {
    double from = 0, until = std::numeric_limits<double>::infinity();  // [s]
    [[nodiscard]] bool holds(double t) const { return t >= from - 1e-9 && t <= until + 1e-9; }
};

struct Errors {
    PerObservable rms{}, worst{}, median{};  // over the samples
    int samples = 0;                         // that counted
};

[[nodiscard]] PerObservable sample_errors(const Sample& sample, const Sample& reference);

/// Over the samples of `reference` in the window that `run` has too (a run that ended early has fewer: see Errors::samples).
[[nodiscard]] Errors trajectory_errors(const Trajectory& run, const Trajectory& reference, const Window& window = {});

}  // namespace seldinger

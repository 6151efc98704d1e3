// What a run says of bands that are too wide, and how to narrow them.
#include "bands/error_band.h"

#include "bands/grid_error.h"
#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace seldinger {

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
        band.resolved = band.is_resolved();
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
        if (band.band == 0 || band.is_resolved())  // what is known of it would not be said
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

// Rounds a force to what its band leaves of it.

std::string newtons(double value, double band)
{
    const bool small = std::max(std::abs(value), std::isfinite(band) ? band : 0.0) < 0.02;
    const double scale = small ? 1e3 : 1;
    const char* unit = small ? "mN" : "N";
    value *= scale, band *= scale;
    if (!(band > 0)) return fmt::format("{:.3g} {}", value, unit);
    // one digit of the band, two where it begins with 1
    const double exponent = std::floor(std::log10(band)), leading = band / std::pow(10, exponent);
    const int decimals = std::clamp(static_cast<int>(-exponent) + (leading < 2 ? 1 : 0), 0, 9);
    return fmt::format("{:.{}f} ± {:.{}f} {}", value, decimals, band, decimals, unit);
}

}  // namespace seldinger

// Kramers' law behind its filters, cut into bins that no K edge divides.
#include "xray/spectrum.h"

#include "core/error.h"
#include "xray/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double step = 0.25;  // of the sum over energies [keV]
constexpr double edges[] = {33.17, 69.53, 78.39};

struct Slice {
    double energy, photons, signal;
};

/// Photons behind the filters that the detector stops, and the energy that they leave.
Slice slice_at(double energy, double kvp)
{
    static const Material tungsten{"tungsten", 19300, {{74, 1.0}}}, aluminium{"aluminium", 2700, {{13, 1.0}}},
        copper{"copper", 8960, {{29, 1.0}}}, iodide{"caesium iodide", 0.75 * 4510, {{53, 0.4885}, {55, 0.5115}}};
    const double through =
        attenuation(tungsten, energy) * 8e-6 + attenuation(aluminium, energy) * 2.5e-3 + attenuation(copper, energy) * 1e-4;
    const double stopped = -std::expm1(-attenuation(iodide, energy) * 6e-4);
    const double photons = (kvp - energy) / energy * std::exp(-through) * stopped;
    return {energy, photons, photons * energy};
}

bool edge_between(double low, double high)
{
    return std::any_of(std::begin(edges), std::end(edges), [&](double e) { return low < e && e <= high; });
}

}  // namespace

std::vector<SpectrumLine> tube_spectrum(double kvp, int bins)
{
    if (!(kvp >= 40 && kvp <= 150))
        throw Error(ErrorKind::BadScene, fmt::format("{} kVp: expected a tube voltage from 40 to 150 kV", kvp));
    std::vector<Slice> slices;
    double photons = 0, signal = 0;
    for (double e = 12 + step / 2; e < kvp; e += step) {
        slices.push_back(slice_at(e, kvp));
        photons += slices.back().photons, signal += slices.back().signal;
    }
    std::vector<SpectrumLine> lines;
    SpectrumLine now;
    double last = 0;
    const auto close = [&] {
        if (now.signal > 0) lines.push_back({now.energy / now.signal, now.photons / photons, now.signal / signal});
        now = {};
    };
    for (const Slice& s : slices) {
        if (edge_between(last, s.energy) || now.signal >= signal / bins) close();
        now.energy += s.energy * s.signal, now.photons += s.photons, now.signal += s.signal;
        last = s.energy;
    }
    close();
    return lines;
}

std::vector<SpectrumLine> single_energy(double energy)
{
    if (!(energy >= 5 && energy <= 200))
        throw Error(ErrorKind::BadScene, fmt::format("{} keV: expected an energy from 5 to 200 keV", energy));
    return {{energy, 1, 1}};
}

}  // namespace seldinger

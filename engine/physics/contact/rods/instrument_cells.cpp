// Cells and pairs from the user's settings.
#include "contact/rods/instrument_cells.h"

#include "contact/wall_law.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace seldinger {
namespace {

constexpr double cell_length = 2;  // radii

/// Pressure per depth of a layer of thickness `depth` on a stiff bed (D6).
double bed_modulus(double youngs, double poisson, double depth)
{
    VesselSpec layer;
    layer.youngs = youngs;
    layer.poisson = poisson;
    layer.thickness = depth;
    return foundation_modulus(layer);
}

InstrumentSurface surface_of(const WireSection& section, double lumen)
{
    const double youngs = section.youngs > 0 ? section.youngs : jacket_youngs;
    const double poisson = section.youngs > 0 ? section.poisson : jacket_poisson;
    const double r = section.radius;
    InstrumentSurface surface;
    surface.radius = r;
    surface.lumen = lumen;
    surface.modulus = surface.lumen_modulus = bed_modulus(youngs, poisson, lumen > 0 ? r - lumen : r);
    surface.mu_static = section.mu_static;
    surface.mu_sliding = section.mu_sliding;
    surface.load = section.density * std::numbers::pi * (r * r - lumen * lumen) * weight_gravity;
    return surface;
}

double damping_of(const ContactSpec& contact)
{
    return contact.normal == NormalLaw::LankaraniNikravesh ? published_damping(contact.restitution)
                                                           : exact_damping(contact.restitution);
}

bool holds(const NestedInstruments& nest, int wire)
{
    return std::find(nest.order.begin(), nest.order.end(), wire) != nest.order.end();
}

}  // namespace

InstrumentCells::InstrumentCells(const InstrumentSetup& setup)
{
    for (const WireSpec& spec : setup.wires) add_cells(spec);
    of_wire.push_back(static_cast<int>(surfaces.size()));
    const int count = static_cast<int>(setup.wires.size());
    move_limit.assign(count, std::numeric_limits<double>::infinity());
    for (int w = 0; w < count; ++w) {
        rods[w].pair = static_cast<uint>(pairs.size());
        add_pairs(setup, w);
        rods[w].pairs = static_cast<uint>(pairs.size()) - rods[w].pair;
    }
    // axes of two that touch are 1.5 of the smaller radius apart at least, those of one in a lumen that far from leaving it
    for (const InstrumentPair& pair : pairs) {
        const double limit = 0.45 * std::min(setup.wires[pair.a].least_radius(), setup.wires[pair.b].least_radius());
        for (const uint w : {pair.a, pair.b}) move_limit[w] = std::min(move_limit[w], limit);
    }
}

void InstrumentCells::add_cells(const WireSpec& spec)
{
    InstrumentRod rod{};
    rod.cell = static_cast<uint>(surfaces.size());
    narrowest.push_back(spec.least_radius());
    rod.epoch = 2;  // a record of zeros must not pass for the last step's
    const int cells = std::max(1, static_cast<int>(std::lround(spec.length / (cell_length * spec.least_radius()))));
    rod.spacing = spec.length / cells;
    for (int k = 0; k < cells; ++k) {
        surfaces.push_back(surface_of(spec.at((k + 0.5) * rod.spacing), spec.lumen_radius));
        rod.widest = std::max(rod.widest, surfaces.back().radius);
        rod_of.push_back(static_cast<uint>(rods.size()));
    }
    of_wire.push_back(static_cast<int>(rod.cell));
    rods.push_back(rod);
}

double InstrumentCells::widest(int wire) const { return rods[wire].widest; }

void InstrumentCells::add_pair(const InstrumentSetup& setup, int a, int b, uint touch)
{
    const ContactSpec& contact = setup.contacts[a];
    InstrumentPair pair{};
    pair.a = static_cast<uint>(a);
    pair.b = static_cast<uint>(b);
    pair.touch = touch;
    pair.from_rod = pair.until_rod = SEL_NO_ROD;
    pair.ends = touch == SEL_TOUCH_OUTSIDE;
    pair.from = -std::numeric_limits<double>::infinity();
    pair.until = std::numeric_limits<double>::infinity();
    if (!contact.stiffness_from_wall) {
        pair.stiffness = contact.stiffness;
        pair.exponent = contact.exponent;
    }
    pair.damping = damping_of(contact);
    pair.mu_static = pair.mu_sliding = -1;
    const double exponent = pair.stiffness > 0 ? pair.exponent : 1.5;
    pair.spread = 1 / std::beta(0.5, exponent + 0.5);
    pairs.push_back(pair);
}

/// A wire inside others: it touches the lumen of the innermost one that is round it. Seen from outside, it touches an outer one
/// only beyond the outer one's mouth, by more than the distance back to the mouth.
void InstrumentCells::add_nested_pairs(const InstrumentSetup& setup, int wire, const NestedInstruments& nest)
{
    const std::ptrdiff_t listed = std::find(nest.order.begin(), nest.order.end(), wire) - nest.order.begin();
    const std::ptrdiff_t place = std::min(listed, std::ssize(nest.order) - nest.exchanged);
    for (std::ptrdiff_t k = 0; k < place; ++k) {
        const int outer = nest.order[static_cast<std::size_t>(k)];
        const double margin = 20 * widest(outer);  // a wire's way to the mouth is not the catheter's to the last tenth
        add_pair(setup, wire, outer, SEL_TOUCH_INSIDE);
        InstrumentPair& inside = pairs.back();
        if (k + 1 < place) {
            inside.from = 0;
            inside.from_rod = static_cast<uint>(nest.order[static_cast<std::size_t>(k) + 1]);
        }
        inside.until = margin;
        inside.until_rod = static_cast<uint>(outer);
        inside.mu_static = nest.mu_static;
        inside.mu_sliding = nest.mu_sliding;
        if (nest.stiffness > 0) {
            inside.stiffness = nest.stiffness;
            inside.exponent = 1.5;
        }
        if (!setup.from_outside) continue;
        add_pair(setup, wire, outer, SEL_TOUCH_OUTSIDE);
        pairs.back().from = std::numbers::pi * (widest(outer) + widest(wire));
        pairs.back().from_rod = static_cast<uint>(outer);
        pairs.back().ends = 0;
    }
}

/// Those in which the wire is a: the inner one of two inside each other, else the first; and itself.
void InstrumentCells::add_pairs(const InstrumentSetup& setup, int wire)
{
    for (const NestedInstruments& nest : setup.nested)
        if (holds(nest, wire)) add_nested_pairs(setup, wire, nest);
    if (!setup.from_outside) return;
    for (int other = wire + 1; other < static_cast<int>(setup.wires.size()); ++other) {
        if (setup.system_of[other] != setup.system_of[wire]) continue;
        const bool nested = std::any_of(setup.nested.begin(), setup.nested.end(),
                                        [&](const NestedInstruments& nest) { return holds(nest, wire) && holds(nest, other); });
        if (!nested) add_pair(setup, wire, other, SEL_TOUCH_OUTSIDE);
    }
    add_pair(setup, wire, wire, SEL_TOUCH_SELF);
}

}  // namespace seldinger

#pragma once
// The instruments of a world for contact between them: cells of material with their surfaces, and the pairs that may touch (D13;
// kernels/shared/instrument_types.h).

#include "contact/contact_spec.h"
#include "rod/wire_spec.h"
#include "shared/instrument_types.h"
#include "vessel/vessel_spec.h"

#include <algorithm>
#include <span>
#include <vector>

namespace seldinger {

/// Instruments inside each other as contact takes them: CoaxialSpec of model.h.
struct NestedInstruments {
    std::vector<int> order;  // wires, outer first
    double mu_static = 0, mu_sliding = 0;
    double stiffness = 0;  // force per metre and depth^1.5 [N/m^2.5]; 0: from the outer one's wall
    int exchanged = 1;     // the last so many are in those before them, and not in each other
};

/// What contact between instruments is made from.
struct InstrumentSetup {
    std::vector<WireSpec> wires;
    std::vector<ContactSpec> contacts;      // [wires]
    std::vector<int> system_of;             // [wires]
    std::vector<NestedInstruments> nested;  // those modelled as a rod each
    bool from_outside = false;              // instruments of a system touch each other, and each itself

    /// Whether any two can touch.
    [[nodiscard]] bool any() const { return from_outside || !nested.empty(); }
};

/// Young's modulus [Pa] and Poisson's ratio of a surface without a given material. They are those of a guidewire's jacket of
/// soft polyurethane: 36 MPa (Elasthane 80A) to 69 MPa (Texin 245). docs/coaxial.md, Surfaces, has the sources and the effect
/// of 4 x smaller and larger values.
inline constexpr double jacket_youngs = 5e7, jacket_poisson = 0.4;

struct InstrumentCells {
    explicit InstrumentCells(const InstrumentSetup& setup);

    std::vector<InstrumentRod> rods;          // [wires]; what changes from step to step is left out
    std::vector<InstrumentPair> pairs;        // by rod a
    std::vector<InstrumentSurface> surfaces;  // [cells]
    std::vector<uint> rod_of;                 // [cells]
    std::vector<int> of_wire;                 // [wires + 1] first cell of each
    std::vector<double> narrowest;            // [wires] least radius [m]
    std::vector<double> move_limit;           // [wires] that no node may move farther at once [m]

private:
    void add_cells(const WireSpec& spec);
    void add_pairs(const InstrumentSetup& setup, int wire);
    void add_pair(const InstrumentSetup& setup, int a, int b, uint touch);
    void add_nested_pairs(const InstrumentSetup& setup, int wire, const NestedInstruments& nest);
    [[nodiscard]] double widest(int wire) const;
};

/// Calls f(wire, first, count) with the stretch of slots in which a wire's cells, of which of_wire tells the first, are listed.
template <class F>
void for_each_stretch(std::span<const std::uint32_t> listed, std::span<const int> of_wire, const F& f)
{
    auto from = listed.begin();
    for (std::size_t w = 0; w + 1 < of_wire.size(); ++w) {
        const auto end = static_cast<std::uint32_t>(SEL_INSTRUMENT_SLOTS * of_wire[w + 1]);
        const auto until = std::lower_bound(from, listed.end(), end);
        if (from != until) f(static_cast<int>(w), std::size_t{*from}, std::size_t{*(until - 1)} - *from + 1);
        from = until;
    }
}

}  // namespace seldinger

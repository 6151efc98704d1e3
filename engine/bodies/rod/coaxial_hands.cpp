// Forces at the hands of instruments that share a centreline: change of the energy when one of them is pushed or turned.
#include "rod/coaxial_stencil.h"

#include <algorithm>

namespace seldinger {

using namespace coaxial;

namespace {

double stretch_stiffness_of(const CoaxialRod& rod, const std::array<const WireSection*, most_coaxial>& section)
{
    double sum = 0;
    for (int k = 0; k < rod.instruments; ++k) sum += section[k] ? section[k]->stretch_stiffness : 0;
    return sum;
}

/// What hands feel at a configuration.
struct HandForces : CoaxialShape {
    /// Energy per length that cell i gains when it gains `factor` of such material per length.
    [[nodiscard]] double cell_gain(int i, const CoaxialCell& rate) const
    {
        return cell_energy_rate(rod.cells[i], rate, stencil_at(*this, i), rod.instruments);
    }
    /// The same of an edge's stretching. @param grow  d(rest length)
    [[nodiscard]] double edge_gain(int j, double covered, double compliance, double grow) const
    {
        if (!(rod.stretch_covered[j] > 0)) return 0;
        const double strain = stretch_strain(line, frames, j), rest = line.rest_length[j], inv = 1 / rod.stretch_compliance[j];
        const double pull = rod.stretch_covered[j] * strain * inv;  // force
        return pull * (strain * covered - rod.stretch_covered[j] * (1 + strain) / rest * grow) - 0.5 * pull * pull * compliance;
    }

    /// At s material `right` takes the place of `left`, one length of it per length that it moves tipwards.
    [[nodiscard]] double change_gain(double s, const std::array<const WireSection*, most_coaxial>& left,
                                     const std::array<const WireSection*, most_coaxial>& right) const
    {
        const auto nodes = line.material_s.first(line.n);
        const int j = static_cast<int>(std::ranges::upper_bound(nodes, s) - nodes.begin()) - 1;  // edge it is on
        const int i = s < 0.5 * (nodes[j] + nodes[j + 1]) ? j : j + 1;                           // cell it is in
        const auto count = static_cast<std::size_t>(rod.instruments);
        CoaxialCell rate;
        rate.add({right.data(), count}, 1);
        rate.add({left.data(), count}, -1);
        const double stiff_l = stretch_stiffness_of(rod, left), stiff_r = stretch_stiffness_of(rod, right);
        const auto inverse = [](double stiffness) { return stiffness > 0 ? 1 / stiffness : 0; };
        const double covered = (stiff_r > 0 ? 1 : 0) - (stiff_l > 0 ? 1 : 0);
        return cell_gain(i, rate) + edge_gain(j, covered, inverse(stiff_r) - inverse(stiff_l), 0);
    }

    [[nodiscard]] double offset_force(int k) const
    {
        double force = 0;
        for (std::size_t p = 0; p + 1 < rod.pieces.size(); ++p) {
            const auto &left = rod.pieces[p].section, &right = rod.pieces[p + 1].section;
            if (left[k] == right[k]) continue;
            // where others change at the same place the two sides differ: the mean
            auto only_k = left, all_but_k = right;
            only_k[k] = right[k];
            all_but_k[k] = left[k];
            const double s = rod.pieces[p].end;
            force += only_k == right ? change_gain(s, left, right)
                                     : 0.5 * (change_gain(s, left, only_k) + change_gain(s, all_but_k, right));
        }
        return force;
    }

    /// Half of the gain goes to the cell before the hub's, half to the hub's, whose other end moves.
    [[nodiscard]] double line_force() const
    {
        const int hub = line.n - 1;
        const double middle = 0.5 * (line.material_s[hub - 1] + line.material_s[hub]);
        const auto holds = [&](const CoaxialPiece& piece) { return middle < piece.end; };
        const auto at_middle = std::ranges::find_if(rod.pieces, holds);
        const auto& in = at_middle == rod.pieces.end() ? rod.pieces.back().section : at_middle->section;
        const auto& fed = rod.pieces.back().section;
        const auto count = static_cast<std::size_t>(rod.instruments);
        CoaxialCell before, end;
        before.length = end.length = 0.5;
        before.add({in.data(), count}, 0.5);
        end.add({in.data(), count}, -0.5);
        end.add({fed.data(), count}, 1);
        const double stiffness = stretch_stiffness_of(rod, fed);
        double force = edge_gain(hub - 1, stiffness > 0 ? 1 : 0, stiffness > 0 ? 1 / stiffness : 0, 1) + cell_gain(hub, end);
        if (hub > 1) force += cell_gain(hub - 1, before);
        return force;
    }

    [[nodiscard]] double torque(int k) const
    {
        const int hub = line.n - 1;
        if (base.behind[k] > 0) return (base.hand[k] - trial.theta[k][hub]) / base.behind[k];
        StencilTerms terms;
        add_cell(rod.cells[hub], stencil_at(*this, hub), rod.instruments, HessianMode::None, terms);
        return terms.own[k].gb;
    }
};

}  // namespace

CoaxialHands coaxial_hands(const CoaxialShape& shape)
{
    const HandForces forces{shape};
    CoaxialHands hands;
    hands.line_force = forces.line_force();
    for (int k = 0; k < shape.rod.instruments; ++k) {
        hands.offset_force[k] = forces.offset_force(k);
        hands.torque[k] = forces.torque(k);
    }
    return hands;
}

}  // namespace seldinger

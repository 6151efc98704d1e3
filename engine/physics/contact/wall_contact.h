#pragma once
// Contact with the wall as the wires of a world feel it. A rigid wall's is the detection method itself (contact_system.h); an
// elastic wall stands in front of one (contact/wall_body.h). What only a wall that moves has to say has the rigid wall's
// answer here, so that nobody asks which of the two it is.

#include "contact/contact_row.h"
#include "solve/force_term.h"
#include "wall/wall_readings.h"

#include <limits>
#include <vector>

namespace seldinger {

class WallContact : public ForceTerm {
public:
    /// Whether a wire on its present nodes is clear of the wall; asked of laws that never overlap.
    [[nodiscard]] virtual bool is_clear(RodArrays& /*rods*/, int /*wire*/) { return true; }
    /// Adds contact forces on the nodes of a wire, [n], as the wire feels them.
    virtual void add_nodal_forces(int wire, std::span<Vec3> forces) const = 0;
    /// Contacts of the accepted state where the wall is now.
    [[nodiscard]] virtual std::vector<ContactRow> rows(RodArrays& rods) = 0;

    /// Feet of the nodes on the wall before a step that may be stopped, and put back after it has been: attempts move them.
    virtual void keep_feet() {}
    virtual void put_feet_back() {}
    /// Whether a step of h starts a block of steps of the wall, which changes what walk_state() saves.
    [[nodiscard]] virtual bool begins_block(double /*h*/) const { return false; }
    /// A step of h that is accepted for these wires: the wall of a system none of whose wires was evaluated in it, as all are
    /// in their introducers, takes the step by itself. Before commit().
    virtual void take_unwatched(double /*h*/, std::span<const std::uint8_t> /*done*/) {}
    /// Whether the wall of this system could take the last step or equilibrium that was tried; trials of its wires are not
    /// admissible else.
    [[nodiscard]] virtual bool stands(int /*system*/) const { return true; }
    /// Farthest that the wall has moved under a wire of this system, of 20 % of the lumen's radius there [-].
    [[nodiscard]] virtual double move_share(int /*system*/) const { return 0; }
    /// Nodes of a wire and middles of its edges, as contact takes them: carried to the wall where it has not moved.
    virtual void list_seen(RodArrays& rods, int wire, std::vector<Vec3>& places) const
    {
        const ConstRodView rod = rods.view(wire);
        places.clear();
        for (int j = 0; j + 1 < rod.n; ++j) {
            places.push_back(rod.pos(j));
            places.push_back((rod.pos(j) + rod.pos(j + 1)) / 2);
        }
    }
    /// Length of a rod's edge in contact that the wall's own mesh asks for [m]; infinite: any.
    [[nodiscard]] virtual double edge_touched() const { return std::numeric_limits<double>::infinity(); }
    /// Flags nodes of the accepted state that must stay, since between their neighbours the displacement of the wall is not
    /// linear.
    /// @param bowed  [n] flags, set there
    virtual void mark_bowed(RodArrays& /*rods*/, int /*wire*/, std::span<std::uint8_t> /*bowed*/) const {}

    /// Displacement of the control vertices [3V] [m], empty for a rigid wall, and contact's work on them since the beginning [J].
    [[nodiscard]] virtual std::vector<double> displacement(int /*system*/) const { return {}; }
    [[nodiscard]] virtual double work(int /*system*/) const { return 0; }
    /// Largest displacement and stress under the wires at the end of the last step; the rest of the readings is 0.
    [[nodiscard]] virtual WallReadings under(int /*system*/) const { return {}; }
    /// Readings of all of the wall, with those under the wires.    @param stress  as read_wall
    [[nodiscard]] virtual WallReadings readings(int /*system*/, std::span<const double> /*displacement*/,
                                                std::vector<double>* /*stress*/ = nullptr) const
    {
        return {};
    }
};

}  // namespace seldinger

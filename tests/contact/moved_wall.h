#pragma once
// Contact of a wire that is put where a test wants it, step by step, with a wall that moves as the test says.

#include "contact/contact_system.h"
#include "rod/place.h"
#include "support/world_fixture.h"
#include "world.h"

#include <memory>

namespace seldinger::test {

class MovedWall {
public:
    MovedWall(device::Context& context, TestSetup from, bool moves = true)
        : world_(std::move(from)),
          rods_(std::vector<int>{world_.wires[0].wire.nodes}),
          wall_(world_.vessel, world_.mesh, world_.centreline),
          setup_(with_motion(contact_setup(world_, wall_), moves)),
          displacement_(world_.mesh.vertices.size(), Vec3::Zero())
    {
        place_wire(rods_, 0, world_.wires[0].wire, {});
        contact_ = make_contact(context, setup_, rods_);
    }

    /// One step of h: the wire goes by `wire`, the wall by `wall`, each as a whole. h = 0: static.
    void step(const Vec3& wire, const Vec3& wall, double h)
    {
        for (Vec3& d : displacement_) d += wall;
        step_to(wire, displacement_, wall.squaredNorm() > 0, h);
    }
    /// The wall goes to `displacement` [V].
    void step_to(const Vec3& wire, const std::vector<Vec3>& displacement, bool wall_moves, double h)
    {
        displacement_ = displacement;
        contact_->begin_step(rods_);
        const RodView rod = rods_.view(0);
        for (int i = 0; i < rod.n; ++i) {
            rod.x[i] += wire.x();
            rod.y[i] += wire.y();
            rod.z[i] += wire.z();
        }
        if (wall_moves) contact_->move_wall(0, displacement_);
        TrialState here;
        here.x.assign(rod.x.begin(), rod.x.end());
        here.y.assign(rod.y.begin(), rod.y.end());
        here.z.assign(rod.z.begin(), rod.z.end());
        here.theta.assign(rod.n, 0.0);
        const std::vector<std::uint8_t> on = {1};
        contact_->prepare(rods_, on);
        contact_->evaluate(here, h, on);
        contact_->commit(on);
    }
    [[nodiscard]] std::vector<ContactRow> rows() { return contact_->rows(rods_); }
    [[nodiscard]] ContactTotals totals() const { return contact_->totals(0); }
    [[nodiscard]] const std::vector<Vec3>& displacement() const { return displacement_; }

private:
    static ContactSetup with_motion(ContactSetup setup, bool moves)
    {
        setup.wall_moves = moves;
        return setup;
    }
    TestSetup world_;
    RodArrays rods_;
    WallModel wall_;
    ContactSetup setup_;
    std::vector<Vec3> displacement_;
    std::unique_ptr<ContactMethod> contact_;
};

}  // namespace seldinger::test

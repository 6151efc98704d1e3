#pragma once
// Contact with an elastic wall (D11): the force term in front of contact with the undeformed wall; it carries wires back to that
// wall (wall_stations.h). Both bodies are solved together:
//
//     wire   R(x) - A^T f(y) = 0                   f: what contact exerts on the nodes, whatever finds it and whatever its laws;
//                                                  A = dy/dx = (1 + G)^-1 (wall_stations.h)
//     wall   rho = U - U_free + W A^T f(y) = 0     U_free: where the wall would be at the end of the step if nothing touched it
//
// Newton's residual takes both. At each trial x the wall moves to the position that the last linear equations of both give for
// this x. The remaining rho goes into the wire's residual as the force that it will still make. With T = -A^T df/dy A the
// tangent is T - T (W^-1 + T)^-1 T: unknowns U beside the band (math/condensed.h). If a trial is far from this prediction (rho
// above 10 % of the largest force), the wall is moved again at the same x.
//
// When a step is accepted the wall takes -A^T f, all of it: (K + C/h) w1 = C/h w0 - sum N^T A^T f (shell/wall_dynamics.h).

#include "contact/contact_system.h"
#include "coupling/wall_stations.h"
#include "core/parallel.h"
#include "math/banded_solver.h"

#include <memory>
#include <vector>

namespace seldinger {

class ElasticContact final : public WallContact {
public:
    /// @param unmoved  what `contact` was made with; as `rods`, carried back @param systems  [wires]  @param rods  of the world
    ElasticContact(const ElasticWall& wall, ContactMethod& contact, RodArrays& rods, RodArrays& unmoved,
                 std::span<const int> systems);
    ~ElasticContact() override;

    void begin_step(RodArrays& rods, Settling how) override;
    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override;
    void evaluate(const TermTrial& trial) override;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) override;
    void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const override;
    void couple(const SystemUnknowns& system, std::span<double> residual, BandedSolver* tangent, bool symmetric) const override;
    void take(int wire, Base base, std::span<double> kinks) override;
    bool refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again) override;
    void take_unwatched(double h, std::span<const std::uint8_t> done) override;
    void commit(std::span<const std::uint8_t> active) override;
    void walk_state(StateWalk& walk, int wire) override;

    void keep_feet() override;
    void put_feet_back() override;
    [[nodiscard]] bool begins_block(double h) const override;
    /// As of the contact behind it.
    [[nodiscard]] bool is_clear(RodArrays& rods, int wire) override;
    [[nodiscard]] std::vector<double> displacement(int system) const override;
    [[nodiscard]] double work(int system) const override;
    /// Looked at are nodes with at least half of the largest force, the scene's loads, and the triangles there.
    [[nodiscard]] WallReadings under(int system) const override;
    [[nodiscard]] WallReadings readings(int system, std::span<const double> displacement,
                                        std::vector<double>* stress = nullptr) const override;
    void add_nodal_forces(int wire, std::span<Vec3> forces) const override;
    [[nodiscard]] std::vector<ContactRow> rows(RodArrays& rods) override;
    /// The wire's arrays as the wall sees them where it has not moved, into what contact was made with.
    void carry_back(RodArrays& rods, int wire);
    /// As WallStations::seen_at, without what contact carries over from step to step and between nodes.
    void list_seen(RodArrays& rods, int wire, std::vector<Vec3>& places) const override;
    [[nodiscard]] double edge_touched() const override { return wall_.edge_touched(); }
    /// Without such a node the wire would be mapped back to other points at once, deeper in the wall than its law bears.
    void mark_bowed(RodArrays& rods, int wire, std::span<std::uint8_t> bowed) const override;
    [[nodiscard]] double move_share(int system) const override;
    /// See WallDynamics::begin_step.
    [[nodiscard]] bool stands(int system) const override;

private:
    struct System;
    [[nodiscard]] System& of(int wire) const { return *systems_[system_of_[wire]]; }
    /// On threads, one system on each: its wires ask the same wall, which keeps what it has answered.
    template <class F>
    void for_each_system(const F& f)
    {
        for_each_item(static_cast<int>(systems_.size()), 1, [&](int s) { f(*systems_[static_cast<std::size_t>(s)]); });
    }
    void evaluate_start(const TermTrial& start);
    [[nodiscard]] double work_from_outside(int wire) const;
    void take_times(double seconds);
    void place_and_copy(RodArrays& rods, int wire);
    [[nodiscard]] bool begun(System& system, double h);
    void start_step(System& system, double h) const;
    void list_rows(System& system) const;
    void set_free(System& system) const;
    void add_rows(System& system) const;
    void predict(System& system, const TrialState& trial) const;
    void guess(System& system) const;
    void carry_trial(System& system, const TrialState& trial, TrialState& to) const;
    [[nodiscard]] bool take_forces(System& system) const;
    void linearise(System& system, const SystemUnknowns* among, Condensed& to) const;
    [[nodiscard]] double open_way(const System& system, int wire) const;
    void list_pushes(System& system) const;
    void end_equilibrium(System& system, double farthest) const;
    [[nodiscard]] bool relax(System& system) const;
    void read_under(System& system) const;
    [[nodiscard]] double line_load(const System& system, std::size_t row, std::int32_t triangle) const;

    const ElasticWall& wall_;
    ContactMethod& contact_;
    RodArrays& rods_;
    RodArrays& unmoved_;
    std::vector<int> system_of_;  // [wires]
    std::vector<std::unique_ptr<System>> systems_;
    mutable std::vector<BandMatrix> tangents_;            // [wires] of contact, at y
    mutable std::vector<std::vector<double>> residuals_;  // [wires] likewise
    TrialState carried_, before_;
    std::vector<std::uint8_t> todo_;
};

}  // namespace seldinger

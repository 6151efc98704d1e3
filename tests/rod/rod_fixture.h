#pragma once
// One wire with everything it needs, for tests: shapes, a dense view of the band, equilibrium by Newton.

#include "rod/elastic.h"
#include "rod/transport.h"
#include "support/approx.h"

#include <Eigen/Dense>
#include <random>
#include <string>
#include <vector>

namespace seldinger::test {

using test::about;

/// Trial configuration that owns its numbers.
struct OwnedTrial {
    std::vector<double> x, y, z, theta;
    explicit OwnedTrial(const RodView& rod)
        : x(rod.x.begin(), rod.x.end()),
          y(rod.y.begin(), rod.y.end()),
          z(rod.z.begin(), rod.z.end()),
          theta(rod.theta.begin(), rod.theta.end())
    {
    }
    [[nodiscard]] RodTrial view() const { return {x, y, z, theta}; }
    /// Unknown 4 i + c.
    double& operator[](int q)
    {
        return (q % RodDofs::per_node == 0   ? x
                : q % RodDofs::per_node == 1 ? y
                : RodDofs::is_spin(q)        ? theta
                                             : z)[RodDofs::node(q)];
    }
};

struct OneWire {
    RodArrays arrays;
    RodView rod;
    RodFrames frames;
    std::vector<RodClamp> clamps;
    BandMatrix band;

    explicit OneWire(int n, int capacity = 0)
        : arrays(std::vector<int>{std::max(n, capacity)}),
          frames(std::max(n, capacity)),
          band(RodDofs::count(std::max(n, capacity)))
    {
        arrays.set_node_count(0, n);
        rod = arrays.view(0);
    }

    /// Node positions tip to hub; frames straight from them, material_s from the chords.
    void place(const std::vector<Vec3>& nodes, const Vec3& normal = Vec3::UnitZ())
    {
        for (int i = 0; i < rod.n; ++i) rod.set_pos(i, nodes[i]);
        rod.material_s[0] = 0;
        for (int i = 1; i < rod.n; ++i) rod.material_s[i] = rod.material_s[i - 1] + (nodes[i] - nodes[i - 1]).norm();
        initialise_frames(rod, normal);
    }

    [[nodiscard]] bool update(const OwnedTrial& trial) { return update_frames(rod, trial.view(), clamps, frames); }
    [[nodiscard]] bool update() { return update(OwnedTrial(rod)); }
    [[nodiscard]] double energy() const { return elastic_energy(rod, clamps, frames); }
    [[nodiscard]] double energy_at(const OwnedTrial& trial) { return update(trial) ? energy() : std::nan(""); }
    [[nodiscard]] bool accept(const OwnedTrial& trial)
    {
        if (!update(trial)) return false;
        accept_frames(rod, trial.view(), frames);
        return true;
    }

    [[nodiscard]] Eigen::VectorXd gradient()
    {
        Eigen::VectorXd g = Eigen::VectorXd::Zero(RodDofs::count(rod.n));
        add_elastic(rod, clamps, frames, {g.data(), static_cast<std::size_t>(g.size())}, nullptr, HessianMode::None);
        return g;
    }
    [[nodiscard]] Eigen::MatrixXd hessian(HessianMode mode)
    {
        const int size = RodDofs::count(rod.n);
        Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
        band.reset(size);
        add_elastic(rod, clamps, frames, {g.data(), static_cast<std::size_t>(size)}, &band, mode);
        Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size, size);
        for (int i = 0; i < size; ++i)
            for (int j = std::max(0, i - 10); j <= std::min(size - 1, i + 10); ++j) h(i, j) = band.at(i, j);
        return h;
    }
};

/// Newton to equilibrium under dead forces `load` [4n], unknowns listed in `fixed` held; frames are accepted at every
/// iterate, updates cut to `largest_move`. @return iterations, or -1
inline int equilibrate(OneWire& wire, const Eigen::VectorXd& load, const std::vector<int>& fixed, HessianMode mode,
                       double tolerance, int most = 200, double largest_move = 1e300)
{
    const int size = RodDofs::count(wire.rod.n);
    std::vector<int> held = fixed;
    held.push_back(size - 1);  // the last node has no angle
    for (int iteration = 0; iteration < most; ++iteration) {
        if (!wire.update()) return -1;
        Eigen::VectorXd r = -load;
        wire.band.reset(size);
        add_elastic(wire.rod, wire.clamps, wire.frames, {r.data(), static_cast<std::size_t>(size)}, &wire.band, mode);
        r = -r;
        for (const int q : held) {
            r[q] = 0;
            wire.band.fix(q);
        }
        if (r.lpNorm<Eigen::Infinity>() < tolerance) return iteration;
        wire.band.factor_ldlt();
        wire.band.solve_ldlt({r.data(), static_cast<std::size_t>(size)});
        r *= std::min(1.0, largest_move / r.lpNorm<Eigen::Infinity>());
        OwnedTrial trial(wire.rod);
        for (int q = 0; q < size - 1; ++q) trial[q] += r[q];
        if (!wire.accept(trial)) return -1;
    }
    return -1;
}

/// A round isotropic wire, scaled to the problem.
inline WireSpec uniform_spec(double length, double bend, double twist, double stretch)
{
    WireSpec spec;
    spec.length = length;
    spec.shaft.radius = 1e-3;
    spec.shaft.density = 8000;
    spec.shaft.bend_stiffness = bend;
    spec.shaft.twist_stiffness = twist;
    spec.shaft.stretch_stiffness = stretch;
    return spec;
}

/// Nodes of a straight wire along -x: tip at the origin... hub at (length, 0, 0).
inline std::vector<Vec3> straight_nodes(int n, double length)
{
    std::vector<Vec3> nodes;
    for (int i = 0; i < n; ++i) nodes.push_back({length * i / (n - 1), 0, 0});
    return nodes;
}

inline Vec3 random_unit(std::mt19937& rng)
{
    std::normal_distribution<double> normal;
    return Vec3(normal(rng), normal(rng), normal(rng)).normalized();
}

/// Of a node, off the wire's own direction and several turns on.
inline RodClamp random_clamp(const OneWire& wire, int node, bool direction, bool spin, unsigned seed)
{
    std::mt19937 rng(seed);
    RodClamp clamp{.node = node,
                   .direction = direction,
                   .spin = spin,
                   .tangent = (wire.rod.tangent(std::min(node, wire.rod.n - 2)) + 0.4 * random_unit(rng)).normalized()};
    clamp.director = unit_normal(random_unit(rng), clamp.tangent);
    clamp.turns = 5;
    return clamp;
}

}  // namespace seldinger::test

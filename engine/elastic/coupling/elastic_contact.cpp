// Wire and wall solved together: trials, residual, tangent. Start and end of a step: elastic_contact_step.cpp.
#include "coupling/elastic_system.h"
#include "core/clock.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace seldinger {
namespace {

constexpr int most_moves = 6;           // of the wall at one trial
constexpr double predicted_force = 0.1;  // of the largest: what may be missed at a trial that is not the last one
constexpr double predicted_move = 0.02;  // of the wire's radius, likewise
constexpr double balanced_force = 1e-6, balanced_move = 1e-4;  // likewise of the accepted one
// of the wall's own equations: Newton's last residual is at most 1e-4 radii of rho; wires in contact over their whole length find
// no equilibrium with 1e-7
constexpr double in_time = 1e-8, at_rest = 1e-11;
constexpr int most_refinements = 8;                                 // that ask for more than Newton's convergence
constexpr int most_relaxations = 100;                               // of an equilibrium of a wall that moves far

Mat3 block_of(const BandMatrix& t, int row, int column)
{
    Mat3 block;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) block(r, c) = t.at(row + r, column + c);
    return block;
}

/// How contact's force on a node i changes with the move of a node j, and the other way round, as wire and wall see it.
struct NodeJoint {
    Mat3 of = Mat3::Zero(), on = Mat3::Zero();            // force on i by j, force on j by i
    Vec3 of_spin = Vec3::Zero(), on_spin = Vec3::Zero();  // force on i by the spin of j's edge, moment on that by i
    bool any = false, spins = false;

    /// Row c of i into F, E^T and D. @param unknown  first of j  @param place  of j among the wall's, < 0: none
    void put(int c, int unknown, int place, Condensed& to) const
    {
        if (!any) return;
        for (int d = 0; d < 3; ++d) {
            to.f.add(unknown + d, of(c, d));
            to.e_transposed.add(unknown + d, on(d, c));
            if (place >= 0) to.d.add(place + d, of(c, d));
        }
        if (!spins) return;
        to.f.add(unknown + RodDofs::spin_place, of_spin[c]);
        to.e_transposed.add(unknown + RodDofs::spin_place, on_spin[c]);
    }
};

NodeJoint joint_of(const BandMatrix& t, int i, int j, bool has_spin, const Mat3& back_i, const Mat3& back_j)
{
    NodeJoint joint;
    const int a = RodDofs::position(i), b = RodDofs::position(j), spin = b + RodDofs::spin_place;
    joint.of = block_of(t, a, b);
    joint.on = block_of(t, b, a);
    if (has_spin)
        for (int c = 0; c < 3; ++c) joint.of_spin[c] = t.at(a + c, spin), joint.on_spin[c] = t.at(spin, a + c);
    joint.spins = !joint.of_spin.isZero() || !joint.on_spin.isZero();
    joint.any = joint.spins || !joint.of.isZero() || !joint.on.isZero();
    if (!joint.any) return joint;
    joint.of = back_i.transpose() * joint.of * back_j;
    joint.on = back_j.transpose() * joint.on * back_i;
    joint.of_spin = back_i.transpose() * joint.of_spin;
    joint.on_spin = back_i.transpose() * joint.on_spin;
    return joint;
}

}  // namespace

ElasticContact::ElasticContact(const ElasticWall& wall, ContactMethod& contact, RodArrays& rods, RodArrays& unmoved,
                           std::span<const int> systems)
    : wall_(wall), contact_(contact), rods_(rods), unmoved_(unmoved), system_of_(systems.begin(), systems.end())
{
    traits_ = contact.traits();
    for (int w = 0; w < rods.wire_count(); ++w) {
        if (system_of_[w] == static_cast<int>(systems_.size()))
            systems_.push_back(std::make_unique<System>(wall, rods.node_begin(w)));
        System& system = of(w);
        system.wires.push_back(w);
        system.stations.provide(system.stations.count() + rods.capacity(w));
        system.kept.provide(system.stations.count());
        system.ends.resize(system.stations.count());
        system.before.resize(system.ends.size());
        system.force_before.resize(system.ends.size(), Vec3::Zero());
        system.y_start.resize(3 * static_cast<std::size_t>(system.stations.count()));
        system.least_radius = std::min(system.least_radius, rods.view(w).radius[0]);
        tangents_.emplace_back(RodDofs::count(rods.capacity(w)));
        residuals_.emplace_back(RodDofs::count(rods.capacity(w)));
    }
    for (TrialState* state : {&carried_, &before_})
        for (auto* array : {&state->x, &state->y, &state->z, &state->theta}) array->resize(rods.total_capacity());
    todo_.resize(rods.wire_count());
}

ElasticContact::~ElasticContact() = default;

// ---- at a trial ---------------------------------------------------------------------------------------------------------------

/// What contact has taken is in this term's times too.
void ElasticContact::take_times(double seconds)
{
    times += contact_.times;
    times.wall += seconds;
    contact_.times = {};
}

void ElasticContact::evaluate(const TermTrial& trial)
{
    if (trial.before) return evaluate_start(trial);
    std::copy(trial.active.begin(), trial.active.end(), todo_.begin());
    bool again = true;
    for (int round = 0; again; ++round) {
        auto start = Clock::now();
        for_each_system([&](System& system) {
            if (!system.is_in(todo_)) return;
            if (!begun(system, trial.h)) return;
            if (round > 0) system.correct();
            else if (predict(system, trial.at); trial.h > 0 && !system.base_trial()) guess(system);
            carry_trial(system, trial.at, carried_);
        });
        take_times(seconds_since(start));
        contact_.evaluate({carried_, trial.h, todo_});
        start = Clock::now();
        again = false;
        for (const auto& system : systems_) {
            if (!system->is_in(todo_)) continue;
            const bool settled = take_forces(*system) && system->misses(predicted_force, predicted_move) <= 1;
            if (settled || round == most_moves)
                for (const int w : system->wires) todo_[w] = 0;
            else again = true;
        }
        take_times(seconds_since(start));
    }
}

/// The wall stands where it is when forces are taken at the start of a step.
void ElasticContact::evaluate_start(const TermTrial& start)
{
    std::copy(start.active.begin(), start.active.end(), todo_.begin());
    for (const auto& system : systems_) {
        if (!system->is_in(todo_) || !begun(*system, start.h)) continue;
        predict(*system, start.at);
        carry_trial(*system, *start.before, before_);
        carry_trial(*system, start.at, carried_);
    }
    contact_.evaluate({carried_, start.h, todo_, &before_, start.linearised});
    take_times(0);
    for (const auto& system : systems_)
        if (system->is_in(todo_)) (void)take_forces(*system);
}

/// Where the wall goes under the forces of the accepted state, which change little in a step.
void ElasticContact::guess(System& system) const
{
    const auto force_on = [&](std::size_t k) -> const Vec3& {
        return system.force_before[static_cast<std::size_t>(system.rows[k])];
    };
    std::vector<std::size_t>& loaded = system.loaded;
    loaded.clear();
    for (std::size_t k = 0; k < system.rows.size(); ++k) {
        if (force_on(k).isZero()) continue;
        loaded.push_back(k);
        system.compliance.want(static_cast<int>(k));
    }
    system.compliance.provide();  // all at once: stations beside each other share most of it
    std::vector<double>& u = system.trial().u;
    u.assign(3 * system.rows.size(), 0.0);
    for (const std::size_t k : loaded) system.compliance.add(static_cast<int>(k), -force_on(k), u);
    for (std::size_t k = 0; k < u.size(); ++k) u[k] += system.u_free[k];
}

/// U where the last linear equations of wire and wall have it for this trial; at the first one, where the wall was.
void ElasticContact::predict(System& system, const TrialState& trial) const
{
    WallTrial& now = system.next_trial();
    now.q.resize(4 * static_cast<std::size_t>(system.stations.count()));
    for (const int w : system.wires)
        for (int i = 0; i < rods_.node_count(w); ++i) {
            const std::size_t from = static_cast<std::size_t>(rods_.node_begin(w) + i);
            double* q = &now.q[4 * (from - static_cast<std::size_t>(system.first_node))];
            q[0] = trial.x[from], q[1] = trial.y[from], q[2] = trial.z[from], q[3] = trial.theta[from];
        }
    const WallTrial* base = system.base_trial();
    if (!base) {
        now.u.resize(3 * system.rows.size());
        for (std::size_t k = 0; k < system.rows.size(); ++k)
            system.stations[system.rows[k]].start.store(&now.u[3 * k]);
        return;
    }
    const std::size_t m = base->u.size();
    std::vector<double>&move = system.scratch_q, &along = system.scratch_m;
    move.resize(now.q.size());
    along.resize(base->linear.row_count());
    for (std::size_t i = 0; i < move.size(); ++i) move[i] = now.q[i] - base->q[i];
    base->linear.f.times(move, along);
    now.u.resize(m);
    base->linear.times_w_of_rows(along, now.u);
    for (std::size_t k = 0; k < m; ++k) now.u[k] -= base->rho[k];
    base->linear.guess_own(now.u);
    for (std::size_t k = 0; k < m; ++k) now.u[k] += base->u[k];
}

void ElasticContact::carry_trial(System& system, const TrialState& trial, TrialState& to) const
{
    WallTrial& now = system.trial();
    now.y.resize(3 * static_cast<std::size_t>(system.stations.count()));
    for (const int w : system.wires)
        for (int i = 0; i < rods_.node_count(w); ++i) {
            const std::size_t at = static_cast<std::size_t>(rods_.node_begin(w) + i);
            const std::size_t own = at - static_cast<std::size_t>(system.first_node);
            const Vec3 x(trial.x[at], trial.y[at], trial.z[at]);
            const Vec3 y = system.carry(static_cast<int>(own), x);
            to.x[at] = y.x(), to.y[at] = y.y(), to.z[at] = y.z(), to.theta[at] = trial.theta[at];
            y.store(&now.y[3 * own]);
        }
}

/// What contact has said, and how it changes. @return false: nodes have come to touch that were not thought of; the wall moves
/// under them too from the next evaluation on
bool ElasticContact::take_forces(System& system) const
{
    bool thought_of = true;
    for (const int w : system.wires) {
        const int n = rods_.node_count(w);
        std::span<double> residual = std::span(residuals_[w]).first(RodDofs::count(n));
        std::fill(residual.begin(), residual.end(), 0.0);
        tangents_[w].reset(RodDofs::count(n));
        contact_.add(w, residual, &tangents_[w], false);
        for (int i = 0; i < n; ++i) {
            WallStation& station = system.stations[rods_.node_begin(w) - system.first_node + i];
            if (!station.near || station.row >= 0) continue;
            const double* r = &residual[RodDofs::position(i)];
            thought_of = thought_of && r[0] == 0 && r[1] == 0 && r[2] == 0;
        }
    }
    WallTrial& now = system.trial();
    if (!thought_of) add_rows(system);
    const std::size_t m = 3 * system.rows.size();
    now.force.assign(m, 0.0);
    for (const int w : system.wires)
        for (int i = 0; i < rods_.node_count(w); ++i) {
            const int node = rods_.node_begin(w) - system.first_node + i, row = system.row_of(node);
            if (row < 0) continue;
            const Vec3 own(&residuals_[w][RodDofs::position(i)]);
            const Vec3 force = -(system.back(node).transpose() * own);
            force.store(&now.force[3 * row]);
            if (!force.isZero()) system.compliance.want(row);
        }
    linearise(system, nullptr, now.linear);
    now.rho.resize(m);
    now.linear.times_w(now.force, now.rho);
    for (std::size_t k = 0; k < m; ++k) now.rho[k] += now.u[k] - system.u_free[k];
    return thought_of;
}

/// E, F and D from the last tangents of contact.
/// @param among  unknowns that are counted, and wires that are left out; null: all of them, counted over the system's nodes
void ElasticContact::linearise(System& system, const SystemUnknowns* among, Condensed& to) const
{
    to.reset(static_cast<int>(3 * system.rows.size()), system.compliance.entries());
    to.own_accuracy = system.h > 0 ? in_time : at_rest;
    for (const int w : system.wires) {
        if (among && among->rod_of(w) < 0) continue;
        const int n = rods_.node_count(w), first = rods_.node_begin(w) - system.first_node;
        const int unknowns = among ? among->map.first(among->rod_of(w)) : RodDofs::position(first);
        for (int i = 0; i < n; ++i) {
            const int row = system.row_of(first + i);
            if (row < 0) continue;
            std::array<NodeJoint, 3> joints;  // with the node before, itself, the node after
            bool any = false;
            for (int j = std::max(0, i - 1); j <= std::min(n - 1, i + 1); ++j) {
                NodeJoint& joint = joints[static_cast<std::size_t>(j - i + 1)];
                joint = joint_of(tangents_[w], i, j, j < n - 1, system.back(first + i), system.back(first + j));
                any = any || joint.any;
            }
            if (any) system.compliance.want(row);
            for (int c = 0; c < 3 && any; ++c) {
                to.begin_row(3 * row + c);
                for (int j = std::max(0, i - 1); j <= std::min(n - 1, i + 1); ++j)
                    joints[static_cast<std::size_t>(j - i + 1)].put(c, unknowns + RodDofs::position(j),
                                                                    3 * system.row_of(first + j), to);
            }
        }
    }
    system.compliance.provide();
    to.close();
}

// ---- residual and tangent ----

void ElasticContact::add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const
{
    const System& system = of(wire);
    const int n = rods_.node_count(wire), first = rods_.node_begin(wire) - system.first_node;
    std::span<double> own = std::span(residuals_[wire]).first(RodDofs::count(n));
    std::fill(own.begin(), own.end(), 0.0);
    if (tangent) tangents_[wire].reset(RodDofs::count(n));
    contact_.add(wire, own, tangent ? &tangents_[wire] : nullptr, symmetric);
    for (int i = 0; i < n; ++i) {
        const int at = RodDofs::position(i);
        add_to(&residual[at], system.back(first + i).transpose() * Vec3(&own[at]));
        residual[at + RodDofs::spin_place] += own[at + RodDofs::spin_place];
    }
    if (!tangent) return;
    const BandMatrix& t = tangents_[wire];
    for (int i = 0; i < n; ++i) {
        const Mat3 seen_i = system.back(first + i);
        const int a = RodDofs::position(i);
        for (int j = std::max(0, i - 1); j <= std::min(n - 1, i + 1); ++j) {
            const int b = RodDofs::position(j);
            Mat3 block = block_of(t, a, b);
            if (!block.isZero()) {
                block = seen_i.transpose() * block * system.back(first + j);
                for (int r = 0; r < 3; ++r)
                    for (int c = 0; c < 3; ++c) tangent->add(a + r, b + c, block(r, c));
            }
            const int spin = b + RodDofs::spin_place;
            const Vec3 column(t.at(a, spin), t.at(a + 1, spin), t.at(a + 2, spin));
            const Vec3 row(t.at(spin, a), t.at(spin, a + 1), t.at(spin, a + 2));
            const Vec3 to_column = seen_i.transpose() * column, to_row = seen_i.transpose() * row;
            for (int r = 0; r < 3; ++r) {
                if (to_column[r] != 0) tangent->add(a + r, spin, to_column[r]);
                if (to_row[r] != 0) tangent->add(spin, a + r, to_row[r]);
            }
        }
        tangent->add(a + RodDofs::spin_place, a + RodDofs::spin_place, t.at(a + RodDofs::spin_place, a + RodDofs::spin_place));
    }
}

void ElasticContact::couple(const SystemUnknowns& unknowns, std::span<double> residual, BandedSolver* tangent,
                            bool symmetric) const
{
    System& system = of(unknowns.wires.front());
    const WallTrial& now = system.trial();
    if (system.rows.empty()) return;
    std::vector<double>& z = system.scratch_m;
    z.resize(now.linear.row_count());
    now.linear.at_rows(now.rho, z);
    now.linear.solve_rows(z);
    for (std::size_t k = 0; k < z.size(); ++k) {
        // from nodes of the system to unknowns of those that are solved
        const int wire = system.wire_of_row[static_cast<std::size_t>(now.linear.place(k)) / 3];
        if (unknowns.rod_of(wire) < 0) continue;
        const int by = unknowns.map.first(unknowns.rod_of(wire)) - RodDofs::position(rods_.node_begin(wire) - system.first_node);
        for (const auto& [unknown, value] : now.linear.e_transposed.row(k)) residual[unknown + by] += value * z[k];
    }
    if (!tangent) return;
    // add() uses the result of the last evaluation, except for a symmetric tangent
    if (!symmetric && system.wires.size() == 1) tangent->condensed.take(now.linear, unknowns.map.first(0));
    else linearise(system, &unknowns, tangent->condensed);
}

TermAnswer ElasticContact::answer(int wire, Ask what)
{
    if (what == Ask::Kinks) return {};  // they are the unmoved wall's
    TermAnswer answer;
    if (!of(wire).stands) {
        answer.admissible = answer.acts = false;
        return answer;
    }
    answer = contact_.answer(wire, what);
    if (what == Ask::Energies) {
        answer.energies.from_outside = work_from_outside(wire);
    } else {
        const double open = open_way(of(wire), wire);
        answer.open = std::min(answer.open, open);
        answer.admissible = answer.admissible && open == 1;
    }
    return answer;
}

/// No wall is jumped while no node goes farther than the limit as the unmoved wall sees it. @return how much of the path is open
double ElasticContact::open_way(const System& system, int wire) const
{
    const double limit = traits_.most_move.empty() ? INFINITY : traits_.most_move[static_cast<std::size_t>(wire)];
    if (!std::isfinite(limit)) return 1;
    const std::vector<double>& from = system.base_trial() ? system.base_trial()->y : system.y_start;
    const std::vector<double>& to = system.trial().y;
    double most2 = 0;
    const int first = rods_.node_begin(wire) - system.first_node;
    for (int i = first; i < first + rods_.node_count(wire); ++i)
        most2 = std::max(most2, (Vec3(&to[3 * i]) - Vec3(&from[3 * i])).squaredNorm());
    const double share = limit / std::sqrt(most2);
    return share < 1 - 1e-6 ? share : 1;
}

void ElasticContact::take(int wire, Base base, std::span<double> /*kinks*/)
{
    contact_.take(wire, base, {});
    if (base == Base::Trial) of(wire).take();
    else of(wire).forget_base();
}

/// The wall's large displacements under contact's forces, in an equilibrium. @return whether it would go elsewhere
bool ElasticContact::relax(System& system) const
{
    if (system.h > 0) return false;
    list_pushes(system);
    system.relaxed = system.dynamics.relax(system.pushed) <= balanced_move * system.least_radius;
    if (system.relaxed || ++system.relaxations > most_relaxations) return false;
    WallTrial& now = system.trial();
    for (std::size_t k = 0; k < now.rho.size(); ++k) now.rho[k] += system.u_free[k];
    set_free(system);
    for (std::size_t k = 0; k < now.rho.size(); ++k) now.rho[k] -= system.u_free[k];
    return true;
}

bool ElasticContact::refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again)
{
    bool any = contact_.refine(solved, again);
    take_times(0);
    for (const auto& system : systems_) {
        const bool all =
            std::all_of(system->wires.begin(), system->wires.end(), [&](int w) { return solved[w] || !system->begun; });
        if (!all || !system->begun || system->refinements >= most_refinements) continue;
        if (system->misses(balanced_force, balanced_move) <= 1 && !relax(*system)) continue;
        if (!system->relaxations) ++system->refinements;
        system->take();
        for (const int w : system->wires)
            if (solved[w]) again[w] = 1, any = true;
    }
    return any;
}

}  // namespace seldinger

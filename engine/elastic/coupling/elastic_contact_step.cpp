// Contact with an elastic wall from step to step: feet, possible contacts, the wall's own step, saving.
#include "coupling/elastic_system.h"

#include "core/clock.h"
#include "core/state_walk.h"
#include "shell/shell.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double most_made_good = 0.02;  // radii in a step: what a wire's contact takes without notice; and of a merge
constexpr int most_renumbered = 8;       // places by which changes of nodes may have moved one
constexpr double may_touch = 2.5;        // radii of the axis from the wall: nearer nodes, and those beside them, move the wall

}  // namespace

void ElasticContact::System::correct()
{
    WallTrial& now = trial();
    scratch_m.assign(now.rho.begin(), now.rho.end());
    now.linear.guess_own(scratch_m);
    for (std::size_t k = 0; k < now.u.size(); ++k) now.u[k] -= scratch_m[k];
}

double ElasticContact::System::misses(double of_force, double of_radius) const
{
    const WallTrial& now = trial();
    double force = 0, most = 0, move = 0;
    missed.resize(2 * now.linear.row_count());
    const std::span<double> at_rows = std::span(missed).first(now.linear.row_count());
    const std::span<double> forces = std::span(missed).last(now.linear.row_count());
    now.linear.at_rows(now.rho, at_rows);
    now.linear.d.times(at_rows, forces);
    for (const double f : forces) force = std::max(force, std::abs(f));
    for (std::size_t k = 0; k < now.rho.size(); ++k) {
        most = std::max(most, std::abs(now.force[k]));
        move = std::max(move, std::abs(now.rho[k]));
    }
    const double by_move = move / (of_radius * least_radius);
    return most > 0 ? std::max(force / (of_force * most), by_move) : by_move;
}

// ---- start of a step ----

/// End state of the node that was at x; births and merges have renumbered it. Null: there was none.
const WallEnd* ElasticContact::System::end_of(int first, int count, int node, const Vec3& x) const
{
    const auto is = [&](int i) { return i >= 0 && i < count && Vec3(ends[first + i].x) == x; };
    for (int k = 0; k <= most_renumbered; ++k)
        for (const int i : {node - k, node + k})
            if (is(i)) return &ends[first + i];
    return nullptr;
}

void ElasticContact::System::find_before(int first, const RodView& rod)
{
    const int capacity = static_cast<int>(rod.x.size());
    thread_local std::vector<const WallEnd*> end;
    end.resize(static_cast<std::size_t>(rod.n));
    for (int i = 0; i < rod.n; ++i) end[i] = end_of(first, capacity, i, rod.pos(i));
    for (int i = 0; i < rod.n; ++i) {
        std::optional<Vec3>& y = before[first + i];
        y.reset();
        force_before[first + i] = end[i] ? Vec3(end[i]->force) : Vec3(Vec3::Zero());
        if (end[i]) {
            y = Vec3(end[i]->y);
        } else if (i > 0 && i + 1 < rod.n && end[i - 1] && end[i + 1]) {  // born between two, where y was linear
            const Vec3 xa(end[i - 1]->x), xb(end[i + 1]->x), ya(end[i - 1]->y), yb(end[i + 1]->y);
            const Vec3 x = rod.pos(i);
            const double t = std::clamp((x - xa).dot(xb - xa) / (xb - xa).squaredNorm(), 0.0, 1.0);
            y = x + (1 - t) * (ya - xa) + t * (yb - xb);
        }
    }
}

void ElasticContact::System::keep_carried(int node, const Vec3& x, double radius)
{
    WallStation& station = stations[node];
    station.shift.setZero();
    if (!station.near || !before[node]) return;
    const Vec3 missing = x - station.start - *before[node];
    // nothing feels it where the axis cannot touch
    const double size = missing.norm(), most = most_made_good * radius + std::max(0.0, station.distance - may_touch * radius);
    if (size > most) station.shift = (most / size - 1) * missing;
}

void ElasticContact::System::note_ends(int first, int count)
{
    const WallTrial& now = trial();
    for (int i = first; i < first + count; ++i) {
        std::copy_n(&now.q[4 * static_cast<std::size_t>(i)], 3, ends[i].x);
        std::copy_n(&now.y[3 * static_cast<std::size_t>(i)], 3, ends[i].y);
        const int row = row_of(i);
        (row >= 0 ? Vec3(&now.force[3 * static_cast<std::size_t>(row)]) : Vec3(Vec3::Zero())).store(ends[i].force);
    }
}

void ElasticContact::list_seen(RodArrays& rods, int wire, std::vector<Vec3>& places) const
{
    const System& system = of(wire);
    const ConstRodView rod = rods.view(wire);
    const int first = rods.node_begin(wire) - system.first_node, capacity = static_cast<int>(rod.x.size());
    places.clear();
    Vec3 moved = Vec3::Zero();  // of the node before
    for (int i = 0; i < rod.n; ++i) {
        const WallEnd* end = system.end_of(first, capacity, i, rod.pos(i));
        const Vec3 own = end ? Vec3(Vec3(end->x) - Vec3(end->y)) : moved;
        const double radius = rod.radius[std::min(i, rod.n - 2)];
        const auto see = [&](const Vec3& x, const Vec3& by) {
            places.push_back(system.stations.seen_at(x, x - by, system.dynamics, radius));
        };
        if (i > 0) see((rod.pos(i - 1) + rod.pos(i)) / 2, (moved + own) / 2);
        see(rod.pos(i), own);
        moved = own;
    }
}

void ElasticContact::mark_bowed(RodArrays& rods, int wire, std::span<std::uint8_t> bowed) const
{
    const System& system = of(wire);
    const RodView rod = rods.view(wire);
    const auto moved = [&](int i) -> Vec3 {
        const WallEnd& end = system.ends[rods.node_begin(wire) - system.first_node + i];
        const Vec3 x(end.x), y(end.y);
        return x == rod.pos(i) ? Vec3(x - y) : Vec3::Zero();
    };
    for (int i = 1; i + 1 < rod.n; ++i) {
        const double t = rod.rest_length[i - 1] / (rod.rest_length[i - 1] + rod.rest_length[i]);
        const Vec3 bow = moved(i) - (1 - t) * moved(i - 1) - t * moved(i + 1);
        if (bow.norm() > most_made_good * rod.radius[i]) bowed[i] = 1;
    }
}

void ElasticContact::carry_back(RodArrays& rods, int wire)
{
    System& system = of(wire);
    const int first = rods.node_begin(wire) - system.first_node;
    system.stations.forget(first, first + rods.capacity(wire));
    place_and_copy(rods, wire);
}

/// Feet are found where they are not known.
void ElasticContact::place_and_copy(RodArrays& rods, int wire)
{
    System& system = of(wire);
    const int first = rods.node_begin(wire) - system.first_node, n = rods.node_count(wire);
    unmoved_.set_node_count(wire, n);
    const auto from = rods.arrays(wire);
    auto to = unmoved_.arrays(wire);
    for (std::size_t k = 0; k < from.size(); ++k) std::copy(from[k].begin(), from[k].end(), to[k].begin());
    const RodView rod = rods.view(wire), carried = unmoved_.view(wire);
    system.find_before(first, rod);
    for (int i = 0; i < n; ++i) {
        const std::optional<Vec3>& before = system.before[first + i];
        const double radius = rod.radius[std::min(i, n - 2)];
        system.stations.place(first + i, rod.pos(i), before ? &*before : nullptr, system.dynamics, radius);
        system.keep_carried(first + i, rod.pos(i), radius);
        const WallStation& station = system.stations[first + i];
        if (station.near) carried.set_pos(i, rod.pos(i) - station.start + station.shift);
        carried.pos(i).store(&system.y_start[3 * static_cast<std::size_t>(first + i)]);
    }
    system.stations.forget(first + n, first + rods.capacity(wire));
}

void ElasticContact::begin_step(RodArrays& rods, Settling how)
{
    const auto start = Clock::now();
    for_each_system([&](System& system) {
        for (const int w : system.wires) carry_back(rods, w);
        system.begun = false;
    });
    take_times(seconds_since(start));
    contact_.begin_step(unmoved_, how);
}

void ElasticContact::prepare(RodArrays& rods, std::span<const std::uint8_t> live)
{
    const auto start = Clock::now();
    for_each_system([&](System& system) {
        for (const int w : system.wires)
            if (live[w]) place_and_copy(rods, w);
        system.begun = false;
    });
    const double seconds = seconds_since(start);
    contact_.prepare(unmoved_, live);
    take_times(seconds);
}

/// Starts the step of a system that has not begun it. @return whether its wall stands; else its wires have nothing to do
bool ElasticContact::begun(System& system, double h)
{
    if (!system.begun) start_step(system, h);
    if (!system.stands)
        for (const int w : system.wires) todo_[w] = 0;
    return system.stands;
}

/// The wall's free motion in a step of h, and its compliance where it may be touched. Fewer rows, of nodes that touch alone, make
/// more evaluations where many contacts come and go.
void ElasticContact::start_step(System& system, double h) const
{
    system.begun = true;
    system.h = h;
    system.refinements = system.relaxations = 0;
    system.relaxed = true;
    system.forget_base();
    system.stands = system.dynamics.begin_step(h);
    if (!system.stands) return;
    system.rows.clear();
    for (int i = 0; i < system.stations.count(); ++i) system.stations[i].row = -1;
    for (const int w : system.wires) {
        const int first = rods_.node_begin(w) - system.first_node, n = rods_.node_count(w);
        const double reach = may_touch * rods_.view(w).radius[0];
        const auto close = [&](int i) {
            const WallStation& station = system.stations[first + i];
            return station.near && (h == 0 || station.distance < reach);
        };
        for (int i = 0; i < n; ++i)
            if (system.stations[first + i].near && (close(i) || (i > 0 && close(i - 1)) || (i + 1 < n && close(i + 1))))
                system.stations[first + i].row = 0;
    }
    list_rows(system);
}

/// Rows of the stations that are marked, and their compliance.
void ElasticContact::list_rows(System& system) const
{
    system.rows.clear();
    system.wire_of_row.clear();
    for (const int w : system.wires) {
        const int first = rods_.node_begin(w) - system.first_node;
        for (int i = first; i < first + rods_.node_count(w); ++i) {
            WallStation& station = system.stations[i];
            if (!station.near || station.row < 0) continue;
            station.row = static_cast<int>(system.rows.size());
            system.rows.push_back(i);
            system.wire_of_row.push_back(w);
        }
    }
    system.compliance.reset(system.stations, system.rows, system.dynamics.patch());
    set_free(system);
}

/// Where the wall would be at the rows if nothing touched it.
void ElasticContact::set_free(System& system) const
{
    system.u_free.clear();
    for (const int row : system.rows) {
        const LoopStencil& s = system.stations[row].weights;
        Vec3 u = Vec3::Zero();
        for (int a = 0; a < s.size; ++a) u += s.n[a] * system.dynamics.free(s.vertex[a]);
        system.u_free.insert(system.u_free.end(), u.data(), u.data() + 3);
    }
}

/// Nodes on which contact has just been found to act join those that move the wall; it stays where it is under them for now.
void ElasticContact::add_rows(System& system) const
{
    const std::vector<int> before = system.rows;
    const std::vector<double> u = system.trial().u;
    for (const int w : system.wires)
        for (int i = 0; i < rods_.node_count(w); ++i) {
            WallStation& station = system.stations[rods_.node_begin(w) - system.first_node + i];
            const double* r = &residuals_[w][RodDofs::position(i)];
            if (station.near && station.row < 0 && (r[0] != 0 || r[1] != 0 || r[2] != 0)) station.row = 0;
        }
    list_rows(system);
    std::vector<double>& now = system.trial().u;
    now.resize(3 * system.rows.size());
    for (std::size_t k = 0; k < system.rows.size(); ++k) system.stations[system.rows[k]].start.store(&now[3 * k]);
    for (std::size_t k = 0; k < before.size(); ++k)
        std::copy_n(&u[3 * k], 3, &now[3 * static_cast<std::size_t>(system.row_of(before[k]))]);
    system.forget_base();
}

// ---- the accepted state ----

void ElasticContact::keep_feet()
{
    for (const auto& system : systems_)
        system->feet_before.assign(system->stations.feet().begin(), system->stations.feet().end());
}

void ElasticContact::put_feet_back()
{
    for (const auto& system : systems_)
        std::copy(system->feet_before.begin(), system->feet_before.end(), system->stations.feet().begin());
}

bool ElasticContact::begins_block(double h) const
{
    return std::any_of(systems_.begin(), systems_.end(), [&](const auto& system) { return system->dynamics.begins_block(h); });
}

void ElasticContact::System::walk_wall(StateWalk& walk)
{
    dynamics.walk_state(walk);
    if (walk.reads()) exerted.clear(), work_at_rest.clear();
    if (dynamics.still()) return;
    const StateRow row{"a force on the wall", "N", "accept"};
    walk.list<std::int32_t>(row, exerted);
    if (!walk.checks()) return;
    const auto count = static_cast<std::int32_t>(wires.size()), vertices = static_cast<std::int32_t>(moves.size() / 3);
    for (const WallDynamics::Push& push : exerted)
        StateWalk::need(
            push.wire >= 0 && push.wire < count && push.vertex >= 0 && push.vertex < vertices && push.force.norm() <= row.most,
            row.name);
}

double ElasticContact::work_from_outside(int wire) const
{
    const System& system = of(wire);
    if (system.h == 0 && !system.work_at_rest.empty())
        return system.work_at_rest[static_cast<std::size_t>(wire - system.wires.front())];
    if (!system.begun) return 0;
    const WallTrial& now = system.trial();
    double sum = 0;
    for (std::size_t k = 0; k < system.rows.size(); ++k) {
        if (system.wire_of_row[k] != wire) continue;
        const Vec3 move = Vec3(&now.u[3 * k]) - system.stations[system.rows[k]].start;
        sum += Vec3(&now.force[3 * k]).dot(move);
    }
    return sum;
}

void ElasticContact::take_unwatched(double h, std::span<const std::uint8_t> done)
{
    for_each_system([&](System& system) {
        if (system.begun || !system.is_in(done)) return;
        if (system.dynamics.still() && wall_.load().empty()) return;
        system.stands = system.dynamics.begin_step(h);
        if (!system.stands) return;
        system.rows.clear();
        system.dynamics.end_step({});
        system.exerted_before.swap(system.exerted);
        system.exerted.clear();
        read_under(system);
    });
}

/// The wall takes what the wires exert on it.
void ElasticContact::commit(std::span<const std::uint8_t> active)
{
    contact_.commit(active);
    const auto start = Clock::now();
    for_each_system([&](System& system) {
        if (!system.begun || !system.is_in(active)) return;
        system.begun = false;
        const WallTrial& now = system.trial();
        std::vector<double>& given = system.scratch_m;
        given.resize(now.force.size());
        now.linear.times_w(now.force, given);
        list_pushes(system);
        std::swap(system.exerted, system.exerted_before);
        system.exerted = system.pushed;
        double farthest = 0;
        for (std::size_t k = 0; k < system.rows.size(); ++k) {
            const Vec3 f = -Vec3(&now.force[3 * k]);
            farthest = std::max(farthest, Vec3(&now.u[3 * k]).norm());
            if (f.isZero() || system.h == 0) continue;
            const WallStation& station = system.stations[system.rows[k]];
            const Vec3 end = Vec3(&system.u_free[3 * k]) - Vec3(&given[3 * k]);
            system.dynamics.work += f.dot(end - station.start);
        }
        if (system.h == 0) end_equilibrium(system, farthest);
        else system.dynamics.end_step(system.pushed, farthest);
        read_under(system);
        for (const int w : system.wires) system.note_ends(rods_.node_begin(w) - system.first_node, rods_.node_count(w));
    });
    take_times(seconds_since(start));
}

/// The work on the way to an equilibrium takes means of the forces at both ends: from another equilibrium, what linear theory
/// stores, exactly.
void ElasticContact::end_equilibrium(System& system, double farthest) const
{
    std::vector<WallDynamics::Push> both = system.exerted_before;
    both.insert(both.end(), system.exerted.begin(), system.exerted.end());
    std::vector<Vec3> start;
    for (const WallDynamics::Push& push : both) start.push_back(system.dynamics.now(push.vertex));
    system.dynamics.end_step(system.pushed, farthest);
    system.work_at_rest.assign(system.wires.size(), 0.0);
    for (std::size_t k = 0; k < both.size(); ++k) {
        const double work = 0.5 * both[k].force.dot(system.dynamics.now(both[k].vertex) - start[k]);
        system.dynamics.work += work;
        system.work_at_rest[static_cast<std::size_t>(both[k].wire)] -= work;
    }
}

/// What the wires exert on the wall's control vertices.
void ElasticContact::list_pushes(System& system) const
{
    system.pushed.clear();
    for (std::size_t k = 0; k < system.rows.size(); ++k) {
        const Vec3 f = -Vec3(&system.trial().force[3 * k]);
        if (f.isZero()) continue;
        const LoopStencil& s = system.stations[system.rows[k]].weights;
        const int wire = system.wire_of_row[k] - system.wires.front();
        for (int a = 0; a < s.size; ++a) system.pushed.push_back({wire, s.vertex[a], s.n[a] * f});
    }
}

void ElasticContact::read_under(System& system) const
{
    constexpr double heavy = 0.5;  // of the largest force on a node
    WallReadings& now = system.under;
    now = {};
    const auto force_on = [&](std::size_t row) { return Vec3(&system.trial().force[3 * row]); };
    double largest = 0;
    for (std::size_t k = 0; k < system.rows.size(); ++k) largest = std::max(largest, force_on(k).norm());
    const auto unmoved = [&](const LoopStencil& at) {
        Vec3 place = Vec3::Zero();
        for (int a = 0; a < at.size; ++a)
            place += at.n[a] * wall_.surface().control().vertices[static_cast<std::size_t>(at.vertex[a])];
        return place;
    };
    LoopStencil stencil;
    const auto look = [&](std::int32_t triangle, double u, double v, const LostPeak& lost) {
        wall_.surface().basis(triangle, u, v, stencil);
        Vec3 move = Vec3::Zero();
        for (int a = 0; a < stencil.size; ++a) {
            const Vec3 w = system.dynamics.now(stencil.vertex[a]);
            w.store(&system.moves[3 * static_cast<std::size_t>(stencil.vertex[a])]);
            move += stencil.n[a] * w;
        }
        if (move.norm() > now.move_max) {
            now.move_max = move.norm();
            unmoved(stencil).store(now.move_at);
            now.move_band.mesh = now.move_max * wall_.band_of(triangle).move;
        }
        std::size_t point = 0;
        const double stress = wall_.shell().stress_of(triangle, system.moves, point, system.dynamics.large());
        if (!(stress + lost.stress > now.stress_max)) return;
        now.stress_max = stress + lost.stress;
        wall_.shell().points()[point].position.store(now.stress_at);
        now.stress_band.mesh = lost.band;
    };
    for (std::size_t k = 0; k < system.rows.size() && largest > 0; ++k) {
        if (force_on(k).norm() < heavy * largest) continue;
        const WallFoot& foot = system.stations.foot(system.rows[k]);
        if (foot.triangle < 0) continue;
        const auto triangle = static_cast<std::int32_t>(foot.triangle);
        look(triangle, foot.u, foot.v, wall_.lost_peak(triangle, line_load(system, k, triangle)));
    }
    for (const LoopFoot& foot : wall_.loaded()) look(foot.triangle, foot.u, foot.v, {});
    if (now.move_max == 0) return;
    if (!system.dynamics.large()) add_geometry(wall_, now.move_max, now);
}

/// Load per length of wire beside a row [N/m]. A node's force is on its own length of wire, at most a decay length. The mean is
/// over that length, half a control edge or a thickness, whichever is longest: nearer to a load the wall is no thin plate
/// (LostPeak).
double ElasticContact::line_load(const System& system, std::size_t row, std::int32_t triangle) const
{
    const int wire = system.wire_of_row[row], first = rods_.node_begin(wire) - system.first_node;
    const ConstRodView rod = rods_.view(wire);
    const auto bears_on = [&](int node) { return std::min(wall_.decay(), rod.voronoi_length(node)); };
    const int node = system.rows[row] - first;
    const double length =
        std::max({bears_on(node), 0.5 * std::min(wall_.decay(), wall_.edge_of(triangle)), wall_.shell().spec().thickness});
    Vec3 load = Vec3::Zero();
    for (std::size_t k = 0; k < system.rows.size(); ++k) {
        if (system.wire_of_row[k] != wire) continue;
        const int other = system.rows[k] - first;
        const double own = bears_on(other), apart = std::abs(rod.material_s[other] - rod.material_s[node]);
        const double common = std::clamp(0.5 * (length + own) - apart, 0.0, std::min(length, own));
        load += common / own * Vec3(&system.trial().force[3 * k]);
    }
    return load.norm() / length;
}

WallReadings ElasticContact::readings(int system, std::span<const double> displacement, std::vector<double>* stress) const
{
    WallReadings all = read_wall(wall_, displacement, work(system), stress);
    const WallReadings& here = under(system);
    if (here.stress_max > all.stress_max) {
        all.stress_max = here.stress_max, all.stress_band = here.stress_band;
        std::copy_n(here.stress_at, 3, all.stress_at);
    }
    return all;
}

WallReadings ElasticContact::under(int system) const { return systems_[system]->under; }

std::vector<double> ElasticContact::displacement(int system) const { return systems_[system]->dynamics.displacement(); }

double ElasticContact::work(int system) const { return systems_[system]->dynamics.work; }

bool ElasticContact::stands(int system) const { return systems_[system]->stands; }

double ElasticContact::move_share(int system) const
{
    double most = 0;
    const System& s = *systems_[system];
    if (!s.relaxed || s.dynamics.is_limited()) return INFINITY;
    for (std::size_t k = 0; 3 * k < s.trial().u.size() && k < s.rows.size(); ++k)
        most = std::max(most,
                        Vec3(&s.trial().u[3 * k]).norm() / wall_.largest_move(s.stations[s.rows[k]].weights));
    return most;
}

void ElasticContact::add_nodal_forces(int wire, std::span<Vec3> forces) const
{
    const System& system = of(wire);
    std::vector<Vec3> own(forces.size(), Vec3::Zero());
    contact_.add_nodal_forces(wire, own);
    const int first = rods_.node_begin(wire) - system.first_node;
    for (std::size_t i = 0; i < own.size(); ++i) forces[i] += system.back(first + static_cast<int>(i)).transpose() * own[i];
}

std::vector<ContactRow> ElasticContact::rows(RodArrays& rods)
{
    // reading leaves no trace: the last bits of a foot depend on the start of its search
    const auto copy = [&](bool back) {
        for (const auto& system : systems_)
            for (const int w : system->wires) {
                const int first = rods.node_begin(w) - system->first_node, last = first + rods.node_count(w);
                if (back) system->stations.copy(system->kept, first, last);
                else system->kept.copy(system->stations, first, last);
            }
    };
    copy(false);
    for (int w = 0; w < rods.wire_count(); ++w) carry_back(rods, w);
    std::vector<ContactRow> list = contact_.rows(unmoved_);
    for (ContactRow& row : list) {
        const System& system = of(row.a.body);
        const int edge = rods.node_begin(row.a.body) - system.first_node + row.a.element;
        // between the two nodes, where the point is nearest
        const Vec3 a = unmoved_.view(row.a.body).pos(row.a.element), b = unmoved_.view(row.a.body).pos(row.a.element + 1);
        const double t = std::clamp((row.point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        const auto moved = [&](int node) {
            return system.stations[node].near ? system.stations[node].start : Vec3(Vec3::Zero());
        };
        row.point += (1 - t) * moved(edge) + t * moved(edge + 1);
    }
    copy(true);
    return list;
}

bool ElasticContact::is_clear(RodArrays& rods, int wire)
{
    carry_back(rods, wire);
    return contact_.is_clear(unmoved_, wire);
}

void ElasticContact::walk_state(StateWalk& walk, int wire)
{
    System& system = of(wire);
    contact_.walk_state(walk, wire);
    if (system.wires.front() == wire) system.walk_wall(walk);
    const int first = rods_.node_begin(wire) - system.first_node, n = rods_.node_count(wire);
    if (walk.reads()) {
        system.begun = false;
        system.under = {};
        for (int i = first; i < first + rods_.capacity(wire); ++i) system.stations.foot(i) = {}, system.ends[i] = {};
    }
    const double triangles = static_cast<double>(wall_.surface().topology().triangle_count());
    for (int i = first; i < first + n; ++i) {
        WallFoot& foot = system.stations.foot(i);
        constexpr double unknown = 1e30;  // WallFoot, WallEnd
        walk({"a place on the wall", "m", "find_contacts", -unknown, unknown}, std::span(foot.node));
        walk({"a place on the wall", "", "find_contacts", 0}, foot.u);
        walk({"a place on the wall", "", "find_contacts", 0}, foot.v);
        if (walk.checks()) StateWalk::need(foot.u + foot.v <= 1 + 1e-9, "a place on the wall");
        walk({"a triangle of the wall", "", "find_contacts", -1, triangles - 1}, foot.triangle);
        walk({"a node's place", "m", "accept", -unknown, unknown}, std::span(system.ends[i].x));
        walk({"a node's place", "m", "accept", -unknown, unknown}, std::span(system.ends[i].y));
        walk({"a force on a node", "N", "accept"}, std::span(system.ends[i].force));
    }
}

}  // namespace seldinger

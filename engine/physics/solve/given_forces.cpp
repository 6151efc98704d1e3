// Forces that the program gives: what they see, what they answer, and how that acts on nodes and spins.
#include "solve/given_forces.h"

#include "core/error.h"
#include "core/state_walk.h"
#include "rod/transport.h"
#include "solve/constraints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace seldinger {
namespace {

constexpr double move = 1e-7, turn = 1e-6;  // of differences [m], [rad]
constexpr double symmetric_to = 1e-6;       // of the largest entry, as differences are

double end_share(const IntegratorSpec& spec)
{
    if (spec.scheme == Scheme::Explicit) return 0;
    return spec.newmark || spec.conserve || spec.scheme == Scheme::Static ? 0.5 : 1;
}

void refuse(const Force& force, double s, const char* what)
{
    throw Error(ErrorKind::BadScene,
                fmt::format("force \"{}\": got a {} that is not finite, {:g} m from the tip; expected finite "
                            "numbers at every trial",
                            force.name, what, s));
}

double component(const PointForce& of, int i) { return i < 3 ? of.force[i] : of.moment[i - 3]; }

}  // namespace

/// A state of a wire to look at: a trial, or the accepted one.
struct GivenForces::Motion {
    RodView rod;
    const TrialState* at = nullptr;  // null: the accepted one, with its velocities
    const TrialState* before = nullptr;
    int begin = 0;
    double h = 0;

    static Vec3 in(const TrialState& state, int i) { return {state.x[i], state.y[i], state.z[i]}; }
    [[nodiscard]] Vec3 x(int i) const { return at ? in(*at, begin + i) : rod.pos(i); }
    [[nodiscard]] Vec3 v(int i) const
    {
        if (!at) return rod.vel(i);
        return h > 0 ? (x(i) - (before ? in(*before, begin + i) : rod.pos(i))) / h : Vec3::Zero();
    }
    [[nodiscard]] double theta(int j) const { return at ? at->theta[begin + j] : rod.theta[j]; }
    [[nodiscard]] double spin(int j) const
    {
        if (!at) return rod.spin_rate[j];
        return h > 0 ? (theta(j) - (before ? before->theta[begin + j] : rod.theta[j])) / h : 0.0;
    }
};

GivenForces::GivenForces(RodArrays& rods, const IntegratorSpec& spec) : rods_(rods), end_share_(end_share(spec))
{
    traits_.may_jump = false;
}

void GivenForces::add(int wire, std::shared_ptr<const Force> force, const CoaxialGroup* group, int member)
{
    Given& given = list_.emplace_back();
    given.wire = wire;
    given.member = member;
    given.group = group;
    given.state = force->state;
    given.force = std::move(force);
}

void GivenForces::set_time(int wire, double time, double dt)
{
    for (Given& given : list_)
        if (given.wire == wire) given.time = time, given.dt = dt;
}

// ---- start of a step ----------------------------------------------------------------------------------------------------------

void GivenForces::place(Given& given) const
{
    const RodView line = rods_.view(given.group ? given.group->line() : given.wire);
    const double offset = given.group ? given.group->rod.instrument[static_cast<std::size_t>(given.member)].offset : 0;
    given.places.clear();
    Seen& seen = given.seen;
    seen.s.clear();
    seen.length.clear();
    const auto put = [&](int edge, double bary, double s, double length) {
        if (s < 0) return;  // beyond the tip of an instrument that is not the line's farthest
        given.places.push_back({edge, bary});
        seen.s.push_back(s);
        seen.length.push_back(length);
    };
    if (given.force->on == Force::On::Nodes)
        for (int i = 0; i < line.n; ++i)
            put(std::min(i, line.n - 2), i == line.n - 1, line.material_s[i] + offset, line.voronoi_length(i));
    else if (given.force->on == Force::On::Edges)
        for (int j = 0; j + 1 < line.n; ++j)
            put(j, 0.5, 0.5 * (line.material_s[j] + line.material_s[j + 1]) + offset, line.rest_length[j]);
    else
        for (const double s : given.force->places) {
            WireHolds::Place at = WireHolds::locate({WirePoint::Kind::Distance, s}, line, offset);
            if (!at.inside) continue;
            if (const int edge = given.group ? coaxial_edge_of(given.group->rod, line, s - offset, at.edge) : at.edge;
                edge != at.edge)
                at = {edge, (s - offset - line.material_s[edge]) / line.rest_length[edge], true};
            put(at.edge, at.bary, s, 0);
        }
    for (Place& at : given.places) at.before = unknowns_of(given, at);
    const std::size_t count = given.places.size();
    seen.wire.assign(count, given.wire);
    for (auto* list : {&seen.position, &seen.velocity, &seen.axis, &seen.director, &seen.turning, &seen.span, &seen.from})
        list->assign(count, Vec3::Zero());
    given.on.assign(count, {});
    given.tangents.assign(count, {});
}

GivenForces::Vector GivenForces::unknowns_of(const Given& given, const Place& place) const
{
    const RodView rod = rods_.view(given.wire);
    const Vec3 a = rod.pos(place.edge), b = rod.pos(place.edge + 1);
    return {a[0], a[1], a[2], b[0], b[1], b[2], rod.theta[place.edge]};
}

/// Nothing more is asked once something has been thrown.
void GivenForces::catch_all(const std::function<void()>& body)
{
    if (raised_) return;
    try {
        body();
    } catch (...) {
        raised_ = std::current_exception();
    }
}

void GivenForces::raise()
{
    if (raised_) std::rethrow_exception(std::exchange(raised_, nullptr));
}

void GivenForces::prepare(RodArrays& /*rods*/, std::span<const std::uint8_t> live)
{
    for (Given& given : list_) {
        given.places.clear();
        if (!live[static_cast<std::size_t>(given.wire)]) continue;
        place(given);
        if (given.places.empty() || (given.force->each_trial && end_share_ == 1)) continue;
        look(given, {rods_.view(given.wire)});
        put_in_call(given, false);
    }
    ask_call(false);
    for (Given& given : list_)
        for (std::size_t k = 0; k < given.places.size() && (!given.force->each_trial || end_share_ < 1); ++k)
            given.places[k].start = act(given, k, nullptr);
}

// ---- what a force sees and says -----------------------------------------------------------------------------------------------

void GivenForces::look(Given& given, const Motion& motion) const
{
    for (std::size_t k = 0; k < given.places.size(); ++k) {
        const auto [j, b] = std::pair(given.places[k].edge, given.places[k].bary);
        const Vec3 span = motion.x(j + 1) - motion.x(j), apart = motion.v(j + 1) - motion.v(j);
        const Vec3 t = span.normalized(), from = motion.rod.tangent(j);
        given.seen.span[k] = span;
        given.seen.from[k] = from;
        given.seen.position[k] = (1 - b) * motion.x(j) + b * motion.x(j + 1);
        given.seen.velocity[k] = (1 - b) * motion.v(j) + b * motion.v(j + 1);
        given.seen.axis[k] = -t;
        given.seen.director[k] = turned(carried_director(motion.rod.ref_d1(j), from, t), t, motion.theta(j));
        given.seen.turning[k] = t.cross(apart) / span.norm() + motion.spin(j) * t;
    }
}

ForcePoints GivenForces::points(const Given& given)
{
    const Seen& seen = given.seen;
    return {given.time,    given.dt,  seen.wire,     seen.s,       seen.length, seen.position,
            seen.velocity, seen.axis, seen.director, seen.turning, given.state};
}

void GivenForces::put_in_call(Given& given, bool tangents)
{
    if (!call_.empty() && (!given.force->together || given.force != call_.back()->force || given.time != call_.back()->time ||
                            given.dt != call_.back()->dt))
        ask_call(tangents);
    call_.push_back(&given);
}

void GivenForces::ask_call(bool tangents)
{
    if (call_.empty()) return;
    Given& asked = call_.size() > 1 ? whole_ : *call_.front();
    // f(list of the whole, list of a part) for all that a force sees
    const auto for_each = [](Seen& whole, Seen& part, const auto& f) {
        f(whole.wire, part.wire), f(whole.s, part.s), f(whole.length, part.length), f(whole.position, part.position);
        f(whole.velocity, part.velocity), f(whole.axis, part.axis), f(whole.director, part.director);
        f(whole.turning, part.turning);
    };
    if (call_.size() > 1) {
        const Given& first = *call_.front();
        asked.force = first.force, asked.time = first.time, asked.dt = first.dt, asked.linearised = first.linearised;
        for_each(asked.seen, asked.seen, [](auto& list, auto&) { list.clear(); });
        for (Given* part : call_)
            for_each(asked.seen, part->seen, [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); });
    }
    catch_all([&] {
        ask(asked, asked.on);
        if (tangents) ask_tangents(asked);
    });
    std::size_t from = 0;
    for (std::size_t k = 0; k < call_.size() && call_.size() > 1 && !raised_; from += call_[k++]->seen.s.size()) {
        const auto count = call_[k]->seen.s.size();
        std::copy_n(asked.on.begin() + from, count, call_[k]->on.begin());
        if (tangents) std::copy_n(asked.tangents.begin() + from, count, call_[k]->tangents.begin());
    }
    call_.clear();
}

void GivenForces::ask(const Given& given, std::vector<PointForce>& out)
{
    out.assign(given.seen.s.size(), {});
    given.force->forces(points(given), out);
    for (std::size_t k = 0; k < out.size(); ++k)
        if (!out[k].force.allFinite() || !out[k].moment.allFinite())
            refuse(*given.force, given.seen.s[k], out[k].force.allFinite() ? "moment" : "force");
}

void GivenForces::ask_tangents(Given& given)
{
    given.tangents.assign(given.seen.s.size(), {});
    if (!given.force->tangents(points(given), given.tangents)) return differences(given);
    for (std::size_t k = 0; k < given.tangents.size(); ++k)
        for (const PointMatrix* matrix : {&given.tangents[k].stiffness, &given.tangents[k].damping})
            for (const auto& row : *matrix)
                for (const double value : row)
                    if (!std::isfinite(value)) refuse(*given.force, given.seen.s[k], "tangent");
}

// A move takes its velocity along, so that the stiffness is K + C/h; in a linearised step, which needs C, each by itself.
void GivenForces::differences(Given& given)
{
    const Seen kept = given.seen;
    const double rate = given.dt > 0 && !given.linearised ? 1 / given.dt : 0;
    for (int c = 0; c < (given.linearised ? 12 : 6); ++c) {
        const double size = c % 6 < 3 ? move : turn, still = c < 6 ? size : 0, fast = c < 6 ? size * rate : size;
        for (std::size_t k = 0; k < kept.s.size(); ++k) {
            const Vec3 unit = Vec3::Unit(c % 3);
            if (c % 6 < 3) {
                given.seen.position[k] += still * unit;
                given.seen.velocity[k] += fast * unit;
            } else {
                given.seen.axis[k] += still * unit.cross(kept.axis[k]);
                given.seen.director[k] += still * unit.cross(kept.director[k]);
                given.seen.turning[k] += fast * unit;
            }
        }
        ask(given, given.near);
        given.seen = kept;
        for (std::size_t k = 0; k < kept.s.size(); ++k)
            for (int i = 0; i < 6; ++i)
                (c < 6 ? given.tangents[k].stiffness : given.tangents[k].damping)[i][c % 6] =
                    (component(given.near[k], i) - component(given.on[k], i)) / size;
    }
}

// ---- on nodes and spins -------------------------------------------------------------------------------------------------------

GivenForces::Vector GivenForces::act(const Given& given, std::size_t k, std::array<Vector, unknowns>* tangent)
{
    const Place& at = given.places[k];
    const Vec3 t = -given.seen.axis[k];
    const double inverse = 1 / given.seen.span[k].norm(), b = at.bary;
    PointForce on = given.on[k];
    std::array<Vector, 6> g{};  // G
    const Vec3& from = given.seen.from[k];
    const double chi = one_plus_cos(from, t);
    const Mat3 turning = inverse * Mat3(skew(t) - outer((1 / chi) * t, from.cross(t)));
    for (int i = 0; i < 3; ++i) {
        g[i][i] = 1 - b;
        g[i][3 + i] = b;
        g[3 + i][6] = t[i];
        for (int c = 0; c < 3; ++c) g[3 + i][c] = -turning(i, c), g[3 + i][3 + c] = turning(i, c);
    }
    const PointTangent& own = given.tangents[k];
    if (given.linearised)
        for (int i = 0; i < 6; ++i)
            for (int c = 0; c < 6; ++c)
                (i < 3 ? on.force[i] : on.moment[i - 3]) -=
                    own.damping[i][c] * (c < 3 ? given.seen.velocity[k][c] : given.seen.turning[k][c - 3]);
    Vector q{};
    for (int u = 0; u < unknowns; ++u)
        for (int i = 0; i < 6; ++i) q[u] += g[i][u] * component(on, i);
    if (!tangent) return q;
    *tangent = {};
    const double rate = given.dt > 0 ? 1 / given.dt : 0;
    for (int i = 0; i < 6; ++i) {
        Vector row{};
        for (int c = 0; c < 6; ++c) {
            const double slope = own.stiffness[i][c] + rate * own.damping[i][c];
            for (int u = 0; slope != 0 && u < unknowns; ++u) row[u] += slope * g[c][u];
        }
        for (int u = 0; u < unknowns; ++u)
            for (int w = 0; w < unknowns; ++w) (*tangent)[u][w] += g[i][u] * row[w];
    }
    const Vec3& m = on.moment;
    const Mat3 couple = (inverse * inverse) * Mat3(skew(m) * (Mat3::Identity() - outer(2 * t, t)) -
                                                   (m.dot(t) / chi) * Mat3(skew(from) * (Mat3::Identity() - outer(t, t))));
    const Vec3 spin = inverse * (m - m.dot(t) * t);
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < 3; ++i)
            for (const int end : {0, 3}) {
                (*tangent)[end + i][c] += end == 0 ? couple(i, c) : -couple(i, c);
                (*tangent)[end + i][3 + c] += end == 0 ? -couple(i, c) : couple(i, c);
            }
        (*tangent)[6][c] -= spin[c];
        (*tangent)[6][3 + c] += spin[c];
    }
    return q;
}

void GivenForces::evaluate(const TermTrial& trial)
{
    const auto acts = [&](const Given& given) {
        return trial.active[static_cast<std::size_t>(given.wire)] && !given.places.empty();
    };
    for (Given& given : list_) {
        if (raised_ || !acts(given)) continue;
        given.dt = trial.h;
        given.linearised = trial.linearised;
        look(given, {rods_.view(given.wire), &trial.at, trial.before, rods_.node_begin(given.wire), trial.h});
        if (given.force->each_trial) put_in_call(given, true);
    }
    ask_call(true);
    for (Given& given : list_)
        if (!raised_ && acts(given)) finish(given);
}

void GivenForces::finish(Given& given) const
{
    double largest = 0, apart = 0;
    for (std::size_t k = 0; k < given.places.size(); ++k) {
        Place& at = given.places[k];
        at.now = act(given, k, &at.tangent);
        for (int u = 0; u < unknowns; ++u)
            for (int w = 0; w < unknowns; ++w) {
                largest = std::max(largest, std::abs(at.tangent[u][w]));
                apart = std::max(apart, std::abs(at.tangent[u][w] - at.tangent[w][u]));
            }
    }
    given.unsymmetric = apart > symmetric_to * largest;
}

TermAnswer GivenForces::answer(int wire, Ask what)
{
    TermAnswer answer;
    answer.acts = false;
    for (const Given& given : list_) {
        if (given.wire != wire || given.places.empty()) continue;
        answer.acts = true;
        answer.unsymmetric = answer.unsymmetric || given.unsymmetric;
        if (what != Ask::Energies) continue;
        for (std::size_t k = 0; k < given.places.size(); ++k) {
            const Place& at = given.places[k];
            const Vector q = unknowns_of(given, at);
            for (int u = 0; u < unknowns; ++u) {
                double now = at.now[u];
                for (int w = 0; given.linearised && w < unknowns; ++w) now += at.tangent[u][w] * (q[w] - at.before[w]);
                answer.energies.given += (end_share_ * now + (1 - end_share_) * at.start[u]) * (q[u] - at.before[u]);
            }
            answer.energies.given_force += given.on[k].force;
        }
    }
    return answer;
}

void GivenForces::add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const
{
    for (const Given& given : list_) {
        if (given.wire != wire) continue;
        if (raised_) residual[0] = NAN;  // no trial stands
        for (const Place& at : given.places) {
            const auto unknown = [&](int u) {
                return u < 6 ? RodDofs::position(at.edge + u / 3, u % 3) : RodDofs::spin(at.edge);
            };
            for (int u = 0; u < unknowns; ++u) {
                residual[unknown(u)] -= at.now[u];
                for (int w = 0; tangent && w < unknowns; ++w)
                    tangent->add(unknown(u), unknown(w),
                                 symmetric ? -0.5 * (at.tangent[u][w] + at.tangent[w][u]) : -at.tangent[u][w]);
            }
        }
    }
}

// ---- the accepted state -------------------------------------------------------------------------------------------------------

void GivenForces::conclude(std::span<const std::uint8_t> active)
{
    for (Given& given : list_) {
        given.next_state = given.state;
        given.next_energy = 0;
        if (!active[static_cast<std::size_t>(given.wire)] || given.places.empty()) continue;
        look(given, {rods_.view(given.wire)});
        catch_all([&] {
            given.next_energy = given.force->energy(points(given));
            given.force->accept(points(given), given.next_state);
            if (!std::ranges::all_of(given.next_state, [](double value) { return std::isfinite(value); }))
                refuse(*given.force, given.seen.s.front(), "state");
        });
    }
}

void GivenForces::commit(std::span<const std::uint8_t> active)
{
    for (Given& given : list_) {
        if (!active[static_cast<std::size_t>(given.wire)]) continue;
        given.energy = given.next_energy;
        given.state.swap(given.next_state);
    }
}

void GivenForces::walk_state(StateWalk& walk, int wire)
{
    for (Given& given : list_)
        if (given.wire == wire && !given.state.empty()) walk({"a force's state", "", "accept"}, std::span(given.state));
}

void GivenForces::read_sensors(int wire, const SensorReader& read) const
{
    for (const Given& given : list_)
        if (const Force& force = *given.force; given.wire == wire && !force.record.empty())
            read(force, std::span(given.state).first(force.record.size()));
}

double GivenForces::along(int wire) const
{
    double sum = 0;
    for (const Given& given : list_)
        for (std::size_t k = 0; given.wire == wire && k < given.places.size(); ++k)
            sum += given.on[k].force.dot(given.seen.axis[k]);
    return sum;
}

double GivenForces::energy(int wire) const
{
    double sum = 0;
    for (const Given& given : list_)
        if (given.wire == wire) sum += given.energy;
    return sum;
}

}  // namespace seldinger

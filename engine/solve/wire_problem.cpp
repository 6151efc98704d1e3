#include "solve/wire_problem.h"

#include "core/prefetch.h"
#include "rod/discrete_gradient.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double most_bending_force = 10;  // of the scale of forces, see set_scales [N]

Vec3 node_of(std::span<const double> q, int i) { return {q[4 * i], q[4 * i + 1], q[4 * i + 2]}; }

void add_to_node(std::span<double> q, int i, const Vec3& value)
{
    for (int c = 0; c < 3; ++c) q[4 * i + c] += value[c];
}

}  // namespace

WireProblem::WireProblem(int capacity, const IntegratorSpec& spec)
    : frames(capacity),
      matrix(4 * capacity),
      start_frames_(spec.conserve ? capacity : 0),
      contact_tangent_(4 * capacity),
      damping_(spec.damping_stiffness > 0 ? 4 * capacity : 0)
{
    for (auto* array : {&start, &trial, &residual, &inertia, &prescribed_value, &velocity_base_, &acceleration_base_,
                        &start_velocity_, &external_})
        array->resize(4 * capacity);
    prescribed.resize(4 * capacity);
    for (auto* array : {&tension_, &base_tension_, &base_longer_, &turned_}) array->resize(capacity);
    base_tangent_.resize(capacity);
    base_direction_.resize(capacity);
    kept_reference_.resize(reference_count * capacity);
}

void WireProblem::begin(const RodView& view, const WireConstraints& constraints, const IntegratorSpec& spec, const Vec3& gravity,
                        Motion kind, double step, SpinAngles spins)
{
    rod = view;
    constraints_ = &constraints;
    clamps.assign(constraints.clamps.begin(), constraints.clamps.end());
    motion = kind;
    conserving_ = spec.conserve && kind == Motion::Implicit;
    end_share_ = conserving_ ? 0.5 : 1;
    base_excess_ = 0;
    h = step;
    const int n = rod.n;
    for (int i = 0; i < n; ++i) {
        const double theta = i < n - 1 ? rod.theta[i] : 0.0;
        const double q[4] = {rod.x[i], rod.y[i], rod.z[i], theta};
        const double v[4] = {rod.vx[i], rod.vy[i], rod.vz[i], i < n - 1 ? rod.spin_rate[i] : 0.0};
        const double m[4] = {rod.mass[i], rod.mass[i], rod.mass[i], i < n - 1 ? rod.spin_inertia[i] : 0.0};
        std::copy_n(q, 4, &start[4 * i]);
        std::copy_n(v, 4, &start_velocity_[4 * i]);
        std::copy_n(m, 4, &inertia[4 * i]);
    }
    std::copy_n(start.begin(), 4 * n, trial.begin());
    std::fill_n(prescribed.begin(), 4 * n, 0);
    for (const auto& [unknown, value] : constraints.prescribed) {
        SEL_ASSERT(unknown >= 0 && unknown < 4 * n - 1);
        prescribed[unknown] = 1;
        prescribed_value[unknown] = value;
    }
    prescribed[4 * n - 1] = 1;  // no edge begins at the last node
    prescribed_value[4 * n - 1] = start[4 * n - 1];
    const bool linearised = spec.scheme == Scheme::Linearised && kind == Motion::Implicit;
    for (int j = 0; j < n - 1; ++j)
        tension_[j] = linearised ? tension_before(j)
                                 : rod.stretch_stiffness[j] * ((rod.pos(j + 1) - rod.pos(j)).norm() / rod.rest_length[j] - 1);
    set_kinematics(spec);
    set_external(gravity);
    set_scales(spec, gravity);
    frames.spins = start_frames_.spins = !(kind == Motion::Implicit && may_leave(spins));
    frames.material = conserving_ || !straight_by_nature(rod);
    matrix.set_fourth(frames.spins);
    for (int j = 0; j < n - 1 && !frames.spins; ++j) {
        prescribed[4 * j + 3] = 1;
        prescribed_value[4 * j + 3] = start[4 * j + 3];
    }
    start_usable_ = !conserving_ || update_frames(rod, trial_view(), clamps, start_frames_);
    set_damping(spec);
}

/// Tension of an edge as the equations of the last step had it, which is what one Newton step takes against turning (the geometric
/// stiffness of stretching). The state at the start of the step has it changed twice: by what was fed since, EA h v/l, which pushes
/// with tens of newtons until this step has moved the wire on; and by EA phi^2/2 where the edge turned by phi, which no linear
/// equation has seen and which is gone one step later. As stiffness, the first buckles the base edge and the second holds the wire.
double WireProblem::tension_before(int j) const
{
    const Vec3 now = rod.pos(j + 1) - rod.pos(j);
    Vec3 move;
    for (int c = 0; c < 3; ++c) move[c] = known_move(4 * (j + 1) + c) - known_move(4 * j + c);
    const double length = now.dot((now - move).normalized());
    const double fed_in = j == rod.n - 2 ? constraints_->base_grown : 0.0;
    return rod.stretch_stiffness[j] * (length / (rod.rest_length[j] - fed_in) - 1);
}

void WireProblem::set_kinematics(const IntegratorSpec& spec)
{
    const int size = 4 * rod.n;
    velocity_rate_ = acceleration_rate_ = damping_rate_ = 0;
    euler_ = motion == Motion::Implicit && !conserving_ && !spec.newmark;
    if (euler_) {
        damping_rate_ = velocity_rate_ = 1 / h;
        acceleration_rate_ = 1 / (h * h);
        return;
    }
    std::fill_n(velocity_base_.begin(), size, 0.0);
    std::fill_n(acceleration_base_.begin(), size, 0.0);
    if (motion == Motion::Explicit) std::copy_n(start_velocity_.begin(), size, velocity_base_.begin());
    if (motion != Motion::Implicit) return;
    damping_rate_ = 1 / h;
    if (conserving_) {  // v+ = 2 (q - q_0)/h - v_0, a+ = (v+ - v_0)/h
        velocity_rate_ = 2 / h;
        acceleration_rate_ = 2 / (h * h);
        for (int i = 0; i < size; ++i) {
            velocity_base_[i] = -start_velocity_[i];
            acceleration_base_[i] = -2 * start_velocity_[i] / h;
        }
        return;
    }
    // D4 solved for a+ and v+
    acceleration_rate_ = 1 / (spec.beta * h * h);
    velocity_rate_ = spec.gamma * h * acceleration_rate_;
    damping_rate_ = velocity_rate_;
    for (int i = 0; i < rod.n; ++i) {
        const double a[4] = {rod.ax[i], rod.ay[i], rod.az[i], i < rod.n - 1 ? rod.spin_acc[i] : 0.0};
        for (int c = 0; c < 4; ++c) {
            const double v = start_velocity_[4 * i + c];
            const double base = -(h * v + h * h * (0.5 - spec.beta) * a[c]) * acceleration_rate_;
            acceleration_base_[4 * i + c] = base;
            velocity_base_[4 * i + c] = v + h * ((1 - spec.gamma) * a[c] + spec.gamma * base);
        }
    }
}

// Weight and dead forces; moments follow the edge and are added at each evaluation.
void WireProblem::set_external(const Vec3& gravity)
{
    std::fill_n(external_.begin(), 4 * rod.n, 0.0);
    for (int i = 0; i < rod.n; ++i) add_to_node(external_, i, rod.mass[i] * gravity);
    for (const auto& load : constraints_->loads) {
        add_to_node(external_, load.edge, (1 - load.bary) * load.force);
        add_to_node(external_, load.edge + 1, load.bary * load.force);
    }
}

// What the residual is measured against: the largest of total weight, loads (moments over the wire's length), stretched
// springs, and B/L^2, the force that bends the wire to its own length, up to 10 N: a short stiff piece in the guide (0.01 N m^2,
// 1 cm: 100 N) would else have residuals that show in the hand's force. The floor is what rounding of positions far from the
// origin does to the stretching and inertia forces.
void WireProblem::set_scales(const IntegratorSpec& spec, const Vec3& gravity)
{
    const int n = rod.n;
    double length = 0, mass = 0, bend = 0, twist = 0, reach = 0, stiffness = 0, spin = 0;
    for (int j = 0; j < n - 1; ++j) {
        length += rod.rest_length[j];
        stiffness = std::max(stiffness, rod.stretch_stiffness[j] / rod.rest_length[j]);
        twist = std::max(twist, rod.twist_stiffness[j] / rod.rest_length[j] * std::abs(rod.theta[j]));
        spin = std::max(spin, inertia[4 * j + 3] * std::abs(rod.theta[j]));
    }
    double heaviest = 0;
    for (int i = 0; i < n; ++i) {
        mass += rod.mass[i];
        heaviest = std::max(heaviest, rod.mass[i]);
        bend = std::max(bend, rod.bend_stiffness[i]);
        reach = std::max({reach, std::abs(rod.x[i]), std::abs(rod.y[i]), std::abs(rod.z[i])});
    }
    length_scale = length / (n - 1);
    force_scale = std::max(mass * gravity.norm(), std::min(bend / (length * length), most_bending_force));
    double loads = 0, springs = 0;
    for (const auto& load : constraints_->loads) loads += load.force.norm() + load.moment.norm() / length;
    for (const auto& spring : constraints_->springs) {
        const Vec3 at = (1 - spring.bary) * rod.pos(spring.edge) + spring.bary * rod.pos(spring.edge + 1);
        springs += spring.stiffness * (at - spring.anchor).norm();
    }
    force_scale = std::max({force_scale, loads, springs});
    const double force_noise = (stiffness + heaviest * acceleration_rate_) * reach;
    const double moment_noise = (twist + spin * acceleration_rate_) / length_scale;
    tolerance = spec.tolerance * force_scale + 8 * epsilon * std::max(force_noise, moment_noise);
}

void WireProblem::set_damping(const IntegratorSpec& spec)
{
    damping_mass_ = motion == Motion::Static ? 0 : spec.damping_mass;
    damping_stiffness_ = motion == Motion::Static ? 0 : spec.damping_stiffness;
    if (damping_stiffness_ == 0) return;
    damping_.reset(size());
    if (!update()) return;  // a broken start is found out by the first evaluation
    add_elastic(rod, clamps, frames, {}, &damping_, HessianMode::Safe);
}

std::span<double> WireProblem::work_in(Workspace& workspace, bool once)
{
    const bool lasting = motion == Motion::Static;
    matrix.use_rows(lasting ? nullptr : &workspace.matrix);
    matrix.use_factor(lasting || !once ? nullptr : &workspace.matrix);
    contact_tangent_.use_rows(lasting ? nullptr : &workspace.contact_tangent);
    std::span<double> left = workspace.numbers;
    const std::size_t size = start.size();
    for (auto* part : {&scratch_, &damped_velocity_, &split_, &contact_gradient_}) {
        *part = left.first(size);
        left = left.subspan(size);
    }
    return left.first(size);
}

void WireProblem::prefetch(SolveStage next) const
{
    const int n = rod.n;
    const auto unknowns = [&](auto&... arrays) { (seldinger::prefetch(arrays, 4 * n), ...); };
    const auto nodes = [&](const auto&... arrays) { (seldinger::prefetch(arrays.data(), n * sizeof(double)), ...); };
    const auto vectors = [&](const auto&... arrays) {
        for (int c = 0; c < 3; ++c) (seldinger::prefetch(arrays.component(c), n * sizeof(double)), ...);
    };
    unknowns(start, trial);
    nodes(frames.ref_twist, rod.tx, rod.ty, rod.tz, rod.d1x, rod.d1y, rod.d1z, rod.ref_twist);
    vectors(frames.tangent, frames.d1);
    if (next != SolveStage::Commit) {
        unknowns(inertia, external_);
        nodes(frames.edge_length, frames.chi, frames.twist, tension_, rod.rest_length, rod.stretch_stiffness, rod.bend_stiffness,
              rod.twist_stiffness, rod.rest_kappa1, rod.rest_kappa2, rod.rest_twist);
        vectors(frames.kb);
    }
    if (next == SolveStage::Advance) unknowns(residual);
    else nodes(rod.x, rod.y, rod.z, rod.theta, rod.vx, rod.vy, rod.vz, rod.spin_rate);
    if (next == SolveStage::Begin) nodes(rod.mass, rod.spin_inertia, rod.radius);
    if (next != SolveStage::Commit || !euler_) unknowns(start_velocity_);
    if (!euler_) unknowns(velocity_base_, acceleration_base_);
}

RodTrial WireProblem::trial_view() const
{
    const std::size_t n = rod.n;
    double* s = split_.data();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t c = 0; c < 4; ++c) s[c * n + i] = trial[4 * i + c];
    return {{s, n}, {s + n, n}, {s + 2 * n, n}, {s + 3 * n, n}};
}

// A discrete gradient is the mean force along the way from q_0 to q, of use only where that is not far: a frame or a joint that
// turns by more in one step than this is refused, as is a fold.
constexpr double most_turned = 2.0;  // [rad]

bool WireProblem::update()
{
    if (!start_usable_ || !update_frames(rod, trial_view(), clamps, frames)) return false;
    if (!conserving_) return true;
    for (int j = 0; j < rod.n - 1; ++j) {
        turned_[j] = trial[4 * j + 3] - start[4 * j + 3];
        if (!(std::abs(turned_[j]) < most_turned && std::abs(frames.twist[j] - start_frames_.twist[j]) < most_turned))
            return false;
    }
    return true;
}

/// Of material through a prescribed unknown that stands still: the hub's of a fed wire.
double WireProblem::flow(int i) const
{
    return is_hub(i) ? constraints_->hub_flow[i - 4 * (rod.n - 1)] : 0.0;
}

double WireProblem::velocity(int i) const
{
    if (motion == Motion::Implicit && prescribed[i]) return (trial[i] - start[i]) / h + flow(i);
    return velocity_rate_ * (trial[i] - start[i]) + velocity_base(i);
}

/// Over the step when conserving, at its end otherwise.
double WireProblem::mean_velocity(int i) const { return conserving_ ? (trial[i] - start[i]) / h : velocity(i); }

bool WireProblem::unsymmetric() const
{
    if (conserving_) return true;
    for (const auto& load : constraints_->loads)
        if (!load.moment.isZero()) return true;
    return false;
}

double WireProblem::acceleration(int i) const
{
    if (motion == Motion::Implicit && prescribed[i]) return (velocity(i) - start_velocity_[i]) / h;
    return acceleration_rate_ * (trial[i] - start[i]) + acceleration_base(i);
}

// velocity() and acceleration() of all unknowns, in loops that vectorise; there are few prescribed ones.
void WireProblem::velocities(double* out) const
{
    const int size = 4 * rod.n;
    const double *q = trial.data(), *q0 = start.data(), *base = velocity_base_.data(), rate = velocity_rate_;
    if (euler_)
        for (int i = 0; i < size; ++i) out[i] = rate * (q[i] - q0[i]) + 0.0;
    else
        for (int i = 0; i < size; ++i) out[i] = rate * (q[i] - q0[i]) + base[i];
    for (int i = 0; i < size; ++i)
        if (prescribed[i]) out[i] = velocity(i);
}

void WireProblem::accelerations(double* out) const
{
    const int size = 4 * rod.n;
    const double *q = trial.data(), *q0 = start.data(), *v0 = start_velocity_.data(), *base = acceleration_base_.data();
    const double rate = acceleration_rate_, step = h;
    if (euler_)
        for (int i = 0; i < size; ++i) out[i] = rate * (q[i] - q0[i]) + -v0[i] / step;
    else
        for (int i = 0; i < size; ++i) out[i] = rate * (q[i] - q0[i]) + base[i];
    for (int i = 0; i < size; ++i)
        if (prescribed[i]) out[i] = acceleration(i);
}

bool WireProblem::evaluate_residual(const ForceTerms& terms, int wire)
{
    const std::size_t size = 4 * rod.n;
    evaluate_host_residual();
    if (!terms.empty()) {
        std::fill_n(contact_gradient_.begin(), size, 0.0);
        terms.add(wire, {contact_gradient_.data(), size}, nullptr, true);
        for (std::size_t i = 0; i < size; ++i) residual[i] += contact_gradient_[i];
    }
    return finish_residual();
}

bool WireProblem::evaluate_linear_contact(const ForceTerms& terms, std::span<const double> base)
{
    const int size = 4 * rod.n;
    evaluate_host_residual();
    if (!terms.empty()) {
        for (int i = 0; i < size; ++i) damped_velocity_[i] = trial[i] - base[i];
        contact_tangent_.multiply(damped_velocity_, scratch_);
        for (int i = 0; i < size; ++i) residual[i] += contact_gradient_[i] + scratch_[i];
    }
    return finish_residual();
}

/// All of R but contact.
void WireProblem::evaluate_host_residual()
{
    const int size = 4 * rod.n;
    const std::span<double> r(residual.data(), size);
    accelerations(r.data());
    if (damping_mass_ > 0)
        for (int i = 0; i < size; ++i) r[i] += damping_mass_ * mean_velocity(i);
    for (int i = 0; i < size; ++i) r[i] = inertia[i] * r[i] - external_[i];
    if (damping_stiffness_ > 0) {
        for (int i = 0; i < size; ++i) damped_velocity_[i] = damping_stiffness_ * mean_velocity(i);
        damping_.multiply(damped_velocity_, scratch_);
        for (int i = 0; i < size; ++i) r[i] += scratch_[i];
    }
    if (conserving_) add_discrete_gradient(rod, clamps, start_frames_, frames, turned_, r, constraints_->base_grown);
    else add_elastic(rod, clamps, frames, r, nullptr, HessianMode::None);
    add_loads();
}

/// @return false if not finite
bool WireProblem::finish_residual()
{
    residual[4 * rod.n - 1] = 0;  // the last node begins no edge
    double sum = 0;
    for (int i = 0; i < 4 * rod.n; ++i) sum += std::abs(residual[i]);
    return std::isfinite(sum);
}

Vec3 WireProblem::spring_pull(const WireConstraints::Spring& spring) const
{
    Vec3 at = (1 - spring.bary) * node_of(trial, spring.edge) + spring.bary * node_of(trial, spring.edge + 1);
    if (conserving_)
        at = 0.5 * (at + (1 - spring.bary) * node_of(start, spring.edge) + spring.bary * node_of(start, spring.edge + 1));
    return spring.stiffness * (spring.anchor - at);
}

Vec3 WireProblem::load_force() const
{
    Vec3 sum = Vec3::Zero();
    for (const auto& load : constraints_->loads) sum += load.force;
    for (const auto& spring : constraints_->springs) sum += spring_pull(spring);
    if (damping_mass_ > 0)
        for (int i = 0; i < 4 * rod.n; ++i)
            if (i % 4 < 3) sum[i % 4] -= damping_mass_ * inertia[i] * mean_velocity(i);
    return sum;
}

// Springs, and dead moments. A moment m turns the edge that it acts on: a couple of forces +-(m x t)/|e| on its ends does the
// work of m on the edge's rotation, and m.t that on its spin.
void WireProblem::add_loads()
{
    const std::span<double> r(residual.data(), 4 * rod.n);
    for (const auto& spring : constraints_->springs) {
        const Vec3 pull = spring_pull(spring);
        add_to_node(r, spring.edge, -(1 - spring.bary) * pull);
        add_to_node(r, spring.edge + 1, -spring.bary * pull);
    }
    for (const auto& load : constraints_->loads) {
        if (load.moment.isZero()) continue;
        const Vec3& t = frames.tangent[load.edge];
        const Vec3 couple = load.moment.cross(t) / frames.edge_length[load.edge];
        add_to_node(r, load.edge + 1, -couple);
        add_to_node(r, load.edge, couple);
        r[4 * load.edge + 3] -= load.moment.dot(t);
    }
}

void WireProblem::add_springs_to(BandMatrix& target) const
{
    for (const auto& spring : constraints_->springs) {
        const double weight[2] = {1 - spring.bary, spring.bary};
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b)
                for (int c = 0; c < 3; ++c)
                    target.add(4 * (spring.edge + a) + c, 4 * (spring.edge + b) + c,
                               end_share_ * spring.stiffness * weight[a] * weight[b]);
    }
}

namespace {

using Mat3 = Eigen::Matrix3d;

/// A stiffness between the ends of edge j: K (dx_{j+1} - dx_j) is the force on node j + 1, and its opposite that on node j.
void add_edge_block(BandMatrix& matrix, int j, const Mat3& k)
{
    constexpr int centre = BandMatrix::half_bandwidth;
    for (int c = 0; c < 3; ++c) {
        double* tip = matrix.row(4 * j + c) + centre - c;  // entries of node j, then of node j + 1
        double* hub = matrix.row(4 * (j + 1) + c) + centre - c - 4;
        for (int d = 0; d < 3; ++d) {
            tip[d] += k(c, d);
            hub[4 + d] += k(c, d);
            tip[4 + d] -= k(c, d);
            hub[d] -= k(c, d);
        }
    }
}

}  // namespace

// d(m x t/|e|)/de = [m]x (1 - 2 t t^T)/|e|^2,  d(m.t)/de = (m - (m.t) t)/|e|.
void WireProblem::add_moments_to(BandMatrix& target, bool symmetric) const
{
    for (const auto& load : constraints_->loads) {
        if (load.moment.isZero()) continue;
        const int j = load.edge;
        const double length = frames.edge_length[j];
        const Vec3 &t = frames.tangent[j], &m = load.moment;
        Mat3 couple;
        couple << 0, -m.z(), m.y(), m.z(), 0, -m.x(), -m.y(), m.x(), 0;
        couple = couple * (Mat3::Identity() - 2 * t * t.transpose()) / (length * length);
        const Vec3 spin = (m - m.dot(t) * t) / length;
        add_edge_block(target, j, symmetric ? Mat3(-0.5 * (couple + couple.transpose())) : Mat3(-couple));
        for (int c = 0; c < 3; ++c)
            for (int end : {0, 1}) {
                const double value = (end == 1 ? -spin[c] : spin[c]) * (symmetric ? 0.5 : 1.0);
                target.add(4 * j + 3, 4 * (j + end) + c, value);
                if (symmetric) target.add(4 * (j + end) + c, 4 * j + 3, value);
            }
    }
}

// The stretching Hessian is EA/l t t^T + N/|e| (I - t t^T), N = EA (|e|/l - 1), and max(N, 0) when safe. Puts the
// predicted tension in place of N. Conserving, the force is N b with N = EA (m/l - 1), m the mean length and b the mean
// direction: half of EA/l b t^T + N/m (I - b t^T) in place of half the Hessian.
void WireProblem::replace_tension(HessianMode mode, bool symmetric)
{
    const double least = mode == HessianMode::Safe ? 0.0 : -std::numeric_limits<double>::infinity();
    for (int j = 0; j < rod.n - 1; ++j) {
        const Vec3& t = frames.tangent[j];
        const double tension = std::max(tension_[j], least);
        if (!conserving_) {
            const double change = (tension - std::max(actual_tension(j), least)) / frames.edge_length[j];
            add_edge_block(matrix, j, change * (Mat3::Identity() - t * t.transpose()));
            continue;
        }
        const double axial = rod.stretch_stiffness[j] / rod.rest_length[j], sideways = tension / stretched_length(j);
        const double strained = rod.stretch_stiffness[j] * (frames.edge_length[j] / rod.rest_length[j] - 1);
        const double there = std::max(strained, least) / frames.edge_length[j];
        Mat3 mean = tension_direction(j) * t.transpose();
        if (symmetric) mean = 0.5 * (mean + mean.transpose().eval());
        add_edge_block(
            matrix, j,
            0.5 * ((axial - sideways) * mean - (axial - there) * t * t.transpose() + (sideways - there) * Mat3::Identity()));
    }
}

void WireProblem::assemble_tangent(HessianMode mode, bool symmetric, const ForceTerms& terms, int wire)
{
    const int size = 4 * rod.n;
    matrix.reset(size);
    const std::span<double> unused(scratch_.data(), size);
    add_elastic(rod, clamps, frames, {}, &matrix, mode);
    if (conserving_) matrix.scale(end_share_);
    replace_tension(mode, symmetric);
    const double rate = acceleration_rate_ + damping_mass_ * damping_rate_;
    for (int i = 0; i < size; ++i) matrix.add(i, i, rate * inertia[i]);
    add_springs_to(matrix);
    add_moments_to(matrix, symmetric);
    if (!terms.empty()) {
        contact_tangent_.reset(size);
        terms.add(wire, unused, &contact_tangent_, symmetric);
        matrix.add_scaled(contact_tangent_, 1);
    }
    if (damping_stiffness_ > 0) matrix.add_scaled(damping_, damping_stiffness_ * damping_rate_);
}

double WireProblem::residual_norm() const
{
    double largest = 0;
    for (int i = 0; i < 4 * rod.n; ++i) {
        if (prescribed[i]) continue;
        largest = std::max(largest, i % 4 == 3 ? std::abs(residual[i]) / length_scale : std::abs(residual[i]));
    }
    return largest;
}

double WireProblem::norm(std::span<const double> d) const
{
    double squares = 0;
    for (int i = 0; i < 4 * rod.n; ++i) {
        const double value = i % 4 == 3 ? d[i] * length_scale : d[i];
        squares += value * value;
    }
    return std::sqrt(squares);
}

double WireProblem::largest_move(std::span<const double> d) const
{
    double largest = 0;
    for (int i = 0; i < rod.n; ++i) largest = std::max(largest, node_of(d, i).squaredNorm());
    return std::sqrt(largest);
}

double WireProblem::largest_turn(std::span<const double> d) const
{
    double largest = 0;
    for (int j = 0; j < rod.n - 1; ++j)
        largest = std::max(largest, (node_of(d, j + 1) - node_of(d, j)).norm() / rod.rest_length[j]);
    return largest;
}

/// At the trial; conserving, the mean over the step, as of the next two.
double WireProblem::stretched_length(int j) const
{
    return conserving_ ? 0.5 * (start_frames_.edge_length[j] + frames.edge_length[j]) : frames.edge_length[j];
}

/// The same over the rest length is the strain, also of an edge whose rest length has grown over the step.
double WireProblem::strained_length(int j) const
{
    return conserving_ ? stretched_length(j) + feed_stretch(rod, start_frames_, j, constraints_->base_grown)
                       : stretched_length(j);
}

double WireProblem::actual_tension(int j) const
{
    return rod.stretch_stiffness[j] * (strained_length(j) / rod.rest_length[j] - 1);
}

Vec3 WireProblem::tension_direction(int j) const
{
    return conserving_ ? mean_direction(start_frames_, frames, j) : frames.tangent[j];
}

void WireProblem::set_base()
{
    for (int j = 0; j < rod.n - 1; ++j) {
        base_tension_[j] = tension_[j];
        base_tangent_[j] = frames.tangent[j];
        base_direction_[j] = tension_direction(j);
        base_longer_[j] = strained_length(j) - rod.rest_length[j];
    }
}

void WireProblem::predict_tension(std::span<const double> d, double alpha)
{
    for (int j = 0; j < rod.n - 1; ++j) {
        const double longer = base_longer_[j] + end_share_ * base_tangent_[j].dot(node_of(d, j + 1) - node_of(d, j));
        tension_[j] = (1 - alpha) * base_tension_[j] + alpha * rod.stretch_stiffness[j] / rod.rest_length[j] * longer;
    }
}

void WireProblem::correct_tension(std::span<const double> correction)
{
    for (int j = 0; j < rod.n - 1; ++j) {
        const double more = end_share_ * base_tangent_[j].dot(node_of(correction, j + 1) - node_of(correction, j));
        tension_[j] = actual_tension(j) + rod.stretch_stiffness[j] / rod.rest_length[j] * more;
    }
}

void WireProblem::mixed_residual(std::span<double> out) const
{
    std::copy_n(residual.begin(), 4 * rod.n, out.begin());
    for (int j = 0; j < rod.n - 1; ++j) {
        const Vec3 excess = (actual_tension(j) - tension_[j]) * (tension_direction(j) - base_direction_[j]);
        add_to_node(out, j, excess);
        add_to_node(out, j + 1, -excess);
    }
}

void WireProblem::take_linear_tensions()
{
    const auto excess = [&](int j) { return actual_tension(j) - tension_[j]; };
    for (int j = 0; j < rod.n - 1; ++j) {
        add_to_node(residual, j, excess(j) * frames.tangent[j]);
        add_to_node(residual, j + 1, -excess(j) * frames.tangent[j]);
    }
    base_excess_ = excess(rod.n - 2);
}

void WireProblem::write_velocity(int i, const double* v)
{
    rod.set_vel(i, {v[0], v[1], v[2]});
    if (i < rod.n - 1) rod.spin_rate[i] = v[3];
}

void WireProblem::write_acceleration(int i, const double* a)
{
    rod.ax[i] = a[0];
    rod.ay[i] = a[1];
    rod.az[i] = a[2];
    if (i < rod.n - 1) rod.spin_acc[i] = a[3];
}

// A trial is described relative to the accepted tangents, from which no edge may turn by pi. A static solve that turns
// farther moves that reference along; positions stay those of the start, which contact measures from.
bool WireProblem::far_from_reference() const
{
    for (int j = 0; j < rod.n - 1; ++j)
        if (frames.tangent[j].dot(rod.tangent(j)) < 0.5) return true;
    return false;
}

void WireProblem::move_reference()
{
    accept_frames(rod, trial_view(), frames);
    restore_positions();
}

void WireProblem::restore_positions()
{
    for (int i = 0; i < rod.n; ++i) {
        rod.set_pos(i, node_of(start, i));
        rod.theta[i] = start[4 * i + 3];
    }
}

void WireProblem::keep_reference()
{
    for (std::size_t k = 0; k < reference_arrays().size(); ++k)
        std::copy_n(reference_arrays()[k].begin(), rod.n, kept_reference_.begin() + k * rod.n);
}

void WireProblem::restore_reference()
{
    for (std::size_t k = 0; k < reference_arrays().size(); ++k)
        std::copy_n(kept_reference_.begin() + k * rod.n, rod.n, reference_arrays()[k].begin());
    restore_positions();
}

std::array<std::span<double>, WireProblem::reference_count> WireProblem::reference_arrays() const
{
    return {rod.tx, rod.ty, rod.tz, rod.d1x, rod.d1y, rod.d1z, rod.ref_twist, rod.clamp_twist_a, rod.clamp_twist_b};
}

void WireProblem::commit(bool newmark)
{
    const int size = 4 * rod.n;
    double *v = scratch_.data(), *a = damped_velocity_.data();
    if (motion == Motion::Implicit) {
        velocities(v);
        if (newmark) accelerations(a);
    } else {
        std::fill_n(v, size, 0.0);
        std::fill_n(a, size, 0.0);
    }
    for (int i = 0; i < rod.n; ++i) {
        write_velocity(i, v + 4 * i);
        if (newmark) write_acceleration(i, a + 4 * i);
    }
    accept_frames(rod, trial_view(), frames);
}

void WireProblem::move_prescribed(int i)
{
    trial[i] = prescribed_value[i];
    residual[i] += inertia[i] * ((trial[i] - start[i]) / h + flow(i) - start_velocity_[i]) / h;
}

void WireProblem::commit_explicit()
{
    for (int i = 0; i < rod.n; ++i) {
        double v[4];
        for (int c = 0; c < 4; ++c) v[c] = (trial[4 * i + c] - start[4 * i + c]) / h + flow(4 * i + c);
        write_velocity(i, v);
    }
    accept_frames(rod, trial_view(), frames);
}

void WireProblem::set_acceleration_from_residual()
{
    for (int i = 0; i < rod.n; ++i) {
        double a[4];
        for (int c = 0; c < 4; ++c) {
            const int k = 4 * i + c;
            a[c] = prescribed[k] || inertia[k] == 0 ? 0.0 : -residual[k] / inertia[k];
        }
        write_acceleration(i, a);
    }
}

}  // namespace seldinger

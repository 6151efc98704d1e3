// Corotational Euler-Bernoulli beams: frame and stiffness of an element, assembly, one or several Newton iterations of a step.
#include "baselines/corotational_beam.h"

#include "math/eigen.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace seldinger::baselines {
namespace {

constexpr double tolerance = 1e-6;  // of the load

Mat3 rotation(const Vec3& vector)
{
    const double angle = vector.norm();
    return angle < 1e-300 ? Mat3::Identity() : to_mat3(Eigen::AngleAxisd(angle, eigen(vector) / angle).toRotationMatrix());
}

Vec3 rotation_vector(const Mat3& r)
{
    const Eigen::AngleAxisd turn(Eigen::Matrix3d{eigen(r)});
    return to_vec3(turn.angle() * turn.axis());
}

/// The element's frame: half-way between its ends' frames, tilted by the least rotation so that its first axis is the chord.
Mat3 element_frame(const Mat3& a, const Mat3& b, const Vec3& chord)
{
    const Mat3 between = a * rotation(rotation_vector(a.transpose() * b) / 2);
    return to_mat3(Eigen::Quaterniond::FromTwoVectors(eigen(between.col(0)), eigen(chord)).toRotationMatrix()) * between;
}

}  // namespace

CorotationalBeam::CorotationalBeam(const Cantilever& wire, int iterations) : wire_(wire), iterations_(iterations)
{
    Mat3 frame;
    frame.col(0) = -wire.direction;
    frame.col(1) = wire.direction.unitOrthogonal();
    frame.col(2) = frame.col(0).cross(frame.col(1));
    for (int i = 0; i < wire.nodes; ++i) position_.push_back(wire.base + (wire.nodes - 1 - i) * wire.edge * wire.direction);
    velocity_.assign(position_.size(), Vec3::Zero());
    spin_ = velocity_;
    frame_.assign(position_.size(), frame);
    residual_.resize(position_.size() - 1);
    diagonal_.resize(position_.size() - 1);
    upper_.resize(position_.size() - 1);
}

CorotationalBeam::Element CorotationalBeam::element(int j) const
{
    const Vec3 chord = position_[j + 1] - position_[j];
    const double length = chord.norm(), h = wire_.edge, extension = length - h;
    const Mat3 turn = element_frame(frame_[j], frame_[j + 1], chord / length);
    const Vec3 a = rotation_vector(turn.transpose() * frame_[j]), b = rotation_vector(turn.transpose() * frame_[j + 1]);
    // deformation d = (extension, a, b), energy d^T D d / 2
    Eigen::Matrix<double, 7, 7> stiffness = Eigen::Matrix<double, 7, 7>::Zero();
    stiffness(0, 0) = wire_.stretch / h;
    stiffness(1, 1) = stiffness(4, 4) = wire_.twist / h;
    stiffness(1, 4) = stiffness(4, 1) = -wire_.twist / h;
    for (const int k : {2, 3}) {
        stiffness(k, k) = stiffness(k + 3, k + 3) = 4 * wire_.bend / h;
        stiffness(k, k + 3) = stiffness(k + 3, k) = 2 * wire_.bend / h;
    }
    // its change with the nodes' (position, rotation), in the element's frame: a chord that tilts turns both ends against it
    Eigen::Matrix<double, 7, 12> change = Eigen::Matrix<double, 7, 12>::Zero();
    change(0, 0) = -1, change(0, 6) = 1;
    for (int k = 0; k < 3; ++k) change(1 + k, 3 + k) = change(4 + k, 9 + k) = 1;
    for (const int end : {1, 4}) {
        change(end + 1, 2) = -1 / length, change(end + 1, 8) = 1 / length;
        change(end + 2, 1) = 1 / length, change(end + 2, 7) = -1 / length;
    }
    Eigen::Matrix<double, 7, 1> deformation;
    deformation << extension, eigen(a), eigen(b);
    const Eigen::Matrix<double, 7, 1> force = stiffness * deformation;
    Eigen::Matrix<double, 12, 1> gradient = change.transpose() * force;
    Eigen::Matrix<double, 12, 12> tangent = change.transpose() * stiffness * change;
    for (const int k : {1, 2}) {  // the axial force turns with the chord
        const double g = force(0) / length;
        tangent(k, k) += g, tangent(k + 6, k + 6) += g;
        tangent(k, k + 6) -= g, tangent(k + 6, k) -= g;
    }
    Mat6 to_world = Mat6::Zero();
    to_world.topLeftCorner<3, 3>() = to_world.bottomRightCorner<3, 3>() = eigen(turn);
    Element e;
    e.gradient_a = to_world * gradient.head<6>();
    e.gradient_b = to_world * gradient.tail<6>();
    e.aa = to_world * tangent.topLeftCorner<6, 6>() * to_world.transpose();
    e.ab = to_world * tangent.topRightCorner<6, 6>() * to_world.transpose();
    e.bb = to_world * tangent.bottomRightCorner<6, 6>() * to_world.transpose();
    e.energy = deformation.dot(force) / 2;
    return e;
}

void CorotationalBeam::assemble(double dt)
{
    const int free = wire_.nodes - 1;
    const double inertia = (1 / dt + wire_.damping) / dt;
    for (int i = 0; i < free; ++i) {
        const double m = wire_.node_mass(i), spin = wire_.spin_inertia * m / wire_.mass;
        const Vec3 v = (position_[i] - position_t0_[i]) / dt, w = rotation_vector(frame_[i] * frame_t0_[i].transpose()) / dt;
        const Vec3 force = m * ((v - velocity_[i]) / dt + wire_.damping * v - wire_.gravity);
        const Vec3 moment = spin * ((w - spin_[i]) / dt + wire_.damping * w);
        residual_[i] << eigen(force), eigen(moment);
        diagonal_[i].setZero();
        diagonal_[i].diagonal() << Eigen::Vector3d::Constant(m * inertia), Eigen::Vector3d::Constant(spin * inertia);
    }
    const Vec3 pull = wire_.tip_force(time_);
    residual_[0].head<3>() -= eigen(pull);
    for (int j = 0; j < free; ++j) {
        const Element e = element(j);
        residual_[j] += e.gradient_a;
        diagonal_[j] += e.aa;
        upper_[j] = e.ab;
        if (j + 1 < free) {
            residual_[j + 1] += e.gradient_b;
            diagonal_[j + 1] += e.bb;
        } else {
            base_force_ = to_vec3(e.gradient_b.head<3>()) - wire_.mass / 2 * wire_.gravity;
        }
    }
}

double CorotationalBeam::largest_residual() const
{
    double largest = 0;
    for (const Vec6& r : residual_) largest = std::max({largest, r.head<3>().norm(), r.tail<3>().norm() / wire_.edge});
    return largest;
}

void CorotationalBeam::solve_and_move()
{
    // block elimination from the tip to the base and back; the matrix is positive definite, so no pivots are sought
    const int free = wire_.nodes - 1;
    std::vector<Eigen::LDLT<Mat6>> pivots(free);
    for (int i = 0; i < free; ++i) {
        pivots[i].compute(diagonal_[i]);
        if (i + 1 == free) break;
        diagonal_[i + 1] -= upper_[i].transpose() * pivots[i].solve(upper_[i]);
        residual_[i + 1] -= upper_[i].transpose() * pivots[i].solve(residual_[i]);
    }
    Vec6 behind = Vec6::Zero();
    for (int i = free - 1; i >= 0; --i) {
        const Vec6 right = i + 1 < free ? Vec6(residual_[i] - upper_[i] * behind) : residual_[i];
        behind = pivots[i].solve(right);
        position_[i] -= to_vec3(behind.head<3>());
        frame_[i] = rotation(-to_vec3(behind.tail<3>())) * frame_[i];
    }
}

StepReport CorotationalBeam::step(double dt)
{
    StepReport report;
    position_t0_ = position_;
    frame_t0_ = frame_;
    time_ += dt;
    const double weight = wire_.mass * (wire_.nodes - 1) * wire_.gravity.norm(),
                 wanted = tolerance * (weight + wire_.tip_force(time_).norm());
    bool converged = false;
    for (int k = 0; k < iterations_ && !converged; ++k) {
        assemble(dt);
        solve_and_move();
        ++report.newton_iterations;
        if (iterations_ == 1) break;
        assemble(dt);
        converged = largest_residual() <= wanted;
    }
    if (iterations_ == 1) assemble(dt);  // the reaction of what is the new state
    else if (!converged) report.flags |= StepBestEffort;
    for (int i = 0; i + 1 < wire_.nodes; ++i) {
        velocity_[i] = (position_[i] - position_t0_[i]) / dt;
        spin_[i] = rotation_vector(frame_[i] * frame_t0_[i].transpose()) / dt;
    }
    if (!position_[0].allFinite()) report.flags |= StepNonFinite;
    return report;
}

StepReport CorotationalBeam::settle()
{
    StepReport report;
    report.flags |= StepNotConverged;
    return report;
}

WireReadings CorotationalBeam::readings() const
{
    WireReadings r;
    r.nodes = wire_.nodes;
    for (int j = 0; j + 1 < wire_.nodes; ++j) r.elastic += element(j).energy;
    for (int i = 0; i < wire_.nodes; ++i) {
        r.kinetic += wire_.node_mass(i) / 2 * velocity_[i].squaredNorm() + wire_.spin_inertia / 2 * spin_[i].squaredNorm();
        r.gravitational -= wire_.node_mass(i) * wire_.gravity.dot(position_[i]);
    }
    r.base_force = base_force_;
    r.hand_force = r.base_force.dot(wire_.direction);
    return r;
}

}  // namespace seldinger::baselines

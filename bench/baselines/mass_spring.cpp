// Chain of masses with axial and bending springs: forces, and symplectic Euler in as many parts of a step as stay stable.
#include "baselines/mass_spring.h"

#include <algorithm>
#include <cmath>

namespace seldinger::baselines {
namespace {

constexpr double of_the_limit = 0.7;

double turning_angle(const Vec3& t1, const Vec3& t2) { return std::atan2(t1.cross(t2).norm(), t1.dot(t2)); }

}  // namespace

MassSpring::MassSpring(const Cantilever& wire, Axial axial) : wire_(wire)
{
    const double h = wire.edge, stretch = axial == Axial::True ? wire.stretch : std::min(wire.stretch, 4 * wire.bend / (h * h));
    axial_stiffness_ = stretch / h;
    const double axial_wave = 2 * std::sqrt(axial_stiffness_ / wire.mass);
    const double bending_wave = 4 * std::sqrt(wire.bend / (wire.mass * h * h * h));
    longest_step_ = of_the_limit * 2 / std::max(axial_wave, bending_wave);
    for (int i = 0; i < wire.nodes; ++i) position_.push_back(wire.base + (wire.nodes - 1 - i) * h * wire.direction);
    velocity_.assign(position_.size(), Vec3::Zero());
    force_ = velocity_;
    find_forces();
}

void MassSpring::find_forces()
{
    const int n = wire_.nodes;
    for (int i = 0; i < n; ++i) force_[i] = wire_.node_mass(i) * wire_.gravity;
    force_[0] += wire_.tip_force(time_);
    for (int j = 0; j + 1 < n; ++j) {
        const Vec3 edge = position_[j + 1] - position_[j];
        const double length = edge.norm();
        const Vec3 pull = axial_stiffness_ * (length - wire_.edge) / length * edge;
        force_[j] += pull;
        force_[j + 1] -= pull;
    }
    for (int i = 1; i < n; ++i) {
        // the last spring is the clamp's: its second edge is the clamp's direction and does not move
        const bool clamp = i + 1 == n;
        const Vec3 e1 = position_[i] - position_[i - 1],
                   e2 = clamp ? Vec3(-wire_.edge * wire_.direction) : position_[i + 1] - position_[i];
        const double l1 = e1.norm(), l2 = e2.norm();
        const Vec3 t1 = e1 / l1, t2 = e2 / l2;
        const double angle = turning_angle(t1, t2), sine = std::sin(angle), cosine = std::cos(angle);
        // dE = B/h phi dphi, dphi = -((t1 - cos t2).de2 / l2 + (t2 - cos t1).de1 / l1) / sin phi
        const double moment = (clamp ? 2 : 1) * wire_.bend / wire_.edge * (sine > 1e-12 ? angle / sine : 1.0);
        const Vec3 on_e1 = moment / l1 * (t2 - cosine * t1), on_e2 = moment / l2 * (t1 - cosine * t2);  // = -dE/de
        force_[i - 1] -= on_e1;
        force_[i] += on_e1;
        if (clamp) continue;
        force_[i] -= on_e2;
        force_[i + 1] += on_e2;
    }
}

void MassSpring::sub_step(double h)
{
    time_ += h;
    find_forces();
    for (int i = 0; i + 1 < wire_.nodes; ++i) {
        velocity_[i] = (velocity_[i] + h / wire_.node_mass(i) * force_[i]) / (1 + h * wire_.damping);
        position_[i] += h * velocity_[i];
    }
}

StepReport MassSpring::step(double dt)
{
    const int count = static_cast<int>(std::ceil(dt / longest_step_));
    for (int k = 0; k < count; ++k) sub_step(dt / count);
    StepReport report;
    if (!position_[0].allFinite()) report.flags |= StepNonFinite;
    return report;
}

StepReport MassSpring::settle()
{
    StepReport report;
    report.flags |= StepNotConverged;
    return report;
}

double MassSpring::elastic_energy() const
{
    double energy = 0;
    for (int j = 0; j + 1 < wire_.nodes; ++j)
        energy += axial_stiffness_ / 2 * std::pow((position_[j + 1] - position_[j]).norm() - wire_.edge, 2);
    for (int i = 1; i < wire_.nodes; ++i) {
        const bool clamp = i + 1 == wire_.nodes;
        const Vec3 behind = clamp ? Vec3(-wire_.direction) : (position_[i + 1] - position_[i]).normalized();
        const double angle = turning_angle((position_[i] - position_[i - 1]).normalized(), behind);
        energy += (clamp ? 2 : 1) * wire_.bend / (2 * wire_.edge) * angle * angle;
    }
    return energy;
}

WireReadings MassSpring::readings() const
{
    WireReadings r;
    r.nodes = wire_.nodes;
    r.elastic = elastic_energy();
    for (int i = 0; i < wire_.nodes; ++i) {
        r.kinetic += wire_.node_mass(i) / 2 * velocity_[i].squaredNorm();
        r.gravitational -= wire_.node_mass(i) * wire_.gravity.dot(position_[i]);
    }
    r.base_force = -force_.back();  // what holds the fixed mass; the clamp's moment is no force
    r.hand_force = r.base_force.dot(wire_.direction);
    return r;
}

}  // namespace seldinger::baselines

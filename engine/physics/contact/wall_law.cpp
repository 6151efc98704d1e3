// Constants of the contact laws from the user's settings.
#include "contact/wall_law.h"

#include "core/check.h"
#include "shared/contact_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

constexpr double pi = std::numbers::pi;

// A law given by the user holds as it was given up to 0.4 of the radius. Its pole stays where the wall's own is, at half the
// radius. The axis is then always farther from the wall than the 0.45 radii that a node may move at once (`swept`), and stays on
// its side of the wall. The remaining range must be wide enough for Newton's steps: at a pole of 0.1 radii the force
// doubles within 0.036 radii.
constexpr double exact_part = 0.8;  // of depth_limit

double own_weight(const WireSection& section)
{
    return section.density * pi * section.radius * section.radius * weight_gravity;  // [N/m]
}

double radius_in_lumen(double r, double lumen_radius) { return effective_radius(rod_side(r, 0), wall_side(lumen_radius, r, 0)); }

// (D10): moment per force = arm * a. From the wall's law a^2 = 2 r* depth. From a user's stiffness the Hertz half-width a^2 = (4
// r / pi) f ((1-nu1^2)/E1 + (1-nu2^2)/E2), f per metre; a wire without a modulus is taken as rigid.
void set_rolling(QuadratureModel& m, const WireSection& section, const ContactSpec& contact, const VesselSpec& wall,
                 double r_star)
{
    m.roll_arm = m.roll_depth = m.roll_force = 0;
    if (!contact.rolling) return;
    m.roll_arm = 2 * contact.rolling_alpha / (3 * pi) +
                 (contact.rolling_sigma_b + contact.rolling_sigma_s / 2) / (6 * contact.rolling_hardness);
    if (contact.stiffness_from_wall) {
        m.roll_depth = 2 * r_star;
    } else {
        const double wire = section.youngs > 0 ? (1 - section.poisson * section.poisson) / section.youngs : 0;
        m.roll_force = 4 * r_star / pi * (wire + (1 - wall.poisson * wall.poisson) / wall.youngs);
    }
}

// Constants from the depth under the wire's own weight: k_t = 2/3 of the normal stiffness there (D9), and the floor of v- (D7).
// At smaller approach speeds the damping of a resting contact would exceed critical.
void set_scales(QuadratureModel& m, double own_load)
{
    const double depth = depth_under(own_load, m.stiffness, m.exponent);
    m.friction_stiffness = 2.0 / 3.0 * m.exponent * own_load / depth;
    m.speed_floor = std::max(m.damping / 2 * std::sqrt(weight_gravity * depth / m.exponent), 1e-12);
}

constexpr double impulse_speed = 1e-4;  // that may be left in the normal direction [m/s], against feeds of centimetres a second

// multiplier_law.h. k: the wall's tangent stiffness at a depth of 0.01 radii. kappa: at half of its distance the barrier carries
// the wall's force at that depth. @param mass  that the quadrature point's law acts on per unit of its weight [kg/m],
// or [kg] at the tip
void set_nonpenetration(QuadratureModel& m, const ContactSpec& contact, double mass)
{
    const double r = m.radius;
    m.line_mass = mass;
    m.restitution = contact.restitution;
    m.penalty_stiffness = m.exponent * m.stiffness * std::pow(r / 100, m.exponent - 1);
    double ignored;
    m.multiplier_most = elastic_normal(0.95 * m.depth_limit, m, &ignored);
    switch (contact.normal) {
        case NormalLaw::HuntCrossley:
        case NormalLaw::LankaraniNikravesh:
            break;
        case NormalLaw::Augmented:
        case NormalLaw::Constraint:
            m.law_length = contact.overlap;
            break;
        case NormalLaw::Impulse:
            m.law_length = impulse_speed;
            break;
        case NormalLaw::Barrier: {
            m.law_length = contact.barrier_distance;
            m.penalty_stiffness =
                elastic_normal(m.depth_limit / 2, m, &ignored) / barrier_law(m.law_length / 10, m.law_length, 1, &ignored);
        }
    }
}

}  // namespace

uint kernel_law(NormalLaw law)
{
    switch (law) {
        case NormalLaw::HuntCrossley:
        case NormalLaw::LankaraniNikravesh: return SEL_NORMAL_DAMPED;
        case NormalLaw::Augmented: return SEL_NORMAL_AUGMENTED;
        case NormalLaw::Constraint: return SEL_NORMAL_CONSTRAINT;
        case NormalLaw::Impulse: return SEL_NORMAL_IMPULSE;
        case NormalLaw::Barrier: return SEL_NORMAL_BARRIER;
    }
    return SEL_NORMAL_DAMPED;
}

uint kernel_law(FrictionLaw law)
{
    switch (law) {
        case FrictionLaw::StickSlip: return SEL_FRICTION_STICK_SLIP;
        case FrictionLaw::Smooth: return SEL_FRICTION_SMOOTH;
        case FrictionLaw::Sign: return SEL_FRICTION_SIGN;
        case FrictionLaw::None: return SEL_FRICTION_NONE;
    }
    return SEL_FRICTION_STICK_SLIP;
}

double exact_damping(double e)
{
    SEL_ASSERT(e > 0 && e <= 1);
    if (e == 1) return 0;
    double low = 1e-12, high = (1 - 1e-15) / e;  // the left side less the right is negative at 0+, +infinity at 1/e
    for (int i = 0; i < 200; ++i) {
        const double beta = (low + high) / 2;
        if (beta == low || beta == high) break;
        (std::log1p(beta) - std::log1p(-beta * e) - beta * (1 + e) < 0 ? low : high) = beta;
    }
    return (low + high) / 2;
}

double published_damping(double e) { return 0.75 * (1 - e * e); }

double foundation_modulus(const VesselSpec& wall)
{
    const double nu = wall.poisson;
    return wall.youngs * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * wall.thickness);
}

double line_stiffness(const LawSide& a, const LawSide& b)
{
    return 4.0 / 3.0 * effective_modulus(a, b) * std::sqrt(2 * effective_radius(a, b));
}

double tip_stiffness(double line, double n, double wire_radius, double lumen_radius)
{
    const double beta = std::sqrt(pi) * std::tgamma(n + 0.5) / std::tgamma(n + 1);  // B(1/2, n + 1/2)
    return line * 2 * pi * wire_radius / ((n + 0.5) * std::sqrt(2 * radius_in_lumen(wire_radius, lumen_radius)) * beta);
}

double depth_under(double load, double stiffness, double exponent) { return std::pow(load / stiffness, 1 / exponent); }

QuadratureModel line_model(const WireSection& section, const ContactSpec& contact, const VesselSpec& wall, double lumen_radius,
                           double weight)
{
    QuadratureModel m{};
    m.weight = m.length = weight;
    m.radius = section.radius;
    if (contact.stiffness_from_wall) {
        m.stiffness =
            line_stiffness(rod_side(section.radius, 0), wall_side(lumen_radius, section.radius, foundation_modulus(wall)));
        m.exponent = 1.5;
        m.depth_limit = std::min(wall.thickness, section.radius) / 2;
    } else {
        m.stiffness = contact.stiffness;
        m.exponent = contact.exponent;
        m.depth_limit = section.radius / 2;
        m.depth_exact = exact_part * m.depth_limit;
    }
    m.damping = contact.normal == NormalLaw::LankaraniNikravesh ? published_damping(contact.restitution)
                                                                : exact_damping(contact.restitution);
    m.mu_static = section.mu_static;
    m.mu_sliding = section.mu_sliding;
    set_scales(m, own_weight(section));
    set_nonpenetration(m, contact, own_weight(section) / weight_gravity);
    set_rolling(m, section, contact, wall, radius_in_lumen(section.radius, lumen_radius));
    return m;
}

QuadratureModel tip_model(const WireSection& section, const ContactSpec& contact, const VesselSpec& wall, double lumen_radius)
{
    QuadratureModel m = line_model(section, contact, wall, lumen_radius, 1.0);
    m.length = 0;
    m.stiffness = contact.stiffness_from_wall ? pi * foundation_modulus(wall) * section.radius
                                              : tip_stiffness(m.stiffness, m.exponent, section.radius, lumen_radius);
    m.exponent += 0.5;
    m.roll_arm = 0;                                            // a ball's end rolls on the line contact behind it
    set_scales(m, own_weight(section) * 10 * section.radius);  // ten radii of wire rest on the tip
    set_nonpenetration(m, contact, own_weight(section) / weight_gravity * section.radius);
    return m;
}

}  // namespace seldinger

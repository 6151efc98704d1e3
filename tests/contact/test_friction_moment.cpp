// Friction acts at the wire's surface: moment, virtual work and tangent of one quadrature point on an edge whose two nodes are
// free. The capstan that follows from it: step/test_capstan_radius.cpp.

#include "contact/wall_fixture.h"
#include "contact/wall_law.h"
#include "rod/wire_spec.h"
#include "shared/edge_sums.h"
#include "support/world_fixture.h"

namespace seldinger::test::test_friction_moment {

namespace {

using Q = std::array<double, 7>;  // node a, node b, theta

/// One quadrature point on one edge over a floor. q0: where the step began.
struct FreeEdge {
    Soup soup;
    ContactParams par{};
    QuadratureModel model = line_model(steel_wire(1, 2).shaft, {}, VesselSpec{}, INFINITY, 1e-3);
    QuadraturePlace place{0, 0, 0.3, 0.3, 5, 0, 0};
    Q q0{};

    FreeEdge()
    {
        soup.add_patch(v3(-0.01, -0.01, 0), v3(0.02, 0, 0), v3(0, 0.02, 0));
        par.item_count = 1;
        par.friction = SEL_FRICTION_STICK_SLIP;
        par.smoothing = 0.002;
        model.reach = 0.1 * model.radius;
        // two micrometres deep at the quadrature point, the edge at 3 degrees to the floor: what a chord of a bend is to its wall
        const double r = model.radius, lean = 1e-4;
        q0 = {-0.6e-3, -0.12e-3, r - 2e-6 - 0.3 * lean, 1.3e-3, 0.28e-3, r - 2e-6 + 0.7 * lean, 0.4};
    }
    static void split(const Q& q, std::array<float, 6>& hi, std::array<double, 6>& lo)
    {
        for (int k = 0; k < 6; ++k) {
            hi[k] = static_cast<float>(q[k]);
            lo[k] = q[k] - hi[k];
        }
    }
    EdgeForce at(const Q& q, ContactState* now) const
    {
        std::array<float, 6> hi, hi_t0;
        std::array<double, 6> lo, lo_t0;
        split(q, hi, lo);
        split(q0, hi_t0, lo_t0);
        const double theta[2] = {q[6], 0}, theta_t0[2] = {q0[6], 0};
        const ContactState none[2] = {};
        ContactForce f{};
        const PointView point = point_view(0, model, place, all_of(soup));
        write_force(
            evaluate_point(point, par, node_view(hi.data(), lo.data(), theta), node_view(hi_t0.data(), lo_t0.data(), theta_t0),
                           state_view(none, now, nullptr), nullptr, nullptr),
            &f);
        EdgeForce sum;
        reduce_edge(&f, &place.bary, 0, 1, &sum);
        return sum;
    }
    EdgeForce at(const Q& q) const
    {
        ContactState scratch[2];
        return at(q, scratch);
    }
};

Q generalised(const EdgeForce& f)
{
    return {f.force_a[0], f.force_a[1], f.force_a[2], f.force_b[0], f.force_b[1], f.force_b[2], f.torque};
}

vec3 node(const Q& q, int first) { return v3(q[first], q[first + 1], q[first + 2]); }

/// -dF/dq as the edge's sums say it is.
double tangent(const EdgeForce& f, int row, int column)
{
    static constexpr int tri[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const int i = row % 3, j = column % 3, u = 3 * i + j;
    if (row == 6 && column == 6) return f.s_tt;
    if (column == 6) return row < 3 ? f.st_a[i] : f.st_b[i];
    if (row == 6) return column < 3 ? f.st_a[j] + f.ut_a[j] : f.st_b[j] + f.ut_b[j];
    if (row < 3) return column < 3 ? f.s_aa[tri[i][j]] + f.u_aa[u] : f.s_ab[u] + f.u_ab[u];
    return column < 3 ? f.s_ab[3 * j + i] + f.u_ba[u] : f.s_bb[tri[i][j]] + f.u_bb[u];
}

/// A move of the edge by `slip`, with a turn and a spin that move the surface about as much.
Q moved(const FreeEdge& edge, double slip)
{
    Q q = edge.q0;
    const double by[7] = {0.4, -0.3, 0.01, 0.5, -0.1, 0.02, 0.5 / edge.model.radius};
    for (int k = 0; k < 7; ++k) q[k] += slip * by[k];
    return q;
}

/// Largest difference between the tangent and central differences, of the largest entry; rotations by the surface that they move.
double tangent_error(const FreeEdge& edge, const Q& q)
{
    const double step = 1e-10;  // of some 1e-6 of overlap, see contact/one_quadrature_point.h
    const EdgeForce f = edge.at(q);
    double worst = 0, largest = 0;
    for (int c = 0; c < 7; ++c) {
        const double scale_c = c == 6 ? 1 / edge.model.radius : 1;
        Q up = q, down = q;
        up[c] += step * scale_c;
        down[c] -= step * scale_c;
        const Q fu = generalised(edge.at(up)), fd = generalised(edge.at(down));
        for (int k = 0; k < 7; ++k) {
            const double scale = scale_c * (k == 6 ? 1 / edge.model.radius : 1);
            const double difference = -(fu[k] - fd[k]) / (up[c] - down[c]);
            worst = std::max(worst, scale * std::abs(tangent(f, k, c) - difference));
            largest = std::max(largest, scale * std::abs(tangent(f, k, c)));
        }
    }
    MESSAGE("tangent within " << worst / largest);
    return worst / largest;
}

}  // namespace

TEST_SUITE("contact/friction_moment")
{
    TEST_CASE("analytic: the edge's forces have the moment of friction at the surface and of a normal force through the axis")
    {
        const FreeEdge edge;
        for (const double slip : {2e-8, 1e-5}) {  // stuck; sliding
            CAPTURE(slip);
            const Q q = moved(edge, slip);
            ContactState now[2];
            const Q f = generalised(edge.at(q, now));
            const vec3 a = node(q, 0), b = node(q, 3), x = a + edge.place.bary * (b - a), t = (1 / norm(b - a)) * (b - a);
            const vec3 n = v3(now[0].normal[0], now[0].normal[1], now[0].normal[2]);
            const vec3 friction = v3(now[0].friction[0], now[0].friction[1], now[0].friction[2]);
            REQUIRE(norm(friction) > 1e-3 * now[0].normal_force);
            const vec3 nodes = cross3(a, node(f, 0)) + cross3(b, node(f, 3)) + f[6] * t;
            const vec3 surface = cross3(x - edge.model.radius * n, friction) + cross3(x, now[0].normal_force * n);
            // products of millimetres, of which a dozen are added
            CHECK(norm(nodes - surface) <= 1e-14 * 2e-3 * now[0].normal_force);
            CHECK(norm(node(f, 0) + node(f, 3) - friction - now[0].normal_force * n) <= 1e-14 * now[0].normal_force);
        }
    }

    // F . dq = f . d(slip): what friction takes is what the slip says, whichever of the seven unknowns moves
    TEST_CASE("derivative: the generalised force of friction is dual to the slip")
    {
        FreeEdge edge;
        const double k = edge.model.friction_stiffness * edge.model.weight;
        edge.q0 = moved(edge, 0);
        const Q q = edge.q0;  // no turn yet: the finite turn's own change is of second order in a step
        const double step = 1e-10;
        for (int along = 0; along < 7; ++along) {
            CAPTURE(along);
            const double unit = along == 6 ? 1 / edge.model.radius : 1;
            // a slip of some 1e-10 in each unknown by turns, and the force that another slip has against it
            Q other = q;
            for (int i = 0; i < 7; ++i) other[i] += (i == 6 ? 1 / edge.model.radius : 1) * 2e-9 * std::sin(1.0 + 2 * i);
            ContactState now[2], up[2], down[2];
            const EdgeForce with = edge.at(other, now);
            FreeEdge smooth = edge;
            smooth.par.friction = SEL_FRICTION_NONE;
            const double force = generalised(with)[along] - generalised(smooth.at(other))[along];
            Q plus = other, minus = other;
            plus[along] += step * unit;
            minus[along] -= step * unit;
            (void)edge.at(plus, up);
            (void)edge.at(minus, down);
            REQUIRE((now[0].flags & up[0].flags & down[0].flags & SEL_CONTACT_STUCK) != 0);
            double power = 0;
            for (int i = 0; i < 3; ++i) power += now[0].friction[i] * (up[0].slip[i] - down[0].slip[i]) / (2 * step * unit);
            // the turn of 2e-9 / l so far, and 1e-19 m of rounding over 1e-10
            CHECK(std::abs(force - power) * unit <= 1e-5 * k * 4e-9);
        }
    }

    TEST_CASE("derivative: the tangent in both nodes and the spin, in stick and in slip, on a floor and over a ridge")
    {
        FreeEdge floor, ridge;
        ridge.soup = {};
        ridge.soup.add(v3(-0.01, 0, 0), v3(0.01, 0, 0), v3(0, 0.01, -0.004));
        ridge.soup.add(v3(-0.01, 0, 0), v3(0, -0.01, -0.004), v3(0.01, 0, 0));
        for (const double slip : {2e-8, 1e-5}) {
            double error[2];
            for (const int over_ridge : {0, 1}) {
                CAPTURE(slip);
                CAPTURE(over_ridge);
                const FreeEdge& edge = over_ridge ? ridge : floor;
                const Q q = moved(edge, slip);
                ContactState now[2];
                (void)edge.at(q, now);
                REQUIRE((now[0].flags & SEL_CONTACT_ACTIVE) != 0);
                REQUIRE(((now[0].flags & SEL_CONTACT_STUCK) == 0) == (slip > 1e-6));
                // left out: that the couple's direction turns with the edge, f r / l^2, of a stiffness f / slip and more
                CHECK((error[over_ridge] = tangent_error(edge, q)) <= 2e-6 + slip / 2e-3);
            }
            CHECK(error[1] <=
                  1.2 * error[0]);  // the same is left out over the ridge, where force and couple turn with the normal
        }
    }
}

}  // namespace seldinger::test::test_friction_moment

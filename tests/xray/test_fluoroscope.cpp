// What arrives: Beer and Lambert's law, displacement, the bolus.
#include "core/error.h"
#include "core/parallel.h"
#include "support/approx.h"
#include "xray/fluoroscope.h"

#include <cmath>
#include <numbers>

namespace seldinger::test::test_fluoroscope {

namespace {

/// A closed box, normals inwards.
WallMesh box(const Vec3& half)
{
    WallMesh mesh;
    for (int k = 0; k < 8; ++k) mesh.vertices.push_back(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1).cwiseProduct(half));
    const int faces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (const auto& f : faces) {
        mesh.triangles.push_back({f[0], f[1], f[2]});
        mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    return mesh;
}

CArm far_arm(int size)
{
    CArm arm;
    arm.sid = 10, arm.sod = 9, arm.field = 0.02, arm.columns = size, arm.rows = size;
    return arm;
}

constexpr int middle = 32 * 65 + 32;

}  // namespace

TEST_SUITE("xray/fluoroscope")
{
    TEST_CASE("analytic: -ln(I/I0) of blood, body and a wire that displaces blood, at one energy and at several")
    {
        const double blood = attenuation(materials::blood(), 60), soft = attenuation(materials::soft_tissue(), 60),
                     steel = attenuation(materials::stainless_steel(), 60);
        Fluoroscope scope(single_energy(60));
        scope.set_view(far_arm(65));
        scope.set_wall(box({0.05, 0.01, 0.05}));
        const std::vector<Device> wire = {{{Vec3(-0.02, 0, 0), 1e-3}, {Vec3(0.02, 0, 0), 1e-3}}};
        scope.look({}, {}, std::nullopt);
        CHECK(scope.line_integrals()[middle] == test::about(0.02 * blood).epsilon(1e-4));
        CHECK(scope.mended() == 0);
        scope.set_body({0.19, 0.11, 0.5});
        scope.look({}, {}, std::nullopt);
        CHECK(scope.line_integrals()[middle] == test::about(0.02 * blood + 0.2 * soft).epsilon(1e-4));
        scope.look(wire, {materials::stainless_steel()}, std::nullopt);
        const double chord = 2e-3 * (1 - std::pow(0.02 / 65 * 0.9 / 1e-3, 2) / 24);  // mean over the pixel's height
        CHECK(scope.line_integrals()[middle] ==
              test::about((0.02 - chord) * blood + 0.2 * soft + chord * steel).epsilon(2e-3));
        const Exposure exposure = scope.exposure();
        CHECK(exposure.signal[middle] == test::about(std::exp(-scope.line_integrals()[middle])).epsilon(1e-5));

        Fluoroscope wide(tube_spectrum(75));
        wide.set_view(far_arm(65));
        wide.set_wall(box({0.05, 0.01, 0.05}));
        wide.look({}, {}, std::nullopt);
        double sum = 0;
        for (const SpectrumLine& line : tube_spectrum(75))
            sum += line.signal * std::exp(-0.02 * attenuation(materials::blood(), line.energy));
        CHECK(wide.line_integrals()[middle] == test::about(-std::log(sum)).epsilon(1e-4));
    }

    TEST_CASE("property: a C-arm inside the patient is refused in one line")
    {
        Fluoroscope scope(single_energy(60));
        CArm arm;
        arm.sod = 0.05;
        scope.set_view(arm);
        scope.set_body({0.19, 0.11, 0.5});
        CHECK_THROWS_AS(scope.look({}, {}, std::nullopt), Error);
    }

    TEST_CASE("analytic: a bolus arrives by the volume before it, spreads, and ends")
    {
        Centreline tube;
        for (int k = 0; k <= 50; ++k)
            tube.points.push_back(Vec3(0.002 * k, 0, 0)), tube.radius.push_back(0.01), tube.parent.push_back(k - 1);
        const std::vector<BolusKey> keys = {{1.0, 0}, {1.01, 100}, {2.0, 100}, {2.01, 0}};
        const Bolus bolus(tube, {Vec3(0.02, 0, 0), Vec3::Zero(), 0.1, 0.1, keys});
        const std::vector<Vec3> places = {Vec3(0.05, 0.004, 0), Vec3(0.005, 0, 0)};
        const auto tau = bolus.travel_times(places);
        CHECK(tau[0] == test::about(0.3).epsilon(1e-5));
        CHECK(tau[1] >= never);
        CHECK(bolus.concentration(0.3, 1.8) == test::about(100).epsilon(1e-6));
        CHECK(bolus.concentration(0.3, 1.305) == test::about(50).epsilon(1e-3));
        CHECK(bolus.concentration(0.3, 3.0) < 1e-6);
        double total = 0;  // what was injected passes: 100 * 1.0 s
        for (double t = 0; t < 4; t += 0.001) total += 0.001 * bolus.concentration(0.5, t);
        CHECK(total == test::about(100).epsilon(1e-3));
        CHECK(BolusMoment(bolus, 1.8).mean(0.1, 0.2) == test::about(100).epsilon(1e-3));
    }

    TEST_CASE("analytic: flow divides by the cubes of the radii")
    {
        Centreline tree;
        tree.points = {Vec3(0, 0, 0), Vec3(0.01, 0, 0), Vec3(0.02, 0.01, 0), Vec3(0.02, -0.01, 0)};
        tree.radius = {0.01, 0.01, 0.008, 0.004};
        tree.parent = {-1, 0, 1, 1};
        const Bolus bolus(tree, {Vec3::Zero(), Vec3::Zero(), 0.1, 0, {{0, 100}}});
        const auto tau = bolus.travel_times(tree.points);
        CHECK(tau[1] == test::about(0.1).epsilon(1e-6));
        const double big = 512.0 / (512 + 64), length = std::sqrt(2e-4);
        const double volume = std::numbers::pi * 0.5 * (1e-4 + 0.64e-4) * length, flow = std::numbers::pi * 1e-4 * 0.1;
        CHECK(tau[2] == test::about(0.1 + volume / (big * flow)).epsilon(1e-5));
    }

    TEST_CASE("property: a picture is the same, to the bit, whatever was looked at before and on any number of threads")
    {
        Centreline tube;
        for (int k = 0; k <= 20; ++k)
            tube.points.push_back(Vec3(-0.05 + 0.005 * k, 0, 0)), tube.radius.push_back(0.01), tube.parent.push_back(k - 1);
        const auto scope_at = [&](int size) {
            Fluoroscope scope(tube_spectrum(75));
            scope.set_bolus(Bolus(tube, {Vec3(-0.05, 0, 0), Vec3(-0.05, 0, 0), 0.1, 0.1, {{0.0, 0}, {0.1, 50}}}));
            scope.set_view(far_arm(size));
            scope.set_wall(box({0.05, 0.01, 0.006}));
            scope.set_body({0.19, 0.11, 0.5});
            return scope;
        };
        const auto wire_at = [](double z) {
            return std::vector<Device>{{{Vec3(-0.02, 0, z), 5e-4}, {Vec3(0, 0, z + 0.002), 5e-4}, {Vec3(0.02, 0, z), 5e-4}}};
        };
        const std::vector<Material> steel = {materials::stainless_steel()};
        Fluoroscope alone = scope_at(97), in_series = scope_at(97);
        for (const double t : {0.0, 0.2, 0.9}) {
            in_series.look(wire_at(0.003 * t), steel, t);
            (void)in_series.exposure();
        }
        in_series.look(wire_at(0), steel, 0.4);
        const Exposure& second = in_series.exposure();
        set_thread_count(1);
        alone.look(wire_at(0), steel, 0.4);
        const Exposure& first = alone.exposure();
        set_thread_count(0);
        CHECK(first.signal == second.signal);
        CHECK(first.second == second.second);
        // rays without instruments and iodine are not summed again: the same law as where all are
        const std::vector<float> integral = in_series.line_integrals();
        double worst = 0;
        for (std::size_t k = 0; k < integral.size(); ++k)
            worst = std::max(worst, std::abs(second.signal[k] * std::exp(static_cast<double>(integral[k])) - 1));
        CHECK(worst < 2e-5);  // exponents of about 5 in single precision, polynomial 3e-7
    }
}

}  // namespace seldinger::test::test_fluoroscope

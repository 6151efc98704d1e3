// The parametric aortic arch: topology, quality, dimensions, determinism.
#include "core/error.h"
#include "repair/repair.h"
#include "setup/vessel_load.h"
#include "shapes/aortic_arch.h"
#include "support/approx.h"
#include "vessel/inlets.h"
#include "vessel/mesh_fixtures.h"

#include <algorithm>

namespace seldinger::test::test_aortic_arch {

TEST_SUITE("shapes/aortic_arch")
{
    TEST_CASE("property: one surface of genus 0 with five openings of the published diameters")
    {
        const ArchSpec spec;
        const GeneratedVessel arch = make_aortic_arch(spec);
        const RepairReport report = describe(arch.mesh);
        CHECK(std::abs(static_cast<double>(report.triangles) - 30000) < 0.05 * 30000);
        CHECK(report.components == 1);
        CHECK(report.non_manifold_edges == 0);
        REQUIRE(report.loops.size() == 5);
        // V - E + F = 2 - 2 genus - openings
        const long edges = (3 * report.triangles + report.boundary_edges) / 2;
        CHECK(report.vertices - edges + report.triangles == 2 - 5);
        // widest first: root, diaphragm, innominate, subclavian, carotid. Rim vertices lie on the wall, so on the true radius
        const double diameters[] = {spec.diameter_root, spec.diameter_diaphragm, spec.diameter_innominate,
                                    spec.diameter_subclavian, spec.diameter_carotid};
        // by less than what a chord between two of them is inside of the circle, which is how far off the centre of uneven ones
        // is
        for (std::size_t k = 0; k < 5; ++k) {
            const double sagitta = 1 - std::cos(M_PI / static_cast<double>(report.loops[k].vertices.size()));
            CHECK(report.loops[k].radius == about(0.5 * diameters[k]).epsilon(sagitta));
        }
    }

    TEST_CASE("property: no slivers, near-uniform triangles, vertices on the wall")
    {
        const ArchSpec spec;
        const GeneratedVessel arch = make_aortic_arch(spec);
        double least = 1, smallest = 1, largest = 0;
        for (std::size_t t = 0; t < arch.mesh.triangles.size(); ++t) {
            const Triangle3 tri = triangle_of(arch.mesh, t);
            least = std::min(least, triangle_quality(tri));
            smallest = std::min(smallest, 0.5 * double_area(tri).norm());
            largest = std::max(largest, 0.5 * double_area(tri).norm());
        }
        CHECK(least > 0.3);
        CHECK(largest / smallest < 12);  // edges within a factor of 3.5
        // in the straight descending aorta the wall is a circle about the x axis, its diameter between two of the published ones
        long looked_at = 0;
        for (const Vec3& v : arch.mesh.vertices) {
            if (v.x() > 0.05) continue;
            ++looked_at;
            const double radius = std::hypot(v.y(), v.z());
            CHECK(radius > 0.5 * spec.diameter_diaphragm - 1e-6);
            CHECK(radius < 0.5 * spec.diameter_isthmus + 1e-6);
        }
        REQUIRE(looked_at > 500);
    }

    TEST_CASE("property: normals face the lumen by repair's own rule, and the same bits come twice")
    {
        WallMesh mesh = make_aortic_arch(ArchSpec{}).mesh;
        const WallMesh again = make_aortic_arch(ArchSpec{}).mesh;
        CHECK(mesh.triangles == again.triangles);
        CHECK(mesh.vertices == again.vertices);
        const RepairReport report = repair(mesh);
        CHECK(report.flipped == 0);
        CHECK_FALSE(report.inverted);
        CHECK(report.hole_loops_closed == 0);
        CHECK(mesh.triangles == again.triangles);
    }

    TEST_CASE("property: a scene's axis, normal and origin carry it along; the inlet is the descending aorta")
    {
        VesselSpec spec{.shape = VesselShape::Arch,
                        .origin = Vec3(0.1, 0.2, 0.3),
                        .axis = Vec3::UnitZ(),
                        .normal = Vec3::UnitY(),
                        .triangles = 8000};
        const LoadedVessel vessel = load_vessel(spec);
        const Inlet inlet = pick_inlet(vessel.report.loops, vessel.centreline);
        CHECK((inlet.point - spec.origin).norm() < 1e-4);
        CHECK(inlet.direction.dot(Vec3::UnitZ()) > 0.999);
        CHECK(std::abs(static_cast<double>(vessel.mesh.triangles.size()) - 8000) < 0.05 * 8000);
        const LumenQuery lumen(vessel.mesh, vessel.report.loops);
        int outside = 0;
        for (const Vec3& p : vessel.centreline.points) outside += !lumen.inside(p);
        CHECK(outside == 0);
        spec.triangles = 10;
        CHECK_THROWS_AS((void)load_vessel(spec), Error);
    }
}

}  // namespace seldinger::test::test_aortic_arch

// Given centrelines against their mesh: in its axes and unit, in others, moved, with diameters for radii; with names.
#include "core/error.h"
#include "core/file_io.h"
#include "io/mesh_file.h"
#include "setup/centreline_check.h"
#include "setup/vessel_load.h"
#include "shapes/swept_lumen.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "vessel/branches.h"
#include "vessel/inside.h"

#include <algorithm>

namespace seldinger::test::test_centreline_check {

namespace {

SweptTube tube(const Vec3& from, const Vec3& to, double radius)
{
    SweptTube made;
    for (int k = 0; k <= 40; ++k) made.points.push_back(from + (to - from) * k / 40.0), made.radius.push_back(radius);
    return made;
}

LumenEnd end_of(const Vec3& from, const Vec3& to, double radius)
{
    return {to - 3e-3 * (to - from).normalized(), (to - from).normalized(), 2 * radius};
}

/// A fork away from the origin, with its own centreline beside it.
struct Fork {
    TemporaryFolder folder;
    VesselSpec spec;
    Centreline line;
    Fork()
    {
        const Vec3 low(0.06, 0.02, -0.075), middle(0.06, 0.02, 0), left(0.033, 0.02, 0.05), right(0.087, 0.02, 0.05);
        const SweptLumen lumen({tube(low, middle, 5e-3), tube(middle, left, 3.5e-3), tube(middle, right, 3.2e-3)}, 1e-3);
        const WallMesh mesh =
            mesh_lumen(lumen, {end_of(middle, low, 5e-3), end_of(middle, left, 3.5e-3), end_of(middle, right, 3.2e-3)}, 6000);
        spec.shape = VesselShape::Mesh;
        spec.mesh = folder.path() / "fork.obj";
        write_mesh(spec.mesh, mesh, "mm");
        line = load_vessel(spec).centreline;
        spec.centreline = folder.path() / "line.vtp";
    }

    /// @param head  words of its header: "SPACE=RAS"
    void write(const Centreline& of, const std::string& unit, const std::string& head = "")
    {
        write_centreline_vtp(spec.centreline, of, unit);
        if (head.empty()) return;
        const std::size_t equals = head.find('=');
        std::string codes, file = read_file(spec.centreline);
        for (const char c : head.substr(equals + 1)) codes += std::to_string(static_cast<int>(c)) + " ";
        const std::size_t at = file.find("<Piece");
        file.insert(at, "<FieldData><DataArray type=\"String\" Name=\"" + head.substr(0, equals) +
                            "\" NumberOfTuples=\"1\" format=\"ascii\">" + codes + "0</DataArray></FieldData>");
        write_file(spec.centreline, file);
    }

    [[nodiscard]] std::string refused() const
    {
        return refusal([&] { return load_vessel(spec); });
    }
    /// Its notes that name the centreline's file, one string.
    [[nodiscard]] std::string notes() const
    {
        std::string all;
        const LoadedVessel vessel = load_vessel(spec);
        REQUIRE(vessel.centreline.points.size() == line.points.size());
        for (std::size_t i = 0; i < line.points.size(); ++i) CHECK((vessel.centreline.points[i] - line.points[i]).norm() < 1e-8);
        for (const std::string& note : vessel.report.notes)
            if (note.find("line.vtp") != std::string::npos) all += note;
        return all;
    }
};

Centreline turned(Centreline line)
{
    for (Vec3& p : line.points) p = {-p.x(), -p.y(), p.z()};
    return line;
}

}  // namespace

TEST_SUITE("setup/centreline_check")
{
    TEST_CASE("property: a centreline that fits its mesh is taken without a word")
    {
        Fork fork;
        fork.write(fork.line, "mm");
        CHECK(fork.notes().empty());
    }

    TEST_CASE("property: a point of a found centreline that clings to the wall is named")
    {
        Fork fork;
        fork.spec.centreline.clear();
        LoadedVessel vessel = load_vessel(fork.spec);
        const auto notes = [&] {
            vessel.report.notes.clear();
            check_found_centreline(vessel);
            std::string all;
            for (const std::string& note : vessel.report.notes) all += note;
            return all;
        };
        CHECK_FALSE(has(notes(), "clings"));
        const LoadedVessel before = vessel;
        const std::vector<int> path = vessel.centreline.main_path();
        const LumenQuery lumen(vessel.mesh, vessel.report.loops);
        const auto lay = [&](std::size_t k, double radius) {
            const auto i = static_cast<std::size_t>(path[k]);
            const LumenPlace at = lumen.locate(before.centreline.points[i]);
            vessel.centreline.points[i] = at.nearest + radius * at.normal;
            vessel.centreline.radius[i] = radius;
        };
        lay(path.size() / 3, 1e-5);
        CHECK(has(notes(), "1 point of the centreline does not fit"));
        CHECK(has(notes(), "clings to the wall, at 0.01 mm, beside one at "));
        // down into a cleft by a third at a time, and on in it
        vessel.centreline = before.centreline;
        for (std::size_t k = 0; k < 8; ++k) lay(path.size() / 3 + k, std::max(1e-5, 2e-3 * std::pow(0.35, k)));
        CHECK(has(notes(), "clings to the wall, at 0.0"));
        CHECK(has(notes(), " mm, between triangles of "));
    }

    TEST_CASE("property: a centreline beside the middle of the lumen is taken with a note that says how far")
    {
        Fork fork;
        for (Vec3& p : fork.line.points) p.y() += 0.8e-3;
        fork.write(fork.line, "mm");
        const std::string notes = fork.notes();
        CAPTURE(notes);
        CHECK(has(notes, "line.vtp lies 0.8"));                      // to 5 %
        CHECK(has(notes, " mm beside the middle of the lumen, 2"));  // of radii of 3.2 to 5 mm 16 to 25 %
    }

    TEST_CASE(
        "property: x and y turned round: refused with the key that says so, taken with the key or where the file's header says "
        "so")
    {
        Fork fork;
        fork.write(turned(fork.line), "mm");
        CHECK(has(fork.refused(), "Fix: vessel.centreline_space = \"RAS\""));
        CHECK(has(fork.refused(), "outside of the lumen"));
        fork.spec.centreline_space = "RAS";
        CHECK(has(fork.notes(), "x and y turned round, as the scene says"));
        fork.spec.centreline_space = "";
        fork.write(turned(fork.line), "mm", "SPACE=RAS");
        CHECK(has(fork.notes(), "x and y turned round, as its header says"));
        // a header that names other axes than the numbers have is no reason to refuse what fits
        fork.write(fork.line, "mm", "SPACE=RAS");
        CHECK_FALSE(has(fork.notes(), "turned"));
    }

    TEST_CASE("property: another unit: refused with the key that says so, taken with the key or where the file's header says so")
    {
        Fork fork;
        for (const char* unit : {"cm", "m"}) {
            CAPTURE(unit);
            fork.spec.centreline_units = "";
            fork.write(fork.line, unit);
            const std::string said = fork.refused();
            CHECK(has(said, (std::string("Fix: vessel.centreline_units = \"") + unit + "\"").c_str()));
            CHECK_FALSE(has(said, "centreline_space"));
            fork.spec.centreline_units = unit;
            CHECK(has(fork.notes(), "as the scene says"));
        }
        fork.spec.centreline_units = "";
        fork.write(fork.line, "cm", "UNITS=cm");
        CHECK(has(fork.notes(), "in cm, as its header says"));
        fork.write(turned(fork.line), "m");
        CHECK(has(fork.refused(), "vessel.centreline_space = \"RAS\", vessel.centreline_units = \"m\""));
    }

    TEST_CASE("property: a moved centreline is refused without a cure, and so is one with diameters for radii")
    {
        Fork fork;
        Centreline moved = fork.line;
        for (Vec3& p : moved.points) p.z() += 0.04;
        fork.write(moved, "mm");
        const std::string said = fork.refused();
        CHECK(has(said, "No usual change of axes or unit makes it fit"));
        CHECK_FALSE(has(said, "Fix: vessel.centreline_"));
        Centreline wide = fork.line;
        for (double& r : wide.radius) r *= 2;
        fork.write(wide, "mm");
        CHECK(has(fork.refused(), "got radii of 2 times the distance to the wall"));
        CHECK(has(fork.refused(), "Diameter"));
    }

    TEST_CASE("property: few points outside of the lumen are named with their place, many are refused")
    {
        Fork fork;
        Centreline bent = fork.line;
        const auto middle = static_cast<std::size_t>(bent.main_path()[8]);
        bent.points[middle].y() += 0.0055;
        fork.write(bent, "mm");
        const LoadedVessel vessel = load_vessel(fork.spec);
        CHECK(std::any_of(vessel.report.notes.begin(), vessel.report.notes.end(), [](const std::string& note) {
            return has(note, "1 point of line.vtp does not fit the mesh, the first near [60");
        }));
    }

    TEST_CASE("property: points of a found centreline outside of the lumen, or beyond an opening, are named with their place")
    {
        const Fork fork;
        const auto said_of = [&](const std::vector<Vec3>& phantom) {
            VesselSpec found = fork.spec;
            found.centreline.clear();
            LoadedVessel vessel = load_vessel(found);
            vessel.report.notes.clear();
            int parent = vessel.centreline.main_path()[8];
            for (const Vec3& p : phantom) {
                vessel.centreline.points.push_back(p);
                vessel.centreline.radius.push_back(1e-3);
                vessel.centreline.parent.push_back(parent);
                parent = static_cast<int>(vessel.centreline.points.size()) - 1;
            }
            check_found_centreline(vessel);
            std::string all;
            for (const std::string& note : vessel.report.notes) all += note + "\n";
            return all;
        };
        CHECK(said_of({}).empty());
        // through the side of the trunk into the air
        const std::string aside = said_of({{0.06, 0.03, -0.04}, {0.06, 0.04, -0.04}, {0.06, 0.05, -0.04}});
        CHECK(has(aside, "3 points of the centreline do not fit the mesh, the first near [60.00, 30.00, -40.00] mm"));
        CHECK(has(aside, "outside of the lumen"));
        // out through the trunk's opening at z = -72 mm, where a given line may go on
        const std::string beyond = said_of({{0.06, 0.02, -0.071}, {0.06, 0.02, -0.08}, {0.06, 0.02, -0.1}});
        CHECK(has(beyond, "2 points of the centreline do not fit the mesh, the first near [60.00, 20.00, -80.00] mm"));
        const std::string wide = said_of({{0.06, 0.0248, -0.04}, {0.06, 0.0248, -0.0385}, {0.06, 0.0248, -0.037}});
        CHECK(has(wide,
                  "2 points of the centreline do not fit the mesh, the first near [60.00, 24.80, -40.00] mm: it has a "
                  "radius of 1 mm"));
    }

    TEST_CASE("property: openings that a given centreline does not reach are counted, with their places")
    {
        Fork fork;
        Centreline stem;
        for (const int i : fork.line.main_path()) {
            stem.points.push_back(fork.line.points[static_cast<std::size_t>(i)]);
            stem.radius.push_back(fork.line.radius[static_cast<std::size_t>(i)]);
            stem.parent.push_back(static_cast<int>(stem.points.size()) - 2);
        }
        fork.write(stem, "mm");
        const LoadedVessel vessel = load_vessel(fork.spec);
        REQUIRE(vessel.report.unreached.size() == 1);
        CHECK(std::abs(vessel.report.unreached[0].z() - 0.047) < 0.003);
        CHECK(std::any_of(vessel.report.notes.begin(), vessel.report.notes.end(),
                          [](const std::string& note) { return has(note, "does not reach 1 opening of the mesh"); }));
    }
}

}  // namespace seldinger::test::test_centreline_check

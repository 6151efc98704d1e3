// VTK itself, the library behind ParaView, opens what a run writes. Skipped where Debian's python3-vtk9 is not installed.

#include "apps/app_fixture.h"
#include "support/skip.h"

namespace seldinger::test::test_vtk_opens {

namespace {

// Opens every file that wire.pvd and contacts.pvd name, and vessel.vtp; prints points, lines or triangles, and the least radius.
const char* const opener = R"PY(
import os, sys, xml.etree.ElementTree as tree
import vtk
def read(path):
    reader = vtk.vtkXMLPolyDataReader()
    if not reader.CanReadFile(path): sys.exit("VTK cannot read " + path)
    reader.SetFileName(path)
    reader.Update()
    if reader.GetErrorCode(): sys.exit("VTK: error in " + path)
    return reader.GetOutput()
folder = sys.argv[1]
for series in ("wire.pvd", "contacts.pvd"):
    files = [d.get("file") for d in tree.parse(os.path.join(folder, series)).getroot().iter("DataSet")]
    if len(files) < 10: sys.exit("only %d frames in %s" % (len(files), series))
    for name in files:
        data = read(os.path.join(folder, name))
        if series == "wire.pvd":
            if data.GetNumberOfLines() != 1: sys.exit("no single polyline in " + name)
            if data.GetPointData().GetArray("radius").GetRange()[0] <= 0: sys.exit("no radius in " + name)
    print(len(files), data.GetNumberOfPoints())
print(read(os.path.join(folder, "vessel.vtp")).GetNumberOfPolys())
)PY";

}  // namespace

TEST_SUITE("apps/vtk_opens")
{
    TEST_CASE(
        "property: VTK opens the wire's and the contacts' series and the vessel, with as many nodes and triangles as the run "
        "says")
    {
        if (std::system("/usr/bin/python3 -c 'import vtk' >/dev/null 2>&1") != 0) {
            skip("/usr/bin/python3 has no vtk (Debian package python3-vtk9)");
            return;
        }
        const ScratchFolder folder{{"t.toml", tube_scene()}};
        run_ok(folder, "run t.toml -o D --quiet");
        const fs::path script = folder.write("opener.py", opener);
        const std::string command = fmt::format("/usr/bin/python3 '{}' '{}' >'{}' 2>&1", script.string(),
                                                (folder.path / "D").string(), (folder.path / "seen").string());
        const int status = std::system(command.c_str());
        std::stringstream seen(slurp(folder.path / "seen"));
        INFO(seen.str());
        REQUIRE(status == 0);
        long frames = 0, nodes = 0, contact_frames = 0, contacts = 0, triangles = 0;
        seen >> frames >> nodes >> contact_frames >> contacts >> triangles;
        const auto summary = summary_of(folder.path / "D");
        CHECK(nodes == summary["nodes"].get<long>());
        CHECK(contacts == static_cast<long>(csv_rows(folder.path / "D" / "contacts.csv").size()) - 1);
        CHECK(triangles == summary["vessel"]["triangles"].get<long>());
        CHECK(contact_frames == frames);
    }
}

}  // namespace seldinger::test::test_vtk_opens

// Label maps in every format that is read: where the surface lies, which label is taken, and what is refused.
#include "core/error.h"
#include "io/file_remarks.h"
#include "io/label_map.h"
#include "io/mesh_file.h"
#include "setup/vessel_load.h"
#include "support/bytes.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>

namespace seldinger::test::test_label_map {

namespace {

/// gzip (31) or zlib (15).
std::string packed(const std::string& raw, int window = 31)
{
    z_stream state{};
    REQUIRE(deflateInit2(&state, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY) == Z_OK);
    std::string data(raw.size() + 1000, '\0');
    state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(raw.data()));
    state.avail_in = static_cast<uInt>(raw.size());
    state.next_out = reinterpret_cast<Bytef*>(data.data());
    state.avail_out = static_cast<uInt>(data.size());
    REQUIRE(deflate(&state, Z_FINISH) == Z_STREAM_END);
    data.resize(state.total_out);
    deflateEnd(&state);
    return data;
}

Mat3 turned(double degrees)  // about x, then about y
{
    const double a = degrees * std::acos(-1.0) / 180, c = std::cos(a), s = std::sin(a);
    const Mat3 x = Mat3::columns({1, 0, 0}, {0, c, s}, {0, -s, c}), y = Mat3::columns({c, 0, -s}, {0, 1, 0}, {s, 0, c});
    return x * y;
}

/// A tube of radius 4.5 mm in the patient (LPS, mm), which every file shows.
const Vec3 centre(31, -47, 120), along = Vec3(0.3, 0.45, 0.84).normalized();
constexpr double radius = 4.5;

struct Map {
    VoxelGrid grid;
    std::vector<double> values;
};

/// Its label is 5; a ball of label 9 lies beside it.
Map map_of(const Mat3& directions, const Vec3& spacing)
{
    Map map;
    map.grid.size = {60, 62, spacing.z() > 1 ? 24 : 64};
    for (std::size_t a = 0; a < 3; ++a) map.grid.step.col(a) = spacing[a] * directions.col(a);
    const Vec3 half(0.5 * map.grid.size[0], 0.5 * map.grid.size[1], 0.5 * map.grid.size[2]);
    map.grid.origin = centre - map.grid.step * half;
    for (int z = 0; z < map.grid.size[2]; ++z)
        for (int y = 0; y < map.grid.size[1]; ++y)
            for (int x = 0; x < map.grid.size[0]; ++x) {
                const Vec3 p = map.grid.at(Vec3(x, y, z)) - centre, off = p - along.dot(p) * along;
                map.values.push_back(off.norm() < radius ? 5 : (map.grid.at({3, 3, 3}) - centre - p).norm() < 2 ? 9 : 0);
            }
    return map;
}

Vec3 ras(const Vec3& v) { return {-v.x(), -v.y(), v.z()}; }

template <class T>
std::string data_of(const Map& map, bool big = false)
{
    return as_bytes(std::vector<T>(map.values.begin(), map.values.end()), big);
}

/// A header with what differs from one file to the next.
struct Nifti {
    Map map;
    std::int16_t type = 2, bits = 8;
    bool big = false, qform = false;
    float slope = 0, intercept = 0, scale = 1;
    std::int16_t axes = 3, volumes = 1, s_code = 1;
    std::string names = {};
    std::uint8_t units = 2;

    [[nodiscard]] std::string bytes(const std::string& data) const
    {
        std::string h(352, '\0');
        const auto put = [&](std::size_t at, auto v) { h.replace(at, sizeof v, as_bytes(std::vector<decltype(v)>{v}, big)); };
        const auto real = [&](std::size_t at, double v) { put(at, static_cast<float>(v)); };
        put(0, std::int32_t{348});
        put(40, axes);
        for (std::size_t a = 0; a < 3; ++a) put(42 + 2 * a, static_cast<std::int16_t>(map.grid.size[a]));
        put(48, volumes);
        put(70, type);
        put(72, bits);
        real(108, 352.0 + static_cast<double>(names.size()));
        real(112, slope);
        real(116, intercept);
        h[123] = static_cast<char>(units);
        const VoxelGrid& g = map.grid;
        const Vec3 s = g.spacing();
        if (qform) {  // the quaternion of a turn that is known to be less than half
            const bool left = g.volume() < 0;
            Mat3 r;
            for (std::size_t a = 0; a < 3; ++a) r.col(a) = ras(g.step.col(a)) / s[a] * (left && a == 2 ? -1 : 1);
            const double w = 0.5 * std::sqrt(1 + r.col(0)[0] + r.col(1)[1] + r.col(2)[2]);
            put(252, std::int16_t{1});
            real(76, left ? -1 : 1);
            for (std::size_t a = 0; a < 3; ++a) {
                const std::size_t u = (a + 1) % 3, v = (a + 2) % 3;
                real(80 + 4 * a, s[a]);
                real(256 + 4 * a, (r.col(u)[v] - r.col(v)[u]) / (4 * w));
                real(268 + 4 * a, ras(g.origin)[a]);
            }
        } else {
            put(254, s_code);
            for (std::size_t row = 0; row < 3; ++row) {
                for (std::size_t a = 0; a < 3; ++a) real(280 + 16 * row + 4 * a, ras(g.step.col(a))[row] * scale);
                real(280 + 16 * row + 12, ras(g.origin)[row] * scale);
            }
        }
        h.replace(344, 4, std::string("n+1\0", 4));
        return h + names + data;
    }
};

std::string text_of(const Vec3& v, const char* between = ",")
{
    return fmt::format("{:.12g}{}{:.12g}{}{:.12g}", v.x(), between, v.y(), between, v.z());
}

std::string nrrd(const Map& map, const std::string& space, const Vec3& to_space, const std::string& lines,
                 const std::string& data)
{
    const VoxelGrid& g = map.grid;
    std::string text = fmt::format("NRRD0004\n# made by a test\ndimension: 3\nspace: {}\nsizes: {} {} {}\n{}", space, g.size[0],
                                   g.size[1], g.size[2], lines);
    text += "space directions:";
    for (std::size_t a = 0; a < 3; ++a) text += fmt::format(" ({})", text_of(g.step.col(a).cwiseProduct(to_space)));
    return text + fmt::format("\nspace origin: ({})\n\n", text_of(g.origin.cwiseProduct(to_space))) + data;
}

std::string meta(const Map& map, const std::string& lines, const std::string& data, const std::string& file = "LOCAL")
{
    const VoxelGrid& g = map.grid;
    const Vec3 s = g.spacing();
    std::string text = "ObjectType = Image\nNDims = 3\nTransformMatrix =";
    for (std::size_t a = 0; a < 3; ++a) text += " " + text_of(g.step.col(a) / s[a], " ");
    return text +
           fmt::format("\nOffset = {}\nElementSpacing = {}\nDimSize = {} {} {}\n{}ElementDataFile = {}\n", text_of(g.origin, " "),
                       text_of(s, " "), g.size[0], g.size[1], g.size[2], lines, file) +
           data;
}

struct Found {
    double radius = 0, axis = 0, inward = 0;
};

Found measure(const WallMesh& mesh)
{
    double area = 0, sum = 0, in = 0;
    Vec3 off = Vec3::Zero();
    for (const auto& t : mesh.triangles) {
        const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
        const Vec3 p = (at(0) + at(1) + at(2)) / 3 * 1e3 - centre, normal = (at(1) - at(0)).cross(at(2) - at(0)),
                   o = p - along.dot(p) * along;
        if (std::abs(along.dot(p)) > 6) continue;
        const double a = normal.norm();
        area += a, sum += a * o.norm(), off += a * o, in += normal.dot(o) < 0 ? a : 0;
    }
    return {sum / area, off.norm() / area, in / area};
}

/// The tube is there: its axis within a fifth of the smallest voxel, its radius within 1 %.
void check_tube(const std::string& bytes, const std::string& name, const std::string& label = "5")
{
    CAPTURE(name);
    MeshFileFacts facts;
    const Found found = measure(parse_mesh(bytes, name, "mm", &facts, label));
    CHECK(found.axis < 0.1);
    CHECK(std::abs(found.radius / radius - 1) < 0.01);
    CHECK(found.inward > 0.999);
    REQUIRE(!facts.notes.empty());
    CHECK(facts.notes[0].starts_with(label.empty() ? "Probabilities" : "Label 5"));
}

void check_refused(const std::string& bytes, const std::string& name, const std::string& part, const std::string& label = "5")
{
    const auto parse = [&] { return parse_mesh(bytes, name, "mm", nullptr, label); };
    const std::string text = refusal(parse, ErrorKind::BadFile);
    CHECK(text.starts_with(name + ": "));
    for (const std::string& said : {part, std::string("expected "), std::string("Fix: ")})
        CHECK_MESSAGE(has(text, said), text << "\n  has not: " << said);
}

const Vec3 fine(0.5, 0.5, 1.5);
Mat3 left_handed(Mat3 m)
{
    m.col(0) = -1.0 * m.col(0);
    return m;
}

}  // namespace

TEST_SUITE("io/label_map")
{
    // An image turned by 30 degrees about two axes, right- and left-handed, with voxels of 0.5 x 0.5 x 1.5 and 0.8 mm
    TEST_CASE("analytic: the vessel lies where it is in the patient, in every format and orientation")
    {
        for (const bool left : {false, true})
            for (const Vec3& spacing : {fine, Vec3::Constant(0.8)}) {
                CAPTURE(left);
                const Map map = map_of(left ? left_handed(turned(30)) : turned(30), spacing);
                const std::string u8 = data_of<std::uint8_t>(map);
                check_tube(Nifti{map}.bytes(u8), "s.nii");
                check_tube(packed(Nifti{map}.bytes(u8)), "s.nii.gz");
                check_tube(nrrd(map, "left-posterior-superior", {1, 1, 1}, "type: uint8\nencoding: raw\n", u8), "l.nrrd");
                check_tube(nrrd(map, "RAS", {-1, -1, 1}, "type: unsigned char\nencoding: gzip\n", packed(u8)), "r.nrrd");
                check_tube(nrrd(map, "left-anterior-superior", {1, -1, 1}, "type: short\nendian: big\nencoding: raw\n",
                                data_of<std::int16_t>(map, true)),
                           "a.nrrd");
                check_tube(meta(map, "ElementType = MET_UCHAR\n", u8), "p.mha");
                check_tube(meta(map, "ElementType = MET_USHORT\nCompressedData = True\nElementByteOrderMSB = True\n",
                                packed(data_of<std::uint16_t>(map, true), 15)),
                           "c.mha");
            }
    }

    TEST_CASE("analytic: a NIfTI's quaternion, shear, units, number types, byte orders, slope and intercept")
    {
        const Map map = map_of(turned(30), fine);
        const std::string u8 = data_of<std::uint8_t>(map);
        Map other = map_of(left_handed(turned(-30)), fine);
        for (Vec3* v : {&other.grid.step.col(0), &other.grid.step.col(1), &other.grid.step.col(2)}) *v = ras(*v);
        other.grid.origin = centre - other.grid.step * Vec3(30, 31, 12);  // in RAS less than half a turn
        Map slanted = map;
        slanted.grid.step.col(0) += 0.2 * map.grid.step.col(1);
        for (Map* m : {&other, &slanted}) {
            m->values.clear();
            for (int row = 0; row < m->grid.size[1] * m->grid.size[2]; ++row)
                for (int x = 0; x < m->grid.size[0]; ++x) {
                    const Vec3 p = m->grid.at(Vec3(x, row % m->grid.size[1], row / m->grid.size[1])) - centre;
                    m->values.push_back((p - along.dot(p) * along).norm() < radius ? 5 : 0);
                }
        }
        check_tube(Nifti{.map = other, .qform = true}.bytes(data_of<std::uint8_t>(other)), "left-q.nii");
        check_tube(Nifti{slanted}.bytes(data_of<std::uint8_t>(slanted)), "shear.nii");
        check_tube(Nifti{.map = map, .scale = 1e-3F, .units = 1}.bytes(u8), "metres.nii");
        check_tube(Nifti{.map = map, .type = 4, .bits = 16, .big = true}.bytes(data_of<std::int16_t>(map, true)), "big.nii");
        check_tube(Nifti{.map = map, .type = 8, .bits = 32}.bytes(data_of<std::int32_t>(map)), "i32.nii");
        check_tube(Nifti{.map = map, .type = 16, .bits = 32}.bytes(data_of<float>(map)), "f32.nii");
        check_tube(Nifti{.map = map, .type = 64, .bits = 64, .big = true}.bytes(data_of<double>(map, true)), "f64.nii");
        check_tube(Nifti{.map = map, .type = 512, .bits = 16}.bytes(data_of<std::uint16_t>(map)), "u16.nii");
        check_tube(Nifti{.map = map, .type = 1024, .bits = 64}.bytes(data_of<std::int64_t>(map)), "i64.nii");
        Map doubled = map;
        for (double& v : doubled.values) v = 2 * v - 10;
        check_tube(Nifti{.map = map, .type = 256, .bits = 8, .slope = 0.5F, .intercept = 5}.bytes(data_of<std::int8_t>(doubled)),
                   "slope.nii");
        const std::string both = Nifti{map}.bytes(u8);  // two gzip files, one behind the other
        check_tube(packed(both.substr(0, 5000)) + packed(both.substr(5000)), "two.nii.gz");
        std::string ascii;
        for (const double v : map.values) ascii += v == 0 ? "0 " : fmt::format("{}\n", v);
        check_tube(nrrd(map, "LPS", {1, 1, 1}, "type: int\nencoding: ascii\n", ascii), "text.nrrd");
    }

    TEST_CASE("property: a segmentation's segments are chosen by name, also in a layer of their own, and NIfTI's by its table")
    {
        const Map map = map_of(turned(30), fine);
        std::vector<std::uint8_t> layers;
        for (const double v : map.values)
            layers.insert(layers.end(), {static_cast<std::uint8_t>(v == 9 ? 5 : 0), static_cast<std::uint8_t>(v == 5 ? 5 : 0)});
        std::string text =
            nrrd(map, "LPS", {1, 1, 1},
                 "type: uint8\nencoding: gzip\nSegment0_ID:=Segment_1\nSegment0_Name:=ball\nSegment0_LabelValue:=5\n"
                 "Segment0_Layer:=0\nSegment1_Name:=aorta\nSegment1_LabelValue:=5\nSegment1_Layer:=1\n",
                 packed(as_bytes(layers)));
        const auto replace = [](std::string& in, const std::string& from, const std::string& to) {
            const std::size_t at = in.find(from);
            REQUIRE(at != std::string::npos);
            in.replace(at, from.size(), to);
        };
        replace(text, "dimension: 3", "dimension: 4");
        replace(text, "sizes: ", "sizes: 2 ");
        replace(text, "space directions: ", "space directions: none ");
        MeshFileFacts facts;
        const Found found = measure(parse_mesh(text, "x.seg.nrrd", "mm", &facts, "aorta"));
        CHECK(found.axis < 0.1);
        CHECK(facts.notes[0].starts_with("Label 5 \"aorta\" of 60 x 62 x 24 voxels of 0.5 x 0.5 x 1.5 mm."));
        check_refused(text, "x.seg.nrrd", "got labels 5 \"ball\", 5 \"aorta\"; expected one. Fix: name the vessel's", "");
        check_refused(text, "x.seg.nrrd",
                      "label: got \"vein\", of which there is no voxel; expected one of 5 \"ball\", 5 \"aorta\".", "vein");

        Nifti named{map};
        named.names =
            std::string("\1\0\0\0\x90\0\0\0\0\0\0\0", 12) +
            "<CaretExtension><LabelTable><Label Key=\"5\"><![CDATA[aorta]]></Label>\n<Label Key=\"9\">ball</Label></LabelTable>";
        named.names.resize(148);
        const std::string bytes = named.bytes(data_of<std::uint8_t>(map));
        CHECK(measure(parse_mesh(bytes, "n.nii", "mm", &facts, "aorta")).axis < 0.1);
        CHECK(facts.notes[0].starts_with("Label 5 \"aorta\" of"));
        check_refused(bytes, "n.nii", "got labels 5 \"aorta\", 9 \"ball\"; expected one.", "");
        check_refused(Nifti{map}.bytes(data_of<std::uint8_t>(map)), "n.nii", "got labels 5, 9; expected one.", "");
        check_refused(Nifti{map}.bytes(data_of<std::uint8_t>(map)), "n.nii",
                      "label: got \"7\", of which there is no voxel; expected one of 5, 9.", "7");
    }

    // The fraction falls over two voxels, as a network's does, so that the surface is known to a hundredth of a voxel
    TEST_CASE("analytic: probabilities have their surface at 0.5, as real numbers and as bytes with a slope")
    {
        Map map = map_of(turned(30), Vec3::Constant(0.8));
        for (std::size_t k = 0; k < map.values.size(); ++k) {
            const auto i = static_cast<int>(k);
            const Vec3 p = map.grid.at(Vec3(i % 60, i / 60 % 62, i / 60 / 62)) - centre;
            map.values[k] = std::clamp(0.5 + (radius - (p - along.dot(p) * along).norm()) / 1.6, 0.0, 1.0);
        }
        check_tube(Nifti{.map = map, .type = 16, .bits = 32}.bytes(data_of<float>(map)), "p.nii", "");
        const std::string doubles = packed(data_of<double>(map));
        const std::string file = nrrd(map, "LPS", {1, 1, 1}, "type: double\nencoding: gzip\n", doubles);
        const Found found = measure(parse_mesh(file, "p.nrrd", "mm"));
        CHECK(std::abs(found.radius / radius - 1) < 0.002);
        check_refused(Nifti{.map = map, .type = 16, .bits = 32}.bytes(data_of<float>(map)), "p.nii",
                      "label: got \"1\"; expected none, as the file holds probabilities.", "1");
        for (double& v : map.values) v = std::round(255 * v);
        check_tube(Nifti{.map = map, .slope = 1.0F / 255}.bytes(data_of<std::uint8_t>(map)), "b.nii", "");
    }

    TEST_CASE("property: a .mhd takes its voxels from beside it, and the vessel's loader knows label, unit and axes")
    {
        const TemporaryFolder folder;
        const Map map = map_of(turned(30), fine);
        const auto write = [&](const char* name, const std::string& text) {
            std::ofstream(folder.path() / name, std::ios::binary) << text;
        };
        write("v.raw", data_of<std::uint8_t>(map));
        write("v.mhd", meta(map, "ElementType = MET_UCHAR\n", "", "v.raw"));
        VesselSpec spec{.shape = VesselShape::Mesh, .mesh = folder.path() / "v.mhd", .label = 5};
        const LoadedVessel vessel = load_vessel(spec);
        CHECK(measure(vessel.mesh).axis < 0.1);
        CHECK(vessel.report.loops.size() == 2);
        CHECK(vessel.report.notes[0].starts_with("Label 5 of 60 x 62 x 24 voxels"));
        const FileRemarks remarks = remarks_of_file(spec.mesh);
        CHECK(remarks.axes == FileAxes::Lps);
        CHECK(remarks.units == "mm");
        for (const char* file : {"/etc/hostname", "../v.raw", "v%03d.raw 1 9 1", "LIST"}) {
            write("w.mhd", meta(map, "ElementType = MET_UCHAR\n", "", file));
            CHECK_THROWS_WITH_AS((void)read_mesh(folder.path() / "w.mhd", "mm"),
                                 doctest::Contains("expected the name of one file beside it"), Error);
        }
    }

    TEST_CASE("regression: what is no label map of a vessel is refused in one line")
    {
        const Map map = map_of(turned(30), fine);
        const std::string u8 = data_of<std::uint8_t>(map), good = Nifti{map}.bytes(u8);
        const auto meta_with = [&](const std::string& lines) { return meta(map, lines, u8); };
        check_refused(Nifti{map}.bytes(std::string(u8.size(), '\0')), "x.nii",
                      "got no label: all voxels are 0; expected a vessel.", "");
        check_refused(Nifti{map}.bytes(std::string(u8.size(), '\0')), "x.nii", "expected one of none: all voxels are 0");
        check_refused(Nifti{.map = map, .axes = 4, .volumes = 3}.bytes(u8 + u8 + u8), "x.nii",
                      "got 3 volumes (a 4-D image, axis 4)");
        check_refused(Nifti{.map = map, .s_code = 0}.bytes(u8), "x.nii", "got no orientation (sform and qform are 0)");
        check_refused(Nifti{.map = map, .type = 128, .bits = 24}.bytes(u8), "x.nii", "got data type 128");
        check_refused(Nifti{.map = map, .scale = 0}.bytes(u8), "x.nii", "expected three directions that span space");
        check_refused(Nifti{.map = map, .slope = 1, .intercept = -1000}.bytes(u8), "x.nii",
                      "voxel [0, 0, 0] (counted from 0): got -1000; expected labels, 0 and above, or probabilities.");
        Map huge = map;
        huge.grid.size = {1000, 1000, 1000};
        check_refused(Nifti{huge}.bytes(""), "x.nii", "for 1000000000 voxels; expected 1000000000");
        check_refused(packed(Nifti{huge}.bytes("")), "x.nii.gz", "for 1000000000 voxels; expected 1000000000");
        const std::string whole = packed(good);
        check_refused(whole.substr(0, whole.size() / 2), "x.nii.gz", "voxels before the data end or no longer unpack");
        check_refused(whole.substr(0, whole.size() - 6), "x.nii.gz", "expected gzip's checksum");
        check_refused(good.substr(0, 300), "x.nii", "got 300 bytes; expected a header of 348");
        check_refused("x" + good, "x.nii", "got no NIfTI header in its first bytes");
        std::vector<float> values(map.values.begin(), map.values.end());
        values[map.values.size() / 2] = std::nanf("");
        check_refused(Nifti{.map = map, .type = 16, .bits = 32}.bytes(as_bytes(values)), "x.nii",
                      "(counted from 0): got nan; expected a label");
        values.assign(values.size(), 0.25F);
        check_refused(Nifti{.map = map, .type = 16, .bits = 32}.bytes(as_bytes(values)), "x.nii",
                      "got no probability of 0.5 and above", "");
        values[7] = 40;
        check_refused(Nifti{.map = map, .type = 16, .bits = 32}.bytes(as_bytes(values)), "x.nii",
                      "expected whole labels, or probabilities", "");

        const std::string raw = "type: uint8\nencoding: raw\n";
        check_refused(nrrd(map, "LPS", {1, 1, 1}, "type: uint8\nencoding: bzip2\n", u8), "x.nrrd",
                      "encoding: got \"bzip2\"; expected raw, gzip or ascii");
        check_refused(nrrd(map, "LPS", {1, 1, 1}, "type: block\nencoding: raw\n", u8), "x.nrrd", "type: got type \"block\"");
        check_refused(nrrd(map, "scanner-xyz", {1, 1, 1}, raw, u8), "x.nrrd", "space: got \"scanner-xyz\"");
        check_refused(nrrd(map, "LPS", {1, 1, 0}, raw, u8), "x.nrrd", "expected three directions that span space");
        check_refused(nrrd(map, "LPS", {1, 1, 1}, raw + "data file: v.raw\n", ""), "x.nrrd", "whose voxels are in another file");
        check_refused(nrrd(map, "LPS", {1, 1, 1}, raw, u8.substr(0, 100)), "x.nrrd", "got 100 bytes of data");
        check_refused("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n12345678", "x.nrrd",
                      "got no orientation");
        check_refused("solid x\n", "x.nrrd", "got no \"NRRD000\"");

        Map slanted = map;
        slanted.grid.step.col(0) += 0.2 * map.grid.step.col(1);
        check_refused(meta(slanted, "ElementType = MET_UCHAR\n", u8), "x.mha",
                      "TransformMatrix: got directions that are not of length 1 and at right angles");
        check_refused(meta_with("ElementType = MET_UCHAR_ARRAY\n"), "x.mha", "ElementType: got type \"MET_UCHAR_ARRAY\"");
        check_refused(meta_with("ElementType = MET_UCHAR\nElementNumberOfChannels = 3\n"), "x.mha",
                      "got 3 numbers in each voxel");
        check_refused(meta(map, "ElementType = MET_UCHAR\n", u8, "v.raw"), "x.mha", "expected LOCAL in a .mha");
        check_refused("v 0 0 0\n", "x.mha", "got no line with ElementDataFile");
        check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "x.obj", "got label \"5\" for a mesh");
    }
}

}  // namespace seldinger::test::test_label_map

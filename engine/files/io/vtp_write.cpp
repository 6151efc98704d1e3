// Assembles .vtp files (appended raw arrays after the XML) and .pvd lists.
#include "io/vtp_write.h"

#include "core/check.h"

#include <fmt/format.h>
#include <bit>
#include <numeric>

namespace seldinger {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

/// Collects the raw blocks that follow the XML, and hands out where each begins.
class Appended {
public:
    template <class T>
    std::string array(const char* type, std::string_view name, int components, const std::vector<T>& values)
    {
        const std::size_t offset = blocks_.size();
        const std::uint64_t size = values.size() * sizeof(T);
        blocks_.append(reinterpret_cast<const char*>(&size), sizeof size);
        blocks_.append(reinterpret_cast<const char*>(values.data()), size);
        return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
                           type, name, components, offset);
    }
    [[nodiscard]] const std::string& blocks() const { return blocks_; }

private:
    std::string blocks_;
};

std::vector<double> numbers_of(std::span<const Vec3> vectors)
{
    std::vector<double> values;
    values.reserve(3 * vectors.size());
    for (const Vec3& v : vectors) values.insert(values.end(), v.data(), v.data() + 3);
    return values;
}

std::vector<std::int32_t> counting(std::size_t count)
{
    std::vector<std::int32_t> list(count);
    std::iota(list.begin(), list.end(), 0);
    return list;
}

}  // namespace

VtpWriter::VtpWriter(std::span<const Vec3> points) : points_(numbers_of(points)) {}

void VtpWriter::set_verts()
{
    verts_.connectivity = verts_.offsets = counting(points_.size() / 3);
    for (std::int32_t& end : verts_.offsets) ++end;
}

void VtpWriter::set_line()
{
    lines_.connectivity = counting(points_.size() / 3);
    lines_.offsets = {static_cast<std::int32_t>(lines_.connectivity.size())};
}

void VtpWriter::set_polys(std::span<const std::array<std::int32_t, 3>> triangles)
{
    for (const auto& t : triangles) {
        polys_.connectivity.insert(polys_.connectivity.end(), t.begin(), t.end());
        polys_.offsets.push_back(static_cast<std::int32_t>(polys_.connectivity.size()));
    }
}

void VtpWriter::add_point_data(std::string_view name, int components, std::span<const double> values)
{
    SEL_ASSERT(3 * values.size() == points_.size() * static_cast<std::size_t>(components));
    point_data_.push_back({std::string(name), components, {values.begin(), values.end()}});
}

void VtpWriter::add_point_vectors(std::string_view name, std::span<const Vec3> values)
{
    add_point_data(name, 3, numbers_of(values));
}

std::string VtpWriter::bytes() const
{
    Appended appended;
    std::string xml =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n";
    xml += fmt::format(
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
        points_.size() / 3, verts_.offsets.size(), lines_.offsets.size(), polys_.offsets.size());
    xml += "<PointData>\n";
    for (const Array& array : point_data_) xml += appended.array("Float64", array.name, array.components, array.values);
    xml += "</PointData>\n<Points>\n" + appended.array("Float64", "Points", 3, points_) + "</Points>\n";
    const std::pair<const char*, const Cells*> kinds[] = {{"Verts", &verts_}, {"Lines", &lines_}, {"Polys", &polys_}};
    for (const auto& [name, cells] : kinds) {
        if (cells->offsets.empty()) continue;
        xml += fmt::format("<{}>\n", name) + appended.array("Int32", "connectivity", 1, cells->connectivity);
        xml += appended.array("Int32", "offsets", 1, cells->offsets) + fmt::format("</{}>\n", name);
    }
    xml += "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
    return xml + appended.blocks() + "\n</AppendedData>\n</VTKFile>\n";
}

std::string pvd_text(std::span<const PvdEntry> entries)
{
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
    for (const PvdEntry& entry : entries)
        text += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"{}\" {}file=\"{}\"/>\n", entry.time, entry.part,
                            entry.name.empty() ? "" : fmt::format("name=\"{}\" ", entry.name), entry.file);
    return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace seldinger

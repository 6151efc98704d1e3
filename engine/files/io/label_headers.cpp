// Headers of NIfTI, NRRD and MetaImage: where voxels lie, and how their numbers are stored.
#include "io/label_map.h"

#include "core/error.h"
#include "core/file_io.h"
#include "io/binary_text.h"
#include "io/damaged_file.h"
#include "io/mesh_file.h"
#include "io/text_words.h"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace seldinger {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& got, const std::string& expected, const std::string& fix)
{
    throw Error(ErrorKind::BadFile, fmt::format("{}: {}; expected {}. Fix: {}", name, got, expected, fix));
}

void set_size(VoxelGrid& grid, std::size_t axis, double size, const std::string& name)
{
    // an axis of NIfTI has 16 bits; with fewer than two voxels along it there is no surface between voxels
    if (!(size >= 2 && size <= 32767) || size != std::floor(size))
        refuse(name, fmt::format("got {} voxels along axis {}", size, axis + 1), "2 to 32767",
               "export the label map again as one volume");
    grid.size[axis] = static_cast<int>(size);
}

void check_grid(const VoxelGrid& grid, const std::string& name)
{
    const Vec3 s = grid.spacing();
    if (!(s.minCoeff() > 0) || !s.allFinite() || !grid.origin.allFinite() ||
        !(std::abs(grid.volume()) > 1e-3 * s.x() * s.y() * s.z()))
        refuse(name,
               fmt::format("got an orientation with voxels of {:.4g} x {:.4g} x {:.4g} mm and a volume of {:.4g} mm^3", s.x(),
                           s.y(), s.z(), grid.volume()),
               "three directions that span space", "set the image's orientation, and export it again");
}

/// From RAS to LPS.
void turn(VoxelGrid& grid)
{
    for (std::size_t a = 0; a < 3; ++a) grid.step.col(a) = grid.step.col(a).cwiseProduct({-1, -1, 1});
    grid.origin = grid.origin.cwiseProduct({-1, -1, 1});
}

// ---- NIfTI

struct NiftiAt {  // places in the header of versions 1 and 2
    std::size_t size, dim, type, bits, pixdim, offset, slope, intercept, qform, sform, quaternion, shift, rows, units;
};
constexpr NiftiAt nifti1{348, 40, 70, 72, 76, 108, 112, 116, 252, 254, 256, 268, 280, 123},
    nifti2{540, 16, 12, 14, 104, 168, 176, 184, 344, 348, 352, 376, 400, 500};

class NiftiReader {
public:
    NiftiReader(std::string_view bytes, const std::string& name) : name_(name)
    {
        const bool packed = bytes.starts_with("\x1f\x8b");
        out_.voxels = std::make_unique<ByteStream>(bytes, packed);
        head_.resize(nifti2.size);
        head_.resize(out_.voxels->read(head_.data(), nifti1.size));
        if (head_.size() < nifti1.size) refuse_damaged(name, fmt::format("got {} bytes; expected a header of 348", head_.size()));
        for (const bool big : {false, true})
            for (const NiftiAt* at : {&nifti1, &nifti2})
                if (number_at<std::int32_t>(head_.data(), big) == static_cast<std::int32_t>(at->size))
                    out_.big_endian = big, at_ = at;
        if (!at_)
            refuse(name, "got no NIfTI header in its first bytes", "348 or 540 as the first number",
                   "name the file after its format, or export it again");
        if (at_ == &nifti2) more(nifti2.size);
        const std::string magic = head_.substr(at_ == &nifti1 ? 344 : 4, 3);
        if (magic == "ni1" || magic == "ni2")
            refuse(name, "got a header without its voxels (.hdr and .img)", "one file", "save it as .nii.gz");
    }

    VoxelHeader read()
    {
        read_size(), read_type(), read_orientation(), read_names();
        return std::move(out_);
    }

private:
    void more(std::size_t until)
    {
        const std::size_t had = head_.size();
        if (until <= had) return;
        head_.resize(until);
        if (out_.voxels->read(head_.data() + had, until - had) < until - had)
            refuse_damaged(name_, fmt::format("got the end of the file before its voxels; expected them at byte {}", until));
    }
    [[nodiscard]] bool version1() const { return at_ == &nifti1; }
    /// The k-th of a row of real numbers.
    [[nodiscard]] double real(std::size_t at, std::size_t k = 0) const
    {
        return version1() ? static_cast<double>(number_at<float>(head_.data() + at + 4 * k, out_.big_endian))
                          : number_at<double>(head_.data() + at + 8 * k, out_.big_endian);
    }
    template <class One, class Two>
    [[nodiscard]] double whole(std::size_t at, std::size_t k = 0) const
    {
        return version1() ? static_cast<double>(number_at<One>(head_.data() + at + sizeof(One) * k, out_.big_endian))
                          : static_cast<double>(number_at<Two>(head_.data() + at + sizeof(Two) * k, out_.big_endian));
    }
    [[nodiscard]] double count(std::size_t k) const { return whole<std::int16_t, std::int64_t>(at_->dim, k); }

    void read_size()
    {
        const double axes = count(0);
        if (!(axes >= 1 && axes <= 7)) refuse_damaged(name_, fmt::format("got {} axes; expected 3", axes));
        for (std::size_t k = 4; k <= static_cast<std::size_t>(axes); ++k)
            if (count(k) != 1)
                refuse(name_, fmt::format("got {} volumes (a 4-D image, axis {})", count(k), k), "one label map",
                       "save one volume, or one map with a number for each structure");
        for (std::size_t a = 0; a < 3; ++a) set_size(out_.grid, a, a < static_cast<std::size_t>(axes) ? count(a + 1) : 1, name_);
    }

    void read_type()
    {
        constexpr std::tuple<int, char, std::size_t> types[] = {{2, 'u', 1},    {4, 'i', 2},   {8, 'i', 4},   {16, 'f', 4},
                                                                {64, 'f', 8},   {256, 'i', 1}, {512, 'u', 2}, {768, 'u', 4},
                                                                {1024, 'i', 8}, {1280, 'u', 8}};
        const int type = number_at<std::int16_t>(head_.data() + at_->type, out_.big_endian);
        const auto found =
            std::find_if(std::begin(types), std::end(types), [&](const auto& t) { return std::get<0>(t) == type; });
        if (found == std::end(types))
            refuse(name_, fmt::format("got data type {}", type),
                   "whole or real numbers (2, 4, 8, 16, 64, 256, 512, 768, 1024 or 1280)", "save it as int16");
        std::tie(std::ignore, out_.kind, out_.bytes) = *found;
        const double slope = real(at_->slope), intercept = real(at_->intercept);
        if (std::isfinite(slope) && slope != 0) out_.slope = slope, out_.intercept = std::isfinite(intercept) ? intercept : 0;
    }

    /// As the standard says it: the affine (sform) where there is one, else rotation and spacing (qform).
    void read_orientation()
    {
        const int unit = head_[at_->units] & 7;
        const double scale = unit == 1 ? 1e3 : unit == 3 ? 1e-3 : 1;  // 1: metres, 3: micrometres
        const bool has_s = whole<std::int16_t, std::int32_t>(at_->sform) > 0,
                   has_q = whole<std::int16_t, std::int32_t>(at_->qform) > 0;
        if (!has_s && !has_q)
            refuse(name_, "got no orientation (sform and qform are 0)", "an affine",
                   "take it from the image that was segmented (nibabel: set_sform; 3D Slicer: save the label map again)");
        const VoxelGrid by_q = has_q ? quaternion() : VoxelGrid{}, by_s = has_s ? rows() : VoxelGrid{};
        const std::array<int, 3> size = out_.grid.size;
        out_.grid = has_s ? by_s : by_q;
        out_.grid.size = size;
        if (has_s && has_q) {
            double apart = 0;
            for (int c = 0; c < 8; ++c) {
                const Vec3 corner(c & 1 ? size[0] : 0, c & 2 ? size[1] : 0, c & 4 ? size[2] : 0);
                apart = std::max(apart, (by_s.at(corner) - by_q.at(corner)).norm());
            }
            if (apart > 0.5 * by_s.spacing().maxCoeff())
                out_.note =
                    fmt::format("The file has two orientations, which differ by up to {:.3g} mm; the affine (sform) was used.",
                                scale * apart);
        }
        out_.grid.step *= scale;
        out_.grid.origin *= scale;
        turn(out_.grid);
        check_grid(out_.grid, name_);
    }
    [[nodiscard]] VoxelGrid rows() const
    {
        VoxelGrid grid;
        for (std::size_t r = 0; r < 3; ++r) {
            for (std::size_t c = 0; c < 3; ++c) grid.step.col(c)[r] = real(at_->rows, 4 * r + c);
            grid.origin[r] = real(at_->rows, 4 * r + 3);
        }
        return grid;
    }
    [[nodiscard]] VoxelGrid quaternion() const
    {
        double b = real(at_->quaternion), c = real(at_->quaternion, 1), d = real(at_->quaternion, 2);
        const double left = 1 - (b * b + c * c + d * d);
        const double a = left > 1e-7 ? std::sqrt(left) : 0;  // half a turn: the three are a unit vector
        if (a == 0) {
            const double n = std::sqrt(b * b + c * c + d * d);
            b /= n, c /= n, d /= n;
        }
        VoxelGrid grid;
        grid.step = Mat3::columns({a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
                                  {2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
                                  {2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b});
        for (std::size_t k = 0; k < 3; ++k) {
            grid.step.col(k) *= real(at_->pixdim, k + 1) * (k == 2 && real(at_->pixdim) < 0 ? -1 : 1);
            grid.origin[k] = real(at_->shift, k);
        }
        return grid;
    }

    /// Between header and voxels: extensions, of which one may have names of labels (<Label Key="52">aorta</Label>).
    void read_names()
    {
        const double offset = version1() ? real(at_->offset) : whole<std::int64_t, std::int64_t>(at_->offset);
        constexpr double most = 1 << 24;
        if (!(offset >= static_cast<double>(at_->size)) || offset > most)
            refuse_damaged(name_, fmt::format("got voxels at byte {}; expected {} to {}", offset, at_->size + 4, most));
        more(static_cast<std::size_t>(offset));
        const std::size_t begin = head_.find("<Label ", at_->size), end = head_.rfind("</Label>");
        if (begin == std::string::npos || end == std::string::npos || end < begin) return;
        pugi::xml_document document;
        const std::string text = "<all>" + head_.substr(begin, end + 8 - begin) + "</all>";
        if (!document.load_buffer(text.data(), text.size())) return;
        for (const pugi::xml_node& label : document.first_child().children("Label"))
            out_.names.push_back({label.attribute("Key").as_double(), 0, label.text().as_string()});
    }

    const std::string& name_;
    const NiftiAt* at_ = nullptr;
    std::string head_;
    VoxelHeader out_;
};

// ---- texts of keys

using Keys = std::vector<std::pair<std::string, std::string>>;

const std::string* find(const Keys& keys, std::initializer_list<const char*> names)
{
    for (const char* name : names)
        for (const auto& [key, value] : keys)
            if (same_word(key, name)) return &value;
    return nullptr;
}

/// All numbers of a text, whatever stands between them.
std::vector<double> numbers_in(std::string text)
{
    for (char& c : text)
        if (c == '(' || c == ')' || c == ',') c = ' ';
    std::vector<double> values;
    TextWords words(text);
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
        const std::optional<double> value = number(word);
        if (!value) return {};
        values.push_back(*value);
    }
    return values;
}

std::vector<double> numbers_of(const Keys& keys, std::initializer_list<const char*> names, std::size_t count,
                               const std::string& file)
{
    const std::string* text = find(keys, names);
    if (!text) return {};
    const std::vector<double> values = numbers_in(*text);
    if (values.size() != count)
        refuse_damaged(file, fmt::format("{}: got \"{}\"; expected {} numbers", *names.begin(), excerpt(*text), count));
    return values;
}

void take_type(VoxelHeader& out, std::string_view word, std::string_view all, const std::string& name)
{
    struct Type {
        const char* names;
        char kind;
        std::size_t bytes;
    };
    constexpr Type types[] = {{"|signed char|int8|int8_t|met_char|", 'i', 1},
                              {"|uchar|unsigned char|uint8|uint8_t|met_uchar|", 'u', 1},
                              {"|short|short int|signed short|signed short int|int16|int16_t|met_short|", 'i', 2},
                              {"|ushort|unsigned short|unsigned short int|uint16|uint16_t|met_ushort|", 'u', 2},
                              {"|int|signed int|int32|int32_t|met_int|met_long|", 'i', 4},
                              {"|uint|unsigned int|uint32|uint32_t|met_uint|met_ulong|", 'u', 4},
                              {"|longlong|long long|long long int|signed long long|int64|int64_t|met_long_long|", 'i', 8},
                              {"|ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t|met_ulong_long|", 'u', 8},
                              {"|float|met_float|", 'f', 4},
                              {"|double|met_double|", 'f', 8}};
    const std::string wanted = "|" + lower_case(word) + "|";
    for (const Type& type : types)
        if (std::string_view(type.names).find(wanted) != std::string_view::npos) {
            out.kind = type.kind, out.bytes = type.bytes;
            return;
        }
    refuse(name, fmt::format("{}: got type \"{}\"", all, excerpt(word)), "whole or real numbers", "save it as 16-bit numbers");
}

}  // namespace

ByteStream::ByteStream(std::string_view bytes, bool packed) : left_(bytes), packed_(packed)
{
    if (packed && inflateInit2(&state_, 15 + 32) != Z_OK) throw std::bad_alloc();
}
ByteStream::~ByteStream()
{
    if (packed_) inflateEnd(&state_);
}

std::size_t ByteStream::read(char* to, std::size_t count)
{
    if (!packed_) {
        count = left_.copy(to, count);
        left_.remove_prefix(count);
        return count;
    }
    constexpr std::size_t piece = 1 << 30;  // zlib counts in 32 bits
    std::size_t got = 0;
    while (got < count && !ended_) {
        state_.next_out = reinterpret_cast<Bytef*>(to + got);
        const uInt room = state_.avail_out = static_cast<uInt>(std::min(piece, count - got));
        state_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(left_.data()));
        const uInt there = state_.avail_in = static_cast<uInt>(std::min(piece, left_.size()));
        const int answer = inflate(&state_, Z_NO_FLUSH);
        left_.remove_prefix(there - state_.avail_in);
        got += room - state_.avail_out;
        if (answer == Z_STREAM_END && left_.starts_with("\x1f\x8b")) inflateReset(&state_);  // gzip files in a row are one
        else ended_ = answer != Z_OK || (room == state_.avail_out && there == state_.avail_in);
        well_ = answer == Z_STREAM_END;
    }
    return got;
}

bool ByteStream::ends_well()
{
    char rest[4096];
    while (read(rest, sizeof rest) > 0 && packed_) {
    }
    return well_;
}

VoxelHeader nifti_header(std::string_view bytes, const std::string& name) { return NiftiReader(bytes, name).read(); }

namespace {

// ---- NRRD

/// Lines "field: value" and "key:=value" until an empty one. @param rest  out: behind it
Keys nrrd_keys(std::string_view bytes, const std::string& name, std::string_view& rest)
{
    if (!bytes.starts_with("NRRD000"))
        refuse(name, "got no \"NRRD000\" in its first line", "a NRRD file", "name the file after its format, or export it again");
    TextWords lines(bytes);
    (void)lines.line();
    Keys keys;
    while (!lines.at_end()) {
        const std::string_view line = lines.line();
        if (line.empty()) {
            rest = lines.rest();
            return keys;
        }
        const std::size_t colon = line.find(':');
        if (line[0] == '#' || colon == std::string_view::npos) continue;
        const bool pair = colon + 1 < line.size() && line[colon + 1] == '=';
        keys.emplace_back(line.substr(0, colon), trimmed(line.substr(colon + (pair ? 2 : 1))));
    }
    refuse_damaged(name, "got no empty line behind the header; expected one, and the voxels after it");
}

void nrrd_orientation(const Keys& keys, VoxelHeader& out, std::size_t first_axis, const std::string& name)
{
    const std::string* space = find(keys, {"space"});
    const std::string* directions = find(keys, {"space directions"});
    if (!space || !directions)
        refuse(name, "got no orientation (space and space directions)", "both",
               "save it from the program that segmented it (3D Slicer: .seg.nrrd), or with the header of the image");
    struct Space {
        const char *name, *letters;
        Vec3 to_lps;
    };
    const Space spaces[] = {{"left-posterior-superior", "lps", {1, 1, 1}},
                            {"right-anterior-superior", "ras", {-1, -1, 1}},
                            {"left-anterior-superior", "las", {1, -1, 1}}};
    const Space* found = nullptr;
    for (const Space& s : spaces)
        if (same_word(*space, s.name) || same_word(*space, s.letters)) found = &s;
    if (!found)
        refuse(name, fmt::format("space: got \"{}\"", excerpt(*space)),
               "left-posterior-superior, right-anterior-superior or left-anterior-superior", "save it in the patient's axes");
    std::string text = *directions;
    for (std::size_t at = 0; first_axis > 0 && (at = text.find("none")) != std::string::npos;) text.erase(at, 4);
    const std::vector<double> d = numbers_in(text), origin = numbers_of(keys, {"space origin"}, 3, name);
    if (d.size() != 9)
        refuse_damaged(name, fmt::format("space directions: got \"{}\"; expected three of three numbers", excerpt(*directions)));
    double scale = 1;
    if (const std::string* units = find(keys, {"space units"})) {
        const std::string_view word = trimmed(units->substr(0, units->find('"', 1)));
        scale = same_word(word, "\"m") ? 1e3 : same_word(word, "\"cm") ? 10 : same_word(word, "\"um") ? 1e-3 : 1;
    }
    out.grid.step = Mat3::columns(Vec3(d.data()), Vec3(d.data() + 3), Vec3(d.data() + 6));
    for (std::size_t a = 0; a < 3; ++a) out.grid.step.col(a) = scale * out.grid.step.col(a).cwiseProduct(found->to_lps);
    if (!origin.empty()) out.grid.origin = scale * Vec3(origin.data()).cwiseProduct(found->to_lps);
    check_grid(out.grid, name);
}

/// Segment0_Name, Segment0_LabelValue, Segment0_Layer.
void nrrd_segments(const Keys& keys, VoxelHeader& out)
{
    for (const auto& [key, value] : keys) {
        const std::size_t end = key.find("_Name");
        if (!key.starts_with("Segment") || end != key.size() - 5 || end < 8) continue;
        const std::string start = key.substr(0, end);
        const auto number_of = [&](const char* what, double otherwise) {
            for (const auto& [k, v] : keys)
                if (k == start + what) return number(v).value_or(otherwise);
            return otherwise;
        };
        const double layer = number_of("_Layer", 0);
        out.names.push_back({number_of("_LabelValue", 1), layer >= 0 && layer < 1e6 ? static_cast<int>(layer) : 0, value});
    }
}

}  // namespace

VoxelHeader nrrd_header(std::string_view bytes, const std::string& name)
{
    VoxelHeader out;
    std::string_view data;
    const Keys keys = nrrd_keys(bytes, name, data);
    const auto text = [&](std::initializer_list<const char*> names) {
        const std::string* value = find(keys, names);
        return value ? *value : std::string();
    };
    if (find(keys, {"data file", "datafile"}))
        refuse(name, "got a header whose voxels are in another file", "both in one", "save it as one .nrrd file");
    const std::vector<double> axes = numbers_of(keys, {"dimension"}, 1, name);
    if (axes.empty() || !(axes[0] >= 1 && axes[0] <= 16)) refuse_damaged(name, "got no dimension; expected 3");
    const std::vector<double> sizes = numbers_of(keys, {"sizes"}, static_cast<std::size_t>(axes[0]), name);
    // a segmentation whose segments overlap has several numbers in each voxel, along a first axis without direction
    const bool list = axes[0] == 4 && trimmed(text({"space directions"})).starts_with("none");
    if (sizes.empty() || (sizes.size() != 3 && !list))
        refuse(name, fmt::format("got {} axes", axes[0]), "one volume of 3",
               "save one volume, or one map with a number for each structure");
    const std::size_t first = list ? 1 : 0;
    if (list && !(sizes[0] >= 1 && sizes[0] <= 256))
        refuse_damaged(name, fmt::format("got {} layers; expected 1 to 256", sizes[0]));
    if (list) out.layers = static_cast<int>(sizes[0]);
    for (std::size_t a = 0; a < 3; ++a) set_size(out.grid, a, sizes[first + a], name);
    take_type(out, trimmed(text({"type"})), "type", name);
    nrrd_orientation(keys, out, first, name);
    nrrd_segments(keys, out);
    const std::string encoding = text({"encoding"}), skip = text({"byte skip", "byteskip"}) + text({"line skip", "lineskip"});
    if (skip.find_first_not_of("0") != std::string::npos)
        refuse(name, "got bytes or lines to skip before the voxels", "none", "save it again as .nrrd (3D Slicer, pynrrd)");
    const bool packed = encoding == "gzip" || encoding == "gz",
               as_text = encoding == "ascii" || encoding == "text" || encoding == "txt";
    if (!packed && !as_text && encoding != "raw")
        refuse(name, fmt::format("encoding: got \"{}\"", excerpt(encoding)), "raw, gzip or ascii", "save it with gzip");
    out.big_endian = same_word(text({"endian"}), "big");
    if (as_text) out.kind = 't', out.bytes = 2;
    out.voxels = std::make_unique<ByteStream>(data, packed);
    return out;
}

namespace {

// ---- MetaImage

struct MetaKeys {
    Keys keys;
    std::string file;       // ElementDataFile
    std::size_t value = 0;  // place of its value in the bytes
    std::string_view rest;  // behind the line
};

MetaKeys meta_keys(std::string_view bytes, const std::string& name)
{
    MetaKeys all;
    TextWords lines(bytes);
    while (!lines.at_end()) {
        const std::string_view line = lines.line();
        const std::size_t equals = line.find('=');
        if (equals == std::string_view::npos) break;  // not a header, or not any more
        const std::string_view key = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
        all.keys.emplace_back(key, value);
        if (!same_word(key, "elementdatafile")) continue;
        all.file = value;
        all.value = static_cast<std::size_t>(value.data() - bytes.data());
        all.rest = lines.rest();
        return all;
    }
    refuse(name, "got no line with ElementDataFile", "a MetaImage header that ends with it",
           "name the file after its format, or export it again");
}

bool meta_true(const Keys& keys, std::initializer_list<const char*> names)
{
    const std::string* value = find(keys, names);
    return value && !value->empty() && ((*value)[0] == 'T' || (*value)[0] == 't' || (*value)[0] == '1');
}

}  // namespace

std::string with_voxels(std::string header, const std::filesystem::path& path)
{
    const MetaKeys all = meta_keys(header, path.string());
    if (same_word(all.file, "local")) return header;
    if (all.file.empty() || all.file == ".." || all.file.find_first_of("/\\%") != std::string::npos ||
        same_word(all.file, "list"))
        refuse(path.string(), fmt::format("ElementDataFile: got \"{}\"", excerpt(all.file)), "the name of one file beside it",
               "save it as .mha");
    const std::string voxels = read_file(path.parent_path() / all.file);
    header.resize(all.value);
    return header.append("LOCAL\n").append(voxels);
}

VoxelHeader meta_header(std::string_view bytes, const std::string& name)
{
    VoxelHeader out;
    const MetaKeys all = meta_keys(bytes, name);
    const Keys& keys = all.keys;
    if (!same_word(all.file, "local"))
        refuse(name, fmt::format("ElementDataFile: got \"{}\"", excerpt(all.file)), "LOCAL in a .mha",
               "name it .mhd, or save it as .mha");
    const std::vector<double> axes = numbers_of(keys, {"ndims"}, 1, name);
    if (axes.empty() || axes[0] != 3)
        refuse(name, fmt::format("NDims: got {}", axes.empty() ? "none" : fmt::format("{}", axes[0])), "3", "save one volume");
    const std::vector<double> sizes = numbers_of(keys, {"dimsize"}, 3, name),
                              spacing = numbers_of(keys, {"elementspacing", "elementsize"}, 3, name),
                              offset = numbers_of(keys, {"offset", "position", "origin"}, 3, name),
                              turned = numbers_of(keys, {"transformmatrix", "rotation", "orientation"}, 9, name),
                              channels = numbers_of(keys, {"elementnumberofchannels"}, 1, name);
    if (sizes.empty()) refuse_damaged(name, "got no DimSize; expected three numbers");
    if (!channels.empty() && channels[0] != 1)
        refuse(name, fmt::format("got {} numbers in each voxel", channels[0]), "one", "save a label map, not colours");
    for (std::size_t a = 0; a < 3; ++a) set_size(out.grid, a, sizes[a], name);
    // The first three numbers are the direction of the first index: as rows stand in the file, columns of the matrix.
    if (!turned.empty()) out.grid.step = Mat3::columns(Vec3(turned.data()), Vec3(turned.data() + 3), Vec3(turned.data() + 6));
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b <= a; ++b)
            if (!(std::abs(out.grid.step.col(a).dot(out.grid.step.col(b)) - (a == b ? 1 : 0)) < 1e-3))
                refuse(name, "TransformMatrix: got directions that are not of length 1 and at right angles",
                       "a rotation, as MetaImage has no shear", "save it as .nrrd or .nii.gz, or export it again");
    for (std::size_t a = 0; a < 3 && !spacing.empty(); ++a) out.grid.step.col(a) *= spacing[a];
    if (!offset.empty()) out.grid.origin = Vec3(offset.data());
    check_grid(out.grid, name);
    const std::string* type = find(keys, {"elementtype"});
    take_type(out, type ? trimmed(*type) : std::string_view(), "ElementType", name);
    out.big_endian = meta_true(keys, {"binarydatabyteordermsb", "elementbyteordermsb"});
    const std::string* head = find(keys, {"headersize"});
    if (head && *head != "0") refuse(name, "HeaderSize: got bytes to skip", "none", "save it again as .mha");
    if (find(keys, {"binarydata"}) && !meta_true(keys, {"binarydata"})) out.kind = 't', out.bytes = 2;
    out.voxels = std::make_unique<ByteStream>(all.rest, meta_true(keys, {"compresseddata"}));
    return out;
}

}  // namespace seldinger

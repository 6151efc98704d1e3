// Voxels of one label out of a file: choice of the label, and numbers of any type into runs.
#include "io/label_map.h"

#include "core/error.h"
#include "io/binary_text.h"
#include "io/damaged_file.h"
#include "io/mesh_file.h"
#include "io/text_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <span>

namespace seldinger {
namespace {

class LabelReader {
public:
    LabelReader(VoxelHeader header, const std::string& name, const std::string& label)
        : head_(std::move(header)),
          name_(name),
          label_(label),
          nx_(static_cast<std::size_t>(head_.grid.size[0])),
          rows_(static_cast<std::size_t>(head_.grid.size[1]) * static_cast<std::size_t>(head_.grid.size[2]))
    {
        if (label_.empty() && head_.layers > 1 && head_.names.size() != 1) refuse_choice({});
        layer_ = static_cast<std::size_t>(std::clamp(wanted() ? wanted()->layer : 0, 0, head_.layers - 1));
    }

    LabelVoxels read()
    {
        const std::uint64_t count = rows_ * nx_ * static_cast<std::uint64_t>(head_.layers);
        if (count > most_voxels)
            refuse(fmt::format("got {} numbers; expected at most {}. Fix: crop the label map to the vessel", count, most_voxels));
        if (count * head_.bytes > head_.voxels->most() + 1)
            refuse_damaged(name_, fmt::format("got {} bytes of data for {} voxels; expected {}", head_.voxels->most(), count,
                                              head_.kind == 't' ? 2 * count : count * head_.bytes));
        if (head_.kind == 't') read_text();
        else with_type({head_.kind, head_.bytes}, [&](auto zero) { read_as<decltype(zero)>(); });
        if (!head_.voxels->ends_well())
            refuse_damaged(name_, "got packed data that do not end where they should; expected gzip's checksum");
        return chosen();
    }

private:
    // as many as 1024 slices of 1024 x 1024: what is kept of them is far less
    static constexpr std::uint64_t most_voxels = 1u << 30;

    [[noreturn]] void refuse(const std::string& what) const { throw Error(ErrorKind::BadFile, name_ + ": " + what); }

    /// The segment that the label names, or the only one of the file.
    [[nodiscard]] const LabelName* wanted() const
    {
        if (label_.empty()) return head_.names.size() == 1 ? head_.names.data() : nullptr;
        for (const LabelName& n : head_.names)
            if (n.name == label_) return &n;
        const std::optional<double> value = number(label_);
        for (const LabelName& n : head_.names)
            if (value && n.value == *value) return &n;
        return nullptr;
    }

    template <class T>
    void read_as()
    {
        const std::size_t in_row = nx_ * static_cast<std::size_t>(head_.layers),
                          at_once = std::max<std::size_t>(1, (1 << 17) / in_row);
        std::vector<T> values(in_row * at_once);
        for (std::size_t row = 0; row < rows_; row += at_once) {
            const std::size_t rows = std::min(at_once, rows_ - row), bytes = rows * in_row * sizeof(T);
            const std::size_t got = head_.voxels->read(reinterpret_cast<char*>(values.data()), bytes);
            if (got < bytes) refuse_cut(row * in_row + got / sizeof(T));
            if (head_.big_endian != (std::endian::native == std::endian::big))
                for (T& v : values) std::reverse(reinterpret_cast<char*>(&v), reinterpret_cast<char*>(&v + 1));
            for (std::size_t r = 0; r < rows; ++r) take_row(row + r, values.data() + r * in_row);
        }
    }

    void read_text()
    {
        std::string text(head_.voxels->most(), '\0');
        text.resize(head_.voxels->read(text.data(), text.size()));
        TextWords words(text);
        std::vector<double> values(nx_ * static_cast<std::size_t>(head_.layers));
        for (std::size_t row = 0; row < rows_; ++row) {
            for (double& v : values) {
                const std::string_view word = words.word();
                if (word.empty()) refuse_cut(row * values.size());
                if (const auto read = number(word)) v = *read;
                else refuse_number(name_, "voxels: ", excerpt(word));
            }
            take_row(row, values.data());
        }
    }

    [[noreturn]] void refuse_cut(std::size_t got) const
    {
        refuse_damaged(name_, fmt::format("got {} of {} voxels before the data end or no longer unpack; expected all", got,
                                          rows_ * nx_ * static_cast<std::size_t>(head_.layers)));
    }

    template <class T>
    void take_row(std::size_t row, const T* values)
    {
        values += layer_;
        const auto step = static_cast<std::size_t>(head_.layers);
        for (std::size_t x = 0; x < nx_;) {
            const T raw = values[x * step];
            const std::size_t begin = x++;
            while (x < nx_ && values[x * step] == raw) ++x;
            take_run(row, begin, x, head_.slope * static_cast<double>(raw) + head_.intercept);
        }
    }

    void take_run(std::size_t row, std::size_t begin, std::size_t end, double value)
    {
        const auto place = [&] {
            const auto ny = static_cast<std::size_t>(head_.grid.size[1]);
            return fmt::format("voxel [{}, {}, {}] (counted from 0)", begin, row % ny, row / ny);
        };
        if (!std::isfinite(value))
            refuse(fmt::format("{}: got {}; expected a label or a probability. Fix: replace it by 0", place(), value));
        if (value < 0)
            refuse(fmt::format(
                "{}: got {:.6g}; expected labels, 0 and above, or probabilities. Fix: give the segmentation, not the image",
                place(), value));
        // 255 times a float32's 1/255 is 1
        if (const double whole = std::round(value); std::abs(value - whole) <= 1e-6 * std::max(1.0, whole)) value = whole;
        if (fractions_.empty() && value != std::floor(value)) {
            fractions_.assign(rows_ * nx_, 0);
            for (const VoxelRun& r : runs_)
                for (std::int32_t x = r.begin; x < r.end; ++x)
                    fraction(static_cast<std::size_t>(r.row), static_cast<std::size_t>(x)) = static_cast<float>(r.value);
        }
        if (!fractions_.empty()) {
            if (value > 1 || (!runs_.empty() && runs_.back().value > 1))
                refuse(fmt::format(
                    "{}: got {:.6g} beside whole numbers above 1 or fractions; expected whole labels, or probabilities from 0 to "
                    "1. Fix: give the segmentation, not the image; resample labels with nearest neighbours",
                    place(), value));
            for (std::size_t x = begin; x < end; ++x) fraction(row, x) = static_cast<float>(value);
            if (value < 0.5) return;
        }
        if (value == 0) return;
        runs_.push_back(
            {static_cast<std::int32_t>(row), static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end), value});
        voxels_ += end - begin;
        if (fractions_.empty() && runs_.size() > (1 << 21) && 2 * runs_.size() > voxels_)
            refuse("got another number in nearly every voxel; expected a label map. Fix: give the segmentation, not the image");
    }
    float& fraction(std::size_t row, std::size_t x) { return fractions_[row * nx_ + x]; }

    /// @param found  labels with their voxels
    [[noreturn]] void refuse_choice(const std::map<double, std::int64_t>& found) const
    {
        std::string list;
        std::size_t listed = 0;
        const auto add = [&](double value, const std::string& name) {
            if (++listed > 40) return;
            list +=
                fmt::format("{}{}{}", list.empty() ? "" : ", ", value, name.empty() ? "" : fmt::format(" \"{}\"", excerpt(name)));
        };
        if (!head_.names.empty())
            for (const LabelName& n : head_.names) add(n.value, n.name);
        else
            for (const auto& [value, voxels] : found) add(value, "");
        if (listed > 40) list += fmt::format(" and {} more", listed - 40);
        const std::string fix = "name the vessel's (--label, vessel.label)";
        if (!label_.empty())
            refuse(fmt::format("label: got \"{}\", of which there is no voxel; expected one of {}. Fix: {}", excerpt(label_),
                               list.empty() ? "none: all voxels are 0" : list, fix));
        if (list.empty()) refuse("got no label: all voxels are 0; expected a vessel. Fix: give the map in which it is segmented");
        refuse(fmt::format("got labels {}; expected one. Fix: {}", list, fix));
    }

    /// The runs of the label that is wanted.
    LabelVoxels chosen()
    {
        LabelVoxels out;
        out.grid = head_.grid;
        if (!head_.note.empty()) out.notes.push_back(head_.note);
        std::string what = "Probabilities, 0.5 and above,";
        if (fractions_.empty()) {
            std::map<double, std::int64_t> found;
            for (const VoxelRun& r : runs_) found[r.value] += r.end - r.begin;
            const LabelName* name = wanted();
            std::optional<double> value = name ? name->value : number(label_);
            if (label_.empty() && !name && found.size() == 1) value = found.begin()->first;
            if (!value || !found.contains(*value)) refuse_choice(found);
            std::erase_if(runs_, [&](const VoxelRun& r) { return r.value != *value; });
            what = fmt::format("Label {}{}", *value, name ? fmt::format(" \"{}\"", excerpt(name->name)) : "");
        } else {
            if (!label_.empty())
                refuse(fmt::format("label: got \"{}\"; expected none, as the file holds probabilities. Fix: take it out",
                                   excerpt(label_)));
            // joined again: pieces of one row differ in their fractions
            std::size_t last = 0;
            for (std::size_t k = 1; k < runs_.size(); ++k) {
                if (runs_[k].row == runs_[last].row && runs_[k].begin == runs_[last].end) runs_[last].end = runs_[k].end;
                else runs_[++last] = runs_[k];
            }
            if (runs_.empty())
                refuse("got no probability of 0.5 and above; expected a vessel. Fix: give the map in which it is segmented");
            runs_.resize(last + 1);
        }
        const Vec3 s = head_.grid.spacing();
        out.notes.push_back(
            fmt::format("{} of {} x {} x {} voxels of {:.4g} x {:.4g} x {:.4g} mm. x points to the patient's left, y to the "
                        "back, z to the head (LPS). {}",
                        what, head_.grid.size[0], head_.grid.size[1], head_.grid.size[2], s.x(), s.y(), s.z(),
                        fractions_.empty() ? "Steps of voxels were smoothed by at most half a voxel along each axis."
                                           : "The surface is where they are 0.5."));
        out.runs = std::move(runs_);
        out.fractions = std::move(fractions_);
        return out;
    }

    VoxelHeader head_;
    const std::string& name_;
    const std::string& label_;
    std::size_t nx_, rows_, layer_ = 0;
    std::uint64_t voxels_ = 0;  // in runs
    std::vector<VoxelRun> runs_;
    std::vector<float> fractions_;
};

}  // namespace

bool is_label_map(const std::filesystem::path& path)
{
    const std::string extension = lower_extension(path);
    return extension == ".nrrd" || extension == ".mha" || extension == ".mhd" || extension == ".nii" ||
           (extension == ".gz" && lower_extension(path.stem()) == ".nii");
}

LabelVoxels read_label(std::string_view bytes, const std::filesystem::path& path, const std::string& label)
{
    const std::string extension = lower_extension(path), name = path.string();
    VoxelHeader head = extension == ".nrrd"                        ? nrrd_header(bytes, name)
                       : extension == ".nii" || extension == ".gz" ? nifti_header(bytes, name)
                                                                   : meta_header(bytes, name);
    return LabelReader(std::move(head), name, label).read();
}

}  // namespace seldinger

// Puts path lengths together, still ones once and those of a picture where it differs from them.
#include "xray/fluoroscope.h"

#include "core/check.h"
#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <numeric>

namespace seldinger {
namespace {

Mat3 patient_axes(const CArm& arm)
{
    return Mat3::columns(arm.back.cross(arm.head), arm.back, arm.head);
}

}  // namespace

Fluoroscope::Fluoroscope(std::vector<SpectrumLine> beam) : beam_(std::move(beam)), view_(arm_) {}

void Fluoroscope::set_view(const CArm& arm)
{
    check(arm);
    const CArm before = arm_;
    arm_ = arm;
    arm_.head.normalize(), arm_.back.normalize();
    body_fits_ &= arm_.head == before.head && arm_.back == before.back && arm_.isocentre == before.isocentre;
    view_ = CArmView(arm_);
    traced_ = false;
}

void Fluoroscope::set_wall(const WallMesh& wall)
{
    wall_ = wall.triangles.empty() ? WallMesh{} : close_openings(wall);
    arrival_ = bolus_ ? bolus_->travel_times(wall_.vertices) : std::vector<float>{};
    traced_ = body_fits_ = false;
}

void Fluoroscope::set_bone(const WallMesh& bone)
{
    bone_ = close_openings(bone);
    traced_ = false;
}

void Fluoroscope::set_body(const Vec3& half_axes)
{
    body_half_ = half_axes;
    traced_ = body_fits_ = false;
}

void Fluoroscope::set_bolus(const Bolus& bolus)
{
    bolus_ = bolus;
    arrival_ = bolus_->travel_times(wall_.vertices);
    traced_ = false;
}

void Fluoroscope::fit_body()
{
    if (body_fits_) return;
    const Mat3 to_patient = patient_axes(arm_).transpose();
    Box3 box;
    for (const Vec3& v : wall_.vertices) box.extend(v);
    body_centre_ = box.isEmpty() ? arm_.isocentre : Vec3(box.center());
    double most = 1;
    for (const Vec3& v : wall_.vertices)
        most = std::max(most, (to_patient * (v - body_centre_)).cwiseQuotient(body_half_).norm());
    body_half_wide_ = most * body_half_;
    body_fits_ = true;
}

void Fluoroscope::find_body()
{
    fit_body();
    const Mat3 axes = patient_axes(arm_);
    const auto inside = [&](const Vec3& p) {
        return (axes.transpose() * (p - body_centre_)).cwiseQuotient(body_half_wide_).norm() <= 1;
    };
    if (inside(view_.source) || inside(view_.source + view_.sid * view_.direction))
        throw Error(
            ErrorKind::BadScene,
            "the C-arm is inside the patient: source or detector lies in the body; make --sod or --sid larger, or --body none");
    body_path_ = trace_ellipsoid(view_, body_centre_, axes, body_half_wide_);
}

void Fluoroscope::trace_still()
{
    if (traced_) return;
    body_path_.clear(), bone_path_.clear();
    lumen_ = {}, mended_ = 0;
    if (!body_half_.isZero()) find_body();
    if (!wall_.triangles.empty()) lumen_ = trace_mesh(view_, wall_, arrival_);
    interval_row_.assign(view_.rows + 1, 0);
    for (int row = 0; row < view_.rows; ++row)
        interval_row_[row + 1] = static_cast<std::size_t>(
            std::partition_point(lumen_.intervals.begin(), lumen_.intervals.end(),
                                 [&](const PathInterval& i) { return i.pixel < (row + 1) * view_.columns; }) -
            lumen_.intervals.begin());
    if (!bone_.triangles.empty()) {
        MeshPaths bone = trace_mesh(view_, bone_);
        mended_ += bone.mended;
        bone_path_ = std::move(bone.length);
    }
    mended_ += lumen_.mended;
    traced_ = true;
    summed_ = false;
}

void Fluoroscope::look(std::vector<Device> devices, const std::vector<Material>& of, std::optional<double> time)
{
    trace_still();
    iodine_.reset();
    if (bolus_ && time) iodine_.emplace(*bolus_, *time);
    if (iodine_ && iodine_->empty()) iodine_.reset();
    if (iodine_) carry_iodine(devices);
    devices_ = trace_devices(view_, devices);
    device_row_.assign(view_.rows + 1, 0);
    for (const DevicePath& d : devices_) ++device_row_[d.pixel / view_.columns + 1];
    std::partial_sum(device_row_.begin(), device_row_.end(), device_row_.begin());
    beam_.set_instruments(of);
}

void Fluoroscope::carry_iodine(std::vector<Device>& devices) const
{
    for (Device& device : devices) {
        std::vector<Vec3> places;
        for (const DeviceStation& s : device) places.push_back(s.place);
        const std::vector<float> arrival = bolus_->travel_times(places);
        for (std::size_t k = 0; k < device.size(); ++k)
            device[k].value = static_cast<float>(iodine_->mean(arrival[k], arrival[k]));
    }
}

std::vector<std::int32_t> Fluoroscope::every_column() const
{
    std::vector<std::int32_t> columns(view_.columns);
    std::iota(columns.begin(), columns.end(), 0);
    return columns;
}

std::vector<float> Fluoroscope::iodine_of(int row) const
{
    if (!iodine_ || interval_row_[row] == interval_row_[row + 1]) return {};
    std::vector<float> iodine(view_.columns);
    // ordered by pixel: each pixel's sum has its order
    for (std::size_t k = interval_row_[row]; k < interval_row_[row + 1]; ++k) {
        const PathInterval& i = lumen_.intervals[k];
        iodine[i.pixel - row * view_.columns] += static_cast<float>(i.length * iodine_->mean(i.from, i.to));
    }
    return iodine;
}

std::vector<std::int32_t> Fluoroscope::changed_columns(int row, const std::vector<float>& iodine) const
{
    std::vector<char> changed(view_.columns);
    for (std::size_t x = 0; x < iodine.size(); ++x) changed[x] = iodine[x] != 0;
    for (std::int32_t k = device_row_[row]; k < device_row_[row + 1]; ++k)
        changed[devices_[k].pixel - row * view_.columns] = 1;
    std::vector<std::int32_t> columns;
    for (int x = 0; x < view_.columns; ++x)
        if (changed[x]) columns.push_back(x);
    return columns;
}

void Fluoroscope::pack_still(int row, const std::vector<std::int32_t>& columns, Rays& out) const
{
    out.clear(static_cast<int>(columns.size()));
    const auto gather = [&](const std::vector<float>& image, std::vector<float>& into) {
        if (image.empty()) return;
        const float* from = image.data() + static_cast<std::size_t>(row) * view_.columns;
        for (std::size_t k = 0; k < columns.size(); ++k) into[k] = from[columns[k]];
    };
    std::vector<float>&soft = out.amount[Soft], &blood = out.amount[Blood], &bone = out.amount[Bone];
    gather(body_path_, soft);
    gather(lumen_.length, blood);
    gather(bone_path_, bone);
    if (body_path_.empty()) return;
    for (std::size_t k = 0; k < columns.size(); ++k) soft[k] -= blood[k] + bone[k];
}

void Fluoroscope::pack(int row, const std::vector<std::int32_t>& columns, const std::vector<float>& iodine, Rays& out) const
{
    pack_still(row, columns, out);
    if (!iodine.empty())
        for (std::size_t k = 0; k < columns.size(); ++k) out.amount[Iodine][k] = iodine[columns[k]];
    std::vector<std::int32_t> ray(view_.columns);
    for (std::size_t k = 0; k < columns.size(); ++k) ray[columns[k]] = static_cast<std::int32_t>(k);
    const bool body = !body_path_.empty(), vessel = !lumen_.length.empty();
    for (std::int32_t k = device_row_[row]; k < device_row_[row + 1]; ++k) {
        const DevicePath& d = devices_[k];
        const std::int32_t r = ray[d.pixel - row * view_.columns];
        if (vessel) out.amount[Blood][r] -= d.length;
        else if (body) out.amount[Soft][r] -= d.length;
        out.amount[Iodine][r] = std::max(0.0f, out.amount[Iodine][r] - d.length * d.value);
        out.pieces.push_back({r, d.material, d.length});
    }
}

const Exposure& Fluoroscope::still()
{
    trace_still();
    if (summed_) return still_;
    still_.resize(view_.columns, view_.rows);
    const std::vector<std::int32_t> columns = every_column();
    for_each_item(view_.rows, 4, [&](int row) {
        const std::size_t begin = static_cast<std::size_t>(row) * view_.columns;
        Rays rays;
        pack_still(row, columns, rays);
        beam_.arrive(rays, still_.signal.data() + begin, still_.second.data() + begin);
    });
    reference_.reset();
    summed_ = true;
    return still_;
}

const Exposure& Fluoroscope::exposure()
{
    SEL_ASSERT(traced_);
    const Exposure& still = this->still();
    exposure_.resize(view_.columns, view_.rows);
    for_each_item(view_.rows, 4, [&](int row) {
        const std::size_t begin = static_cast<std::size_t>(row) * view_.columns;
        float *signal = exposure_.signal.data() + begin, *second = exposure_.second.data() + begin;
        std::copy_n(still.signal.data() + begin, view_.columns, signal);
        std::copy_n(still.second.data() + begin, view_.columns, second);
        const std::vector<float> iodine = iodine_of(row);
        const std::vector<std::int32_t> columns = changed_columns(row, iodine);
        if (columns.empty()) return;
        Rays rays;
        pack(row, columns, iodine, rays);
        std::vector<float> new_signal(columns.size()), new_second(columns.size());
        beam_.arrive(rays, new_signal.data(), new_second.data());
        for (std::size_t k = 0; k < columns.size(); ++k) signal[columns[k]] = new_signal[k], second[columns[k]] = new_second[k];
    });
    return exposure_;
}

std::vector<float> Fluoroscope::line_integrals()
{
    SEL_ASSERT(traced_);
    std::vector<float> result(static_cast<std::size_t>(view_.rows) * view_.columns);
    const std::vector<std::int32_t> columns = every_column();
    for_each_item(view_.rows, 4, [&](int row) {
        Rays rays;
        pack(row, columns, iodine_of(row), rays);
        beam_.line_integrals(rays, result.data() + static_cast<std::size_t>(row) * view_.columns);
    });
    return result;
}

std::vector<float> Fluoroscope::lumen_thickness() const
{
    SEL_ASSERT(traced_);
    return lumen_.length.empty() ? std::vector<float>(static_cast<std::size_t>(view_.rows) * view_.columns) : lumen_.length;
}

double Fluoroscope::reference()
{
    const Exposure& still = this->still();
    if (reference_) return *reference_;
    std::vector<float> middle;
    for (int row = view_.rows / 4; row < std::max(view_.rows / 4 + 1, view_.rows * 3 / 4); row += 4) {
        const auto signal = still.signal.begin() + static_cast<std::ptrdiff_t>(row) * view_.columns;
        middle.insert(middle.end(), signal + view_.columns / 4, signal + std::max(view_.columns / 4 + 1, view_.columns * 3 / 4));
    }
    std::nth_element(middle.begin(), middle.begin() + middle.size() / 2, middle.end());
    reference_ = middle[middle.size() / 2];
    return *reference_;
}

}  // namespace seldinger

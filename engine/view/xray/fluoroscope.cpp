// Puts path lengths together and sums the beam's energies.
#include "view/xray/fluoroscope.h"

#include "core/check.h"
#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace seldinger {
namespace {

/// exp(-x), x >= -20: 2^n times a polynomial, 3e-7 off at most; a loop of it is vectorised where std::exp is not.
inline float exp_minus(float x)
{
    const float y = std::max(-126.0f, std::min(28.0f, x * -1.44269504f));
    const float n = static_cast<float>(static_cast<int>(y + 1024.5f) - 1024), f = y - n;  // |f| <= 1/2
    const float p =
        1.0f + f * (0.693147182f +
                    f * (0.240226463f + f * (0.0555032530f + f * (0.00961817370f + f * (0.00133983510f + f * 0.000154353160f)))));
    const std::int32_t bits = (static_cast<std::int32_t>(n) + 127) << 23;
    float power;
    std::memcpy(&power, &bits, sizeof power);
    return p * power;
}

Mat3 patient_axes(const CArm& arm)
{
    Mat3 axes;
    axes << arm.back.cross(arm.head), arm.back, arm.head;
    return axes;
}

}  // namespace

Fluoroscope::Fluoroscope(std::vector<SpectrumLine> beam) : beam_(std::move(beam)), view_(arm_)
{
    double energy = 0;
    for (const SpectrumLine& line : beam_) {
        energy += line.photons * line.energy;
        mu_.push_back({static_cast<float>(attenuation(materials::soft_tissue(), line.energy)),
                       static_cast<float>(attenuation(materials::blood(), line.energy)),
                       static_cast<float>(attenuation(materials::cortical_bone(), line.energy)),
                       static_cast<float>(mass_attenuation(53, line.energy))});
    }
    mean_energy_ = energy;
}

void Fluoroscope::set_view(const CArm& arm)
{
    check(arm);
    arm_ = arm;
    arm_.head.normalize(), arm_.back.normalize();
    view_ = CArmView(arm_);
    traced_ = false;
}

void Fluoroscope::set_wall(const WallMesh& wall)
{
    wall_ = wall.triangles.empty() ? WallMesh{} : close_openings(wall);
    arrival_ = bolus_ ? bolus_->travel_times(wall_.vertices) : std::vector<float>{};
    traced_ = false;
}

void Fluoroscope::set_bone(const WallMesh& bone)
{
    bone_ = close_openings(bone);
    traced_ = false;
}

void Fluoroscope::set_body(const Vec3& half_axes)
{
    body_half_ = half_axes;
    traced_ = false;
}

void Fluoroscope::set_bolus(const Bolus& bolus)
{
    bolus_ = bolus;
    arrival_ = bolus_->travel_times(wall_.vertices);
    traced_ = false;
}

void Fluoroscope::find_body()
{
    const Mat3 axes = patient_axes(arm_);
    Eigen::AlignedBox3d box;
    for (const Vec3& v : wall_.vertices) box.extend(v);
    body_centre_ = box.isEmpty() ? arm_.isocentre : Vec3(box.center());
    double most = 1;
    for (const Vec3& v : wall_.vertices)
        most = std::max(most, (axes.transpose() * (v - body_centre_)).cwiseQuotient(body_half_).norm());
    const auto inside = [&](const Vec3& p) {
        return (axes.transpose() * (p - body_centre_)).cwiseQuotient(most * body_half_).norm() <= 1;
    };
    if (inside(view_.source) || inside(view_.source + view_.sid * view_.direction))
        throw Error(ExitCode::BadScene,
                    "the C-arm is inside the patient: source or detector lies in the body; make --sod or --sid larger, or --body none");
    body_path_ = trace_ellipsoid(view_, body_centre_, axes, most * body_half_);
}

void Fluoroscope::trace_still()
{
    if (traced_) return;
    body_path_.clear(), bone_path_.clear();
    lumen_ = {}, mended_ = 0;
    reference_.reset();
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
}

void Fluoroscope::look(std::vector<Device> devices, const std::vector<Material>& of, std::optional<double> time)
{
    trace_still();
    iodine_.clear();
    const bool contrast = bolus_ && time;
    const BolusMoment moment = contrast ? BolusMoment(*bolus_, *time) : BolusMoment(Bolus(), 0);
    if (contrast && !moment.empty()) {
        iodine_.assign(static_cast<std::size_t>(view_.rows) * view_.columns, 0.0f);
        // ordered by pixel, so that rows are apart and each pixel's sum has its order
        for_each_item(view_.rows, 4, [&](int row) {
            for (std::size_t k = interval_row_[row]; k < interval_row_[row + 1]; ++k) {
                const PathInterval& i = lumen_.intervals[k];
                iodine_[i.pixel] += static_cast<float>(i.length * moment.mean(i.from, i.to));
            }
        });
        for (Device& device : devices) {
            std::vector<Vec3> places;
            for (const DeviceStation& s : device) places.push_back(s.place);
            const std::vector<float> arrival = bolus_->travel_times(places);
            for (std::size_t k = 0; k < device.size(); ++k)
                device[k].value = static_cast<float>(moment.mean(arrival[k], arrival[k]));
        }
    }
    devices_ = trace_devices(view_, devices);
    // paths come in bands of rows: sorted by row, those of a row in their order
    std::stable_sort(devices_.begin(), devices_.end(),
                     [&](const DevicePath& a, const DevicePath& b) { return a.pixel / view_.columns < b.pixel / view_.columns; });
    device_row_.assign(view_.rows + 1, 0);
    for (const DevicePath& d : devices_) ++device_row_[d.pixel / view_.columns + 1];
    for (int row = 0; row < view_.rows; ++row) device_row_[row + 1] += device_row_[row];
    mu_device_.assign(beam_.size(), {});
    for (std::size_t line = 0; line < beam_.size(); ++line)
        for (const Material& m : of) mu_device_[line].push_back(static_cast<float>(attenuation(m, beam_[line].energy)));
}

void Fluoroscope::fill_row(int row, bool full, Row& out) const
{
    const std::size_t count = view_.columns, begin = count * row;
    const auto part = [&](const std::vector<float>& image, std::vector<float>& into) {
        if (image.empty()) into.assign(count, 0.0f);
        else into.assign(image.begin() + begin, image.begin() + begin + count);
    };
    part(body_path_, out.amount[Soft]);
    part(lumen_.length, out.amount[Blood]);
    part(bone_path_, out.amount[Bone]);
    static const std::vector<float> none;
    part(full ? iodine_ : none, out.amount[Iodine]);  // by reference: a copy for each row is what a whole frame costs
    const bool body = !body_path_.empty(), vessel = !lumen_.length.empty();
    for (std::size_t x = 0; body && x < count; ++x) out.amount[Soft][x] -= out.amount[Blood][x] + out.amount[Bone][x];
    if (!full) return;
    for (std::int32_t k = device_row_[row]; k < device_row_[row + 1]; ++k) {
        const DevicePath& d = devices_[k];
        const std::size_t x = d.pixel - begin;
        if (vessel) out.amount[Blood][x] -= d.length;
        else if (body) out.amount[Soft][x] -= d.length;
        if (!iodine_.empty()) out.amount[Iodine][x] = std::max(0.0f, out.amount[Iodine][x] - d.length * d.value);
    }
}

void Fluoroscope::exponents(int row, std::size_t line, const Row& amounts, bool full, std::vector<float>& out) const
{
    const std::size_t count = view_.columns;
    out.resize(count);
    const float soft = mu_[line][Soft], blood = mu_[line][Blood], bone = mu_[line][Bone], iodine = mu_[line][Iodine];
    const float *a = amounts.amount[Soft].data(), *b = amounts.amount[Blood].data(), *c = amounts.amount[Bone].data(),
                *d = amounts.amount[Iodine].data();
    float* to = out.data();
    for (std::size_t x = 0; x < count; ++x) to[x] = soft * a[x] + blood * b[x] + bone * c[x] + iodine * d[x];
    if (!full) return;
    for (std::int32_t k = device_row_[row]; k < device_row_[row + 1]; ++k)
        to[devices_[k].pixel - count * row] += mu_device_[line][devices_[k].material] * devices_[k].length;
}

Exposure Fluoroscope::exposure()
{
    SEL_ASSERT(traced_);
    const std::size_t count = static_cast<std::size_t>(view_.rows) * view_.columns;
    Exposure e{view_.columns, view_.rows, std::vector<float>(count), std::vector<float>(count)};
    for_each_item(view_.rows, 4, [&](int row) {
        Row amounts;
        std::vector<float> x;
        fill_row(row, true, amounts);
        float *signal = e.signal.data() + static_cast<std::size_t>(row) * view_.columns,
              *second = e.second.data() + static_cast<std::size_t>(row) * view_.columns;
        for (std::size_t line = 0; line < beam_.size(); ++line) {
            exponents(row, line, amounts, true, x);
            const auto share = static_cast<float>(beam_[line].signal);
            const auto square = static_cast<float>(beam_[line].signal * beam_[line].energy / mean_energy_);
            const float* from = x.data();
            for (int i = 0; i < view_.columns; ++i) {
                const float through = exp_minus(from[i]);
                signal[i] += share * through;
                second[i] += square * through;
            }
        }
    });
    return e;
}

std::vector<float> Fluoroscope::line_integrals()
{
    SEL_ASSERT(traced_);
    std::vector<float> result(static_cast<std::size_t>(view_.rows) * view_.columns);
    for_each_item(view_.rows, 4, [&](int row) {
        Row amounts;
        std::vector<float> x;
        std::vector<double> sum(view_.columns);
        fill_row(row, true, amounts);
        float* out = result.data() + static_cast<std::size_t>(row) * view_.columns;
        for (std::size_t line = 0; line < beam_.size(); ++line) {
            exponents(row, line, amounts, true, x);
            for (int i = 0; i < view_.columns; ++i) sum[i] += beam_[line].signal * std::exp(-static_cast<double>(x[i]));
        }
        for (int i = 0; i < view_.columns; ++i)
            out[i] = beam_.size() == 1 ? x[i] : static_cast<float>(-std::log(std::max(sum[i], 1e-300)));
    });
    return result;
}

double Fluoroscope::reference()
{
    trace_still();
    if (reference_) return *reference_;
    std::vector<float> middle;
    Row amounts;
    std::vector<float> x;
    for (int row = view_.rows / 4; row < std::max(view_.rows / 4 + 1, view_.rows * 3 / 4); row += 4) {
        fill_row(row, false, amounts);
        std::vector<float> signal(view_.columns, 0.0f);
        for (std::size_t line = 0; line < beam_.size(); ++line) {
            exponents(row, line, amounts, false, x);
            for (int i = 0; i < view_.columns; ++i) signal[i] += static_cast<float>(beam_[line].signal) * exp_minus(x[i]);
        }
        middle.insert(middle.end(), signal.begin() + view_.columns / 4,
                      signal.begin() + std::max(view_.columns / 4 + 1, view_.columns * 3 / 4));
    }
    std::nth_element(middle.begin(), middle.begin() + middle.size() / 2, middle.end());
    reference_ = middle[middle.size() / 2];
    return *reference_;
}

}  // namespace seldinger

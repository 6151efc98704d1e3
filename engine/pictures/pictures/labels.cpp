// Projects the contents of a frame and asks the X-ray's tracer which pixels they cover.
#include "pictures/labels.h"

#include "core/error.h"
#include "xray/device_paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

PixelPoint pixel_of(const CArmView& view, const Vec3& point)
{
    const CArmPoint at = project(view, point);
    // the area of a pixel reaches half a pixel beyond its centre
    const bool inside =
        at.depth > 0 && at.column >= -0.5 && at.column < view.columns - 0.5 && at.row >= -0.5 && at.row < view.rows - 0.5;
    return {at.column, at.row, inside};
}

/// The fraction of a line's length outside of the field: the part of each piece beside an end that is outside counts as half.
double cut_off_of(const InstrumentTruth& of)
{
    double all = 0, outside = 0;
    for (std::size_t i = 0; i + 1 < of.centreline.size(); ++i) {
        const double length = (of.centreline[i + 1] - of.centreline[i]).norm();
        all += length;
        outside += 0.5 * length * (!of.pixels[i].in_field + !of.pixels[i + 1].in_field);
    }
    return all > 0 ? outside / all : 0;
}

InstrumentTruth instrument_of(const CArmView& view, const WireLine& wire, const std::vector<TubeStation>& line)
{
    InstrumentTruth truth;
    truth.name = wire.name.empty() ? "wire" : wire.name;
    truth.hand_force = wire.hand_force, truth.hand_torque = wire.hand_torque;
    for (const double r : wire.radius) truth.radius = std::max(truth.radius, r);
    truth.narrowest = 1e9;
    for (const TubeStation& s : line) {
        const CArmPoint at = project(view, s.position);
        truth.centreline.push_back(s.position);
        truth.pixels.push_back(pixel_of(view, s.position));
        if (truth.pixels.back().in_field)
            truth.narrowest = std::min(truth.narrowest, 2 * s.radius * at.magnification / view.pixel);
    }
    truth.cut_off = cut_off_of(truth);
    return truth;
}

/// A contact between two instruments pushes on both, against each other.
void add_contact(const CArmView& view, const ContactMark& mark, std::vector<InstrumentTruth>& instruments)
{
    const Vec3 force = mark.force * mark.normal + mark.friction;
    for (const auto& [k, sign] : {std::pair{mark.instrument, 1.0}, std::pair{mark.other, -1.0}})
        if (k >= 0 && k < static_cast<int>(instruments.size()))
            instruments[static_cast<std::size_t>(k)].contacts.push_back(
                {mark.point, pixel_of(view, mark.point), Vec3(sign * force)});
}

}  // namespace

std::vector<std::vector<TubeStation>> drawn_lines(const WireFrame& frame)
{
    std::vector<std::vector<TubeStation>> lines;
    for (const WireLine& wire : frame.wires)
        lines.push_back(wire.nodes.size() > 1 ? smooth_line(wire.nodes, wire.radius) : std::vector<TubeStation>{});
    return lines;
}

CArmView pinhole_view(const Camera& camera, const Viewport& viewport)
{
    CArmView view{CArm{}};
    view.source = camera.eye, view.direction = camera.forward(), view.right = camera.right();
    view.up = view.right.cross(view.direction);
    view.sid = 1e3;
    view.pixel = 2 * std::tan(0.5 * camera.fov_y) / viewport.height * view.sid;
    view.columns = viewport.width, view.rows = viewport.height;
    return view;
}

Projection projection_of(const CArmView& view)
{
    const double f = view.sid / view.pixel, column = 0.5 * (view.columns - 1), row = 0.5 * (view.rows - 1);
    const Vec3 rows[] = {Vec3(f * view.right + column * view.direction), Vec3(row * view.direction - f * view.up),
                         view.direction};
    Projection p{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) p[i][static_cast<std::size_t>(k)] = rows[i][k];
        p[i][3] = -rows[i].dot(view.source);
    }
    return p;
}

PictureTruth locate(const CArmView& view, const WireFrame& frame, const std::vector<std::vector<TubeStation>>& lines)
{
    PictureTruth truth{frame.time, frame.step, view, {}, 0, {}, frame.contacts_known, {}, {}, {}};
    for (std::size_t k = 0; k < frame.wires.size(); ++k)
        truth.instruments.push_back(instrument_of(view, frame.wires[k], lines[k]));
    for (const ContactMark& mark : frame.contacts) add_contact(view, mark, truth.instruments);
    return truth;
}

void add_mask(PictureTruth& truth, const std::vector<std::vector<TubeStation>>& lines, bool with_depth)
{
    std::vector<Device> devices;
    for (const std::vector<TubeStation>& line : lines) {
        Device& device = devices.emplace_back();
        for (const TubeStation& s : line) {
            if (!truth.arm && !(project(truth.view, s.position).depth > 1e-3))
                throw Error(ErrorKind::BadScene,
                            "--labels: an instrument passes behind the camera; expected all of it in front. Fix: take another "
                            "--view or --camera");
            device.push_back({s.position, s.radius});
        }
    }
    DeviceMask mask = mask_devices(truth.view, devices, with_depth);
    truth.mask = std::move(mask.label), truth.depth = std::move(mask.depth);
}

void LabelWarnings::take_in(const PictureTruth& truth)
{
    x_ray_ = truth.arm.has_value();
    tallies_.resize(std::max(tallies_.size(), truth.instruments.size()));
    for (std::size_t k = 0; k < truth.instruments.size(); ++k) {
        const InstrumentTruth& of = truth.instruments[k];
        Tally& t = tallies_[k];
        t.name = of.name;
        if (of.pixels.empty()) continue;
        t.pictures++;
        t.cut += of.cut_off > 0;
        t.tip_outside += !of.pixels.front().in_field;
        t.most = std::max(t.most, of.cut_off);
        t.narrowest = std::min(t.narrowest, of.narrowest);
    }
}

std::vector<std::string> LabelWarnings::lines(bool masks) const
{
    std::vector<std::string> all;
    for (const Tally& t : tallies_) {
        if (t.cut > 0)
            all.push_back(fmt::format(
                "the field cuts off {}: in {} of {} pictures, up to {:.0f} % of its length; its tip is outside in {}. Fix: {}",
                t.name, t.cut, t.pictures, std::ceil(100 * t.most), t.tip_outside,
                x_ray_ ? "a larger --field or another --c-arm" : "another --view or --camera"));
        if (masks && t.narrowest < 1)
            all.push_back(fmt::format(
                "the mask of {} may have gaps: it is {:.2f} pixels wide where it is narrowest. Fix: a larger --size{}", t.name,
                t.narrowest, x_ray_ ? " or a smaller --field" : ""));
    }
    return all;
}

}  // namespace seldinger

// Directions, the tip's view, and moves along key frames.
#include "view/viewpoint.h"

#include "core/error.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace seldinger {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double tip_reach = 0.025;  // [m] what the endoscopic view is focused on
constexpr double usual_follow = 0.06;

[[noreturn]] void refuse(const std::string& text)
{
    throw Error(
        ErrorKind::BadScene,
        fmt::format("--camera: got \"{}\"; expected orbit [DEGREES], follow [60mm], or keys: time, azimuth, elevation [deg] "
                    "and zoom, e.g. \"0s 0 0; 2s 90 20 1.5\"",
                    text));
}

CameraKey read_key(const std::string& part, const std::string& text)
{
    std::istringstream words(part);
    std::string time, rest;
    CameraKey key;
    words >> time;
    if (time.empty() || time.back() != 's') refuse(text);
    char* end = nullptr;
    key.t = std::strtod(time.c_str(), &end);
    if (end != time.c_str() + time.size() - 1 || !std::isfinite(key.t)) refuse(text);
    if (!(words >> key.azimuth >> key.elevation)) refuse(text);
    key.azimuth *= degree, key.elevation *= degree;
    words >> key.zoom;
    if (words.fail()) words.clear(), key.zoom = 1;
    if (words >> rest || !(key.zoom > 0) || !std::isfinite(key.azimuth + key.elevation + key.zoom)) refuse(text);
    return key;
}

Camera from_direction(const Scenery& s, ViewFrom from, double aspect)
{
    if (from == ViewFrom::Auto) return automatic_camera(*s.wall, s.nodes, aspect, s.patient.head, s.patient.back);
    const Vec3 &head = s.patient.head, &back = s.patient.back, left = s.patient.left();
    Vec3 forward = back, up = head;
    if (from == ViewFrom::Back) forward = -back;
    if (from == ViewFrom::Left) forward = -left;
    if (from == ViewFrom::Right) forward = left;
    if (from == ViewFrom::Top) forward = -head, up = -back;
    if (from == ViewFrom::Bottom) forward = head, up = -back;
    std::vector<Vec3> points = s.wall->vertices;
    points.insert(points.end(), s.nodes.begin(), s.nodes.end());
    return fit_camera(points, forward, up, aspect);
}

/// Down the lumen: where the last 5 mm of the wire point.
Camera from_tip(const Scenery& s, const WireFrame& frame)
{
    if (frame.wires.empty() || frame.wires[0].nodes.size() < 2)
        throw Error(ErrorKind::BadScene, "--view endoscopic: the frame has no wire with a tip to look from; choose another view");
    const std::vector<Vec3>& nodes = frame.wires[0].nodes;
    std::size_t i = 1;
    while (i + 1 < nodes.size() && (nodes[i] - nodes[0]).norm() < 5e-3) ++i;
    const Vec3 forward = (nodes[0] - nodes[i]).normalized();
    Camera camera;
    const double radius = frame.wires[0].radius[0];
    camera.eye = nodes[0] + radius * forward;
    camera.nearest = 0.1 * radius;  // the wall that the tip lies on is one radius away
    camera.target = camera.eye + tip_reach * forward;
    camera.up = std::abs(forward.dot(s.patient.head)) < 0.9 ? s.patient.head : Vec3(-s.patient.back);
    camera.fov_y = 90 * degree;
    return camera;
}

CameraKey key_at(const std::vector<CameraKey>& keys, double t)
{
    if (keys.empty()) return {};
    const auto next = std::find_if(keys.begin(), keys.end(), [&](const CameraKey& k) { return k.t > t; });
    const CameraKey &a = next == keys.begin() ? *next : next[-1], &b = next == keys.end() ? keys.back() : *next;
    const double s = b.t > a.t ? std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0) : 0.0;
    return {t, a.azimuth + s * (b.azimuth - a.azimuth), a.elevation + s * (b.elevation - a.elevation),
            a.zoom + s * (b.zoom - a.zoom)};
}

Vec3 middle_of(const Scenery& s)
{
    Box3 box;
    for (const Vec3& v : s.wall->vertices) box.extend(v);
    if (box.isEmpty())
        for (const Vec3& v : s.nodes) box.extend(v);
    return box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.center());
}

}  // namespace

CameraMotion parse_motion(const std::string& text)
{
    CameraMotion motion;
    std::istringstream words(text);
    std::string first, rest;
    words >> first;
    if (first == "orbit") {
        double turn = 360;
        if (!(words >> turn)) words.clear(), turn = 360;
        if (words >> rest || !std::isfinite(turn)) refuse(text);
        motion.orbit = turn * degree;
        return motion;
    }
    if (first == "follow") {
        double high = 1e3 * usual_follow;
        if (!(words >> high)) words.clear(), high = 1e3 * usual_follow;
        words >> rest;
        if ((!rest.empty() && rest != "mm") || !(high > 0) || !std::isfinite(high)) refuse(text);
        motion.follow = 1e-3 * high;
        return motion;
    }
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ';');) motion.keys.push_back(read_key(part, text));
    const auto later = [](const CameraKey& a, const CameraKey& b) { return a.t >= b.t; };
    if (motion.keys.empty() || std::adjacent_find(motion.keys.begin(), motion.keys.end(), later) != motion.keys.end())
        refuse(text);
    return motion;
}

namespace {

/// v turned about the unit `axis` by `angle` (Rodrigues).
Vec3 rotated(const Vec3& v, const Vec3& axis, double angle)
{
    return std::cos(angle) * v + std::sin(angle) * axis.cross(v) + (1 - std::cos(angle)) * axis.dot(v) * axis;
}

}  // namespace

Camera frame_camera(const Scenery& scenery, ViewFrom from, const CameraMotion& motion, const WireFrame& frame, double aspect)
{
    if (from == ViewFrom::Endoscopic) return from_tip(scenery, frame);
    Camera camera = from_direction(scenery, from, aspect);
    const double t = std::isfinite(frame.time) ? frame.time : scenery.begin;
    CameraKey key = key_at(motion.keys, t);
    if (scenery.end > scenery.begin) key.azimuth += motion.orbit * (t - scenery.begin) / (scenery.end - scenery.begin);
    if (key.azimuth != 0 || key.elevation != 0) {
        // about the up axis of the picture through the middle of the vessel, so that the horizon stays
        const Vec3 axis = camera.up.normalized(), right = camera.right(), middle = middle_of(scenery);
        const auto turn = [&](const Vec3& v) { return rotated(rotated(v, right, -key.elevation), axis, key.azimuth); };
        camera.eye = middle + turn(camera.eye - middle);
        camera.target = middle + turn(camera.target - middle);
        camera.up = turn(camera.up);
    }
    const double reach = (camera.target - camera.eye).norm() / key.zoom;
    camera.eye = camera.target - reach * camera.forward();
    if (motion.follow > 0 && !frame.wires.empty() && !frame.wires[0].nodes.empty()) {
        const Vec3 forward = camera.forward();
        camera.target = frame.wires[0].nodes[0];
        camera.eye = camera.target - 0.5 * motion.follow / (std::tan(0.5 * camera.fov_y) * key.zoom) * forward;
    }
    return camera;
}

}  // namespace seldinger

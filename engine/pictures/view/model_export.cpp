// Resamples the wires of each frame and carries a frame along them, and from one time to the next.
#include "view/model_export.h"

#include "view/solids.h"

#include <glm/gtc/quaternion.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace seldinger {
namespace {

constexpr std::size_t stations = 161;

/// `count` stations at even shares of the line's length.
std::vector<TubeStation> resample(const WireLine& wire, std::size_t count)
{
    const std::vector<TubeStation> line = smooth_line(wire.nodes, wire.radius);
    std::vector<double> arc(line.size(), 0.0);
    for (std::size_t i = 1; i < line.size(); ++i) arc[i] = arc[i - 1] + (line[i].position - line[i - 1].position).norm();
    std::vector<TubeStation> out;
    std::size_t k = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double s = arc.back() * static_cast<double>(i) / static_cast<double>(count - 1);
        while (k + 2 < line.size() && arc[k + 1] < s) ++k;
        if (line.size() < 2) {
            out.push_back(line.front());
            continue;
        }
        const double t = arc[k + 1] > arc[k] ? std::clamp((s - arc[k]) / (arc[k + 1] - arc[k]), 0.0, 1.0) : 0.0;
        out.push_back(
            {(1 - t) * line[k].position + t * line[k + 1].position, (1 - t) * line[k].radius + t * line[k + 1].radius, 0});
    }
    return out;
}

glm::dvec3 to_dvec3(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// @param side  where the first station's x points, about; carried on to the next frame
std::vector<AnimatedTube::Pose> poses_of(const std::vector<TubeStation>& line, Vec3& side,
                                         const std::vector<AnimatedTube::Pose>* before)
{
    std::vector<AnimatedTube::Pose> poses;
    Vec3 axis = Vec3::UnitZ(), x = side;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const Vec3 along = line[std::min(i + 1, line.size() - 1)].position - line[i > 0 ? i - 1 : 0].position;
        if (along.squaredNorm() > 0) axis = along.normalized();
        x -= x.dot(axis) * axis;
        if (!(x.norm() > 1e-3)) x = axis.unitOrthogonal();
        x.normalize();
        if (i == 0) side = x;
        const glm::dquat turn = glm::quat_cast(glm::dmat3(to_dvec3(x), to_dvec3(axis.cross(x)), to_dvec3(axis)));
        std::array<double, 4> q = {turn.x, turn.y, turn.z, turn.w};
        // the nearer of q and -q, so that programs do not turn the long way round between two frames
        if (before && std::inner_product(q.begin(), q.end(), (*before)[i].turn.begin(), 0.0) < 0)
            for (double& component : q) component = -component;
        poses.push_back({line[i].position, q});
    }
    return poses;
}

}  // namespace

AnimatedModel animated_model(const RunFolder& run, const FrameRange& range, const PatientAxes& patient)
{
    AnimatedModel model;
    model.left = patient.left(), model.back = patient.back, model.head = patient.head;
    model.vertices = run.wall.vertices, model.triangles = run.wall.triangles;
    std::map<std::string, Vec3> sides;
    bool touched = false;
    for (std::size_t f = range.first; f <= range.last; ++f) {
        const WireFrame frame = read_frame(run, f);
        model.times.push_back(frame.time);
        for (std::size_t k = 0; k < frame.wires.size(); ++k) {
            if (model.tubes.size() <= k)
                model.tubes.push_back({frame.wires[k].name.empty() ? "wire" : frame.wires[k].name, {}, {}});
            AnimatedTube& tube = model.tubes[k];
            const std::vector<TubeStation> line = resample(frame.wires[k], stations);
            if (tube.radius.empty())
                for (const TubeStation& s : line) tube.radius.push_back(s.radius);
            Vec3& side = sides.try_emplace(tube.name, Vec3::UnitX()).first->second;
            tube.poses.push_back(poses_of(line, side, tube.poses.empty() ? nullptr : &tube.poses.back()));
        }
        model.contacts.emplace_back(), model.contact_forces.emplace_back();
        for (const ContactMark& c : frame.contacts)
            model.contacts.back().push_back(c.point), model.contact_forces.back().push_back(c.force);
        touched = touched || !frame.contacts.empty();
    }
    if (!touched) model.contacts.clear(), model.contact_forces.clear();
    return model;
}

}  // namespace seldinger

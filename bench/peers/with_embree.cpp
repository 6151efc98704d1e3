// Embree 3: triangles as its own, point queries with the bounding sphere of the capsule; or both sides as user geometry and
// rtcCollide.
#include "exact.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

namespace peers {

namespace {

struct Asked {
    const Problem* problem;
    std::size_t query;
    std::vector<std::uint32_t>* found = nullptr;
    double best2 = std::numeric_limits<double>::infinity();
};

bool collect(RTCPointQueryFunctionArguments* args)
{
    auto& asked = *static_cast<Asked*>(args->userPtr);
    if (within(*asked.problem, asked.problem->capsules[asked.query], args->primID)) asked.found->push_back(args->primID);
    return false;
}

bool radius_reduction(RTCPointQueryFunctionArguments* args)
{
    auto& asked = *static_cast<Asked*>(args->userPtr);
    seldinger::vec3 point;
    const double d2 = nearest_point(*asked.problem, asked.problem->points[asked.query], args->primID, &point);
    if (d2 >= asked.best2) return false;
    asked.best2 = d2;
    args->query->radius = std::nextafter(static_cast<float>(std::sqrt(d2)), std::numeric_limits<float>::infinity());
    return true;
}

struct Boxes {  // of user geometry
    const Problem* problem;
    bool capsules;
};

void bounds_of(const RTCBoundsFunctionArguments* args)
{
    const auto& boxes = *static_cast<const Boxes*>(args->geometryUserPtr);
    float lo[3], hi[3];
    for (int d = 0; d < 3; ++d) {
        if (boxes.capsules) {
            const Capsule& c = boxes.problem->capsules[args->primID];
            lo[d] = std::nextafter(static_cast<float>(std::min(c.a[d], c.b[d]) - c.radius), -1e30f);
            hi[d] = std::nextafter(static_cast<float>(std::max(c.a[d], c.b[d]) + c.radius), 1e30f);
        } else {
            const float* v = &boxes.problem->tree->vertices[9 * std::size_t{args->primID} + static_cast<std::size_t>(d)];
            lo[d] = std::min({v[0], v[3], v[6]});
            hi[d] = std::max({v[0], v[3], v[6]});
        }
    }
    *args->bounds_o = {lo[0], lo[1], lo[2], 0, hi[0], hi[1], hi[2], 0};
}

struct Pairs {
    const Problem* problem;
    Sets* out;
    std::mutex* locks;  // one per query modulo 64: collisions of one query may come from both threads
};

void collide_pairs(void* user, RTCCollision* pairs, unsigned count)
{
    const auto& p = *static_cast<Pairs*>(user);
    for (unsigned k = 0; k < count; ++k) {
        const unsigned query = pairs[k].primID0, t = pairs[k].primID1;
        if (!within(*p.problem, p.problem->capsules[query], t)) continue;
        const std::lock_guard lock(p.locks[query % 64]);
        (*p.out)[query].push_back(t);
    }
}

class Embree final : public Peer {
public:
    explicit Embree(bool collide) : collide_(collide), device_(rtcNewDevice("threads=2"))
    {
        name = collide ? "Embree rtcCollide" : "Embree point query";
    }
    ~Embree() override
    {
        if (scene_) rtcReleaseScene(scene_);
        if (queries_) rtcReleaseScene(queries_);
        rtcReleaseDevice(device_);
    }
    void build(const Problem& problem) override
    {
        for (RTCScene* scene : {&scene_, &queries_})
            if (*scene) rtcReleaseScene(*scene), *scene = nullptr;
        mesh_boxes_ = {&problem, false};
        capsule_boxes_ = {&problem, true};
        scene_ = rtcNewScene(device_);
        if (collide_) {
            attach(scene_, problem.triangles(), &mesh_boxes_);
        } else {
            RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
            const auto& v = problem.tree->vertices;
            float* to = static_cast<float*>(
                rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), v.size() / 3));
            std::copy(v.begin(), v.end(), to);
            auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                         3 * sizeof(unsigned), problem.triangles()));
            for (unsigned k = 0; k < 3 * problem.triangles(); ++k) index[k] = k;
            rtcCommitGeometry(mesh);
            rtcAttachGeometry(scene_, mesh);
            rtcReleaseGeometry(mesh);
        }
        rtcCommitScene(scene_);
    }
    [[nodiscard]] bool has_nearest() const override { return !collide_; }
    void sets(const Problem& problem, Sets& out) override
    {
        for (auto& set : out) set.clear();
        if (collide_) {
            if (queries_) rtcReleaseScene(queries_);  // the wire's tree is new at every step: part of the query
            queries_ = rtcNewScene(device_);
            attach(queries_, problem.capsules.size(), &capsule_boxes_);
            rtcCommitScene(queries_);
            static std::mutex locks[64];
            Pairs pairs{&problem, &out, locks};
            rtcCollide(queries_, scene_, collide_pairs, &pairs);
            return;
        }
        on_two_threads(problem.capsules.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const Capsule& c = problem.capsules[k];
                double half2 = 0;
                for (int d = 0; d < 3; ++d) half2 += (c.b[d] - c.a[d]) * (c.b[d] - c.a[d]) / 4;
                Asked asked{&problem, k, &out[k]};
                ask({(c.a[0] + c.b[0]) / 2, (c.a[1] + c.b[1]) / 2, (c.a[2] + c.b[2]) / 2},
                    (std::sqrt(half2) + c.radius) * (1 + 1e-5), collect, asked);
            }
        });
    }
    void nearest(const Problem& problem, Distances& out) override
    {
        on_two_threads(problem.points.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                Asked asked{&problem, k};
                ask(problem.points[k], 1.0, radius_reduction, asked);
                out[k] = std::sqrt(asked.best2);
            }
        });
    }

private:
    void attach(RTCScene scene, std::size_t count, Boxes* boxes)
    {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
        rtcSetGeometryUserData(geometry, boxes);
        rtcSetGeometryBoundsFunction(geometry, bounds_of, nullptr);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    void ask(const std::array<double, 3>& at, double radius, RTCPointQueryFunction callback, Asked& asked)
    {
        RTCPointQuery query;
        query.x = static_cast<float>(at[0]);
        query.y = static_cast<float>(at[1]);
        query.z = static_cast<float>(at[2]);
        query.radius = static_cast<float>(radius);
        query.time = 0;
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        rtcPointQuery(scene_, &query, &context, callback, &asked);
    }
    bool collide_;
    RTCDevice device_;
    RTCScene scene_ = nullptr, queries_ = nullptr;
    Boxes mesh_boxes_{}, capsule_boxes_{};
};

}  // namespace

std::unique_ptr<Peer> make_embree(bool collide) { return std::make_unique<Embree>(collide); }

}  // namespace peers

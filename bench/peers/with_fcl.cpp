// FCL: its OBB tree in double and GJK, capsule against mesh; distance of a tiny sphere for the nearest point.
#include "peers.h"

#include <fcl/fcl.h>

#include <algorithm>
#include <cmath>

namespace peers {

namespace {

using Model = fcl::BVHModel<fcl::OBBd>;
using DistanceModel = fcl::BVHModel<fcl::RSSd>;  // distances go by these

template <class M>
std::shared_ptr<M> make_model(const Problem& problem)
{
    auto model = std::make_shared<M>();
    std::vector<fcl::Vector3d> vertices;
    std::vector<fcl::Triangle> triangles;
    const auto& v = problem.tree->vertices;
    for (std::size_t k = 0; k < v.size(); k += 3) vertices.emplace_back(v[k], v[k + 1], v[k + 2]);
    for (std::size_t t = 0; t < problem.triangles(); ++t) triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
    model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    model->addSubModel(vertices, triangles);
    model->endModel();
    return model;
}

class Fcl final : public Peer {
public:
    Fcl() { name = "FCL OBB + GJK"; }
    void build(const Problem& problem) override
    {
        distance_model_.reset();
        model_ = make_model<Model>(problem);
    }
    [[nodiscard]] double share() const override { return 0.2; }
    void sets(const Problem& problem, Sets& out) override
    {
        const fcl::Transform3d identity = fcl::Transform3d::Identity();
        on_two_threads(out.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                out[k].clear();
                const Capsule& c = problem.capsules[k];
                const fcl::Vector3d a(c.a[0], c.a[1], c.a[2]), b(c.b[0], c.b[1], c.b[2]);
                const fcl::Capsuled capsule(c.radius, (b - a).norm());
                fcl::Transform3d at = fcl::Transform3d::Identity();
                at.linear() = fcl::Quaterniond::FromTwoVectors(fcl::Vector3d::UnitZ(), b - a).toRotationMatrix();
                at.translation() = (a + b) / 2;
                fcl::CollisionRequestd request;
                request.num_max_contacts = 1u << 20;
                fcl::CollisionResultd result;
                fcl::collide(model_.get(), identity, &capsule, at, request, result);
                for (std::size_t i = 0; i < result.numContacts(); ++i)
                    out[k].push_back(static_cast<std::uint32_t>(result.getContact(i).b1));
            }
        });
    }
    void nearest(const Problem& problem, Distances& out) override
    {
        if (!distance_model_) distance_model_ = make_model<DistanceModel>(problem);
        const fcl::Transform3d identity = fcl::Transform3d::Identity();
        on_two_threads(out.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const fcl::Sphered ball(1e-9);
                fcl::Transform3d at = fcl::Transform3d::Identity();
                at.translation() = fcl::Vector3d(problem.points[k][0], problem.points[k][1], problem.points[k][2]);
                fcl::DistanceRequestd request;
                fcl::DistanceResultd result;
                fcl::distance(distance_model_.get(), identity, &ball, at, request, result);
                out[k] = result.min_distance + 1e-9;
            }
        });
    }

private:
    std::shared_ptr<Model> model_;
    std::shared_ptr<DistanceModel> distance_model_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl() { return std::make_unique<Fcl>(); }

}  // namespace peers

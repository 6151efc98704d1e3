// Bullet: its quantised tree finds triangles in the capsule's box, the exact test is ours. It has no nearest-point query on a
// mesh.
#include "exact.h"

#include <btBulletCollisionCommon.h>

#include <algorithm>

namespace peers {

namespace {

constexpr std::size_t most_in_a_part = 2000000;  // 2^21 - 1 triangles is what its node index holds

struct Collect final : btTriangleCallback {
    const Problem& problem;
    const Capsule& capsule;
    const std::uint32_t first;
    std::vector<std::uint32_t>& out;
    Collect(const Problem& p, const Capsule& c, std::uint32_t f, std::vector<std::uint32_t>& o)
        : problem(p), capsule(c), first(f), out(o)
    {
    }
    void processTriangle(btVector3*, int, int index) override
    {
        const auto t = first + static_cast<std::uint32_t>(index);
        if (within(problem, capsule, t)) out.push_back(t);
    }
};

struct Part {
    std::uint32_t first;
    std::unique_ptr<btTriangleIndexVertexArray> mesh;
    std::unique_ptr<btBvhTriangleMeshShape> shape;
};

class Bullet final : public Peer {
public:
    Bullet() { name = "Bullet tree"; }
    void build(const Problem& problem) override
    {
        parts_.clear();
        indices_.resize(3 * std::min(problem.triangles(), most_in_a_part));
        for (std::size_t k = 0; k < indices_.size(); ++k) indices_[k] = static_cast<int>(k);
        for (std::size_t first = 0; first < problem.triangles(); first += most_in_a_part) {
            const auto count = static_cast<int>(std::min(most_in_a_part, problem.triangles() - first));
            Part part;
            part.first = static_cast<std::uint32_t>(first);
            auto* vertices = const_cast<float*>(&problem.tree->vertices[9 * first]);
            part.mesh = std::make_unique<btTriangleIndexVertexArray>();
            btIndexedMesh piece;
            piece.m_numTriangles = count;
            piece.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(indices_.data());
            piece.m_triangleIndexStride = 3 * sizeof(int);
            piece.m_numVertices = 3 * count;
            piece.m_vertexBase = reinterpret_cast<const unsigned char*>(vertices);
            piece.m_vertexStride = 3 * sizeof(float);
            piece.m_vertexType = PHY_FLOAT;
            part.mesh->addIndexedMesh(piece, PHY_INTEGER);
            part.shape = std::make_unique<btBvhTriangleMeshShape>(part.mesh.get(), true);
            parts_.push_back(std::move(part));
        }
    }
    [[nodiscard]] bool has_nearest() const override { return false; }
    void nearest(const Problem&, Distances&) override {}
    void sets(const Problem& problem, Sets& out) override
    {
        on_two_threads(problem.capsules.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                out[k].clear();
                const Capsule& c = problem.capsules[k];
                btVector3 lo, hi;
                for (int d = 0; d < 3; ++d) {
                    lo[d] = static_cast<btScalar>(std::min(c.a[d], c.b[d]) - c.radius * (1 + 1e-6));
                    hi[d] = static_cast<btScalar>(std::max(c.a[d], c.b[d]) + c.radius * (1 + 1e-6));
                }
                for (const Part& part : parts_) {
                    Collect collect(problem, c, part.first, out[k]);
                    part.shape->processAllTriangles(&collect, lo, hi);
                }
            }
        });
    }

private:
    std::vector<int> indices_;
    std::vector<Part> parts_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet() { return std::make_unique<Bullet>(); }

}  // namespace peers

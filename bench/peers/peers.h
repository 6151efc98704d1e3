#pragma once
// Queries for every library: the same queries on the same rounded mesh (the float32 vertices that the wall's tree holds, in its
// centre's frame), the same two threads, answers in the same form.

#include "vessel/tree.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace peers {

struct Capsule {
    std::array<double, 3> a, b;
    double radius;
};

struct Problem {
    const seldinger::WallTree* tree = nullptr;  // vertices [9 T] float; what every library is given
    std::vector<Capsule> capsules;
    std::vector<std::array<double, 3>> points;
    [[nodiscard]] std::size_t triangles() const { return tree->triangle_count(); }
};

/// Triangles in leaf order, in any order within a query.
using Sets = std::vector<std::vector<std::uint32_t>>;
using Distances = std::vector<double>;

struct Peer {
    std::string name;
    virtual ~Peer() = default;
    /// All work that is done once per mesh; its time is `build`.
    virtual void build(const Problem& problem) = 0;
    /// Empty: the library has no such query.
    virtual bool has_sets() const { return true; }
    virtual bool has_nearest() const { return true; }
    virtual void sets(const Problem& problem, Sets& out) = 0;
    virtual void nearest(const Problem& problem, Distances& out) = 0;
    /// How much of the queries to ask: slow ones get a part.
    virtual double share() const { return 1; }
};

/// body(begin, end) on two threads, in chunks.
inline void on_two_threads(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body)
{
    constexpr std::size_t chunk = 16;
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t k = next.fetch_add(chunk); k < count; k = next.fetch_add(chunk)) body(k, std::min(k + chunk, count));
    };
    std::thread helper(work);
    work();
    helper.join();
}

std::unique_ptr<Peer> make_ours(bool float32);
std::unique_ptr<Peer> make_embree(bool collide);
std::unique_ptr<Peer> make_cgal();
std::unique_ptr<Peer> make_bullet();
std::unique_ptr<Peer> make_fcl();

}  // namespace peers

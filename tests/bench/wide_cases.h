// Tests of bench/wide/wide_walk.h, compiled in double and in float like host_reference_cases.h: the walks against loops over all
// triangles one by one, and their kernels against the walks.
#include "contact/host_reference_names.h"
#include "wide/wide_walk.h"

#include <algorithm>
#include <random>

namespace {

struct WideScene {
    const sel_reference::ReferenceWall& wall = sel_reference::reference_wall();
    std::vector<WideNode> nodes;
    const std::vector<float>& vertices = sel_reference::wide_wall().vertices;
    std::mt19937 rng{13};

    WideScene()
    {
        const auto& bytes = sel_reference::wide_wall().nodes;
        nodes.resize(bytes.size() / sizeof(WideNode));
        std::memcpy(nodes.data(), bytes.data(), bytes.size());
    }
    real draw(double lo, double hi) { return static_cast<real>(std::uniform_real_distribution<double>(lo, hi)(rng)); }
    /// At the wall, within the tube, on a vertex, or ten times its length away.
    vec3 point(std::size_t k)
    {
        if (k % 4 == 1) {
            const float* v = &wall.vertices[3 * std::uniform_int_distribution<std::size_t>(0, 3 * wall.triangles - 1)(rng)];
            return make_vec3(v[0], v[1], v[2]);
        }
        const double far = k % 16 == 2 ? 20 : 1;
        const double x = far * draw(-0.6, 0.6) * wall.length, angle = draw(0, 6.283),
                     rho = far * wall.radius * (k % 4 == 3 ? draw(0, 1) : draw(0.9, 1.02));
        return make_vec3(static_cast<real>(x), static_cast<real>(rho * std::cos(angle)),
                         static_cast<real>(rho * std::sin(angle)));
    }
    CapsuleQuery capsule(std::size_t k)
    {
        const vec3 a = point(k);
        const real length = k % 5 ? draw(0, 0.005) : 0, angle = draw(0, 6.283), slope = draw(-1, 1);
        return {{a.x, a.y, a.z},
                {a.x + length * std::cos(angle), a.y + length * std::sin(angle), a.z + length * slope},
                k % 7 ? draw(1e-4, 1e-3) : 0,
                0};
    }
};

void nearest_case()
{
    WideScene s;
    std::size_t flat = 0;
    for (uint t = 0; t < s.wall.triangles; ++t) {
        const vec3 n = triangle_normal(load_triangle(s.wall.vertices.data(), t, make_vec3(0, 0, 0)));
        flat += dot3(n, n) == 0;
    }
    REQUIRE(flat > 50);  // what closest_on_triangles8() leaves to closest_on_triangle()
    for (std::size_t k = 0; k < 600; ++k) {
        const vec3 p = s.point(k);
        real least = static_cast<real>(1e30);
        for (uint t = 0; t < s.wall.triangles; ++t) {
            int feature;
            const vec3 v = p - closest_on_triangle(p, load_triangle(s.wall.vertices.data(), t, make_vec3(0, 0, 0)), &feature);
            least = std::min(least, dot3(v, v));
        }
        vec3 closest;
        const uint t = find_nearest(p, s.nodes.data(), s.vertices.data(), &closest);
        const vec3 v = p - closest;
        // the same operations on the same numbers: equal to the bit
        CHECK(dot3(v, v) == least);
        const Triangle tri = load_triangle(s.wall.vertices.data(), t, make_vec3(0, 0, 0));
        int feature;
        const vec3 w = p - closest_on_triangle(p, tri, &feature);
        CHECK(dot3(w, w) == least);
    }
}

void within_case()
{
    WideScene s;
    const real tolerance = static_cast<real>(float32 ? 1e-6 : 1e-12);  // [m], of coordinates up to 0.3 m
    std::size_t found_in_all = 0, apart = 0;
    for (std::size_t k = 0; k < 600; ++k) {
        const CapsuleQuery q = s.capsule(k);
        const vec3 a = make_vec3(q.a[0], q.a[1], q.a[2]), u = make_vec3(q.b[0], q.b[1], q.b[2]) - a;
        std::vector<uint> expected, found(s.wall.triangles);
        for (uint t = 0; t < s.wall.triangles; ++t)
            if (segment_within(a, u, load_triangle(s.wall.vertices.data(), t, make_vec3(0, 0, 0)), q.radius * q.radius))
                expected.push_back(t);
        const uint count = find_within(q, s.nodes.data(), s.vertices.data(), static_cast<uint>(found.size()), found.data());
        REQUIRE(count <= found.size());
        found.resize(count);
        std::sort(found.begin(), found.end());
        std::vector<uint> differ;
        std::set_symmetric_difference(found.begin(), found.end(), expected.begin(), expected.end(), std::back_inserter(differ));
        CAPTURE(k);
        for (const uint t : differ) {
            const Triangle tri = load_triangle(s.wall.vertices.data(), t, make_vec3(0, 0, 0));
            CHECK(std::abs(std::sqrt(segment_triangle_distance2(a, u, tri)) - q.radius) <= tolerance);
        }
        found_in_all += expected.size();
        apart += differ.size();
        // the number is the same where they do not fit, and what fits is
        uint few[4] = {};
        CHECK(find_within(q, s.nodes.data(), s.vertices.data(), 3, few) == count);
        CHECK(few[3] == 0);
    }
    REQUIRE(found_in_all > 5000);
    CHECK(apart < found_in_all / 100);
}

void kernels_case()
{
    sel_device::Context& context = sel_reference::reference_context(float32);
    (void)sel_reference::wide_wall();  // makes the kernels known
    sel_device::Kernel nearest(context, "wide/queries.cl", "query_nearest"), capsule(context, "wide/queries.cl", "query_capsule");
    for (const Queue lane : {Queue::Inline, Queue::Pool})
        for (const std::size_t n : {1, 63, 64, 65, 257}) {
            WideScene s;
            constexpr uint slots = 40;
            std::vector<real> points, closest;
            std::vector<CapsuleQuery> queries;
            std::vector<uint> triangles, found(n * slots), counts;
            for (std::size_t k = 0; k < n; ++k) {
                const vec3 p = s.point(k);
                vec3 c;
                triangles.push_back(find_nearest(p, s.nodes.data(), s.vertices.data(), &c));
                points.insert(points.end(), {p.x, p.y, p.z});
                closest.insert(closest.end(), {c.x, c.y, c.z});
                queries.push_back(s.capsule(k));
                counts.push_back(find_within(queries[k], s.nodes.data(), s.vertices.data(), slots, &found[k * slots]));
            }
            Guarded<WideNode> nodes(context, lane, s.nodes);
            Guarded<float> vertices(context, lane, s.vertices);
            Guarded<real> at(context, lane, points), to(context, lane, std::vector<real>(3 * n));
            Guarded<CapsuleQuery> asked(context, lane, queries);
            Guarded<uint> on(context, lane, std::vector<uint>(n)), list(context, lane, std::vector<uint>(n * slots)),
                counted(context, lane, std::vector<uint>(n));
            nearest.launch(lane, n, static_cast<uint>(n), at.buffer(), nodes.buffer(), vertices.buffer(), to.buffer(),
                           on.buffer());
            capsule.launch(lane, n, static_cast<uint>(n), slots, asked.buffer(), nodes.buffer(), vertices.buffer(), list.buffer(),
                           counted.buffer());
            CAPTURE(n);
            CHECK(first_difference(to.read(), closest) == -1);
            CHECK(first_difference(on.read(), triangles) == -1);
            CHECK(first_difference(list.read(), found) == -1);
            CHECK(first_difference(counted.read(), counts) == -1);
        }
}

}  // namespace

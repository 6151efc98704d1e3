// The limit surface of Loop subdivision: its functions, derivatives, rims, and the closest point.
#include "core/error.h"
#include "shapes/subdivide.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "surface/loop_surface.h"
#include "wall/wall_fixtures.h"

namespace seldinger::test::test_loop_surface {

namespace {

double from_axis(const Vec3& p) { return std::hypot(p.x(), p.y()); }

/// A bumpy sheet of valences 5 to 7, with four corners.
WallMesh bumpy_sheet()
{
    WallMesh mesh = grid(8, 7, [](double u, double v) { return Vec3(u, v, 0.1 * std::sin(3 * u) * std::cos(4 * v)); });
    flip_edges(mesh, 0.3, 5);
    return mesh;
}

/// Tube of valences 5 to 7, with smooth rims.
WallMesh bumpy_tube(int around = 9)
{
    WallMesh mesh = tube(1, 4, around, 10);
    flip_edges(mesh, 0.3, 7);
    std::mt19937 random(3);
    for (Vec3& x : mesh.vertices)
        for (const int c : {2, 1, 0}) x[c] += 0.05 * (random() % 1000 / 1e3);
    return mesh;
}

std::vector<std::pair<double, double>> places()
{
    std::vector<std::pair<double, double>> p = {{0, 0},   {1, 0},   {0, 1},       {0.5, 0.5},
                                                {0.5, 0}, {0, 0.5}, {1e-4, 2e-4}, {0.25, 0.25}};
    std::mt19937 random(1);
    for (int k = 0; k < 20; ++k) {
        double u = random() % 1000 / 1e3, v = random() % 1000 / 1e3;
        if (u + v > 1) u = 1 - u, v = 1 - v;
        p.push_back({u, v});
    }
    return p;
}

int irregular(const LoopSurface& s)
{
    int n = 0;
    for (int v = 0; v < s.topology().vertex_count(); ++v) n += !s.topology().regular(v);
    return n;
}

}  // namespace

TEST_SUITE("surface/loop_surface")
{
    TEST_CASE("property: weights sum to 1, derivatives to 0, everywhere")
    {
        for (const WallMesh& mesh : {bumpy_sheet(), bumpy_tube(), ball(1, 1), tube(1, 3, 3, 4)}) {
            const LoopSurface s(mesh);
            LoopCurvedStencil c;
            for (int t = 0; t < int(mesh.triangles.size()); ++t)
                for (const auto& [u, v] : places()) {
                    s.basis(t, u, v, c);
                    double sum[6] = {};
                    for (int k = 0; k < c.size; ++k) {
                        sum[0] += c.n[k], sum[1] += c.n_u[k], sum[2] += c.n_v[k];
                        sum[3] += c.n_uu[k], sum[4] += c.n_uv[k], sum[5] += c.n_vv[k];
                    }
                    REQUIRE(sum[0] == about(1).epsilon(1e-13));
                    for (int i = 1; i < 6; ++i) REQUIRE(std::abs(sum[i]) < (i < 3 ? 1e-10 : 1e-6));  // rounding times 2^depth
                }
        }
    }

    TEST_CASE("analytic: a flat lattice is reproduced, quadratic height to second derivatives")
    {
        // box splines of this order hold quadratics; control heights of x^2 give x^2 + 1/4 edge^2 on the lattice below
        WallMesh mesh = grid(8, 8, [](double u, double v) { return Vec3(u, v, u * u - 2 * u * v + 3 * v * v); });
        const LoopSurface s(mesh);
        for (int t = 0; t < int(mesh.triangles.size()); ++t) {
            const Vec3 centre = (mesh.vertices[mesh.triangles[t][0]] + mesh.vertices[mesh.triangles[t][1]] +
                                 mesh.vertices[mesh.triangles[t][2]]) /
                                3;
            if ((centre - Vec3(0.5, 0.5, centre.z())).cwiseAbs().maxCoeff() > 0.3) continue;
            LoopCurvedStencil c;
            s.basis(t, 0.3, 0.2, c);
            Vec3 x = Vec3::Zero(), uu = x, uv = x, vv = x, xu = x, xv = x;
            for (int k = 0; k < c.size; ++k) {
                const Vec3& p = mesh.vertices[c.vertex[k]];
                x += c.n[k] * p, xu += c.n_u[k] * p, xv += c.n_v[k] * p, uu += c.n_uu[k] * p, uv += c.n_uv[k] * p,
                    vv += c.n_vv[k] * p;
            }
            const auto height = [](const Vec3& a, const Vec3& b) {  // bilinear form of the quadratic
                return a.x() * b.x() - a.x() * b.y() - a.y() * b.x() + 3 * a.y() * b.y();
            };
            CHECK(from_axis(uu) + from_axis(uv) + from_axis(vv) < 1e-12);
            const double scale = height(xu, xu) + height(xv, xv);  // the mixed one may vanish
            CHECK(scale > 0);
            CHECK(std::abs(uu.z() - 2 * height(xu, xu)) < 1e-10 * scale);
            CHECK(std::abs(uv.z() - 2 * height(xu, xv)) < 1e-10 * scale);
            CHECK(std::abs(vv.z() - 2 * height(xv, xv)) < 1e-10 * scale);
        }
    }

    TEST_CASE("property: derivatives are those of the surface, by differences")
    {
        for (const WallMesh& mesh : {bumpy_sheet(), bumpy_tube(), ball(1, 1)}) {
            const LoopSurface s(mesh);
            REQUIRE(irregular(s) > 5);
            const auto sum = [&](const LoopCurvedStencil& c, const std::array<double, LoopStencil::capacity>& w) {
                Vec3 x = Vec3::Zero();
                for (int k = 0; k < c.size; ++k) x += w[k] * mesh.vertices[c.vertex[k]];
                return x;
            };
            LoopCurvedStencil c, a, b;
            for (int t = 0; t < int(mesh.triangles.size()); ++t)
                for (const auto& [u, v] : {std::pair(0.21, 0.33), {0.05, 0.07}, {0.9, 0.04}, {0.3, 0.6}}) {
                    const double h = 1e-5;
                    s.basis(t, u, v, c);
                    s.basis(t, u + h, v, a), s.basis(t, u - h, v, b);
                    CHECK((sum(c, c.n_u) - (sum(a, a.n) - sum(b, b.n)) / (2 * h)).norm() < 1e-7);
                    CHECK((sum(c, c.n_uu) - (sum(a, a.n_u) - sum(b, b.n_u)) / (2 * h)).norm() < 1e-6);
                    CHECK((sum(c, c.n_uv) - (sum(a, a.n_v) - sum(b, b.n_v)) / (2 * h)).norm() < 1e-6);
                    s.basis(t, u, v + h, a), s.basis(t, u, v - h, b);
                    CHECK((sum(c, c.n_v) - (sum(a, a.n) - sum(b, b.n)) / (2 * h)).norm() < 1e-7);
                    CHECK((sum(c, c.n_vv) - (sum(a, a.n_v) - sum(b, b.n_v)) / (2 * h)).norm() < 1e-6);
                }
        }
    }

    TEST_CASE("twin: subdividing the whole mesh tends to it, inside and on rims")
    {
        const WallMesh mesh = bumpy_tube();
        const LoopSurface s(mesh);
        WallMesh fine = mesh;
        constexpr int rounds = 6;
        for (int k = 0; k < rounds; ++k) fine = subdivide_loop(fine);
        // vertices after m rounds are off their limits by about edge^2 curvature 4^-m / 8 (1e-5 here), by more about
        // high valences, whose second eigenvalue is above 1/2
        double worst = 0;
        for (const auto& [u, v] : places())
            for (int t = 0; t < int(mesh.triangles.size()); ++t) {
                const Vec3 x = s.at(t, u, v).position;
                // the fine triangle: children in subdivide_loop's order
                int f = t;
                double a = u, b = v;
                for (int k = 0; k < rounds; ++k) {
                    f *= 4;
                    if (a >= 0.5) f += 1, a = 2 * a - 1, b = 2 * b;
                    else if (b >= 0.5) f += 2, a = 2 * a, b = 2 * b - 1;
                    else if (a + b < 0.5) a = 2 * a, b = 2 * b;
                    else {
                        f += 3;
                        const double w = 1 - a - b, ua = a;
                        a = 1 - 2 * w, b = 1 - 2 * ua;
                    }
                }
                const auto& tri = fine.triangles[f];
                const Vec3 y = (1 - a - b) * fine.vertices[tri[0]] + a * fine.vertices[tri[1]] + b * fine.vertices[tri[2]];
                worst = std::max(worst, (x - y).norm());
            }
        CHECK(worst < 3e-4);
    }

    TEST_CASE("property: triangles meet along edges, and in vertices")
    {
        for (const WallMesh& mesh : {bumpy_sheet(), bumpy_tube(), ball(1, 1)}) {
            const LoopSurface s(mesh);
            const auto& top = s.topology();
            const double corner[3][2] = {{0, 0}, {1, 0}, {0, 1}};
            double worst = 0, turn = 0;
            for (int h = 0; h < 3 * top.triangle_count(); ++h) {
                const int o = top.opposite[h];
                if (o < 0) continue;
                for (double f : {0.0, 1e-3, 0.1, 0.37, 0.5, 0.83}) {
                    const double *a = corner[h % 3], *b = corner[(h % 3 + 1) % 3], *c = corner[(o % 3 + 1) % 3],
                                 *d = corner[o % 3];
                    const LoopFoot x = s.at(h / 3, a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]));
                    const LoopFoot y = s.at(o / 3, c[0] + f * (d[0] - c[0]), c[1] + f * (d[1] - c[1]));
                    worst = std::max(worst, (x.position - y.position).norm());
                    if (f > 0) turn = std::max(turn, (x.normal - y.normal).norm());
                }
            }
            CHECK(worst < 1e-13);
            CHECK(turn < 1e-10);
        }
    }

    TEST_CASE("property: a plane stays flat up to its rims and corners, and linear")
    {
        WallMesh mesh = grid(6, 5, [](double u, double v) { return Vec3(2 * u + 0.3 * v, v, 0); });
        const LoopSurface s(mesh);
        // a lattice, corners included: the surface is the mesh itself, at the same weights
        double worst = 0;
        for (int t = 0; t < int(mesh.triangles.size()); ++t)
            for (const auto& [u, v] : places()) {
                const auto& tri = mesh.triangles[t];
                const Vec3 flat = (1 - u - v) * mesh.vertices[tri[0]] + u * mesh.vertices[tri[1]] + v * mesh.vertices[tri[2]];
                worst = std::max(worst, (s.at(t, u, v).position - flat).norm());
            }
        CHECK(worst < 1e-14);
    }

    TEST_CASE("property: interpolation puts a tube's surface on its radius")
    {
        // Through the vertices exactly; between them off by the fourth power of edge/R (1e-3 for 16 around). More beside rims,
        // whose phantoms bind one curvature to the other, and in the long triangles that flips leave (a chord of 0.8 R sags by
        // 0.08 R)
        for (const bool rough : {false, true}) {
            WallMesh mesh = tube(1, 4, 16, 12);
            if (rough) flip_edges(mesh, 0.1, 3);
            LoopSurface s(mesh);
            const double before = std::abs(from_axis(s.at(150, 0.3, 0.3).position) - 1);
            CHECK(s.interpolate(mesh.vertices) < 1e-10);
            LoopStencil st;
            double worst = 0;
            for (int v = 0; v < int(mesh.vertices.size()); ++v) {
                s.limit_of_vertex(v, st);
                Vec3 x = Vec3::Zero();
                for (int k = 0; k < st.size; ++k) x += st.n[k] * s.control().vertices[st.vertex[k]];
                worst = std::max(worst, (x - mesh.vertices[v]).norm());
            }
            CHECK(worst < 1e-10);
            double off = 0;
            for (int t = 0; t < int(mesh.triangles.size()); ++t)
                for (const auto& [u, v] : places()) off = std::max(off, std::abs(from_axis(s.at(t, u, v).position) - 1));
            CHECK(off < (rough ? 0.04 : 2e-3));
            CHECK(before > 0.01);
        }
    }

    TEST_CASE("property: the closest point is that of a search of everything, from nowhere and from nearby")
    {
        for (const WallMesh& mesh : {bumpy_sheet(), bumpy_tube(), ball(1, 1)}) {
            const LoopSurface s(mesh);
            std::vector<LoopFoot> all;
            for (int t = 0; t < int(mesh.triangles.size()); ++t)
                for (int j = 0; j <= 8; ++j)
                    for (int i = 0; i + j <= 8; ++i) all.push_back(s.at(t, i / 8.0, j / 8.0));
            std::mt19937 random(4);
            const auto unit = [&] { return random() % 2001 / 1000.0 - 1; };
            int rims = 0;
            for (int k = 0; k < 300; ++k) {
                const LoopFoot& from = all[random() % all.size()];
                Vec3 p = from.position;  // nearer than the centres of curvature
                for (const int c : {2, 1, 0}) p[c] += 0.05 * unit();
                LoopFoot foot;
                s.closest(p, foot);
                double best = 1e9;
                for (const LoopFoot& f : all) best = std::min(best, (f.position - p).norm());
                CHECK(foot.distance <= best + 1e-12);
                CHECK(foot.distance == about((foot.position - p).norm()));
                const Vec3 r = (p - foot.position) / std::max(foot.distance, 1e-9);
                if (!foot.rim) {
                    CHECK(std::abs(r.dot(foot.tangent_u)) < 1e-6 * foot.tangent_u.norm());
                    CHECK(std::abs(r.dot(foot.tangent_v)) < 1e-6 * foot.tangent_v.norm());
                }
                rims += foot.rim;
                LoopFoot warm = from;  // a walk of up to a triangle
                s.closest(p, warm);
                CHECK(warm.distance == about(foot.distance).epsilon(1e-6));
            }
            const bool closed = s.topology().kind[0] == LoopVertex::Inner && irregular(s) == 6;
            CHECK((closed || rims > 0));
        }
    }

    TEST_CASE("property: the foot moves smoothly with the point")
    {
        const LoopSurface s(bumpy_tube());
        LoopFoot foot;
        Vec3 last = Vec3::Zero();
        for (int k = 0; k < 4000; ++k) {
            const double a = k * 1e-3;
            const Vec3 p(0.9 * std::cos(a), 0.9 * std::sin(a), 0.7 * std::sin(2 * a));
            s.closest(p, foot);
            // steps of 1.7e-3 of p; curved towards p the foot goes faster, by less than 3 here
            if (k > 0) CHECK((foot.position - last).norm() < 5e-3);
            last = foot.position;
            // and its distance by the normal's share: d distance = -n . dp
            const double h = 1e-6;
            LoopFoot moved = foot;
            s.closest(p + h * foot.normal, moved);
            const double sign = (p - foot.position).dot(foot.normal) > 0 ? 1 : -1;
            if (foot.distance > 0.01) CHECK((moved.distance - foot.distance) / h == about(sign).epsilon(1e-3));
        }
    }

    TEST_CASE("bad input: one clear line each")
    {
        WallMesh mesh = grid(3, 3, [](double u, double v) { return Vec3(u, v, 0); });
        const auto refused = [](const WallMesh& m, const char* words) { return has(refusal([&] { LoopSurface s(m); }), words); };
        WallMesh bad = mesh;
        std::swap(bad.triangles[4][0], bad.triangles[4][1]);
        CHECK(refused(bad, "face opposite sides"));
        bad = mesh;
        bad.vertices.push_back({0.5, 0.5, 1});
        bad.triangles.push_back({bad.triangles[6][0], bad.triangles[6][1], 16});
        CHECK((refused(bad, "triangles, two at most") || refused(bad, "face opposite")));
        bad = mesh;
        bad.vertices[5] = bad.vertices[6];
        CHECK(refused(bad, "has no area"));
        bad = mesh;
        bad.vertices.push_back({0, 0, 1});
        CHECK(refused(bad, "belongs to no triangle"));
        bad = mesh;
        bad.vertices.push_back({-1, 0, 0}), bad.vertices.push_back({-1, -1, 0});
        bad.triangles.push_back({0, 16, 17});
        CHECK(refused(bad, "two sheets touch"));
        bad = mesh;
        bad.triangles[0][1] = 77;
        CHECK(refused(bad, "not there"));
        CHECK(refused(WallMesh{}, "no triangles"));
    }
}

}  // namespace seldinger::test::test_loop_surface

// Factors of K + C/h: against Eigen's, two at once, columns, symmetry, holds, and a wall that could fly away.
#include "shell/wall_patch.h"
#include "support/approx.h"
#include "wall_problem.h"

namespace seldinger::test::test_wall_compliance {

namespace {

std::vector<double> noise(std::size_t n)
{
    std::mt19937 random(9);
    std::vector<double> x(n);
    for (double& v : x) v = random() % 2001 / 1000.0 - 1;
    return x;
}

}  // namespace

TEST_SUITE("wall/wall_compliance")
{
    TEST_CASE("twin: solves of Eigen's Cholesky, at rest and in a step")
    {
        WallMesh mesh = tube(0.012, 0.06, 14, 14);
        flip_edges(mesh, 0.1, 5);
        const LoopSurface s(mesh);
        for (const bool held : {true, false})
            for (const double h : {0.0, 1e-3}) {
                CAPTURE(held);
                CAPTURE(h);
                ShellSpec spec;
                spec.rims_held = held;
                const WallCompliance wall(Shell(s, spec));
                const auto factor = wall.factor(h);
                std::vector<double> b = noise(3 * mesh.vertices.size()), x = b;
                WallSolveWork work;
                factor->solve(x, work);
                SparseMatrix m = wall.stiffness();
                if (h > 0) m += wall.damping() / h;
                for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
                    for (int a = 0; a < 3; ++a)
                        if (wall.matrices().held[v]) {
                            m.coeffRef(Eigen::Index(3 * v) + a, Eigen::Index(3 * v) + a) = 1;
                            b[3 * v + a] = 0;
                        }
                const Eigen::SimplicialLLT<SparseMatrix> llt(m);
                const Eigen::VectorXd y = llt.solve(Eigen::Map<Eigen::VectorXd>(b.data(), Eigen::Index(b.size())));
                double worst = 0, size = 0;
                for (std::size_t i = 0; i < x.size(); ++i)
                    worst = std::max(worst, std::abs(x[i] - y[i])), size = std::max(size, std::abs(y[i]));
                CHECK(worst < 1e-10 * size);  // condition about 1e4
            }
    }

    TEST_CASE("property: rows of a patch are the columns, whatever it has forgotten in between")
    {
        const LoopSurface s(tube(0.012, 0.06, 12, 12));
        const WallCompliance wall(Shell(s, ShellSpec{}));
        const auto factor = wall.factor(1e-3);
        WallPatch patch(wall.vertex_count());
        patch.use(factor);
        const auto ask = [&](int first, int last) {
            for (int v = last; v-- > first;)
                if (const int slot = patch.slot(v); v % 3 == 0) patch.provide(slot);
        };
        ask(0, wall.vertex_count());
        patch.trim();
        ask(20, 60);
        patch.trim();  // forgets all others
        ask(50, 80);
        for (const int from : {21, 57, 75, 100}) {
            patch.provide(patch.slot(from));
            const std::span<const float> columns = factor->columns(from);
            for (const int at : {20, 21, 59, 79, 101})
                for (int r = 0; r < 3; ++r)
                    for (int c = 0; c < 3; ++c) {
                        const int slot = patch.slot(at);
                        CHECK(patch.block(patch.slot(from), slot)[3 * r + c] ==
                              columns[columns.size() / 3 * static_cast<std::size_t>(r) + static_cast<std::size_t>(3 * at + c)]);
                    }
        }
    }

    TEST_CASE("property: two at once, columns and repeated factors give the same bits")
    {
        const LoopSurface s(tube(0.012, 0.06, 12, 12));
        const Shell shell(s, ShellSpec{});
        const WallCompliance wall(shell), again(shell);
        const auto factor = wall.factor(1e-3);
        CHECK(wall.factor(1e-3) == factor);
        const std::size_t n = static_cast<std::size_t>(3 * wall.vertex_count());
        std::vector<double> a = noise(n), b(a.rbegin(), a.rend()), c = a, d = b;
        WallSolveWork work;
        factor->solve(a, work);
        factor->solve(b, work);
        factor->solve(c, d, work);
        CHECK(a == c);
        CHECK(b == d);
        std::vector<double> e = noise(n);
        again.factor(1e-3)->solve(e, work);
        CHECK(a == e);

        const int v = 70, w = 95;
        std::vector<double> unit(n, 0);
        unit[3 * v + 1] = 1;
        factor->solve(unit, work);
        const auto columns = factor->columns(v);
        REQUIRE(columns.size() == 3 * n);
        CHECK(std::equal(unit.begin(), unit.end(), columns.begin() + std::ptrdiff_t(n),
                         [](double whole, float kept) { return float(whole) == kept; }));
        CHECK(columns.data() == factor->columns(v).data());
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                CHECK(columns[i * n + 3 * w + j] == about(factor->columns(w)[j * n + 3 * v + i]).epsilon(1e-9));
        // held: nothing moves it and it moves nothing
        for (const double x : factor->columns(0)) REQUIRE(x == 0);
        CHECK(columns[0] == 0);
    }

    TEST_CASE("property: small steps give way less, and all of it in time")
    {
        const LoopSurface s(tube(0.012, 0.06, 12, 12));
        const WallCompliance wall(Shell(s, ShellSpec{}));
        const int v = 78;
        double before = wall.factor(0)->columns(v)[3 * v];
        CHECK(wall.factor(1e3)->columns(v)[3 * v] == about(before).epsilon(1e-4));
        for (const double h : {1e-1, 1e-2, 1e-3}) {
            const double now = wall.factor(h)->columns(v)[3 * v];
            CHECK(now > 0);
            CHECK(now < before);
            before = now;
        }
    }

    TEST_CASE("bad input: neither support nor rims that hold")
    {
        const LoopSurface s(tube(0.012, 0.06, 12, 12));
        ShellSpec spec;
        spec.support = 0, spec.rims_held = false;
        const WallCompliance free{Shell(s, spec)};
        CHECK_FALSE(free.factor(0));
        CHECK(free.factor(1e-3));  // the tissue's damping holds it for a step
        spec.rims_held = true;
        CHECK(WallCompliance(Shell(s, spec)).factor(0));
        const LoopSurface closed(ball(0.012, 2));
        CHECK_FALSE(WallCompliance(Shell(closed, spec)).factor(0));
    }

    // Without tissue K + C/h = (1 + tau/h) K_e + p K_1, and p_c is where K_e + p_c K_1 becomes singular. So n p_c are borne in
    // steps shorter than tau/(n - 1). Tolerance: p_c is bisected to 1e-6 of itself.
    TEST_CASE("analytic: n times the pressure that buckles a wall at rest is borne in steps shorter than tau/(n - 1)")
    {
        const LoopSurface s(tube(0.012, 0.06, 12, 12));
        const auto under = [&](double pressure) {
            ShellSpec spec{.support = 0, .support_damping = 0, .relaxation = 0.02, .pressure = pressure};
            return std::make_unique<WallCompliance>(Shell(s, spec), [](const Vec3&) { return Prestress{Vec3::UnitZ(), 0.012}; });
        };
        double borne = 0, buckles = -1e6;
        REQUIRE(under(borne)->factor(0));
        REQUIRE_FALSE(under(buckles)->factor(0));
        while (borne - buckles > 1e-6 * -buckles) {
            const double middle = (borne + buckles) / 2;
            (under(middle)->factor(0) ? borne : buckles) = middle;
        }
        for (const double n : {1.5, 3.0, 20.0}) {
            CAPTURE(n);
            const auto wall = under(n * buckles);
            const double longest = 0.02 / (n - 1);
            CHECK(wall->factor(0.9999 * longest));
            CHECK_FALSE(wall->factor(1.0001 * longest));
            CHECK_FALSE(wall->factor(0));  // no longer step, and no equilibrium
            CHECK(wall->factor(0.9 * longest));
        }
    }
}

}  // namespace seldinger::test::test_wall_compliance

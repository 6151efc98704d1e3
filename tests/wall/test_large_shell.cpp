// The shell under displacements of any size: objectivity, derivatives, and equilibria against solutions that know no shell
// elements (plates by von Karman's equations for a disk, a strip by the elastica) and published tables.
#include "support/approx.h"
#include "shell/large_shell.h"
#include "large_shell_tangent.h"
#include "wall_problem.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace seldinger::test::test_large_shell {

namespace {

using Vector = Eigen::VectorXd;

Eigen::Map<const Vector> as_vector(const std::vector<double>& w) { return {w.data(), Eigen::Index(w.size())}; }

/// A tube that pressure acts in, irregular, its edges bowed enough for both membrane strains to count.
struct RoughTube {
    WallMesh mesh = [] {
        WallMesh made = tube(0.012, 0.05, 10, 10);
        flip_edges(made, 0.15, 4);
        return made;
    }();
    LoopSurface surface{mesh};
    ShellSpec spec = [] {
        ShellSpec made;
        made.pressure = 2e4;
        return made;
    }();
    Shell shell{surface, spec};
    LargeShell large{shell};
    ShellMatrices matrices = shell.assemble([](const Vec3&) { return Prestress{Vec3::UnitZ(), 0.012, 0.5}; });

    /// Of a third of the radius and slopes of 1.
    [[nodiscard]] std::vector<double> moved() const
    {
        std::mt19937 random(5);
        std::vector<double> w;
        for (const Vec3& x : mesh.vertices) {
            const double noise[3] = {1e-6 * double(random() % 1000), 1e-6 * double(random() % 1000),
                                     1e-6 * double(random() % 1000)};
            const double wave = 4e-3 * std::sin(x.z() / 0.004);
            for (int a = 0; a < 3; ++a) w.push_back(noise[a] + (a < 2 ? wave * x[a] / 0.012 : 0));
        }
        return w;
    }
    [[nodiscard]] Vector force(const std::vector<double>& w) const
    {
        std::vector<double> f(w.size(), 0);
        large.add_excess(w, f);
        return as_vector(f) + matrices.elastic * as_vector(w);
    }
};

/// Newton's method with fixed and held unknowns, in steps of the load.
class LargeProblem {
public:
    explicit LargeProblem(WallProblem& wall)
        : wall_(wall), large_(wall.shell), place_(wall.force.size(), -1), w_(wall.force.size(), 0)
    {
        for (std::size_t i = 0; i < place_.size(); ++i)
            if (!wall.fixed[i] && !wall.matrices.held[i / 3]) place_[i] = free_++;
    }
    /// Equilibrium under `share` of the forces, from the last one.
    void solve(double share)
    {
        const double small = 1e-9 * share * as_vector(wall_.force).norm();
        Vector rest = residual(w_, share);
        for (iterations = 0; rest.norm() > small; ++iterations) {
            REQUIRE(iterations < 60);
            const Vector step = factor().solve(rest);
            double part = 1;
            for (std::vector<double> trial = w_;; part /= 2) {
                REQUIRE(part > 1e-4);
                for (std::size_t i = 0; i < place_.size(); ++i)
                    if (place_[i] >= 0) trial[i] = w_[i] + part * step[place_[i]];
                // thin shells bend far before they stretch: a full step may leave more, by strains of second order
                const Vector there = residual(trial, share);
                if (!(there.norm() < 100 * rest.norm() || there.norm() < small)) continue;
                w_ = trial, rest = there;
                break;
            }
        }
    }
    [[nodiscard]] Vec3 displacement(const Vec3& p) const { return wall_.displacement(w_, p); }

    int iterations = 0;  // of the last solve

private:
    [[nodiscard]] Vector residual(const std::vector<double>& w, double share) const
    {
        std::vector<double> f(w.size(), 0);
        large_.add_excess(w, f);
        const Vector all = share * as_vector(wall_.force) - as_vector(f) - wall_.stiffness() * as_vector(w);
        Vector free(free_);
        for (std::size_t i = 0; i < place_.size(); ++i)
            if (place_[i] >= 0) free[place_[i]] = all[Eigen::Index(i)];
        return free;
    }
    [[nodiscard]] Eigen::SimplicialLDLT<SparseMatrix> factor() const
    {
        const SparseMatrix k = LargeShellTangent{large_}.matrix(w_);
        std::vector<Eigen::Triplet<double>> t;
        for (int c = 0; c < k.outerSize(); ++c)
            for (SparseMatrix::InnerIterator it(k, c); it; ++it)
                if (place_[it.row()] >= 0 && place_[c] >= 0) t.emplace_back(place_[it.row()], place_[c], it.value());
        SparseMatrix free(free_, free_);
        free.setFromTriplets(t.begin(), t.end());
        return Eigen::SimplicialLDLT<SparseMatrix>(free);
    }

    WallProblem& wall_;
    LargeShell large_;
    std::vector<int> place_;  // [3V] of an unknown among the free ones, -1: fixed
    int free_ = 0;
    std::vector<double> w_;
};

ShellSpec unsupported(double youngs, double poisson, double thickness)
{
    ShellSpec spec;
    spec.youngs = youngs, spec.poisson = poisson, spec.thickness = thickness, spec.support = 0, spec.rims_held = false;
    return spec;
}

/// Rings of 6, 12, 18 ... vertices about a centre.
WallMesh disk(double radius, int rings)
{
    WallMesh mesh;
    mesh.vertices.push_back(Vec3::Zero());
    for (int k = 1; k <= rings; ++k)
        for (int i = 0; i < 6 * k; ++i) {
            const double a = pi * i / (3 * k);
            mesh.vertices.push_back({radius * k / rings * std::cos(a), radius * k / rings * std::sin(a), 0});
        }
    const auto at = [](int k, int i) { return k == 0 ? 0 : 1 + 3 * k * (k - 1) + i % (6 * k); };
    for (int k = 1; k <= rings; ++k)
        for (int side = 0; side < 6; ++side)
            for (int i = 0; i < k; ++i) {
                mesh.triangles.push_back({at(k - 1, side * (k - 1) + i), at(k, side * k + i), at(k, side * k + i + 1)});
                if (i + 1 < k)
                    mesh.triangles.push_back(
                        {at(k - 1, side * (k - 1) + i), at(k, side * k + i + 1), at(k - 1, side * (k - 1) + i + 1)});
            }
    return mesh;
}

/// Middle of a disk whose rim is held and free to turn, under pressure q: von Karman's equations for slope f = w' and r N_r = s,
///   D (f'' + f'/r - f/r^2) = q r/2 + s f/r,   s'' + s'/r - s/r^2 = -E t f^2 / (2 r),
///   f' + nu f/a = 0 and s' - nu s/a = 0 at a,
/// by central differences on n intervals (error of order 1/n^2) and Newton's method from the linear solution.
double karman_disk(double youngs, double nu, double thickness, double a, double q)
{
    constexpr int n = 200;
    const double h = a / n, d = youngs * std::pow(thickness, 3) / (12 * (1 - nu * nu));
    Vector x = Vector::Zero(2 * n);  // f, s at h, 2 h, ... a
    Vector rest(2 * n);
    for (int round = 0; round < 100; ++round) {
        Eigen::MatrixXd j = Eigen::MatrixXd::Zero(2 * n, 2 * n);
        for (int i = 0; i < n; ++i) {
            const double r = h * (i + 1), f = x[2 * i], s = x[2 * i + 1];
            for (int c = 0; c < 2; ++c) {
                const double scale = c == 0 ? d : 1;
                double left = 1 / (h * h) - 1 / (2 * r * h), right = 1 / (h * h) + 1 / (2 * r * h),
                       own = -2 / (h * h) - 1 / (r * r);
                if (i + 1 == n) {  // x_n+1 = x_n-1 + 2 h x' with x' = -+ nu x / a
                    own += right * 2 * h * (c == 0 ? -nu : nu) / a;
                    left += right, right = 0;
                }
                rest[2 * i + c] = scale * own * x[2 * i + c];
                j(2 * i + c, 2 * i + c) += scale * own;
                if (i > 0) rest[2 * i + c] += scale * left * x[2 * i - 2 + c], j(2 * i + c, 2 * i - 2 + c) += scale * left;
                if (i + 1 < n) rest[2 * i + c] += scale * right * x[2 * i + 2 + c], j(2 * i + c, 2 * i + 2 + c) += scale * right;
            }
            rest[2 * i] -= q * r / 2 + s * f / r;
            j(2 * i, 2 * i) -= s / r, j(2 * i, 2 * i + 1) -= f / r;
            rest[2 * i + 1] += youngs * thickness * f * f / (2 * r);
            j(2 * i + 1, 2 * i) += youngs * thickness * f / r;
        }
        const Vector step = j.partialPivLu().solve(rest);
        x -= step;
        if (step.norm() < 1e-12 * x.norm()) break;
        REQUIRE(round < 99);
    }
    double w = 0;  // w(a) = 0: -int f
    for (int i = 0; i < n; ++i) w -= h * (i + 1 == n ? 0.5 : 1.0) * x[2 * i];
    return std::abs(w);
}

struct ShellDisk {
    WallProblem wall;
    LargeProblem large;
    ShellDisk(double youngs, double nu, double thickness, double a, double q, int rings)
        : wall(disk(a, rings), unsupported(youngs, nu, thickness)), large(prepare(wall, q))
    {
    }
    static WallProblem& prepare(WallProblem& wall, double q)
    {
        wall.fix([&](int v) { return std::array<bool, 3>{wall.rim(v), wall.rim(v), wall.rim(v)}; });
        wall.add_load([q](const ShellPoint&) { return Vec3(0, 0, q); });
        return wall;
    }
    double middle(double share)
    {
        large.solve(share);
        return large.displacement(Vec3::Zero()).z();
    }
};

/// Tip of a cantilever of length 1 under a force a = P L^2 / (E I) at its end: theta'' = -a cos theta, theta(0) = theta'(1) = 0,
/// by shooting. @return deflection and shortening
std::array<double, 2> elastica(double a)
{
    const auto run = [a](double bend, std::array<double, 2>& tip) {
        constexpr int n = 2000;
        double theta = 0, turn = bend;
        tip = {0, 0};
        for (int i = 0; i < n; ++i) {  // midpoint rule
            const double h = 1.0 / n, middle = theta + h / 2 * turn, turned = turn - h / 2 * a * std::cos(theta);
            tip[0] += h * std::sin(middle), tip[1] += h * (1 - std::cos(middle));
            theta += h * turned, turn -= h * a * std::cos(middle);
        }
        return turn;
    };
    double low = 0, high = a;
    std::array<double, 2> tip{};
    for (int k = 0; k < 60; ++k) (run((low + high) / 2, tip) > 0 ? high : low) = (low + high) / 2;
    return tip;
}

}  // namespace

TEST_SUITE("wall/large_shell")
{
    TEST_CASE("property: a rigid motion of any size costs nothing, and forces turn with the shell")
    {
        const RoughTube t;
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
        const auto turned = [&](const std::vector<double>& w) {
            std::vector<double> to(w.size());
            for (std::size_t v = 0; v < t.mesh.vertices.size(); ++v) {
                const Vec3& x = t.mesh.vertices[v];
                const Eigen::Vector3d rest(x.x(), x.y(), x.z()), moved = rest + Eigen::Vector3d(&w[3 * v]);
                const Eigen::Vector3d u = turn * moved + Eigen::Vector3d(0.3, 0.1, -0.2) - rest;
                for (int a = 0; a < 3; ++a) to[3 * v + a] = u[a];
            }
            return to;
        };
        const double size = t.matrices.elastic.norm();
        const LargeShell::Energy e = t.large.energy(turned(std::vector<double>(3 * t.mesh.vertices.size(), 0)));
        // strains of 1e-16 of tangents of 1, squared; those of places 0.4 m away over edges of 5 mm
        CHECK(e.membrane + e.bending < 1e-26 * size);
        ShellSpec bare = t.spec;
        bare.pressure = 0;  // the third order alone is not the pressure's work
        const Shell shell(t.surface, bare);
        const LargeShell large(shell);
        const auto w = t.moved();
        const auto force = [&](const std::vector<double>& at) {
            std::vector<double> f(at.size(), 0);
            large.add_excess(at, f);
            return Vector(as_vector(f) + t.matrices.elastic * as_vector(at));
        };
        const Vector here = force(w), there = force(turned(w));
        Vector back(here.size());
        for (Eigen::Index v = 0; 3 * v < back.size(); ++v) back.segment<3>(3 * v) = turn.transpose() * there.segment<3>(3 * v);
        CHECK(here.norm() > 1);
        CHECK((back - here).norm() < 1e-9 * here.norm());
    }

    TEST_CASE("property: at rest it is the linear shell")
    {
        const RoughTube t;
        const std::vector<double> rest(3 * t.mesh.vertices.size(), 0);
        const SparseMatrix apart = LargeShellTangent{t.large}.matrix(rest) - t.matrices.elastic;
        CHECK(apart.norm() < 1e-12 * t.matrices.elastic.norm());
        CHECK(t.force(rest).norm() < 1e-12 * t.force(t.moved()).norm());  // tangents of 1 to rounding
        // and what it leaves out is of second order
        auto w = t.moved();
        std::vector<double> once(w.size(), 0), tenth(w.size(), 0);
        for (double& x : w) x *= 1e-4;
        t.large.add_excess(w, once);
        for (double& x : w) x *= 0.1;
        t.large.add_excess(w, tenth);
        CHECK(as_vector(once).norm() / as_vector(tenth).norm() == about(100).epsilon(0.01));
    }

    TEST_CASE("derivative: force and tangent by differences, far from rest, under pressure")
    {
        const RoughTube t;
        const auto w = t.moved();
        std::mt19937 random(7);
        std::vector<double> direction(w.size());
        for (double& x : direction) x = 1e-3 * double(random() % 2001) - 1;
        const auto at = [&](double share) {
            std::vector<double> to = w;
            for (std::size_t i = 0; i < to.size(); ++i) to[i] += share * direction[i];
            return to;
        };
        const double h = 1e-8;  // of edges of 5 mm: differences of fourth order are as small as rounding
        const auto slope = [&](double step) {
            return (t.large.energy(at(step)).sum() - t.large.energy(at(-step)).sum()) / (2 * step);
        };
        const Vector force = t.force(w);
        const double by_energy = (4 * slope(100 * h) - slope(200 * h)) / 3;
        CHECK(force.dot(as_vector(direction)) == about(by_energy).epsilon(1e-6));
        CHECK(std::abs(t.large.energy(w).pressure) > 1e-3 * t.large.energy(w).bending);

        const Vector by_force = (t.force(at(h)) - t.force(at(-h))) / (2 * h);
        const SparseMatrix k = LargeShellTangent{t.large}.matrix(w);
        CHECK(SparseMatrix(k - SparseMatrix(k.transpose())).norm() < 1e-12 * k.norm());
        CHECK((k * as_vector(direction) - by_force).norm() < 1e-6 * by_force.norm());
        CHECK((t.matrices.elastic * as_vector(direction) - by_force).norm() > 0.1 * by_force.norm());
    }

    TEST_CASE("analytic: the pressure's third order is that of the volume inside")
    {
        WallMesh mesh = ball(0.012, 2);
        const LoopSurface s(mesh);
        ShellSpec spec;
        spec.pressure = 1e4;
        const Shell shell(s, spec);
        std::vector<double> w;
        for (const Vec3& x : mesh.vertices)
            for (const double u :
                 {0.2 * x.x() + 20 * x.y() * x.z(), 0.3 * x.y() + 30 * x.x() * x.z(), 0.4 * x.z() - 10 * x.x() * x.y()})
                w.push_back(u);
        const auto volume = [&](double share) {  // of a polyhedron whose corners lie on the moved surface
            constexpr int n = 12;
            double sum = 0;
            LoopStencil at;
            for (std::int32_t t = 0; t < s.topology().triangle_count(); ++t) {
                const auto place = [&](int i, int j) {
                    s.basis(t, double(i) / n, double(j) / n, at);
                    Vec3 x = Vec3::Zero();
                    for (int k = 0; k < at.size; ++k)
                        x += at.n[k] * (mesh.vertices[at.vertex[k]] + share * Vec3(&w[3 * at.vertex[k]]));
                    return x;
                };
                for (int i = 0; i < n; ++i)
                    for (int j = 0; i + j < n; ++j) {
                        const Vec3 a = place(i, j), b = place(i + 1, j), c = place(i, j + 1);
                        sum += a.dot(b.cross(c)) / 6;
                        if (i + j + 1 < n) sum += b.dot(place(i + 1, j + 1).cross(c)) / 6;
                    }
            }
            return sum;
        };
        const double third = (volume(2) - 2 * volume(1) + 2 * volume(-1) - volume(-2)) / 12;
        // four points a triangle of edges of half a radius: 1 %
        CHECK(LargeShell(shell).energy(w).pressure == about(spec.pressure * third).epsilon(0.02));
    }

    TEST_CASE("analytic: a disk under pressure, by von Karman's equations")
    {
        const double youngs = 1e6, nu = 0.3, thickness = 1, a = 200, unit = youngs * std::pow(thickness / a, 4);
        ShellDisk coarse(youngs, nu, thickness, a, unit, 6), fine(youngs, nu, thickness, a, unit, 12);
        for (const double load : {0.1, 2.0, 10.0, 40.0}) {
            CAPTURE(load);
            const double expected = karman_disk(youngs, nu, thickness, a, load * unit);
            // of second order in the edge: 0.45 to 0.06 %, 0.21 to 0.02 %; slopes squared that von Karman leaves out: 0.03 % at
            // most
            CHECK(coarse.middle(load) == about(expected).epsilon(0.01));
            CHECK(fine.middle(load) == about(expected).epsilon(0.005));
        }
    }

    TEST_CASE("analytic: a disk so thin that it is a membrane [Hencky 1915; Timoshenko and Woinowsky-Krieger 1959, sec. 101]")
    {
        // w = 0.662 a (q a / (E t))^(1/3) for nu 0.3
        const double youngs = 1e6, thickness = 0.2, a = 200, q = 0.5;
        ShellDisk disk(youngs, 0.3, thickness, a, q, 10);
        for (const double share : {1e-4, 1e-3, 1e-2, 0.1}) disk.middle(share);
        const double w = disk.middle(1), expected = 0.662 * a * std::cbrt(q * a / (youngs * thickness));
        CHECK(w > 40 * thickness);
        CHECK(w == about(expected).epsilon(0.02));  // three digits; bending at the rim takes 0.3 %
    }

    TEST_CASE("analytic: a strip bent by forces at its ends is the elastica")
    {
        // Sze 2004's cantilever twice over, held in its middle: E 1.2e6, nu 0, 10 x 1 x 0.1, force 4
        const int along = 40;
        WallProblem wall(grid(along, 2, [](double u, double v) { return Vec3(20 * (u - 0.5), v - 0.5, 0); }),
                         unsupported(1.2e6, 0, 0.1));
        wall.fix([&](int v) {
            const bool middle = std::abs(wall.surface.control().vertices[v].x()) < 1e-6;
            return std::array<bool, 3>{middle, middle, middle};
        });
        LoopStencil at;
        for (const int end : {0, along})
            for (int j = 0; j <= 2; ++j) {
                wall.surface.limit_of_vertex(j * (along + 1) + end, at);
                wall.add_stencil(at, Vec3(0, 0, j == 1 ? 2.0 : 1.0));
            }
        LargeProblem large(wall);
        for (const double share : {0.1, 0.25, 0.5, 0.75, 1.0}) {
            CAPTURE(share);
            large.solve(share);
            const Vec3 tip = large.displacement({10, 0, 0});
            const auto [up, back] = elastica(4 * share);
            CHECK(tip.z() == about(10 * up).epsilon(0.005));
            CHECK(-tip.x() == about(10 * back).epsilon(0.01));
        }
    }

    TEST_CASE(
        "analytic: hemisphere with a hole, pulled and pushed by four forces [Sze 2004, doi:10.1016/j.finel.2003.11.001, table 4]")
    {
        const int n = 12;
        WallMesh mesh = hemisphere_mesh(n);
        WallProblem wall(mesh, unsupported(6.825e7, 0.3, 0.04));
        int at[4];
        for (int k = 0; k < 4; ++k) {
            const Vec3 out(std::cos(k * pi / 2), std::sin(k * pi / 2), 0);
            wall.add_force(10 * out, (k % 2 ? -400.0 : 400.0) * out);
            at[k] = wall.nearest(10 * out);
        }
        // six rigid motions, by what the planes of symmetry forbid, and one height
        const double r = 10 * std::cos(72 * pi / 180), z = 10 * std::sin(72 * pi / 180);
        const int top[2] = {wall.nearest({r, 0, z}), wall.nearest({0, r, z})};
        wall.fix([&](int v) {
            return std::array<bool, 3>{v == at[1] || v == at[3] || v == top[1], v == at[0] || v == top[0], v == at[0]};
        });
        LargeProblem large(wall);
        struct Row {
            double share, out, in;
        };
        for (const Row& row : {Row{0.1, 1.499, 1.840}, Row{0.3, 2.819, 4.339}, Row{0.5, 3.406, 5.902}}) {
            CAPTURE(row.share);
            large.solve(row.share);
            const double out = large.displacement({10, 0, 0}).x(), in = -large.displacement({0, 10, 0}).y();
            // the rim's boundary layer, as under small loads (test_shell_obstacles): -2 to -5 %, at 16 elements a side -1.4 to
            // -3.8
            CHECK(out == about(row.out).epsilon(0.06));
            CHECK(in == about(row.in).epsilon(0.06));
        }
    }
}

}  // namespace seldinger::test::test_large_shell

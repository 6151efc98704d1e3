// The shell alone: rigid motion, patches, symmetry, energies by differences, pressure modes of a tube, bad input.
#include "core/error.h"
#include "support/approx.h"
#include "wall_problem.h"

#include <Eigen/Eigenvalues>

namespace seldinger::test::test_shell {

namespace {

WallMesh rough_tube(double radius = 0.012)
{
    WallMesh mesh = tube(radius, 5 * radius, 12, 12);
    flip_edges(mesh, 0.15, 4);
    return mesh;
}

std::vector<double> field(const LoopSurface& s, const std::function<Vec3(const Vec3&)>& u)
{
    std::vector<double> w;
    for (const Vec3& x : s.control().vertices)
        for (int a = 0; a < 3; ++a) w.push_back(u(x)[a]);
    return w;
}

double quadratic(const SparseMatrix& k, const std::vector<double>& w)
{
    const Eigen::Map<const Eigen::VectorXd> x(w.data(), Eigen::Index(w.size()));
    return 0.5 * x.dot(k * x);
}

double asymmetry(const SparseMatrix& k) { return SparseMatrix(k - SparseMatrix(k.transpose())).norm(); }

}  // namespace

TEST_SUITE("wall/shell")
{
    TEST_CASE("property: rigid motion costs nothing, on curved irregular meshes with and without rims")
    {
        WallMesh closed = ball(0.012, 2);
        flip_edges(closed, 0.1, 3);
        for (const WallMesh& mesh : {rough_tube(), closed}) {
            const LoopSurface s(mesh);
            const Shell shell(s, ShellSpec{});
            const ShellMatrices m = shell.assemble();
            CHECK(asymmetry(m.elastic) == 0);
            CHECK(asymmetry(m.area) == 0);
            const double size = m.elastic.norm();
            for (int a = 0; a < 3; ++a) {
                Vec3 axis = Vec3::Zero();
                axis[a] = 1;
                for (const auto& u : {field(s, [&](const Vec3&) { return axis; }),
                                      field(s, [&](const Vec3& x) { return Vec3(100 * axis.cross(x)); })}) {
                    // sums of numbers of `size` that cancel
                    CHECK((m.elastic * Eigen::Map<const Eigen::VectorXd>(u.data(), Eigen::Index(u.size()))).norm() <
                          1e-11 * size * std::sqrt(double(u.size())));
                    const Shell::Energy e = shell.energy(u);
                    CHECK(e.membrane + e.bending < 1e-20 * size * double(u.size()));
                }
            }
        }
    }

    TEST_CASE("property: a free shell has six modes without energy and no more")
    {
        WallMesh mesh = tube(0.012, 0.03, 8, 5);
        flip_edges(mesh, 0.2, 4);
        const LoopSurface s(mesh);
        const ShellMatrices m = Shell(s, ShellSpec{}).assemble();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes{Eigen::MatrixXd(m.elastic)};
        const auto& e = modes.eigenvalues();
        CHECK(std::abs(e[5]) < 1e-12 * e[e.size() - 1]);
        CHECK(e[6] > 1e-5 * e[e.size() - 1]);
    }

    TEST_CASE("property: energy, matrix and second differences agree")
    {
        const LoopSurface s(rough_tube());
        const Shell shell(s, ShellSpec{});
        const ShellMatrices m = shell.assemble();
        std::mt19937 random(2);
        const auto w = field(s, [&](const Vec3&) {
            return Vec3(1e-6 * double(random() % 1000), 1e-6 * double(random() % 1000), 1e-6 * double(random() % 1000));
        });
        const Shell::Energy e = shell.energy(w);
        CHECK(e.membrane > 0);
        CHECK(e.bending > 0);
        CHECK(quadratic(m.elastic, w) == about(e.membrane + e.bending).epsilon(1e-11));
        // area: 1^T A 1 is the surface's
        double area = 0;
        for (const ShellPoint& q : shell.points()) area += q.area;
        CHECK(m.area.sum() == about(area).epsilon(1e-12));
    }

    TEST_CASE(
        "property: the elastic energy is the strain energy of the moved surface, by differences of its metric and curvature")
    {
        // eps = d a_ab / 2 at the very points, on a regular mesh, which has no corrections; so thick that edges do not bow
        WallMesh mesh = tube(1, 5, 12, 12);
        const LoopSurface s(mesh);
        ShellSpec spec;
        spec.youngs = 1, spec.poisson = 0.3, spec.thickness = 1;
        const Shell shell(s, spec);
        const auto push = [](const Vec3& x) {
            return Vec3(0.3 * x.y() * x.z(), 0.2 * x.x() * x.x(), 0.1 * x.x() * x.y() + 0.2 * x.z());
        };
        const double h = 1e-4;
        WallMesh plus = mesh, minus = mesh;
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            plus.vertices[v] += h * push(mesh.vertices[v]), minus.vertices[v] -= h * push(mesh.vertices[v]);
        double membrane = 0;
        LoopCurvedStencil st;
        for (const ShellPoint& q : shell.points()) {
            s.basis(q.triangle, q.u, q.v, st);
            Vec3 d[2][2], here[2];  // tangents of both
            for (auto& a : d) a[0] = a[1] = Vec3::Zero();
            here[0] = here[1] = Vec3::Zero();
            for (int k = 0; k < st.size; ++k) {
                const int v = st.vertex[k];
                d[0][0] += st.n_u[k] * plus.vertices[v], d[0][1] += st.n_v[k] * plus.vertices[v];
                d[1][0] += st.n_u[k] * minus.vertices[v], d[1][1] += st.n_v[k] * minus.vertices[v];
                here[0] += st.n_u[k] * mesh.vertices[v], here[1] += st.n_v[k] * mesh.vertices[v];
            }
            Eigen::Matrix2d strain, t;
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) strain(a, b) = (d[0][a].dot(d[0][b]) - d[1][a].dot(d[1][b])) / (4 * h);
            t << here[0].dot(q.e1), here[1].dot(q.e1), here[0].dot(q.e2), here[1].dot(q.e2);
            const Eigen::Matrix2d e = t.inverse().transpose() * strain * t.inverse();
            membrane += 0.5 * q.area * spec.youngs * spec.thickness / (1 - 0.09) *
                        (e(0, 0) * e(0, 0) + e(1, 1) * e(1, 1) + 0.6 * e(0, 0) * e(1, 1) + 1.4 * e(0, 1) * e(0, 1));
        }
        // strains averaged over a triangle have a little less energy: by their spread there, 2 % here
        const double mean = shell.energy(field(s, push)).membrane;
        CHECK(mean < membrane);
        CHECK(mean > 0.96 * membrane);
    }

    TEST_CASE("analytic: patches of constant stress and constant moment, on a distorted mesh")
    {
        // MacNeal & Harder 1985: E = 1e6, nu = 1/4, t = 1e-3 give 1333 and 400, moments 1.111e-7 and 3.333e-8 (stress 0.667, 0.2)
        WallMesh mesh = grid(10, 9, [](double u, double v) { return Vec3(0.24 * u, 0.12 * v, 0); });
        flip_edges(mesh, 0.15, 6);
        ShellSpec spec;
        spec.youngs = 1e6, spec.poisson = 0.25, spec.thickness = 1e-3, spec.rims_held = false;
        const LoopSurface s(mesh);
        const Shell shell(s, spec);
        const auto stretched =
            field(s, [](const Vec3& x) { return Vec3(1e-3 * (x.x() + x.y() / 2), 1e-3 * (x.y() + x.x() / 2), 0); });
        const ShellStress flat = shell.stress(stretched);
        // solved for from the rim alone, the same
        WallProblem patch(mesh, [&] {
            ShellSpec free = spec;
            free.support = 0;
            return free;
        }());
        const auto& in = patch.surface.control().vertices;
        const auto given =
            field(patch.surface, [](const Vec3& x) { return Vec3(1e-3 * (x.x() + x.y() / 2), 1e-3 * (x.y() + x.x() / 2), 0); });
        const Eigen::VectorXd out =
            patch.matrices.elastic * Eigen::Map<const Eigen::VectorXd>(given.data(), Eigen::Index(given.size()));
        double inside = 0, rim = 0;
        for (int v = 0; v < int(in.size()); ++v)
            (patch.rim(v) ? rim : inside) = std::max(patch.rim(v) ? rim : inside, out.segment<3>(3 * v).norm());
        for (const auto& t : flat.membrane) {
            const double mean = (t[0] + t[1]) / 2, apart = std::hypot((t[0] - t[1]) / 2, t[2]);
            CHECK(mean == about(4.0 / 3 * 1000).epsilon(1e-9));
            CHECK(apart == about(400).epsilon(1e-9));
        }
        for (const auto& t : flat.bending) CHECK(t.norm() < 1e-6);
        CHECK(flat.mises_inner[40] == about(std::sqrt(4.0 / 3 * 1000 * 4.0 / 3 * 1000 + 3 * 160000.0)).epsilon(1e-9));
        // quadrature leaves forces between the triangles of an irregular mesh: small beside those that pull at the rim
        CHECK(inside < 0.05 * rim);

        // constant moments: limits of the vertices on the paraboloid
        LoopSurface bent = s;
        const auto height = [](const Vec3& x) { return 1e-3 * (x.x() * x.x() + x.x() * x.y() + x.y() * x.y()) / 2; };
        std::vector<Vec3> to;
        LoopStencil st;
        for (int v = 0; v < int(mesh.vertices.size()); ++v) {
            s.limit_of_vertex(v, st);
            Vec3 x = Vec3::Zero();
            for (int k = 0; k < st.size; ++k) x += st.n[k] * mesh.vertices[st.vertex[k]];
            to.push_back(x + Vec3(0, 0, height(x)));
        }
        bent.interpolate(to, 200);
        std::vector<double> w;
        for (std::size_t v = 0; v < to.size(); ++v)
            for (int a = 0; a < 3; ++a) w.push_back(a == 2 ? bent.control().vertices[v].z() : 0);
        const ShellStress curved = shell.stress(w);
        for (std::size_t k = 0; k < curved.bending.size(); ++k) {
            const auto& t = curved.bending[k];  // of either sign: the side that the normal is on
            CHECK(std::abs(t[0] + t[1]) / 2 == about(2.0 / 3).epsilon(1e-6));
            CHECK(std::hypot((t[0] - t[1]) / 2, t[2]) == about(0.2).epsilon(1e-6));
        }
    }

    TEST_CASE("analytic: pressure leaves 0, 0, 3 p/R of a tube's modes n = 0, 1, 2")
    {
        const double radius = 0.012, length = 0.2, p = 13332;
        ShellSpec spec;
        spec.pressure = p;
        for (const bool rough : {false, true}) {
            CAPTURE(rough);
            WallMesh mesh = tube(radius, length, 32, 90);
            if (rough) flip_edges(mesh, 0.05, 3);
            const WallProblem wall(mesh, spec, [&](const Vec3&) { return Prestress{Vec3::UnitZ(), radius, 0.5}; });
            CHECK(asymmetry(wall.matrices.pressure) < 1e-14 * wall.matrices.pressure.norm());
            // along the middle half of the tube, constant: rims have their own terms; d/dz of the ramps costs N_z / 2 w'^2 of no
            // interest
            const auto energy = [&](int n) {
                const auto part = [&](double z) { return std::clamp(2 - 4 * std::abs(z) / (length / 2), 0.0, 1.0); };
                const auto u = field(wall.surface, [&](const Vec3& x) {
                    const double a = std::atan2(x.y(), x.x());
                    const Vec3 out(std::cos(a), std::sin(a), 0), on(-std::sin(a), std::cos(a), 0);
                    const double v = n == 0 ? 0 : -std::sin(n * a) / n;  // inextensional: v_t + w = 0
                    return Vec3(part(x.z()) * (std::cos(n * a) * out + v * on));
                });
                double ramps = 0, level = 0;  // int part'^2, int part^2
                constexpr int steps = 4000;
                for (int k = 0; k < steps; ++k) {
                    const double z = length * ((k + 0.5) / steps - 0.5), dz = length / steps;
                    level += part(z) * part(z) * dz;
                    ramps += std::pow((part(z + 1e-7) - part(z - 1e-7)) / 2e-7, 2) * dz;
                }
                // control values are a little larger than the surface's: measure by the surface
                const double lift = wall.displacement(u, {radius, 0, 0}).x();
                const double around = pi * radius * (n == 0 ? 2 : 1) * lift * lift, both = n == 0 ? 1 : 1 + 1.0 / (n * n);
                // per length 1/2 pi R (n^2 - 1) p/R of the mode, and 1/2 N_z of its ramps
                return (quadratic(wall.matrices.pressure, u) - 0.5 * p * radius / 2 * around * both * ramps) /
                       (0.5 * around * level);
            };
            const double unit = p / radius;
            CHECK(std::abs(energy(0)) < 0.02 * unit);
            CHECK(std::abs(energy(1)) < 0.02 * unit);
            CHECK(energy(2) == about(3 * unit).epsilon(0.03));
        }
    }

    TEST_CASE("bad input: specs out of range, pressure without an axis")
    {
        const LoopSurface s(rough_tube());
        for (const auto& spoil : std::initializer_list<std::function<void(ShellSpec&)>>{
                 [](ShellSpec& x) { x.youngs = 0; }, [](ShellSpec& x) { x.poisson = 0.7; },
                 [](ShellSpec& x) { x.thickness = -1; }, [](ShellSpec& x) { x.support = -1; },
                 [](ShellSpec& x) { x.relaxation = NAN; }}) {
            ShellSpec spec;
            spoil(spec);
            CHECK_THROWS_AS(Shell(s, spec), Error);
        }
        ShellSpec loaded;
        loaded.pressure = 1e4;
        CHECK_THROWS_AS((void)Shell(s, loaded).assemble(), Error);
    }
}

}  // namespace seldinger::test::test_shell

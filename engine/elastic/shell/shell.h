#pragma once
// The vessel's wall as a thin linear Kirchhoff-Love shell on a Loop subdivision surface: stiffness, pressure, stresses.
//
// Displacement u [m] of the mid-surface x(s1, s2); a_a = x_,a, a_3 the normal, b_ab = x_,ab . a_3. Energy [J]
//
//   E(u) = 1/2 int C H^abcd eps_ab eps_cd + D H^abcd rho_ab rho_cd dA        K_elastic: membrane and bending
//        + 1/2 int N^ab u_,a . u_,b dA - (p/2) int u . (u_,1 x x_,2 + x_,1 x u_,2) ds1 ds2      K_pressure (outward normal)
//        + 1/2 int k_s u . u dA                                                                 k_s A: the tissue around
//
//   C = E h / (1 - nu^2) [N/m], D = E h^3 / (12 (1 - nu^2)) [N m], H^abcd = nu a^ab a^cd + (1 - nu)/2 (a^ac a^bd + a^ad a^bc)
//   eps_ab = (a_a . u_,b + a_b . u_,a) / 2                      membrane strain
//   rho_ab = change of b_ab - (b_a^c eps_cb + b_b^c eps_ca) / 2 change of curvature [Koiter60, Sanders59]: 0 for a tube that
//            widens evenly; Cirak leaves the second part out, which differs by h^2/(12 R^2) of the membrane's energy
//
// Both strains vanish for rigid motion. The given shape is the loaded equilibrium: N_theta = p R and N_z = p R / 2 [N/m] carry
// the mean pressure p and stiffen the wall (N^ab). The pressure stays normal to the moving wall (second variation of the enclosed
// volume). The terms of open rims are left out; held rims have none. On a tube the two leave (n^2 - 1) p/R for the inextensional
// modes: 0, 0, 3 p/R for n = 0, 1, 2. Inertia is left out: it is small beside the tissue's damping. [Cirak00; Moireau12 for the
// tissue]
//
// Where this departs from Cirak. Loop's functions do not hold quadratic displacements about vertices of other than six triangles,
// nor beside rims, where phantoms bind twist to curvature. Without correction a plate whose mesh is irregular throughout is 25 %
// too stiff however fine it is, and a regular one gains first-order errors from its rims. Second derivatives are therefore
// corrected: Loop's weights miss part of quadratics, which is fitted to the patch's control vertices and added (Shell::mend). It
// changes nothing on a flat lattice and nothing for rigid motion, and makes bending about irregular vertices exact for constant
// moments.
// Bending is summed over the barycentres of a triangle's four parts.
//
// The membrane has one strain per triangle, or thin shells would lock: eps = a mean + (1 - a) tied. `mean` is that over the four
// points; `tied` is the constant strain that stretches the three edges as they are stretched on average, t . eps . t = t . u_,s
// [Lee04]. If a mean exists it is the better strain. But bending without strain then gets a membrane part that grows with l^2/(R
// h). It stiffened a hemisphere by 3 % at l^2 = 2.5 R h, by 50 % at 10 R h. Tied strains are as many as unknowns (three per
// vertex) and leave such bending free; for membrane bending in its plane they are too stiff. So
//   a = 1 / (1 + (bow / 2h)^2),  bow = l^2/R, eight times the sagitta of the edge that bows most
// which ends in the mean as the mesh is refined, and on a plane [as Arnold97 take a share of the membrane that grows so]. Either
// strain is exact for rigid motion and for constant strain, so is the sum.

#include "surface/loop_surface.h"

#include <Eigen/SparseCore>
#include <functional>
#include <span>
#include <vector>

namespace seldinger {

struct ShellSpec {
    double youngs = 1e6;  // [Pa]
    double poisson = 0.45;
    double thickness = 1.5e-3;     // h [m]
    double support = 1e6;          // k_s, springs of the tissue on the displacement vector [Pa/m]
    double support_damping = 1e4;  // c_s [Pa s/m]
    double relaxation = 0.02;      // tau of the wall itself [s]
    double pressure = 0;           // p, mean, inside minus outside [Pa]
    bool rims_held = true;         // displacement of rims zero, free to turn
};

/// What carries the mean pressure at a place of the wall.
struct Prestress {
    Vec3 axis = Vec3::UnitZ();  // of the vessel, any length
    double radius = 0;          // of the vessel [m]
    double axial_part = 0.5;    // N_z / (p R)
};
using PrestressAt = std::function<Prestress(const Vec3& position)>;

/// One quadrature point: where it is, and the weights of its control vertices in a local orthonormal frame (e1, e2, normal).
struct ShellPoint {
    std::int32_t triangle = 0;
    double u = 0, v = 0;
    double area = 0;  // weight of the point [m^2]
    Vec3 position = Vec3::Zero(), normal = Vec3::UnitZ(), e1 = Vec3::UnitX(), e2 = Vec3::UnitY();
    double b11 = 0, b22 = 0, b12 = 0;                 // curvature b_ab in the frame [1/m]
    std::int32_t first_vertex = 0, vertex_count = 0;  // in Shell's arrays
};

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Assembled matrices, symmetric, both triangles stored. Unknown 3 vertex + axis.
struct ShellMatrices {
    SparseMatrix elastic;             // [3V][3V] [N/m]
    SparseMatrix pressure;            // [3V][3V] [N/m], empty without pressure
    SparseMatrix area;                // [V][V] int N_a N_b dA [m^2]
    std::vector<unsigned char> held;  // [V] 1: displacement zero
};

/// Stress of the wall. Components 11, 22, 12 in a point's frame [Pa].
struct ShellStress {
    std::vector<Vec3> membrane,
        bending;  // [Q]; at the outer surface membrane + bending, at the inner membrane - bending
    std::vector<double> mises_inner, mises_outer;  // [V] area-weighted about each control vertex: smooth, for pictures [Pa]
    double mises_max = 0;                          // largest of the points and both surfaces [Pa]
    std::size_t highest = 0;                       // that point
};

/// Strain of the mid-surface at a point, in its frame.
struct ShellStrain {
    Vec3 membrane;  // 11, 22, 2 12
    Vec3 bending;   // change of curvature: 11, 22, 2 12 [1/m]
};

class BlockPattern;
class LargeShell;

class Shell {
public:
    /// The surface must outlive it. Throws Error for a spec out of range.
    Shell(const LoopSurface& surface, const ShellSpec& spec);

    [[nodiscard]] const std::vector<ShellPoint>& points() const { return points_; }
    [[nodiscard]] const LoopSurface& surface() const { return surface_; }
    [[nodiscard]] const ShellSpec& spec() const { return spec_; }

    /// All matrices at once. @param prestress  may be empty when the spec's pressure is zero
    [[nodiscard]] ShellMatrices assemble(const PrestressAt& prestress = {}) const;

    /// @param displacement  [3V] [m]  @param large  of this shell: under large displacements; null: linear theory
    /// @param excess  to which the energy is added that `large` has beyond linear theory [J]
    [[nodiscard]] ShellStress stress(std::span<const double> displacement, const LargeShell* large = nullptr,
                                     double* excess = nullptr) const;
    /// Largest von Mises stress of a triangle, of its points and both surfaces [Pa]; its control vertices' displacements are
    /// enough.
    /// @param highest  out: the point
    [[nodiscard]] double stress_of(std::int32_t triangle, std::span<const double> displacement, std::size_t& highest,
                                   const LargeShell* large = nullptr) const;
    /// Membrane and bending energy of a displacement, summed over quadrature points [J].
    struct Energy {
        double membrane = 0, bending = 0;
    };
    [[nodiscard]] Energy energy(std::span<const double> displacement) const;

private:
    friend class LargeShell;  // shell/large_shell.h: the same points and weights
    friend struct LargeShellTangent;  // tests/wall/large_shell_tangent.h

    /// Weight of one control vertex at one point: value, derivatives along e1, e2 [1/m], covariant second derivatives [1/m^2].
    struct Weight {
        std::int32_t vertex;
        double n;
        double n_1, n_2, n_11, n_22, n_12;
    };
    void add_point(std::int32_t triangle, double u, double v, double share);
    void find_spreads();
    void mend(const ShellPoint& q);
    void add_membrane(std::size_t first);

    [[nodiscard]] std::span<const Weight> weights(const ShellPoint& q) const
    {
        return {weights_.data() + q.first_vertex, static_cast<std::size_t>(q.vertex_count)};
    }
    [[nodiscard]] ShellStrain strain(const ShellPoint& q, std::span<const double> displacement) const;
    /// Weights of a triangle's stencil, whose points begin with `first`.
    [[nodiscard]] std::span<const Mat3> membrane(std::size_t first) const;
    /// Strains at the four points of a triangle, of which `first` is the first.
    /// @return the triangle's membrane strain, in the frame of the last one
    Vec3 strains_of(std::size_t first, std::span<const double> displacement,
                    std::span<ShellStrain, 4> at) const;
    template <class Add>
    void add_elastic(std::size_t first, const Add& add) const;
    template <class Add>
    void add_pressure(const ShellPoint& q, const Prestress& prestress, const Add& add) const;
    /// Stresses per strain: C H and D H.
    [[nodiscard]] Mat3 law() const;
    /// Control vertices that share a triangle's stencil.
    [[nodiscard]] BlockPattern pattern() const;

    const LoopSurface& surface_;
    ShellSpec spec_;
    std::vector<ShellPoint> points_;  // [Q]
    std::vector<Weight> weights_;
    /// [Q/4 stencils] membrane strain (11, 22, 2 12) of a triangle per displacement of a control vertex [1/m], in the frame of
    /// its last point
    std::vector<Mat3> membrane_;
    /// [V] control values of a quadratic q with limits q at the vertices are q(X) - S : q'' / 2 [m^2]; known until points are
    /// made
    std::vector<Mat3> spreads_;
};

}  // namespace seldinger

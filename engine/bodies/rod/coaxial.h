#pragma once
// Instruments inside each other that share one centreline (D12): energy, gradient, Hessian, and the forces at the hand of each
// one.
//
// Clearance is zero. The centreline has nodes x_i and edges as a wire has (RodView), with one reference frame per edge.
// Instrument k has its own spin angles theta_k in these frames and lies along the centreline by its offset o_k. At the
// centreline's coordinate s (RodView::material_s, rising from the tip) is its material s + o_k, measured from its own tip. Where
// that is outside [0, its length] it is not there and contributes nothing.
//
//     E = sum_k 1/2 int B_k |kappa - R(theta_k) kappa_k|^2 + C_k theta_k'^2 ds + 1/2 int EA strain^2 ds         (D12)
//                                                       [Dupont10; Rucker10], discretised like D1-D3 [Bergou10]
//
// **A cell** (Voronoi: from the middle of one edge to the middle of the next) is cut where any instrument begins, ends or changes
// its section. In a piece the instruments act as one of stiffness B = sum B_k and natural curvature r = sum B_k R_k kappa_k / B.
// Forcing them into one shape costs 1/2 sum_{k<l} (B_k B_l/B) |R_k kappa_k - R_l kappa_l|^2. This does not depend on the shape:
// it turns them against each other. Pieces are in series, as in rod/rest_shape.cpp, so that a jump of stiffness anywhere in a
// cell keeps second order:
//
//     E_i = 1/2 |f kappa - int r ds|^2 / int ds/B + (what forcing costs) + sum_k 1/2 (f_k twist_k)^2 / int ds/C_k
//
// f and f_k are the parts of the cell where any instrument, and k, lie. In the tip's half cell, where bending is free, only what
// forcing costs is left. E is continuous in the offsets. Its derivative is too
// while no end or change of section passes from one cell to the next, where it changes by as much as the moment does from node to
// node. With one instrument this is the energy of rod/elastic.h.
//
// **Unknowns** of node i: x, y, z, then for each instrument the angle of the edge that begins there; 3 + K, half bandwidth
// 2 (3 + K) + 2, 12 for two. The last node's angles are those of the hub's clamp, in the places that a wire leaves unused. They
// are prescribed, or joined to the hand by the twist of the length still behind it (CoaxialBase). Angles of edges that an
// instrument does not reach are of no account: coaxial_idle() says which; the solver holds them and follow_idle() keeps them
// level with the rest.

#include "rod/clamp.h"

#include <array>
#include <complex>

namespace seldinger {

inline constexpr int most_coaxial = 4;  // instruments in one centreline

/// Where unknowns live, counted from the centreline's first; compare RodDofs.
struct CoaxialDofs {
    int instruments = 1;
    static constexpr int coordinates = 3;
    static constexpr int reach = 2;

    [[nodiscard]] int per_node() const { return coordinates + instruments; }
    [[nodiscard]] int half_bandwidth() const { return per_node() * reach + coordinates - 1; }
    [[nodiscard]] int count(int nodes) const { return per_node() * nodes; }
    [[nodiscard]] int position(int i, int c = 0) const { return per_node() * i + c; }
    /// Angle of instrument k on edge j; j = nodes - 1: of the hub's clamp.
    [[nodiscard]] int spin(int j, int k) const { return per_node() * j + coordinates + k; }
};

struct CoaxialInstrument {
    const WireSpec* spec = nullptr;  // its material, from its tip
    double offset = 0;               // o_k [m]
};

/// Integrals over a cell; also, as a rate, over what a cell gains when something moves.
struct CoaxialCell {
    using Complex = std::complex<double>;                 // components about the two directors
    double length = 0;                                    // l_i [m]
    double covered = 0;                                   // f l_i [m]
    double compliance = 0;                                // int ds/B [1/(N m)]
    double forced = 0;                                    // of what forcing costs, the part that turning does not change [J]
    std::array<Complex, most_coaxial> rest{};             // int (B_k/B) kappa_k ds [-]
    std::array<double, most_coaxial> twist_covered{};     // f_k l_i [m]
    std::array<double, most_coaxial> twist_compliance{};  // int ds/C_k [1/(N m)]
    std::array<Complex, 6> couple{};                      // pairs k < l: int (B_k B_l/B) conj(kappa_k) kappa_l ds [J]

    /// The part of a cell (of a rate) that is `length` of such material. @param section  [instruments], null: not there
    void add(std::span<const WireSection* const> section, double length);
};

/// Place of the pair k < l in CoaxialCell::couple.
inline int coaxial_pair(int k, int l) { return l * (l - 1) / 2 + k; }

/// A stretch of the centreline in which no instrument begins, ends or changes.
struct CoaxialPiece {
    double begin = 0, end = 0;                               // centreline coordinate [m]
    std::array<const WireSection*, most_coaxial> section{};  // null: not there
};

/// The instruments of one centreline, and the integrals that prepare_coaxial() makes. Scratch is allocated once.
struct CoaxialRod {
    explicit CoaxialRod(int nodes = 0, int instrument_count = 1);
    [[nodiscard]] CoaxialDofs dofs() const { return {instruments}; }

    int instruments = 1;
    std::array<CoaxialInstrument, most_coaxial> instrument;
    std::array<std::vector<double>, most_coaxial> theta;  // [nodes] accepted angles, the last one the clamp's [rad]
    // written by prepare_coaxial()
    std::vector<CoaxialPiece> pieces;                            // from tip to hub
    std::vector<CoaxialCell> cells;                              // [nodes]; half cells at tip and hub
    std::vector<double> stretch_covered, stretch_compliance;     // [nodes - 1] [m], int ds/EA [m/N]
    std::array<std::vector<double>, most_coaxial> spin_inertia;  // [nodes - 1] [kg m^2]
};

/// How the instruments enter at the hub, node n - 1: a sleeve that holds their tangent (over half a cell, RodClamp).
struct CoaxialBase {
    Vec3 tangent = Vec3::UnitX();   // unit, tip -> hub
    Vec3 director = Vec3::UnitZ();  // unit, normal to it: angles of the last node count from here
    // Twist compliance of each instrument between clamp and hand, length/C [rad/(N m)]; 0: the hand is at the clamp, and the last
    // node's angle is prescribed.
    std::array<double, most_coaxial> behind{};
    std::array<double, most_coaxial> hand{};  // angle that the hand holds, where `behind` > 0 [rad]

    /// The sleeve as a clamp of a wire with `nodes` nodes; each instrument is turned by itself.
    [[nodiscard]] RodClamp clamp(int nodes) const
    {
        return {.node = nodes - 1, .spin = true, .tangent = tangent, .director = director};
    }
};

/// Scratch for update_coaxial(): without material directors, as each instrument has its own.
[[nodiscard]] inline RodFrames coaxial_frames(int nodes)
{
    RodFrames frames(nodes, 1);
    frames.material = false;
    return frames;
}

/// Positions and angles being tried: spans of length n; theta[k][n - 1] is the clamp's.
struct CoaxialTrial {
    std::span<const double> x, y, z;
    std::array<std::span<const double>, most_coaxial> theta;
};

/// A configuration: `frames` are those of the trial, see update_coaxial().
struct CoaxialShape {
    const CoaxialRod& rod;
    const RodView& line;
    const CoaxialTrial& trial;
    const CoaxialBase& base;
    const RodFrames& frames;
};

/// Upper half of the Hessian by blocks of nodes: rows of node i, columns of nodes i, i + 1, i + 2.
class CoaxialHessian {
public:
    explicit CoaxialHessian(int nodes = 0, int instruments = 1);
    void reset(int nodes);  // zero; nodes <= those of the constructor
    [[nodiscard]] int size() const { return width_ * nodes_; }
    /// Block of node i with node i + ahead (0, 1, 2), [per_node][per_node] row by row. With two ahead there are no angles on the
    /// right.
    [[nodiscard]] double* block(int i, int ahead) { return blocks_.data() + (3 * i + ahead) * width_ * width_; }
    [[nodiscard]] double at(int i, int j) const;  // either half

private:
    int width_ = 4, nodes_ = 0;
    std::vector<double> blocks_;
};

/// All integrals for the present offsets and `line.material_s`; writes line.rest_length, and what belongs to all instruments
/// together: stretch_stiffness, bend_stiffness, mass, radius (of the widest). O(n + changes), no allocation after the first call.
void prepare_coaxial(CoaxialRod& rod, const RodView& line);

/// Stretch stiffness of all instruments together in [begin, end] of the centreline, as one edge [N]; prepare_coaxial() has been
/// called for their offsets.
[[nodiscard]] double coaxial_stretch_stiffness(const CoaxialRod& rod, double begin, double end);

/// The edge that material at s goes on with straight, one of the two of its cell. It is `edge`, which s lies on, unless the cell
/// bends almost only beyond s, as at the tip of a catheter that a soft wire leaves: there the cell turns at its node all the
/// same, and what acts on the catheter would turn the half edge that has left it. From less than half of what bends between s and
/// the middle of the other edge, were the cell even, s is on the line of that other edge; what is left there to turn is no more
/// than in an even cell. prepare_coaxial() has been called.
[[nodiscard]] int coaxial_edge_of(const CoaxialRod& rod, const RodView& line, double s, int edge);

/// What bends between two middles, on either side of a place between them.
struct CoaxialBend {
    double before = 0, after = 0;            // compliance [1/(N m)]
    double before_rate = 0, after_rate = 0;  // their change as an instrument slides and takes the place along [1/(N m^2)]
    double least = 0;                        // per length, of the stiffest material [1/(N m^2)]
    bool even = true;                        // the same material all the way
};
/// @param k  the instrument that the place is on
[[nodiscard]] CoaxialBend coaxial_bend(const CoaxialRod& rod, int k, double from, double s, double to);

/// Frames at `trial`: those of the centreline, of which the first instrument's angles and twist, and the sleeve as the only
/// clamp. @param frames  of coaxial_frames()     @return false where there is no such configuration, see update_frames()
[[nodiscard]] bool update_coaxial(const CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialBase& base,
                                  RodFrames& frames);

/// [J]
[[nodiscard]] double coaxial_energy(const CoaxialShape& shape);

/// Adds +dE/dq to `gradient` (CoaxialDofs; may be empty) and d2E/dq2 to `hessian` (may be null). The remark at add_elastic() on
/// moving a frame while changing shape holds here too. `Projected`: every stencil positive semidefinite, Gauss-Newton where
/// natural curvature is felt. O(n), no allocation.
void add_coaxial(const CoaxialShape& shape, std::span<double> gradient, CoaxialHessian* hessian, HessianMode mode);

/// Forces and torques of the hands: derivatives of the energy E by what each hand moves, nodes and spin angles held fixed.
struct CoaxialHands {
    std::array<double, most_coaxial> offset_force{};  // dE/do_k [N]
    double line_force = 0;                            // dE/d(rest length of the base edge) at fixed offsets [N]
    std::array<double, most_coaxial> torque{};        // that the hand exerts, + in the sense of increasing theta [N m]

    /// Force of the hand on instrument k, + when it pushes. The hand of the one whose tip the centreline's coordinate counts from
    /// (`leader`) makes the centreline longer while the others stay at the hub: o_l falls. The weight of fed material is not
    /// included.
    [[nodiscard]] double push(int k, int leader, int instruments) const;
};
[[nodiscard]] CoaxialHands coaxial_hands(const CoaxialShape& shape);

/// Whether nothing depends on the angle of instrument k on edge j (j = n - 1: at the clamp).
[[nodiscard]] bool coaxial_idle(const CoaxialRod& rod, int j, int k);
/// Sets accepted idle angles so that there is no twist between them and the nearest edge that the instrument reaches.
void follow_idle(CoaxialRod& rod, const RodView& line);

}  // namespace seldinger

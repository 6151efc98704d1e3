#pragma once
// Force of an instrument on the lumen around it, when both bend together.
//
// Instruments of one centreline have the same curvature everywhere. The inner one carries M(s) of the bending moment, which jumps
// at changes of stiffness or natural curvature and at the outer one's end. There the lateral force between them, -M'', is an
// unbounded couple. At the clearance c that the lumen leaves the inner one goes its own way instead, off by y(s), and |y| <= c.
// With B = B_in B_out/(B_in + B_out), as stiff as the one is against the other, y is the least of
//
//     J = int B |y''|^2/2 + M . y'' - w . y ds + M_e . y'(e) - Q_e . y(e),      |y| <= c,   y = y' = 0 at the hub
//
// a convex problem: moments M + B y'' of the inner one, and force between them only in contact. The load w is any other lateral
// load on the inner one: T kappa if it is drawn round a bend. At the end e of the overlap M_e and Q_e are moment and shear of
// the inner instrument's part beyond it; 0 if it ends there. The lumen gives by K of force per length and depth. A jump M_0
// alone is a couple of forces M_0/l, l = sqrt(12 B c/M_0), from one side of the lumen to the other: the force grows as
// 1/sqrt(c).
//
// Complex numbers: the two directions across the line, in a frame carried along it in parallel.

#include <complex>
#include <vector>

namespace seldinger {

class LumenPress {
public:
    using Complex = std::complex<double>;

    /// Data of the inner instrument at places a `spacing` apart, from the overlap's end to the hub.
    struct Place {
        double stiffness = 0;  // B [N m^2]
        Complex moment = 0;    // M [N m]
        double clearance = 0;  // c [m], > 0
        Complex lateral = 0;   // w [N/m]
    };
    struct End {
        Complex moment = 0, shear = 0;  // M_e [N m], Q_e [N]
    };

    std::vector<Place> places;
    End end;
    std::vector<Complex> off;   // y, first guess and result: [places], the last of them held [m]
    std::vector<double> force;  // of the inner one on the lumen at each place [N], result

    /// Newton from `off`, steps cut where J does not fall. @return steps; `most` where it is not there yet, closer than before
    int solve(double spacing, int most);

private:
    [[nodiscard]] double energy(const std::vector<Complex>& at, double spacing) const;
    void set_bending(double spacing);
    void set_newton(double spacing);
    void factor_and_solve();
    [[nodiscard]] int free() const { return static_cast<int>(places.size()) - 1; }

    static constexpr int width = 6;             // of a row of the lower half: itself and the five before
    std::vector<double> bending_, rows_, rhs_;  // [2 free][width], likewise, [2 free]
    std::vector<double> load_;                  // of M, M_e and Q_e [2 free]
    std::vector<Complex> tried_;
};

}  // namespace seldinger

#pragma once
// Readings of contact along a wire that do not depend on its sampling: force per length, the force on a patch, the number of
// regions in contact.
//
// Let s be the arc length from the tip along the unstressed wire [m]. A sample of contact that represents the length l of wire
// bears its normal force F [N] evenly over [s - l/2, s + l/2]. The tip's own point law and the pairs of `layer` represent no
// length and bear theirs at s. Their sum is a load along the wire whose integral is the sum of all F, whatever the samples are.
// With N(a, b) the load on the closed stretch from a to b [N]:
//
//     force per length    q(s) = N(s - W/2, s + W/2) / W     [N/m]
//     force on a patch    P(L) = max over a of N(a, a + L)   [N]
//     pressure            N over the area that the same window lies on (contact_patch.h)   [Pa]
//     regions             runs of stretches with contact, apart by more than W
//
// The window W is one wire diameter: what a wire presses on is not known finer than the wire is thick. A box window keeps the
// integral of the load. A force F at one position reads F/W, and an even load reads q itself. At the wire's ends the window hangs
// over, and q falls to half of an even load. Two samples share the load between them over 2 l: W is at least twice the samples'
// spacing, and the reading says so (`widened`). Normal forces are added as they are, without direction: a wire that is pressed
// between two walls reads the forces of both sides.

#include "contact/contact_row.h"

#include <span>
#include <vector>

namespace seldinger {

/// Readings of one wire's contacts with the wall, or with other instruments.
struct ContactAlong {
    double per_length_max = 0;    // largest q [N/m]
    double per_length_at = 0;     // there, from the tip [m]
    double patch_force = 0;       // P [N]
    double patch_at = 0;          // middle of that patch, from the tip [m]
    int regions = 0;              // separate places
    double extent = 0;            // their lengths, summed; gaps up to one window are closed, points alone count as one window [m]
    double window = 0, patch = 0; // W, L [m]
    bool widened = false;         // W is more than was asked for: samples are too far apart for it
};

/// One sample as the readings take it.
struct LoadSample {
    double s = 0;       // [m]
    double length = 0;  // [m], 0: a point
    double force = 0;   // [N]
};

/// The samples of one wire, and sums of the magnitudes of their forces as ContactTotals has them.
struct WireLoads {
    std::vector<LoadSample> samples;
    double normal = 0, friction = 0;  // [N]
    void add(const LoadSample& sample, double rubs);
    void clear();
};

/// The load that samples put on a wire.
class LoadAlong {
public:
    /// @param samples  in any order; stretches may overlap
    explicit LoadAlong(std::span<const LoadSample> samples);

    struct Place {
        double value = 0, at = 0;
    };
    /// N of the closed stretch [N].
    [[nodiscard]] double on(double from, double to) const { return upto(to, true) - upto(from, false); }
    [[nodiscard]] double per_length(double s, double window) const { return on(s - window / 2, s + window / 2) / window; }
    /// The stretch of `length` that bears most [N], and its middle [m].
    [[nodiscard]] Place most_on(double length) const;

private:
    /// Load up to x, with the load at x itself or without it [N]. @param after  the first knot beyond x
    [[nodiscard]] double upto(double x, bool closed, std::size_t after) const;
    [[nodiscard]] double upto(double x, bool closed) const;
    struct Knot {
        double s;       // where the load per metre changes or a point bears some
        double before;  // borne up to here [N]
        double jump;    // here [N]
        double slope;   // per metre from here to the next [N/m]
    };
    std::vector<Knot> knots_;
};

/// Places with contact: ends of each, tip first [m].
struct ContactRegion {
    double begin = 0, end = 0;
};
[[nodiscard]] std::vector<ContactRegion> contact_regions(std::span<const LoadSample> samples, double window);

/// How a wire's readings are taken.
struct AlongSpec {
    double window = 0;   // asked for [m]
    double patch = 0;    // [m]
    double spacing = 0;  // of its samples against the wall [m]; 0: they stand for no length
};

/// The greatest force per length and on a patch with their places, and the lengths that they are taken over.
[[nodiscard]] ContactAlong greatest_loads(std::span<const LoadSample> samples, const AlongSpec& spec);

/// Readings of all wires, and `per_length`, `pressure` and `region` of every row: of rows between instruments those of body a.
/// @param specs, wall, instruments  [wires]
void read_along(std::span<ContactRow> rows, std::span<const AlongSpec> specs, std::span<ContactAlong> wall,
                std::span<ContactAlong> instruments);

}  // namespace seldinger

// Layouts of contact between instruments (D13), shared by kernels, their host twin and the code that fills the buffers.
//
// A rod is divided into cells of about two radii, fixed in its material, so that what a contact carries from step to step
// (elastic slip, approach speed) lives on material. Contact is searched for from the cells of one rod, a, to the curve of
// another, b, or to a distant part of the same rod. One cell may touch several stretches of b, each in a slot.
#ifndef SEL_SHARED_INSTRUMENT_TYPES_H
#define SEL_SHARED_INSTRUMENT_TYPES_H
#include "shared/contact_types.h"

SEL_BEGIN

#define SEL_INSTRUMENT_SLOTS 4    // stretches that one cell is near to, at most
#define SEL_CELL_PIECES 8         // smooth ones that one cell is cut into, at most
#define SEL_INSTRUMENT_POINTS 128  // of one slot: Gauss points; four of a piece, or 24 of a lobe in a quarter of a cell

#define SEL_FOLLOWED ((real)0.5)  // radii of a: gap up to which a cell that touches nothing has its approach speed recorded

#define SEL_TOUCH_NONE 0u
#define SEL_TOUCH_INSIDE 1u   // a is in the lumen of b
#define SEL_TOUCH_OUTSIDE 2u  // surface to surface
#define SEL_TOUCH_SELF 3u     // the same of one rod

// The rods as the kernels find them.
typedef struct InstrumentRod {
    uint node, count, count_t0;  // its nodes in the concatenated arrays: now, at the start of the step
    uint epoch;                  // of this step
    uint cell;                   // its first cell
    uint live;                   // cells that are inside now; 0: nothing acts on it
    uint pair, pairs;            // those in which it is a
    real spacing;                // length of a cell [m]
    real inside;                 // material that is inside: coordinate of the hub [m]
    real longest_edge, widest;   // edge, radius [m]
} InstrumentRod;

// What a cell's surface is.
typedef struct InstrumentSurface {
    real radius, lumen;  // [m]; lumen 0: solid
    real modulus;        // k_f of the outer surface, pressure per depth [N/m^3]; 0: rigid
    real lumen_modulus;  // of the inner one
    real mu_static, mu_sliding;
    real load;  // own weight [N/m], by which the law's constants are reckoned
} InstrumentSurface;

// Two rods that may touch, or one with itself. Selects cells of a: those whose arc length from the hub, which instruments inside
// each other share, is at least `from` and less than `until`. If a rod inside is named, either counts from its length.
typedef struct InstrumentPair {
    uint a, b;                   // rods
    uint touch;                  // SEL_TOUCH_*
    uint from_rod, until_rod;    // or SEL_NO_ROD
    uint ends;                   // outside: 1: the tip of b touches, as a ball
    real from, until;            // [m]
    real stiffness, exponent;    // of the law, per metre and depth^exponent; 0: from the moduli
    real damping;                // beta of (D7)
    real mu_static, mu_sliding;  // < 0: those of the surfaces
    real spread;                 // of one with itself: 1/B(1/2, exponent + 1/2) (instrument_self.h)
} InstrumentPair;
#define SEL_NO_ROD 0xffffffffu

// What a cell is near to, as it was found.
typedef struct InstrumentSlot {
    uint pair, touch;  // touch 0: none
    real at;           // where along b; of one with itself: the first of its cells that are near
    uint cells, pad;   // of one with itself: how many
} InstrumentSlot;

// State of one slot of a cell from step to step, with its last force. In `contact`: slip and friction are those on a,
// `normal` points from b to a's side that is pushed, `triangle` is the edge of b, `point` is on b's surface.
typedef struct InstrumentState {
    ContactState contact;
    real along_a, along_b;  // material coordinates of the middle of what touches [m]
    real length;            // metres of a that touch
    uint pair, touch;
} InstrumentState;

// One point of a: gap's gradient and Hessian as functions of the six nodes that it depends on. With delta = x_a - c_b,
//   d gap = n . delta + turn . (change of b's derivative),
//   d2 gap = delta m delta + bend (p . delta + q . (change of b's derivative))^2
typedef struct InstrumentPoint {
    real wa[3], wb[3], db[3];  // weights of x_a, c_b and of b's derivative
    real n[3], turn[3], m[6];  // m: xx xy xz yy yz zz
    real bend, p[3], q[3];
    real force, slope;    // along n on a [N], and its growth with depth [N/m]
    uint node_a, node_b;  // first of three, in the rods
} InstrumentPoint;

// A direction on the surfaces, as the nodes feel it: x_i w_i v + d_i turn, and the spins of two edges (spline.h).
typedef struct InstrumentRow {
    real v[3], turn_a[3], turn_b[3], spin_a, spin_b;
} InstrumentRow;

// Force of one slot, beside its points.
typedef struct InstrumentForce {
    // friction, at the middle of the contact
    real wa[3], da[3], wb[3], db[3];
    real n[3], turn[3];
    InstrumentRow force, along, across;  // what it exerts on a; directions of the slip and across it
    real stiff_along, stiff_across;      // -df/dslip [N/m]
    real skew;                           // mu times the slope of the normal force: -df/dq = -skew along (x) d gap
    real depth;                          // deepest, negative: gap [m]
    real clear;                          // so far do both rods together move at least before anything touches [m]; 0: not known
    real normal_sum, friction_sum, sliding_sum, length;
    real slope_sum;      // of the points: growth of the normal force with depth [N/m]
    real friction_work;  // on both rods together, over the step [J]
    real stored;         // the most that it can give back [J]
    uint node_a, node_b;
    uint count;  // points that push
    uint flags;  // SEL_FORCE_*
    uint pair, pad;
} InstrumentForce;

// One step of one launch; passed by value.
typedef struct InstrumentParams {
    uint item_count;
    uint friction;  // SEL_FRICTION_*
    uint settling;  // SEL_SETTLE_*
    uint follow;    // 1: what is near is followed, whether it touches or not; 0: what touches is
    uint node_count;  // of all rods
    uint unused;
    real inv_dt;    // 0 in static equilibrium
    real smooth_speed;
    real skin;  // gap up to which cells are listed, for nodes that move by half of it [m]
} InstrumentParams;

SEL_END
#endif

// Layouts of the contact stage, shared by kernels, their host references and the code that fills the buffers.
//
// Quadrature points of the wire are fixed in the material. Their state from step to step (anchors, approach speed, rolling angle)
// therefore survives splits, merges and changes of triangle. Records are structs, not split arrays: every kernel that touches a
// quadrature point reads its whole record, so one cache line serves it; nodes and triangles are split arrays.
#ifndef SEL_SHARED_CONTACT_TYPES_H
#define SEL_SHARED_CONTACT_TYPES_H
#include "shared/portable.h"

SEL_BEGIN

// Friction laws, as enum FrictionLaw in engine/include/seldinger/contact/contact_spec.h.
#define SEL_FRICTION_STICK_SLIP 0
#define SEL_FRICTION_SMOOTH 1
#define SEL_FRICTION_SIGN 2
#define SEL_FRICTION_NONE 3

// Normal laws as the kernels tell them apart, see contact/contact_spec.h: hunt-crossley and lankarani-nikravesh are one, damped.
#define SEL_NORMAL_DAMPED 0
#define SEL_NORMAL_AUGMENTED 1
#define SEL_NORMAL_CONSTRAINT 2
#define SEL_NORMAL_IMPULSE 3
#define SEL_NORMAL_BARRIER 4

// Flags of a contact point.
#define SEL_CONTACT_ACTIVE 1u   // normal force > 0
#define SEL_CONTACT_STUCK 2u    // inside the static cone
#define SEL_CONTACT_OUTSIDE 4u  // the quadrature point is beyond the wall
#define SEL_CONTACT_WHOLE 8u    // of a cell of an instrument: it touches all along (instrument_cell.h)

// Constant while the wire's sections stand. A quadrature point represents `weight` metres of wire; the tip's own point law (D6c)
// has weight 1 and stiffness in N/m^n.
typedef struct QuadratureModel {
    real weight;              // [m]; 1 for the tip's point law
    real length;              // metres of wire that it stands for in readings: weight, or 0 at the tip
    real radius;              // wire [m]
    real reach;               // beyond the radius where a second wall is looked for [m]
    real stiffness;           // k: force per metre = k depth^n [N/m^(n+1)]
    real exponent;            // n
    real friction_stiffness;  // k_t per metre [N/m^2], constant in time (D9)
    real mu_static, mu_sliding;
    real speed_floor;  // least v- of (D7) [m/s]
    real depth_limit;  // depth_max of the hardening law [m]; 0: no hardening
    real depth_exact;  // up to here the law is k depth^n without hardening, < depth_limit [m]
    real damping;      // beta of (D7)
    real roll_arm;     // bracket of (D10): moment per metre = roll_arm a f; 0: no rolling resistance
    real roll_depth;   // a^2 = roll_depth depth + roll_force f  (half-width of the line contact) [m]
    real roll_force;   // [m^2 / (N/m)]
    // of the laws in multiplier_law.h only
    real penalty_stiffness;  // augmented, constraint, impulse: least k of (D8) [N/m^2]; barrier: kappa [N/m^2]
    real law_length;         // augmented, constraint: overlap allowed [m]; impulse: speed allowed [m/s]; barrier: d_hat [m]
    real line_mass;          // of the wire [kg/m]
    real restitution;        // impulse
    real multiplier_most;    // augmented, constraint, impulse: largest multiplier [N/m]
} QuadratureModel;

// Which edge a quadrature point lies on at the end of the step and where it was at its start. Edge: index of its tip-side node in
// the concatenated node arrays.
typedef struct QuadraturePlace {
    uint edge;     // at the end of the step
    uint edge_t0;  // at its start; SEL_NO_EDGE: the quadrature point has just been fed in
    real bary;     // position = (1 - bary) node[edge] + bary node[edge + 1]
    real bary_t0;
    uint epoch;             // of this step for the quadrature point's wire; what the last one wrote has epoch - 1
    uint pad;
    real radius_reduction;  // barrier: by how much the wire is taken to be thinner, see barrier_start [m]
} QuadraturePlace;
#define SEL_NO_EDGE 0xffffffffu

// State of one contact point (a quadrature point against one side of the lumen) from step to step, with its last force.
typedef struct ContactState {
    real slip[3];       // elastic part of the tangential displacement (D9) [m]
    real normal[3];     // unit, into the lumen
    real point[3];      // on the wall, relative to the mesh centre [m]
    real gap;           // [m]
    real rate;          // rate of deepening in the last step [m/s]
    real approach;      // v- of (D7) while in contact [m/s]
    real roll;          // elastic rolling angle [rad]
    real normal_force;  // [N]
    real friction[3];   // on the wire [N]
    real moment;        // rolling, about the tangent [N m]
    uint triangle;      // in leaf order
    uint flags;
    uint epoch;  // step that wrote it; an older epoch means no contact in the last step
    uint pad;
} ContactState;

// What augmented, constraint and impulse know of one contact point while a step is solved (multiplier_law.h).
typedef struct MultiplierState {
    real normal[3];    // of the wall that it speaks of
    real force;        // lambda of (D8) [N/m]
    real friction[3];  // tangential multiplier of `constraint` [N/m]
    real stiffness;    // k of (D8) [N/m^2]
    real miss;         // |change of a multiplier| / its stiffness at the last update [m]
    uint live;         // there is such a contact point
    uint pad;
} MultiplierState;

// Forces of one quadrature point, to be reduced to its edge. F, and -dF/dq split so that the host may leave out the unsymmetric
// part of sliding friction. q = (x, y, z, theta), and the edge's vector w = x_b - x_a, which the section turns with. Seen from
// the nodes, friction at the surface is a force on the axis point, a torque, and a couple. `contacts` 0: only depth and flags are
// written; without SEL_FORCE_COUPLE what stands in the second block is 0.
typedef struct ContactForce {
    real force[4];  // on the axis point [N], about the tangent [N m]
    real sym[10];   // symmetric part: xx xy xz xt yy yz yt zz zt tt
    real
        skew[12];  // 4 x 3: -d(force[row])/d(x, y, z) due to the normal force's change while sliding, or rolling beyond the yield
    // the couple
    real couple[3];                                           // on node b, and its negative on node a [N]
    real sym_xw[9];                                           // row x, column w
    real sym_ww[6];                                           // xx xy xz yy yz zz
    real sym_tw[3];                                           // theta against w
    real skew_wx[9];                                          // -d(couple)/d(x, y, z), as `skew`
    real depth;                                               // deepest overlap, negative: gap [m]
    real normal_sum, friction_sum, sliding_sum, rolling_sum;  // magnitudes [N], [N m]
    real normal_work, friction_work, rolling_work;            // on the wire, over the step [J]
    real length;                                              // metres of wire in contact
    uint flags;                                               // SEL_FORCE_*
    uint contacts;
} ContactForce;
#define SEL_FORCE_BLOCKED 1u  // deeper than the law allows, and deepening: the trial is inadmissible
#define SEL_FORCE_SLIDING 2u  // `skew` is not zero
#define SEL_FORCE_OUTSIDE 4u
#define SEL_FORCE_COUPLE 8u  // friction acts

// Sum over an edge's quadrature points, in quadrature point order: generalised force on (x_a, x_b, theta) and blocks of -dF/dq.
// Index s: 6 entries xx xy xz yy yz zz of a symmetric 3 x 3 block; s_ab and u: 9 entries, row-major.
typedef struct EdgeForce {
    real force_a[3], force_b[3], torque;
    real s_aa[6], s_ab[9], s_bb[6];
    real st_a[3], st_b[3], s_tt;  // x-theta coupling and theta-theta
    real u_aa[9], u_ab[9], u_ba[9], u_bb[9];
    real ut_a[3], ut_b[3];  // row theta against x_a, x_b
    real depth, normal_sum, friction_sum, sliding_sum, rolling_sum, length;
    real normal_work, friction_work, rolling_work;
    uint flags, contacts;
} EdgeForce;

#define SEL_SETTLE_STUCK 1u    // every contact point sticks, whatever the cone
#define SEL_SETTLE_SLIDING 2u  // every contact point has slid to where it is: its cone is that of mu_sliding

// What a step of one Newton iteration, or an explicit one, takes contact from: the state at its start and the velocity known
// there. Where the step starts (`hi_t0`, `theta_t0`) is then where that velocity comes from in inv_dt, so that `move` is the
// known one.
#define SEL_KNOWN_LINEAR 1u  // linearised (D5): force and tangent as functions of the move from the start of the step
#define SEL_KNOWN_FORCE 2u   // explicit: the force alone

// One step of one launch; passed by value.
typedef struct ContactParams {
    uint item_count;
    uint slots;         // per quadrature point: cells of the tree (walk.h); layer: triangles
    uint friction;      // SEL_FRICTION_*
    uint settling;      // SEL_SETTLE_*, scene start = "settled"; 0: not settling
    uint normal_law;    // SEL_NORMAL_*
    uint known;         // SEL_KNOWN_*; 0: the law at the trial, moves are those of the step
    uint returns;       // 1: a step begins with an evaluation where the last one has ended (TouchMemory)
    uint pad;
    real inv_dt;        // [1/s]; 0 in static equilibrium: no damping
    real smoothing;     // width of the smooth maximum over neighbouring facets, as a fraction of the radius [-]
    real smooth_speed;  // regularisation of `smooth` [m/s]
} ContactParams;

SEL_END
#endif

// Depth where facets meet in a valley. There the nearest point jumps from one facet to another; the depth is a smooth maximum
// over the planes of facets (D6d),
//     depth = max over lambda of  sum_i lambda_i depth_i + sum_{i<j} eps_ij lambda_i lambda_j,
//     eps_ij = smoothing r (sqrt(|n_i - n_j|^2 + 4 smoothing^2) - 2 smoothing),
// with shares lambda >= 0 of sum 1. Its gradient is sum_i lambda_i n_i. The maximum is unique, because the eps are negative
// definite for shares of sum 0 (a Bernstein function of squared distances), so the force turns without a jump at corners of three
// facets too. For two planes it is
//     depth_0 + max(0, eps - (depth_0 - depth_1))^2 / (4 eps),
// whose width vanishes with the angle between them, with a bias of at most eps/4. Shares of other planes k draw a plane j in by
// sum_k lambda_k (eps_jk - eps_0k) <= smoothing r |n_j - n_0|, since eps grows with |n_i - n_j| by at most smoothing r. So a
// plane with depth_j <= depth_0 - smoothing r |n_j - n_0| has no share, and the list of planes may begin and end there. With
// eps_0j as the limit the normal would jump by 1e-3 rad where plane j comes to two planes that are nearly as deep.
//
// Flat valleys, of an angle phi below 4 smoothing: the nearest point of the neighbour is the edge, which does not count, until
// its plane is less deep by d phi^2/2 only, d the axis' distance. There its share must begin with 0: eps <= r phi^2/4, for any d
// >= r/2. With eps = smoothing r phi the normal would jump by up to 5e-4 rad.
//
// What counts is local: a plane counts once, with the nearest of its triangles (else a valley would push as often as it is cut
// into triangles); a point counts once, whichever of its triangles has it; and a point on an edge does not count where the wall
// goes on from it towards the ball (opposite_wall.h). Else a ridge would be joined with its own edge.
#ifndef SEL_SHARED_SMOOTH_MAXIMUM_H
#define SEL_SHARED_SMOOTH_MAXIMUM_H
#include "shared/contact_gap.h"

SEL_BEGIN

#define SEL_COPLANAR \
    1e-5f  // normals nearer than this [rad] lie in one plane: float32 vertices of one, 1 mm apart, differ by 4e-6

#define SEL_SMOOTH_PLANES 16  // round one ball: half a circle of 24 facets and a few more (F12)

// A triangle in front of the ball.
typedef struct FacingTriangle {
    vec3 v, n, facet;  // from its closest point to the ball's centre; the same, unit; its normal
    real d;            // |v| [m]
    int feature;       // of the triangle, that has this point
} FacingTriangle;

// Does triangle t face the ball, within its reach?
SEL_FN int faces(ContactBall ball, Triangle tri, uint boundary, FacingTriangle* out)
{
    const real range2 = (ball.radius + ball.reach) * (ball.radius + ball.reach);
    int feature;
    out->v = ball.p - closest_on_triangle(ball.p, tri, &feature);
    const real d2 = dot3(out->v, out->v);
    if (d2 > range2 || !(d2 > 0)) return 0;
    out->facet = triangle_normal(tri);
    if (dot3(out->v, out->facet) <= 0 && !on_boundary(boundary, feature)) return 0;
    out->d = sqrt(d2);
    out->feature = feature;
    out->n = (1 / out->d) * out->v;
    return 1;
}

// A plane of the wall, as the ball sees it.
typedef struct WallPlane {
    vec3 facet;        // its normal
    vec3 turn;         // direction to the ball, less that of the nearest point
    real depth;        // less that of the nearest point: <= 0 [m]
    real share, pull;  // lambda; derivative of the above with it [m]
    uint triangle;     // that is nearest in it
} WallPlane;

typedef struct NeighbourPlanes {
    uint count;
    WallPlane plane[SEL_SMOOTH_PLANES];                           // the first: of the nearest point
    real lower[SEL_SMOOTH_PLANES * (SEL_SMOOTH_PLANES - 1) / 2];  // L of add_bend, row after row
} NeighbourPlanes;

// Are two normals, or two directions to the ball, the same?
SEL_FN int is_same_direction(vec3 a, vec3 b)
{
    const vec3 turn = a - b;
    return dot3(turn, turn) < (real)SEL_COPLANAR * (real)SEL_COPLANAR;
}

// eps of two directions that differ by `turn`. @param turn2  |turn|^2
SEL_FN real joint_width_of(real turn2, real radius, real smoothing)
{
    const real flat = 2 * smoothing;
    return smoothing * radius * turn2 / (sqrt(turn2 + flat * flat) + flat);
}

// eps for two directions to the ball.
SEL_FN real joint_width(vec3 a, vec3 b, ContactBall ball)
{
    const vec3 turn = a - b;
    return joint_width_of(dot3(turn, turn), ball.radius, ball.smoothing);
}

SEL_FN WallPlane wall_plane(vec3 facet, vec3 turn, real depth, uint triangle)
{
    const WallPlane plane = {facet, turn, depth, 0, 0, triangle};
    return plane;
}

// Is the plane of a facing triangle joined with that of the nearest point, `first`?
SEL_FN int is_joined(SEL_OUT const NeighbourPlanes* planes, SEL_OUT const ContactPoint* first, ContactBall ball,
                     uint t, FacingTriangle facing, WallPlane* out)
{
    const vec3 none = make_vec3(0, 0, 0);
    *out = wall_plane(facing.facet, facing.n - first->normal, ball.radius - facing.d - first->depth, t);
    if (is_same_direction(facing.facet, planes->plane[0].facet) || is_same_direction(out->turn, none)) return 0;
    return ball.smoothing * ball.radius * sqrt(dot3(out->turn, out->turn)) + out->depth > 0;
}

// Which plane is missed least when `found` comes to a full list: the shallower of the two whose directions differ least. The
// first plane stays. @return the number of planes for `found` itself
SEL_FN uint least_missed(SEL_OUT const NeighbourPlanes* planes, WallPlane found)
{
    uint at = planes->count;
    real least = (real)1e30;
    for (uint i = 1; i <= planes->count; ++i) {
        const WallPlane a = i < planes->count ? planes->plane[i] : found;
        for (uint k = 0; k < i; ++k) {
            const vec3 turn = a.turn - planes->plane[k].turn;
            const real d2 = dot3(turn, turn);
            if (!(d2 < least)) continue;
            least = d2;
            at = k > 0 && planes->plane[k].depth < a.depth ? k : i;
        }
    }
    return at;
}

// Takes the plane into the list: in the place of the same plane or point when it is nearer, else at the end, else for the one
// that is missed least.
SEL_FN void keep_plane(SEL_OUT NeighbourPlanes* planes, WallPlane found)
{
    const uint count = planes->count;
    uint at = count;
    for (uint k = 1; k < count; ++k)
        if (is_same_direction(planes->plane[k].facet, found.facet) || is_same_direction(planes->plane[k].turn, found.turn))
            at = k;
    if (at < count) {
        if (planes->plane[at].depth < found.depth) planes->plane[at] = found;
        return;
    }
    if (count < SEL_SMOOTH_PLANES) planes->count = count + 1;
    else at = least_missed(planes, found);
    if (at < SEL_SMOOTH_PLANES) planes->plane[at] = found;
}

#ifdef SEL_FLOAT32
    #define SEL_SHARED_OUT 1e-5f  // of the widest eps: pulls that differ by less are equal
#else
    #define SEL_SHARED_OUT 1e-13
#endif
#define SEL_MOST_EXCHANGES 2048

// Moves share between two planes, from the one that pulls least to the one that pulls most. @return they were equal
SEL_FN int exchange_shares(SEL_OUT NeighbourPlanes* planes, ContactBall ball)
{
    uint least = 0, most = 0;
    for (uint k = 1; k < planes->count; ++k) {
        const real pull = planes->plane[k].pull;
        if (pull > planes->plane[most].pull) most = k;
        if (planes->plane[k].share > 0 && (!(planes->plane[least].share > 0) || pull < planes->plane[least].pull)) least = k;
    }
    const real gain = planes->plane[most].pull - planes->plane[least].pull;
    if (!(gain > (real)SEL_SHARED_OUT * ball.smoothing * ball.radius)) return 1;
    const vec3 from = planes->plane[least].turn, to = planes->plane[most].turn;
    const real best = gain / (2 * joint_width(from, to, ball));
    const real share = min_r(best, planes->plane[least].share);
    planes->plane[most].share += share;
    planes->plane[least].share = best < planes->plane[least].share ? planes->plane[least].share - share : (real)0;
    for (uint k = 0; k < planes->count; ++k)
        planes->plane[k].pull +=
            share * (joint_width(planes->plane[k].turn, to, ball) - joint_width(planes->plane[k].turn, from, ball));
    return 0;
}

// Shares of the planes. Two planes know theirs at once; of more the best pair exchanges share until all pull alike.
SEL_FN void share_out(SEL_OUT NeighbourPlanes* planes, ContactBall ball)
{
    const vec3 none = make_vec3(0, 0, 0);
    planes->plane[0].share = 1;
    planes->plane[0].pull = 0;
    for (uint k = 1; k < planes->count; ++k) {
        planes->plane[k].share = 0;
        planes->plane[k].pull = planes->plane[k].depth + joint_width(planes->plane[k].turn, none, ball);
    }
    SEL_ROLLED for (uint round = 0; round < SEL_MOST_EXCHANGES; ++round) if (exchange_shares(planes, ball)) break;
}

// adds a a^T to a symmetric matrix, xx xy xz yy yz zz
SEL_FN void add_square(SEL_OUT real* to, vec3 a)
{
    to[0] += a.x * a.x;
    to[1] += a.x * a.y;
    to[2] += a.x * a.z;
    to[3] += a.y * a.y;
    to[4] += a.y * a.z;
    to[5] += a.z * a.z;
}

// Second derivatives of the depth: how shares move between the planes that have any. With the turns u_i from one of these planes,
// 0, to the others they are
//     sum_ij u_i (M^-1)_ij u_j^T,   M_ij = eps_i0 + eps_j0 - eps_ij,
// the maximum's own equations. M = L L^T is positive definite, so they are the sum of squares of the rows of L^-1 u.
// The planes are used up: plane j keeps u_j as its turn and row j of L^-1 u as its facet. An array of its own, which a variable
// indexes, would lie in a graphics card's scratch memory.
SEL_FN void add_bend(SEL_OUT ContactPoint* first, SEL_OUT NeighbourPlanes* planes, ContactBall ball)
{
    const vec3 none = make_vec3(0, 0, 0);
    vec3 base = none;
    int any = 0;
    uint count = 0;
    SEL_ROLLED for (uint k = 0; k < planes->count; ++k)
    {
        if (!(planes->plane[k].share > 0)) continue;
        if (!any) {
            any = 1;
            base = planes->plane[k].turn;
            continue;
        }
        const vec3 turn = planes->plane[k].turn - base;
        const real eps = joint_width(turn, none, ball);
        SEL_OUT real* of = planes->lower + count * (count + 1) / 2;
        vec3 left = turn;
        real rest = 2 * eps;
        for (uint j = 0; j < count; ++j) {
            SEL_OUT const real* other = planes->lower + j * (j + 1) / 2;
            const vec3 u = planes->plane[j].turn;
            real m = eps + joint_width(u, none, ball) - joint_width(turn, u, ball);
            for (uint l = 0; l < j; ++l) m -= of[l] * other[l];
            const real at = m / other[j];
            of[j] = at;
            left = left - at * planes->plane[j].facet;
            rest -= at * at;
        }
        const real pivot = sqrt(max_r(rest, (real)SEL_SHARED_OUT * eps));
        const vec3 row = (1 / pivot) * left;
        of[count] = pivot;
        planes->plane[count].turn = turn;
        planes->plane[count].facet = row;
        add_square(first->hessian, row);
        ++count;
    }
}

// Depth, gradient and second derivatives of the smooth maximum in place of those of the nearest facet.
SEL_FN void smooth_maximum(SEL_OUT ContactPoint* first, SEL_OUT NeighbourPlanes* planes, ContactBall ball)
{
    if (planes->count < 2) return;
    share_out(planes, ball);
    real depth = 0, pull = planes->plane[0].pull;
    for (uint k = 0; k < planes->count; ++k) {
        depth += planes->plane[k].share * planes->plane[k].depth;
        pull = max_r(pull, planes->plane[k].pull);
        first->normal = first->normal + planes->plane[k].share * planes->plane[k].turn;
    }
    first->depth += (real)0.5 * (depth + pull);
    add_bend(first, planes, ball);
}

SEL_END
#endif

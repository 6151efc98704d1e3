// The published detection, per edge of wire between two control nodes: spheres at the nodes, three cases, dichotomy for the
// touching length L', oriented layer L' x w x h on the wall side. Then the layer is tested against the tree, and a ray from each
// candidate's centre along its normal against the wire's cylinder. Kept faithful, with its own mesh dependence: this is
// the measured method.
//
// Choices that the source leaves open, the same for every scene unless the user sets them:
//   sphere     radius r + H: a contact whose overlap is a micrometre would be lost with r alone
//   dichotomy  8 halvings: L' to 1/256 of the edge
//   w          r (1/4 + 7/4 r/R), R the lumen radius there: 2 r in a lumen as narrow as the wire, r/4 in a wide one
//   h          r + H, measured from the axis towards the wall, so that every wall nearer than H to the wire's surface is inside
//   H          r / 2
#ifndef SEL_SHARED_LAYER_H
#define SEL_SHARED_LAYER_H
#include "shared/contact_law.h"
#include "shared/contact_records.h"
#include "shared/point_motion.h"
#include "shared/wall_distance.h"

SEL_BEGIN

#define SEL_LAYER_HALVINGS 8

// A wire's edge for the layer: what changes from edge to edge.
typedef struct LayerEdge {
    uint node;              // tip-side node in the concatenated arrays
    uint epoch;             // see QuadraturePlace
    real width;             // w [m]
    real height;            // h [m]
    real reach;             // H [m]
    QuadratureModel model;  // of one pair: line stiffness x 1 mm (weight 1e-3)
} LayerEdge;

typedef struct Layer {
    vec3 centre, along, side, up;  // unit axes; up points from the axis to the wall
    real extent[3];                // half of L', w, h [m]
    real from, to;                 // touching stretch, as fractions of the edge
    int found;
} Layer;

// Does the sphere touch the wall? Adds the inward normals of the triangles it touches to *normal.
SEL_FN int sphere_touches(vec3 p, real radius, WallView wall, vec3* normal)
{
    const real r2 = radius * radius;
    const vec3 zero = make_vec3(0, 0, 0);
    int states = 0;
    Descent way = descent_from(0);
    while (way.at != SEL_NO_NODE) {
        const TreeNode node = wall.nodes[way.at];
        const int near = box_distance2(p, node) <= r2;
        if (near && SEL_IS_INNER(node.count)) {
            go_down(&way, node);
            continue;
        }
        go_on(&way, wall.nodes);
        if (!near) continue;
        for (uint k = 0; k < SEL_LEAF_TRIANGLES(node.count); ++k) {
            const Triangle tri = load_triangle(wall.vertices, node.left_or_first + k, zero);
            int feature;
            const vec3 v = p - closest_on_triangle(p, tri, &feature);
            if (dot3(v, v) > r2) continue;
            states = 1;
            *normal = *normal + triangle_normal(tri);
        }
    }
    return states;
}

// Steps 2 to 4: the layer of the edge a -> b.
SEL_FN Layer make_layer(vec3 a, vec3 b, LayerEdge e, WallView wall)
{
    const real radius = e.model.radius, reach = e.reach;
    Layer layer;
    layer.found = 0;
    layer.from = 0;
    layer.to = 1;
    vec3 normal = make_vec3(0, 0, 0);
    const int at_a = sphere_touches(a, radius + reach, wall, &normal);
    const int at_b = sphere_touches(b, radius + reach, wall, &normal);
    if (!at_a && !at_b) return layer;
    const vec3 edge = b - a;
    if (at_a != at_b) {
        // the far end of the touching stretch, by halving
        real in = at_a ? 0 : 1, out = at_a ? 1 : 0;
        for (int k = 0; k < SEL_LAYER_HALVINGS; ++k) {
            const real mid = (in + out) / 2;
            vec3 ignored = make_vec3(0, 0, 0);
            if (sphere_touches(a + mid * edge, radius + reach, wall, &ignored)) in = mid;
            else out = mid;
        }
        if (at_a) layer.to = in;
        else layer.from = in;
    }
    const real length = sqrt(dot3(edge, edge));
    layer.along = (1 / length) * edge;
    const vec3 up = -(normal - dot3(normal, layer.along) * layer.along);
    const real size = sqrt(dot3(up, up));
    if (!(size > 0)) return layer;  // normals cancel: walls all round, the published layer has no side to lie on
    layer.up = (1 / size) * up;
    layer.side = cross3(layer.along, layer.up);
    // a contact point at a node alone keeps a sliver of length
    layer.extent[0] = max_r((layer.to - layer.from) * length / 2, radius / 8);
    layer.extent[1] = e.width / 2;
    layer.extent[2] = e.height / 2;
    layer.centre = a + ((layer.from + layer.to) / 2) * edge + (e.height / 2) * layer.up;
    layer.found = 1;
    return layer;
}

SEL_FN real abs_r(real x) { return x < 0 ? -x : x; }

// Layer against an axis-parallel box, by the layer's and the box's own face normals (edges' cross products left out: the test may
// say yes too often, never no).
SEL_FN int layer_meets_box(Layer layer, TreeNode box)
{
    const vec3 extent = make_vec3(((real)box.hi[0] - (real)box.lo[0]) / 2, ((real)box.hi[1] - (real)box.lo[1]) / 2,
                                  ((real)box.hi[2] - (real)box.lo[2]) / 2);
    const vec3 d = make_vec3(((real)box.hi[0] + (real)box.lo[0]) / 2, ((real)box.hi[1] + (real)box.lo[1]) / 2,
                             ((real)box.hi[2] + (real)box.lo[2]) / 2) -
                   layer.centre;
    const vec3 u = layer.along, v = layer.side, w = layer.up;
    if (abs_r(d.x) > extent.x + layer.extent[0] * abs_r(u.x) + layer.extent[1] * abs_r(v.x) + layer.extent[2] * abs_r(w.x))
        return 0;
    if (abs_r(d.y) > extent.y + layer.extent[0] * abs_r(u.y) + layer.extent[1] * abs_r(v.y) + layer.extent[2] * abs_r(w.y))
        return 0;
    if (abs_r(d.z) > extent.z + layer.extent[0] * abs_r(u.z) + layer.extent[1] * abs_r(v.z) + layer.extent[2] * abs_r(w.z))
        return 0;
    if (abs_r(dot3(d, u)) > layer.extent[0] + extent.x * abs_r(u.x) + extent.y * abs_r(u.y) + extent.z * abs_r(u.z)) return 0;
    if (abs_r(dot3(d, v)) > layer.extent[1] + extent.x * abs_r(v.x) + extent.y * abs_r(v.y) + extent.z * abs_r(v.z)) return 0;
    return abs_r(dot3(d, w)) <= layer.extent[2] + extent.x * abs_r(w.x) + extent.y * abs_r(w.y) + extent.z * abs_r(w.z);
}

// One axis of the separating test between the box |x| <= extent and a triangle in its frame.
SEL_FN int separated(vec3 axis, vec3 a, vec3 b, vec3 c, real hx, real hy, real hz)
{
    const real p = dot3(axis, a), q = dot3(axis, b), s = dot3(axis, c);
    const real reach = hx * abs_r(axis.x) + hy * abs_r(axis.y) + hz * abs_r(axis.z);
    return min_r(p, min_r(q, s)) > reach || max_r(p, max_r(q, s)) < -reach;
}

// Layer against triangle, exact: thirteen axes [Akenine-Moeller01, doi:10.1080/10867651.2001.10487535].
SEL_FN int layer_meets_triangle(Layer layer, Triangle tri)
{
    const vec3 p = tri.a - layer.centre, q = tri.b - layer.centre, s = tri.c - layer.centre;
    const vec3 a = make_vec3(dot3(p, layer.along), dot3(p, layer.side), dot3(p, layer.up));
    const vec3 b = make_vec3(dot3(q, layer.along), dot3(q, layer.side), dot3(q, layer.up));
    const vec3 c = make_vec3(dot3(s, layer.along), dot3(s, layer.side), dot3(s, layer.up));
    const real hx = layer.extent[0], hy = layer.extent[1], hz = layer.extent[2];
    const vec3 x = make_vec3(1, 0, 0), y = make_vec3(0, 1, 0), z = make_vec3(0, 0, 1);
    if (separated(x, a, b, c, hx, hy, hz) || separated(y, a, b, c, hx, hy, hz) || separated(z, a, b, c, hx, hy, hz)) return 0;
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    if (separated(cross3(ab, bc), a, b, c, hx, hy, hz)) return 0;
    if (separated(cross3(x, ab), a, b, c, hx, hy, hz) || separated(cross3(x, bc), a, b, c, hx, hy, hz) ||
        separated(cross3(x, ca), a, b, c, hx, hy, hz))
        return 0;
    if (separated(cross3(y, ab), a, b, c, hx, hy, hz) || separated(cross3(y, bc), a, b, c, hx, hy, hz) ||
        separated(cross3(y, ca), a, b, c, hx, hy, hz))
        return 0;
    return !(separated(cross3(z, ab), a, b, c, hx, hy, hz) || separated(cross3(z, bc), a, b, c, hx, hy, hz) ||
             separated(cross3(z, ca), a, b, c, hx, hy, hz));
}

// A ray from a triangle's centre along its normal, against the wire's cylinder.
typedef struct RayHit {
    vec3 normal;  // of the triangle, unit
    vec3 centre;  // of the triangle
    real gap;     // along the ray from the wall to the wire's near surface [m]; negative: the centre is inside the wire
    real bary;    // of the hit on the edge
    int hit;
} RayHit;

// a: first node, edge: to the second; all relative to one origin
SEL_FN RayHit ray_against_wire(Triangle tri, vec3 a, vec3 edge, real radius)
{
    RayHit out;
    out.hit = 0;
    out.gap = out.bary = 0;
    out.normal = triangle_normal(tri);
    out.centre = ((real)1 / 3) * (tri.a + tri.b + tri.c);
    const real length2 = dot3(edge, edge);
    const vec3 m = out.centre - a;
    // components across the axis: |m_ + t n_|^2 = r^2
    const vec3 n_ = out.normal - (dot3(out.normal, edge) / length2) * edge;
    const vec3 m_ = m - (dot3(m, edge) / length2) * edge;
    const real A = dot3(n_, n_), B = dot3(m_, n_), C = dot3(m_, m_) - radius * radius;
    const real root = B * B - A * C;
    if (!(A > 0) || root < 0) return out;
    out.gap = (-B - sqrt(root)) / A;
    out.bary = dot3(m + out.gap * out.normal, edge) / length2;
    out.hit = out.bary >= 0 && out.bary <= 1;
    return out;
}

// A pair found by the layer: which edge (index among LayerEdge), which triangle, and its record of the last step.
typedef struct LayerPair {
    uint edge, triangle;
    uint last;  // SEL_NO_EDGE: new
    uint pad;
} LayerPair;

SEL_FN ContactState empty_pair(uint triangle, real reach)
{
    ContactState state = no_contact_state();
    state.gap = reach;
    state.triangle = triangle;
    return state;
}

// Candidates of one edge: triangles that meet its layer and whose ray hits within H. Writes at most `slots`, and L' [m] to
// *touching. @return how many
SEL_PART uint find_pairs(LayerEdge e, NodeView nodes, WallView wall, uint slots, SEL_GLOBAL uint* found,
                         SEL_GLOBAL real* touching)
{
    *touching = 0;
    const AxisPoint at = axis_point(e.node, 0, nodes);
    const vec3 a = at.origin + at.offset;
    const vec3 zero = make_vec3(0, 0, 0);
    const Layer layer = make_layer(a, a + at.edge, e, wall);
    if (!layer.found) return 0;
    *touching = (layer.to - layer.from) * sqrt(dot3(at.edge, at.edge));
    uint count = 0;
    Descent way = descent_from(0);
    while (way.at != SEL_NO_NODE) {
        const TreeNode node = wall.nodes[way.at];
        const int meets = layer_meets_box(layer, node);
        if (meets && SEL_IS_INNER(node.count)) {
            go_down(&way, node);
            continue;
        }
        go_on(&way, wall.nodes);
        if (!meets) continue;
        for (uint k = 0; k < SEL_LEAF_TRIANGLES(node.count); ++k) {
            const uint t = node.left_or_first + k;
            const Triangle tri = load_triangle(wall.vertices, t, zero);
            if (!layer_meets_triangle(layer, tri)) continue;
            const RayHit ray = ray_against_wire(tri, a, at.edge, e.model.radius);
            if (!ray.hit || ray.gap > e.reach) continue;
            if (count < slots) found[count] = t;
            ++count;
        }
    }
    return count;
}

// The published pair as a contact point of the wire's axis point p.
SEL_FN ContactPoint contact_of_ray(RayHit ray, vec3 p, uint triangle)
{
    ContactPoint contact = no_contact_point(0);
    contact.normal = ray.normal;
    contact.to_wall = ray.centre - p;
    contact.depth = -ray.gap;
    contact.triangle = triangle;
    contact.found = 1;
    return contact;
}

// Contact of one pair; *bary gets its place on the edge. old, now: its records; of the last step, and written.
SEL_PART void evaluate_pair(LayerPair pair, LayerEdge e, ContactParams par, NodeView nodes, NodeView nodes_t0,
                          SEL_GLOBAL const float* vertices, ContactState old, SEL_OUT ContactState* now,
                          SEL_OUT ContactForce* out, SEL_GLOBAL real* bary)
{
    *out = no_force(e.model);
    out->depth = -e.reach;
    *now = empty_pair(pair.triangle, e.reach);
    const AxisPoint start = axis_point(e.node, 0, nodes);
    const Triangle tri = load_triangle(vertices, pair.triangle, start.origin);
    const RayHit ray = ray_against_wire(tri, start.offset, start.edge, e.model.radius);
    *bary = clamp_r(ray.bary, 0, 1);
    if (!ray.hit) return;
    QuadraturePlace place;
    place.edge = place.edge_t0 = e.node;
    place.bary = place.bary_t0 = *bary;
    place.epoch = e.epoch;
    place.pad = 0;
    place.radius_reduction = 0;
    AxisPoint at = start;
    at.offset = start.offset + *bary * start.edge;
    LawContext c = {e.model, motion_of(place, at, nodes, nodes_t0), par};
    add_contact_point(contact_of_ray(ray, at.offset, pair.triangle), at.origin + at.offset, old, no_multiplier(), &c, now, out);
}

SEL_END
#endif

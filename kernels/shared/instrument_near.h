// The stretches of another rod, or of the same one, near a cell; and the cell's evaluation in kernels and their twin.
//
// A cell's middle is compared with the middles of the edges of b. If the slope of the distance along b changes sign from one to
// the next, there is one nearest point between them, and a slot if it is within reach. Far stretches are passed over in leaps
// that their distance allows.
#ifndef SEL_SHARED_INSTRUMENT_NEAR_H
#define SEL_SHARED_INSTRUMENT_NEAR_H
#include "shared/instrument_self.h"

SEL_BEGIN

// Nodes of all rods at one time.
typedef struct InstrumentNodes {
    SEL_GLOBAL const real* position;
    SEL_GLOBAL const real* material;
    SEL_GLOBAL const real* theta;
} InstrumentNodes;

// Constants of a launch.
typedef struct InstrumentBodies {
    SEL_GLOBAL const InstrumentRod* rods;
    SEL_GLOBAL const InstrumentPair* pairs;
    SEL_GLOBAL const InstrumentSurface* surfaces;  // [cells]
    SEL_GLOBAL const uint* rod_of;                 // [cells]
} InstrumentBodies;

// `all`: [count][3] places, [count] material coordinates, [count] spin angles.
SEL_FN InstrumentNodes instrument_nodes(SEL_GLOBAL const real* all, uint count)
{
    const InstrumentNodes nodes = {all, all + 3 * count, all + 4 * count};
    return nodes;
}

SEL_FN InstrumentBodies instrument_bodies(SEL_GLOBAL const InstrumentRod* rods, SEL_GLOBAL const InstrumentPair* pairs,
                                          SEL_GLOBAL const InstrumentSurface* surfaces, SEL_GLOBAL const uint* rod_of)
{
    const InstrumentBodies bodies = {rods, pairs, surfaces, rod_of};
    return bodies;
}

SEL_FN SplineView spline_of(InstrumentNodes nodes, uint node, uint count)
{
    const SplineView rod = {nodes.position + 3 * node, nodes.material + node, nodes.theta + node, count};
    return rod;
}

// The slots of a cell while they are looked for; the nearest are kept.
typedef struct SlotList {
    InstrumentSlot slots[SEL_INSTRUMENT_SLOTS];
    real distance[SEL_INSTRUMENT_SLOTS];
    uint count;
} SlotList;

SEL_FN void add_slot(SlotList* list, uint pair, uint touch, real at, uint cells, real distance)
{
    uint place = list->count;
    if (place == SEL_INSTRUMENT_SLOTS) {
        place = 0;
        for (uint k = 1; k < SEL_INSTRUMENT_SLOTS; ++k)
            if (list->distance[k] > list->distance[place]) place = k;
        if (list->distance[place] <= distance) return;
    } else {
        list->count++;
    }
    list->slots[place].pair = pair;
    list->slots[place].touch = touch;
    list->slots[place].at = at;
    list->slots[place].cells = cells;
    list->distance[place] = distance;
}

// A nearest point between two places on b, if it is within `limit`.
SEL_FN void try_stretch(SplineView b, vec3 x, real low, real high, real limit, uint pair, uint touch, SlotList* list)
{
    const Closest near = closest_on(b, x, (real)0.5 * (low + high), low, high);
    const SplinePlace p = spline_place(near.at, b.count);
    const vec3 away = x - spline_sum(b, p.node, p.w);
    const real distance = sqrt(dot3(away, away));
    if (distance < limit) add_slot(list, pair, touch, near.at, 0, distance);
}

// All stretches of b near x.
SEL_FN void search_rod(SplineView b, vec3 x, real limit, real longest, uint pair, uint touch, SlotList* list)
{
    const real end = (real)(b.count - 1);
    // slope at the middle of the edge before, < 0 at the tip: whatever is nearest on the first half_length edge is tried
    real last = -1;
    int known = 1;
    uint j = 0;
    while (j + 1 < b.count) {
        const vec3 from = node_at(b, j), edge = node_at(b, j + 1) - from, away = x - (from + (real)0.5 * edge);
        const real slope = -dot3(away, edge), spare = sqrt(dot3(away, away)) - limit;
        if (known && last <= 0 && slope > 0)
            try_stretch(b, x, j == 0 ? (real)0 : (real)j - (real)0.5, (real)j + (real)0.5, limit, pair, touch, list);
        if (j + 2 == b.count && slope <= 0) try_stretch(b, x, end - (real)0.5, end, limit, pair, touch, list);
        uint leap = 1;
        if (spare > 2 * longest) leap = (uint)min_r(spare / longest, (real)(b.count - 2 - j));
        leap = leap < 1 ? 1 : leap;
        known = leap == 1;
        last = slope;
        j += leap;
    }
}

SEL_FN real way_limit(real way, uint rod, InstrumentBodies bodies)
{
    return rod == SEL_NO_ROD ? way : way + bodies.rods[rod].inside;
}

// Points of each cell's axis: its start, its middle and its end.
#define SEL_AXIS_POINTS 3
typedef SEL_GLOBAL const real* CellAxes;  // [cells][SEL_AXIS_POINTS][3] [m]

SEL_FN vec3 cell_axis_point(CellAxes axes, uint cell, uint k)
{
    CellAxes at = axes + 3 * (SEL_AXIS_POINTS * cell + k);
    return make_vec3(at[0], at[1], at[2]);
}

SEL_FN real cells_apart(CellAxes axes, uint a, uint b)
{
    real least = SEL_FAR;
    for (uint i = 0; i < SEL_AXIS_POINTS; ++i)
        for (uint j = 0; j < SEL_AXIS_POINTS; ++j) {
            const vec3 d = cell_axis_point(axes, a, i) - cell_axis_point(axes, b, j);
            least = min_r(least, dot3(d, d));
        }
    return sqrt(least);
}

// Whether the axis advances along the chord of a stretch everywhere by `share` of its material at least. A point of the curve
// moves by a mean of two neighbouring edges, and its material coordinate by the same mean of their lengths. So every edge that
// acts on the stretch is checked.
SEL_FN int is_straight(SplineView rod, real from, real until, real share)
{
    uint first = edge_of_material(rod, from), end = first;
    while (end + 1 < rod.count && rod.material[end] < until) ++end;
    first = first > 0 ? first - 1 : 0;
    end = end + 1 < rod.count ? end + 1 : end;
    const vec3 chord = node_at(rod, end) - node_at(rod, first);
    const real least = share * sqrt(dot3(chord, chord));
    for (uint i = first; i < end; ++i)
        if (!(dot3(node_at(rod, i + 1) - node_at(rod, i), chord) >= least * (rod.material[i + 1] - rod.material[i]))) return 0;
    return least > 0;
}

// Cells that a rod may touch itself with: the live ones, and the one that is on its way through the inlet, as far as it is
// inside. If that were left out until all of it is inside, a strand that lies across the inlet would be found in it, as deep as
// it happens to be.
SEL_FN uint cells_inside(InstrumentRod rod)
{
    const real over = rod.inside - rod.spacing * (real)rod.live;
    return rod.live > 0 && over > (real)1e-9 * rod.spacing ? rod.live + 1 : rod.live;
}

// Stretches of cells of the same rod, hubwards of a cell's points by more than `apart`, whose axes come nearer than `limit` to
// it. Three points of each are compared. Their nearest pair is farther apart than the axes by 1/4 of a cell's length along both.
// That is (l/4)^2 / (2 D) each if they run across their distance D, and l/16 is taken for both. The cells that come next along
// the rod are always that near. Where the rod is nearly straight, points of them that are `apart` along it are farther away than
// `limit`, and these cells are passed over.
SEL_FN void search_cells(InstrumentRod a, SplineView view, CellAxes axes, uint cell, real apart, real limit, uint pair,
                         SlotList* list)
{
    const real near = limit + a.spacing / 16, s0 = a.spacing * (real)(cell - a.cell);
    const vec3 own = cell_axis_point(axes, cell, 1);
    const uint inside = cells_inside(a);
    uint k = (uint)((s0 + apart) / a.spacing), first = 0, cells = 0;
    const uint beyond = (uint)((s0 + a.spacing + near) / a.spacing) + 1, next = beyond < inside ? beyond : inside;
    if (k < next && is_straight(view, s0, a.spacing * (real)next, limit / apart)) k = next;
    real nearest = SEL_FAR;
    while (k < inside) {
        const vec3 away = cell_axis_point(axes, a.cell + k, 1) - own;
        const real spare = sqrt(dot3(away, away)) - near - SEL_LONGER * a.spacing;  // of half a cell each
        const real distance = spare > 0 ? SEL_FAR : cells_apart(axes, cell, a.cell + k);
        if (distance < near) {
            if (cells == 0) first = k;
            ++cells;
            nearest = min_r(nearest, distance);
        } else if (cells > 0) {
            add_slot(list, pair, SEL_TOUCH_SELF, (real)first, cells, nearest);
            cells = 0;
            nearest = SEL_FAR;
        }
        k += spare > 0 ? 1 + (uint)(spare / (SEL_LONGER * a.spacing)) : 1;
    }
    if (cells > 0) add_slot(list, pair, SEL_TOUCH_SELF, (real)first, cells, nearest);
}

// Slots of one cell, unused ones with touch 0.
// @param straight  the rod touches itself nowhere, as is_straight() has told of all of it
SEL_FN SlotList near_slots(uint cell, InstrumentBodies bodies, InstrumentNodes nodes, CellAxes axes, int straight,
                           InstrumentParams par)
{
    SlotList list;
    list.count = 0;
    for (uint k = 0; k < SEL_INSTRUMENT_SLOTS; ++k) {
        list.slots[k].pair = list.slots[k].touch = list.slots[k].cells = list.slots[k].pad = 0;
        list.slots[k].at = list.distance[k] = 0;
    }
    const InstrumentRod a = bodies.rods[bodies.rod_of[cell]];
    if (cell - a.cell >= a.live) return list;
    const real s = a.spacing * ((real)(cell - a.cell) + (real)0.5), way = a.inside - s;
    const vec3 x = cell_axis_point(axes, cell, 1);
    for (uint p = a.pair; p < a.pair + a.pairs; ++p) {
        const InstrumentPair pair = bodies.pairs[p];
        const InstrumentRod rod = bodies.rods[pair.b];
        if (rod.live == 0 || way < way_limit(pair.from, pair.from_rod, bodies) ||
            way >= way_limit(pair.until, pair.until_rod, bodies))
            continue;
        const SplineView b = spline_of(nodes, rod.node, rod.count);
        if (pair.touch == SEL_TOUCH_SELF) {
            if (!straight) search_cells(a, b, axes, cell, SEL_SELF_APART * bodies.surfaces[cell].radius,
                         bodies.surfaces[cell].radius + rod.widest + par.skin, p, &list);
            continue;
        }
        if (pair.touch == SEL_TOUCH_INSIDE) {
            add_slot(&list, p, pair.touch, spline_at(b, rod.inside - way), 0, 0);
            continue;
        }
        const real radius = bodies.surfaces[cell].radius;
        const real limit = radius + rod.widest + (real)0.5 * a.spacing + par.skin;
        search_rod(b, x, limit, rod.longest_edge, p, pair.touch, &list);
    }
    return list;
}

// The surface of a rod at a material coordinate.
SEL_FN InstrumentSurface surface_at(InstrumentRod rod, real s, SEL_GLOBAL const InstrumentSurface* surfaces)
{
    const real last = rod.inside / rod.spacing;
    const real cell = clamp_r(s / rod.spacing, 0, max_r(last - (real)1e-9, 0));
    return surfaces[rod.cell + (uint)cell];
}

SEL_FN GapPart gap_part(InstrumentPair pair, InstrumentSurface a, InstrumentSurface b, SplineView view)
{
    GapPart part;
    part.touch = pair.touch;
    part.low = 0;
    part.high = (real)(view.count - 1);
    part.reach_a = a.radius;
    part.reach_b = b.radius;
    part.rim = 0;
    part.low_ends = (int)pair.ends;
    part.high_ends = 1;
    if (pair.touch == SEL_TOUCH_INSIDE) {
        part.reach_b = b.lumen;
        part.rim = (real)0.5 * (b.radius - b.lumen);
        part.low = min_r(part.rim / (view.material[1] - view.material[0]), (real)0.5);
    }
    return part;
}

SEL_END
#endif

// Evaluation of slots in kernels and their twin: with other instruments SEL_BLOCK at a time, with the same one each alone.
//
// Most neighbours do not touch, and in a lumen the gaps at both ends of a cell show it (least_room()). On a processor these ends,
// two of each of four cells, go in eight SIMD lanes, and so do the clearances of cells that touch nothing, at the trial and at
// the start of the step. On a graphics card an item has one cell, and one end after the other, in stages (instrument_stages.h).
#ifndef SEL_SHARED_INSTRUMENT_BLOCK_H
#define SEL_SHARED_INSTRUMENT_BLOCK_H
#include "shared/instrument_near.h"

SEL_BEGIN

// The state that a slot had at the start of the step: of the same pair, the nearest along b.
// @return its place among the cell's, or SEL_INSTRUMENT_SLOTS
SEL_FN uint old_slot(SEL_GLOBAL const InstrumentState* states, uint pair, real along_b, real farthest, uint epoch)
{
    uint found = SEL_INSTRUMENT_SLOTS;
    real least = farthest;
    for (uint k = 0; k < SEL_INSTRUMENT_SLOTS; ++k) {
        if (states[k].contact.epoch + 1 != epoch || states[k].pair != pair || states[k].touch == SEL_TOUCH_NONE) continue;
        const real apart = fabs(states[k].along_b - along_b);
        if (apart >= least) continue;
        least = apart;
        found = k;
    }
    return found;
}

// The rods of one slot of one cell.
SEL_FN InstrumentScene slot_scene(uint cell, InstrumentPair pair, real along_b, InstrumentBodies bodies, InstrumentNodes nodes,
                                  InstrumentNodes nodes_t0)
{
    const InstrumentRod a = bodies.rods[pair.a], b = bodies.rods[pair.b];
    InstrumentScene scene;
    scene.a = spline_of(nodes, a.node, a.count);
    scene.b = spline_of(nodes, b.node, b.count);
    scene.a_t0 = spline_of(nodes_t0, a.node, a.count_t0);
    scene.b_t0 = spline_of(nodes_t0, b.node, b.count_t0);
    scene.part = gap_part(pair, bodies.surfaces[cell], surface_at(b, along_b, bodies.surfaces), scene.b);
    scene.apart = SEL_SELF_APART * bodies.surfaces[cell].radius;
    scene.edge = edge_of_material(scene.a, a.spacing * (real)(cell - a.cell));
    return scene;
}

SEL_FN LawContext slot_law(InstrumentSurface a, InstrumentSurface b, InstrumentPair pair, int fresh, uint epoch,
                           InstrumentParams par)
{
    LawContext c;
    c.m = instrument_model(a, b, pair);
    c.mv.tangent = c.mv.move = c.mv.turn = make_vec3(0, 0, 0);
    c.mv.length = c.mv.spin = c.mv.radius_reduction = 0;
    c.mv.fresh = fresh;
    c.mv.epoch = epoch;
    c.par.item_count = c.par.slots = c.par.known = 0;
    c.par.normal_law = SEL_NORMAL_DAMPED;
    c.par.smoothing = 0;
    c.par.friction = par.friction;
    c.par.settling = par.settling;
    c.par.inv_dt = par.inv_dt;
    c.par.smooth_speed = par.smooth_speed;
    return c;
}

// One slot of one cell.
typedef struct SlotCell {
    InstrumentScene scene;
    InstrumentSurface surface_a, surface_b;
    real s0, s1;   // ends of the cell [m]
    real at;       // where along b's curve
    real onwards;  // of `at` along b from one end of the cell to the other, about
    uint pair, touch, epoch;
    uint old;    // its state at the start of the step; SEL_INSTRUMENT_SLOTS: none
    uint whole;  // it is taken as a whole
} SlotCell;

// @param states_t0  [SEL_INSTRUMENT_SLOTS] of the cell
SEL_FN SlotCell slot_cell(uint cell, InstrumentSlot slot, InstrumentBodies bodies, InstrumentNodes nodes,
                          InstrumentNodes nodes_t0, SEL_GLOBAL const InstrumentState* states_t0, real inv_dt)
{
    const InstrumentPair pair = bodies.pairs[slot.pair];
    const InstrumentRod a = bodies.rods[pair.a], b = bodies.rods[pair.b];
    const SplineView view = spline_of(nodes, b.node, b.count);
    const real along_b = spline_material(view, slot.at);
    SlotCell its;
    its.scene = slot_scene(cell, pair, along_b, bodies, nodes, nodes_t0);
    its.surface_a = bodies.surfaces[cell];
    its.surface_b = surface_at(b, along_b, bodies.surfaces);
    its.s0 = a.spacing * (real)(cell - a.cell);
    its.s1 = its.s0 + a.spacing;
    its.at = slot.at;
    const uint edge = (uint)clamp_r(slot.at, 0, (real)b.count - (real)1.5);
    its.onwards = slot.touch == SEL_TOUCH_INSIDE ? a.spacing / (view.material[edge + 1] - view.material[edge]) : (real)0;
    its.pair = slot.pair;
    its.touch = slot.touch;
    its.epoch = a.epoch;
    its.old = old_slot(states_t0, slot.pair, along_b, 4 * (a.spacing + b.spacing), a.epoch);
    // at a static equilibrium, which may be far away, nothing is taken as it was
    const uint whole = SEL_CONTACT_WHOLE | SEL_CONTACT_ACTIVE;
    its.whole = inv_dt > 0 && its.old < SEL_INSTRUMENT_SLOTS && (states_t0[its.old].contact.flags & whole) == whole;
    return its;
}

// Gaps of cells, each in two lanes, k and SEL_BLOCK + k. @param first  lane
SEL_LANES_FN real8 gap_in_lanes(const SlotCell* cells, uint first, LaneNearest near, real8* inwards)
{
    real reach[SEL_LANES], sign[SEL_LANES];
    for (uint k = 0; k < SEL_LANES; ++k) {
        const GapPart part = cells[(first + k) % SEL_BLOCK].scene.part;
        sign[k] = part.touch == SEL_TOUCH_INSIDE ? (real)-1 : (real)1;
        reach[k] = part.touch == SEL_TOUCH_INSIDE ? part.reach_b - part.reach_a : -part.reach_a - part.reach_b;
    }
    *inwards = lanes_at(sign);
    return lanes_at(reach) + *inwards * near.distance;
}

// Both ends of SEL_BLOCK cells. @param known  [SEL_BLOCK] is written: whether both are known
SEL_FN void ends_in_lanes(const SlotCell* cells, CellEnds* ends, int* known)
{
    real s[2 * SEL_BLOCK], start[2 * SEL_BLOCK], low[2 * SEL_BLOCK], high[2 * SEL_BLOCK], gap[2 * SEL_BLOCK],
        slope[2 * SEL_BLOCK], of_a[2 * SEL_BLOCK], at[2 * SEL_BLOCK], missed[2 * SEL_BLOCK];
    for (uint k = 0; k < 2 * SEL_BLOCK; ++k) {
        const SlotCell* its = cells + k % SEL_BLOCK;
        const real end = k < SEL_BLOCK ? (real)-0.5 : (real)0.5;
        s[k] = k < SEL_BLOCK ? its->s0 : its->s1;
        low[k] = its->scene.part.low;
        high[k] = its->scene.part.high;
        start[k] = clamp_r(its->at + end * its->onwards, low[k], high[k]);
    }
    for (uint l = 0; l < 2 * SEL_BLOCK; l += SEL_LANES) {
        CurvePiece a[SEL_LANES], b[SEL_LANES];
        for (uint k = 0; k < SEL_LANES; ++k) {
            const InstrumentScene* scene = &cells[(l + k) % SEL_BLOCK].scene;
            a[k] = curve_piece(scene->a, spline_at_near(scene->a, s[l + k], scene->edge));
        }
        const LanePieces on_a = on_own_pieces(a);
        LanePieces on_b;
        LaneNearest near;
        int again = 1;
        for (int round = 0; round < 2 && again; ++round) {
            for (uint k = 0; k < SEL_LANES; ++k) b[k] = curve_piece(cells[(l + k) % SEL_BLOCK].scene.b, start[l + k]);
            on_b = on_own_pieces(b);
            near = nearest_in_lanes(lanes_at(s + l), lanes_at(start + l), &on_a, &on_b, lanes_at(low + l), lanes_at(high + l));
            put8(near.missed | (near.distance <= real8_of(0)) ? real8_of(1) : real8_of(0), missed + l);
            put8(near.t + on_b.origin, at + l);
            // one that has left its piece is looked for once more on the one that it has come to
            again = 0;
            for (uint k = l; k < l + SEL_LANES; ++k) {
                if (missed[k] == 0 || !(at[k] > start[k] - 1 && at[k] < start[k] + 1)) continue;
                start[k] = clamp_r(at[k], low[k], high[k]);
                again = 1;
            }
        }
        const Lanes3 along = add_lanes(on_a.c1, scale_lanes(2 * near.u, on_a.c2));
        real8 inwards;
        put8(gap_in_lanes(cells, l, near, &inwards), gap + l);
        put8(inwards * dot_lanes(near.away, along) / (near.distance * sqrt8(dot_lanes(along, along))), slope + l);
        put8(near.u + on_a.origin, of_a + l);
    }
    for (uint k = 0; k < SEL_BLOCK; ++k) {
        CellMark* marks[2];
        marks[0] = &ends[k].first;
        marks[1] = &ends[k].last;
        for (uint e = 0; e < 2; ++e) {
            const uint lane = k + SEL_BLOCK * e;
            marks[e]->s = s[lane];
            marks[e]->gap = gap[lane];
            marks[e]->slope = slope[lane];
            marks[e]->at = at[lane];
        }
        known[k] = missed[k] == 0 && missed[k + SEL_BLOCK] == 0;
        if (known[k]) ends[k].room = least_room(&cells[k].scene, ends[k].first, ends[k].last, of_a[k], of_a[k + SEL_BLOCK]);
    }
}

// Clearances of cells that touch nothing, at their nearest end: as follow_cell(). @param due  [SEL_BLOCK] which; 0 is written
// where it is done
SEL_FN void follow_in_lanes(const SlotCell* cells, const CellEnds* ends, real inv_dt, int* due, SEL_OUT InstrumentState* now)
{
    real s[2 * SEL_BLOCK], at[2 * SEL_BLOCK], low[2 * SEL_BLOCK], high[2 * SEL_BLOCK], gap[2 * SEL_BLOCK], missed[2 * SEL_BLOCK],
        x[3][2 * SEL_BLOCK], n[3][2 * SEL_BLOCK], place[2 * SEL_BLOCK];
    for (uint k = 0; k < SEL_BLOCK; ++k) {
        const InstrumentScene* scene = &cells[k].scene;
        const CellMark least = ends[k].first.gap < ends[k].last.gap ? ends[k].first : ends[k].last;
        const uint then = k + SEL_BLOCK;
        s[k] = s[then] = least.s;
        at[k] = at[then] = clamp_r(least.at, scene->part.low, scene->part.high);
        low[k] = low[then] = scene->part.low;
        high[k] = scene->part.high;
        high[then] = min_r(scene->part.high, (real)(scene->b_t0.count - 1));
    }
    for (uint l = 0; l < 2 * SEL_BLOCK; l += SEL_LANES) {
        CurvePiece a[SEL_LANES], b[SEL_LANES];
        for (uint k = 0; k < SEL_LANES; ++k) {
            const int then = l + k >= SEL_BLOCK;
            const InstrumentScene* scene = &cells[(l + k) % SEL_BLOCK].scene;
            const SplineView of_a = *(then ? &scene->a_t0 : &scene->a), of_b = *(then ? &scene->b_t0 : &scene->b);
            a[k] = curve_piece(of_a, spline_at_near(of_a, s[l + k], scene->edge));
            b[k] = curve_piece(of_b, at[l + k]);
        }
        const LanePieces on_a = on_own_pieces(a), on_b = on_own_pieces(b);
        const LaneNearest near =
            nearest_in_lanes(lanes_at(s + l), lanes_at(at + l), &on_a, &on_b, lanes_at(low + l), lanes_at(high + l));
        real8 inwards;
        put8(gap_in_lanes(cells, l, near, &inwards), gap + l);
        put8(near.t + on_b.origin, place + l);
        put8(near.missed | (near.distance <= real8_of(0)) ? real8_of(1) : real8_of(0), missed + l);
        const real8 unit = inwards / near.distance;
        put8(near.x.x, x[0] + l);
        put8(near.x.y, x[1] + l);
        put8(near.x.z, x[2] + l);
        put8(unit * near.away.x, n[0] + l);
        put8(unit * near.away.y, n[1] + l);
        put8(unit * near.away.z, n[2] + l);
    }
    for (uint k = 0; k < SEL_BLOCK; ++k) {
        if (!due[k] || missed[k] != 0 || missed[k + SEL_BLOCK] != 0) continue;
        due[k] = 0;
        DeepPoint nearest;
        for (uint i = 0; i < 3; ++i) {
            nearest.x[i] = x[i][k];
            nearest.n[i] = n[i][k];
        }
        nearest.mark.gap = gap[k];
        nearest.mark.s = s[k];
        nearest.mark.at = place[k];
        write_deepest(&cells[k].scene, nearest, following(gap[k], gap[k + SEL_BLOCK], inv_dt), cells[k].epoch, &now[k]);
    }
}

// A cell that is near enough to touch in the next step.
SEL_FN int is_followed(const SlotCell* its, InstrumentParams par, real depth)
{
    return par.follow && -depth <= SEL_FOLLOWED * its->surface_a.radius;
}

#if !SEL_SUMS_IN_MEMORY
// What a cell exerts that is not known to be clear.
// @param states_t0  [SEL_INSTRUMENT_SLOTS] of the cell     points  [SEL_INSTRUMENT_POINTS] of the slot: those that push are
// written
SEL_FN void cell_force(const SlotCell* its, CellEnds ends, int ends_known, InstrumentPair pair,
                       SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par, SEL_OUT InstrumentState* now,
                       SEL_OUT InstrumentForce* force, SEL_GLOBAL InstrumentPoint* points)
{
    const InstrumentScene* scene = &its->scene;
    const int fresh = its->old == SEL_INSTRUMENT_SLOTS;
    SEL_GLOBAL const InstrumentState* state = &states_t0[fresh ? 0 : its->old];
    SEL_GLOBAL const ContactState* old = &state->contact;
    const real middle = (real)0.5 * (its->s0 + its->s1), length = its->s1 - its->s0;
    CellBeside beside;
    int whole = its->whole;
    if (whole && its->touch == SEL_TOUCH_INSIDE) beside = beside_lumen(scene, state, middle, its->onwards / length);
    else if (whole) whole = beside_other(scene, middle, its->at, &beside);
    CellPieces pieces;
    if (!whole) {
        if (!ends_known) ends = cell_ends(scene, its->s0, its->s1, its->at);
        look_through(scene, ends, &pieces, force);
        if (force->depth <= 0) {
            if (is_followed(its, par, force->depth)) follow_cell(scene, &pieces, par.inv_dt, its->epoch, now);
            return;
        }
    }
    LawContext c = slot_law(its->surface_a, its->surface_b, pair, fresh, its->epoch, par);
    CellRule rule;
    CellTouch touch;
    if (whole) push_whole(scene, middle, (real)0.5 * length, beside, *old, &c, &rule, &touch, now, force, points);
    else push_pieces(scene, &pieces, *old, fresh, &c, &rule, &touch, now, force, points);
    if (force->count > 0) finish_cell(scene, touch, *old, fresh, &c, now, force);
}

// Contact of `count` slots, SEL_BLOCK at most, with other instruments; of a slot with the same one nothing is done.
// @param list  [count]     states_t0, states  [cells][SEL_INSTRUMENT_SLOTS]     forces  [count]     points 
// [count][SEL_INSTRUMENT_POINTS]
SEL_PART void instrument_forces(SEL_GLOBAL const uint* list, uint count, SEL_GLOBAL const InstrumentSlot* slots,
                              InstrumentBodies bodies, InstrumentNodes nodes, InstrumentNodes nodes_t0,
                              SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par,
                              SEL_GLOBAL InstrumentState* states, SEL_GLOBAL InstrumentForce* forces,
                              SEL_GLOBAL InstrumentPoint* points)
{
    SlotCell cells[SEL_BLOCK];
    uint item[SEL_BLOCK], its = 0, whole = 0;
    for (uint k = 0; k < count; ++k) {
        const InstrumentSlot slot = slots[list[k]];
        if (slot.touch == SEL_TOUCH_SELF) continue;
        const uint cell = list[k] / SEL_INSTRUMENT_SLOTS;
        item[its] = k;
        cells[its] = slot_cell(cell, slot, bodies, nodes, nodes_t0, states_t0 + SEL_INSTRUMENT_SLOTS * cell, par.inv_dt);
        whole += cells[its].whole;
        ++its;
    }
    if (its == 0) return;
    for (uint k = its; k < SEL_BLOCK; ++k) cells[k] = cells[0];  // lanes that nobody asks
    CellEnds ends[SEL_BLOCK];
    int known[SEL_BLOCK], clear[SEL_BLOCK], due[SEL_BLOCK], any_due = 0;
    InstrumentState now[SEL_BLOCK];
    for (uint k = 0; k < SEL_BLOCK; ++k) known[k] = clear[k] = due[k] = 0;
    if (whole < its) ends_in_lanes(cells, ends, known);
    for (uint k = 0; k < its; ++k) {
        now[k] = no_instrument_state();
        now[k].pair = cells[k].pair;
        now[k].touch = cells[k].touch;
        clear[k] = known[k] && !cells[k].whole && ends[k].room > 0;
        due[k] = clear[k] && is_followed(cells + k, par, -min_r(ends[k].first.gap, ends[k].last.gap));
        any_due = any_due || due[k];
    }
    if (any_due) follow_in_lanes(cells, ends, par.inv_dt, due, now);
    for (uint k = 0; k < its; ++k) {
        InstrumentForce own, *force = &own;
        *force = no_instrument_force();
        force->pair = cells[k].pair;
        if (clear[k] && !due[k]) {
            write_room(&cells[k].scene, ends[k], min_r(ends[k].first.gap, ends[k].last.gap), ends[k].room, force);
        } else {
            const uint cell = list[item[k]] / SEL_INSTRUMENT_SLOTS;
            cell_force(cells + k, ends[k], known[k], bodies.pairs[cells[k].pair], states_t0 + SEL_INSTRUMENT_SLOTS * cell, par,
                       &now[k], force, points + SEL_INSTRUMENT_POINTS * item[k]);
        }
        forces[item[k]] = own;
        states[list[item[k]]] = now[k];
    }
}
#endif

// One slot of one cell with a stretch of the same rod.
typedef struct SelfCell {
    SelfScene self;
    InstrumentSurface surface_a, surface_b;
    InstrumentPair pair;
    real follows;  // gap up to which it counts how it closes [m]; 0: it does not
    uint slot_pair, epoch;
    uint old;  // its state at the start of the step; SEL_INSTRUMENT_SLOTS: none
} SelfCell;

SEL_FN SelfCell self_cell(uint cell, InstrumentSlot slot, InstrumentBodies bodies, InstrumentNodes nodes,
                          InstrumentNodes nodes_t0, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par)
{
    SelfCell its;
    its.pair = bodies.pairs[slot.pair];
    const InstrumentRod a = bodies.rods[its.pair.a];
    const real from_b = a.spacing * slot.at, until_b = min_r(from_b + a.spacing * (real)slot.cells, a.inside),
               along_b = (real)0.5 * (from_b + until_b);
    its.self.scene = slot_scene(cell, its.pair, along_b, bodies, nodes, nodes_t0);
    its.self.s0 = a.spacing * (real)(cell - a.cell);
    its.self.s1 = its.self.s0 + a.spacing;
    its.self.from = spline_at(its.self.scene.b, from_b);
    its.self.until = spline_at(its.self.scene.b, until_b);
    its.surface_a = bodies.surfaces[cell];
    its.surface_b = surface_at(a, along_b, bodies.surfaces);
    its.follows = par.follow ? SEL_FOLLOWED * its.surface_a.radius : (real)0;
    its.slot_pair = slot.pair;
    its.epoch = a.epoch;
    its.old = old_slot(states_t0, slot.pair, along_b, 8 * a.spacing, a.epoch);
    return its;
}

SEL_FN LawContext self_law(const SelfCell* its, InstrumentParams par)
{
    return slot_law(its->surface_a, its->surface_b, its->pair, its->old == SEL_INSTRUMENT_SLOTS, its->epoch, par);
}

SEL_FN real self_line_mass(const SelfCell* its) { return min_r(its->surface_a.load, its->surface_b.load) / SEL_WEIGHT_GRAVITY; }

SEL_FN void start_self(const SelfCell* its, SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* force)
{
    *now = no_instrument_state();
    now->pair = its->slot_pair;
    now->touch = SEL_TOUCH_SELF;
    *force = no_instrument_force();
    force->pair = its->slot_pair;
}

// Where it is deepest. @return 0: it touches nothing
SEL_FN int write_self_depth(SEL_OUT const SelfTouch* touch, SEL_OUT InstrumentForce* force)
{
    force->depth = -touch->deepest.gap;
    if (touch->count == 0) force->clear = max_r(touch->clear, 0);
    return touch->count > 0;
}

SEL_FN int is_self_followed(const SelfCell* its, SEL_OUT const SelfTouch* touch, InstrumentParams par)
{
    return par.follow && touch->deepest.gap <= its->follows;
}

#if !SEL_SUMS_IN_MEMORY
// Contact of one slot of one cell with a stretch of the same rod.
SEL_PART void instrument_self_force(uint cell, InstrumentSlot slot, InstrumentBodies bodies, InstrumentNodes nodes,
                                  InstrumentNodes nodes_t0, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par,
                                  InstrumentState* now, InstrumentForce* force, SEL_GLOBAL InstrumentPoint* points)
{
    const SelfCell its = self_cell(cell, slot, bodies, nodes, nodes_t0, states_t0, par);
    start_self(&its, now, force);
    const SelfTouch touch = self_touch(&its.self, its.follows);
    if (!write_self_depth(&touch, force)) {
        if (is_self_followed(&its, &touch, par)) follow_self(&its.self, &touch, par.inv_dt, its.epoch, now);
        return;
    }
    const int fresh = its.old == SEL_INSTRUMENT_SLOTS;
    LawContext c = self_law(&its, par);
    self_force(&its.self, &touch, its.pair.spread, self_line_mass(&its), states_t0[fresh ? 0 : its.old].contact, fresh, &c, now,
               force, points);
}
#endif

SEL_END
#endif

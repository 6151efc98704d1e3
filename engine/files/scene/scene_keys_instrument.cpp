// Keys of [wire], [[instrument]], [coaxial], [feed], [[hold]], [[load]], [[link]] and [[force]].
#include "scene/scene_keys.h"

#include "scene/toml_parse.h"

#include <algorithm>
#include <cmath>

namespace seldinger::keys {
namespace {

/// The point of a wire that a hold, a load or a link acts on.
Value point(WirePoint& at)
{
    return number(at.from_tip, {0, range_end, false, false, "metres from the tip, 0 or above"},
                  {{"base", "tip"},
                   [&at] { return at.kind == WirePoint::Kind::Distance ? -1 : static_cast<int>(at.kind); },
                   [&at](int i) { at.kind = i < 0 ? WirePoint::Kind::Distance : static_cast<WirePoint::Kind>(i); }});
}

void append(std::vector<Key>& keys, const std::vector<Key>& more) { keys.insert(keys.end(), more.begin(), more.end()); }

}  // namespace

std::vector<Key> properties(WireSection& s, bool of_section)
{
    WireSection solid = s;
    set_stiffness_from_material(solid);
    const bool by_material = s.youngs > 0 && solid.bend_stiffness == s.bend_stiffness &&
                             solid.twist_stiffness == s.twist_stiffness && solid.stretch_stiffness == s.stretch_stiffness;
    std::vector<Key> keys = {
        {"radius_m", "m", number(s.radius, positive), "outer radius. In a vessel, wire and sections need at least 1/500,000 of the length", needed},
        {"density", "kg/m³", number(s.density, positive), "mass per volume of the whole cross-section", needed},
        {"youngs_pa", "Pa", number(s.youngs, positive),
         "Young's modulus E of a round solid wire: EI = E π r⁴/4, GJ = E/(2 (1 + ν)) π r⁴/2, EA = E π r²", none, quiet_if(!by_material)},
        {"bend_nm2", "N m²", number(s.bend_stiffness, positive), "bending stiffness EI", "*needed* without `youngs_pa`", quiet_if(by_material)},
        {"twist_nm2", "N m²", number(s.twist_stiffness, positive), "twisting stiffness GJ", "*needed* without `youngs_pa`", quiet_if(by_material)},
        {"stretch_n", "N", number(s.stretch_stiffness, positive), "stretching stiffness EA", "*needed* without `youngs_pa`", quiet_if(by_material)},
        {"bend_table", "", Special{"a CSV file"},
         "stiffness as measured, in place of `bend_nm2` here and in the sections ([tables](#bend_table))", none},
        {"poisson", "", number(s.poisson, poisson_range), "ν, with `youngs_pa` only", {}, quiet_if(!by_material && !(of_section && s.youngs > 0))},
        {"mu_static", "", number(s.mu_static, friction_range),
         "coefficient of static friction, ≥ `mu_sliding`. A smaller explicit value is an error; a smaller default is raised, with a warning",
         "as in `[contact]`"},
        {"mu_sliding", "", number(s.mu_sliding, friction_range), "coefficient of sliding friction", "as in `[contact]`"},
    };
    for (Key& key : keys)
        if (of_section) key.absent = "as the shaft", key.meaning = "";
    return keys;
}

std::vector<Key> of_instrument(WireSpec& w)
{
    std::vector<Key> keys = properties(w.shaft, false);
    append(keys, {
        {"lumen_radius_m", "m", number(w.lumen_radius, not_negative),
         "lumen radius of a catheter or sheath, below every outer radius; 0: solid. Other instruments can run in the lumen "
         "([`[coaxial]`](#coaxial))"},
        {"bend_scale", "", Special{"(0, ∞)"},
         "multiplies bending and twisting stiffness of the shaft and all sections, for example of a [preset](#presets) whose stiffness is "
         "known to a factor", "`1.0`"},
        {"section", "", Special{"tables"}, "[`[[wire.section]]`](#wiresection)", none},
    });
    return keys;
}

const std::vector<std::string_view>& of_instruments()
{
    static const std::vector<std::string_view> names = [] {
        WireSpec any;
        std::vector<std::string_view> list;
        for (const Key& key : of_instrument(any)) list.push_back(key.name);
        return list;
    }();
    return names;
}

std::vector<Key> wire(SceneInstrument& i)
{
    WireSpec& w = i.wire;
    std::vector<Key> keys = {
        {"name", "", &i.label,
         "1 to 40 letters, digits, `-` and `_`. Names must differ from each other and from a run's own files; `trace_NAME` is not allowed "
         "beside NAME", needed, only_if(!i.label.empty())},
        {"preset", "", Special{"an instrument's name"}, "uses an instrument of the [catalogue](instruments.md): [presets](#presets)", none},
        {"length_m", "m", number(w.length, positive), "length of the whole wire; more than its diameter", needed},
        {"nodes", "",
         count(w.nodes, 3, most_nodes, {{"adaptive"}, [&w] { return w.nodes == 0 ? 0 : -1; }, [&w](int word) { if (word == 0) w.nodes = 0; }}),
         "number of nodes over the whole length; a fed wire has those inside"},
        {"min_edge_m", "m", number(w.min_edge, positive), "adaptive nodes: shortest edge, below `max_edge_m`"},
        {"max_edge_m", "m", number(w.max_edge, positive), "adaptive nodes: longest edge"},
        {"edge_error_m", "m", number(w.edge_error, positive),
         "adaptive nodes: permitted discretisation error per edge, as the tip displacement that it causes"},
    };
    append(keys, of_instrument(w));
    append(keys, {
        {"curvature", "", words(w.curvature, curvature_words),
         "integrated curvature of a node whose edges turn by φ: φ, or the published 2 tan(φ/2)"},
        {"place", "", Tables{{place(w.place)}, false},
         "[`wire.place`](#wireplace); not with `[feed]`", "along +x from the origin", only_if(!i.feed.on)},
        {"rest", "", words(w.place.rest_is_placed, rest_words),
         "stress-free shape: straight (with the sections' rest curvature) or as placed", {}, quiet_if(i.feed.on)},
        {"velocity_m_s", "m/s", vector(w.place.velocity), "initial velocity of every node; not with `[feed]`", {}, only_if(!i.feed.on)},
        {"spin_rad_s", "rad/s", number(w.place.spin_rate, any_number),
         "initial spin about the wire's axis; not with `[feed]`", {}, only_if(!i.feed.on)},
        {"feed", "", Special{"table"},
         "[`[feed]`](#feed) of this instrument. An inner instrument has only `keys`, `behind_m` and those of its hub, since it enters with the "
         "outer one",
         none, only_if(!i.label.empty())},
    });
    return keys;
}

std::vector<Key> section(WireSectionRange& range)
{
    Vec2& k = range.section.rest_curvature;
    std::vector<Key> keys = {{"from_tip_m", "m", pair(range.begin, range.end, "[from, to] in metres from the tip"),
                              "extent of the section, 0 ≤ from < to ≤ `length_m`", needed}};
    append(keys, properties(range.section, true));
    append(keys, {{"rest_curvature_1_m", "1/m", pair(k[0], k[1], "two numbers [k1, k2] in 1/m"),
                   "natural curvature about the two material directors; a J of radius 8 mm is `[120.0, 0.0]`"}});
    return keys;
}

std::vector<Key> place(WirePlacement& p)
{
    const bool has_points = p.shape == PlaceShape::Points, is_based = !has_points && p.shape != PlaceShape::Centreline;
    return {
        {"shape", "", words(p.shape, place_words), "shape of the wire"},
        {"base", "m", vector(p.base), "the proximal end; not for `points` and `centreline`", {}, only_if(is_based)},
        {"direction", "", direction(p.direction), "from base to tip; not for `points` and `centreline`", {}, only_if(is_based)},
        {"normal", "", direction(p.normal),
         "first material director, towards which an arc bends; not parallel to `direction`", "z; x for a wire along z"},
        {"bend_radius_m", "m", number(p.bend_radius, positive),
         "radius of the circle that the wire follows", "*needed* for `arc`", only_if(p.shape == PlaceShape::Arc)},
        {"twist_rad", "rad", number(p.twist, any_number),
         "twist inserted before the ring is closed", "`0.0` for `ring`", only_if(p.shape == PlaceShape::Ring)},
        {"from_m", "m", number(p.from, not_negative),
         "position of the base along the vessel's centreline, from its start", "`0.0` for `centreline`", only_if(p.shape == PlaceShape::Centreline)},
        {"stretch", "", words(p.stretched, stretch_words),
         "for `points`. `none`: every edge starts with its rest length. `as-placed`: the nodes share out the length of the points evenly, so "
         "the wire starts with the strain L/`length_m` − 1, at most ±0.4", {}, has_points ? quiet_if(!p.stretched) : Use::Unused},
        {"points", "m", rows<3>(p.points, 2, "[x, y, z]"),
         "from base to tip; their length equals the wire's within 5 %. Edges cut the corners; what is left of the wire continues straight. "
         "With `stretch = \"as-placed\"` their length is the wire's under tension", "*needed* for `points`", only_if(has_points)},
    };
}

std::vector<Key> feed(SceneFeed& f, bool inside)
{
    return {
        {"inlet", "",
         count(f.inlet_number, 1, 1000, {{"auto"}, [&f] { return f.inlet_number == 0 ? 0 : -1; }, [&f](int) { f.inlet_auto = true; }},
               "the number of an inlet, as `seldinger vessel` lists them from 1"),
         "one of the vessel's [inlets](#inlets); otherwise give `point` and `direction`", none, inside ? Use::Unused : quiet_if(!f.inlet_auto)},
        {"point", "m", vector(f.point),
         "point of entry, inside the lumen or on an opening", "*needed* without `inlet`", inside ? Use::Unused : quiet_if(f.inlet_auto)},
        {"direction", "", direction(f.direction), "direction of entry", "*needed* without `inlet`", inside ? Use::Unused : quiet_if(f.inlet_auto)},
        {"start", "", words(f.along_centreline, feed_start_words),
         "where the length of the first key lies at t = 0. `straight`: straight ahead of the inlet. `centreline`: along the vessel's "
         "centreline, and the run starts settled unless `scene.start` says otherwise; not in a `[coaxial]` group", {}, only_if(!inside)},
        {"behind_m", "m", number(f.behind, not_negative),
         "`merged` groups: length between operator and inlet at the start. It twists with the rest and shortens as the instrument is pushed. "
         "With the length inside, at most `length_m`. 0: the operator holds the instrument at the inlet", {}, quiet_if(f.behind == 0)},
        {"hub_mass_kg", "kg", number(f.hub.mass, positive),
         "a force drives the hub (`force_n` of the keys), and this mass moves with it: hand, torque device, length outside. Only with "
         "`scheme = \"newton\"` and backward Euler", none, quiet_if(!f.hub.driven())},
        {"hub_damping_n_s_m", "N s/m", number(f.hub.damping, not_negative), "resistance against the speed of such a hub", {},
         quiet_if(f.hub.damping == 0)},
        {"hub_friction_n", "N", number(f.hub.friction, not_negative), "dry friction at such a hub: of a valve, a grip", {},
         quiet_if(f.hub.friction == 0)},
        {"keys", "", list_of(f.keys, [driven = f.hub.driven()](FeedKey& k) { return feed_key(k, driven); }), "[`feed.keys`](#feedkeys)",
         "*needed* without `log`"},
        {"log", "", Special{"a CSV file"}, "motion as recorded by a robot, in place of `keys` ([logs](#log))", none},
    };
}

std::vector<Key> feed_key(FeedKey& k, bool driven)
{
    return {
        {"t_s", "s", number(k.t, not_negative), "time, increasing from key to key", needed},
        {"force_n", "N", number(k.force, any_number), "with `hub_mass_kg`: force on the hub, above 0 pushes; linear between keys",
         driven ? needed : "*needed* with `hub_mass_kg`", only_if(driven)},
        {"advance_m", "m", number(k.advance, not_negative),
         "length inside; at most `length_m`. In the first key it lies straight ahead of the inlet, or along the centreline (`start`); if the "
         "wall is in the way, the scene is refused with the length that fits. With `hub_mass_kg` where the hub starts, the same in all "
         "keys",
         driven ? "0 with `hub_mass_kg`" : needed},
        {"turn_rad", "rad", number(k.turn, any_number),
         "rotation of the hub, right-handed about the direction of insertion", "as in the last key, 0 in the first"},
    };
}

std::vector<Key> coaxial(CoaxialSpec& c, const Scene& s)
{
    std::string names, others;
    const std::size_t nested = c.order.size() - std::min<std::size_t>(c.order.size(), c.exchanged - 1);
    for (std::size_t k = 0; k < c.order.size(); ++k) {
        std::string& list = k < nested ? names : others;
        list += (list.empty() ? "" : ", ") + toml_quoted(s.instrument(c.order[k]).label);
    }
    return {
        {"order", "", Special{"2 or more names", "[" + names + "]"}, "outer first; `merged`: 4 at most, with those of `exchange`",
         needed},
        {"exchange", "", Special{"1 or more names", others.empty() ? others : "[" + others + "]"},
         "instruments that take the place of the last one of `order`. One of them is inside at a time; the others wait outside "
         "with `advance_m = 0`", none},
        {"model", "", words(c.model, coaxial_words),
         "`merged`: one centreline without clearance, with the sum of the bending stiffnesses and a spin for each instrument. `separate`: "
         "one rod each; the inner one touches the outer one's lumen ([several instruments](coaxial.md))"},
        {"mu_static", "", number(c.mu_static, friction_range),
         "between instrument and lumen (`separate`, and `merged` with `lumen_friction`), ≥ `mu_sliding`. A smaller explicit value is an "
         "error; a smaller default is raised, with a warning"},
        {"mu_sliding", "", number(c.mu_sliding, friction_range), "between instrument and lumen, for the same models"},
        {"stiffness", "N/m^2.5", number(c.stiffness, positive),
         "`separate`: stiffness of that contact, as force per metre of wire and depth^1.5. By default from the outer instrument's wall",
         none, quiet_if(c.stiffness == 0)},
        {"drag_n_m", "N/m", number(c.drag, not_negative),
         "`merged`: dry friction per length between neighbouring instruments; the limit applies to axial and circumferential slip together",
         {}, quiet_if(c.drag == 0)},
        {"viscous_pa_s", "Pa s", number(c.viscous, not_negative),
         "`merged`: viscous resistance of a film between them, N s/m per metre of length", {}, quiet_if(c.viscous == 0)},
        {"lumen_friction", "", &c.lumen_friction,
         "`merged`: friction with `mu_static` and `mu_sliding` on the force between the instruments at the clearance of the lumen ([hand "
         "forces](coaxial.md#hand-forces-in-merged))", {}, quiet_if(!c.lumen_friction)},
    };
}

std::vector<Key> hold(HoldSpec& h, std::string& instrument)
{
    std::string axes, position = h.position ? "true" : "false";
    for (std::size_t c = 0; c < 3; ++c)
        if (h.axes[c]) axes += (axes.empty() ? "" : ", ") + toml_quoted(axis_names[c]);
    if (!h.axes[0] || !h.axes[1] || !h.axes[2]) position = "[" + axes + "]";
    return {
        {"instrument", "", &instrument, "the instrument", "*needed* with several"},
        {"at", "m", point(h.at), "the point, or its distance from the tip; the base is allowed only without `[feed]`"},
        {"position", "", Special{"`true`, `false`, list of axes", position},
         "holds the position. `[\"y\", \"z\"]` holds these two coordinates, and the point slides along x; not in a `merged` group", "`false`"},
        {"direction", "", &h.direction, "clamps the tangent of the wire at the node"},
        {"spin", "", &h.spin, "holds the rotation about the axis"},
        {"move", "s, m", rows<4>(h.move, 1, "[t_s, dx, dy, dz]"), "displacement, piecewise linear; with `position`", none},
        {"turn", "s, rad", rows<2>(h.turn, 1, "[t_s, rad]"), "rotation, piecewise linear; with `spin`", none},
        {"velocity_m_s", "m/s", vector(h.velocity), "added to `move`; with `position`, not for `scheme = \"static\"`", {}, quiet_if(!h.position)},
        {"until_s", "s", number(h.until, positive),
         "the hold lets go after this time; not for `scheme = \"static\"`", none, quiet_if(!std::isfinite(h.until))},
    };
}

std::vector<Key> load(LoadSpec& l, std::string& instrument)
{
    return {
        {"instrument", "", &instrument, "the instrument", "*needed* with several"},
        {"at", "m", point(l.at), "the point, or its distance from the tip", needed},
        {"force_n", "N", vector(l.force), "force", "`[0.0, 0.0, 0.0]`"},
        {"moment_nm", "N m", vector(l.moment), "moment"},
        {"ramp_s", "s", number(l.ramp, not_negative), "the load rises linearly from 0 over this time"},
        {"until_s", "s", number(l.until, positive),
         "the load ends after this time; not for `scheme = \"static\"`", none, quiet_if(!std::isfinite(l.until))},
    };
}

std::vector<Key> link(LinkSpec& l, std::string& instrument)
{
    return {
        {"instrument", "", &instrument, "the instrument", "*needed* with several"},
        {"at", "m", point(l.at), "the point, or its distance from the tip", needed},
        {"anchor", "m", vector(l.anchor), "the point in space", needed},
        {"stiffness_n_m", "N/m", number(l.stiffness, positive), "stiffness of the spring", needed},
        {"move", "s, m", rows<4>(l.move, 1, "[t_s, dx, dy, dz]"), "displacement of the anchor, piecewise linear", none},
    };
}

std::vector<Key> force(SceneForce& f, std::string& instrument)
{
    std::vector<Key> keys = {
        {"plugin", "", &f.plugin,
         "a library with a [force of your own](forces.md#plugins), in a folder that `SELDINGER_PLUGINS` names", needed},
        {"instrument", "", &instrument, "the instrument", "*needed* with several"},
        {"name", "", &f.name, "in messages and in `sensor_NAME.csv`", "the plugin's", quiet_if(f.name.empty())},
    };
    for (auto& [name, text] : f.keys.texts) keys.push_back({name, "", &text, ""});
    for (auto& [name, list] : f.keys.lists) {
        Numbers numbers{{}, "numbers"};
        for (double& value : list) numbers.values.push_back(&value);
        keys.push_back({name, "", list.size() == 1 ? number(list[0], any_number) : Value(numbers), ""});
    }
    return keys;
}

}  // namespace seldinger::keys

// Keys of [scene], [integrator], [contact] and [output]; the tables of a whole scene.
#include "scene/scene_keys.h"

#include <algorithm>

namespace seldinger::keys {
namespace {

/// Whether instrument k is in another one, and so enters where that does.
bool is_inside(const Scene& s, int k)
{
    if (!s.coaxial) return false;
    const std::vector<int>& order = s.coaxial->order;
    return std::find(order.begin() + 1, order.end(), k) != order.end();
}

}  // namespace

std::vector<Key> scene(Scene& s)
{
    const bool timed = s.integrator.scheme != Scheme::Static;
    return {
        {"name", "", &s.name, "name in summaries and pictures", "the file's stem"},
        {"planned", "", &s.planned, "purpose for which `seldinger plan` chose this model; copied to `summary.json`", none},
        {"gravity", "m/s²", vector(s.gravity), "acceleration of gravity"},
        {"duration_s", "s", number(s.duration, timed ? positive : not_negative),
         "simulated time; at least one step. Not needed with `scheme = \"static\"`", timed ? needed : std::string_view()},
        {"dt_s", "s", number(s.dt, positive),
         "time step; at most 10⁹ steps. Not needed with `scheme = \"static\"`", timed ? needed : std::string_view()},
        {"until", "", words(s.until, until_words),
         "`reached`: the run ends when its tip is at the [target](#tasktarget). `rest`: the run ends earlier when the wire has been at rest "
         "for 10 steps and no prescribed motion or load is still to change"},
        {"record_every", "steps", count(s.record_every, 1, most_steps), "interval between rows of `trace.csv`"},
        {"seed", "", &s.seed, "seed of the random numbers of `seldinger batch` and of X-ray noise"},
        {"start", "", words(s.start_settled, start_words),
         "`settled`: the run starts in static equilibrium, with every contact sticking. If this moves any part of the wire by more than its "
         "radius, the wire was not placed in contact with the wall. It then first slides to rest with `mu_sliding`, and contacts stick from "
         "there. If there is no equilibrium, `run` and Python start from the placed wire, with a warning; a run of a batch stops"},
    };
}

std::vector<Key> integrator(IntegratorSpec& i)
{
    return {
        {"scheme", "", words(i.scheme, scheme_words),
         "`newton`: implicit, Newton iterations to `tolerance`; `linearised`: one Newton iteration per step; `static`: equilibrium only, "
         "following prescribed moves and turns in small increments; `explicit`: symplectic Euler"},
        {"beta", "", Special{"`0.25`", i.newmark ? "0.25" : ""},
         "Newmark's β of the trapezoid rule; it and `gamma` absent: backward Euler", none},
        {"gamma", "", Special{"`0.5`", i.newmark ? "0.5" : ""},
         "Newmark's γ of the trapezoid rule; not with a hold on an instrument of a `merged` group", none},
        {"conserve", "", &i.conserve,
         "energy–momentum steps, second order, instead of Newmark's; only with `scheme = \"newton\"`, and not with `merged` groups"},
        {"spins", "", words(i.spins, spins_words),
         "`auto`: each step is first solved with fixed spin angles (rotation of the cross-sections about the wire's axis). If the torque "
         "balance then misses `tolerance`, as in a twisted wire, the step is solved again with spin angles as unknowns. `kept`: they are "
         "always unknowns"},
        {"tolerance", "", number(i.tolerance, {0, 1, true, true, "a number above 0 and below 1"}),
         "force residual relative to the scene's own forces"},
        {"damping_mass_1_s", "1/s", number(i.damping_mass, not_negative), "mass damping: force −a m v"},
        {"damping_stiffness_s", "s", number(i.damping_stiffness, not_negative), "stiffness damping"},
    };
}

std::vector<Key> contact(Scene& s)
{
    SceneContact& c = s.contact;
    return {
        {"detection", "", words(c.detection, detection_words),
         "`swept` or `capsule`: along the whole wire, checked over the motion within the step; `layer`: "
         "[published adaptive layer](#the-published-layer-method); `nodes`: at the nodes only"},
        {"normal", "", words(c.normal, normal_words), "[normal laws](#normal-laws)"},
        {"friction", "", words(c.friction, friction_words),
         "`stick-slip`: Coulomb friction in which a sticking contact is an elastic spring; `smooth`: regularised in velocity, without "
         "sticking; `sign`: sgn(v) as published; `none`"},
        {"stiffness", "N/m^(n+1)",
         number(c.stiffness, {0, range_end, true, false, "a number above 0 [N/m^(n+1)]"},
                {{"from-wall"}, [&c] { return c.stiffness_from_wall ? 0 : -1; }, [&c](int i) { c.stiffness_from_wall = i == 0; }}),
         "from the wall's modulus and thickness, or [your own](#your-own-stiffness), per metre of wire"},
        {"exponent", "", number(c.exponent, {1, 3, false, false, "a number from 1 to 3"}), "n; `from-wall` fixes it at 1.5"},
        {"restitution", "", number(c.restitution, {0, 1, true, false, "a number above 0, at most 1"}),
         "separation speed over approach speed of an impact"},
        {"mu_static", "", number(c.mu_static, friction_range),
         "static friction of wires and sections without a value, ≥ `mu_sliding`. A smaller explicit value is an error; a smaller default is "
         "raised, with a warning"},
        {"mu_sliding", "", number(c.mu_sliding, friction_range), "sliding friction of wires and sections without a value"},
        {"rolling", "", &c.rolling, "rolling resistance: moment a (2 α/3π + (σ_b + σ_s/2)/6H) f_n against the spin, a the half-width of the contact"},
        {"rolling_alpha", "", number(c.rolling_alpha, not_negative), "α, hysteresis loss"},
        {"rolling_sigma_b_pa", "Pa", number(c.rolling_sigma_b, not_negative), "σ_b"},
        {"rolling_sigma_s_pa", "Pa", number(c.rolling_sigma_s, not_negative), "σ_s"},
        {"rolling_hardness_pa", "Pa", number(c.rolling_hardness, positive), "H"},
        {"layer_height_m", "m", number(c.layer_height, positive),
         "`layer`: extent of the box from the axis towards the wall", "radius + `pair_distance_m`", quiet_if(c.layer_height == 0)},
        {"pair_distance_m", "m", number(c.pair_distance, positive),
         "`layer`: walls closer than this to the wire's surface make pairs", "half the radius", quiet_if(c.pair_distance == 0)},
        {"samples_per_edge", "", count(c.samples_per_edge, 1, 1000),
         "contact samples along an edge", "one wire radius apart, down to 1/4 over sharp ridges", quiet_if(c.samples_per_edge == 0)},
        {"overlap_m", "m", number(c.overlap, positive),
         "overlap that these two laws permit; at most 1/4 of the radius", "0.01 r (`augmented`), 1e-5 r (`constraint`)", quiet_if(c.overlap == 0)},
        {"barrier_distance_m", "m", number(c.barrier_distance, positive),
         "gap at which `barrier` begins to act; at most 1/10 of the radius", "0.02 r", quiet_if(c.barrier_distance == 0)},
        {"precision", "", words(c.precision, precision_words),
         "precision of the contact kernels; float32 supports `swept` and `nodes` with the damped laws"},
        {"instruments", "", &s.instruments_touch,
         "contact between the outer surfaces of instruments, and of an instrument with itself (loops, knots). Contact with the lumen around "
         "an instrument does not need this key"},
    };
}

std::vector<Key> output(Scene& s)
{
    return {
        {"wire_every", "steps", count(s.wire_every, 0, most_steps), "interval between frames `wire_*.vtp`; 0: none", "about 100 frames of a run"},
        {"contacts_every", "steps", count(s.contacts_every, 0, most_steps),
         "interval between frames `contacts_*.vtp`; 0: none", "about 100 frames of a run"},
        {"force_window_m", "m", number(s.force_window, positive),
         "window of [force per length](readings.md#along-the-wire); at least twice the spacing of contact samples",
         "the wire's diameter", quiet_if(s.force_window == 0)},
        {"force_patch_m", "m", number(s.force_patch, positive), "length of wire for the [force on a patch](readings.md#along-the-wire)"},
        {"bands", "", &s.bands,
         "in a batch or farm, each run is computed a second time with half the step, and forces have bands "
         "([columns](readings.md#resultscsv)); `batch --bands` sets it", {}, quiet_if(!s.bands)},
        {"keep_traces", "", &s.keep_traces,
         "a batch or farm writes `runs/NUMBER.csv` for each run; `batch --keep traces` sets it", {}, quiet_if(!s.keep_traces)},
        {"keep_last_frame", "", &s.keep_last_frame,
         "a batch or farm writes the final shapes `runs/NUMBER_wire.vtp` of each run; `batch --keep last-frame` sets it",
         {}, quiet_if(!s.keep_last_frame)},
    };
}

std::vector<Table> tables(Scene& s)
{
    std::vector<Table> all;
    const auto add = [&](std::string name, const std::string& header, std::vector<Key> keys) {
        all.push_back({std::move(name), header, std::move(keys)});
    };
    const bool one = s.label.empty();
    add("scene", "[scene]", scene(s));
    for (int k = 0; k < s.instrument_count(); ++k) {
        SceneInstrument& i = s.instrument(k);
        add(one ? "wire" : "instrument", one ? "[wire]" : "[[instrument]]", wire(i));
        for (auto& range : i.wire.sections) add("wire.section", one ? "[[wire.section]]" : "[[instrument.section]]", section(range));
        if (i.feed.on) add("feed", one ? "[feed]" : "[instrument.feed]", feed(i.feed, is_inside(s, k)));
    }
    if (s.coaxial) add("coaxial", "[coaxial]", coaxial(*s.coaxial, s));
    add("integrator", "[integrator]", integrator(s.integrator));
    if (s.vessel.shape != VesselShape::None) add("vessel", "[vessel]", vessel(s.vessel));
    add("contact", "[contact]", contact(s));
    for (int k = 0; k < s.instrument_count(); ++k) {
        SceneInstrument& i = s.instrument(k);
        for (HoldSpec& h : i.holds) add("hold", "[[hold]]", hold(h, i.label));
        for (LoadSpec& l : i.loads) add("load", "[[load]]", load(l, i.label));
        for (LinkSpec& l : i.links) add("link", "[[link]]", link(l, i.label));
        for (SceneForce& f : i.forces) add("force", "[[force]]", force(f, i.label));
    }
    for (WallLoad& l : s.vessel.loads) add("wall_load", "[[wall_load]]", wall_load(l));
    if (s.task.on) add("task", "[task]", task(s.task));
    if (s.carm.on) add("carm", "[carm]", carm(s.carm));
    if (s.contrast.on) add("contrast", "[contrast]", contrast(s.contrast));
    add("output", "[output]", output(s));
    return all;
}

}  // namespace seldinger::keys

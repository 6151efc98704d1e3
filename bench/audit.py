#!/usr/bin/env python3
"""Do the bands of a default run hold? Set-ups drawn from a seed, each run by default and refined, source by source.

    bench/audit.py [--app build/seldinger] [--seed 1] [--draws 12] [--first 0] [-o out/audit] [--again] [--table] [--least PERCENT]

Each draw has a vessel, an instrument (or a catheter over a wire), friction, step, nodes and wall. The runs of a draw:

    default   as a user leaves it, with its bands
    time      steps / 4                nodes   edges / 4 (uniform), or adaptive nodes with 1/64 of the error per edge
    facets    triangles x 16           wall    elastic walls: control edges / 1.5, as fine everywhere as where the wire touches
    all       all of these at once     near    all of these, each half as fine (steps / 2, edges / 2, triangles x 4)
    off       as default, without the estimate: what that costs

Elastic walls are short arcs, with edges / 2 at most, and have no bands for facets.

A reading is judged where the refinement stands: |all - near| is at most half of |default - all|, or of the band, or 2 % of the value.
It is inside where |default - all| is at most its band. `by source` asks the same of a refinement of one source alone.
A run is healthy if all forces are within 20 % or 1 mN of `all`, and wrong if one that stands is not; else nobody knows: a force differs
by more, but does not stand itself. Shares of warned runs are given for all three.

One file per run lies in the folder: a second call runs only what is missing, so seeds and ranges of draws can be done in parts, and
on several cores. --again runs the default runs anew and keeps the refined ones: for a change that moves bands and no bits (a draw
whose state differs is reported). --table only prints. Seconds are processor time (user + system). ./dev audit builds
the program first.
"""
import bisect
import json
import math
import os
import pathlib
import random
import statistics
import sys

import runner

HERE = runner.ROOT
MEAN = 0.02  # of peaks [s]
READINGS = ("hand_force_n", "hand_force_peak_n", "friction_n", "friction_peak_n", "patch_force_max_n", "hand_work_j", "tip_m", "wall_move_max_m",
            "wall_stress_max_pa", "other_hand_n", "other_hand_peak_n")
FORCES = (*READINGS[:5], *READINGS[-2:])
OTHER = {"other_hand_n": "hand_force_n", "other_hand_peak_n": "hand_force_peak_n"}  # the wire's, in a catheter
SOURCES = ("time", "nodes", "facets", "wall")
FINER = {"default": {}, "off": {}, "time": {"time": 4}, "nodes": {"nodes": 4}, "facets": {"facets": 16}, "wall": {"wall": 1.5},
         "all": {"time": 4, "nodes": 4, "facets": 16, "wall": 1.5}, "near": {"time": 2, "nodes": 2, "facets": 4, "wall": 1}}
WIRES = {"amplatz-super-stiff-035": 0.00044, "lunderquist-035": 0.00044, "bentson-035": 0.00044, "terumo-angled-035": 0.00044,
         "terumo-stiff-angled-035": 0.00044, "vertebral-5f": 0.00083, "control-018": 0.00023, "coronary-soft-014": 0.00018}


AXES = "axis = [1.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\n"
ARC = 'shape = "arc"\nradius_m = 0.0055\nbend_radius_m = 0.05\nangle_deg = 100\nlead_in_m = 0.04\nlead_out_m = 0.06\n'
SIPHON = 'shape = "arc"\nradius_m = 0.0018\nbend_radius_m = 0.006\nangle_deg = 180\nlead_in_m = 0.02\nlead_out_m = 0.04\n' + AXES
CATHETER, GUIDE = [(0, 0.02), (2, 0.03), (4, 0.11)], [(0, 0.03), (2, 0.14), (4, 0.14)]  # keys: (s, m)
# Seed 0: set-ups whose readings were off in an earlier version. The vessel as text, without its triangles if they are generated
EARLIER = [
    {"shape": "aortic-arch", "wire": "lunderquist-035", "mu": 0.2, "dt": 0.001, "nodes": 41, "from": 0.13, "way": 0.17, "duration": 3.4},
    {"shape": "tube", "radius": 0.004, "wire": "terumo-angled-035", "mu": 0.02, "dt": 0.00025, "nodes": 101, "from": 0.01, "way": 0.11, "duration": 2.2},
    {"vessel": ARC, "wire": "terumo-stiff-angled-035", "mu": 0.02, "dt": 0.004, "nodes": 41, "from": 0.04, "way": 0.09, "duration": 1.5},
    {"vessel": SIPHON, "wire": "control-018", "mu": 0.05, "dt": 1 / 60, "nodes": "adaptive", "from": 0.005, "way": 0.05, "duration": 1.0},
    {"vessel": f'mesh = "{HERE}/assets/vessels/coronary.ply"\nunits = "mm"\n', "inlet": "point = [0.001, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]",
     "wire": "control-018", "mu": 0.1, "dt": 0.001, "nodes": 101, "from": 0.0, "way": 0.04, "duration": 1.0},
    {"vessel": f'mesh = "{HERE}/assets/vessels/renal.ply"\nunits = "mm"\n', "inlet": "point = [0.0, 0.0, -0.0595]\ndirection = [0.129, 0.052, 0.990]",
     "wire": "terumo-angled-035", "mu": 0.2, "dt": 0.00025, "nodes": 101, "from": 0.0, "way": 0.06, "duration": 1.2},
    {"vessel": ARC, "wire": "bentson-035", "mu": 0.1, "dt": 0.001, "nodes": "adaptive", "group": 'model = "separate"\n', "keys": CATHETER, "wire keys": GUIDE},
    {"vessel": ARC, "wire": "bentson-035", "mu": 0.1, "dt": 0.001, "nodes": "adaptive", "group": 'lumen_friction = true\nmu_sliding = 0.1\n', "keys": CATHETER, "wire keys": GUIDE},
]


def draw(seed, number):
    """One set-up: the same for a seed and a number, whatever else is drawn."""
    if seed == 0:
        return {"group": "", "elastic": False, "turn": 0.0} | EARLIER[number]
    rng = random.Random(f"seldinger audit {seed} {number}")
    setup = {"shape": rng.choice(["tube", "arc", "arc", "aortic-arch"]), "wire": rng.choice(sorted(WIRES)),
             "mu": rng.choice([0.02, 0.05, 0.1, 0.2, 0.4]), "dt": rng.choice([0.001, 0.001, 0.004, 1 / 60]),
             "nodes": rng.choice([41, 101, "adaptive"]), "group": rng.random() < 0.15, "elastic": rng.random() < 0.2,
             "radius": rng.uniform(0.002, 0.006), "bend": rng.uniform(0.02, 0.06), "angle": rng.uniform(50, 140), "from": rng.uniform(0.02, 0.05),
             "way": rng.uniform(0.05, 0.09), "speed": rng.uniform(0.03, 0.08), "turn": rng.choice([0.0, 0.0, 1.5]),
             "youngs": rng.choice([0.2e6, 0.4e6, 1e6]), "support": rng.choice([1e6, 3e6, 10e6])}
    if setup["shape"] == "aortic-arch":  # stiff wires find the curved part only further in
        setup["from"], setup["way"] = 0.13, rng.uniform(0.06, 0.12)
    if setup["elastic"]:
        setup["shape"], setup["way"], setup["from"] = "arc", 0.3 * setup["way"], 0.03
    if setup["group"]:
        setup["wire"] = "bentson-035"
        setup["radius"] = max(setup["radius"], 0.003)
    if setup["shape"] == "arc":  # farther in, a straight wire does not fit: its axis meets the wall of the bend, which begins at 30 mm
        chord = math.sqrt((setup["bend"] + setup["radius"]) ** 2 - setup["bend"] ** 2)
        setup["from"] = min(setup["from"], 0.033 if setup["group"] else 0.043, 0.0295 + chord)
    setup["duration"] = setup["way"] / setup["speed"]
    return setup


def scene_of(s, finer):
    """The scene's text, with what `finer` says refined."""
    parts, split, facets, wall = (finer.get(key, 1) for key in SOURCES)
    if s["elastic"]:  # even meshes of twice as fine edges over a whole wall take 13 GB
        split, facets, wall = min(split, 2), 1, 1.5 if wall > 1 else 1
    if s["nodes"] == "adaptive":
        nodes = 'nodes = "adaptive"' + ("" if split == 1 else f"\nmin_edge_m = {0.001 / split}\nmax_edge_m = {0.01 / split}\nedge_error_m = {2e-6 / split**3}")
    else:
        nodes = f"nodes = {split * (s['nodes'] - 1) + 1}"
    keys = s.get("keys") or [(0, s["from"]), (s["duration"], s["from"] + s["way"])]
    wire_keys = s.get("wire keys") or [(0, keys[0][1] + 0.01), (keys[-1][0], keys[-1][1] + 0.03)]

    def keys_of(pairs, turn):
        return "keys = [" + ", ".join(f"{{t_s = {t}, advance_m = {at}, turn_rad = {turn * (t / pairs[-1][0])}}}" for t, at in pairs) + "]"

    text = f"[scene]\nduration_s = {keys[-1][0]}\ndt_s = {s['dt'] / parts}\nrecord_every = 1\n"
    inlet = s.get("inlet", 'inlet = "auto"')
    if s["group"]:
        text += (f'[[instrument]]\nname = "catheter"\npreset = "vertebral-5f"\nlength_m = 0.4\n{nodes}\n[instrument.feed]\n{inlet}\n{keys_of(keys, s["turn"])}\n'
                 f'[[instrument]]\nname = "wire"\npreset = "{s["wire"]}"\nlength_m = 0.5\n{nodes}\n[instrument.feed]\n{keys_of(wire_keys, 0)}\n'
                 '[coaxial]\norder = ["catheter", "wire"]\n')
        text += s["group"] if s["group"] is not True else ""
    else:
        text += (f'[wire]\npreset = "{s["wire"]}"\nlength_m = 0.4\nmu_sliding = {s["mu"]}\nmu_static = {1.2 * s["mu"]}\n{nodes}\n[feed]\n{inlet}\n'
                 f'{keys_of(keys, s["turn"])}\n')
    if "vessel" in s:
        text += f"[vessel]\n{s['vessel']}" + (f"triangles = {20000 * facets}\n" if "shape" in s["vessel"] else "")
    elif s["shape"] == "aortic-arch":
        text += f'[vessel]\nshape = "aortic-arch"\ntriangles = {30000 * facets}\n'
    else:
        text += f'[vessel]\nshape = "{s["shape"]}"\nradius_m = {s["radius"]}\ntriangles = {20000 * facets}\n'
        if s["shape"] == "tube":
            text += "length_m = 0.2\n"
        else:
            text += f"bend_radius_m = {s['bend']}\nangle_deg = {s['angle']}\nlead_in_m = 0.03\nlead_out_m = {0.02 if s['elastic'] else 0.08}\n"
    if s["elastic"]:
        text += f'wall = "elastic"\nyoungs_pa = {s["youngs"]}\nthickness_m = 0.0008\nsupport_pa_m = {s["support"]}\n'
        if wall > 1:
            text += f"wall_edge_m = {s['wall_edge'] / wall}\n"
    return text


def run(app, text, is_default, estimate):
    """What one run says, or why there is nothing."""
    done = runner.run(app, text, estimate=estimate, accept=None)
    said = {"seconds": done.seconds, "exit": done.code}
    if done.code or not (done.folder / "summary.json").exists():
        return said | {"log": done.said[-500:]}
    return said | readings_of(done.summary, done.rows(), is_default)


def largest_mean(values, times):
    """Over MEAN: a mean begins or ends with a step and takes a part of the one at its other end."""
    ends, sums = [0.0, *times], [0.0]
    for value, begin, end in zip(values, ends, ends[1:]):
        sums.append(sums[-1] + value * (end - begin))
    if ends[-1] <= MEAN:
        return sums[-1] / ends[-1]

    def sum_to(time):
        k = min(max(bisect.bisect_right(ends, time) - 1, 0), len(values) - 1)
        return sums[k] + values[k] * (time - ends[k])

    starts = [end for end in ends if end + MEAN <= ends[-1]] + [end - MEAN for end in ends if end >= MEAN]
    return max(sum_to(start + MEAN) - sum_to(start) for start in starts) / MEAN


def readings_of(summary, rows, is_default):
    times = [row["time_s"] for row in rows]
    hand, friction = ([row[key] for row in rows] for key in ("hand_force_n", "friction_n"))
    values = {"hand_force_n": summary["hand_force_mean_n"], "friction_n": summary["friction_mean_n"],
              "hand_force_peak_n": largest_mean([abs(value) for value in hand], times), "friction_peak_n": largest_mean(friction, times)}
    for key in READINGS[4:]:
        if key in summary:
            values[key] = summary[key]
    values["tip_m"] = [rows[-1][f"tip_{axis}_m"] for axis in "xyz"]
    bands = {key: summary[band] for key, band in (("wall_move_max_m", "wall_move_max_band_m"), ("wall_stress_max_pa", "wall_stress_max_band_pa"))
             if key in summary}
    shares = {}
    estimate = summary.get("error_estimate", {})
    if estimate.get("windows", 0) > 0:
        bands["tip_m"] = estimate["tip_band_m"]
        shares["tip_m"] = {source: estimate[f"tip_{source}_band_m"] for source in ("step", "nodes", "facets")}
        for key in READINGS[:6]:
            if key in estimate:
                bands[key] = estimate[key]["band"]
                if is_default:  # as a user reads it; refined runs are read off their rows
                    values[key] = estimate[key]["value"]
                shares[key] = {source: estimate[key].get(source) for source in ("step", "nodes", "facets")}
        for hand in estimate.get("other_hands", []):
            for key, name in OTHER.items():
                values[key], bands[key] = hand[name]["value"], hand[name]["band"]
    return {"values": values, "bands": {key: band for key, band in bands.items() if band is not None}, "shares": shares,
            "warnings": summary["warnings"], "state": summary["state_hash"], "wall_edge_m": summary.get("wall_edge_touched_m")}


def difference(key, one, other):
    if key == "tip_m":
        return sum((a - b) ** 2 for a, b in zip(one[key], other[key])) ** 0.5
    return abs(one[key] - other[key])


def measure(options, number):
    """Runs what is missing of one draw."""
    setup = draw(options.seed, number)
    for name, finer in FINER.items():
        if name == "wall" and not setup["elastic"]:
            continue
        file = options.output / f"{options.seed}-{number:03}-{name}.json"
        if file.exists() and not (options.again and name in ("default", "off")):
            said = json.loads(file.read_text())
        else:
            old = json.loads(file.read_text()) if file.exists() else {}
            said = run(options.app, scene_of(setup, finer), name == "default", None if name == "default" or (name != "off" and setup["group"]) else "off")
            if old and old.get("state") != said.get("state"):
                print(f"audit.py: draw {number} of seed {options.seed}: the default run's state differs; remove its files to refine it anew", file=sys.stderr)
            new = file.with_suffix(".new")
            new.write_text(json.dumps({"setup": setup} | said, indent=1) + "\n")
            os.replace(new, file)
        if name == "default":
            if "values" not in said:
                return
            setup["wall_edge"] = said.get("wall_edge_m") or 0.0


def load(folder):
    draws = {}
    for file in sorted(folder.glob("*-*-*.json")):
        seed, number, name = file.stem.split("-")
        draws.setdefault((int(seed), int(number)), {})[name] = json.loads(file.read_text())
    return draws


def stands(key, base, runs, band):
    error = difference(key, base["values"], runs["all"]["values"])
    unknown = difference(key, runs["all"]["values"], runs["near"]["values"])
    size = 0 if key == "tip_m" else abs(runs["all"]["values"][key])
    return unknown <= max(0.5 * error, 0.5 * (band or 0), 0.02 * size)


def print_table(draws):
    """@return the part of the readings that is inside"""
    rows, widths, failed = [], {}, []
    counts = {"healthy": [0, 0], "wrong": [0, 0], "unknown": [0, 0]}  # runs; of them warned about
    by_source = {source: [0, 0] for source in SOURCES}
    for key, runs in draws.items():
        lost = [name for name in runs if "values" not in runs[name]]
        if lost or "all" not in runs or "near" not in runs:
            failed.append(f"{key[0]}-{key[1]} ({', '.join(lost) or 'not finished'})")
            continue
        base, fine = runs["default"], runs["all"]["values"]
        kind = "healthy"
        for reading in READINGS:
            if reading not in base["values"] or reading not in fine:
                continue
            band = base["bands"].get(reading)
            error = difference(reading, base["values"], fine)
            judged = stands(reading, base, runs, band)
            rows.append((key, reading, band, error, judged))
            if reading in FORCES and error > max(0.2 * abs(fine[reading]), 1e-3) and kind != "wrong":
                kind = "wrong" if judged else "unknown"
            for source in SOURCES:
                if source in runs and band is not None and reading in runs[source]["values"]:
                    moved = difference(reading, base["values"], runs[source]["values"])
                    by_source[source][0] += moved <= band
                    by_source[source][1] += 1
            if judged and band is not None and error > 0:
                widths.setdefault(reading, []).append(band / error)
        counts[kind][0] += 1
        counts[kind][1] += bool(base["warnings"])
    print("| reading | judged | with a band | inside | median of band / error | do not stand |\n|---|---|---|---|---|---|")
    total = [0, 0, 0]
    for reading in READINGS:
        of = [row for row in rows if row[1] == reading]
        judged = [row for row in of if row[4]]
        banded = [row for row in judged if row[2] is not None]
        inside = sum(row[3] <= row[2] for row in banded)
        total = [total[0] + len(judged), total[1] + len(banded), total[2] + inside]
        if of:
            wide = f"{statistics.median(widths[reading]):.2g}" if reading in widths else "-"
            print(f"| {reading} | {len(judged)} | {len(banded)} | {inside} | {wide} | {len(of) - len(judged)} |")
    every = [ratio for list_ in widths.values() for ratio in list_]
    print(f"| all | {total[0]} | {total[1]} | {total[2]} ({100 * total[2] / max(total[1], 1):.0f} %) | {statistics.median(every) if every else 0:.2g} | |")
    print("\n| refined alone | inside |\n|---|---|")
    for source, (inside, count) in by_source.items():
        if count:
            print(f"| {source} | {inside} of {count} ({100 * inside / count:.0f} %) |")
    print(f"\n{len(draws) - len(failed)} draws; runs, and of them warned about: {', '.join(f'{kind} {n}, {w}' for kind, (n, w) in counts.items())}; failed: {', '.join(failed) or 'none'}")
    cost = [runs["default"]["seconds"] / runs["off"]["seconds"] - 1 for runs in draws.values() if "off" in runs and "values" in runs["default"]]
    if cost:
        print(f"estimate: median {100 * statistics.median(cost):.0f} % of the processor time of a run without; processor time in all "
              f"{sum(run['seconds'] for runs in draws.values() for run in runs.values()):.0f} s")
    for key, reading, band, error, judged in rows:
        if judged and band is not None and error > band:
            print(f"outside: {key[0]}-{key[1]} {reading}: {draws[key]['default']['values'][reading]} ± {band:.3g}, off by {error:.3g}")
    return total[2] / max(total[1], 1)


def main():
    parser = runner.parser(__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=12)
    parser.add_argument("--first", type=int, default=0, help="number of the first draw")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=HERE / "out/audit")
    parser.add_argument("--again", action="store_true", help="default runs anew; refined runs are kept")
    parser.add_argument("--table", action="store_true", help="print what is there, run nothing")
    parser.add_argument("--least", type=float, default=0, help="exit with 1 if less of the readings are inside their bands [%%]")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    if not options.table:
        for number in range(options.first, options.first + options.draws):
            measure(options, number)
    if print_table(load(options.output)) < options.least / 100:
        sys.exit(f"audit.py: less than {options.least:g} % of the readings are inside their bands")


if __name__ == "__main__":
    main()

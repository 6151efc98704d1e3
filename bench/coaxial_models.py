#!/usr/bin/env python3
"""What `merged` leaves out at a real clearance: a scene of catheter and wire run as `merged`, as that with `lumen_friction` and as `separate`;
tip, hand forces and whip compared.

    bench/coaxial_models.py --app build/seldinger [--scene assets/scenes/catheter-over-wire.toml] [-o table.csv]

After the scene's own end the outer instrument's hub is turned once in --turn-s seconds. Whip: over that turn, the share of its way round
that the tip has gone less the share that the hub has turned, largest less smallest, of 360 degrees; 0 where the tip follows the hub.
"""
import json
import math
import pathlib
import sys
import tomllib

import runner


def tip(row):
    return [row[f"tip_{axis}_m"] for axis in "xyz"]


def whip(rows, start, seconds):
    """@return [deg], and the length of the tip's way [m]"""
    turn = [row for row in rows if row["time_s"] >= start]
    way = [0.0]
    for before, after in zip(turn, turn[1:]):
        way.append(way[-1] + math.dist(tip(before), tip(after)))
    ahead = [360 * (gone / way[-1] - min((row["time_s"] - start) / seconds, 1)) for gone, row in zip(way, turn)]
    return max(ahead) - min(ahead), way[-1]


MODELS = {"merged": ["coaxial.model=merged"], "lumen": ["coaxial.model=merged", "coaxial.lumen_friction=true"], "separate": ["coaxial.model=separate"]}


def main():
    parser = runner.parser(__doc__)
    parser.add_argument("--scene", type=pathlib.Path, default=runner.ROOT / "assets/scenes/catheter-over-wire.toml")
    parser.add_argument("--turn-s", type=float, default=4)
    parser.add_argument("-o", dest="table", type=pathlib.Path)
    given = parser.parse_args()
    text = given.scene.read_text()
    scene = tomllib.loads(text)
    names = scene["coaxial"]["order"]
    start = scene["scene"]["duration_s"]
    last = scene["instrument"][0]["feed"]["keys"][-1]
    text = text.replace(f"duration_s = {start}", f"duration_s = {start + given.turn_s}", 1)
    key = f"    {{t_s = {last['t_s']}, advance_m = {last['advance_m']}}},\n"
    if text.count(key) != 1:
        sys.exit(f"coaxial_models: {given.scene}: expected one line {key!r}, the outer instrument's last key")
    text = text.replace(key, key + f"    {{t_s = {start + given.turn_s}, advance_m = {last['advance_m']}, turn_rad = {2 * math.pi}}},\n")
    traces, summary = {}, {}
    for model, settings in MODELS.items():
        run = runner.run(given.app, text, settings=settings)
        traces[model], summary[model] = {name: run.rows(f"trace_{name}") for name in names}, run.summary
    rows = []
    for name in names:
        row = {"instrument": name}
        for model in MODELS:
            forces = [r["hand_force_n"] for r in traces[model][name] if r["time_s"] < start]
            if model != "separate":
                pairs = list(zip(traces[model][name], traces["separate"][name]))
                apart = [1e3 * math.dist(tip(a), tip(b)) for a, b in pairs]
                off = [(a["hand_force_n"] - b["hand_force_n"]) ** 2 for a, b in pairs if a["time_s"] < start]
                row[f"tip_apart_mean_{model}_mm"], row[f"tip_apart_max_{model}_mm"] = sum(apart) / len(apart), max(apart)
                row[f"hand_apart_rms_{model}_mn"] = 1e3 * math.sqrt(sum(off) / len(off))
            row[f"hand_mean_{model}_mn"] = 1e3 * sum(abs(f) for f in forces) / len(forces)
            row[f"hand_max_{model}_mn"] = 1e3 * max(abs(f) for f in forces)
            row[f"whip_{model}_deg"], row[f"tip_way_{model}_m"] = whip(traces[model][name], start, given.turn_s)
        rows.append({key: round(value, 4) if isinstance(value, float) else value for key, value in row.items()})
    for row in rows:
        print(json.dumps(row, indent=2))
    print(json.dumps({model: {key: one[key] for key in ("steps", "halved_steps", "outside_max_m", "friction_loss_j", "energy_open_j")}
                      for model, one in summary.items()}, indent=2))
    runner.write_rows(given.table, rows)


if __name__ == "__main__":
    main()

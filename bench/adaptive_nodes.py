#!/usr/bin/env python3
"""What adaptive nodes save, and what they cost in accuracy: experiments with even and with adaptive nodes against finer even ones.

    bench/adaptive_nodes.py --scene SCENE.toml [--app build/seldinger] [--runs DIR] [--csv bench/results/validation/adaptive_nodes.csv]
                            [--adaptive 1e-6 2e-6] [--fine 2001] [--uniform 51 101]
    bench/adaptive_nodes.py --pair [--model merged] [--uniform 231 461] [--fine 921] [--csv bench/results/validation/adaptive_pair.csv]

SCENE is experiment 2 on an arch, its first 24 cm. --pair: the whole of experiment2-pair.toml; nodes are those of each instrument, 0.6 m long,
and rows of another model stay in the table. Every run is kept in --runs and used again: the fine ones take minutes. Errors are of the tips'
positions and of forces smoothed over 20 ms; rms and largest over the run. `saved` of the adaptive rows: nodes (mean over the run) that a
uniform wire needs for the same error over those of the adaptive one, by linear interpolation of log(error) against log(nodes) between the
uniform rows.
"""
import pathlib

import numpy as np

import runner

UNTIL = 12.0      # [s]: 24 cm at 2 cm/s
SMOOTH = 20       # steps of 1 ms
QUANTITIES = ("tip", "hand", "friction")  # written in mm and mN
PAIR_COLUMNS = ["model", "nodes", "nodes_at_end", "instrument", "tip_rms_mm", "tip_max_mm", "hand_rms_mn", "hand_max_mn", "hand_largest_mn"]


def smoothed(values):
    return np.convolve(values, np.ones(SMOOTH) / SMOOTH, mode="valid")


def kept_run(options, name, settings, more=()):
    """The folder of a run, which is made unless a finished one is there."""
    folder = options.runs / name
    if not (folder / "summary.json").exists():
        runner.run(options.app, options.scene, folder, {"scene.record_every": 1, "output.contacts_every": 0, **settings}, more)
    return folder


def read(folder, instrument=""):
    trace = np.genfromtxt(folder / f"trace{instrument}.csv", delimiter=",", names=True)
    tips = [runner.vtp_arrays(file, "Points")[0][0] for file in sorted(folder.glob("wire_*.vtp"))]
    return {"nodes": trace["nodes"], "hand": smoothed(trace["hand_force_n"]), "friction": smoothed(trace["friction_n"]),
            "tip": np.array(tips) if tips else np.stack([trace[f"tip_{c}_m"] for c in "xyz"], axis=1)}


def errors(result, fine):
    """{quantity: (rms, largest)} [mm] or [mN]"""
    found = {}
    for name in QUANTITIES:
        off = 1e3 * np.abs(result[name] - fine[name])
        off = np.linalg.norm(off, axis=1) if off.ndim == 2 else off
        found[name] = (float(np.sqrt(np.mean(off**2))), float(off.max()))
    return found


def equivalent_nodes(error, uniform):
    """Mean nodes of a uniform wire with this error. @param uniform [(nodes, error)] in order of nodes"""
    logs = np.log(np.array(uniform))
    for (n0, e0), (n1, e1) in zip(logs, logs[1:]):
        if e1 <= np.log(error) <= e0 or n1 == logs[-1][0]:
            return float(np.exp(n0 + (np.log(error) - e0) / (e1 - e0) * (n1 - n0)))
    return float("nan")


def alone(options):
    def result(name, settings):
        return read(kept_run(options, name, {"scene.duration_s": UNTIL, "output.wire_every": 100, **settings}))

    kinds = ("rms", "max")
    table = runner.Table(options.csv, ["wire", "nodes_end", "nodes_mean", *[f"{q}_{k}_{'mm' if q == 'tip' else 'mn'}" for q in QUANTITIES for k in kinds],
                                       *[f"saved_{q}_{k}" for k in ("end", "mean") for q in QUANTITIES]])
    fine, uniform = result(f"uniform-{options.fine}", {"wire.nodes": options.fine}), []
    for name, setting in [(f"uniform {n}", {"wire.nodes": n}) for n in options.uniform] + \
                         [(f"adaptive {a:g}", {"wire.nodes": "adaptive", "wire.edge_error_m": a}) for a in options.adaptive]:
        got = result(name.replace(" ", "-"), setting)
        found, nodes = errors(got, fine), (got["nodes"][-1], got["nodes"].mean())
        saved = [""] * 2 * len(QUANTITIES)
        if name.startswith("adaptive"):
            saved = [f"{equivalent_nodes(found[q][0], [(n[k], e[q][0]) for n, e in uniform]) / nodes[k]:.2f}" for k in (0, 1) for q in QUANTITIES]
        else:
            uniform.append((nodes, found))
        table.add([name, int(nodes[0]), f"{nodes[1]:.1f}", *[f"{found[q][k]:.3g}" for q in QUANTITIES for k in (0, 1)], *saved])


def pair(options):
    def of(nodes):
        even = {} if nodes == "adaptive" else {f"instrument.{k}.nodes": nodes for k in (0, 1)}
        folder = kept_run(options, f"{options.model}-{nodes}", {"output.wire_every": 0, "coaxial.model": options.model, **even}, ["--error-estimate", "off"])
        return {name: read(folder, f"_{name}") for name in ("catheter", "wire")}

    table = runner.Table(options.csv, PAIR_COLUMNS, lambda row: row["model"] != options.model)
    fine = of(options.fine)
    for nodes in [*options.uniform, "adaptive"]:
        for name, got in of(nodes).items():
            found = errors(got, fine[name])
            table.add([options.model, nodes, f"{got['nodes'][-1]:.0f}", name,
                       *(f"{e:.3g}" for e in (*found["tip"], *found["hand"], 1e3 * np.abs(fine[name]["hand"]).max()))])


def main():
    parser = runner.parser(__doc__, "")
    parser.add_argument("--scene", help="experiment 2 (assets/scenes/experiment2.toml, or on the patient's arch)")
    parser.add_argument("--pair", action="store_true", help="experiment2-pair.toml")
    parser.add_argument("--model", default="merged", choices=["merged", "separate"], help="of the pair")
    parser.add_argument("--runs", type=pathlib.Path, default="adaptive-runs", help="folder of the runs")
    parser.add_argument("--fine", type=int, help="nodes over the whole wire of the run that errors are taken against (2001, of a pair 921)")
    parser.add_argument("--uniform", type=int, nargs="*", help="(51 101 201 401, of a pair 231 461)")
    parser.add_argument("--adaptive", type=float, nargs="*", default=[0.5e-6, 1e-6, 2e-6, 4e-6], help="wire.edge_error_m of the adaptive runs")
    options = parser.parse_args()
    if not options.pair and not options.scene:
        parser.error("--scene or --pair is missing")
    options.scene = options.scene or runner.ROOT / "assets/scenes/experiment2-pair.toml"
    options.csv = options.csv or runner.RESULTS / f"validation/adaptive_{'pair' if options.pair else 'nodes'}.csv"
    options.fine = options.fine or (921 if options.pair else 2001)
    options.uniform = options.uniform or ([231, 461] if options.pair else [51, 101, 201, 401])
    (pair if options.pair else alone)(options)


if __name__ == "__main__":
    main()

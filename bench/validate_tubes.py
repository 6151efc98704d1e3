#!/usr/bin/env python3
"""Instruments of one centreline (D12) against a measured robot of three nested tubes, and against an independent model of it.

    validate_tubes.py PHANTOM [--app build/seldinger] [--rows N] [--edge MM]

PHANTOM holds data.csv (joints and measured tips) and model.py (bending and torsion by shooting; asked where numpy and scipy are there).
Each time of the table is a run at rest. Prints the tip's error against the measurement at the nominal parameters, and how far apart the
two models are. The tubes are those of the phantom's table (nominal): only ratios of stiffness matter, 1 : 1 : 2/7, nu = 0.3."""
import importlib.util
import math
import pathlib
import sys

import runner

JOINTS = [f"rotation{k}_rad" for k in (1, 2, 3)] + [f"translation{k}_mm" for k in (1, 2, 3)]
TIP = ["tip_x_mm", "tip_y_mm", "tip_z_mm"]
TUBES = [(0.0, 0.15, 1000 / 265, 0.05), (0.017, 0.15, 1000 / 265, 0.05), (0.184, 0.0863938, 1000 / 55, 0.05 * 2 / 7)]  # straight, curved [m], [1/m], [N m^2]
RADII = [(0.0015, 0.0012), (0.001, 0.0008), (0.0006, 0.0)]  # outer, inner [m]: any that fit


def tip_of(app, joints, edge):
    """[mm], z along the tubes' axis from where tube 1 begins."""
    tables = {"scene": {"gravity": [0.0, 0.0, 0.0]}, "integrator": {"scheme": "static"},
              "coaxial": {"order": ["tube0", "tube1", "tube2"], "model": "merged"}, "output": runner.QUIET}
    text = runner.scene(tables)
    for k, ((straight, curved, curvature, bend), (radius, lumen)) in enumerate(zip(TUBES, RADII)):
        length, back = straight + curved, -1e-3 * joints[3 + k]
        stiffness = {"bend_nm2": bend, "twist_nm2": bend / 1.3}
        keys = [{"t_s": 0.0, "advance_m": length - back - 1e-12, "turn_rad": joints[k]}]
        inlet = {} if k else {"point": [0.0, 0.0, 0.0], "direction": [1.0, 0.0, 0.0]}
        text += runner.scene({
            "instrument": [{"name": f"tube{k}", "length_m": length, "radius_m": radius, "lumen_radius_m": lumen, "density": 6500.0, "stretch_n": 4e6 * bend,
                            "nodes": math.ceil(length / edge) + 1, **stiffness}],
            "instrument.section": [{"from_tip_m": [0.0, curved], "rest_curvature_1_m": [curvature, 0.0], **stiffness}],
            "instrument.feed": {**inlet, "behind_m": back, "keys": keys}})
    x, y, z = 1e3 * runner.run(app, text).nodes("tube2")[0]
    return [z, -y, x]  # (k, 0) bends towards +z and turns from +z to -y


def tips_of_model(phantom, joints):
    """None where its libraries are not there."""
    try:
        import numpy as np

        spec = importlib.util.spec_from_file_location("model", phantom / "model.py")
        model = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(model)
    except ImportError:
        return None
    table = np.array(joints)
    return model.tip_frame(table[:, :3], table[:, 3:], model.NOMINAL)[0].tolist()


def report(name, ours, theirs):
    miss = [math.dist(a, b) for a, b in zip(ours, theirs, strict=True)]
    print(f"{name}: {len(miss)} rows, mean {sum(miss) / len(miss):.3f} mm, largest {max(miss):.3f} mm")


def main():
    parser = runner.parser(__doc__)
    parser.add_argument("phantom", type=pathlib.Path)
    parser.add_argument("--rows", type=int, default=None)
    parser.add_argument("--edge", type=float, default=1.5, help="of the line [mm]")
    options = parser.parse_args()
    rows = runner.read_rows(options.phantom / "data.csv")[: options.rows] or sys.exit(f"{options.phantom}: got no data.csv with rows in it")
    joints, measured = ([[float(row[name]) for name in names] for row in rows] for names in (JOINTS, TIP))
    merged = [tip_of(options.app, row, 1e-3 * options.edge) for row in joints]
    report("merged against the measurement", merged, measured)
    independent = tips_of_model(options.phantom, joints)
    if independent is None:
        return print("model.py not asked: it needs numpy and scipy")
    report("independent model against the measurement", independent, measured)
    report("merged against the independent model", merged, independent)


if __name__ == "__main__":
    main()

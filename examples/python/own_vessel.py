#!/usr/bin/env python3
"""From a mesh of one's own to an answer: which wire reaches how far, and how hard it presses. own_vessel.py [MESH.stl UNIT] [PICTURE.png]"""

import sys

import seldinger

mesh, unit, picture = (sys.argv[1:] + ["", "", ""])[:3]
mesh, unit = mesh or str(seldinger.assets() / "vessels" / "renal.ply"), unit or "mm"
for wire in ("terumo-angled-035", "amplatz-super-stiff-035"):
    scene = {"scene": {"duration_s": 4.0, "dt_s": 0.004}, "wire": {"preset": wire, "length_m": 0.4, "nodes": "adaptive"},
             "vessel": {"mesh": mesh, "units": unit},
             "feed": {"inlet": "auto", "keys": [{"t_s": 0.0, "advance_m": 0.0, "turn_rad": 0.0}, {"t_s": 4.0, "advance_m": 0.12, "turn_rad": 0.0}]}}
    with seldinger.World(scene) as world:
        world.run()
        output, tip = world.output, 1e3 * world.output.nodes[0]
        print(f"{wire}: {1e3 * output.inserted:.0f} mm in, tip at {tip[0]:.0f}, {tip[1]:.0f}, {tip[2]:.0f} mm, "
              f"{len(output.contacts)} contacts, {output.wall_force:.3f} N on the wall, hand {output.hand_force:.3f} N")
        if picture:
            from matplotlib import pyplot
            pyplot.imsave(picture, world.render(640, 480))

#!/usr/bin/env bash
# exudyn 1.13.6: a J-tip that is drawn as the reference shape of ANCF cable elements is straight at rest.
#
# The tip is a half circle of radius 10 mm: 16 planar cable elements, their nodes and slopes on the circle, the first node held,
# no load. The element's length is that of the arc, as the elements are drawn. One would expect the reference shape to be free
# of stress, as it is for a drawn solid or beam mesh, so that a static solution stays where it was drawn.
#
# Seen: the free end moves from (-10.00, 0.00) mm to (10.00, 31.42) mm: the wire has become straight. The curvature of the
# reference shape counts as strain unless `strainIsRelativeToReference` is 1 (its default is 0); with 1 the end stays.
# A shaped guidewire loses its tip, or pushes with its full straightening force against the vessel, without a message.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/env"
"$folder/env/bin/pip" -q install --only-binary :all: exudyn==1.13.6 numpy==2.4.6

cat >"$folder/tip.py" <<'PY'
import math
import sys

import exudyn as exu
from exudyn.utilities import Cable2D, CoordinateConstraint, MarkerNodeCoordinate, NodePointGround, ObjectGround, Point2DS1

count, bend, wire, modulus = 16, 10e-3, 0.2e-3, 60e9
length, area = math.pi * bend, math.pi * wire**2


def tip(**given):
    container = exu.SystemContainer()
    system = container.AddSystem()
    system.AddObject(ObjectGround())
    nodes = []
    for i in range(count + 1):
        a = math.pi * i / count
        at = [bend * math.cos(a), bend * math.sin(a), -math.sin(a), math.cos(a)]
        nodes.append(system.AddNode(Point2DS1(referenceCoordinates=at)))
    for a, b in zip(nodes, nodes[1:]):
        system.AddObject(Cable2D(
            length=length / count, massPerLength=6500 * area, axialStiffness=modulus * area,
            bendingStiffness=modulus * math.pi * wire**4 / 4, nodeNumbers=[a, b], **given))
    ground = system.AddMarker(MarkerNodeCoordinate(nodeNumber=system.AddNode(NodePointGround()), coordinate=0))
    for k in range(4):
        held = system.AddMarker(MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=k))
        system.AddObject(CoordinateConstraint(markerNumbers=[ground, held]))
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.staticSolver.numberOfLoadSteps = 20
    settings.staticSolver.verboseMode = 0
    system.SolveStatic(settings)
    x, y, _ = system.GetNodeOutput(nodes[-1], exu.OutputVariableType.Position)
    return 1e3 * x, 1e3 * y


default, relative = tip(), tip(strainIsRelativeToReference=1)
print("drawn at (-10.00, 0.00) mm; straight would be (10.00, 31.42) mm")
print("tip, default: ({:.2f}, {:.2f}) mm; relative to the reference: ({:.2f}, {:.2f}) mm".format(*default, *relative))
as_stated = math.dist(default, (10, 1e3 * length)) < 0.05 and math.dist(relative, (-10, 0)) < 0.05
sys.exit(0 if as_stated else 1)
PY
cd "$folder" && env/bin/python tip.py

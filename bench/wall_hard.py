#!/usr/bin/env python3
"""The failure suite's rows beside walls that yield, as a table.

    wall_hard.py [--tests build/tests/seldinger_tests] [--csv bench/results/validation/wall_hard.csv]
                 [--rows PREFIX]

Runs the table of tests/failure/test_elastic_walls.cpp: walls of 0.1 and 1 MPa, 0.8 mm, in tissue of 1e6 Pa/m; distances are to the wall where it has
moved to. A row whose outcome is no hold, or that is outside, makes the exit status 1.
"""
import os
import subprocess
import sys

import runner

COLUMNS = ["row", "youngs_pa", "dt_s", "steps_asked", "outcome", "steps", "halved", "sub_steps_max", "axis_to_wall_mm", "overlap_um", "wall_move_mm",
           "hand_force_mn", "normal_n", "newton_mean", "newton_max", "far_steps"]


def main():
    parser = runner.parser(__doc__, "validation/wall_hard.csv", app=False)
    parser.add_argument("--tests", default="build/tests/seldinger_tests")
    parser.add_argument("--rows", help="only those whose name begins so; the others of the table stay")
    options = parser.parse_args()
    command = ["stdbuf", "-oL", options.tests, "--source-file=*test_elastic_walls.cpp", "--test-case=table:*", "--no-skip", "--no-intro"]
    table = runner.Table(options.csv, COLUMNS, lambda row: options.rows and not row["row"].startswith(options.rows))
    environment = {**os.environ, **({"SELDINGER_ROWS": options.rows} if options.rows else {})}
    bad = rows = 0
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        for line in process.stdout:
            if "row;" not in line:
                continue
            row = line.strip().split("row;", 1)[1].split(";")
            table.add(row, show=False)
            rows += 1
            thrown = "thrown base" in row[0]  # its force alternates because its base does
            bad += row[4] not in (("hold", "jitter") if thrown else ("hold",)) or float(row[8]) <= 0
            print(", ".join(f"{name} {value}" for name, value in zip(COLUMNS, row)), flush=True)
    if not rows:
        sys.exit(f"{' '.join(command)}: no rows")
    sys.exit(bad > 0 or process.returncode != 0)


if __name__ == "__main__":
    main()

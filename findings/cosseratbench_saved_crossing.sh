#!/usr/bin/env bash
# cosseratbench 0.3.0 beside SciPy 1.10.1 and NumPy 1.24.2 (Debian 12's versions): a saved run of `crossing` is not found again.
#
# The benchmark reuses a saved run if the digest of its scenario is unchanged. One would expect the digest to follow from the
# experiment's numbers. `crossing` builds its scenario from scipy.integrate.solve_bvp, whose last digits differ from process to
# process with these versions, also on one thread of BLAS. So the same command runs again what it has saved, and two solvers,
# each run in a process of its own, are not given the same scenario. `capstan`, by closed forms, has one digest.
#
# Seen, of 12 processes: crossing 2 to 5 digests, capstan 1. With SciPy 1.17.1 and NumPy 2.4.6: 1 and 1.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/env"
"$folder/env/bin/pip" -q install cosseratbench==0.3.0 scipy==1.10.1 numpy==1.24.2

cat >"$folder/digests.py" <<'PY'
from cosseratbench.provenance import scenario_digest
from cosseratbench.registry import load_experiment

print(*(scenario_digest(load_experiment(name).scenario) for name in ("crossing", "capstan")))
PY
for _ in $(seq 12); do OPENBLAS_NUM_THREADS=1 "$folder/env/bin/python" "$folder/digests.py"; done >"$folder/seen"
crossing=$(cut -d' ' -f1 "$folder/seen" | sort -u | wc -l)
capstan=$(cut -d' ' -f2 "$folder/seen" | sort -u | wc -l)
echo "digests in 12 processes: crossing $crossing, capstan $capstan"
[ "$crossing" -gt 1 ] && [ "$capstan" -eq 1 ]

#!/usr/bin/env python3
# A farm on a real Slurm under faults: tasks killed at random, the node drained, the controller restarted; then the merged table
# against the batch's. For a cluster of one node that may be disturbed; not part of the tests.
#
#   slurm_faults.py SELDINGER DIR SCENE SWEEP [--tasks 200] [--run RUN --frame-tasks 100] [--restart-controller COMMAND]
import argparse, filecmp, json, os, random, shlex, signal, subprocess, time

parser = argparse.ArgumentParser()
parser.add_argument("app"), parser.add_argument("dir"), parser.add_argument("scene"), parser.add_argument("sweep")
parser.add_argument("--tasks", default="200"), parser.add_argument("--run"), parser.add_argument("--frame-tasks", default="100")
parser.add_argument("--restart-controller", help="command that ends slurmctld and starts it again")
parser.add_argument("--kills", type=int, default=12), parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--limit", type=float, default=1200, help="seconds")
o = parser.parse_args()
dice = random.Random(o.seed)


def call(*words, check=True):
    return subprocess.run(words, check=check, capture_output=True, text=True).stdout


def workers():
    """Processes that do a task of one of our farms now."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            words = open(f"/proc/{pid}/cmdline").read().split("\0")
        except OSError:
            continue
        if words[1:2] in (["batch"], ["render"]) and "-o" in words and words[words.index("-o") + 1].startswith(o.dir + "/"):
            found.append(int(pid))
    return found


os.makedirs(o.dir, exist_ok=True)
batch = f"{o.dir}/batch"
if not os.path.exists(f"{batch}/results.csv"):
    call(o.app, "batch", o.scene, "--vary", o.sweep, "-o", batch, "--quiet")
farms = {f"{o.dir}/sweep": [o.app, "farm", o.scene, "--vary", o.sweep, "--tasks", o.tasks]}
if o.run:
    farms[f"{o.dir}/frames"] = [o.app, "farm", o.run, "--frames", "all", "--tasks", o.frame_tasks, "--size", "320x180"]
started = time.time()
for folder, words in farms.items():
    print(call(*words, "-o", folder, "--backend", "slurm", "--submit"), end="")
node = call("sinfo", "-hN", "-o", "%N").split()[0]
events, next_kill, drained, restarted, killed = [], started + 5, None, False, 0
while time.time() - started < o.limit:
    left = call("squeue", "-h", "-r", check=False).split("\n")
    done = sum(json.loads(call(o.app, "farm", "status", f, "--json"))["done"] for f in farms)
    now = time.time() - started
    alive = workers()
    if killed < o.kills and time.time() > next_kill and alive:
        victim = dice.choice(alive)
        try:
            os.kill(victim, signal.SIGKILL)
            killed += 1
            events.append(f"{now:.0f} s: task killed ({done} done)")
        except ProcessLookupError:
            pass
        next_kill = time.time() + dice.uniform(1, 4)
    if drained is None and killed >= o.kills // 3:
        call("scontrol", "update", f"NodeName={node}", "State=DRAIN", "Reason=test")
        drained = now
        events.append(f"{now:.0f} s: node drained")
    if drained and drained > 0 and now > drained + 8:
        call("scontrol", "update", f"NodeName={node}", "State=RESUME")
        drained = -1.0
        events.append(f"{now:.0f} s: node back")
    if drained == -1.0 and not restarted and killed >= 2 * o.kills // 3 and o.restart_controller:
        subprocess.run(shlex.split(o.restart_controller), check=True)
        restarted = True
        events.append(f"{now:.0f} s: controller restarted")
    if not any(left):
        states = [json.loads(call(o.app, "farm", "status", f, "--json")) for f in farms]
        if all(s["done"] == s["tasks"] for s in states):
            break
        for folder, words in farms.items():  # what was killed too often
            call(*words, "-o", folder, "--backend", "slurm", "--submit")
    time.sleep(0.5)
print("\n".join(events))
for folder in farms:
    print(call(o.app, "farm", "merge", folder, check=False), end="")
    print(call(o.app, "farm", "status", folder), end="")
    status = json.loads(call(o.app, "farm", "status", folder, "--json"))
    assert status["done"] == status["tasks"], status
for table in ("results.csv", "results.npz"):
    assert filecmp.cmp(f"{batch}/{table}", f"{o.dir}/sweep/{table}", shallow=False), table
print(f"the same bits as the batch, {time.time() - started:.0f} s, {killed} tasks killed")

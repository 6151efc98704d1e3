#!/usr/bin/env python3
"""Farms in folders with odd names, against a Slurm of its own: slurm_names.py SELDINGER. Each job.sh is shown to `sbatch --test-only`, then
submitted; its log must lie in the farm's folder and the merged table be there. Exit 77 where Debian's slurmctld and slurmd are not
installed or do not start (they run here without munge, as who calls this)."""
import os, shutil, socket, subprocess, sys, tempfile, time
from pathlib import Path

SCENE = "[scene]\nduration_s = 0.01\ndt_s = 0.001\n" + (Path(__file__).resolve().parent.parent / "scenes/hanging.toml").read_text()
TAKEN = [b"plain", b"a b", b"100%j%A", b"run-10:00", b"#a; b", b"it's", b"a$(touch owned)`touch owned`", "gefäß".encode(), b"\xff\xfe"]
REFUSED = [b"a\nb", b'a"b', b"a\\b", b"a\tb"]


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def start_slurm(folder):
    """@return its daemons, or None where they do not come up"""
    host = socket.gethostname().split(".")[0]
    user = subprocess.run(["id", "-un"], stdout=subprocess.PIPE, text=True).stdout.strip()
    for inner in ("state", "spool"): (folder / inner).mkdir()
    (folder / "slurm.conf").write_text(f"""ClusterName=names
SlurmctldHost={host}
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/ctld.pid
SlurmdPidFile={folder}/d.pid
SlurmctldLogFile={folder}/ctld.log
SlurmdLogFile={folder}/d.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
ReturnToService=2
NodeName={host} CPUs=2 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")
    os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
    daemons = [subprocess.Popen([name, "-D", "-f", folder / "slurm.conf"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
               for name in ("slurmctld", "slurmd")]
    for _ in range(100):
        if "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout: return daemons
        time.sleep(0.2)
    stop(daemons)
    return None


def stop(daemons):
    for one in daemons: one.terminate()
    for one in daemons: one.wait()


def main():
    app = os.path.abspath(sys.argv[1])
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    if not all(shutil.which(name) for name in ("sbatch", "slurmctld", "slurmd")):
        print("skipped: no Slurm here (Debian: apt-get install slurm-client slurmctld slurmd)")
        return 77
    folder = Path(tempfile.mkdtemp(prefix="seldinger-slurm-"))
    daemons = start_slurm(folder)
    if not daemons:
        print("skipped: slurmctld and slurmd do not start here")
        return 77
    try:
        os.chdir(folder)
        Path("s.toml").write_text(SCENE)
        Path("v.toml").write_text('[vary]\n"wire.density" = [6000.0, 7000.0]\n')

        def farm(name, *more):
            words = [app, "farm", "s.toml", "--vary", "v.toml", "-o", name, "--tasks", "2", "--backend", "slurm", *more]
            return subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

        for name in REFUSED:
            done = farm(name)
            assert done.returncode == 2 and b"Fix: " in done.stderr and done.stderr.count(b"\n") <= 2, (name, done)
            assert not os.path.exists(name + b"/job.sh"), name
        for option in ("--time=60\ntouch owned", "--comment=a\rb"):
            assert farm(b"plain", "--sbatch=" + option).returncode == 2, option
        for name in TAKEN:
            done = farm(name)
            assert done.returncode == 0, (name, done)
            tried = subprocess.run([b"sbatch", b"--test-only", b"--array=1", name + b"/job.sh", b"0"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            assert tried.returncode == 0, (name, tried)
            done = farm(name, "--submit")
            assert done.returncode == 0, (name, done)
        for _ in range(600):
            if all(os.path.exists(name + b"/results.csv") for name in TAKEN): break
            time.sleep(0.2)
        plain = Path("plain/results.csv").read_bytes()
        for name in TAKEN:
            logs = [n for n in os.listdir(name + b"/log") if n.startswith(b"slurm-")]
            assert sorted(n.rsplit(b"_", 1)[-1] for n in logs if b"merge" not in n) == [b"1.txt", b"2.txt"], (name, logs)
            assert open(name + b"/results.csv", "rb").read() == plain, name
            assert not os.path.exists("owned"), name
        print(f"{len(TAKEN)} folders taken and done, {len(REFUSED)} refused; {subprocess.run(['sbatch', '--version'], stdout=subprocess.PIPE, text=True).stdout.strip()}")
    finally:
        stop(daemons)
        os.chdir("/")
        shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())

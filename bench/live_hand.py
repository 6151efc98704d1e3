#!/usr/bin/env python3
"""A simulated hand on a live session's UDP port: a mass with a damper, pushed by an operator who trembles, feeling the force late.

    bench/live_hand.py run  --app build/seldinger SCENE.toml [--seconds 10] [...]     latency, lateness and what was felt
    bench/live_hand.py map  --app build/seldinger SCENE.toml -o stability.csv        stable or not, over stiffness x delay; rows of other scenes stay
    bench/live_hand.py plot stability.csv -o stability.png
    bench/live_hand.py soak --app build/seldinger SCENE.toml -o soak.csv [--minutes 60]      memory, files and threads of the session, each minute
    bench/live_hand.py wild --app build/seldinger SCENE.toml [--seconds 300] [--kill]   push, pull and turn at random, then replay it

The hand is integrated in 20 parts of a millisecond, the force held for a period and `delay` periods old, as a device holds it. A cell of the map: the hand goes in at
25 cm/s, presses from 1.5 s on against what the wire has met, trembles until 3 s, and is unstable where it still swings by more than 50 um from 3.5 to 4.5 s. The map
is made in lockstep (`seldinger live --lockstep`): a step for each datagram, so that it is the same on any machine. Colgate's line, with a force that is held for
T and comes tau late, is b_hand = k (T/2 + tau) + b [Colgate & Schenkel 1997].
"""
import collections
import json
import math
import os
import pathlib
import random
import re
import select
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

import runner

REQUEST, ANSWER = struct.Struct("<IHHQdddII"), struct.Struct("<IHHQQdddddII")


class Session:
    def __init__(self, app, scene, options=()):
        self.record = os.path.join(tempfile.mkdtemp(prefix="seldinger-hand-"), "hand.record")
        self.process = subprocess.Popen([app, "live", scene, "--port", "0", "--udp", "0", "--record", self.record, *options],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.search(r"page (http://\S+) +hand UDP [^:]+:(\d+)", line)
        if not found:
            sys.exit("live_hand: no session: " + line + self.process.stderr.read())
        self.page, self.port = found.group(1), int(found.group(2))

    def end(self):
        self.process.terminate()
        self.said = self.process.communicate()[1]
        with open(self.record + ".summary.json") as file:
            return json.load(file)


class Hand:
    """@param push  the operator's force as a function of time and position [N]"""

    def __init__(self, port, mass=0.15, damping=3.0, tremor=0.02, delay=0, period=1e-3, parts=20, keeps_log=True):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.socket.setblocking(False)
        self.mass, self.damping, self.tremor, self.delay, self.period = mass, damping, tremor, delay, period
        self.parts, self.keeps_log = parts, keeps_log
        self.calm_from, self.refused = math.inf, False
        self.x = self.v = self.turn = 0.0
        self.sequence, self.sent, self.trips, self.log, self.forces = 0, {}, [], [], collections.deque([0.0] * (delay + 1), delay + 1)
        self.answer = None

    def receive(self):
        while True:
            try:
                data = self.socket.recv(128)
            except (BlockingIOError, ConnectionRefusedError):
                return
            self.answer = ANSWER.unpack(data)
            sent = self.sent.pop(self.answer[3], None)
            if sent is not None:
                self.trips.append(time.perf_counter() - sent)

    def tick(self, t, push):
        self.forces.append(self.answer[6] if self.answer else 0.0)
        felt = self.forces[0]
        h = self.period / self.parts
        drive = push(t, self.x) + (self.tremor * math.sin(2 * math.pi * 9 * t) if t < self.calm_from else 0.0)
        for _ in range(self.parts):
            self.v = (self.v + h / self.mass * (drive - felt)) / (1 + h * self.damping / self.mass)
            self.x += h * self.v
        self.sequence += 1
        self.sent[self.sequence] = time.perf_counter()
        self.socket.send(REQUEST.pack(0x484C4553, 1, 0, self.sequence, t, self.x, self.turn, 0, 0))
        if self.keeps_log:
            self.log.append((t, self.x, felt, self.answer[9] if self.answer else 0.0))

    def go_in_lockstep(self, seconds, push, stop):
        self.socket.setblocking(True)
        self.socket.settimeout(5)
        for k in range(round(seconds / self.period)):
            if stop(self.log):
                break
            self.tick(k * self.period, push)
            try:
                self.answer = ANSWER.unpack(self.socket.recv(128))
            except TimeoutError:  # thrown about so fast that the session takes it for a jump and does not answer
                self.refused = True
                break

    def go(self, seconds, push, stop=lambda log: False):
        begin = time.perf_counter()
        k = 0
        while k * self.period < seconds and not stop(self.log):
            # one that was kept from its clock does not make up for it: so fast a hand would be taken for one that jumps
            begin = max(begin, time.perf_counter() - k * self.period - 0.05)
            while (wait := begin + k * self.period - time.perf_counter()) > 0:
                if select.select([self.socket], [], [], wait)[0]:
                    self.receive()
            self.receive()
            self.tick(k * self.period, push)
            k += 1


def quantiles(values):
    values = sorted(values)
    return {f"p{name}_ms": round(1e3 * values[min(len(values) - 1, int(share * len(values)))], 4)
            for name, share in (("50", 0.5), ("99", 0.99), ("999", 0.999))} if values else {}


def follow(speed):
    """An operator who wants to be at speed x t, and pushes as a hand of 60 N/m does."""
    return lambda t, x: 60 * (speed * t - x)


def open_page(url):
    """The session's page in a headless Chromium that draws on the same cores. @return the browser, once frames arrive"""
    sys.path.insert(0, str(runner.ROOT / "tests" / "web"))
    from browser import Browser
    browser = Browser()
    browser.open(url)
    browser.wait("window.seldinger && seldinger.frames > 5 && seldinger.viewer", 60)
    return browser


def stolen_s():
    """What a host has taken from this (virtual) machine's processors since it began [s]."""
    with open("/proc/stat") as file:
        return int(file.readline().split()[8]) / os.sysconf("SC_CLK_TCK")


def to_and_fro(options):
    """An operator who goes in at 2 cm/s as far as options.reach, and from there on pulls back two centimetres and goes in again, every ten seconds."""
    there = options.reach / 0.02

    def push(t, x):
        to = 0.02 * t if t < there else options.reach - 0.01 * (1 - math.cos(2 * math.pi * (t - there) / 10))
        return 60 * (to - x)
    return push


def holdings(process):
    """What a process has of the system: resident memory [MB], open files, threads."""
    folder = f"/proc/{process.pid}"
    return {"memory_mb": round(runner.memory_mb(process.pid), 2), "files": len(os.listdir(folder + "/fd")), "threads": len(os.listdir(folder + "/task"))}


class Page(threading.Thread):
    """The page in a browser from one second of the soak to another."""

    def __init__(self, url, begin, end):
        super().__init__(daemon=True)
        self.url, self.begin, self.end, self.frames, self.is_open = url, begin, end, "", 0

    def run(self):
        time.sleep(self.begin)
        browser = open_page(self.url)
        self.is_open, closing = 1, time.time() + self.end - self.begin
        while time.time() < closing:
            time.sleep(10)
            self.frames = browser.evaluate("seldinger.fps")
        browser.close()
        self.is_open, self.frames = 0, ""


def soak(options):
    session = Session(options.app, options.scene, options.live)
    hand = Hand(session.port, parts=4, keeps_log=False)
    page = Page(session.page, 60 * options.page[0], 60 * options.page[1])
    page.start()
    time.sleep(1)
    rows, push, began = [], to_and_fro(options), time.time()

    def note(_):
        passed = (time.time() - began) / 60
        if passed < len(rows) + 1 or not hand.answer:
            return passed >= options.minutes
        steps, late = hand.answer[4], hand.answer[10]
        before = rows[-1] if rows else {"steps": 0, "late": 0}
        trip = quantiles(hand.trips or [math.nan])
        rows.append({"minute": len(rows) + 1, **holdings(session.process), "page": page.is_open, "page_frames_per_s": page.frames, "steps": steps,
                     "late": late, "late_percent": round(100 * (late - before["late"]) / max(1, steps - before["steps"]), 3),
                     "inserted_mm": round(1e3 * hand.answer[9], 1), "round_trip_p50_ms": trip["p50_ms"], "round_trip_p99_ms": trip["p99_ms"]})
        hand.trips.clear()
        hand.sent.clear()
        runner.write_rows(options.output, rows)
        return session.process.poll() is not None or len(rows) >= options.minutes

    hand.go(math.inf, push, note)
    summary = session.end()
    print(json.dumps({key: summary[key] for key in ("steps", "late_share", "stretched_s", "step", "input_to_force", "failure", "state_hash")}, indent=2))


class Malformed(threading.Thread):
    """Datagrams that are none of the protocol's, to a session's port, evenly over a time: noise of any length, and requests cut short."""

    def __init__(self, port, count, seconds):
        super().__init__(daemon=True)
        self.address, self.count, self.seconds, self.sent = ("127.0.0.1", port), count, seconds, 0
        dice = random.Random(1)
        self.kinds = [dice.randbytes(dice.randrange(0, 1200)) for _ in range(500)] + [self.cut_off(dice) for _ in range(500)]

    @staticmethod
    def cut_off(dice):
        return REQUEST.pack(0x484C4553, 1, 0, 1, 0, 0.1, 0, 0, 0)[:dice.randrange(4, REQUEST.size)]

    def run(self):
        line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        began = time.monotonic()
        while self.sent < self.count:
            due = min(self.count, int(self.count * (time.monotonic() - began) / self.seconds) + 1)
            for k in range(self.sent, due):
                line.sendto(self.kinds[k % len(self.kinds)], self.address)
            self.sent = due
            time.sleep(0.002)


def run(options):
    session = Session(options.app, options.scene, options.live)
    browser = open_page(session.page) if options.page else None
    hand = Hand(session.port, delay=options.delay)
    time.sleep(1)
    stolen = stolen_s()
    if options.malformed:
        Malformed(session.port, options.malformed, options.seconds).start()
    hand.go(options.seconds, follow(options.speed))
    seen = {"memory_mb": round(runner.memory_mb(session.process.pid), 1), "stolen_s": round(stolen_s() - stolen, 2)}
    if browser:
        seen["page_frames_per_s"] = browser.evaluate("seldinger.fps")
        browser.close()
    summary = session.end()
    print(json.dumps({"sent": hand.sequence, "answered": len(hand.trips), "round_trip": quantiles(hand.trips), **seen,
                      **{key: summary[key] for key in ("rate_hz", "steps", "late", "woken_late", "late_share", "cut_short", "stretched_s", "step", "wake_up", "input_to_force",
                                                       "scheduling", "packets", "coupling")}}, indent=2))


def replay(app, scene, record, threads):
    """@return exit code, state hash, steps and halved steps of the record run again on `threads` threads"""
    folder = tempfile.mkdtemp(prefix="seldinger-replay-")
    done = subprocess.run([app, "run", scene, "--replay", record, "-o", folder, "--overwrite", "--quiet", "--set", "scene.record_every=1000"],
                          env={**os.environ, "POCL_MAX_PTHREAD_COUNT": str(threads)}, capture_output=True, text=True)
    with open(os.path.join(folder, "summary.json")) as file:
        summary = json.load(file)
    return {"threads": threads, "exit": done.returncode, "said": done.stderr.strip(),
            **{key: summary[key] for key in ("state_hash", "steps", "halved_steps", "outside_m", "energy") if key in summary}}


def wild(options):
    """Every half second another speed up to 0.3 m/s and another rate of turning up to 15 rad/s, each way; a hand that is held, not felt."""
    session = Session(options.app, options.scene, options.live)
    hand = Hand(session.port)
    time.sleep(1)
    chance = random.Random(options.seed)
    begin, period, k, speed, rate = time.perf_counter(), hand.period, 0, 0.0, 0.0
    while k * period < options.seconds and session.process.poll() is None:
        if k % 500 == 0:
            speed, rate = chance.uniform(-0.3, 0.3), chance.uniform(-15, 15)
        hand.x = min(max(hand.x + speed * period, 0.0), options.reach)
        hand.turn += rate * period
        hand.sequence += 1
        hand.receive()
        try:
            hand.socket.send(REQUEST.pack(0x484C4553, 1, 0, hand.sequence, k * period, hand.x, hand.turn, 0, 0))
        except ConnectionRefusedError:
            break
        k += 1
        time.sleep(max(0.0, begin + k * period - time.perf_counter()))
    told = {"seconds": k * period, "flags": hand.answer[-1] if hand.answer else None}
    if options.kill:
        session.process.kill()
        session.process.communicate()
    else:
        summary = session.end()
        told.update({key: summary[key] for key in ("state_hash", "steps", "late_share", "coupling")}, said=session.said.strip())
    print(json.dumps({"live": told, "replays": [replay(options.app, options.scene, session.record, threads) for threads in (1, 2)]}, indent=2))


def swing(app, scene, stiffness, delay, options):
    """How far the hand swings a while after it has ceased to tremble, pressed with options.press against what it has met."""
    session = Session(app, scene, ["--lockstep", "--coupling-stiffness", str(stiffness), *options.live])
    hand = Hand(session.port, delay=delay, damping=options.damping)
    hand.calm_from = 3.0
    reach = lambda t, x: 60 * (min(options.reach, 0.25 * t) - x) if t < 1.5 else options.press
    hand.go_in_lockstep(4.5, reach, lambda log: bool(log) and abs(log[-1][1]) > 0.5)
    summary = session.end()
    last = [x for t, x, *_ in hand.log if t > hand.log[-1][0] - 1]
    # a slow drift is the wire sliding on, a swing goes both ways
    turns = [last[k] for k in range(1, len(last) - 1) if (last[k] - last[k - 1]) * (last[k + 1] - last[k]) < 0]
    gone = max((abs(a - b) for a, b in zip(turns, turns[1:])), default=0.0)
    return max(gone, 0.01) if hand.refused else gone, summary


def stability(options):
    name = pathlib.Path(options.scene).stem
    rows = runner.read_rows(options.output, lambda row: row["scene"] != name)
    for delay in options.delays:
        for stiffness in options.stiffnesses:
            gone, summary = swing(options.app, options.scene, stiffness, delay, options)
            line = (options.damping) / (1e-3 * (0.5 + 1 + delay))
            rows.append({"scene": name, "stiffness_n_m": stiffness, "delay_ms": delay, "swing_mm": round(1e3 * gone, 4), "stable": int(gone < 5e-5),
                         "colgate_n_m": round(line, 1), "hand_energy_j": summary["coupling"][0]["energy_j"],
                         "coupling_energy_lowest_j": summary["coupling"][0]["advance_energy_lowest_j"]})
            print(rows[-1], flush=True)
            runner.write_rows(options.output, rows)


def plot(options):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    sys.path.insert(0, str(runner.ROOT / "assets"))
    from plot_style import BLACK, BLUE, GREEN, RED, use_style
    use_style()
    rows = runner.read_rows(options.table)
    scenes = sorted({row["scene"] for row in rows})
    figure, panels = plt.subplots(1, len(scenes), figsize=(3.4 * len(scenes), 3.2), sharey=True, squeeze=False)
    for axes, scene in zip(panels[0], scenes):
        own = [row for row in rows if row["scene"] == scene]
        for stable, marker, colour in (("1", "o", GREEN), ("0", "x", RED)):
            chosen = [row for row in own if row["stable"] == stable]
            axes.scatter([float(r["delay_ms"]) for r in chosen], [float(r["stiffness_n_m"]) for r in chosen], marker=marker, color=colour,
                         label="stable" if stable == "1" else "swings")
        line = sorted({(float(r["delay_ms"]), float(r["colgate_n_m"])) for r in own})
        axes.plot(*zip(*line), color=BLACK, label="Colgate's line, hand of 3 N s/m")
        axes.axhline(500, color=BLUE, linestyle="--", label="default stiffness")
        axes.set(yscale="log", title=scene)
    panels[0][0].set(ylabel="coupling stiffness [N/m]")
    figure.supxlabel("delay of the force beside the period that it is held for [ms]", fontsize="medium")
    handles, labels = panels[0][0].get_legend_handles_labels()
    for axes in panels[0][1:]:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            if label not in labels:
                handles.append(handle), labels.append(label)
    figure.legend(handles, labels, loc="upper center", ncols=2)
    figure.set_layout_engine("constrained", rect=(0, 0, 1, 0.85))  # the legend above
    figure.savefig(options.output, dpi=200)


def main():
    parser = runner.parser(__doc__, app=False)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("run", "map", "wild", "soak"):
        command = commands.add_parser(name)
        command.add_argument("scene")
        command.add_argument("--app", required=True)
        command.add_argument("--live", nargs="*", default=[], help="options of `seldinger live`")
    commands.choices["run"].add_argument("--seconds", type=float, default=10)
    commands.choices["run"].add_argument("--speed", type=float, default=0.02)
    commands.choices["run"].add_argument("--delay", type=int, default=0)
    commands.choices["run"].add_argument("--page", action="store_true", help="with the page open in a headless Chromium")
    commands.choices["run"].add_argument("--malformed", type=int, default=0, help="so many malformed datagrams meanwhile")
    command = commands.choices["map"]
    command.add_argument("-o", dest="output", required=True)
    command.add_argument("--damping", type=float, default=3.0)
    command.add_argument("--reach", type=float, default=0.3, help="where the hand meets something [m]")
    command.add_argument("--press", type=float, default=0.6, help="and how it presses on [N]")
    command.add_argument("--stiffnesses", type=float, nargs="+", default=[125, 250, 500, 1000, 2000, 4000, 8000, 16000])
    command.add_argument("--delays", type=int, nargs="+", default=[0, 2, 5, 10, 20])
    command = commands.choices["wild"]
    command.add_argument("--seconds", type=float, default=300)
    command.add_argument("--reach", type=float, default=0.4, help="the farthest that the hand goes [m]")
    command.add_argument("--seed", type=int, default=1)
    command.add_argument("--kill", action="store_true", help="end the session by SIGKILL; the record is replayed all the same")
    command = commands.choices["soak"]
    command.add_argument("-o", dest="output", required=True)
    command.add_argument("--minutes", type=float, default=60)
    command.add_argument("--reach", type=float, default=0.2, help="how far the hand goes in [m]")
    command.add_argument("--page", type=float, nargs=2, default=(10, 25), help="minutes from and to which the page is open")
    command = commands.add_parser("plot")
    command.add_argument("table")
    command.add_argument("-o", dest="output", required=True)
    options = parser.parse_args()
    {"run": run, "map": stability, "plot": plot, "wild": wild, "soak": soak}[options.command](options)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Plays a training scene with a scripted hand over UDP and says whether it was won.

    bench/train.py --app build/seldinger SCENE.toml "2:0.05:0 4:0.09:1.5"      t_s:advance_m:rotation_rad, steadily from one to the next

In lockstep (a step for each datagram, as fast as it goes), so that the sheet is the same on any machine; --real-time: by the clock.
"""
import argparse
import json
import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from live_hand import REQUEST, Hand, Session  # noqa: E402


def along(keys, t):
    before = (0.0, 0.0, 0.0)
    for key in keys:
        if t < key[0]:
            share = (t - before[0]) / (key[0] - before[0])
            return [a + share * (b - a) for a, b in zip(before[1:], key[1:])]
        before = key
    return keys[-1][1:]


def ask(hand, sequence, t, keys):
    hand.socket.send(REQUEST.pack(0x484C4553, 1, 0, sequence, t, *along(keys, t), 1, 0))


def in_lockstep(hand, keys):
    hand.socket.setblocking(True)
    hand.socket.settimeout(5)
    for k in range(1, round(1000 * (keys[-1][0] + 0.3))):
        ask(hand, k, 1e-3 * k, keys)
        hand.socket.recv(128)


def by_the_clock(hand, keys):
    begin, sequence = time.perf_counter(), 0
    while (t := time.perf_counter() - begin) < keys[-1][0] + 0.3:
        sequence += 1
        ask(hand, sequence, t, keys)
        hand.receive()
        time.sleep(0.002)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("way")
    parser.add_argument("--app", required=True)
    parser.add_argument("--real-time", action="store_true")
    options = parser.parse_args()
    keys = [tuple(float(v) for v in key.split(":")) for key in options.way.split()]
    session = Session(options.app, options.scene, [] if options.real_time else ["--lockstep"])
    hand = Hand(session.port)
    (by_the_clock if options.real_time else in_lockstep)(hand, keys)
    summary = session.end()
    print(json.dumps(summary["score"], indent=2))


if __name__ == "__main__":
    main()

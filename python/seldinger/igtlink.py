"""A run as an OpenIGTLink server: the wire, its tip and the film for 3D Slicer and others. It needs no other package.

    python3 -m seldinger.igtlink SCENE --port 18944 [--every N] [--film PIXELS]

Of every Nth step a client gets, in mm along the scene's axes: TRANSFORM `Tip`, its third axis the tip's direction, its first the material's
director; POLYDATA `Wire`, a line through the nodes; with --film IMAGE `Film`, 12 bits in 16, a pixel a unit, the first one at the origin.
The run waits for its client, ends when that leaves, and is not held to real time.
"""

from __future__ import annotations

import argparse
import socket
import struct
import sys
import time
from typing import Optional

import numpy as np

import seldinger

_POLYNOMIAL = 0x42F0E1EBA9EA3693  # ECMA-182


def _entry(byte: int) -> int:
    value = byte << 56
    for _ in range(8):
        value = ((value << 1) ^ _POLYNOMIAL if value >> 63 & 1 else value << 1) & (1 << 64) - 1
    return value


_TABLE = [_entry(byte) for byte in range(256)]


def crc64(content: bytes) -> int:
    value = 0
    for byte in content:
        value = (value << 8 & (1 << 64) - 1) ^ _TABLE[value >> 56 ^ byte]
    return value


def message(kind: str, device: str, content: bytes, seconds: float) -> bytes:
    stamp = int(seconds * 2**32)
    return struct.pack(">H12s20sQQQ", 1, kind.encode(), device.encode(), stamp, len(content), crc64(content)) + content


def tip(wire: "seldinger._engine.InstrumentOutput") -> bytes:
    nodes = np.asarray(wire.nodes)
    ahead = (nodes[0] - nodes[1]) / np.linalg.norm(nodes[0] - nodes[1])
    side = wire.director[0] - (wire.director[0] @ ahead) * ahead
    side /= np.linalg.norm(side)
    return np.concatenate([side, np.cross(ahead, side), ahead, 1e3 * wire.tip]).astype(">f4").tobytes()


def line(wire: "seldinger._engine.InstrumentOutput") -> bytes:
    nodes = np.asarray(wire.nodes)
    head = [len(nodes), 0, 0, 1, 4 * (len(nodes) + 1), 0, 0, 0, 0, 0]
    return np.array(head, ">u4").tobytes() + (1e3 * nodes).astype(">f4").tobytes() + np.array([len(nodes), *range(len(nodes))], ">u4").tobytes()


def film(picture: np.ndarray) -> bytes:
    rows, columns = picture.shape
    axes = [1, 0, 0, 0, 1, 0, 0, 0, 1, (columns - 1) / 2, (rows - 1) / 2, 0]  # the header has the middle of the image
    return struct.pack(">HBBBB3H12f6H", 1, 1, 5, 2, 2, columns, rows, 1, *axes, 0, 0, 0, columns, rows, 1) + picture.astype("<u2").tobytes()


def main(arguments: Optional[list[str]] = None) -> int:
    words = argparse.ArgumentParser(prog="seldinger.igtlink", description="A run as an OpenIGTLink server.")
    words.add_argument("scene", help="scene file, or the name of a scene of the package")
    words.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as of the command")
    words.add_argument("--port", type=int, default=18944, help="on this machine alone")
    words.add_argument("--every", type=int, default=20, metavar="N", help="messages for every Nth step")
    words.add_argument("--film", type=int, default=0, metavar="PIXELS", help="an X-ray picture of so many rows and columns, too")
    given = words.parse_args(arguments)
    try:
        with seldinger.World(given.scene, set=given.set) as world, socket.create_server(("127.0.0.1", given.port)) as server:
            print(f"port {server.getsockname()[1]}", flush=True)
            client = server.accept()[0]
            with client:
                for step in range(1, world._steps + 1):
                    report = world.step()
                    if report.failed:
                        raise seldinger.Error(f"step {step}: {report.message}", 4)
                    if step % given.every:
                        continue
                    wire, now = world.output.instruments[0], time.time()
                    client.sendall(message("TRANSFORM", "Tip", tip(wire), now) + message("POLYDATA", "Wire", line(wire), now))
                    if given.film:
                        client.sendall(message("IMAGE", "Film", film(world.fluoroscopy(given.film, given.film)), now))
    except seldinger.Error as error:
        print(error, file=sys.stderr)
        return error.code
    except (BrokenPipeError, ConnectionResetError):  # the client has seen enough
        return 0
    except OSError as error:
        print(f"--port: got {given.port}: {error.strerror}; expected one that is free", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())

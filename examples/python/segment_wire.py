#!/usr/bin/env python3
"""Trains a small network to find the wire in X-rays, on 1,000 labelled pictures of one vessel, and tests it on another vessel.

    python3 examples/python/segment_wire.py [--app build/seldinger] [--out out/segment] [--pictures 1000] [--passes 4] [--quick]

Needs torch, numpy and Pillow (Debian: python3-torch python3-pil; or pip). Where one is missing it says so and ends with code 77. It takes
some minutes on two cores: a run of the demo, its frames from ten C-arm angles that a sweep draws, four passes over them. The test vessel
is a carotid-like bend (`arc`) that the network has not seen, from angles of its own, with another wire. --quick is a trial of the same
steps in a minute, too short to learn more than that the loss falls; where it does not, the trial has failed.
"""

import argparse
import json
import pathlib
import resource
import subprocess
import sys
import time

try:
    import numpy as np
    import torch
    from PIL import Image
    from torch import nn
except ImportError as missing:
    print(f"skipped: {missing.name} is not installed (Debian: apt-get install python3-torch python3-numpy python3-pil)")
    sys.exit(77)

SIZE, CROP = 512, 128  # a wire of 0.9 mm is 2.3 pixels wide
ROOT = pathlib.Path(__file__).resolve().parents[2]
VIEWS = """[vary]
"carm.lao_deg" = {{min = {low}, max = {high}, n = {n}}}
"carm.cra_deg" = {{min = -20.0, max = 20.0, n = {n}}}
"carm.photons" = {{min = 2e4, max = 2e5, n = {n}, log = true}}
"""
TEST_SCENE = """[scene]
name = "another vessel"
gravity = [0.0, 0.0, -9.81]
duration_s = 4.0
dt_s = 0.002
record_every = 40
[wire]
preset = "terumo-angled-035"
length_m = 0.35
[vessel]
shape = "arc"
radius_m = 0.004
bend_radius_m = 0.05
angle_deg = 80.0
lead_in_m = 0.05
lead_out_m = 0.06
axis = [0.0, 0.0, 1.0]
normal = [1.0, 0.0, 0.0]
triangles = 12000
[contact]
mu_static = 0.06
mu_sliding = 0.05
[feed]
inlet = "auto"
keys = [ {t_s = 0.0, advance_m = 0.02}, {t_s = 4.0, advance_m = 0.15} ]
[output]
wire_every = 40
"""


def call(app, *words):
    subprocess.run([app, *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def spent(began):
    """Processor time of this process and of the runs and pictures that it had made [s]."""
    times = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() - began + times.ru_utime + times.ru_stime


def pictures(app, folder, run, views, frames, keep):
    """Renders `frames` of a run from each view with labels. @return grey [n, 1, SIZE, SIZE] float32, and masks, bool"""
    (folder / "views.toml").write_text(views)
    call(app, "render", run, "--view", "fluoro", "--size", f"{SIZE}x{SIZE}", "--frames", f"{frames[0]}:{frames[1]}",
         "--views", folder / "views.toml", "--labels", folder / "labels", "-o", folder / "x.png", "--resume", "--quiet")
    names = sorted((folder / "labels").glob("*.json"))
    names = [names[int(k)] for k in np.linspace(0, len(names) - 1, min(keep, len(names)))]
    grey = np.empty((len(names), 1, SIZE, SIZE), np.float32)
    mask = np.empty(grey.shape, bool)
    for k, name in enumerate(names):
        x = np.log(np.asarray(Image.open(folder / json.loads(name.read_text())["image"]["file"]), dtype=np.float32) + 1)
        grey[k] = (x - x.mean()) / x.std()
        mask[k] = np.asarray(Image.open(name.with_name(name.stem + "_mask.png"))) > 0
    return torch.from_numpy(grey), torch.from_numpy(mask)


class Net(nn.Module):
    """Three levels down and up again with skips [Ronneberger 2015, doi:10.1007/978-3-319-24574-4_28], 67,000 weights."""

    def __init__(self, width=12):
        super().__init__()
        sizes = [1, width, 2 * width, 4 * width]
        self.down = nn.ModuleList(self.pair(a, b) for a, b in zip(sizes, sizes[1:]))
        self.up = nn.ModuleList(self.pair(sizes[k + 1] + sizes[k], sizes[k]) for k in (2, 1))
        self.last = nn.Conv2d(width, 1, 1)

    @staticmethod
    def pair(a, b):
        return nn.Sequential(nn.Conv2d(a, b, 3, padding=1), nn.BatchNorm2d(b), nn.ReLU(), nn.Conv2d(b, b, 3, padding=1), nn.BatchNorm2d(b), nn.ReLU())

    def forward(self, x):
        kept = []
        for k, level in enumerate(self.down):
            x = level(x if k == 0 else nn.functional.max_pool2d(x, 2))
            kept.append(x)
        for level, skip in zip(self.up, kept[-2::-1]):
            x = level(torch.cat([nn.functional.interpolate(x, scale_factor=2.0), skip], 1))
        return self.last(x)


def crops(x, y, rng):
    """A piece of each picture, half of them about a pixel of the wire, mirrored at random."""
    out = []
    for a, b in zip(x, y):
        at = rng.integers(0, SIZE - CROP + 1, 2)
        wire = b[0].nonzero()
        if len(wire) and rng.random() < 0.5:
            at = np.clip(wire[rng.integers(len(wire))].numpy() - rng.integers(0, CROP, 2), 0, SIZE - CROP)
        part = torch.stack([t[0, at[0]:at[0] + CROP, at[1]:at[1] + CROP].float() for t in (a, b)])
        out.append(part.flip([d for d in (1, 2) if rng.random() < 0.5]))
    both = torch.stack(out)
    return both[:, :1], both[:, 1:]


def loss_of(logits, y):
    p = torch.sigmoid(logits)
    overlap = (2 * (p * y).sum() + 1) / (p.sum() + y.sum() + 1)
    return nn.functional.binary_cross_entropy_with_logits(logits, y) + 1 - overlap


@torch.no_grad()
def dice(net, x, y):
    net.eval()
    found = torch.cat([net(part) > 0 for part in x.split(8)]).float()
    return float(2 * (found * y).sum() / (found.sum() + y.sum()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--app", default=str(ROOT / "build/seldinger"))
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/segment"))
    parser.add_argument("--pictures", type=int, default=1000)
    parser.add_argument("--passes", type=int, default=4)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    seconds, views, most = (3, 1, 24) if options.quick else (10, 10, options.pictures)
    torch.manual_seed(0)
    rng = np.random.default_rng(0)
    began = time.process_time()
    for part in ("train", "test"):
        (options.out / part).mkdir(parents=True, exist_ok=True)
    if not (options.out / "run/summary.json").exists():
        call(options.app, "run", ROOT / "assets/scenes/aortic-arch.toml", "-o", options.out / "run", "--quiet", "--overwrite",
             "--set", f"scene.duration_s={seconds}", "--set", "output.wire_every=80")
        (options.out / "test.toml").write_text(TEST_SCENE)
        call(options.app, "run", options.out / "test.toml", "-o", options.out / "run-test", "--quiet", "--overwrite")
    x, y = pictures(options.app, options.out / "train", options.out / "run", VIEWS.format(low=-60.0, high=60.0, n=views), (20, 12 * seconds), most)
    tx, ty = pictures(options.app, options.out / "test", options.out / "run-test", VIEWS.format(low=-45.0, high=45.0, n=(views + 1) // 2), (10, 49),
                      max(8, most // 10))
    print(f"{len(x)} pictures to train on, {len(tx)} of another vessel: {spent(began):.0f} s of processor time", flush=True)
    net = Net()
    adam = torch.optim.Adam(net.parameters(), 2e-3)
    batches = len(x) // 8
    plan = torch.optim.lr_scheduler.OneCycleLR(adam, 5e-3, total_steps=options.passes * batches)
    losses = []
    for k in range(options.passes):
        net.train()
        total = 0.0
        for batch in np.array_split(rng.permutation(len(x)), batches):
            a, b = crops(x[batch], y[batch], rng)
            adam.zero_grad()
            loss = loss_of(net(a), b)
            loss.backward()
            adam.step()
            plan.step()
            total += float(loss.detach())
        losses.append(total / batches)
        print(f"pass {k + 1}: loss {losses[-1]:.3f}, {spent(began):.0f} s", flush=True)
    torch.save(net.state_dict(), options.out / "net.pt")
    some = slice(None, None, max(1, len(x) // (len(tx) // 2)))
    print(f"Dice: {dice(net, x[some], y[some]):.3f} on the vessel of the training, {dice(net, tx, ty):.3f} on the other; {spent(began):.0f} s")
    if options.quick and not losses[-1] < losses[0]:
        sys.exit("the loss did not fall")


if __name__ == "__main__":
    main()

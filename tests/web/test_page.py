#!/usr/bin/env python3
"""The live page and a report in a real, headless Chromium with software GL. Exit 77, skipped, where there is none.

    test_page.py APP SOURCE [-o FOLDER]      pictures go into FOLDER where one is given
"""
import argparse
import concurrent.futures
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    from matplotlib.image import imread
except ImportError:
    print("skipped: no matplotlib: apt-get install python3-matplotlib")
    sys.exit(77)
from browser import Browser, WebSocket  # noqa: E402
from phone import phone  # noqa: E402
from session import LiveSession  # noqa: E402

FAILURES = []


def check(holds, what):
    print(("ok      " if holds else "FAILED  ") + what, flush=True)
    if not holds:
        FAILURES.append(what)


def pixels(png):
    """[h, w, 3], 0 ... 255"""
    return (imread(io.BytesIO(png), format="png")[..., :3] * 255 + 0.5).astype(int)


def share(rows, box, like):
    """Of the box's pixels, those for which `like` holds."""
    x0, y0, x1, y1 = (int(v) for v in box)
    inside = rows[max(0, y0):y1, max(0, x0):x1]
    return like(inside).mean() if inside.size else 0.0


def reddish(pixels):
    return (pixels[..., 0] > pixels[..., 1] + 25) & (pixels[..., 0] > pixels[..., 2] + 25)


def differing(a, b, box):
    x0, y0, x1, y1 = (int(v) for v in box)
    return (a[y0:y1, x0:x1] != b[y0:y1, x0:x1]).any(axis=2).sum()


ADVANCE = "seldinger.last.numbers.instruments[0].advance"


def advance(browser):
    return browser.evaluate(ADVANCE)


def hold(browser, key, until):
    """A key is down until so much has come of it, however fast the machine is."""
    browser.key(key, key, True)
    try:
        browser.wait(until, 60)
        came = True
    except TimeoutError:
        came = False
    browser.key(key, key, False)
    browser.wait(f"seldinger.frames > {browser.evaluate('seldinger.frames')} + 5", 60)
    return came


def box_of(browser, element):
    return json.loads(browser.evaluate(f"(() => {{ const b = document.querySelector('{element}').getBoundingClientRect(); "
                                       "return JSON.stringify([b.left, b.top, b.right, Math.min(b.bottom, innerHeight)]) })()"))


def drive(browser, session, pictures):
    browser.open(session.url)
    browser.wait("window.seldinger && seldinger.frames > 5 && seldinger.viewer", 60)
    time.sleep(1)
    before = pixels(browser.picture(os.path.join(pictures, "before.png")))
    scene = box_of(browser, "#scene")
    check(share(before, scene, reddish) > 0.03, "the canvas shows the vessel")
    check(hold(browser, "ArrowUp", f"{ADVANCE} > 0.08"), f"the arrow up pushes the wire ({advance(browser):.3f} m)")
    after = pixels(browser.picture(os.path.join(pictures, "wide-light.png")))
    check(differing(before, after, scene) > 300, "and the wire is seen")
    inserted, turned = advance(browser), browser.evaluate("seldinger.last.numbers.instruments[0].turn")
    check(hold(browser, "ArrowDown", f"{ADVANCE} < {inserted - 0.015}"), "the arrow down pulls it back")
    check(hold(browser, "ArrowRight", f"seldinger.last.numbers.instruments[0].turn > {turned + 1.5}"), "the arrow right turns it")
    browser.wait("seldinger.fps > 0")
    print(f"        {browser.evaluate('seldinger.fps')} frames drawn in the last second")
    pedals(browser)
    layouts(browser, pictures)
    return inserted


def pedals(browser):
    browser.key("f", "KeyF", True, "f")
    browser.key("f", "KeyF", False)
    browser.wait("seldinger.last.numbers.fluoro", 5)
    browser.key("c", "KeyC", True, "c")
    time.sleep(1.5)
    grey = json.loads(browser.evaluate("""(() => { seldinger.fluoroscope.draw(); const c = document.createElement('canvas'); c.width = c.height = 360;
        const g = c.getContext('2d'); g.drawImage(document.querySelector('#fluoroscope'), 0, 0); const d = g.getImageData(0, 0, 360, 360).data;
        let low = 255, high = 0; for (let i = 0; i < d.length; i += 4) { const x = i / 4 % 360 - 180, y = (i / 4 / 360 | 0) - 180;
        if (x * x + y * y > 150 * 150) continue; low = Math.min(low, d[i]); high = Math.max(high, d[i]); } return JSON.stringify([low, high]) })()"""))
    check(grey[0] < 0.6 * grey[1], f"fluoroscopy shows wire and contrast (grey {grey[0]} to {grey[1]})")
    browser.key("c", "KeyC", False)
    browser.key(" ", "Space", True, " ")
    browser.key(" ", "Space", False)
    browser.wait("seldinger.last.numbers.paused", 5)
    browser.key(" ", "Space", True, " ")
    browser.key(" ", "Space", False)
    browser.wait("!seldinger.last.numbers.paused", 5)
    check(True, "the space bar pauses and goes on")


def layouts(browser, pictures):
    for name, width, height, scheme in (("wide-dark", 1280, 720, "dark"), ("narrow-light", 390, 844, "light")):
        browser.size(width, height, width < 800)
        browser.scheme(scheme)
        time.sleep(1)
        rows = pixels(browser.picture(os.path.join(pictures, name + ".png")))
        corner = sum(rows[-2][1])
        check((corner < 200) == (scheme == "dark"), f"{name}: the page is {scheme}")
        check(browser.evaluate("document.documentElement.scrollWidth <= innerWidth"), f"{name}: nothing runs out of the window")
        check(share(rows, box_of(browser, "#scene"), reddish) > 0.015, f"{name}: the vessel is there")
    browser.size(1280, 720)


def press(browser, key):
    browser.key(key, "Key" + key.upper(), True, key)
    browser.key(key, "Key" + key.upper(), False)


def training(app, source, pictures):
    """The clock starts at the first push, attempts are kept, the sheet fits on a laptop, and an exam shows the X-ray alone."""
    session, browser = LiveSession(app, os.path.join(source, "assets/scenes/training/left-subclavian.toml")), Browser()
    try:
        browser.size(1280, 720)
        browser.scheme("light")
        browser.open(session.url)
        browser.wait("window.seldinger && seldinger.frames > 5 && seldinger.viewer", 60)
        browser.wait("seldinger.last.numbers.time > 1", 60)
        check(browser.evaluate("seldinger.last.numbers.score.time === 0"), "training: the clock waits for the first push")
        check(hold(browser, "ArrowUp", "seldinger.last.numbers.score.time > 1"), "training: and runs from then on")
        press(browser, "r")
        browser.wait("seldinger.attempts.length === 1 && seldinger.last.numbers.score.time === 0", 10)
        check(browser.evaluate("seldinger.attempts[0].seen && document.querySelector('#attempts').textContent.startsWith('not reached')"), "training: an attempt is kept")
        check(browser.evaluate("(() => { const c = document.querySelector('.column.side'); return c.scrollHeight <= c.clientHeight })()"), "training: the sheet fits on 1280 x 720")
        press(browser, "e")
        press(browser, "f")
        hold(browser, "ArrowUp", f"{ADVANCE} > {advance(browser)} + 0.03")
        rows = pixels(browser.picture(os.path.join(pictures, "exam.png")))
        check(share(rows, box_of(browser, "#scene"), reddish) == 0, "exam: the vessel is not in view")
        large = box_of(browser, "#fluoroscope")
        check(large[2] - large[0] > 800 and large[3] - large[1] > 400, f"exam: the X-ray is large ({large})")
        press(browser, "r")
        browser.wait("seldinger.attempts.length === 2", 10)
        check(not browser.evaluate("seldinger.attempts[1].seen") and browser.evaluate("document.querySelector('#attempts').textContent.endsWith('exam')"), "exam: the attempt says so")
        press(browser, "e")
        time.sleep(1)
        check(share(pixels(browser.picture(os.path.join(pictures, "after-exam.png"))), box_of(browser, "#scene"), reddish) > 0.03, "after the exam the vessel is back")
    finally:
        browser.close()
        summary = session.end()
    check(len(summary["attempts"]) == 2 and summary["attempts"][0]["time_s"] > 1, f"the session's summary has the attempts ({len(summary['attempts'])})")


def refusals(session):
    host = f"127.0.0.1:{session.port}"
    for what, headers, path, status in (("its own origin", {"Origin": f"http://{host}"}, "/ws", 101), ("a foreign origin", {"Origin": "http://evil.example"}, "/ws", 403),
                                        ("a foreign host", {"Host": "evil.example"}, "/ws", 403), ("another path", {}, "/other", 404)):
        client = WebSocket("127.0.0.1", session.port, path, headers)
        check(client.status == status, f"a socket with {what}: {client.status}")
        client.close()


def slow_and_broken(browser, session):
    deaf = WebSocket("127.0.0.1", session.port, "/ws")  # reads nothing from now on
    second = WebSocket("127.0.0.1", session.port, "/ws")
    for k in range(10000):
        if k % 100 == 0:
            hostile = WebSocket("127.0.0.1", session.port, "/ws")
        try:
            hostile.send(b"\xff\x00{" + os.urandom(k % 90), 1 + k % 15)
        except OSError:
            hostile = WebSocket("127.0.0.1", session.port, "/ws")
    hostile.close()
    frames = browser.evaluate("seldinger.frames")
    try:
        browser.wait(f"seldinger.frames > {frames + 20}", 30)
        goes_on = True
    except TimeoutError:
        goes_on = False
    check(goes_on, "ten thousand malformed messages and a deaf client: the page goes on")
    opcode, data = second.receive()
    check(opcode == 2 and len(data) > 100, "a second client gets frames too")
    second.close()
    deaf.close()


def dropped(browser):
    frames = browser.evaluate("seldinger.socket.close(), seldinger.frames")
    browser.wait("document.querySelector('#pace').textContent === 'not connected'", 5)
    browser.wait(f"seldinger.socket.readyState === 1 && seldinger.frames > {frames + 20}", 20)
    check(True, "a dropped connection is said, and comes back")


def keyboard_only(browser):
    """With Tab alone every control is reached, round and round, and Enter presses it."""
    reached = []
    for _ in range(11):
        browser.key("Tab", "Tab", True)
        browser.key("Tab", "Tab", False)
        reached.append(browser.evaluate("document.activeElement.id"))
    check({"pause", "reset", "fluoro", "contrast", "near", "exam", "view", "lao", "cra"} <= set(reached), f"the keyboard reaches every control ({' '.join(reached)})")
    browser.evaluate("document.querySelector('#near').focus()")
    browser.key("Enter", "Enter", True, "\r")
    browser.key("Enter", "Enter", False)
    check(browser.evaluate("document.querySelector('#near').getAttribute('aria-pressed')") == "true", "and Enter presses a button")
    browser.evaluate("document.querySelector('#near').click(), document.querySelector('#view').focus()")


def without_webgl(session, pictures):
    browser = Browser(more=["--disable-3d-apis"])
    try:
        browser.open(session.url)
        browser.wait("window.seldinger && seldinger.frames > 5", 60)
        said = browser.evaluate("document.querySelector('#message').hidden ? '' : document.querySelector('#message').textContent")
        check("no WebGL" in said, f"a browser without WebGL is told so ({said})")
        check(hold(browser, "ArrowUp", f"{ADVANCE} > {advance(browser)} + 0.01"), "and its keys push all the same")
        check("N" in browser.evaluate("document.querySelector('#sheet').textContent"), "and it has its sheet")
        browser.picture(os.path.join(pictures, "no-webgl.png"))
    finally:
        browser.close()


def reports(app, source, pictures):
    folder, browser = tempfile.mkdtemp(prefix="seldinger-report-"), Browser()
    try:
        run = os.path.join(folder, "run")
        subprocess.run([app, "run", os.path.join(source, "assets/scenes/experiment2.toml"), "--set", "scene.duration_s=6", "-o", run, "--quiet"], check=True)
        subprocess.run([app, "report", run, "-o", os.path.join(folder, "report.html")], check=True, stdout=subprocess.DEVNULL)
        browser.scheme("light")
        browser.open("file://" + os.path.join(folder, "report.html"))
        browser.wait("window.seldinger && seldinger.data && seldinger.viewer", 60)
        browser.wait("seldinger.frame > 50", 20)
        last = browser.evaluate("seldinger.frame")
        rows = pixels(browser.picture(os.path.join(pictures, "report.png")))
        check(share(rows, box_of(browser, "#scene"), reddish) > 0.02, "the report shows the vessel")
        browser.evaluate("document.querySelector('#time').value = 3; document.querySelector('#time').dispatchEvent(new Event('input'))")
        check(last > 50 and browser.evaluate("seldinger.frame") == 3, "its slider goes back in time")
        with open(os.path.join(folder, "report.html")) as file:
            text = file.read()
        check("src=" not in text.split("<script>")[0] and "href=\"http" not in text, "it needs nothing from outside")
        report_of_several(browser, app, source, pictures)
        errors = browser.errors()
        check(not errors, f"reports: nothing in the console {errors or ''}")
    finally:
        browser.close()
        shutil.rmtree(folder, ignore_errors=True)


# what each instrument is drawn in where nothing touches it, as live.css has it
COLOURS = {"light": {"sheath": (0x1f, 0x7a, 0x8c), "catheter": (0x24, 0x43, 0x5f), "wire": (0x7d, 0x4e, 0x9e)},
           "dark": {"sheath": (0x4f, 0xb3, 0xc4), "catheter": (0xc8, 0xd6, 0xe2), "wire": (0xb4, 0x8a, 0xd6)}}


def like(colour):
    """Shaded: of its hue within a sixth, and neither black nor white."""
    def same(pixels):
        total = pixels.sum(axis=-1)
        hue = abs(pixels / total.clip(1)[..., None] - [part / sum(colour) for part in colour])
        return (total > 90) & (total < 740) & (hue < 0.035).all(axis=-1)
    return same


def report_of_several(browser, app, source, pictures):
    folder = tempfile.mkdtemp(prefix="seldinger-report-")
    try:
        run, page = os.path.join(folder, "run"), os.path.join(folder, "report.html")
        subprocess.run([app, "run", os.path.join(source, "assets/scenes/sheath-catheter-wire.toml"), "--set", "scene.duration_s=5", "--set",
                        "output.wire_every=50", "-o", run, "--quiet", "--error-estimate", "off"], check=True)
        subprocess.run([app, "report", run, "-o", page], check=True, stdout=subprocess.DEVNULL)
        browser.open("file://" + page)
        browser.wait("window.seldinger && seldinger.data && seldinger.viewer", 60)
        names = browser.evaluate("[...document.querySelectorAll('#legend li')].map((item) => item.textContent)")
        check(names == ["sheath", "catheter", "wire", "contact"], f"the legend names every instrument of a report ({', '.join(names)})")
        nodes = browser.evaluate("seldinger.viewer.shown.map((nodes) => nodes.length / 4)")
        check(len(nodes) == 3 and min(nodes) > 2, f"and all of them are played back ({nodes} nodes)")
        browser.evaluate("seldinger.viewer.distance *= 0.45, seldinger.viewer.moved = true")
        for name, width, height, scheme in (("wide-light", 1280, 720, "light"), ("narrow-dark", 390, 844, "dark")):
            browser.size(width, height, width < 800)
            browser.scheme(scheme)
            time.sleep(1)
            rows = pixels(browser.picture(os.path.join(pictures, f"report-several-{name}.png")))
            check(browser.evaluate("document.documentElement.scrollWidth <= innerWidth"), f"report, {name}: nothing runs out of the window")
            for instrument, colour in COLOURS[scheme].items():
                seen = share(rows, box_of(browser, "#scene"), like(colour))
                check(seen > 1e-4, f"report, {name}: the {instrument} is seen in its colour ({1e4 * seen:.1f} of 10,000 pixels)")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def page(app, source, pictures):
    session, browser = LiveSession(app, os.path.join(source, "assets/scenes/experiment2.toml")), Browser()
    try:
        drive(browser, session, pictures)
        keyboard_only(browser)
        dropped(browser)
        refusals(session)
        slow_and_broken(browser, session)
        errors = browser.errors()
        check(not errors, f"nothing in the console {errors or ''}")
        browser.close()
        without_webgl(session, pictures)
        summary = session.end()
        check(summary["failure"] == "", "the session ended well")
        print(f"        {summary['steps']} steps, {100 * summary['late_share']:.2f} % late, p99 {summary['step']['p99_ms']:.2f} ms")
    finally:
        browser.close()
        session.end()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("app")
    parser.add_argument("source")
    parser.add_argument("-o", dest="pictures")
    options = parser.parse_args()
    try:
        Browser().close()
    except FileNotFoundError:
        print("skipped: no chromium: apt-get install chromium")
        sys.exit(77)
    pictures = options.pictures or tempfile.mkdtemp(prefix="seldinger-pictures-")
    os.makedirs(pictures, exist_ok=True)
    # much of each is waiting, for a wire that is pushed at the speed of a hand: two at a time, the longest first
    parts = [(page, ()), (reports, ()), (training, ()), (phone, (check,))]
    try:
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for done in [pool.submit(part, options.app, options.source, pictures, *more) for part, more in parts]:
                done.result()
    finally:
        if not options.pictures:
            shutil.rmtree(pictures, ignore_errors=True)
    if FAILURES:
        sys.exit(f"{len(FAILURES)} failed")


if __name__ == "__main__":
    main()

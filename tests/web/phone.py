"""The live page as a phone on the same network has it: small, three pixels to a point, fingers for a mouse, the token in its address."""
import json
import math
import os
import socket
import time
import urllib.error
import urllib.request

from browser import Browser
from session import LiveSession

TOKEN = "a-secret-of-the-test"


def own_address():
    """This machine's address on its network; loopback where it is on none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # nothing is sent
            return probe.getsockname()[0]
        except OSError:
            return "127.0.0.1"


def status_of(url):
    try:
        with urllib.request.urlopen(url) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def box_of(browser, element):
    return json.loads(browser.evaluate(f"(() => {{ const b = document.querySelector('{element}').getBoundingClientRect(); "
                                       "return JSON.stringify([b.left, b.top, b.right, b.bottom]) })()"))


def middle_of(browser, element):
    left, top, right, bottom = box_of(browser, element)
    return (left + right) / 2, (top + bottom) / 2


def numbers(browser):
    return json.loads(browser.evaluate("JSON.stringify(seldinger.last.numbers.instruments[0])"))


def drag(browser, begin, end, until=None):
    """One finger, in ten moves; then it stays until so much has come of it. @return did it"""
    browser.touch("touchStart", [begin])
    for k in range(1, 11):
        browser.touch("touchMove", [tuple(a + (b - a) * k / 10 for a, b in zip(begin, end))])
    came = True
    if until:
        try:
            browser.wait(until, 60)
        except TimeoutError:
            came = False
    browser.touch("touchEnd", [])
    some_frames(browser)
    return came


def some_frames(browser, count=5):
    browser.wait(f"seldinger.frames > {browser.evaluate('seldinger.frames')} + {count}", 60)


def turn_and_pinch(browser, check):
    x, y = middle_of(browser, "#view")
    before = browser.evaluate("[seldinger.viewer.turn, seldinger.viewer.tilt, seldinger.viewer.distance]")
    drag(browser, (x - 60, y), (x + 60, y + 40))
    after = browser.evaluate("[seldinger.viewer.turn, seldinger.viewer.tilt, seldinger.viewer.distance]")
    check(abs(after[0] - before[0]) > 0.3 and abs(after[1] - before[1]) > 0.1, "phone: a finger on the picture turns it")
    check(browser.evaluate("scrollY") == 0, "phone: and does not scroll the page")
    browser.touch("touchStart", [(x - 30, y), (x + 30, y)])
    for gap in (40, 60, 80, 100):
        browser.touch("touchMove", [(x - gap, y), (x + gap, y)])
    browser.touch("touchEnd", [])
    check(browser.evaluate("seldinger.viewer.distance") < 0.7 * after[2], "phone: two fingers bring it nearer")


def push_and_turn(browser, check):
    x, y = middle_of(browser, "#pad")
    left, top, right, bottom = box_of(browser, "#pad")
    check(top >= 0 and bottom <= browser.evaluate("innerHeight"), "phone: the pad is on the first screen, below the picture")
    of = "seldinger.last.numbers.instruments[0]"
    start = numbers(browser)
    came = drag(browser, (x, y), (x, y - 45), f"{of}.advance > {start['advance']} + 0.03")
    pushed = numbers(browser)
    check(came, f"phone: a finger held upwards on the pad pushes ({pushed['advance']:.3f} m)")
    some_frames(browser, 20)
    check(abs(numbers(browser)["advance"] - pushed["advance"]) < 1e-3, "phone: a finger taken off pushes no more")
    check(drag(browser, (x, y), (x, y + 45), f"{of}.advance < {pushed['advance']} - 0.01"), "phone: downwards it pulls back")
    check(drag(browser, (x, y), (x + 70, y), f"{of}.turn > {numbers(browser)['turn']} + 1.5"), "phone: sideways it turns")


def tap(browser, element):
    browser.touch("touchStart", [middle_of(browser, element)])
    browser.touch("touchEnd", [])


def buttons(browser, check):
    for name in ("pause", "reset", "fluoro", "contrast", "near"):
        left, top, right, bottom = box_of(browser, "#" + name)
        check(bottom - top >= 36 and right - left >= 36, f"phone: the button {name} is large enough for a finger ({right - left:.0f} x {bottom - top:.0f})")
    tap(browser, "#fluoro")
    browser.wait("seldinger.last.numbers.fluoro", 20)
    browser.touch("touchStart", [middle_of(browser, "#contrast")])
    browser.wait("seldinger.last.numbers.contrast", 20)
    some_frames(browser, 20)
    check(browser.evaluate("seldinger.last.numbers.contrast"), "phone: contrast runs while a finger is on its button")
    browser.touch("touchEnd", [])
    browser.wait("!seldinger.last.numbers.contrast", 20)
    tap(browser, "#fluoro")
    browser.wait("!seldinger.last.numbers.fluoro", 20)
    check(True, "phone: a tap switches fluoroscopy on and off")


def off_line(points):
    """Largest distance of points from the line through the first and the last."""
    def dot(p, q): return sum(x * y for x, y in zip(p, q))
    along = [b - a for a, b in zip(points[0], points[-1])]
    from_first = [[b - a for a, b in zip(points[0], p)] for p in points]
    return max(math.sqrt(max(0, dot(d, d) - dot(d, along) ** 2 / dot(along, along))) for d in from_first)


def narrow(browser, check, pictures):
    """330 points: the tip's bend in a corner that the tip is not in, and one unit of force."""
    browser.phone(330, 700, 2)
    browser.evaluate("scrollTo(0, 0)")
    browser.wait("!document.querySelector('.tip-frame').hidden && seldinger.viewer.narrow()", 60)
    some_frames(browser)
    check(browser.evaluate("document.documentElement.scrollWidth <= innerWidth"), "330 points: nothing to scroll sideways")
    left, top, right, bottom = box_of(browser, ".tip-frame")
    view = box_of(browser, "#view")
    x, y = browser.evaluate("(() => { const v = seldinger.viewer, p = v.tip.at.clone().project(v.camera); return [0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y] })()")
    x, y = view[0] + x * (view[2] - view[0]), view[1] + y * (view[3] - view[1])
    check(min(right - left, bottom - top) > 100 and not (left < x < right and top < y < bottom), "330 points: the tip again, larger, and not over itself")
    # a wire pulled back has few nodes: the camera still stands beside them
    for nodes in ([0.1, 0.2, 0.3, 0], [0.1, 0.2, 0.3, 0, 0.1, 0.2, 0.31, 0], [0.1, 0.2, 0.3, 0] * 2):
        at = browser.evaluate(f"""(() => {{
            const v = seldinger.viewer, nodes = new Float32Array({nodes});
            v.showTip(nodes, () => v.hot);
            v.tip.camera.updateMatrixWorld();
            return new THREE.Vector3(nodes[0], nodes[1], nodes[2]).project(v.tip.camera).toArray() }})()""")
        check(all(a is not None and abs(a) < 1 for a in at), f"330 points: a wire of {len(nodes) // 4} nodes is in the tip's frame ({at})")
    # a slow machine pulls it back a long way before the finger is seen to go
    x, y = middle_of(browser, "#pad")
    came = drag(browser, (x, y), (x, y - 45), f"seldinger.last.numbers.instruments[0].advance > {max(0.06, numbers(browser)['advance'] + 0.01)}")
    check(came, "330 points: pushed in again")
    # how far nodes leave the straight line between the ends of what is shown: in the frame, and in space with the frame about 1.24 lengths wide.
    # How much the tip is bent depends on where the wire has come to; that the bend is turned to the viewer does not
    points = browser.evaluate("""(() => {
        const v = seldinger.viewer, nodes = seldinger.last.nodes[0], all = [];
        let way = 0;
        for (let i = 0; i + 4 < nodes.length && way < v.tip.length; i += 4) {
          const at = new THREE.Vector3(nodes[i], nodes[i + 1], nodes[i + 2]).project(v.tip.camera);
          all.push([at.x, at.y, nodes[i], nodes[i + 1], nodes[i + 2]]);
          way += Math.hypot(nodes[i + 4] - nodes[i], nodes[i + 5] - nodes[i + 1], nodes[i + 6] - nodes[i + 2]);
        }
        return all })()""")
    seen, bend = off_line([p[:2] for p in points]) / 2, off_line([p[2:] for p in points]) / (1.24 * browser.evaluate("seldinger.viewer.tip.length"))
    check(seen > 0.8 * bend, f"330 points: the tip's bend is turned to the viewer ({seen:.2f} of the frame, of {bend:.2f})")
    units = browser.evaluate("[seldinger.forces.scaleOf(1e-3).unit, seldinger.forces.scaleOf(1).unit, document.querySelector('#instrument').textContent, "
                             "document.querySelector('#sheet').textContent]")
    check(units[:2] == ["N", "N"] and "mN" not in units[2] + units[3] and " N," in units[2], f"330 points: forces are in newtons everywhere ({units[2]})")
    browser.picture(os.path.join(pictures, "narrow.png"))


def phone(app, source, pictures, check):
    address = own_address()
    session = LiveSession(app, os.path.join(source, "assets/scenes/training/left-subclavian.toml"), "--bind", "0.0.0.0", "--token", TOKEN)
    browser = Browser()
    try:
        plain = f"http://{address}:{session.port}/"
        check(status_of(plain) in (401, 403), f"phone: {address} without the token is refused ({status_of(plain)})")
        browser.phone(390, 844, 3)
        browser.open(f"{plain}?token={TOKEN}")
        browser.wait("window.seldinger && seldinger.frames > 5 && seldinger.viewer", 60)
        time.sleep(1)
        check(browser.evaluate("devicePixelRatio") == 3 and browser.evaluate("innerWidth") == 390, "phone: 390 points of three pixels")
        check(browser.evaluate("document.documentElement.scrollWidth <= innerWidth"), "phone: nothing to scroll sideways")
        turn_and_pinch(browser, check)
        push_and_turn(browser, check)
        buttons(browser, check)
        for scheme in ("light", "dark"):
            browser.scheme(scheme)
            time.sleep(1)
            browser.picture(os.path.join(pictures, f"phone-{scheme}.png"))
        browser.evaluate("scrollTo(0, document.body.scrollHeight)")
        time.sleep(1)
        browser.picture(os.path.join(pictures, "phone-end.png"))
        narrow(browser, check, pictures)
        errors = browser.errors()
        check(not errors, f"phone: nothing in the console {errors or ''}")
        print(f"        phone: {browser.evaluate('seldinger.fps')} frames drawn in the last second")
    finally:
        browser.close()
        summary = session.end()
    check(summary["failure"] == "", "phone: the session ended well")

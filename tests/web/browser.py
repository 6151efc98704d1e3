"""A headless Chromium driven over its DevTools socket, and the WebSocket client that this takes: nothing beside Python's own library."""
import base64
import json
import os
import shutil
import socket
import struct
import subprocess
import tempfile
import time
import urllib.request


class WebSocket:
    """A client of RFC 6455, as far as tests go: text and binary, and whatever bytes a hostile client would send."""

    def __init__(self, host, port, path, headers=None, timeout=20):
        self.sock = socket.create_connection((host, port), timeout)
        lines = [f"GET {path} HTTP/1.1", f"Host: {host}:{port}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}", "Sec-WebSocket-Version: 13"]
        named = {name.lower(): value for name, value in (headers or {}).items()}
        if "host" in named:
            lines[1] = f"Host: {named.pop('host')}"
        lines += [f"{name}: {value}" for name, value in named.items()]
        self.sock.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.rest = b""
        head = b""
        while b"\r\n\r\n" not in head:
            got = self.sock.recv(4096)
            if not got:
                break
            head += got
        head, _, self.rest = head.partition(b"\r\n\r\n")
        self.status = int(head.split(b" ")[1]) if b" " in head else 0

    def send(self, text, opcode=1):
        data = text.encode() if isinstance(text, str) else text
        mask = os.urandom(4)
        size = struct.pack("!B", 0x80 | len(data)) if len(data) < 126 else struct.pack("!BH", 0xFE, len(data)) \
            if len(data) < 65536 else struct.pack("!BQ", 0xFF, len(data))
        self.sock.sendall(bytes([0x80 | opcode]) + size + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    def raw(self, data):
        self.sock.sendall(data)

    def exactly(self, count):
        while len(self.rest) < count:
            got = self.sock.recv(1 << 16)
            if not got:
                raise ConnectionError("closed")
            self.rest += got
        data, self.rest = self.rest[:count], self.rest[count:]
        return data

    def receive(self):
        """The next message as (opcode, bytes); pings are answered."""
        whole, first = b"", 0
        while True:
            a, b = self.exactly(2)
            size = b & 127
            if size == 126:
                size, = struct.unpack("!H", self.exactly(2))
            elif size == 127:
                size, = struct.unpack("!Q", self.exactly(8))
            data = self.exactly(size)
            if a & 15 == 9:
                self.send(data, 10)
                continue
            first = first or a & 15
            whole += data
            if a & 0x80:
                return first, whole

    def close(self):
        self.sock.close()


class Browser:
    """One tab. @param more  arguments of the browser   @raises FileNotFoundError without a Chromium"""

    def __init__(self, width=1280, height=720, dark=False, more=()):
        program = next((p for p in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if p), None)
        if not program:
            raise FileNotFoundError("no chromium")
        self.folder = tempfile.mkdtemp(prefix="seldinger-web-")
        # as a Chromium without a graphics card does of itself: SwiftShader draws WebGL, the page is put together in memory. With plain
        # "swiftshader" the whole page goes through it, at 1/5 of the frames.
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-gl=angle", "--use-angle=swiftshader-webgl",
                     "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-first-run", "--remote-debugging-port=0",
                     f"--user-data-dir={self.folder}", f"--window-size={width},{height}", "--hide-scrollbars", *more, "about:blank"]
        self.process = subprocess.Popen([program] + arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.port = self._port()
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/json/list") as answer:
            page = next(target for target in json.load(answer) if target["type"] == "page")
        self.socket = WebSocket("127.0.0.1", self.port, "/" + page["webSocketDebuggerUrl"].split("/", 3)[3], timeout=120)
        self.number, self.events = 0, []
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.size(width, height)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def _port(self):
        path = os.path.join(self.folder, "DevToolsActivePort")
        for _ in range(600):
            if os.path.exists(path) and open(path).read().strip():
                return int(open(path).read().split()[0])
            time.sleep(0.1)
        raise TimeoutError("chromium did not start")

    def call(self, method, **params):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            message = json.loads(self.socket.receive()[1])
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.events.append(message)

    def size(self, width, height, mobile=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)

    def phone(self, width, height, scale):
        """From now on a phone: `scale` pixels to a point, and fingers (see touch)."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=True)
        self.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)

    def touch(self, kind, points):
        """@param kind  touchStart, touchMove, touchEnd   @param points  of the fingers that are down, (x, y)"""
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(points)])

    def scheme(self, name):
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def open(self, url):
        self.call("Page.navigate", url=url)

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"].get("exception", {}).get("description", str(result)))
        return result["result"].get("value")

    def wait(self, expression, seconds=30):
        end = time.time() + seconds
        while time.time() < end:
            if self.evaluate(f"Boolean({expression})"):
                return
            time.sleep(0.1)
        raise TimeoutError(expression)

    def key(self, name, code, down, text=None):
        event = {"key": name, "code": code, "windowsVirtualKeyCode": {"ArrowUp": 38, "ArrowDown": 40, "Tab": 9, " ": 32}.get(name, ord(name[0].upper()))}
        if down and text:
            event["text"] = text
        self.call("Input.dispatchKeyEvent", type="keyDown" if down else "keyUp", **event)

    def picture(self, path):
        data = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        with open(path, "wb") as out:
            out.write(data)
        return data

    def errors(self):
        """What the console and the network complained of."""
        self.evaluate("1")
        found = []
        for event in self.events:
            params = event.get("params", {})
            if event["method"] == "Runtime.exceptionThrown":
                found.append(params["exceptionDetails"].get("exception", {}).get("description", "exception"))
            elif event["method"] == "Runtime.consoleAPICalled" and params["type"] in ("error", "assert"):
                found.append(str(params["args"]))
            elif event["method"] == "Log.entryAdded" and params["entry"]["level"] == "error":
                found.append(params["entry"]["text"] + " " + params["entry"].get("url", ""))
        return found

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

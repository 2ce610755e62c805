"""A real Chromium without a window, driven through its DevTools protocol.

    with Browser(folder) as browser:
        page = browser.page(1280, 900)
        page.open("http://127.0.0.1:8017/")
        page.run("document.title")
"""
import base64
import collections
import json
import pathlib
import shutil
import subprocess
import time
import urllib.request

import websocket

TIMEOUT_S = 60


class Browser:
    def __init__(self, folder):
        program = shutil.which("chromium")
        assert program, "chromium is missing (ops/packages.txt)"
        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             "--disable-background-networking", "--disable-component-update", "--disable-extensions", "--disable-sync", "--mute-audio",
             "--hide-scrollbars", "--force-color-profile=srgb", "--remote-debugging-port=0", "--remote-allow-origins=*",
             f"--user-data-dir={folder}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        port_file = pathlib.Path(folder) / "DevToolsActivePort"
        begin = time.monotonic()
        while not (port_file.exists() and port_file.read_text().count("\n")):
            assert self.process.poll() is None, "chromium ended"
            assert time.monotonic() - begin < TIMEOUT_S, "chromium does not start"
            time.sleep(0.05)
        self.port = int(port_file.read_text().splitlines()[0])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()

    def page(self, width, height, dark=False, touch=False):
        ask = urllib.request.Request(f"http://127.0.0.1:{self.port}/json/new?about:blank", method="PUT")
        with urllib.request.urlopen(ask, timeout=TIMEOUT_S) as reply:
            address = json.load(reply)["webSocketDebuggerUrl"]
        return Page(address, width, height, dark, touch)


class Page:
    def __init__(self, address, width, height, dark, touch):
        self.socket = websocket.create_connection(address, timeout=TIMEOUT_S)
        self.calls, self.width = 0, width
        self.requests, self.errors, self.events = [], [], collections.Counter()
        for domain in ("Page", "Runtime", "Log", "Network", "Accessibility"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=touch)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        if touch:
            self.call("Emulation.setTouchEmulationEnabled", enabled=True)

    def close(self):
        self.call("Page.close")
        self.socket.close()

    def call(self, method, **parameters):
        self.calls += 1
        number = self.calls
        self.socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self.socket.recv())
            if message.get("id") == number:
                assert "error" not in message, f"{method}: {message['error']}"
                return message["result"]
            self.note(message)

    def note(self, event):
        kind, what = event.get("method"), event.get("params", {})
        self.events[kind] += 1
        if kind == "Network.requestWillBeSent":
            self.requests.append(what["request"]["url"])
        elif kind == "Runtime.exceptionThrown":
            self.errors.append(what["exceptionDetails"].get("exception", {}).get("description") or what["exceptionDetails"]["text"])
        elif kind == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            self.errors.append(what["entry"]["text"] + " " + what["entry"].get("url", ""))
        elif kind == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning", "assert"):
            self.errors.append(str(what["args"]))

    def run(self, expression):
        """The value of an expression of JavaScript; promises are waited for."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True, userGesture=True)
        assert "exceptionDetails" not in result, f"{expression}: {result['exceptionDetails']}"
        return result["result"].get("value")

    def run_unless_leaving(self, expression):
        """The same, or None while another page takes the place of this one."""
        try:
            return self.run(expression)
        except AssertionError as error:
            if "navigated or closed" in str(error) or "Not attached" in str(error):
                return None
            raise

    def wait(self, expression, what=None):
        begin = time.monotonic()
        while not self.run_unless_leaving(expression):
            assert time.monotonic() - begin < TIMEOUT_S, f"in vain waited for {what or expression}; errors {self.errors}"
            time.sleep(0.02)

    def open(self, url):
        self.call("Page.bringToFront")  # a page behind others is not painted
        loaded = self.events["Page.loadEventFired"]
        self.call("Page.navigate", url=url)
        begin = time.monotonic()
        while self.events["Page.loadEventFired"] == loaded:
            assert time.monotonic() - begin < TIMEOUT_S, f"{url} does not load"
            self.note(json.loads(self.socket.recv()))
        self.settle()

    def settle(self):
        """Until everything that was asked for is shown."""
        time.sleep(0.05)
        self.wait("document.readyState === 'complete' && document.title !== '' && !document.body.hasAttribute('aria-busy') && "
                  "(document.querySelector('main').hidden ? !document.getElementById('trouble').hidden : true)", "the page to settle")
        self.run("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")  # drawn, too

    def text(self, selector):
        return self.run(f"document.querySelector({json.dumps(selector)})?.innerText ?? null")

    def box(self, selector):
        self.run(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{block: 'center'}})")
        return self.run(f"(({{x, y, width, height}}) => ({{x, y, width, height}}))(document.querySelector({json.dumps(selector)}).getBoundingClientRect())")

    def choose(self, selector, value):
        """A choice in a form, as a hand makes it."""
        self.run(f"(e => {{ e.value = {json.dumps(value)}; e.dispatchEvent(new Event('input', {{bubbles: true}})); "
                 f"e.dispatchEvent(new Event('change', {{bubbles: true}})); }})(document.querySelector({json.dumps(selector)}))")
        self.settle()

    def mouse(self, kind, x, y):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="none" if kind == "mouseMoved" else "left",
                  clickCount=0 if kind == "mouseMoved" else 1)

    def click(self, x, y):
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.mouse(kind, x, y)
        self.settle()

    def tap(self, x, y):
        self.call("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.settle()

    def key(self, key, code=None, shift=False):
        codes = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Tab": 9, "Enter": 13}
        for kind in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=code or key, windowsVirtualKeyCode=codes.get(key, 0),
                      modifiers=8 if shift else 0)
        self.settle()

    def unnamed_controls(self):
        """Roles of what a hand or a reader meets without being told what it is."""
        roles = {"button", "combobox", "slider", "spinbutton", "checkbox", "image", "link", "application", "region", "progressbar", "table"}
        out = []
        for node in self.call("Accessibility.getFullAXTree")["nodes"]:
            role = node.get("role", {}).get("value")
            if not node.get("ignored") and role in roles and not node.get("name", {}).get("value"):
                out.append(role)
        return out

    def screenshot(self, path, clip=None):
        """Of the whole page; clip: (width, height, scale) of its beginning, or a dict of x, y, width and height."""
        if isinstance(clip, tuple):
            clip = dict(zip(("width", "height", "scale"), clip))
        part = {} if clip is None else {"clip": {"x": 0, "y": 0, "scale": 1, **clip}}
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, **part)
        pathlib.Path(path).write_bytes(base64.b64decode(shot["data"]))

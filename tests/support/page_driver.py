"""A page in headless Chromium that is used as a reader uses it: pointer, wheel, keys, downloads."""

import base64
import contextlib
import json
import tempfile
import time
from pathlib import Path

from chromium import Browser

KEYS = {"Enter": 13, "Escape": 27, "Tab": 9, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40}
SHIFT = 8


class Page:
    """`with Page(path) as page:`; errors of the page's scripts are in `errors`, whatever it loads in `requests`. `first` is a script
    that runs before those of the page."""

    def __init__(self, path, width=1200, height=1000, dark=False, timeout=60, first=""):
        self.path, self.size, self.dark, self.timeout, self.first = Path(path).resolve(), (width, height), dark, timeout, first
        self.errors, self.requests, self._events = [], [], []

    def __enter__(self):
        """In a context of its own: no page sees what another one kept."""
        self._keeper = tempfile.TemporaryDirectory(prefix="rodwake-page-", ignore_cleanup_errors=True)
        self.downloads = Path(self._keeper.name)
        self.browser = Browser.shared()
        try:
            self._context = self.browser.send("Target.createBrowserContext")["browserContextId"]
            self._open()
        except BaseException:  # whatever hangs: the next page has another browser
            self.browser.close()
            self._keeper.cleanup()
            raise
        return self

    def __exit__(self, *_):
        self.browser.pages.pop(self._session, None)
        with contextlib.suppress(AssertionError):
            self.browser.send("Target.disposeBrowserContext", browserContextId=self._context, timeout=10)
        self._keeper.cleanup()

    def _open(self):
        self.browser.send("Browser.setDownloadBehavior", behavior="allow", browserContextId=self._context, downloadPath=str(self.downloads))
        target = self.browser.send("Target.createTarget", url="about:blank", browserContextId=self._context)["targetId"]
        self._session = self.browser.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.browser.pages[self._session] = self
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.send(f"{domain}.enable")
        self.send("Emulation.setDeviceMetricsOverride", width=self.size[0], height=self.size[1], deviceScaleFactor=1, mobile=False)
        self.send("Emulation.setFocusEmulationEnabled", enabled=True)
        self.send("Page.addScriptToEvaluateOnNewDocument", source=self.first)
        self.set_dark(self.dark)
        self.go(self.path)

    def go(self, path, address=""):
        """To another file; `address`: what follows its name, such as ?a=b#c."""
        self._events.clear()
        self.send("Page.navigate", url=Path(path).resolve().as_uri() + address)
        self.wait_for(lambda: any(event["method"] == "Page.loadEventFired" for event in self._events), "the page did not load")

    def send(self, method, **parameters):
        """Its answer; what else the browser tells is sorted into the lists."""
        return self.browser.send(method, self._session, self.timeout, **parameters)

    def note(self, event):
        method, params = event["method"], event.get("params", {})
        self._events.append(event)
        if method == "Runtime.exceptionThrown":
            self.errors.append(params["exceptionDetails"].get("exception", {}).get("description") or params["exceptionDetails"]["text"])
        elif method == "Runtime.consoleAPICalled" and params["type"] == "error":
            self.errors.append(" ".join(str(one.get("value", one.get("description"))) for one in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.errors.append(params["entry"]["text"])
        elif method == "Network.requestWillBeSent" and not params["request"]["url"].startswith(("data:", "blob:")):
            self.requests.append(params["request"]["url"])

    def wait_for(self, is_true, what, seconds=None):
        end = time.monotonic() + (seconds or self.timeout)
        while time.monotonic() < end:
            if is_true():
                return
            self.evaluate("0")  # takes up the events of the meantime
            time.sleep(0.01)
        raise AssertionError(what)

    def evaluate(self, expression):
        """The value of an expression of JavaScript, a promise awaited."""
        found = self.send("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise AssertionError(found["exceptionDetails"].get("exception", {}).get("description") or found["exceptionDetails"]["text"])
        return found["result"].get("value")

    def text(self, selector):
        return self.evaluate(f"document.querySelector({json.dumps(selector)})?.innerText ?? null")

    def set_dark(self, dark):
        self.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    # What a reader does. Places are CSS pixels of the window.

    def pointer(self, kind, x, y, shift=False, **more):
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, modifiers=SHIFT if shift else 0, **more)

    def move(self, x, y):
        self.pointer("mouseMoved", x, y)

    def click(self, x, y):
        self.move(x, y)
        self.drag((x, y))

    def drag(self, *places, shift=False):
        """Pressed at the first, moved over the others, released at the last."""
        self.pointer("mousePressed", *places[0], shift=shift, button="left", buttons=1, clickCount=1)
        for place in places[1:]:
            self.pointer("mouseMoved", *place, shift=shift, button="left", buttons=1)
        self.pointer("mouseReleased", *places[-1], shift=shift, button="left", buttons=0, clickCount=1)

    def wheel(self, x, y, turned):
        self.pointer("mouseWheel", x, y, deltaX=0, deltaY=turned)

    def key(self, name, shift=False):
        """A named key, or a sign."""
        code = KEYS.get(name, ord(name[0].upper()))
        event = {"key": name, "windowsVirtualKeyCode": code, "modifiers": SHIFT if shift else 0}
        text = {} if name in KEYS and name != "Enter" else {"text": "\r" if name == "Enter" else name}
        self.send("Input.dispatchKeyEvent", type="keyDown", **event, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", **event)

    def press(self, selector):
        """Clicks the middle of an element, which must be in view, enabled and not under another."""
        found = self.evaluate(f"""(() => {{
            const one = document.querySelector({json.dumps(selector)});
            if (!one) return "no such element";
            if (one.disabled) return "disabled";
            one.scrollIntoView({{ block: "center" }});
            const box = one.getBoundingClientRect(), at = [box.left + box.width / 2, box.top + box.height / 2];
            const top = document.elementFromPoint(...at);
            return top && (one === top || one.contains(top)) ? at : "not to be seen";
        }})()""")
        if isinstance(found, str):
            raise AssertionError(f"{selector}: {found}")
        self.click(*found)

    def choose(self, selector, value):
        """Of a list of choices."""
        found = self.evaluate(f"""(() => {{
            const one = document.querySelector({json.dumps(selector)});
            if (![...one.options].some(option => option.value === {json.dumps(value)})) return null;
            one.value = {json.dumps(value)};
            one.dispatchEvent(new Event("change", {{ bubbles: true }}));
            return one.value;
        }})()""")
        if found != value:
            raise AssertionError(f"{selector}: has no choice {value}")

    def arrived(self, name, seconds=20):
        """The file of this name, once all of it is there: an empty one holds its place at first."""
        path = self.downloads / name
        self.wait_for(lambda: path.is_file() and path.stat().st_size > 0 and not list(self.downloads.glob("*.crdownload")),
                      f"{name} was not downloaded", seconds)
        return path

    def downloaded(self, name, seconds=20):
        """Its text."""
        return self.arrived(name, seconds).read_text(encoding="utf-8")

    def picture(self, path):
        Path(path).write_bytes(base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"]))

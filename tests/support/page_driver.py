"""A page in headless Chromium that is used as a reader uses it: pointer, wheel, keys, downloads.

Speaks the DevTools protocol over two pipes: messages are JSON, each ended by a zero byte.
"""

import base64
import json
import os
import select
import subprocess
import tempfile
import time
from pathlib import Path

import browser

KEYS = {"Enter": 13, "Escape": 27, "Tab": 9, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40}
SHIFT = 8


class Page:
    """`with Page(path) as page:`; errors of the page's scripts are in `errors`, whatever it loads in `requests`."""

    def __init__(self, path, width=1200, height=1000, dark=False, timeout=60):
        self.path, self.size, self.dark, self.timeout = Path(path).resolve(), (width, height), dark, timeout
        self.errors, self.requests, self._number, self._buffer, self._events = [], [], 0, b"", []

    def __enter__(self):
        self._keeper = tempfile.TemporaryDirectory(prefix="rodwake-page-", ignore_cleanup_errors=True)
        self.folder = Path(self._keeper.name)
        self.downloads, self._complaints = self.folder / "downloads", self.folder / "complaints"
        self.downloads.mkdir()
        self._start()
        try:
            self._open()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        os.close(self._out)
        self._process.kill()
        self._process.wait()
        os.close(self._in)
        self._keeper.cleanup()

    def _start(self):
        """The browser reads commands at 3 and answers at 4. By bash: other shells take descriptors of one digit only."""
        theirs_in, self._out = os.pipe()
        self._in, theirs_out = os.pipe()
        command = browser.command(self.folder, *self.size)
        shell = ["bash", "-c", f'exec "$@" 3<&{theirs_in} 4>&{theirs_out}', "bash"]
        with self._complaints.open("wb") as complaints:
            self._process = subprocess.Popen([*shell, *command, "--remote-debugging-pipe", "about:blank"], stdout=subprocess.DEVNULL,
                                             stderr=complaints, pass_fds=(theirs_in, theirs_out))
        os.close(theirs_in)
        os.close(theirs_out)

    def _open(self):
        self._session = None
        self.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(self.downloads), eventsEnabled=True)
        target = next(one for one in self.send("Target.getTargets")["targetInfos"] if one["type"] == "page")
        self._session = self.send("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.send(f"{domain}.enable")
        self.send("Emulation.setDeviceMetricsOverride", width=self.size[0], height=self.size[1], deviceScaleFactor=1, mobile=False)
        self.set_dark(self.dark)
        self.send("Page.navigate", url=self.path.as_uri())
        self.wait_for(lambda: any(event["method"] == "Page.loadEventFired" for event in self._events), "the page did not load")

    def send(self, method, **parameters):
        """Its answer; what else the browser tells is sorted into the lists."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters} | ({"sessionId": self._session} if self._session else {})
        try:
            os.write(self._out, json.dumps(message).encode() + b"\0")
        except BrokenPipeError:
            self._has_ended()
        end = time.monotonic() + self.timeout
        while time.monotonic() < end:
            for answer in self._messages(end):
                if answer.get("id") == self._number:
                    if "error" in answer:
                        raise AssertionError(f"{method}: {answer['error'].get('message')}")
                    return answer["result"]
        raise AssertionError(f"{method}: the browser did not answer")

    def _has_ended(self):
        said = self._complaints.read_text(errors="replace")[-1500:]
        raise AssertionError(f"the browser has ended (exit code {self._process.wait()}): {said}")

    def _messages(self, end):
        """What has come since; events are noted."""
        ready, _, _ = select.select([self._in], [], [], max(0.0, end - time.monotonic()))
        if not ready:
            return []
        found = os.read(self._in, 1 << 20)
        if not found:
            self._has_ended()
        *whole, self._buffer = (self._buffer + found).split(b"\0")
        messages = [json.loads(text) for text in whole]
        for message in messages:
            if "id" not in message:
                self._note(message)
        return messages

    def _note(self, event):
        method, told = event["method"], event.get("params", {})
        self._events.append(event)
        if method == "Runtime.exceptionThrown":
            self.errors.append(told["exceptionDetails"].get("exception", {}).get("description") or told["exceptionDetails"]["text"])
        elif method == "Runtime.consoleAPICalled" and told["type"] == "error":
            self.errors.append(" ".join(str(one.get("value", one.get("description"))) for one in told["args"]))
        elif method == "Log.entryAdded" and told["entry"]["level"] == "error":
            self.errors.append(told["entry"]["text"])
        elif method == "Network.requestWillBeSent" and not told["request"]["url"].startswith(("data:", "blob:")):
            self.requests.append(told["request"]["url"])

    def wait_for(self, is_true, what, seconds=None):
        end = time.monotonic() + (seconds or self.timeout)
        while time.monotonic() < end:
            if is_true():
                return
            self.evaluate("0")  # takes up what has been told meanwhile
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
        told = {"key": name, "windowsVirtualKeyCode": code, "modifiers": SHIFT if shift else 0}
        text = {} if name in KEYS and name != "Enter" else {"text": "\r" if name == "Enter" else name}
        self.send("Input.dispatchKeyEvent", type="keyDown", **told, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", **told)

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

    def downloaded(self, name, seconds=20):
        """The text of the file of this name, once it is there."""
        path = self.downloads / name
        self.wait_for(lambda: path.is_file() and not list(self.downloads.glob("*.crdownload")), f"{name} was not downloaded", seconds)
        return path.read_text(encoding="utf-8")

    def picture(self, path):
        Path(path).write_bytes(base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"]))

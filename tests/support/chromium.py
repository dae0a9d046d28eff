"""One headless Chromium for all pages that a test program opens: it takes a second to start, a page in it a tenth.

Speaks the DevTools protocol over two pipes: messages are JSON, each ended by a zero byte.
"""

import atexit
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path


def command(folder, width, height):
    """No sandbox: it needs privileges that a container does not have; the page is our own. No name resolves: nothing is fetched."""
    program = shutil.which("chromium")
    if program is None:
        raise AssertionError("chromium is not installed: tools/packages.txt names what the tests need")
    return [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
            "--disable-extensions", "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
            "--disable-features=WebUIOmniboxPopup,WebUIOmniboxFullPopup,WebUIOmniboxAimPopup",  # 300 files of its own for each window
            "--disable-renderer-backgrounding", "--disable-backgrounding-occluded-windows", "--disable-background-timer-throttling",
            "--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={folder}/profile", f"--window-size={width},{height}"]


class Browser:
    """Commands to the browser, or to a page in it by its session; what a page tells goes to `pages[session].note`."""
    _shared = None

    @classmethod
    def shared(cls):
        if cls._shared is None or not cls._shared.runs:
            cls._shared = cls()
            atexit.register(cls._shared.close)
        return cls._shared

    def __init__(self):
        self.pages, self._number, self._buffer, self.runs = {}, 0, b"", True
        self._keeper = tempfile.TemporaryDirectory(prefix="rodwake-browser-", ignore_cleanup_errors=True)
        self.folder = Path(self._keeper.name)
        self._complaints = self.folder / "complaints"
        self._start()

    def _start(self):
        """The browser reads commands at 3 and answers at 4. By bash: other shells take descriptors of one digit only."""
        theirs_in, self._out = os.pipe()
        self._in, theirs_out = os.pipe()
        shell = ["bash", "-c", f'exec "$@" 3<&{theirs_in} 4>&{theirs_out}', "bash"]
        with self._complaints.open("wb") as complaints:
            self.process = subprocess.Popen([*shell, *command(self.folder, 1200, 1000), "--remote-debugging-pipe", "about:blank"],
                                            stdout=subprocess.DEVNULL, stderr=complaints, pass_fds=(theirs_in, theirs_out))
        os.close(theirs_in)
        os.close(theirs_out)

    def close(self):
        if not self.runs:
            return
        self.runs = False
        os.close(self._out)
        self.process.kill()
        self.process.wait()
        os.close(self._in)
        self._keeper.cleanup()

    def send(self, method, session=None, timeout=60, **parameters):
        """Its answer."""
        if not self.runs:
            self._has_ended()
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters} | ({"sessionId": session} if session else {})
        self._write(json.dumps(message).encode() + b"\0")
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            for answer in self._messages(end):
                if answer.get("id") == self._number:
                    if "error" in answer:
                        raise AssertionError(f"{method}: {answer['error'].get('message')}")
                    return answer["result"]
        raise AssertionError(f"{method}: the browser did not answer")

    def _write(self, data):
        try:
            while data:
                data = data[os.write(self._out, data):]
        except OSError:  # it reads no more, or was closed
            self._has_ended()

    def _has_ended(self):
        said = self._complaints.read_text(errors="replace")[-1500:] if self.runs else ""
        self.close()
        raise AssertionError(f"the browser has ended (exit code {self.process.returncode}): {said}")

    def _messages(self, end):
        """What has come since."""
        ready, _, _ = select.select([self._in], [], [], max(0.0, end - time.monotonic()))
        if not ready:
            return []
        found = os.read(self._in, 1 << 20)
        if not found:
            self._has_ended()
        *whole, self._buffer = (self._buffer + found).split(b"\0")
        messages = [json.loads(text) for text in whole]
        for message in messages:
            if "id" not in message and message.get("sessionId") in self.pages:
                self.pages[message["sessionId"]].note(message)
        return messages

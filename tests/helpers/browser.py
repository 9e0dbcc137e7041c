"""Headless Chromium for tests of pages, driven over two pipes by the DevTools protocol; nothing beside it is needed.

``apt-get install chromium`` installs it; without it these tests are skipped.
"""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
PATIENCE = 120.0  # [s] for one answer: not a measure of anything, only an end of waiting for a browser that hangs


def chromium() -> str | None:
    """Path of a Chromium, or ``None``."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


def opened(page: Path) -> Iterator[Browser]:
    """A browser with a page, on which nothing may fail; the test is skipped where there is no Chromium."""
    if chromium() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    with Browser() as browser:
        browser.open(page)
        yield browser
        assert browser.errors == []


class Browser:
    """A page of Chromium: what it logs, what it asks the network for, what it shows.

    Attributes
    ----------
    errors
        Errors and warnings of the console, and exceptions.
    requests
        Addresses asked for.
    """

    _session: str | None = None

    def __init__(self, width: int = 1300, height: int = 900) -> None:
        self.errors: list[str] = []
        self.requests: list[str] = []
        self._number, self._rest, self._answers = 0, b"", dict[int, Any]()
        self._size = (width, height)

    def __enter__(self) -> Self:
        program = chromium()
        assert program is not None
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self._write = os.pipe()
        self._read, from_browser = os.pipe()
        # The browser reads from descriptor 3 and writes to 4; the two moves must not run over each other.
        start = f'exec 3<&{to_browser} 4>&{from_browser}; exec "$0" "$@"'
        options = ["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--hide-scrollbars", "--disable-gpu"]
        options += ["--enable-unsafe-swiftshader", "--force-device-scale-factor=1", "--no-first-run"]
        options += [f"--user-data-dir={self._folder.name}", "--window-size={},{}".format(*self._size)]
        self._process = subprocess.Popen(
            ["bash", "-c", start, program, *options, "about:blank"],
            pass_fds=(to_browser, from_browser), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(to_browser)
        os.close(from_browser)
        pages = [t for t in self.send("Target.getTargets")["targetInfos"] if t["type"] == "page"]
        attached = self.send("Target.attachToTarget", targetId=pages[0]["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Runtime", "Log", "Network", "Page"):
            self.send(f"{domain}.enable")
        self.resize(*self._size)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.terminate()
        self._process.wait(PATIENCE)
        os.close(self._write)
        os.close(self._read)
        self._folder.cleanup()

    def send(self, method: str, **parameters: Any) -> Any:
        """Answer to a command."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._write, data) :]
        while self._number not in self._answers:
            self._receive()
        answer = self._answers.pop(self._number)
        assert "error" not in answer, answer
        return answer["result"]

    def _receive(self) -> None:
        if not select.select([self._read], [], [], PATIENCE)[0]:
            raise TimeoutError("the browser does not answer")
        found = os.read(self._read, 1 << 20)
        if not found:
            raise RuntimeError("the browser has ended")
        *messages, self._rest = (self._rest + found).split(b"\0")
        for text in messages:
            message = json.loads(text)
            if "id" in message:
                self._answers[message["id"]] = message
            else:
                self._note(message["method"], message["params"])

    def _note(self, method: str, told: Any) -> None:
        if method == "Runtime.exceptionThrown":
            details = told["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
            self.errors.append(str(told["args"]))
        elif method == "Log.entryAdded" and told["entry"]["level"] == "error":
            self.errors.append(told["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(told["request"]["url"])

    def resize(self, width: int, height: int) -> None:
        """Size of the window [px]."""
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def open(self, path: Path, fragment: str = "") -> None:
        """Load a file, and wait until the page says that it is ready or has failed."""
        self.send("Page.navigate", url=path.as_uri() + (f"#{fragment}" if fragment else ""))
        self.run(
            "new Promise(done => { const look = () => document.body && document.readyState === 'complete' ? "
            "done(1) : setTimeout(look, 20); look(); })"
        )

    def run(self, script: str) -> Any:
        """Value of a script, waited for if it is a promise."""
        found = self.send("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def move(self, x: float, y: float) -> None:
        """Put the pointer to a place of the window [px]."""
        self.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Drag with the left button from one place to another [px]."""
        for kind, (x, y) in (("mousePressed", start), ("mouseMoved", end), ("mouseReleased", end)):
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)

    def place(self, selector: str) -> tuple[float, float, float, float]:
        """Left, top, width and height [px] of an element, scrolled into the window."""
        found = self.run(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)}); "
            "e.scrollIntoView({block: 'center'});"
            " const r = e.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()"
        )
        left, top, width, height = found
        return left, top, width, height

    def picture(self, selector: str | None = None) -> bytes:
        """PNG of an element, or of the whole page."""
        if selector is None:
            sizes = self.send("Page.getLayoutMetrics")["cssContentSize"]
            box = {"x": 0, "y": 0, "width": sizes["width"], "height": sizes["height"], "scale": 1}
            found = self.send("Page.captureScreenshot", clip=box, captureBeyondViewport=True)
        else:
            left, top, width, height = self.place(selector)
            scrolled = self.run("[scrollX, scrollY]")
            box = {"x": left + scrolled[0], "y": top + scrolled[1], "width": width, "height": height, "scale": 1}
            found = self.send("Page.captureScreenshot", clip=box)
        return base64.b64decode(found["data"])

    def pdf(self) -> bytes:
        """The page as it is printed."""
        return base64.b64decode(self.send("Page.printToPDF", preferCSSPageSize=True, printBackground=True)["data"])

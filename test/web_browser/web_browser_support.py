"""A real browser, and servers for it in threads: of a machine that is made up, and of an offline machine."""

from __future__ import annotations

import asyncio
import os
import shutil
import threading
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from aiohttp import web

HERE = Path(__file__).parent
CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"]
DESKTOP = {"width": 1440, "height": 900}
PHONE = {"width": 390, "height": 844}
TABLET = {"width": 1024, "height": 768}
PATIENCE = 20_000
"""ms; the computers of tests are busy."""


def why_no_browser() -> str:
    """Empty where there is one."""
    try:
        import playwright.sync_api  # noqa: F401
    except ImportError:
        return "playwright is not installed: pip install playwright"
    return "" if CHROMIUM else "there is no chromium: apt-get install chromium, or its path in CHROMIUM"


@contextmanager
def chromium() -> Iterator[Any]:
    """A headless browser. While it is there, no other event loop can run in this thread."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


class InThread:
    """An application that is served by a thread of its own."""

    def __init__(self, app: web.Application) -> None:
        self._app = app
        self._loop = asyncio.new_event_loop()
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_until_complete(self._begin())
        self._ready.set()
        self._loop.run_forever()
        self._loop.run_until_complete(self._runner.cleanup())
        left = asyncio.all_tasks(self._loop)
        for task in left:
            task.cancel()
        self._loop.run_until_complete(asyncio.gather(*left, return_exceptions=True))
        self._loop.close()

    async def _begin(self) -> None:
        self._runner = web.AppRunner(self._app, access_log=None, shutdown_timeout=0.2)
        await self._runner.setup()
        site = web.TCPSite(self._runner, "127.0.0.1", 0)
        await site.start()
        self.url = f"http://127.0.0.1:{self._runner.addresses[0][1]}/"

    def __enter__(self) -> InThread:
        self._thread.start()
        assert self._ready.wait(30.0)
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(10.0)

    def begin(self, coroutine: Coroutine[Any, Any, Any]) -> Any:
        """In the thread of the server; what it gives is in `result()`."""
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop)

    def do(self, coroutine: Coroutine[Any, Any, Any]) -> Any:
        """In the thread of the server."""
        return self.begin(coroutine).result(10.0)


class Complaints:
    """What a page has complained of: errors of scripts, and of the console (the security policy too)."""

    def __init__(self, page: Any) -> None:
        self.texts: list[str] = []
        page.on("pageerror", lambda error: self.texts.append(str(error)))
        page.on("console", self._hear)

    def _hear(self, message: Any) -> None:
        """That no program is loaded yet, the browser logs, and the page says."""
        has_no_program = "404" in message.text and "/api/backplot" in message.location["url"]
        if message.type == "error" and not has_no_program:
            self.texts.append(message.text)


def until(page: Any, expression: str) -> Any:
    """Waits until an expression of a page is true; the page's policy forbids the eval of `wait_for_function`."""
    for _ in range(PATIENCE // 50):
        if value := page.evaluate(f"() => ({expression})"):
            return value
        page.wait_for_timeout(50)
    raise AssertionError(f"not true in {PATIENCE} ms: {expression}")


def eventually(page: Any, condition: Callable[[], Any]) -> None:
    """Waits until a condition of the server is true; the page goes on meanwhile."""
    for _ in range(PATIENCE // 20):
        if condition():
            return
        page.wait_for_timeout(20)
    raise AssertionError(f"it did not happen in {PATIENCE} ms")


def open_page(
    browser: Any,
    url: str,
    *,
    size: dict[str, int] | None = None,
    scheme: str = "light",
    command: bool = False,
    touch: bool = False,
) -> Any:
    """A page that is connected and shows its elements, whose modules come later.

    `command`: it holds the command; `touch`: its screen is touched.
    """
    page = browser.new_page(viewport=size or DESKTOP, color_scheme=scheme, has_touch=touch)
    page.set_default_timeout(PATIENCE)
    page.complaints = Complaints(page)
    page.goto(url)
    until(page, "window.app && app.store.link === 'open' && app.store.machine !== null && app._mounted")
    if command:
        page.click("text=Take command")
        until(page, "app.store.holds")
    return page

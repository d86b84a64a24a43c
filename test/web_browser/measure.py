"""Figures of docs/web.md: size of the pages, first view, backplot of 150,000 segments. `python test/web_browser/measure.py`

Frames a second depend on what else the computer does; so the processor time of a picture is measured too: all
processes of the browser, and what that makes on two idle cores.
"""

from __future__ import annotations

import gzip
import os
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE)]

from fake_machine import STATIC, Fake  # noqa: E402
from web_browser_support import InThread, chromium, open_page  # noqa: E402

SEGMENTS = 150_001
TURN = """async () => {
    const { scene } = document.querySelector(".backplot");
    const [before, begin] = [scene.frames, performance.now()];
    return await new Promise((done) => {
        const step = () => {
            scene.rotate(1);
            if (performance.now() - begin < 4000) requestAnimationFrame(step);
            else done([(scene.frames - before), performance.now() - begin, scene._pace.step]);
        };
        requestAnimationFrame(step);
    });
}"""


def size_of_pages() -> tuple[int, int]:
    """Bytes of all that is served to a page: as it is, and compressed."""
    files = [
        file
        for file in STATIC.rglob("*")
        if file.suffix in (".js", ".css", ".html", ".svg") and file.name != "three_entry.js"
    ]
    return sum(file.stat().st_size for file in files), sum(len(gzip.compress(file.read_bytes(), 9)) for file in files)


def processor_time(parent: int) -> float:
    """Seconds of all processes below one."""
    children: dict[int, list[tuple[int, float]]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        children.setdefault(int(fields[1]), []).append(
            (int(stat.parent.name), (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"))
        )
    found, waiting = 0.0, [parent]
    while waiting:
        for number, time in children.get(waiting.pop(), []):
            found += time
            waiting.append(number)
    return found


def first_view(browser: Any, url: str) -> float:
    """Seconds from the address to positions on the page, in a browser that knows nothing of it."""
    context = browser.new_context()
    page = context.new_page()
    begin = perf_counter()
    page.goto(url, wait_until="commit")
    page.wait_for_selector(".positions .big >> text=/[0-9]/")
    took = perf_counter() - begin
    context.close()
    return took


def main() -> None:
    plain, compressed = size_of_pages()
    print(f"pages: {plain / 1e3:.0f} kB, compressed {compressed / 1e3:.0f} kB")
    with InThread(Fake(points=SEGMENTS).app) as server, chromium() as browser:
        print("first view:", ", ".join(f"{first_view(browser, server.url):.2f} s" for _ in range(5)))
        page = open_page(browser, server.url + "#watch")
        page.wait_for_selector("[data-ms]")
        print(f"backplot of {SEGMENTS - 1} segments: shown in {page.get_attribute('.backplot', 'data-ms')} ms")
        page.evaluate(TURN)
        for _ in range(3):
            before = processor_time(os.getpid())
            frames, took, step = page.evaluate(TURN)
            each = (processor_time(os.getpid()) - before) / frames
            print(
                f"turned: {1000 * frames / took:.1f} frames/s (each {step}th point), {1000 * each:.0f} ms of processor a picture; load {os.getloadavg()[0]:.1f}"
            )
        page.close()


if __name__ == "__main__":
    main()

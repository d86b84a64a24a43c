"""Makes docs/pictures/web_*.png: each page, light and dark, on a desktop and a phone, with a real program running.

`python test/web_browser/pictures.py [PAGE …]`: needs chromium and pillow.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(HERE.parent / "support"), str(ROOT)]

from PIL import Image  # noqa: E402
from web_browser_support import DESKTOP, PHONE, InThread, chromium, open_page, until  # noqa: E402

from cnc_ptp.web.access.access import Access  # noqa: E402
from cnc_ptp.web.access.guard import Names  # noqa: E402
from cnc_ptp.web.faces.machine_face import offline_face  # noqa: E402
from cnc_ptp.web.hub import Hub  # noqa: E402
from cnc_ptp.web.programs.programs import ProgramFolder  # noqa: E402
from cnc_ptp.web.server import Server  # noqa: E402

PAGES = ("operate", "watch", "scope", "commission", "alarms", "program")
MILL = str(ROOT / "config/mill.yaml")
COLOURS = 160
SCALE = 0.75
"""Of the pixels of a desktop; they are for a glance."""


def take(page: Any, file: Path, scale: float) -> None:
    picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    size = (round(picture.width * scale), round(picture.height * scale))
    small = picture.resize(size, Image.Resampling.LANCZOS)
    few = small.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE)
    few.save(file, optimize=True)
    print(file.relative_to(ROOT), file.stat().st_size)


def begin(page: Any) -> None:
    """A program is loaded and an alarm is there."""
    page.wait_for_selector("option:text-is('bracket.nc')", state="attached")
    page.select_option("[aria-label='Load a program']", "bracket.nc")
    until(page, "app.store.units.channel.state === 'ready'")
    page.evaluate("() => void app.connection.command('x', 'move_absolute', { target: 5000 }).catch(() => 0)")


def run(page: Any, name: str) -> None:
    """The program runs, and the page has something to show."""
    page.evaluate("() => app.store.units.channel.active || app.command('channel', 'start')")
    until(page, "app.store.units.channel.active && app.store.units.channel.progress > 0.1")
    if name == "watch":
        page.wait_for_selector("[data-ms]")
    page.wait_for_timeout(3500 if name == "scope" else 1000)


def main(names: list[str]) -> None:
    hub = Hub(lambda: offline_face(MILL), name="Mill", folder=ProgramFolder(str(ROOT / "examples")), machine_file=MILL)
    with InThread(Server(hub, Access(None), Names()).app) as server, chromium() as browser:
        first = open_page(browser, server.url, command=True)
        begin(first)
        first.close()
        for name in names:
            for scheme in ("light", "dark"):
                for kind, size in (("desktop", DESKTOP), ("phone", PHONE)):
                    page = open_page(browser, f"{server.url}#{name}", size=size, scheme=scheme, command=True)
                    run(page, name)
                    take(
                        page,
                        ROOT / f"docs/pictures/web_{name}_{scheme}_{kind}.png",
                        SCALE if kind == "desktop" else 1.0,
                    )
                    page.close()


if __name__ == "__main__":
    main(sys.argv[1:] or [*PAGES])

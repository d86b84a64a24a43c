"""The web face on the mill of 8 processes in real time: scopes, buttons, positions, a large backplot, ends of jogs.

What needs no picture is measured with plain WebSocket clients (scope, lateness, core, commands); what a person sees and
presses with pages in headless Chromium (positions, jog button, backplot, first view). All of them run at nice 10.
"""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from math import nan
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from typing import Any

import psutil

BROWSER_TESTS = str(Path(__file__).parents[1] / "test" / "web_browser")
sys.path.insert(0, BROWSER_TESTS)

from measure import TURN, first_view, size_of_pages  # noqa: E402
from web_browser_support import open_page, until, why_no_browser  # noqa: E402

from bench.big_program import write_program  # noqa: E402
from bench.figures import Effort, Figure, ShowProgress  # noqa: E402
from bench.graph import missing_samples  # noqa: E402
from bench.graph_run import process_seconds  # noqa: E402
from bench.jobs import MACHINE  # noqa: E402
from bench.plc import p99  # noqa: E402
from bench.web_clients import CLIENTS, SIGNALS, ClientRun, Observer, watch  # noqa: E402
from bench.web_ends import KINDS, End, ends, limits_of_ramps, own_browser, press  # noqa: E402

COMMANDS, PRESSES, ENDS, VIEWS = 200, 100, 100, 5
SEGMENTS = 150_000
NICENESS = 10
DISPLAYED = 10.0
"""Seconds for which positions are counted."""
LONGEST_START = 120.0
"""Seconds until the graph runs, and until it has ended."""
LONGEST_DRAWING = 240.0
"""Seconds until the server has drawn the large program, beside the machine."""
BETWEEN = 0.4
PRESSED = """() => document.addEventListener("pointerdown", (event) => {
    window.pressedAt = performance.timeOrigin + event.timeStamp;
}, true)"""
COUNT_POSITIONS = """(ms) => new Promise((done) => {
    let shown = 0;
    const watch = new MutationObserver(() => { shown += 1; });
    watch.observe(document.querySelector(".positions"), { subtree: true, childList: true, characterData: true });
    const begin = performance.now();
    setTimeout(() => { watch.disconnect(); done(1000 * shown / (performance.now() - begin)); }, ms);
})"""


@dataclass(slots=True)
class WebRun:
    """What was measured; times in ms, but where s is said."""

    clients: ClientRun = field(default_factory=ClientRun)
    presses: list[float] = field(default_factory=list)
    positions: float = nan
    """Positions a second that a page shows."""
    first_views: list[float] = field(default_factory=list)
    """s"""
    drawn: float = nan
    """Until a large program is shown that the server has to draw first …"""
    shown: float = nan
    """… and once it is drawn."""
    frames: list[float] = field(default_factory=list)
    """A second, while the path is turned; three times."""
    point: int = 1
    """Each of these points of the path is drawn meanwhile."""
    ends: list[End] = field(default_factory=list)
    lost: float = nan
    missing: int = 0


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """All in one run of the graph."""
    if reason := why_no_browser():
        raise RuntimeError(reason)
    segments = effort.scaled(SEGMENTS, least=1000)
    show(f"{effort.graph_seconds:.0f} s of {CLIENTS} scopes, then pages in Chromium")
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        run = pool.submit(measure, effort, segments).result()
    yield from of_clients(run)
    yield from of_pages(run, segments)
    yield from of_ends(run.ends)


def of_clients(run: WebRun) -> Iterator[Figure]:
    seen = run.clients
    scopes = f"{CLIENTS} clients with a scope of {len(SIGNALS)} signals at 1 kHz (WebSocket)"
    yield Figure(f"{scopes}: samples that came", seen.samples, "")
    yield Figure("samples of the scopes lost", seen.lost, "", goal=0.0, at_most=True)
    yield Figure(
        "block lateness of the latest node meanwhile, p99", seen.lateness_p99_ms, "ms", goal=10.0, at_most=True
    )
    yield Figure("web meanwhile", seen.core, "cores", goal=0.35, at_most=True)
    yield Figure("states with a new position (WebSocket), least", seen.states_per_second, "1/s", goal=20.0)
    yield Figure("blocks lost in the whole run", run.lost, "", goal=0.0, at_most=True)
    yield Figure("samples missing in the recording", run.missing, "", goal=0.0, at_most=True)
    reaction = "override message (WebSocket) to first changed setpoint"
    yield Figure(f"{reaction}, median", median(seen.reactions), "ms")
    yield Figure(f"{reaction}, p99", p99(seen.reactions), "ms", goal=60.0, at_most=True)


def of_pages(run: WebRun, segments: int) -> Iterator[Figure]:
    button = "jog button (Chromium) to first changed setpoint"
    yield Figure(f"{button}, median", median(run.presses), "ms")
    yield Figure(f"{button}, p99", p99(run.presses), "ms", goal=60.0, at_most=True)
    yield Figure("positions that a page shows (Chromium)", run.positions, "1/s", goal=20.0)
    yield Figure("all pages, compressed", size_of_pages()[1] / 1e6, "MB", goal=3.0, at_most=True)
    yield Figure("first view, median", median(run.first_views), "s", goal=2.0, at_most=True)
    path = f"backplot of {segments} segments"
    yield Figure(f"{path}: shown, drawn by the server before that", run.drawn / 1e3, "s")
    yield Figure(f"{path}: shown, once it is drawn", run.shown / 1e3, "s", goal=3.0, at_most=True)
    yield Figure(f"{path}: turned, least of {len(run.frames)}", min(run.frames), "frames/s", goal=30.0)
    yield Figure("each of so many points is drawn while it is turned", run.point, "")


def of_ends(found: list[End]) -> Iterator[Figure]:
    """From the end of a jogging page: until the stop begins, until the axis stands, and whether all were ramps."""
    most_acceleration, most_jerk = limits_of_ramps()
    for kind in KINDS:
        of_kind = [end for end in found if end.kind == kind]
        if not of_kind:
            continue
        name = f"jog, {kind}"
        yield Figure(f"{name}: times", len(of_kind), "")
        yield Figure(f"{name}: stop begins after, median", median(end.begins for end in of_kind), "ms")
        latest = max(end.begins for end in of_kind)
        yield Figure(f"{name}: stop begins after, largest", latest, "ms", goal=250.0, at_most=True)
        yield Figure(f"{name}: stands after, median", median(end.stands for end in of_kind), "ms")
        yield Figure(f"{name}: stands after, largest", max(end.stands for end in of_kind), "ms")
        acceleration = max(end.acceleration for end in of_kind)
        yield Figure(f"{name}: largest acceleration", acceleration, "mm/s²", goal=most_acceleration, at_most=True)
        jerk = max(end.jerk for end in of_kind)
        yield Figure(f"{name}: largest jerk", jerk, "mm/s³", goal=most_jerk, at_most=True)
        gained = max(end.overshoot for end in of_kind)
        yield Figure(f"{name}: velocity gained in the stop", gained, "mm/s", goal=1e-9, at_most=True)
        again = sum(end.goes_on > 0.0 for end in of_kind)
        yield Figure(f"{name}: started again", again, "times", goal=0.0, at_most=True)


def measure(effort: Effort, segments: int) -> WebRun:
    """Starts and ends the graph of the mill with its pages."""
    import rclpy

    from cnc_ptp.nodes import process

    with tempfile.TemporaryDirectory() as folder:
        write_program(Path(folder) / "big.nc", segments)
        record, told = str(Path(folder) / "run.mcap"), Path(folder) / "told"
        port = free_port()
        command = [sys.executable, "-m", "cnc_ptp", "run", MACHINE, "--stay", "--web", str(port), "--record", record]
        with told.open("w") as output:
            graph = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, cwd=folder)
        try:
            wait_for_pages(graph, told)
            os.nice(NICENESS)
            process.initialise()
            run = session(port, psutil.Process(graph.pid), effort)
        except Exception as error:
            raise RuntimeError(f"{error}; the graph has said: {told.read_text()}") from error
        finally:
            graph.terminate()
            graph.wait(LONGEST_START)
            rclpy.try_shutdown()
        if found := re.search(r"lost (\d+), computed twice", told.read_text()):
            run.lost = int(found[1])
        run.missing = missing_samples(record)
    return run


def free_port() -> int:
    import socket

    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def wait_for_pages(graph: subprocess.Popen[bytes], told: Path) -> None:
    """Its server has told its address."""
    deadline = time.monotonic() + LONGEST_START
    while "pages: " not in told.read_text():
        if graph.poll() is not None or time.monotonic() > deadline:
            raise RuntimeError(f"no pages: {told.read_text()}")
        time.sleep(0.1)


def session(port: int, graph: psutil.Process, effort: Effort) -> WebRun:
    from playwright.sync_api import sync_playwright

    server = next(child for child in graph.children() if "--listening" in child.cmdline())
    observer = Observer()
    address, run = f"http://127.0.0.1:{port}", WebRun()
    try:
        observer.wait(lambda: observer.since(0))
        commands = effort.scaled(COMMANDS, least=2)
        watching = watch(address, effort.graph_seconds, commands, observer, lambda: process_seconds(server))
        run.clients = asyncio.run(watching)
        with sync_playwright() as playwright:
            with own_browser(playwright) as (browser, _):
                run.first_views = [first_view(browser, address) for _ in range(effort.scaled(VIEWS))]
                page = open_page(browser, address, command=True)
                run.presses = presses(page, observer, effort.scaled(PRESSES, least=2))
                run.positions = shown_positions(page, min(DISPLAYED, effort.graph_seconds))
                backplot(page, run)
                page.close()
            run.ends = ends(playwright, port, observer, effort.scaled(ENDS, least=len(KINDS)))
    finally:
        observer.close()
    return run


def presses(page: Any, observer: Observer, count: int) -> list[float]:
    """Milliseconds from a jog button to the first changed setpoint."""
    page.evaluate(PRESSED)
    found = []
    for number in range(count):
        begin = time.time_ns()
        press(page, "+−"[number % 2])
        observer.wait(lambda: abs(observer.velocity) > 1.0)
        pressed = round(1e6 * page.evaluate("window.pressedAt"))
        milliseconds = observer.changed(max(begin, pressed), 0.0)
        assert milliseconds is not None
        found.append(milliseconds + 1e-6 * max(0, begin - pressed))
        page.mouse.up()
        observer.wait(lambda: observer.velocity == 0.0)
        page.wait_for_timeout(1000.0 * (BETWEEN + 0.0137 * (number % 7)))
    return found


def shown_positions(page: Any, seconds: float) -> float:
    """Positions a second on the page while x moves."""
    page.evaluate("() => void app.command('x', 'move_absolute', { target: 200, velocity: 5 })")
    until(page, "app.store.units.x.set_velocity !== 0")
    shown = float(page.evaluate(COUNT_POSITIONS, 1000.0 * seconds))
    page.evaluate("() => void app.command('x', 'halt')")
    until(page, "app.store.units.x.set_velocity === 0")
    return shown


def backplot(page: Any, run: WebRun) -> None:
    """A large program: drawn by the server and shown, shown again by a page that was left, turned."""
    page.set_default_timeout(1000.0 * LONGEST_DRAWING)
    page.evaluate("() => app.request('load', { channel: app.store.channel, name: 'big.nc' })")
    until(page, "(app.store.units.channel.program || '').endsWith('big.nc')")
    times = []
    for _ in range(2):
        page.evaluate("() => { location.hash = 'watch'; }")
        page.wait_for_selector(".backplot[data-ms]")
        times.append(float(page.get_attribute(".backplot", "data-ms")))
        if len(times) == 1:
            page.evaluate("() => { location.hash = 'operate'; }")
            page.wait_for_selector("main.operate")
    run.drawn, run.shown = times
    page.evaluate(TURN)
    turned = [page.evaluate(TURN) for _ in range(3)]
    run.frames = [1000.0 * frames / took for frames, took, _ in turned]
    run.point = int(max(step for *_, step in turned))

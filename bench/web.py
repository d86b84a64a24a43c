"""The web face in real time, with pages in headless Chromium: scopes on the mill of 8 processes; buttons, positions and
ends of jogs on the mill in one process. The browsers run at nice 19: people have them on another computer. Beside 8
processes two cores leave them too little to press a hundred buttons.
"""

from __future__ import annotations

import os
import random
import re
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import nan
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from typing import Any

import psutil

from bench.figures import Effort, Figure, ShowProgress
from bench.graph import missing_samples
from bench.graph_run import process_seconds
from bench.jobs import MACHINE, long_program
from bench.lateness import lateness_p99, told
from bench.plc import p99
from bench.web_jogs import KEEP_PRESSES, Ends, Observer, Proxy, collect, killed, own_browser, released, stalled

sys.path.insert(0, str(Path(__file__).parents[1] / "test" / "web_browser"))

from web_browser_support import open_page, until, why_no_browser

SIGNALS = [
    *(f"{axis}.{field}" for axis in "xyz" for field in ("set_position", "following_error")),
    "channel.path_velocity",
    "s.actual_speed_rpm",
]
"""Eight, at 1 kHz."""
PAGES = 2
PRESSES, KILLED, STALLED = 100, 50, 50
SEED = 20
NICENESS = 19
DISPLAYED = 10.0
"""Seconds for which positions are counted."""
SETTLING = 2.0
LONGEST_START = 120.0
"""Seconds until the graph runs, and until it has ended."""
KEEP_VIEW = """(names) => {
    const channels = names.map((name, i) => ({ name, graph: 1 + i % 4 }));
    localStorage.setItem("scope-views", JSON.stringify({ bench: { channels, window: 2 } }));
    location.hash = "scope";
}"""
COUNT_SAMPLES = """() => {
    const take = app.connection.onBinary;
    window.seen = { samples: 0, lost: 0 };
    let next = -1;
    app.connection.onBinary = (data) => {
        const [, low, high, , count] = new Uint32Array(data, 0, 5);
        const first = low + high * 2 ** 32;
        if (next >= 0) seen.lost += Math.max(0, first - next);
        seen.samples += count;
        next = first + count;
        take(data);
    };
}"""
RUN_PROGRAM = """async (text) => {
    await app.request("load", { channel: "channel", name: "rounds.nc", text });
    await app.command("channel", "start", {});
}"""
COUNT_POSITIONS = """(ms) => new Promise((done) => {
    let shown = 0;
    const watch = new MutationObserver(() => { shown += 1; });
    watch.observe(document.querySelector(".positions"), { subtree: true, childList: true, characterData: true });
    const begin = performance.now();
    setTimeout(() => { watch.disconnect(); done(1000 * shown / (performance.now() - begin)); }, ms);
})"""


@dataclass(slots=True)
class WebRun:
    """What was measured; times in ms."""

    samples: int = 0
    lost: int = 0
    """Cycles of the scopes that have not come."""
    core: float = nan
    looked: tuple[int, int] | None = None
    """From when to when the scopes were looked at, ns of the wall clock."""
    lateness_p99: float = nan
    """Of the blocks of the latest node meanwhile."""
    positions: float = nan
    """A second, on a page."""
    reactions: list[float] = field(default_factory=list)
    ends: dict[str, Ends] = field(default_factory=dict)
    pressed_for_nothing: int = 0
    """Presses of a button after which nothing moved within 2 s."""
    blocks_lost: float = 0.0
    missing: int = 0


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """All in two runs of the graph."""
    if reason := why_no_browser():
        raise RuntimeError(reason)
    show(f"{effort.graph_seconds:.0f} s of {PAGES} scopes, then {effort.scaled(PRESSES, least=2)} jogs and other ends")
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    run = WebRun()
    for part in (measure_scopes, measure_jogs):  # each in a process of its own, whose niceness nobody else gets
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            run = pool.submit(part, effort, run).result()
    yield Figure(f"{PAGES} browsers with a scope of {len(SIGNALS)} signals at 1 kHz: samples", run.samples, "")
    yield Figure("samples of the scopes lost", run.lost, "", goal=0.0, at_most=True)
    lateness = "block lateness of the latest node meanwhile, p99"
    yield Figure(lateness, run.lateness_p99, "ms", goal=10.0, at_most=True)
    yield Figure("web meanwhile", run.core, "cores", goal=0.35, at_most=True)
    yield Figure("blocks lost in both runs", run.blocks_lost, "", goal=0.0, at_most=True)
    yield Figure("samples missing in the recording", run.missing, "", goal=0.0, at_most=True)
    yield Figure("positions that a page shows", run.positions, "1/s", goal=20.0)
    yield Figure("jog button to first changed setpoint, median", median(run.reactions), "ms")
    yield Figure("jog button to first changed setpoint, p99", p99(run.reactions), "ms", goal=60.0, at_most=True)
    yield Figure("jog buttons that moved nothing within 2 s", run.pressed_for_nothing, "times")
    for kind, (ends, ended_before) in run.ends.items():
        begins = [end.begins for end in ends]
        yield Figure(f"jog, {kind}: times", len(ends), "")
        yield Figure(f"jog, {kind}: had ended before", ended_before, "times")
        yield Figure(f"jog, {kind}: stop begins after, median", median(begins), "ms")
        yield Figure(f"jog, {kind}: stop begins after, largest", max(begins), "ms", goal=250.0, at_most=True)
        yield Figure(f"jog, {kind}: stands after, largest", max(end.stands for end in ends), "ms")
        again = sum(end.goes_on > 0.0 for end in ends)
        yield Figure(f"jog, {kind}: started again", again, "times", goal=0.0, at_most=True)


def measure_scopes(effort: Effort, run: WebRun) -> WebRun:
    from playwright.sync_api import sync_playwright

    with mill(run) as (port, graph), sync_playwright() as playwright:
        server = next(child for child in graph.children() if "--listening" in child.cmdline())
        scopes(playwright, address_of(port), server, effort.graph_seconds, run)
    return run


def measure_jogs(effort: Effort, run: WebRun) -> WebRun:
    import rclpy
    from playwright.sync_api import sync_playwright

    from cnc_ptp.nodes import process

    with mill(run, "--composed") as (port, _), sync_playwright() as playwright:
        process.initialise()
        try:
            jogs(playwright, port, effort, run)
        finally:
            rclpy.try_shutdown()
    return run


@contextmanager
def mill(run: WebRun, *words: str) -> Iterator[tuple[int, psutil.Process]]:
    """The graph of the mill: port of its pages, process. What it has lost counts for `run`."""
    port = free_port()
    with tempfile.TemporaryDirectory() as folder:
        record, output_file = str(Path(folder) / "run.mcap"), Path(folder) / "told"
        command = [sys.executable, "-m", "cnc_ptp", "run", MACHINE, "--stay", "--web", str(port), "--record", record]
        with output_file.open("w") as output:
            graph = subprocess.Popen([*command, *words], stdout=output, stderr=subprocess.STDOUT, cwd=folder)
        try:
            wait_for_pages(graph, output_file)
            os.nice(NICENESS)
            yield port, psutil.Process(graph.pid)
        except Exception as error:
            raise RuntimeError(f"{error}; the graph has said: {output_file.read_text()}") from error
        finally:
            graph.terminate()
            graph.wait(LONGEST_START)
        found = re.search(r"lost (\d+), computed twice", output_file.read_text())
        run.blocks_lost += int(found[1]) if found else nan
        run.missing += missing_samples(record)
        if run.looked:
            run.lateness_p99, run.looked = lateness_p99(told(record), *run.looked), None


def address_of(port: int) -> str:
    return f"http://127.0.0.1:{port}/"


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def wait_for_pages(graph: subprocess.Popen[bytes], output_file: Path) -> None:
    """Its server has told its address."""
    deadline = time.monotonic() + LONGEST_START
    while "pages: " not in output_file.read_text():
        if graph.poll() is not None or time.monotonic() > deadline:
            raise RuntimeError("no pages")
        time.sleep(0.1)


def jogs(playwright: Any, port: int, effort: Effort, run: WebRun) -> None:
    """Positions that a page shows, and ends of jogs."""
    address, held = address_of(port), random.Random(SEED)
    with Observer() as observer, Proxy(port) as proxy:
        with own_browser(playwright) as (browser, _):
            page = open_page(browser, address, command=True)
            run.positions = shown_positions(page, min(DISPLAYED, effort.graph_seconds))
            page.evaluate(KEEP_PRESSES)
            count = effort.scaled(PRESSES, least=2)
            run.ends["key up"] = collect("key up", count, lambda: released(page, observer, held, run.reactions))
        count = effort.scaled(KILLED)
        run.ends["browser killed"] = collect(
            "browser killed", count, lambda: killed(playwright, address, observer, held)
        )
        with own_browser(playwright) as (browser, _):
            page = open_page(browser, proxy.address, command=True)
            count = effort.scaled(STALLED)
            run.ends["socket stalled"] = collect("socket stalled", count, lambda: stalled(page, proxy, observer, held))
        run.pressed_for_nothing = observer.pressed_for_nothing


def scopes(playwright: Any, address: str, server: psutil.Process, seconds: float, run: WebRun) -> None:
    """Two browsers look at eight signals of a program that runs."""
    with own_browser(playwright) as (first, _), own_browser(playwright) as (second, _):
        pages = [open_page(first, address, command=True), open_page(second, address)]
        for page in pages:
            page.evaluate(KEEP_VIEW, SIGNALS)
            page.select_option("[aria-label='Saved views']", "bench")
            page.wait_for_selector(f".channels >> text={SIGNALS[-1]}")
        pages[0].evaluate(RUN_PROGRAM, long_program(seconds + 5.0 * SETTLING))
        until(pages[0], "app.store.units.channel.state === 'running'")
        for page in pages:
            page.evaluate(COUNT_SAMPLES)
        time.sleep(SETTLING)
        begin, used = time.time_ns(), process_seconds(server)
        pages[0].wait_for_timeout(1000.0 * seconds)
        run.looked = begin, time.time_ns()
        run.core = (process_seconds(server) - used) / (1e-9 * (run.looked[1] - begin))
        for page in pages:
            seen = page.evaluate("window.seen")
            run.samples, run.lost = run.samples + seen["samples"], run.lost + seen["lost"]
        pages[0].evaluate("() => app.command('channel', 'reset', {})")
        until(pages[0], "!app.store.units.channel.active")


def shown_positions(page: Any, seconds: float) -> float:
    """Positions a second on the page while x moves."""
    page.evaluate("() => void app.command('x', 'move_absolute', { target: 200, velocity: 5 })")
    until(page, "app.store.units.x.set_velocity !== 0")
    shown = float(page.evaluate(COUNT_POSITIONS, 1000.0 * seconds))
    page.evaluate("() => void app.command('x', 'halt', {})")
    until(page, "app.store.units.x.set_velocity === 0")
    return shown

"""Ends of jogging pages: their browser is killed or frozen, or their socket stalls; and what becomes of the axis."""

from __future__ import annotations

import asyncio
import random
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import psutil
from web_browser_support import CHROMIUM, FLAGS, open_page, until

from bench.jobs import MACHINE
from bench.web_clients import Observer
from cnc_ptp.parameters import read_machine

SEED = 20
KINDS = ("browser killed", "browser frozen", "socket stalled")
HELD = (0.3, 0.9)
"""Seconds from the beginning of the motion to the end of the page, at random."""
STALL = 1.0
"""Seconds after which a browser or a socket goes on: what is late must start nothing."""
SETTLING = 0.5
CYCLE = 1e-3
DIGITS = 3
"""Of accelerations and jerks: further ones are rounding errors of velocities."""


@dataclass(frozen=True, slots=True)
class End:
    """One page; times in ms from its end, velocity in mm/s, acceleration in mm/s², jerk in mm/s³."""

    kind: str
    begins: float
    """The velocity falls."""
    stands: float
    acceleration: float
    jerk: float
    overshoot: float
    """Velocity that it gained while it stopped; above 0 it was no ramp down."""
    goes_on: float
    """Largest velocity after the standstill."""


def limits_of_ramps() -> tuple[float, float]:
    """The largest acceleration (mm/s²) and jerk (mm/s³) of a jog of x and of its stop, by the machine file."""
    x = read_machine(MACHINE).axes["x"]
    return max(x.acceleration, x.deceleration), x.jerk


class Proxy:
    """Between a browser and the server; when it stalls, nothing comes through, and the connection stays."""

    def __init__(self, port: int) -> None:
        self._to = port
        self._flows = threading.Event()
        self._flows.set()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        served = asyncio.run_coroutine_threadsafe(asyncio.start_server(self._serve, "127.0.0.1", 0), self._loop)
        self._server = served.result(10.0)
        self.port = self._server.sockets[0].getsockname()[1]

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        other_reader, other_writer = await asyncio.open_connection("127.0.0.1", self._to)
        await asyncio.gather(self._pass(reader, other_writer), self._pass(other_reader, writer))

    async def _pass(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with suppress(ConnectionError):
            while data := await reader.read(1 << 16):
                while not self._flows.is_set():
                    await asyncio.sleep(0.005)
                writer.write(data)
                await writer.drain()
        writer.close()

    def stall(self, on: bool) -> None:
        (self._flows.clear if on else self._flows.set)()

    def close(self) -> None:
        self._loop.call_soon_threadsafe(self._server.close)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(5.0)


@contextmanager
def own_browser(playwright: Any) -> Iterator[tuple[Any, list[psutil.Process]]]:
    """A browser and all its processes; those that live are ended, by their ids."""
    known = {child.pid for child in psutil.Process().children(recursive=True)}
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
    mine = [child for child in psutil.Process().children(recursive=True) if child.pid not in known]
    try:
        yield browser, mine
    finally:
        for child in mine:
            with suppress(psutil.NoSuchProcess):
                child.send_signal(signal.SIGCONT)
                child.kill()
        with suppress(Exception):  # it is gone already
            browser.close()


def ends(playwright: Any, port: int, observer: Observer, count: int) -> list[End]:
    """So many jogging pages, of each kind in turn, at seeded moments."""
    moments = random.Random(SEED)
    proxy = Proxy(port)
    try:
        return [
            one_end(playwright, proxy, observer, KINDS[number % len(KINDS)], moments.uniform(*HELD), number)
            for number in range(count)
        ]
    finally:
        proxy.close()


def one_end(playwright: Any, proxy: Proxy, observer: Observer, kind: str, held: float, number: int) -> End:
    with own_browser(playwright) as (browser, processes):
        page = open_page(browser, f"http://127.0.0.1:{proxy.port}/", command=True)
        press(page, "+" if number % 2 else "−")
        observer.wait(lambda: abs(observer.velocity) > 1.0)
        page.wait_for_timeout(1000.0 * held)
        processes += [child for child in descendants(processes) if child not in processes]
        velocity, died = observer.velocity, time.time_ns()
        if kind == "browser killed":
            signal_all(processes, signal.SIGKILL)
        elif kind == "browser frozen":
            signal_all(processes, signal.SIGSTOP)
        else:
            proxy.stall(True)
        observer.wait(lambda: observer.velocity == 0.0)
        time.sleep(STALL)
        proxy.stall(False)
        if kind == "browser frozen":
            signal_all(processes, signal.SIGCONT)
        time.sleep(SETTLING)
    return evaluated(kind, observer, died, velocity)


def press(page: Any, sign: str) -> None:
    """Holds a jog button of x."""
    until(page, "app.roundTrip.time < 100")
    box = page.locator(f"[aria-label='Jog X {sign}']").bounding_box()
    page.mouse.move(box["x"] + 10, box["y"] + 10)
    page.mouse.down()


def descendants(processes: list[psutil.Process]) -> list[psutil.Process]:
    found = []
    for process in processes:
        with suppress(psutil.NoSuchProcess):
            found += process.children(recursive=True)
    return found


def signal_all(processes: list[psutil.Process], number: signal.Signals) -> None:
    for process in processes:
        with suppress(psutil.NoSuchProcess):
            process.send_signal(number)


def evaluated(kind: str, observer: Observer, died: int, velocity: float) -> End:
    """Times of cycles count from the publication of their block on."""
    blocks = observer.since(died - 50_000_000)  # with the ramp's beginning in any case
    missing = [
        later.cycle for earlier, later in pairwise(blocks) if later.cycle != earlier.cycle + len(earlier.velocities)
    ]
    if missing:
        raise RuntimeError(f"the observer lacks blocks before cycles {missing}")
    speeds = np.abs(np.concatenate([block.velocities for block in blocks]))
    times = np.concatenate(
        [1e-6 * (block.at - died) + 1e3 * CYCLE * np.arange(len(block.velocities)) for block in blocks]
    )
    slower = int(np.flatnonzero(speeds < abs(velocity) - 1e-9)[0])
    stands = slower + int(np.flatnonzero(speeds[slower:] == 0.0)[0])
    ramp = speeds[max(0, slower - 3) : stands + 3]
    acceleration = np.diff(ramp) / CYCLE
    return End(
        kind,
        float(times[slower]),
        float(times[stands]),
        round(float(np.max(np.abs(acceleration))), DIGITS),
        round(float(np.max(np.abs(np.diff(acceleration)))) / CYCLE, DIGITS),
        max(0.0, float(np.max(np.diff(speeds[slower : stands + 1]), initial=0.0))),
        float(np.max(speeds[stands:])),
    )

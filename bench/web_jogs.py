"""Jogs of a page and their ends, by what the axis does: its key comes up, its browser is killed, its socket stalls."""

from __future__ import annotations

import asyncio
import os
import random
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import psutil

sys.path.insert(0, str(Path(__file__).parents[1] / "test" / "web_browser"))

from web_browser_support import CHROMIUM, FLAGS, open_page, until

HELD = (0.2, 0.5)
"""Seconds from the beginning of the motion to the end of the jog, at random."""
STALL = 0.6
"""Seconds after the standstill for which a socket still stalls: what is late must start nothing."""
SETTLING = 0.4
TOLD = 10
"""Ends from one line of progress to the next."""
MOST_TRIES = 5
"""For each end that counts."""
KEPT_BLOCKS = 6000
"""Of an axis: a minute."""
BEFORE = 50_000_000
"""ns of blocks before an end, which have its velocity."""
PATIENCE, BEGINNING = 30.0, 2.0
NOTICES = "() => app.notices.element.innerText"
LOOK_PERIOD = 0.002
CYCLE = 1.0
"""ms"""
ZERO = 1e-9
KEEP_PRESSES = """() => {
    window.at = {};
    for (const kind of ["pointerdown", "pointerup"]) {
        document.addEventListener(kind, (event) => { at[kind] = performance.timeOrigin + event.timeStamp; }, true);
    }
}"""


@dataclass(frozen=True, slots=True)
class End:
    """Of a jog; times in ms from what ended it, velocity in mm/s."""

    begins: float
    """The velocity falls."""
    stands: float
    goes_on: float
    """Largest velocity after the standstill."""


class Ends(NamedTuple):
    """Those of one kind, and how many jogs had ended before."""

    found: list[End]
    ended_before: int


@dataclass(frozen=True, slots=True)
class Moved:
    """A block of an axis: when it was published (ns of the wall clock), its first cycle, its speeds."""

    at: int
    cycle: int
    speeds: npt.NDArray[np.float64]


class Observer:
    """The blocks of an axis as DDS gives them, with the times at which they were published; read by a thread."""

    def __init__(self, axis: str = "x") -> None:
        from rclpy.serialization import deserialize_message

        from cnc_ptp import msg
        from cnc_ptp.nodes.polling_node import PollingNode
        from cnc_ptp.nodes.topics import BLOCKS, block_topic

        self._node = PollingNode("web_bench")
        self._subscription = self._node.poll(msg.AxisBlock, block_topic(axis), lambda _: None, BLOCKS)
        self._read = deserialize_message
        self._blocks: deque[Moved] = deque(maxlen=KEPT_BLOCKS)
        self.pressed_for_nothing = 0
        """Presses of a button that have not moved the axis."""
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> Observer:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        self._node.destroy_node()

    def _run(self) -> None:
        handle: Any = self._subscription.handle
        while not self._ended.wait(LOOK_PERIOD):
            while True:
                with handle:
                    taken = handle.take_message(self._subscription.msg_type, True)
                if taken is None:
                    break
                block = self._read(taken[0], self._subscription.msg_type)
                speeds = np.abs(np.array(block.set_velocity))
                self._blocks.append(Moved(taken[1]["source_timestamp"], block.first_cycle, speeds))

    @property
    def speed(self) -> float:
        """The newest one, mm/s."""
        return float(self._blocks[-1].speeds[-1]) if self._blocks else 0.0

    def since(self, moment: int) -> list[Moved]:
        """Blocks that were published after a moment (ns)."""
        return [block for block in list(self._blocks) if block.at > moment]

    def wait(self, what: str, condition: Callable[[], bool], patience: float = PATIENCE) -> None:
        """Raises TimeoutError."""
        deadline = time.monotonic() + patience
        while not condition():
            if time.monotonic() > deadline:
                raise TimeoutError(f"{what}: not within {patience:g} s")
            time.sleep(LOOK_PERIOD)

    def wait_for_rest(self, moment: int) -> None:
        """Until a block that was published after a moment (ns) ends at rest: this process may lag behind."""
        self.wait("a jog ends", lambda: bool(self.since(moment)) and self.speed == 0.0)

    def first_motion(self, moment: int) -> float:
        """Milliseconds from a moment at which the axis stands to the publication of the first block that moves."""
        return next(1e-6 * (block.at - moment) for block in self.since(moment) if np.any(block.speeds > ZERO))

    def end_after(self, moment: int) -> End | None:
        """Cycles count from the publication of their block on; None: the stop had begun before, by another cause (a
        busy browser sends too late). Raises RuntimeError for blocks that it has not seen.
        """
        blocks = self.since(moment - BEFORE)
        if any(later.cycle != earlier.cycle + len(earlier.speeds) for earlier, later in pairwise(blocks)):
            raise RuntimeError("the observer lacks blocks")
        speeds = np.concatenate([block.speeds for block in blocks])
        times = np.concatenate([1e-6 * (b.at - moment) + CYCLE * np.arange(len(b.speeds)) for b in blocks])
        stands = int(np.flatnonzero(speeds == 0.0)[0])
        moving = speeds[:stands]
        slower = int(np.flatnonzero(moving >= np.max(moving, initial=0.0) - ZERO)[-1]) + 1 if stands else 0
        if times[slower] < 0.0:
            return None
        return End(float(times[slower]), float(times[stands]), float(np.max(speeds[stands:])))


class Proxy:
    """Between a browser and the server; when it stalls, nothing comes through, and the connection stays."""

    def __init__(self, port: int) -> None:
        self._to = port
        self._flows = threading.Event()
        self._flows.set()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)

    def __enter__(self) -> Proxy:
        self._thread.start()
        served = asyncio.run_coroutine_threadsafe(asyncio.start_server(self._serve, "127.0.0.1", 0), self._loop)
        self.address = f"http://127.0.0.1:{served.result(10.0).sockets[0].getsockname()[1]}/"
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(5.0)

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


@contextmanager
def own_browser(playwright: Any) -> Iterator[tuple[Any, Callable[[], list[int]]]]:
    """A browser, and what finds the ids of all its processes."""
    known = set(psutil.Process().children(recursive=True))
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
    mine = [each for each in psutil.Process().children(recursive=True) if each not in known and is_browser(each)]
    try:
        yield browser, lambda: [each.pid for one in mine for each in (one, *descendants(one))]
    finally:
        with suppress(Exception):  # it is gone already
            browser.close()


def is_browser(process: psutil.Process) -> bool:
    """Not one of the graph, which is a child too."""
    with suppress(psutil.NoSuchProcess):
        return "chrom" in process.name()
    return False


def descendants(process: psutil.Process) -> list[psutil.Process]:
    with suppress(psutil.NoSuchProcess):
        return list(process.children(recursive=True))
    return []


def jog(page: Any, observer: Observer, held: random.Random) -> None:
    """Holds the jog button of x that leads towards the middle, until the axis has moved for a while."""
    for _ in range(MOST_TRIES):
        until(page, "app.roundTrip.time < 100")
        sign = "−" if page.evaluate("app.store.units.x.set_position") > 0.0 else "+"
        box = page.locator(f"[aria-label='Jog X {sign}']").bounding_box()
        page.mouse.move(box["x"] + 10, box["y"] + 10)
        page.mouse.down()
        with suppress(TimeoutError):
            observer.wait("a jog begins", lambda: observer.speed > 1.0, BEGINNING)
            break
        page.mouse.up()  # a page that is too slow at the moment does not jog
        observer.pressed_for_nothing += 1
    else:
        raise TimeoutError(f"no jog in {MOST_TRIES} tries: {page.evaluate(NOTICES)}")
    time.sleep(held.uniform(*HELD))


def ended(observer: Observer, moment: int) -> End | None:
    """Once the axis has stood for a while."""
    observer.wait_for_rest(moment)
    time.sleep(SETTLING)
    return observer.end_after(moment)


def collect(kind: str, count: int, one_end: Callable[[], End | None]) -> Ends:
    """So many ends, with a line after each tenth of them. Raises RuntimeError where most jogs end before."""
    found: list[End] = []
    for tries in range(1, MOST_TRIES * count + 1):
        if (end := one_end()) is None:
            continue
        found.append(end)
        if len(found) == count or len(found) % TOLD == 0:
            latest = max(each.begins for each in found)
            print(f"web: {kind}, {len(found)} of {count}: the latest stop after {latest:.0f} ms", file=sys.stderr)
        if len(found) == count:
            return Ends(found, tries - count)
    raise RuntimeError(f"{len(found)} of {MOST_TRIES * count} jogs lasted until their end: the computer is too busy")


def released(page: Any, observer: Observer, held: random.Random, reactions: list[float]) -> End | None:
    """`reactions` get the milliseconds from the button to the first setpoint that moves."""
    jog(page, observer, held)
    page.mouse.up()
    down, up = (round(1e6 * page.evaluate("window.at")[kind]) for kind in ("pointerdown", "pointerup"))
    end = ended(observer, up)
    reactions.append(observer.first_motion(down))
    return end


def killed(playwright: Any, address: str, observer: Observer, held: random.Random) -> End | None:
    with own_browser(playwright) as (browser, processes):
        page = open_page(browser, address, command=True)
        numbers = processes()  # takes long on a busy computer
        jog(page, observer, held)
        moment = time.time_ns()
        for number in numbers:
            with suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
        return ended(observer, moment)


def stalled(page: Any, proxy: Proxy, observer: Observer, held: random.Random) -> End | None:
    """What stalls comes while the axis stands: its page has the button down until then."""
    jog(page, observer, held)
    moment = time.time_ns()
    proxy.stall(True)
    observer.wait_for_rest(moment)
    time.sleep(STALL)
    proxy.stall(False)
    end = ended(observer, moment)
    page.mouse.up()
    return end

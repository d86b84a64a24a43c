"""A figure, how often it is measured, and how figures are shown."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

ShowProgress = Callable[[str], None]
"""Shows what is being measured."""


@dataclass(frozen=True, slots=True)
class Effort:
    """Thoroughness of the measurement."""

    runs: int
    """Runs of which the median is taken."""
    size: float
    """Size of the jobs, 1 = full."""
    graph_seconds: float
    """Length of the real-time run of the graph."""

    def scaled(self, full: int, least: int = 1) -> int:
        return max(least, round(full * self.size))


FULL = Effort(runs=5, size=1.0, graph_seconds=60.0)
SHORT = Effort(runs=3, size=0.2, graph_seconds=15.0)


@dataclass(frozen=True, slots=True)
class Figure:
    """A measured value with the goal (and an aim beyond it) and the value of a peer from the same run."""

    name: str
    value: float
    unit: str
    goal: float | None = None
    aim: float | None = None
    at_most: bool = False
    """The goal is an upper bound."""
    of_ratio: bool = False
    """The goal is one for the ratio to the peer: it holds on any computer."""
    peer: str = ""
    peer_value: float | None = None

    @property
    def ratio(self) -> float | None:
        """Value over that of the peer."""
        return self.value / self.peer_value if self.peer_value else None

    @property
    def met(self) -> bool | None:
        """Whether the goal is reached; None without one."""
        if self.goal is None:
            return None
        value = (self.ratio or 0.0) if self.of_ratio else self.value
        return value <= self.goal if self.at_most else value >= self.goal


def median_of(runs: int, measure: Callable[[], float]) -> float:
    return statistics.median(measure() for _ in range(runs))


def medians_of(runs: int, measures: Sequence[Callable[[], float]]) -> list[float]:
    """Medians of several measures, taken in turn, so that a slow moment of the machine meets all of them."""
    rounds = [[measure() for measure in measures] for _ in range(runs)]
    return [statistics.median(column) for column in zip(*rounds, strict=True)]


class Stopwatch:
    """Seconds of the wall and of this process's processors."""

    wall = 0.0
    cpu = 0.0


@contextmanager
def stopwatch() -> Iterator[Stopwatch]:
    """Measures the block of a with statement, without garbage of earlier measurements."""
    gc.collect()
    watch = Stopwatch()
    wall, cpu = time.perf_counter(), time.process_time()
    yield watch
    watch.wall, watch.cpu = time.perf_counter() - wall, time.process_time() - cpu


WORK = 500_000


def fixed_work() -> float:
    """CPU s of a piece of work that never changes: what the machine gives in this hour, to compare hours by."""
    with stopwatch() as watch:
        value = 0.0
        for step in range(WORK):
            value = 0.5 * value + step
    return watch.cpu


def number(value: float) -> str:
    """Three significant digits, without an exponent."""
    if value == 0.0:
        return "0"
    digits = next((n for n, bound in enumerate((100.0, 10.0, 1.0, 0.1)) if abs(value) >= bound), 4)
    return f"{value:,.{digits}f}"


def goal_text(figure: Figure) -> Text:
    if figure.goal is None:
        return Text("")
    aim = f", aim {number(figure.aim)}" if figure.aim is not None else ""
    sign = ("ratio " if figure.of_ratio else "") + ("≤" if figure.at_most else "≥")
    word, style = ("met", "green") if figure.met else ("not met", "yellow")
    return Text.assemble(f"{sign} {number(figure.goal)}{aim} ", (word, style))


def table(topic: str, figures: Iterable[Figure]) -> Table:
    """One topic: figure, value, goal, peer."""
    rows = Table(title=topic, title_justify="left", title_style="bold", box=SIMPLE_HEAD, show_header=True)
    rows.add_column("figure", overflow="fold")
    rows.add_column("median", justify="right", no_wrap=True)
    rows.add_column("unit")
    rows.add_column("goal", no_wrap=True)
    rows.add_column("peer")
    for figure in figures:
        peer = ""
        if figure.peer_value is not None and figure.ratio is not None:
            peer = f"{figure.peer} {number(figure.peer_value)}, ratio {number(figure.ratio)}"
        rows.add_row(figure.name, number(figure.value), figure.unit, goal_text(figure), peer)
    return rows

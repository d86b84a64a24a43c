"""Seed -> input -> call -> verdict: the same for every kind of input.

An input is known by kind, seed and number: each has its own source of random numbers. Where inputs share a state (a
machine that runs on), it is made anew at numbers that are known, and a finding names the first number of its state: the
same inputs from there on come into the same state.
"""

from __future__ import annotations

import gc
import random
import signal
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import click
import psutil

from bench.fuzzing.guard import guarded
from cnc_ptp.catalogue import entry
from cnc_ptp.errors import CncError

LONGEST = 60.0
"""Seconds after which an input counts as one that hangs; the slowest ones take a few."""
MOST_FINDINGS = 20
"""After so many different ones of a kind it ends."""
MARKS = (0.5, 0.75, 1.0)
"""Parts of the inputs after which the memory is looked at."""
LARGEST_GROWTH = 4096
"""KiB by which the memory may grow in the third and again in the fourth quarter of the inputs: what is kept once, as a
cache, grows in one of them, what is lost with each input in both."""
LEAST_JUDGED = 1000
"""Inputs from which on growth is judged: with fewer of them, what is loaded once is seen as growth."""
PACKAGE = "/cnc_ptp/"
SHOWN = 300
"""Characters of an input that are shown."""


class Draw(random.Random):
    """The random numbers of one input, and its number."""

    def __init__(self, kind: str, seed: int, number: int) -> None:
        super().__init__(f"{kind} {seed} {number}")
        self.number = number

    def __new__(cls, kind: str, seed: int, number: int) -> Draw:
        return super().__new__(cls, 0)


Make = Callable[[Draw], Any]
Call = Callable[[Any], None]


def nothing() -> None:
    """There is nothing to close."""


def void(_value: object) -> None:
    """What came out is not looked at."""


class Target(NamedTuple):
    """How an input is made, and what takes it; `close`: at the end.

    `renew` makes the state of which inputs know new: before each input whose number is a multiple of `lasts`, if it is
    not 0. `make` may not depend on that state.
    """

    make: Make
    call: Call
    close: Callable[[], None] = nothing
    renew: Callable[[], None] = nothing
    lasts: int = 0

    def first_of_state(self, number: int, first: int) -> int:
        """Number at which the state of an input began, in a run from `first` on."""
        return max(first, number - number % self.lasts) if self.lasts else number


class Kind(NamedTuple):
    """A kind of input. `prepare` gets a folder for its files; `daily`: inputs of the test."""

    name: str
    prepare: Callable[[Path], Target]
    daily: int


class Finding(NamedTuple):
    """An input that was not taken as documented; `first`: number from which on a run comes to it again."""

    kind: str
    seed: int
    first: int
    number: int
    input: str
    reason: str

    @property
    def place(self) -> str:
        """Findings of one place are probably one defect."""
        return self.reason.partition(": ")[0]

    def __str__(self) -> str:
        again = f"--seed {self.seed} --first {self.first} --count {self.number - self.first + 1}"
        return f"{self.kind} number {self.number}: {self.reason}\n  input: {self.input}\n  again: {self.kind} {again}"


@dataclass
class Verdict:
    """What has become of the inputs of a kind.

    `findings`: one of each place; `growth`: KiB by which the memory in use is larger at the end than after half of the
    inputs, 0 for a run that ended before.
    """

    kind: str
    seed: int
    count: int = 0
    refused: int = 0
    undocumented: int = 0
    findings: list[Finding] = field(default_factory=list)
    slowest: float = 0.0
    slowest_number: int = 0
    growth: int = 0
    seconds: float = 0.0


class Hang(BaseException):
    """An input that does not come to an end."""


class Broken(AssertionError):
    """An invariant that does not hold."""


def attempt(
    kind: Kind, target: Target, seed: int, number: int, folder: Path, *, first: int = 0
) -> tuple[bool, Finding | None]:
    """One input of a run from `first` on: whether it was refused, and what is wrong about how it was taken."""
    given = target.make(Draw(kind.name, seed, number))
    refused, reason = False, ""
    with guarded(folder) as outside:
        try:
            with limited(LONGEST):
                target.call(given)
        except Hang:
            reason = f"no end within {LONGEST:g} s"
        except Exception as error:
            refused, reason = True, objection(error)
    reason = reason or (f"outside of its folder: {', '.join(outside[:3])}" if outside else "")
    begin = target.first_of_state(number, first)
    return refused, Finding(kind.name, seed, begin, number, shown(given), reason) if reason else None


def objection(error: Exception) -> str:
    """Why an exception is no documented refusal; empty if it is one."""
    if isinstance(error, CncError):
        if entry(error.number) is None:
            return f"error {error.number} is in no catalogue: {error}"
        return "" if error.reason.strip() else f"error {error.number} has no text"
    if isinstance(error, (click.ClickException, click.exceptions.Exit, click.Abort)):
        return ""
    return f"{type(error).__name__} at {place_of(error)}: {str(error)[:SHOWN]}"


def place_of(error: BaseException) -> str:
    """The innermost places in this package where it came from."""
    frames = [each for each in traceback.extract_tb(error.__traceback__) if PACKAGE in each.filename]
    return (
        " > ".join(f"{each.filename.partition(PACKAGE)[2]}:{each.lineno}" for each in frames[-3:])
        or "no place of cnc_ptp"
    )


def shown(given: Any) -> str:
    text = repr(given)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]} … ({len(text)} characters)"


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raises Hang in what takes longer. Of the main thread."""

    def end(_number: int, _frame: object) -> None:
        raise Hang

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def run(kind: Kind, seed: int, count: int, folder: Path, *, first: int = 0, seconds: float = 0.0) -> Verdict:
    """`count` inputs from number `first` on, or as many as `seconds` suffice for.

    From LEAST_JUDGED inputs on, a growth of memory by more than LARGEST_GROWTH in each of the last two quarters is a
    finding.
    """
    verdict, memory = Verdict(kind.name, seed), Memory()
    target, begin = kind.prepare(folder), time.monotonic()
    try:
        for number in range(first, first + count):
            if target.lasts and number > first and number % target.lasts == 0:
                target.renew()
            try_one(kind, target, number, first, folder, verdict)
            verdict.seconds = time.monotonic() - begin
            progress = max(verdict.count / count, verdict.seconds / seconds if seconds else 0.0)
            memory.look(progress)
            if progress >= 1.0 or len(verdict.findings) >= MOST_FINDINGS:
                break
    finally:
        target.close()
    verdict.growth = sum(memory.growths)
    if verdict.count >= LEAST_JUDGED and memory.grows:
        verdict.undocumented += 1
        verdict.findings.append(Finding(kind.name, seed, first, number, "all of these", memory.reason))
    return verdict


def try_one(kind: Kind, target: Target, number: int, first: int, folder: Path, verdict: Verdict) -> None:
    """One input, and what becomes of it in the verdict."""
    begin = time.monotonic()
    refused, finding = attempt(kind, target, verdict.seed, number, folder, first=first)
    seconds = time.monotonic() - begin
    verdict.count += 1
    verdict.refused += refused
    if seconds > verdict.slowest:
        verdict.slowest, verdict.slowest_number = seconds, number
    if finding is not None:
        verdict.undocumented += 1
        if finding.place not in {known.place for known in verdict.findings}:
            verdict.findings.append(finding)


class Memory:
    """What the process holds in memory (resident set) at each of MARKS, in KiB."""

    def __init__(self) -> None:
        self._held: list[int] = []
        self._process = psutil.Process()

    def look(self, progress: float) -> None:
        """`progress`: part of the inputs that has been tried, 0 to 1."""
        while len(self._held) < len(MARKS) and progress >= MARKS[len(self._held)]:
            gc.collect()
            self._held.append(self._process.memory_info().rss // 1024)

    @property
    def growths(self) -> list[int]:
        """KiB in the third and in the fourth quarter; empty where a run has ended before."""
        return [later - before for before, later in pairwise(self._held)] if len(self._held) == len(MARKS) else []

    @property
    def grows(self) -> bool:
        return min(self.growths, default=0) > LARGEST_GROWTH

    @property
    def reason(self) -> str:
        third, fourth = self.growths
        grown = f"{third:,} KiB in the third quarter of the inputs and {fourth:,} KiB in the fourth"
        return f"memory grows: {grown}, more than {LARGEST_GROWTH:,} KiB each"

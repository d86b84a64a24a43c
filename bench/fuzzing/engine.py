"""Seed -> input -> call -> verdict: the same for every kind of input.

An input is known by kind, seed and number: each has its own source of random numbers, so that one alone can be tried
again.
"""

from __future__ import annotations

import random
import resource
import signal
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import click

from bench.fuzzing.guard import guarded
from cnc_ptp.catalogue import entry
from cnc_ptp.errors import CncError

LONGEST = 60.0
"""Seconds after which an input counts as one that hangs; the slowest ones take a few."""
MOST_FINDINGS = 20
"""After so many different ones of a kind it ends."""
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


class Target(NamedTuple):
    """How an input is made, and what takes it; `close`: at the end."""

    make: Make
    call: Call
    close: Callable[[], None] = nothing


class Kind(NamedTuple):
    """A kind of input. `prepare` gets a folder for its files; `daily`: inputs of the test."""

    name: str
    prepare: Callable[[Path], Target]
    daily: int


class Finding(NamedTuple):
    """An input that was not taken as documented."""

    kind: str
    seed: int
    number: int
    input: str
    reason: str

    @property
    def place(self) -> str:
        """Findings of one place are probably one defect."""
        return self.reason.partition(": ")[0]

    def __str__(self) -> str:
        return f"{self.kind} seed {self.seed} number {self.number}: {self.reason}\n  input: {self.input}"


@dataclass
class Verdict:
    """What has become of the inputs of a kind.

    `findings`: one of each place; `growth`: KiB in the second half of the inputs.
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


def attempt(kind: Kind, target: Target, seed: int, number: int, folder: Path) -> tuple[bool, Finding | None]:
    """One input: whether it was refused, and what is wrong about how it was taken."""
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
    return refused, Finding(kind.name, seed, number, shown(given), reason) if reason else None


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
    """`count` inputs from number `first` on, or as many as `seconds` suffice for."""
    verdict, half = Verdict(kind.name, seed), 0
    target, begin = kind.prepare(folder), time.monotonic()
    last = begin
    for number in range(first, first + count):
        refused, finding = attempt(kind, target, seed, number, folder)
        now = time.monotonic()
        verdict.count += 1
        verdict.refused += refused
        if now - last > verdict.slowest:
            verdict.slowest, verdict.slowest_number = now - last, number
        last = now
        if finding is not None:
            verdict.undocumented += 1
            if finding.place not in {known.place for known in verdict.findings}:
                verdict.findings.append(finding)
        over_half = verdict.count >= count / 2 or (seconds and now - begin > seconds / 2)
        half = half or (over_half and largest_memory()) or 0
        if len(verdict.findings) >= MOST_FINDINGS or (seconds and now - begin > seconds):
            break
    target.close()
    verdict.growth, verdict.seconds = largest_memory() - (half or largest_memory()), time.monotonic() - begin
    return verdict


def largest_memory() -> int:
    """KiB that the process has had at most."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

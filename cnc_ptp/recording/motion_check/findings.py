"""What the checker has found: violations, and what may look like one but was told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

Numbers = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Cycles = npt.NDArray[np.int64]
MOST = 20
"""Violations of one kind and unit that are listed; the others are counted."""


@dataclass(frozen=True, slots=True)
class Violation:
    """Neighbouring cycles in which the same is wrong; `value` and `limit` are those of the worst of them.

    `cycle` is the first of `cycles` of them, `time` its time in s, `units` of value and limit.
    """

    unit: str
    what: str
    cycle: int
    time: float
    cycles: int
    value: float
    limit: float
    units: str

    def __str__(self) -> str:
        last = f"-{self.cycle + self.cycles - 1}" if self.cycles > 1 else ""
        numbers = f"{self.value:.9g} {self.units}, limit {self.limit:.9g} {self.units}".replace(" ,", ",").rstrip()
        return f"{self.unit} cycle {self.cycle}{last} ({self.time:.4f} s): {self.what} {numbers}"


@dataclass(slots=True)
class MotionResult:
    """Result of a check. `told`: limits exceeded by a command that says so, at most MOST of one kind and unit.

    `units`: those that were checked; `cycles`: of all of them. `further`: violations beyond those that are listed.
    """

    path: str
    units: list[str] = field(default_factory=list)
    cycles: int = 0
    violations: list[Violation] = field(default_factory=list)
    told: list[Violation] = field(default_factory=list)
    further: int = 0

    @property
    def clean(self) -> bool:
        return not self.violations

    def text(self) -> str:
        """One line if all is well, otherwise one for each violation."""
        checked = f"{self.cycles} cycles of {len(self.units)} units"
        if self.clean:
            return f"{self.path}: motion of {checked}: no violation"
        lines = [f"{self.path}: {len(self.violations) + self.further} violations in {checked}"]
        lines += [str(violation) for violation in self.violations]
        return "\n".join([*lines, f"{self.further} further violations"] if self.further else lines)

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self) | {"clean": self.clean}


class Findings:
    """Collects violations of one unit."""

    def __init__(self, unit: str, cycles: Cycles, cycle_time: float, result: MotionResult) -> None:
        self._unit, self._cycles, self._cycle_time, self._result = unit, cycles, cycle_time, result

    def above(
        self, what: str, values: Numbers, limits: Numbers, wrong: Mask, units: str, *, told: bool = False
    ) -> None:
        """Rows (n,) in which `wrong` is true, those of neighbouring cycles together."""
        places = np.flatnonzero(wrong)
        if not len(places):
            return
        apart = np.flatnonzero(np.diff(self._cycles[places]) != 1) + 1
        runs: Sequence[npt.NDArray[np.intp]] = np.split(places, apart)
        target = self._result.told if told else self._result.violations
        for run in runs[:MOST]:
            target.append(self._violation(what, values, limits, run, units))
        if not told:
            self._result.further += max(0, len(runs) - MOST)

    def _violation(
        self, what: str, values: Numbers, limits: Numbers, run: npt.NDArray[np.intp], units: str
    ) -> Violation:
        excess = np.abs(values[run]) - np.abs(limits[run])
        worst = run[int(np.argmax(np.where(np.isnan(excess), np.inf, excess)))]
        cycle = int(self._cycles[run[0]])
        time = cycle * self._cycle_time
        value, limit = float(values[worst]), float(limits[worst])
        return Violation(self._unit, what, cycle, time, len(run), value, limit, units)

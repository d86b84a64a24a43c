"""Results of a circle test, and their texts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from cnc_ptp.commands.console import WarningLine
from cnc_ptp.commissioning.roundness import CircleResult

UM = 1000.0
"""µm a mm."""
FEED_TOLERANCE = 0.01
NOTHING = 5e-6
"""mm; less is shown as 0.00 µm."""
OFF_AND_ON = {False: "without", True: "with"}
MAGNIFICATIONS = (1.0, 2.0, 5.0)


@dataclass(frozen=True, slots=True)
class Variant:
    """Switched functions: feedforward (G135, G137) and friction compensation (None: as the machine has it)."""

    feedforward: bool
    friction: bool | None

    @property
    def name(self) -> str:
        words = [f"{OFF_AND_ON[self.feedforward]} feedforward"]
        if self.friction is not None:
            words.append(f"{OFF_AND_ON[self.friction]} friction compensation")
        return ", ".join(words)

    def blocks(self, axes: Iterable[str]) -> list[str]:
        """The program words that switch it; `axes` are those with friction compensation."""
        blocks = ["G135" if self.feedforward else "G137"]
        if self.friction is not None:
            blocks += [f"{axis}[COMP {'ON' if self.friction else 'OFF'} FRICT]" for axis in axes]
        return blocks


@dataclass(frozen=True, slots=True)
class VariantResult:
    """Circles of one variant by direction, G(b) in mm, and the lowest feed while measuring in mm/min."""

    variant: Variant
    circles: tuple[CircleResult, ...]
    bidirectional: float
    lowest_feed: float

    @property
    def largest_peak(self) -> float:
        """mm"""
        return max(circle.largest_peak for circle in self.circles)


@dataclass(frozen=True, slots=True)
class CircleTest:
    """All of it: axes of the plane, centre and radius in mm, feed in mm/min."""

    axes: tuple[str, str]
    centre: tuple[float, float]
    radius: float
    feed: float
    results: tuple[VariantResult, ...]
    uncompensated: tuple[str, ...] = ()
    """Axes without friction compensation."""

    @property
    def title(self) -> str:
        first, second = self.axes
        place = f"{first} {self.centre[0]:g} {second} {self.centre[1]:g}"
        return f"Circle test {first}{second}, R {self.radius:g} mm about {place}, F {self.feed:g} mm/min"


def direction_name(circle: CircleResult) -> str:
    return "cw" if circle.clockwise else "ccw"


def magnification_for(test: CircleTest) -> float:
    """The largest of 1, 2, 5, 10 … with which no deviation is drawn longer than a third of the radius."""
    largest = max(
        max(abs(circle.radial_low), abs(circle.radial_high)) for result in test.results for circle in result.circles
    )
    fits = test.radius / 3.0 / max(largest, 1e-9 * test.radius)
    decade = 10.0 ** math.floor(math.log10(fits))
    return max(step * decade for step in MAGNIFICATIONS if step * decade <= fits)


def circle_lines(test: CircleTest) -> Iterator[str]:
    """The table: lengths in µm."""
    yield test.title
    yield (
        "in µm. G: circular deviation (ISO 230-4, minimum zone), F: radial deviation about the least squares centre, "
        "G(b): both directions"
    )
    width = max(len(result.variant.name) for result in test.results) + 2
    peaks = "".join(f"{f'peak {angle}°':>11}" for angle in (0, 90, 180, 270))
    yield f"{'':{width}}{'':5}{'G':>9}{'F least':>10}{'F most':>10}{peaks}{'G(b)':>9}"
    for result in test.results:
        for number, circle in enumerate(result.circles):
            name = result.variant.name if number == 0 else ""
            values = (
                f"{UM * circle.circular_deviation:9.2f}{UM * circle.radial_low:10.2f}{UM * circle.radial_high:10.2f}"
            )
            heights = "".join(f"{UM * peak.height:11.2f}" for peak in circle.peaks)
            both = f"{UM * result.bidirectional:9.2f}" if number == 0 and len(result.circles) > 1 else ""
            yield f"{name:{width}}{direction_name(circle):5}{values}{heights}{both}".rstrip()
    yield from comparison_lines(test)
    yield from warning_lines(test)


def comparison_lines(test: CircleTest) -> Iterator[str]:
    """The first variant against the last one."""
    if len(test.results) < 2:
        return
    first, last = test.results[0], test.results[-1]
    yield f"{last.variant.name}, against {first.variant.name}:"
    for name, before, after in (
        ("G", max(c.circular_deviation for c in first.circles), max(c.circular_deviation for c in last.circles)),
        ("largest |F|", max(map(_largest, first.circles)), max(map(_largest, last.circles))),
        ("largest peak", first.largest_peak, last.largest_peak),
    ):
        yield f"  {name:14}{UM * before:9.2f} -> {UM * after:.2f} µm, {_change(before, after)}"


def _change(before: float, after: float) -> str:
    """Ratio of the larger to the smaller and its direction; a zero has no ratio."""
    small, large = sorted((before, after))
    if large == small or large < NOTHING or (small >= NOTHING and round(large / small, 1) == 1.0):
        return "as large"
    if small < NOTHING:
        return "practically zero" if after < before else "from practically zero"
    ratio = large / small
    return f"{ratio:.1f} times {'smaller' if after < before else 'larger'}"


def _largest(circle: CircleResult) -> float:
    return max(abs(circle.radial_low), abs(circle.radial_high))


def warning_lines(test: CircleTest) -> Iterator[str]:
    """The feed that was not reached, friction compensation that an axis does not have."""
    lowest = min(result.lowest_feed for result in test.results)
    if lowest < (1.0 - FEED_TOLERANCE) * test.feed:
        yield WarningLine(
            f"the feed of {test.feed:g} mm/min was not reached everywhere, the lowest is {lowest:.0f} "
            "mm/min; the axes' acceleration is too small for this radius"
        )
    if test.uncompensated and any(result.variant.friction for result in test.results):
        yield WarningLine(
            f"axis {', '.join(test.uncompensated)} has no friction compensation, it needs lr_param.frict_comp "
            "(P-AXIS-00522) and a table; only the other axis was switched"
        )

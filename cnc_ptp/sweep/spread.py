"""What follows the equals sign of --vary: values, an interval, a distribution."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.changed import read_value
from cnc_ptp.sweep.faults import BAD_VARIATION, NOTHING

Scalar = bool | int | float | str
FORMS = "a:b:n, log:a:b:n, a,b,c, a:b, uniform:a:b, log:a:b or normal:mean:sigma"
MOST_VALUES = 10**5


@dataclass(frozen=True, slots=True)
class Values:
    """Values one by one; `stepped`: computed between two limits, so that integer parameters round them."""

    values: tuple[Scalar, ...]
    stepped: bool = False


@dataclass(frozen=True, slots=True)
class Interval:
    """All values between two limits, evenly, or evenly in their logarithm."""

    low: float
    high: float
    log: bool = False


@dataclass(frozen=True, slots=True)
class Normal:
    """A normal distribution."""

    mean: float
    sigma: float


Spread = Values | Interval | Normal


def read_spread(text: str) -> Spread:
    """The spread that a text describes in one of FORMS. Raises CncError 26177."""
    kind, *numbers = text.split(":")
    if not numbers:
        return Values(tuple(scalar(item) for item in text.split(",")))
    if kind == "normal" and len(numbers) == 2:
        return normal(text, *read_numbers(text, numbers))
    if kind == "uniform" and len(numbers) == 2:
        return interval(text, *read_numbers(text, numbers))
    log = kind == "log"
    limits = numbers if log else [kind, *numbers]
    if len(limits) == 2:
        return interval(text, *read_numbers(text, limits), log=log)
    if len(limits) == 3:
        return steps(text, *read_numbers(text, limits[:2]), read_count(text, limits[2]), log=log)
    raise bad(text, f"is none of {FORMS}")


def scalar(text: str) -> Scalar:
    """A number, true or false, or text, as a machine file would have it."""
    value = read_value(text)
    if isinstance(value, (bool, int, float, str)):
        return value
    raise bad(text, "has a value that is neither number nor text" if text.strip() else "has an empty value")


def read_numbers(text: str, parts: Sequence[str]) -> tuple[float, float]:
    low, high = (read_number(text, part) for part in parts)
    return low, high


def read_number(text: str, part: str) -> float:
    try:
        number = float(part)
    except ValueError:
        raise bad(text, f"has {part!r} where a number is expected; a range is one of {FORMS}") from None
    if not math.isfinite(number):
        raise bad(text, f"has {part!r}, which is not finite")
    return number


def read_count(text: str, part: str) -> int:
    if not (part.isascii() and part.isdecimal()):
        raise bad(text, f"has {part!r} where the number of values is expected")
    count = int(part) if len(part) < 10 else MOST_VALUES + 1
    if not 1 <= count <= MOST_VALUES:
        raise bad(text, f"is empty: {part} values" if not count else f"has {part} values, more than {MOST_VALUES}")
    return count


def interval(text: str, low: float, high: float, *, log: bool = False) -> Interval:
    if low >= high:
        raise bad(text, f"is empty: {low:g} is not below {high:g}")
    if log and low <= 0.0:
        raise bad(text, f"has a logarithm of {low:g}, which is not above 0")
    return Interval(low, high, log)


def normal(text: str, mean: float, sigma: float) -> Normal:
    if sigma <= 0.0:
        raise bad(text, f"is empty: sigma {sigma:g} is not above 0")
    return Normal(mean, sigma)


def steps(text: str, first: float, last: float, count: int, *, log: bool) -> Values:
    """`count` values from `first` to `last`; whole numbers stay whole."""
    if log and min(first, last) <= 0.0:
        raise bad(text, f"has a logarithm of {min(first, last):g}, which is not above 0")
    if (first == last) != (count == 1):
        raise bad(text, f"has {count} values from {first:g} to {last:g}, which do not differ by the same step")
    spaced = np.geomspace if log else np.linspace
    return Values(tuple(spaced(first, last, count).tolist()), stepped=True)


def bad(text: str, reason: str) -> CncError:
    return CncError(BAD_VARIATION, f"range '{text}' {reason}", NOTHING, where="--vary")

"""Units of the parameter lists against the units of the kernel (mm, °, s and their derivatives, ratios without unit).

Every factor is the reciprocal of an integer, and list values are divided by that integer: the result is the float
nearest to the exact one.
"""

DEG_S_PER_RPM = 6.0
"""Speeds of spindles are rpm for people, °/s in the kernel."""
LARGEST_POSITION = 214748.3647
"""°: a position of the lists, 32 bits of 0.0001°."""
DIVISORS: dict[str, int] = {
    "0.1 µm": 10_000,
    "0.0001°": 10_000,
    "0.1 µm or 0.0001°": 10_000,
    "µm": 1_000,
    "0.001°": 1_000,
    "µm/s": 1_000,
    "0.001°/s": 1_000,
    "0.01/s": 100,
    "0.1 %": 1_000,
    "µs": 1_000_000,
    "ms": 1_000,
}

SHOWN_UNITS: dict[str, tuple[str, int]] = {
    "0.1 µm": ("mm", 10_000),
    "0.0001°": ("°", 10_000),
    "0.1 µm or 0.0001°": ("mm or °", 10_000),
    "µm": ("mm", 1_000),
    "0.001°": ("°", 1_000),
    "µm/s": ("mm/s", 1_000),
    "0.001°/s": ("°/s", 1_000),
    "0.01/s": ("1/s", 100),
    "0.1 %": ("%", 10),
    "µs": ("s", 1_000_000),
    "ms": ("s", 1_000),
}
"""Unit of the lists -> the unit in which people think of it, and how many of the first are one of the second."""


def to_kernel(value: float, unit: str) -> float:
    """`value` in list units -> kernel units: 5000 (0.01/s) -> 50.0 1/s. Kernel units stay unchanged."""
    return value / DIVISORS.get(unit, 1)

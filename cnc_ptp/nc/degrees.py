"""Sine and cosine of angles in degrees."""

import math
from typing import Final


def sine(degrees: float) -> float:
    """Exact at the multiples of 30° where it is 0, ±1/2, ±1."""
    turned = math.fmod(degrees, 360.0)
    exact = EXACT_SINES.get(turned + 360.0 if turned < 0.0 else turned)
    return math.sin(math.radians(turned)) if exact is None else exact


EXACT_SINES: Final = {0.0: 0.0, 30.0: 0.5, 90.0: 1.0, 150.0: 0.5, 180.0: 0.0, 210.0: -0.5, 270.0: -1.0, 330.0: -0.5}


def cosine(degrees: float) -> float:
    """Exact where the sine is: cos a = sin (90° - |a|)."""
    return sine(90.0 - math.fmod(abs(degrees), 360.0))

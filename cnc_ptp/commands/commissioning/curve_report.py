"""Output of `cnc_ptp curve fit`: coefficients, a table of the points, and the lines of the machine file."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

import numpy as np

from cnc_ptp.commands.console import WarningLine
from cnc_ptp.commissioning.curve_fit import CurveFit
from cnc_ptp.commissioning.curve_points import SPEED_UNITS
from cnc_ptp.commissioning.trace import Array
from cnc_ptp.parameters.view.spindle_view import CURVE_TYPES
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve
from cnc_ptp.spindle.speed_ramp import plan_speed

RPM = SPEED_UNITS["rpm"]
TYPES = {kind: number for number, kind in CURVE_TYPES.items()}
LAWS = {
    "polynomial": "a = a_konst + b1·Δn + b2·Δn² + b3·Δn³ with Δn = n - n_grenz",
    "hyperbola": "a = b1 / (1 + b2·x²·(1 + b3·x²)) with x = n / n_grenz",
}
UNITS = {"polynomial": ("1/s", "1/°", "s/°²"), "hyperbola": ("°/s²", "", "")}
"""Of b1, b2, b3."""
LARGE_MISS = 0.05
"""Over the acceleration of the point."""
DIGITS = 12
"""Of the coefficients, fewer than the rounding of a fit leaves."""
DRAWN = 400
"""Places of a drawn curve above the limit speed."""


def title(fit: CurveFit) -> str:
    count = len(fit.points) - fit.limit_index
    method = f"through {count} points" if fit.exact else f"least squares over {count} points"
    return f"Acceleration curve: {fit.parameters.kind} {method}"


def curve_lines(fit: CurveFit, *, usable: bool) -> Iterator[str]:
    """Title, coefficients, points; run-up of a spindle if one can run on the curve."""
    parameters = fit.parameters
    yield title(fit)
    yield LAWS[parameters.kind]
    yield f"n_grenz  {parameters.limit_speed:.10g} °/s ({parameters.limit_speed / RPM:.7g} rpm)"
    yield f"a_konst  {parameters.constant:.10g} °/s²"
    coefficients = (parameters.b1, parameters.b2, parameters.b3)
    for number, (value, unit) in enumerate(zip(coefficients, UNITS[parameters.kind], strict=True), start=1):
        yield f"b{number}       {value:.{DIGITS}g} {unit}".rstrip()
    yield from point_lines(fit)
    if usable:
        top = fit.top_speed
        yield f"up to {top:.7g} °/s ({top / RPM:.7g} rpm) the acceleration falls to {fit.acceleration(top):.6g} °/s²"
        yield f"from 0 to {top:.7g} °/s in {run_up_time(fit):.3f} s"
    yield from warning_lines(fit)


def point_lines(fit: CurveFit) -> Iterator[str]:
    """Given points against the curve without floor."""
    heads = ("n °/s", "n rpm", "point °/s²", "curve °/s²", "off °/s²", "off %")
    yield "".join(f"{head:>12}" for head in heads)
    for number, (point, miss) in enumerate(zip(fit.points, fit.misses(), strict=True)):
        off = round(miss, 3) + 0.0  # no -0.000
        percent = round(100.0 * miss / point.acceleration, 2) + 0.0
        speeds = f"{point.speed:12.7g}{point.speed / RPM:12.7g}"
        remark = "  below n_grenz, not fitted" if number < fit.limit_index else ""
        yield f"{speeds}{point.acceleration:12.7g}{point.acceleration + miss:12.3f}{off:12.3f}{percent:12.2f}{remark}"


def run_up_time(fit: CurveFit) -> float:
    """Seconds from standstill to the largest speed, as the spindle computes it."""
    curve = AccelerationCurve(fit.parameters, top_speed=fit.top_speed)
    return plan_speed(0.0, 0.0, fit.top_speed, curve).duration


def warning_lines(fit: CurveFit) -> Iterator[str]:
    """Warnings about the fit."""
    for point, miss in zip(fit.points, fit.misses(), strict=True):
        if abs(miss) > LARGE_MISS * point.acceleration:
            percent = 100.0 * miss / point.acceleration
            yield WarningLine(f"the curve lies {percent:+.1f} % off the point at {point.speed:g} °/s")
    minimum, last = fit.parameters.minimum, fit.points[-1]
    for point in fit.points:
        if point.acceleration < minimum:
            yield WarningLine(
                f"a_min {minimum:g} °/s² (P-AXIS-00010) is above the point at {point.speed:g} °/s, the drive "
                f"has {point.acceleration:g} °/s² there"
            )
    if fit.top_speed > last.speed:
        yield WarningLine(f"no point lies between {last.speed:g} °/s and the largest speed {fit.top_speed:g} °/s")


def rounded(value: float) -> float:
    """To DIGITS significant digits: the same on every computer."""
    return float(f"{value:.{DIGITS}g}")


def curve_yaml(fit: CurveFit, spindle: str, gear: int) -> str:
    """The lines to paste into the machine file, in the units of the parameters."""
    parameters, (unit_1, unit_2, unit_3) = fit.parameters, UNITS[fit.parameters.kind]
    rows = (
        ("typ", TYPES[parameters.kind], parameters.kind, "00202"),
        ("n_grenz", round(1000.0 * parameters.limit_speed), "0.001 °/s", "00130"),
        ("a_konst", round(parameters.constant), "°/s²", "00007"),
        ("a_min", round(parameters.minimum), "°/s²", "00010"),
        ("b1", rounded(parameters.b1), unit_1, "00026"),
        ("b2", rounded(parameters.b2), unit_2, "00027"),
        ("b3", rounded(parameters.b3), unit_3, "00028"),
    )
    lines = [
        f"# {title(fit)}; spindle {spindle}, gear {gear}.",
        f"/{spindle}:",
        "  ros__parameters:",
        "    getriebe:",
        f'      "{gear}":',
        "        beschl_kennlinie:",
    ]
    for name, value, unit, number in rows:
        lines.append(f"          {name}: {value}  # P-AXIS-{number} {unit}".rstrip())
    return "\n".join([*lines, ""])


# ---------------------------------------------------------------- drawn curve


def drawn_curve(fit: CurveFit) -> tuple[Array, Array]:
    """Speeds and accelerations of the curve with its floor; nan next to a pole."""
    speeds = np.linspace(fit.parameters.limit_speed, fit.top_speed, DRAWN)
    accelerations = [fit.acceleration(speed) for speed in speeds]
    highest = 2.0 * max(fit.parameters.constant, *(point.acceleration for point in fit.points))
    shown = np.array([value if -inf < value <= highest else np.nan for value in accelerations])
    return np.concatenate([[0.0], speeds]), np.concatenate([[fit.parameters.constant], shown])

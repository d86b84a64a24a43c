"""Output of `cnc_ptp identify friction`: a table for people, and the lines of the machine file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cnc_ptp.commands.commissioning.axis_data import AxisData
from cnc_ptp.commands.console import WarningLine
from cnc_ptp.commissioning.friction import FrictionCurve, FrictionPoint
from cnc_ptp.commissioning.friction_table import MODE, FrictionTable, Scaling
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.view.control_view import friction_table_size

LARGE_SCATTER = 0.03
"""Scatter over friction that is warned about."""


def scaling_of(data: AxisData) -> Scaling:
    """How the drive counts torque (P-AXIS-00325, 00326, 00392)."""
    numbers = (ids.ANTR_TORQUE_SCALE_NUM, ids.ANTR_TORQUE_SCALE_DENOM, ids.ANTR_ACC_REFERENCE_VALUE)
    return Scaling(*(float(data.raw.number(number)) for number in numbers))


def curve_lines(data: AxisData, curve: FrictionCurve) -> Iterator[str]:
    """The points as a table of text."""
    effort = data.effort
    efforts = (f"M(+v) {effort}", f"M(-v) {effort}", f"friction {effort}", "scatter", f"load {effort}")
    heads = (f"v {data.unit}/s", *efforts, "time s")
    yield "".join(f"{head:>13}" for head in heads)
    for point in curve.points:
        torques = "".join(f"{value:13.4f}" for value in (point.positive, point.negative, point.friction))
        load = round(point.load, 4) + 0.0  # no -0.0000
        yield f"{point.speed:13.4g}{torques}{point.scatter:13.1e}{load:13.4f}{point.seconds:13.2f}"
    yield from _remarks(data, curve)


def _remarks(data: AxisData, curve: FrictionCurve) -> Iterator[str]:
    if curve.one_way:
        yield f"left out, driven in one direction only: {speeds_shown(curve.one_way)} {data.unit}/s"
    if curve.uneven:
        yield f"left out, uneven motion (stick-slip, or not settled): {speeds_shown(curve.uneven)} {data.unit}/s"
    if curve.standing:
        reason = "the torque does not come above the friction (torque limit?)"
        yield f"left out, the axis does not move: {speeds_shown(curve.standing)} {data.unit}/s; {reason}"
    doubt = doubtful(data, curve)
    if doubt is not None:
        yield WarningLine(doubt)


def doubtful(data: AxisData, curve: FrictionCurve) -> str | None:
    """The speeds with a large scatter, and why; None if there are none."""
    points = [point for point in curve.points if point.scatter > LARGE_SCATTER * abs(point.friction)]
    if not points:
        return None
    speeds = [point.speed for point in points]
    where = (
        f"axis {data.axis.name}: scatter above {100.0 * LARGE_SCATTER:g} % of the friction at {speeds_shown(speeds)}"
    )
    if all(data.half_digit <= LARGE_SCATTER * abs(point.friction) for point in points):
        return f"{where} {data.unit}/s; measure longer, or without disturbances"
    return (
        f"{where} {data.unit}/s; half a digit of the torque, which counts as scatter, is {data.half_digit:.3g} "
        f"{data.effort} there: more digits per {data.effort} in drive and P-AXIS-00325, 00326, 00392"
    )


def speeds_shown(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.4g}" for value in values)


def friction_yaml(data: AxisData, curve: FrictionCurve, table: FrictionTable, source: str) -> str:
    """The lines to paste into the machine file; all else is unchanged."""
    raw, effort = data.raw, data.effort
    scaling = scaling_of(data)
    unit = "0.001 deg/s" if data.axis.rotary else "µm/s"
    digits = f"{scaling.numerator:g}/{scaling.denominator:g} digits are {scaling.reference:g} {effort}"
    doubt = doubtful(data, curve)
    lines = [
        f"# Friction of axis {data.axis.name}, {source}.",
        "# Replaces lr_param.frict_comp and frict_comp. Behind each entry: velocity, mean of both directions, scatter.",
        f"# in: {unit}, out: {digits} (P-AXIS-00325, 00326, 00392), times scaling_factor / 1000.",
        *([f"# warning: {doubt}"] if doubt is not None else []),
        f"/{data.axis.name}:",
        "  ros__parameters:",
        "    lr_param: {frict_comp: 1}",
        "    frict_comp:",
        f"      mode: {MODE}",
        f"      max_points: {friction_table_size(data.raw)}",
        f"      table_entries: {len(table.entries)}",
        f"      position_delay: {raw.number(ids.FRICT_COMP_POSITION_DELAY)}  # unchanged",
        f"      reversal_lookahead: {raw.number(ids.FRICT_COMP_REVERSAL_LOOKAHEAD)}  # unchanged",
        f"      delay_cycles: {raw.number(ids.FRICT_COMP_DELAY_CYCLES)}  # unchanged",
        f"      scaling_factor: {table.scaling_factor}",
        "      table:",
    ]
    for index, entry in enumerate(table.entries):
        lines.append(f'        "{index}": {{in: {entry.velocity}, out: {entry.current}}}  # {_note(data, entry.point)}')
    return "\n".join([*lines, ""])


def _note(data: AxisData, point: FrictionPoint) -> str:
    return f"{point.speed:.4g} {data.unit}/s: {point.friction:.4g} {data.effort} ± {point.scatter:.2g}"

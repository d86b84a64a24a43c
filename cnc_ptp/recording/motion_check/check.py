"""Checks the motion of a whole recording."""

from __future__ import annotations

from math import inf
from pathlib import Path

from cnc_ptp.recording.motion_check.axis_check import AxisCheck
from cnc_ptp.recording.motion_check.findings import MotionResult
from cnc_ptp.recording.motion_check.inputs import MotionInputs, Order, read_inputs
from cnc_ptp.recording.motion_check.spindle_check import SpindleCheck
from cnc_ptp.recording.opened import OpenRecording


def check_recording(path: str | Path) -> MotionResult:
    """Every axis and spindle of a recording, or of a folder of its parts.

    Raises CncError as OpenRecording does; 26017 for a file of another program, 26262 without setpoints, 26263 without
    parameters, 26264 where fields are missing.
    """
    with OpenRecording(path) as recording:
        return check_motion(read_inputs(recording), str(path))


def check_motion(inputs: MotionInputs, path: str = "") -> MotionResult:
    """Every axis and spindle of a run; violations in the order of time."""
    result = MotionResult(path)
    for name, columns in inputs.axes.items():
        _count(result, name, len(columns["cycle"]))
        AxisCheck(name, inputs, steps_from=steps_from(inputs, name), result=result).check()
    for name, columns in inputs.spindles.items():
        _count(result, name, len(columns["cycle"]))
        SpindleCheck(name, inputs, result).check()
    result.violations.sort(key=lambda violation: (violation.cycle, violation.unit))
    result.told.sort(key=lambda violation: (violation.cycle, violation.unit))
    return result


def _count(result: MotionResult, name: str, cycles: int) -> None:
    result.units.append(name)
    result.cycles += cycles


def steps_from(inputs: MotionInputs, axis: str) -> float:
    """Cycle from which on a path of the axis may step its acceleration, inf for never.

    Its channel always does, or from a text with #SLOPE on; one that was begun before the recording may, too.
    """
    cycles = inputs.axes[axis]["cycle"]
    channels = [each for each in inputs.machine.channels.values() if axis in (own.node for own in each.axes)]
    if (len(cycles) and cycles[0] > 0) or any(channel.slope == "STEP" for channel in channels):
        return 0.0
    orders = [order for channel in channels for order in inputs.orders_of(channel.name)]
    return min((order.cycle for order in orders if "#SLOPE" in program_of(order).upper()), default=inf)


def program_of(order: Order) -> str:
    """All texts that a channel gets with a command."""
    files = order.arguments.get("files") or {}
    return "\n".join(text for text in (order.arguments.get("text"), *files.values()) if isinstance(text, str))

"""Checks the motion of a whole recording."""

from __future__ import annotations

from pathlib import Path

from cnc_ptp.recording.motion_check.axis_check import AxisCheck
from cnc_ptp.recording.motion_check.findings import MotionResult
from cnc_ptp.recording.motion_check.inputs import MotionInputs, read_inputs
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
    steps = path_steps(inputs)
    for name, columns in inputs.axes.items():
        _count(result, name, len(columns["cycle"]))
        AxisCheck(name, inputs, steps=steps, result=result).check()
    for name, columns in inputs.spindles.items():
        _count(result, name, len(columns["cycle"]))
        SpindleCheck(name, inputs, result).check()
    result.violations.sort(key=lambda violation: (violation.cycle, violation.unit))
    result.told.sort(key=lambda violation: (violation.cycle, violation.unit))
    return result


def _count(result: MotionResult, name: str, cycles: int) -> None:
    result.units.append(name)
    result.cycles += cycles


def path_steps(inputs: MotionInputs) -> bool:
    """A channel has, or a program selects, a path whose acceleration steps; one begun before the recording may, too."""
    late = any(len(columns["cycle"]) and columns["cycle"][0] > 0 for columns in inputs.axes.values())
    if late or any(channel.slope == "STEP" for channel in inputs.machine.channels.values()):
        return True
    texts = [
        str(order.arguments)
        for name in inputs.machine.channels
        for order in inputs.orders_of(name)
        if order.command in ("load", "mdi")
    ]
    return any("#SLOPE" in text.upper() for text in texts)

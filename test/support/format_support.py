"""Axes and spindles from machine files, for tests of drive formats."""

from __future__ import annotations

from cnc_ptp.control.drive_format import DriveFormat, drive_format
from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.view.control_view import ControlParameters, control_view

DA_FULL_SCALE = 32767
DA_VOLTS = 10.0


def da_volts(word: int) -> float:
    """Output voltage of a DA word, V: 32767 is 10 V; the word -32768 gives -10 V too."""
    return max(-DA_VOLTS, word * DA_VOLTS / DA_FULL_SCALE)


def control_of(*lines: str, spindle: bool = False, gear: int = 0, cycle_time_us: int = 1000) -> ControlParameters:
    """What the drive of an axis (or spindle) with these parameter lines is controlled by."""
    kind = "spindles" if spindle else "axes"
    text = f"/machine: {{ros__parameters: {{{kind}: [u], cycle_time_us: {cycle_time_us}}}}}\n"
    text += "/u:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in lines or ("kopf.achs_nr: 1",))
    machine = load_machine(text, "m.yaml")
    return control_view(machine.raw("u"), gear, cycle_time_us / 1e6)


def format_of(*lines: str, spindle: bool = False, gear: int = 0, cycle_time_us: int = 1000) -> DriveFormat:
    control = control_of(*lines, spindle=spindle, gear=gear, cycle_time_us=cycle_time_us)
    return drive_format(control.scaling, control.drive)

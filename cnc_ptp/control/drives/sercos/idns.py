"""The parameters of a SERCOS drive (identification numbers, IDN) that the simulated one has.

Numbers, meanings and bits: public documentation of SERCOS drives (AX2000, AX5000, IndraDrive).
"""

from __future__ import annotations

import re
from typing import NamedTuple

from cnc_ptp.control.drive_format import Digits
from cnc_ptp.parameters.view.sercos_view import SercosParameters

VELOCITY_FEEDBACK = "S-0-0040"
HOMING_VELOCITY = "S-0-0041"
HOMING_ACCELERATION = "S-0-0042"
VELOCITY_SCALING = "S-0-0044"
VELOCITY_FACTOR = "S-0-0045"
VELOCITY_EXPONENT = "S-0-0046"
POSITION_COMMAND = "S-0-0047"
POSITION_FEEDBACK = "S-0-0051"
REFERENCE_DISTANCE = "S-0-0052"
POSITION_WINDOW = "S-0-0057"
POSITION_SCALING = "S-0-0076"
DIAGNOSIS = "S-0-0095"
OVERRIDE = "S-0-0108"
STANDSTILL_WINDOW = "S-0-0124"
HOMING_PARAMETER = "S-0-0147"
HOMING = "S-0-0148"
ACCELERATION_SCALING = "S-0-0160"
JERK = "S-0-0349"
HOME_SWITCH = "S-0-0400"
FEEDBACK_STATUS = "S-0-0403"

LARGEST = 2**31 - 1
PARAMETER_SCALING = 0x08
"""Bit of S-0-0044."""
LINEAR, ROTATIONAL, AT_THE_LOAD = 0x01, 0x02, 0x40
"""Bits of S-0-0044, 0076 and 0160."""
NEGATIVE, SWITCH_AT_DRIVE, WITHOUT_SWITCH, WITHOUT_MARKER, AT_REFERENCE = 0x01, 0x04, 0x20, 0x40, 0x80
"""Bits of S-0-0147: direction, where the home switch is connected, what does not count, where the drive stops."""
HOMING_BITS = NEGATIVE | SWITCH_AT_DRIVE | WITHOUT_SWITCH | WITHOUT_MARKER | AT_REFERENCE
REFERENCED = 0x03
"""S-0-0403: bit 0 for the feedback in use, bit 1 for that of the motor."""
SET, SET_AND_ENABLE = 1, 3
"""What a master writes to a procedure command; 0 cancels it."""


class Idn(NamedTuple):
    """One parameter. `low` … `high` for what a master may write; None: read only."""

    name: str
    text: str
    low: int | None = None
    high: int = LARGEST


IDNS = {
    idn.name: idn
    for idn in (
        Idn(VELOCITY_FEEDBACK, "velocity feedback value"),
        Idn(HOMING_VELOCITY, "homing velocity", 0),
        Idn(HOMING_ACCELERATION, "homing acceleration", 1),
        Idn(VELOCITY_SCALING, "velocity data scaling type"),
        Idn(VELOCITY_FACTOR, "velocity data scaling factor"),
        Idn(VELOCITY_EXPONENT, "velocity data scaling exponent"),
        Idn(POSITION_COMMAND, "position command value of the drive's own motion"),
        Idn(POSITION_FEEDBACK, "position feedback value"),
        Idn(REFERENCE_DISTANCE, "reference distance", -LARGEST),
        Idn(POSITION_WINDOW, "position window"),
        Idn(POSITION_SCALING, "position data scaling type"),
        Idn(DIAGNOSIS, "diagnostic message"),
        Idn(OVERRIDE, "feedrate override, in 0.01 %"),
        Idn(STANDSTILL_WINDOW, "standstill window"),
        Idn(HOMING_PARAMETER, "homing parameter", 0, 0xFFFF),
        Idn(HOMING, "drive-controlled homing procedure command", 0, SET_AND_ENABLE),
        Idn(ACCELERATION_SCALING, "acceleration data scaling type"),
        Idn(JERK, "jerk limit bipolar", 1),
        Idn(HOME_SWITCH, "home switch"),
        Idn(FEEDBACK_STATUS, "position feedback value status"),
    )
}
_NAME = re.compile(r"S-0-\d{4}")


def is_name(idn: str) -> bool:
    """True for S-0- and four digits."""
    return _NAME.fullmatch(idn) is not None


class Scaling(NamedTuple):
    """Digits of the service channel for one mm, mm/s … (deg, deg/s …), all in 32 bits.

    Preferred scaling: 0.1 µm, µm/min, 0.001 mm/s² (1e-4 deg, 1e-4 rpm, 0.001 rad/s²); at the load.
    """

    position: Digits
    velocity: Digits
    acceleration: Digits
    """Of the jerk too."""


def scaling(*, rotary: bool, exponent_shift: int = 0) -> Scaling:
    """`exponent_shift`: how much larger S-0-0046 is than that of preferred scaling."""
    velocity, acceleration = (10_000.0 / 6.0, 1000.0 * 0.017453292519943295) if rotary else (60_000.0, 1000.0)
    return Scaling(Digits(10_000.0, 32), Digits(velocity / 10.0**exponent_shift, 32), Digits(acceleration, 32))


def homing_bits(drive: SercosParameters) -> int:
    """S-0-0147 as the axis list has it: P-AXIS-00158, 00156 and 00084; the switch is at the drive."""
    homing = drive.homing
    bits = SWITCH_AT_DRIVE | AT_REFERENCE
    bits |= NEGATIVE if homing.direction < 0.0 else 0
    bits |= WITHOUT_SWITCH if homing.without_cam else 0
    return bits | (WITHOUT_MARKER if homing.without_zero_pulse else 0)

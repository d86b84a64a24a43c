"""What a simulated SERCOS drive is set to at start, and where it gets its signals when it homes its axis on its own."""

from __future__ import annotations

from dataclasses import dataclass

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.homing_view import HomingParameters

NO_FAULT, NO_SWITCH, NO_MARKER = "NONE", "NO_SWITCH", "NO_MARKER"
ABORTED, NO_REFERENCE, NO_ANSWER = "ABORTED", "NO_REFERENCE", "NO_ANSWER"
"""Of P-SIM-00028."""


@dataclass(frozen=True, slots=True)
class SercosParameters:
    """A SERCOS drive (P-AXIS-00020 = 2), mm and mm/s (°, °/s); homing velocity, flags and signals are in `homing`."""

    rotary: bool
    homing: HomingParameters
    acceleration: float
    """Of its own motions (S-0-0042) …"""
    jerk: float
    """… and S-0-0349."""
    position_window: float
    """S-0-0057."""
    referenced: bool
    """Its encoder is absolute."""
    parameter_scaling: bool
    """Of velocities (S-0-0044)."""
    fault: str
    """P-SIM-00028."""


def sercos_view(
    parameters: ParameterSet, homing: HomingParameters, *, acceleration: float, jerk: float, position_window: float
) -> SercosParameters:
    """`acceleration` and `jerk` of the axis count where the drive has none of its own."""
    return SercosParameters(
        rotary=parameters.axis_type == "R",
        homing=homing,
        acceleration=parameters.kernel(ids.SERCOS_HOMING_ACCELERATION) or acceleration,
        jerk=parameters.kernel(ids.SERCOS_HOMING_JERK) or jerk,
        position_window=position_window,
        referenced=bool(parameters.number(ids.SIMULATION_REFERENCED_AT_START)),
        parameter_scaling=parameters.text(ids.SERCOS_VELOCITY_SCALING) == "PARAMETER",
        fault=parameters.text(ids.SERCOS_HOMING_FAULT),
    )

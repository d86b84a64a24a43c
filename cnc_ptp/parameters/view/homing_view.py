"""How an axis is homed, and where its simulated drive has reference cam and zero pulses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.fields import given_fields

DISABLED, IGNORE_ABSOLUTE, DRIVE_CONTROLLED = "DISABLED", "IGNORE_ABS_POS", "DRIVE_CONTROLLED"
"""Of P-AXIS-00299."""


@dataclass(frozen=True, slots=True)
class HomingParameters:
    """Homing of an axis, mm and mm/s (°, °/s). Cam and zero pulses are where the encoder of the machine counts them.

    `direction`: +1 or -1, in which cam or zero pulse are looked for; `cam_length` 0 reaches to the end of travel.
    """

    kind: str
    """P-AXIS-00299."""
    required: Annotated[bool, ids.HOMING_REQUIRED]
    reference_position: Annotated[float, ids.GETRIEBE_POS_REFPKT]
    direction: float
    without_cam: Annotated[bool, ids.KENNGR_REF_OHNE_NOCKEN]
    without_reversing: Annotated[bool, ids.KENNGR_REF_OHNE_REV]
    without_zero_pulse: Annotated[bool, ids.KENNGR_HOMING_WITHOUT_ZERO_PULSE]
    fast_off_cam: Annotated[bool, ids.KENNGR_FAST_FROM_CAM]
    fast: Annotated[float, ids.GETRIEBE_VB_REFMAX]
    slow: Annotated[float, ids.GETRIEBE_VB_REFLOW]
    range: float
    """Within which each phase must find its signal."""
    timeout: Annotated[float, ids.HOMING_TIMEOUT_MS]
    """Within which a drive that homes its axis must acknowledge."""
    cam_position: Annotated[float, ids.SIMULATION_CAM_POSITION]
    cam_length: Annotated[float, ids.SIMULATION_CAM_LENGTH]
    to_zero_pulse: Annotated[float, ids.SIMU_RPF_WEG_BIS_NIP]
    """From cam_position in the direction of homing."""
    pulse_distance: Annotated[float, ids.SIMULATION_ZERO_PULSE_DISTANCE]


def homing_view(parameters: ParameterSet, gear: int, travel: float) -> HomingParameters:
    """`travel` between the soft limits, of a modulo axis the length of a turn; mm (°)."""
    return HomingParameters(
        kind=parameters.text(ids.HOMING_HOMING_TYPE),
        direction=1.0 if parameters.number(ids.KENNGR_REF_RICHT) else -1.0,
        range=parameters.kernel(ids.KENNGR_HOMING_MAX_MOVEMENT_DIST) or 2.0 * math.fabs(travel),
        **given_fields(HomingParameters, parameters, gear),
    )

"""Gear records of an axis or spindle, getriebe[i]."""

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet


def active_gear(parameters: ParameterSet) -> int:
    """Index of the record in use after start-up (P-AXIS-00079 counts from 1)."""
    return int(parameters.number(ids.KENNGR_GETRIEBE_STUFE)) - 1


def gear_records(parameters: ParameterSet) -> list[int]:
    """Indexes of the records that the file gives, and of the one in use after start-up."""
    return sorted({active_gear(parameters), *parameters.used_indexes("getriebe")})


def emergency_deceleration(parameters: ParameterSet, gear: int) -> float:
    """Of record `gear`, mm/s² (°/s²): P-AXIS-00003, or the largest acceleration where that is 0."""
    return parameters.kernel(ids.DYNAMIK_A_EMERGENCY, gear) or parameters.kernel(ids.DYNAMIK_A_MAX, gear)

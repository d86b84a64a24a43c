"""Numbers of what commissioning refuses. Each text says what is missing and what to do."""

from __future__ import annotations

from cnc_ptp.errors import CncError

UNKNOWN_AXIS = 27001
NOT_RECORDED = 27002
TOO_SHORT = 27003
NO_MOTION = 27004
NO_TORQUE = 27005
NOT_STEADY = 27006
ONE_DIRECTION = 27007
NO_FRICTION = 27008
NO_SCALE = 27009
NO_ROOM = 27010
BAD_VELOCITIES = 27011
NOT_EXCITED = 27012
NO_FIT = 27013
NO_COMMAND = 27014
BAD_CIRCLE = 27020
NOT_COVERED = 27022
NOTHING_TO_COMPARE = 27023
BAD_PLANE = 27024
BAD_OUTPUT = 27030
BAD_CURVE_POINT = 27041
BAD_CURVE_FILE = 27042
NOT_ASCENDING = 27043
TOO_FEW_POINTS = 27044
NO_LIMIT_POINT = 27045
BAD_CURVE_RANGE = 27046
NO_HYPERBOLA = 27047
CURVE_NOT_POSITIVE = 27048
CURVE_POLE = 27049
CURVE_RISES = 27050


def refusal(number: int, axis: str, text: str) -> CncError:
    """An error of one axis."""
    return CncError(number, f"axis {axis}: {text}")

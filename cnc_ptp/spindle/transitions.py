"""The states of a spindle and all transitions between them (PLCopen); only `Spindle.take` changes the state.

The diagrams in docs/spindles.md show these arrows; Stopping is one state with Standstill there.
"""

from __future__ import annotations

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.transitions import transition

ON = (S.STANDSTILL, S.CONTINUOUS_MOTION, S.DISCRETE_MOTION, S.HOMING, S.STOPPING)
PROCEDURE = (S.DISCRETE_MOTION, S.HOMING, S.STOPPING)
"""Jobs of several steps; their stop is one."""

POWER_ON = transition("power on", S.DISABLED, to=S.STANDSTILL)
POWER_OFF = transition("power off", S.STANDSTILL, S.DISABLED, to=S.DISABLED)
ROTATE = transition("M3, M4", S.STANDSTILL, S.CONTINUOUS_MOTION, S.DISCRETE_MOTION, S.STOPPING, to=S.CONTINUOUS_MOTION)
POSITION = transition("M19", *ON, to=S.DISCRETE_MOTION)
HOME = transition("G74", S.STANDSTILL, S.CONTINUOUS_MOTION, S.HOMING, S.STOPPING, to=S.HOMING)
STOP = transition("M5", *ON, to=S.STOPPING)
CHANGE_GEAR = transition("at the position of the gear change", S.DISCRETE_MOTION, S.STOPPING, to=S.STANDSTILL)
FINISH = transition("finished", *PROCEDURE, S.STANDSTILL, S.DISABLED, to=S.STANDSTILL)
FINISH_WITHOUT_POWER = transition("finished without power", S.DISABLED, to=S.DISABLED)
FAULT = transition("fault", *S, to=S.ERROR_STOP)
FOLLOW_PATH = transition("taken over by the path (G63)", S.STANDSTILL, to=S.SYNCHRONIZED_MOTION)
LEAVE_PATH = transition("released by the path", S.SYNCHRONIZED_MOTION, to=S.STANDSTILL)
RESET = transition("reset", S.ERROR_STOP, to=S.STANDSTILL)
RESET_WITHOUT_POWER = transition("reset without power", S.ERROR_STOP, to=S.DISABLED)

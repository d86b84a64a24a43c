"""The states of an axis and all transitions between them (PLCopen); only `Axis.take` changes the state.

docs/ptp.md shows the diagram drawn from this table.
"""

from __future__ import annotations

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.transitions import transition

MOVING = (S.DISCRETE_MOTION, S.CONTINUOUS_MOTION)
OWN_MOTION = (*MOVING, S.STOPPING)
STOPPABLE = (*MOVING, S.HOMING)
ENDING = (*OWN_MOTION, S.HOMING)

POWER_ON = transition("power on", S.DISABLED, to=S.STANDSTILL)
POWER_OFF = transition("power off", S.STANDSTILL, to=S.DISABLED)
START = transition("start", S.STANDSTILL, to=S.DISCRETE_MOTION)
NEXT = transition("next motion", *MOVING, to=S.DISCRETE_MOTION)
RUN = transition("velocity", S.STANDSTILL, *MOVING, to=S.CONTINUOUS_MOTION)
SUPERIMPOSE = transition("superimposed motion", S.STANDSTILL, to=S.DISCRETE_MOTION)
CONTINUE_SUPERIMPOSED = transition("superimposed motion continues", *OWN_MOTION, to=S.DISCRETE_MOTION)
NEW_TARGET = transition("new target", *OWN_MOTION, to=S.DISCRETE_MOTION)
JOG = transition("jog", S.STANDSTILL, *MOVING, to=S.CONTINUOUS_MOTION)
HALT = transition("halt", S.CONTINUOUS_MOTION, to=S.DISCRETE_MOTION)
END_JOG = transition("end of the jog", S.CONTINUOUS_MOTION, to=S.DISCRETE_MOTION)
ENABLE_EXTERNAL = transition("external setpoints", S.STANDSTILL, to=S.CONTINUOUS_MOTION)
HOME = transition("homing", S.STANDSTILL, to=S.HOMING)
STOP = transition("stop", *ENDING, to=S.STOPPING)
FINISH = transition("finished", *ENDING, to=S.STANDSTILL)
FINISH_WITHOUT_POWER = transition("finished without power", *OWN_MOTION, to=S.DISABLED)
CONTINUE_EXTERNALLY = transition("external setpoints continue", *OWN_MOTION, to=S.CONTINUOUS_MOTION)
STOP_EXTERNALLY = transition("external setpoints come to rest", *OWN_MOTION, to=S.STOPPING)
ENTER_PATH = transition("path of a channel", S.STANDSTILL, to=S.SYNCHRONIZED_MOTION)
LEAVE_PATH = transition("end of the path", S.SYNCHRONIZED_MOTION, to=S.STOPPING)
COUPLE = transition("couple", S.STANDSTILL, S.SYNCHRONIZED_MOTION, to=S.SYNCHRONIZED_MOTION)
DECOUPLE_AT_REST = transition("decouple at rest", S.SYNCHRONIZED_MOTION, to=S.STANDSTILL)
DECOUPLE_WITHOUT_POWER = transition("decouple without power", S.SYNCHRONIZED_MOTION, to=S.DISABLED)
DECOUPLE_TO_TARGET = transition("decouple to a target", S.SYNCHRONIZED_MOTION, to=S.DISCRETE_MOTION)
DECOUPLE_IN_MOTION = transition("decouple in motion", S.SYNCHRONIZED_MOTION, to=S.CONTINUOUS_MOTION)
DECOUPLE_AND_STOP = transition("decouple without velocity", S.SYNCHRONIZED_MOTION, to=S.STOPPING)
FAULT = transition("fault", *S, to=S.ERROR_STOP)
RESET = transition("reset", S.ERROR_STOP, to=S.STANDSTILL)
RESET_WITHOUT_POWER = transition("reset without power", S.ERROR_STOP, to=S.DISABLED)

"""Faults of thread cutting (G33)."""

from cnc_ptp.nc.faults import Fault

PITCH_MISSING = Fault(21660, "G33 has no pitch; it is programmed with {letter} in mm per revolution")
PITCH_RANGE = Fault(21661, "pitch {word}{value} must be above 0 (mm per revolution, without a sign)")
PITCH_TWICE = Fault(21662, "pitch by {first} and by {second}; G33 takes one of them")
PITCH_LETTER = Fault(
    21663,
    "{axis} moves most in this thread ({travels}), so its pitch is programmed with {letter}, not with {given}",
)
AXIS = Fault(21664, "axis {word} cannot take part in a thread; G33 moves X, Y and Z")
SPINDLE_STANDS = Fault(21665, "spindle {spindle} does not turn ({why}); G33 needs M03 or M04 with a speed above 0")
SPINDLE_COMMANDED = Fault(
    21666, "{word} commands spindle {spindle} between two blocks of G33; it must not change within a thread"
)
OFFSET_SPINDLE = Fault(21668, "OFFSET of spindle {spindle}; a thread is cut with the main spindle {main}")
OFFSET_RANGE = Fault(21669, "OFFSET {value} deg of spindle {spindle} must be from 0 to below 360")

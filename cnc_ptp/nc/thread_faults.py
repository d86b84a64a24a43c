"""Faults of thread cutting (G33)."""

from cnc_ptp.nc.faults import Fault

PITCH_MISSING = Fault(21660, "{g} has no pitch; it is programmed with {letter} in mm per revolution")
PITCH_RANGE = Fault(21661, "pitch {word}{value} must be above 0 (mm per revolution, without a sign)")
PITCH_TWICE = Fault(21662, "pitch by {first} and by {second}; G33 takes one of them")
PITCH_LETTER = Fault(
    21663,
    "{axis} moves most in this thread ({travels}), so its pitch is programmed with {letter}, not with {given}",
)
AXIS = Fault(21664, "axis {word} cannot take part in a thread; {g} moves X, Y and Z")
CHANGE_MISSING = Fault(
    21670, "{g} has no change of its lead; it is programmed with F above 0 in mm per revolution each"
)
LEAD_ENDS = Fault(
    21671,
    "the lead falls from {lead} mm to 0 within {length} mm at {change} mm per revolution; the thread has {way} mm",
)
SPINDLE_STANDS = Fault(21665, "spindle {spindle} does not turn ({why}); {g} needs M03 or M04 with a speed above 0")
SPINDLE_COMMANDED = Fault(
    21666, "{word} commands spindle {spindle} between two blocks of a thread; it must not change within a thread"
)
RETRACT_AXIS = Fault(21672, "{word} is not possible: a retract moves one axis of X, Y and Z, as in {syntax}")
RETRACT_ASKEW = Fault(21673, "the retract of #THREAD RETRACT would be askew: X, Y and Z are rotated")
OFFSET_SPINDLE = Fault(21668, "OFFSET of spindle {spindle}; a thread is cut with the main spindle {main}")
OFFSET_RANGE = Fault(21669, "OFFSET {value} deg of spindle {spindle} must be from 0 to below 360")

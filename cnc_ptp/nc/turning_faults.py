"""Faults of turning (G51, G95, G96, G196); numbers as in faults.py, our own from 21720."""

from typing import Final

from cnc_ptp.nc.faults import Fault

NO_FACING_AXIS = Fault(20042, "{g} without a facing axis in the plane {plane} (P-AXIS-00015 0x40)")
TWO_FACING_AXES = Fault(
    20064, "{g} with two facing axes in the plane {plane}, {first} and {second} (P-AXIS-00015 0x40)"
)
MIRRORED = Fault(20019, "axis {axis} is mirrored ({g}) while its words are diameters (G51)")
NO_FACING_AXIS_FOR_SPEED = Fault(20634, "{g} without a facing axis in the plane {plane} (P-AXIS-00015 0x40)")
TAPPING_FEED = Fault(20635, "{g} with a feed per turn (G95); G94 ends it")
TAPPING = Fault(20636, "{g} with constant cutting speed (G96); G97 ends it")
POSITIONING = Fault(20642, "M19 of spindle {spindle} with constant cutting speed (G96); G97 ends it")
SPEED_ZERO = Fault(50499, "feed per turn (G95) with speed 0 of spindle {spindle}")
CUTTING_SPEED = Fault(120167, "cutting speed S{value} of G96 must be greater than 0")
MAX_SPEED = Fault(120169, "largest speed {value} rpm of {g} must be greater than 0")
NO_DIAMETERS = Fault(
    21720, "G51 would have no effect: diameters of axis {axis} are off for G90 (P-AXIS-00058) and G91 (P-AXIS-00059)"
)
NEGATIVE_DIAMETER = Fault(21721, "diameter {axis}{value} is negative")
LIMIT_TOO_LATE = Fault(21722, "{g} S{value} must be in a block before G96{instead}")
LIMIT_MISSING = Fault(21723, "{g} without a speed, as in {examples}")
PLC_SPINDLE = Fault(21724, "{g} needs a spindle that the NC moves, the PLC controls {spindle} (P-CHAN-00069)")
MAIN_SPINDLE = Fault(21725, "#MAIN SPINDLE while the cutting speed is constant (G96): G97 before it")
FEED_OF_C_AXIS = Fault(
    21726, "feed per turn (G95) while spindle {spindle} is axis {axis} of the path and does not turn; G94 before it"
)
FEED_OF_STOPPED = Fault(
    21727, "feed per turn (G95) of spindle {spindle}, which the program has stopped; M03, M04 or G94 before it"
)

SPEED_LIMITED: Final = 20633
"""Number of the warning at S of G96."""

"""Faults of coordinates."""

from cnc_ptp.nc.faults import Fault

OFFSET_INDEX = Fault(21600, "zero offset {index} does not exist: G159=0 to G159={limit}")
AXES_MISSING = Fault(21602, "{word} without an axis")
ROTATION_PLANE = Fault(21603, "{word} needs the axes {needed} of plane {plane}; axes of this channel: {known}")
MAIN_AXIS_MISSING = Fault(21604, "{word} moves axis {axis}, which this channel does not have")
SCALE_FACTOR = Fault(21605, "scale {value} of axis {axis} must be greater than 0")
SCALE_ACTIVE = Fault(21606, "#SCALE with factors while it is on; #SCALE OFF first")
SCALE_ROTARY = Fault(21607, "axis {axis} is rotary and is not scaled")
SCALED_ARC = Fault(21608, "the arc would be an ellipse: axes {first} and {second} have different scales")
TILTED_ARC = Fault(21609, "arcs in a coordinate system that is turned out of the plane {plane} are not available yet")
SYSTEM_NUMBER = Fault(21610, "coordinate system {number} must be an integer from 1 to {limit}")
SYSTEM_UNKNOWN = Fault(21611, "{command} {number} was not defined with {command} DEF or ON before")
SYSTEM_VALUES = Fault(21612, "{command} takes up to six values: shift of X, Y, Z in mm, rotation about X, Y, Z in deg")
SYSTEM_DEPTH = Fault(21613, "{command} ON at level {depth}, the limit is {limit}")
SYSTEM_NONE = Fault(21614, "{command} OFF, but none is on")
MIRROR_PRESET = Fault(20612, "{command} is not possible while {what}")
LIMIT_POSITIVE = Fault(120002, "axis {axis}: {position} {unit} lies beyond the software limit {limit} {unit} of G99")
LIMIT_NEGATIVE = Fault(120003, "axis {axis}: {position} {unit} lies beyond the software limit {limit} {unit} of G98")
LIMIT_ORDER = Fault(21649, "software limits of axis {axis}: negative {low} {unit} is not below positive {high} {unit}")

"""Faults of the compensation of the tool radius; the numbers below 21000 and above 90000 are the vendor's."""

from typing import Final

from cnc_ptp.nc.faults import Fault

PLANE_CHANGE = Fault(20133, "{g} while the tool radius is compensated; G40 and a straight line end that before it")
NOT_WHILE = Fault(
    20651, "{what} is not possible while the tool radius is compensated; G40 and a straight line end that before it"
)
SYSTEM_CHANGE = Fault(
    20802, "{command} while the tool radius is compensated; G40 and a straight line end that before it"
)
APPROACH_ARC = Fault(90008, "{g} begins with an arc: the motion to the contour must be a straight line (G00, G01)")
OTHER_BLOCKS = Fault(
    90011,
    "{count} blocks without motion in the plane {g} between two motions in it, at most {limit} are possible"
    " (P-CHAN-90036)",
)
ARC_TOO_SMALL = Fault(
    90017, "the tool with radius {tool} mm is on the inside of an arc with radius {radius} mm: it does not fit into it"
)
RADIUS_CHANGED = Fault(
    21680,
    "{word} changes the tool from {before} to {behind} while its radius is compensated;"
    " G40 and a straight line end that before it",
)
SIDE_ARC = Fault(
    21681, "{g}: the tool changes the side of the contour with an arc; that motion must be a straight line"
)
NO_ELEMENT = Fault(21682, "no motion in the plane {g} follows the motion to the contour, so where it ends is not known")
NO_RADIUS = Fault(21683, "{g} without a tool: no compensation data with a radius are active")
DEPARTURE_ARC = Fault(21684, "the motion from the contour, the first one behind G40, is an arc: it must be straight")
TOO_NARROW = Fault(
    21685,
    "the path of the tool comes as near as {apart} mm to line {line} '{text}', its radius is {tool} mm:"
    " it does not fit between them",
)
NO_CROSSING = Fault(
    21686,
    "the tool with radius {tool} mm does not fit into the inner corner with line {line} '{text}':"
    " the paths beside the motions around it, at most {count} (P-CHAN-90035), do not cross",
)
SCALED_PLANE = Fault(21687, "{g} in a tilted plane with different scales, in which nothing keeps its distance")
TILTED_TIP = Fault(21688, "{g} in a tilted plane with a turning tool, whose tip has a position in the machine")
CARTESIAN_TIP = Fault(21690, "{g} while {command} is on with a turning tool, whose tip has a position in the machine")

STILL_ON: Final = 21689
"""Number of the warning at the end of a program."""

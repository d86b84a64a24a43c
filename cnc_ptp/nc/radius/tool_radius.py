"""Radius of the active tool with its wear, and where the tip of a turning tool is beside the centre of its nose.

The tip is the point that programs move: where parallels to both axes of the plane that touch the nose cross (positions
1 to 4), or where one of them touches it (5 to 8). Positions 0 and 9 are the centre itself. They are counted as turning
machines do, with the first axis of the plane to the right (G18: Z) and the second one upwards (X).
"""

from typing import Final

from cnc_ptp.nc.canonical import number
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.radius.shapes import Vector
from cnc_ptp.parameters import Tool

TURNING: Final = 1
"""P-TOOL-00001."""
TIPS: Final[dict[int, Vector]] = {
    1: (1.0, 1.0),
    2: (-1.0, 1.0),
    3: (-1.0, -1.0),
    4: (1.0, -1.0),
    5: (1.0, 0.0),
    6: (0.0, 1.0),
    7: (-1.0, 0.0),
    8: (0.0, -1.0),
}
"""From the centre of the nose to the tip, in radii along the axes of the plane, by P-TOOL-00002."""
CENTRE: Vector = (0.0, 0.0)


def tool_of(state: ModalState) -> Tool:
    """Compensation data whose radius acts."""
    return state.tool.data if state.radius_compensation.data is None else state.radius_compensation.data


def radius_of(tool: Tool) -> float:
    """mm, with wear; below 0: the tool is on the other side of the contour."""
    return tool.radius + tool.wear_radius


def tip_of(tool: Tool) -> Vector:
    """From the centre of the nose to the point that programs move, mm."""
    first, second = TIPS.get(tool.orientation, CENTRE) if tool.type == TURNING else CENTRE
    return first * radius_of(tool), second * radius_of(tool)


def described(tool: Tool) -> str:
    """For errors."""
    text = f"radius {number(radius_of(tool))} mm"
    return f"{text}, tip {tool.orientation}" if tool.type == TURNING else text

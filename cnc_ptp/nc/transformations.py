"""Kinematics in programs: #FACE [X, C], #CYL [Z, C, X60] and their OFF (TF5200 spindle 2.8.8).

The offsets that are on when a kinematics begins place it: the tool, a zero offset of C in degrees. What is programmed
behind it is Cartesian. The machine position at its begin and end is known when the path stands there, so the
interpreter waits for that.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import atan2, cos, hypot, sin
from typing import Final

from cnc_ptp.errors import Value
from cnc_ptp.kinematics.cylinder import Cylinder
from cnc_ptp.kinematics.face import CENTRE, Face
from cnc_ptp.kinematics.kinematics import Kinematics, Point
from cnc_ptp.nc import c_axis_faults as own
from cnc_ptp.nc.arcs import extreme_points
from cnc_ptp.nc.canonical import CircularMove, Function, KinematicsChange, LinearMove, number
from cnc_ptp.nc.coordinates.coordinates import Coordinates
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.faults import Fault, ProgramError
from cnc_ptp.nc.program import Channel, HashCommand, ModalState, NcBlock

FACE: Final = "#FACE [X, C], with the facing axis and the C axis, or #FACE OFF"
CYLINDER: Final = "#CYL [Z, C, X60], with the axis along the cylinder, the C axis and the radius, or #CYL OFF"
MILLING: Final = 2
"""P-CHAN-00008: X may pass the centre of rotation."""
_RADIUS = re.compile(r"([A-Z]\w*?)\s*=?\s*([+-]?\d+(?:\.\d*)?|[+-]?\.\d+)", re.ASCII)


def face(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#FACE [X, C]: words of X and C are Cartesian on the face of the workpiece."""
    _require_c_axis(state, block, command)
    arguments = command.arguments or ()
    if len(arguments) != 2:
        raise _fault(own.KINEMATICS_SYNTAX, block, command, syntax=FACE)
    x, c = _axes(channel, block, command, arguments[0], arguments[1], FACE)
    through = channel.table.face_kind == MILLING
    origin = _origin(channel, state, block, command)
    if not through and state_machine(state)[x] < origin[x] - CENTRE:
        raise _fault(
            own.FACE_SIDE, block, command, axis=arguments[0], value=number(state_machine(state)[x] - origin[x])
        )
    return _select(channel, state, Face(x, c, origin, through, (arguments[0], arguments[1])))


def cylinder(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#CYL [Z, C, X60]: words of C are lengths on a cylinder with this radius."""
    _require_c_axis(state, block, command)
    arguments = command.arguments or ()
    given = _RADIUS.fullmatch(arguments[2]) if len(arguments) == 3 else None
    if given is None or given[1] not in channel.axis_index:
        raise _fault(own.KINEMATICS_SYNTAX, block, command, syntax=CYLINDER)
    first, c = _axes(channel, block, command, arguments[0], arguments[1], CYLINDER)
    radius = float(given[2]) * state.coordinates.unit
    if radius <= 0.0:
        raise _fault(own.CYLINDER_RADIUS, block, command, value=number(radius))
    origin = _origin(channel, state, block, command)
    return _select(channel, state, Cylinder(first, c, radius, origin, (arguments[0], arguments[1], given[1])))


def off(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#FACE OFF, #CYL OFF: positions are again those of the axes."""
    if command.arguments is not None:
        raise _fault(own.KINEMATICS_SYNTAX, block, command, syntax=FACE if command.name == "FACE OFF" else CYLINDER)
    kinematics, name = state.coordinates.kinematics, "#" + command.name.partition(" ")[0]
    if kinematics is None or not kinematics.name.startswith(name):
        raise _fault(own.KINEMATICS_NOT_ON, block, command, command=name)
    leave(channel, state)
    return (KinematicsChange(None),)


def leave(channel: Channel, state: ModalState) -> None:
    """The coordinates from before the kinematics; where the axes stand is only near until the run says it."""
    state.position = state_machine(state)
    restore(state)
    refresh(channel, state)


def restore(state: ModalState) -> None:
    """The offsets before the kinematics, with units and tables as they are now."""
    now, before = state.coordinates, state.coordinates.untransformed
    if before is not None:
        before = before.copy()
        before.unit, before.changes, before.defined = now.unit, now.changes, now.defined
        before.last_defined, before.limits = now.last_defined, now.limits
        state.coordinates = before


def place(channel: Channel, state: ModalState, machine: Point) -> None:
    """The axes are at a machine position that the run has told."""
    kinematics = state.coordinates.kinematics
    state.position = machine if kinematics is None else kinematics.forward(machine)
    refresh(channel, state)


def state_machine(state: ModalState) -> Point:
    """The machine position of the state; behind kinematics it may be whole turns away from the real one."""
    kinematics = state.coordinates.kinematics
    return state.position if kinematics is None else kinematics.inverse(state.position, kinematics.origin)


def check_move(
    channel: Channel, state: ModalState, block: NcBlock, motion: LinearMove | CircularMove
) -> Sequence[Point]:
    """Machine positions between which the axes move. Raises ProgramError 21755 for a way through the centre."""
    kinematics = state.coordinates.kinematics
    assert kinematics is not None
    points = [state.position, motion.target, *centre_points(kinematics, state.position, motion)]
    if isinstance(motion, CircularMove):
        points += extreme_points(state.position, motion)
    if isinstance(kinematics, Face):
        _require_way(kinematics, block, motion, points)
    return [kinematics.inverse(point, kinematics.origin) for point in points]


def _require_way(face: Face, block: NcBlock, motion: LinearMove | CircularMove, points: Sequence[Point]) -> None:
    """A line through the centre needs X to pass it, an arc through it has no angle there."""
    start, target, *between = [hypot(point[face.x], point[face.c]) for point in points]
    if isinstance(motion, LinearMove) and (face.through or min(start, target) < CENTRE):
        return
    if min(start, target, *between) < CENTRE:
        raise own.THROUGH_CENTRE.at(block.source, 1, command=face.name)


def centre_points(kinematics: Kinematics, start: Point, motion: LinearMove | CircularMove) -> list[Point]:
    """Points of a motion that are nearest to the centre of its plane, and farthest from it."""
    first, second = kinematics.plane
    points = (
        [part_of_arc(motion, start, outwards) for outwards in (False, True)]
        if isinstance(motion, CircularMove)
        else [part_of_line(start, motion.target, first, second)]
    )
    return [_moved(start, kinematics.plane, point) for point in points if point is not None]


def part_of_line(start: Point, target: Point, first: int, second: int) -> tuple[float, float] | None:
    """The foot of the perpendicular from the centre, if it is on the line."""
    x, y = start[first], start[second]
    dx, dy = target[first] - x, target[second] - y
    square = dx * dx + dy * dy
    part = -(x * dx + y * dy) / square if square > 0.0 else 0.0
    return (x + part * dx, y + part * dy) if 0.0 < part < 1.0 else None


def part_of_arc(motion: CircularMove, start: Point, outwards: bool) -> tuple[float, float] | None:
    """The point of the circle on the way from the centre to that of the circle, or behind it, if the arc has it."""
    (x, y), (first, second) = motion.center, motion.plane
    if hypot(x, y) < CENTRE:
        return None
    angle = atan2(y, x) if outwards else atan2(-y, -x)
    begin = atan2(start[second] - y, start[first] - x)
    turned = (angle - begin) if motion.sweep > 0.0 else (begin - angle)
    if turned % TURN > abs(motion.sweep) / 360.0 * TURN:
        return None
    return x + motion.radius * cos(angle), y + motion.radius * sin(angle)


TURN: Final = 6.283185307179586
"""rad."""


def _moved(start: Point, plane: tuple[int, int], point: tuple[float, float]) -> Point:
    moved = list(start)
    moved[plane[0]], moved[plane[1]] = point
    return tuple(moved)


def _select(channel: Channel, state: ModalState, kinematics: Kinematics) -> tuple[Function, ...]:
    """From here on positions are Cartesian; offsets begin anew."""
    machine, before = state_machine(state), state.coordinates.untransformed or state.coordinates
    now = state.coordinates
    state.coordinates = Coordinates(
        unit=now.unit, changes=now.changes, defined=now.defined, last_defined=now.last_defined, limits=now.limits,
        clamp_index=now.clamp_index, kinematics=kinematics, untransformed=before,
    )  # fmt: skip
    place(channel, state, machine)
    return (KinematicsChange(kinematics),)


def _origin(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> Point:
    """What lies between programmed and machine positions. Raises ProgramError for rotated, mirrored, scaled ones."""
    before = state.coordinates.untransformed or state.coordinates
    frame = before.frame(len(channel.axes), channel.main)
    if frame is None:
        return (0.0,) * len(channel.axes)
    if frame.turned:
        raise _fault(own.KINEMATICS_TURNED, block, command, command=f"#{command.name}")
    return frame.shift


def _axes(channel: Channel, block: NcBlock, command: HashCommand, first: str, c: str, syntax: str) -> tuple[int, int]:
    """Places of a linear axis and of the C axis."""
    if first not in channel.axis_index or first in channel.rotary or c != channel.table.c_axis:
        raise _fault(
            own.KINEMATICS_AXES, block, command, command=f"#{command.name}", first=first, second=c, syntax=syntax
        )
    return channel.axis_index[first], channel.axis_index[c]


def _require_c_axis(state: ModalState, block: NcBlock, command: HashCommand) -> None:
    if not state.c_axis:
        raise _fault(own.KINEMATICS_WITHOUT_CAX, block, command, command=f"#{command.name}")


def _fault(fault: Fault, block: NcBlock, line: HashCommand, /, **values: Value) -> ProgramError:
    return fault.at(block.source, line.column, **values)

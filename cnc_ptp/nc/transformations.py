"""Kinematics in programs: #FACE [X, C], #CYL [Z, C, X60] and their OFF (TF5200 spindle 2.8.8).

The offsets that are on when a kinematics begins place it: the tool, a zero offset of C in degrees. What is programmed
behind it is Cartesian. The machine position at its begin and end is known when the path stands there, so the
interpreter waits for that.
"""

from __future__ import annotations

import re
from typing import Final

from cnc_ptp.errors import Value
from cnc_ptp.kinematics.cylinder import Cylinder
from cnc_ptp.kinematics.face import CENTRE, Face
from cnc_ptp.kinematics.kinematics import Kinematics, Point
from cnc_ptp.nc import c_axis_faults as own
from cnc_ptp.nc.canonical import Function, KinematicsChange, number
from cnc_ptp.nc.coordinates.coordinates import Coordinates
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.faults import Fault, ProgramError
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, HashCommand, NcBlock

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

"""Commands of coordinates: #ROTATION, #SCALE, #CS, #ACS, #MCS, #PSET, #PRESET."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Final

from cnc_ptp.nc.c_axis_faults import NOT_WITH_KINEMATICS
from cnc_ptp.nc.canonical import number
from cnc_ptp.nc.coordinates import coordinate_faults as faults
from cnc_ptp.nc.coordinates.coordinates import NO_OFFSETS, System, system_of
from cnc_ptp.nc.coordinates.frame import main_axes
from cnc_ptp.nc.coordinates.placement import plane_axes, refresh
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.faults import AXIS_UNKNOWN
from cnc_ptp.nc.flow.command_words import Words
from cnc_ptp.nc.flow.lines import Flow, Line, Statement
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, NcBlock
from cnc_ptp.nc.radius.changes import require_same_system

DEEPEST: Final = 10
"""Coordinate systems within each other."""
LAST_SYSTEM: Final = 5
ROTATION: Final = "#ROTATION ON [ANGLE=30 CENTER1=10 CENTER2=5] or #ROTATION OFF"
SCALE: Final = "#SCALE X2 Y2, #SCALE ON, #SCALE ON X2 Y2 or #SCALE OFF"
MACHINE: Final = "#MCS ON or #MCS OFF"
PSET: Final = "#PSET X10 Y20"
PRESET: Final = "#PRESET or #PRESET X Y"


def system_syntax(command: str) -> str:
    values = "[10, 0, 0, 0, 0, 90]"
    return f"{command} DEF [1] {values}, {command} ON {values}, {command} ON [1], {command} OFF or {command} OFF ALL"


def bounded(node: Node, values: Values) -> float:
    """A value that may be as large as a word. Raises ProgramError."""
    return values.bounded(node.value(values), node.column, "the command")


class CoordinateCommand(Statement):
    """Changes the coordinates when it is executed."""

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        values = execution.values
        self.change(values.channel, values.state, execution, line)
        refresh(values.channel, values.state)
        return None

    @abstractmethod
    def change(self, channel: Channel, state: ModalState, execution: Flow, line: Line) -> None:
        """The change alone; the frame follows from it."""


class Rotation(CoordinateCommand):
    """#ROTATION ON [ANGLE=30 CENTER1=10 CENTER2=5]: the contour turns in its plane; not programmed values stay."""

    def __init__(self, column: int, options: dict[str, Node] | None) -> None:
        super().__init__(column, independent=True)
        self.options = options

    def change(self, channel: Channel, state: ModalState, execution: Flow, line: Line) -> None:
        coordinates = state.coordinates
        if self.options is None:
            coordinates.turn = None
            return
        given = {name: bounded(node, execution.values) for name, node in self.options.items()}
        plane = plane_axes(channel, state, line.source, "#ROTATION")
        scale = coordinates.unit
        coordinates.plane = plane
        coordinates.turn = (
            given.get("ANGLE", 0.0), given.get("CENTER1", 0.0) * scale, given.get("CENTER2", 0.0) * scale
        )  # fmt: skip


class Scale(CoordinateCommand):
    """#SCALE: factors of axes, switched on and off."""

    def __init__(self, column: int, factors: Sequence[tuple[str, Node, int]], switch: str) -> None:
        super().__init__(column, independent=True)
        self.factors, self.switch = factors, switch

    def change(self, channel: Channel, state: ModalState, execution: Flow, line: Line) -> None:
        coordinates = state.coordinates
        if self.factors and coordinates.scaled:
            raise faults.SCALE_ACTIVE.at(line.source, self.column)
        plane = () if coordinates.kinematics is None else coordinates.kinematics.plane
        scale = list(coordinates.scale or (1.0,) * len(channel.axes))
        for axis, node, column in self.factors:
            index = axis_index(channel, line, axis, column)
            if axis in channel.rotary and index not in plane:
                raise faults.SCALE_ROTARY.at(line.source, column, axis=axis)
            value = bounded(node, execution.values)
            if value <= 0.0:
                raise faults.SCALE_FACTOR.at(line.source, column, value=number(value), axis=axis)
            scale[index] = value
        coordinates.scale = tuple(scale)
        if self.switch:
            coordinates.scaled = self.switch == "ON"


def axis_index(channel: Channel, line: Line, axis: str, column: int) -> int:
    index = channel.axis_index.get(axis)
    if index is None:
        raise AXIS_UNKNOWN.at(line.source, column, word=axis, known=", ".join(channel.axes))
    return index


class SystemCommand(CoordinateCommand):
    """#CS, #ACS: DEF stores a coordinate system, ON switches it on within those that are on, OFF switches one off."""

    def __init__(
        self, column: int, command: str, action: str, identity: Node | None, values: Sequence[Node | None]
    ) -> None:
        super().__init__(column, independent=True)
        self.command, self.action, self.identity, self.values = command, action, identity, values

    def change(self, channel: Channel, state: ModalState, execution: Flow, line: Line) -> None:
        coordinates = state.coordinates
        if self.action != "DEF":
            require_same_system(state, line.source, self.column, f"{self.command} {self.action}")
        if coordinates.outside is not None:
            raise faults.IN_MACHINE.at(line.source, self.column, command=self.command)
        if self.action.startswith("OFF"):
            self._off(state, line)
            return
        key = (self.command, self._number(state, execution, line))
        defined = dict(coordinates.defined or {})
        if self.values:
            given = [0.0 if node is None else bounded(node, execution.values) for node in self.values]
            lengths = [value * coordinates.unit for value in given[:3]]
            defined[key] = (*lengths, *given[3:], *[0.0] * (6 - len(given)))
            coordinates.defined = defined
            coordinates.last_defined = {**(coordinates.last_defined or {}), self.command: key[1]}
        if key not in defined:
            raise faults.SYSTEM_UNKNOWN.at(line.source, self.column, command=self.command, number=key[1])
        if self.action == "ON":
            self._on(channel, state, line, defined[key])

    def _number(self, state: ModalState, execution: Flow, line: Line) -> int:
        if self.identity is None:
            return 1 if self.values else (state.coordinates.last_defined or {}).get(self.command, 1)
        value = bounded(self.identity, execution.values)
        if value != int(value) or not 1 <= value <= LAST_SYSTEM:
            shown = number(value)
            raise faults.SYSTEM_NUMBER.at(line.source, self.identity.column, number=shown, limit=LAST_SYSTEM)
        return int(value)

    def _on(self, channel: Channel, state: ModalState, line: Line, values: tuple[float, ...]) -> None:
        coordinates = state.coordinates
        depth = len(coordinates.systems) + 1
        if depth > DEEPEST:
            raise faults.SYSTEM_DEPTH.at(line.source, self.column, command=self.command, depth=depth, limit=DEEPEST)
        system = system_of(self.command, values, coordinates.own)
        plane = None if coordinates.kinematics is None else coordinates.kinematics.plane
        for place, index in enumerate(main_axes(channel.main, plane)):
            mixed = [system.rotation[place][other] for other in range(3) if other != place]
            if index < 0 and (any(mixed) or system.shift[place]):
                raise faults.MAIN_AXIS_MISSING.at(line.source, self.column, word=self.command, axis="XYZ"[place])
        if self.command == "#ACS":
            coordinates.systems = self._below_workpiece(coordinates.systems, system)
        else:
            coordinates.systems = (*coordinates.systems, system)
            coordinates.own = NO_OFFSETS

    def _below_workpiece(self, systems: tuple[System, ...], system: System) -> tuple[System, ...]:
        """The fixture lies below all workpiece systems and has no offsets of its own."""
        fixtures = [each for each in systems if each.command == "#ACS"]
        others = [each for each in systems if each.command != "#ACS"]
        return (*fixtures, system._replace(before=NO_OFFSETS), *others)

    def _off(self, state: ModalState, line: Line) -> None:
        coordinates = state.coordinates
        of_kind = [place for place, system in enumerate(coordinates.systems) if system.command == self.command]
        if not of_kind:
            raise faults.SYSTEM_NONE.at(line.source, self.column, command=self.command)
        for place in reversed(of_kind if self.action == "OFF ALL" else of_kind[-1:]):
            if self.command == "#CS":
                coordinates.own = coordinates.systems[place].before
            coordinates.systems = (*coordinates.systems[:place], *coordinates.systems[place + 1 :])


class MachineCoordinates(CoordinateCommand):
    """#MCS ON: positions are those of the machine; #MCS OFF brings back what was before."""

    def __init__(self, column: int, *, on: bool) -> None:
        super().__init__(column, independent=True)
        self.on = on

    def change(self, channel: Channel, state: ModalState, execution: Flow, line: Line) -> None:
        coordinates = state.coordinates
        require_same_system(state, line.source, self.column, "#MCS ON" if self.on else "#MCS OFF")
        kinematics = coordinates.kinematics
        if kinematics is not None:
            raise NOT_WITH_KINEMATICS.at(line.source, self.column, word="#MCS", command=kinematics.name)
        if self.on == (coordinates.outside is not None):
            raise (faults.MACHINE_ON if self.on else faults.MACHINE_OFF).at(line.source, self.column)
        if self.on:
            coordinates.leave()
        else:
            coordinates.come_back()


class Preset(CoordinateCommand):
    """#PSET X10: the present position of axes gets this value; #PRESET takes that back, for the named axes or all."""

    def __init__(self, column: int, axes: Sequence[tuple[str, Node, int]], *, on: bool) -> None:
        super().__init__(column, independent=True)
        self.axes, self.on = axes, on

    def change(self, channel: Channel, state: ModalState, execution: Flow, line: Line) -> None:
        coordinates = state.coordinates
        command = "#PSET" if self.on else "#PRESET"
        if coordinates.mirror or coordinates.turn is not None or coordinates.scaled:
            what = "the contour is mirrored, rotated or scaled"
            raise faults.MIRROR_PRESET.at(line.source, self.column, command=command, what=what)
        preset = list(coordinates.own.preset or (0.0,) * len(channel.axes))
        for axis, node, column in self.axes:
            index = axis_index(channel, line, axis, column)
            if not self.on:
                preset[index] = 0.0
                continue
            value = bounded(node, execution.values) * (1.0 if axis in channel.rotary else coordinates.unit)
            preset[index] += state.programmed[index] - value
        if not self.on and not self.axes:
            preset = [0.0] * len(preset)
        coordinates.own = coordinates.own._replace(preset=tuple(preset))


def read_rotation(line: Line, text: str, end: int, column: int) -> None:
    words = Words(line, text, end, "#ROTATION", ROTATION)
    switch = words.takes("ON", "OFF")
    if not switch:
        raise words.stray() if not words.at_end else words.missing("ON or OFF")
    options = words.options("ANGLE", "CENTER1", "CENTER2") if switch == "ON" else None
    words.require_end()
    line.statement = Rotation(column, options)
    line.synchronises = words.reader.synchronises


def read_scale(line: Line, text: str, end: int, column: int) -> None:
    words = Words(line, text, end, "#SCALE", SCALE)
    switch = words.takes("ON", "OFF")
    factors = [] if switch == "OFF" else words.axes()
    words.require_end()
    if not switch and not factors:
        raise words.missing("ON, OFF or factors")
    line.statement = Scale(column, factors, switch)
    line.synchronises = words.reader.synchronises


def read_system(line: Line, text: str, end: int, column: int) -> None:
    command = "#ACS" if "ACS" in text[column - 1 : end] else "#CS"
    words = Words(line, text, end, command, system_syntax(command))
    action = words.takes("DEF", "ON", "OFF")
    if not action:
        raise words.stray() if not words.at_end else words.missing("DEF, ON or OFF")
    identity: Node | None = None
    values: list[Node | None] = []
    if action == "OFF":
        action = f"OFF {words.takes('ALL')}".rstrip()
    while not words.at_end and text.startswith("[", words.reader.at):
        found = words.items()
        if len(found) == 1 and not values and identity is None:
            identity = found[0]
            continue
        if values or len(found) > 6:
            raise faults.SYSTEM_VALUES.at(line.source, words.reader.at, command=command)
        values = found
    words.require_end()
    if action == "DEF" and not values:
        raise words.missing("values")
    line.statement = SystemCommand(column, command, action, identity, values)
    line.synchronises = words.reader.synchronises


def read_machine_coordinates(line: Line, text: str, end: int, column: int) -> None:
    words = Words(line, text, end, "#MCS", MACHINE)
    switch = words.takes("ON", "OFF")
    if not switch:
        raise words.stray() if not words.at_end else words.missing("ON or OFF")
    if switch == "ON" and words.reader.line[words.reader.skip_blanks() :].replace(" ", "").startswith("[EXTOOL]"):
        raise faults.MACHINE_TOOL.at(line.source, words.reader.at + 1)
    words.require_end()
    line.statement = MachineCoordinates(column, on=switch == "ON")


def read_preset(line: Line, text: str, end: int, column: int) -> None:
    on = "PSET" in text[column - 1 : end]
    words = Words(line, text, end, "#PSET" if on else "#PRESET", PSET if on else PRESET)
    axes = words.axes(alone=not on)
    if on and not axes:
        raise words.missing("an axis")
    line.statement = Preset(column, axes, on=on)
    line.synchronises = words.reader.synchronises

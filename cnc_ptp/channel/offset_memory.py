"""The offsets of a channel beyond a program: tables as they were changed, the clamp position, what its topic shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cnc_ptp.errors import CncError, Value, did_you_mean, nearest
from cnc_ptp.kinematics.kinematics import Kinematics
from cnc_ptp.nc.canonical import OffsetReport
from cnc_ptp.nc.coordinates.codes import LAST_OFFSET, default_offset, inactive_axes, offset_values
from cnc_ptp.nc.coordinates.coordinates import NO_CHANGES, Coordinates
from cnc_ptp.nc.coordinates.frame import IDENTITY, Frame, main_axes, matrix
from cnc_ptp.nc.coordinates.report import offset_report
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel
from cnc_ptp.parameters.list_units import LARGEST_POSITION
from cnc_ptp.protocol.blocks import ChannelOffsets

NO_SUCH_OFFSET = 22030
NO_SUCH_AXIS = 22031
OFFSET_RANGE = 22032
NO_SUCH_CLAMP_POSITION = 22033
LAST_CLAMP_POSITION = 149


class OffsetMemory:
    """Zero offsets as commands and programs have changed them, and the clamp position of the next program."""

    def __init__(self, unit: str, channel: Channel) -> None:
        self._unit, self._channel = unit, channel
        self.changes = NO_CHANGES
        self.clamp_index = 0
        self._shown: OffsetReport | None = None
        self._shown_changes = NO_CHANGES
        self._news: list[ChannelOffsets] = []
        self._frame: Frame | None = None
        self._kinematics: Kinematics | None = None
        self._stale = True
        """What is shown may not be what an MDI text would start with."""

    # commands

    def set(self, command: str, index: int, values: Mapping[int, float]) -> None:
        """Changes the values of a zero offset for some axes, by their places. Raises CncError 22030, 22032.

        Those of a facing axis are diameters with P-CHAN-00091.
        """
        self.require_index(command, index)
        table = list(offset_values(self._channel, self.changes, index))
        for place, value in values.items():
            if not -LARGEST_POSITION <= value <= LARGEST_POSITION:
                axis = self._channel.axes[place]
                unit = "deg" if axis in self._channel.rotary else "mm"
                limits = f"-{LARGEST_POSITION} ... {LARGEST_POSITION} {unit}"
                reason = f"axis {axis}: {value:g} {unit} is not within {limits}"
                named = {"angle" if unit == "deg" else "position": value, "limit": LARGEST_POSITION}
                raise self._refusal(command, OFFSET_RANGE, reason, **named)
            table[place] = value * self._channel.turning.offset_factor(place)
        self.changes = self.changes._replace(values={**self.changes.values, index: tuple(table)})

    def teach(
        self, command: str, index: int, axis: str, value: float, position: Sequence[float], state: Coordinates
    ) -> None:
        """The present position becomes `value` in a zero offset: of one axis, or of all if it is empty.

        Clamp position and tool lie below the zero offset. `value` of a facing axis is a radius. Raises CncError 22030,
        22031, 22032.
        """
        places = [self.place(command, axis)] if axis else range(len(self._channel.axes))
        offsets = {place: position[place] - below(state, place) - value for place in places}
        factor = self._channel.turning.offset_factor
        self.set(command, index, {place: offset / factor(place) for place, offset in offsets.items()})

    def choose_clamp_position(self, command: str, index: int) -> None:
        """Raises CncError 22033."""
        if not 0 <= index <= LAST_CLAMP_POSITION:
            reason = f"index = {index} is not within 0 ... {LAST_CLAMP_POSITION}"
            raise self._refusal(command, NO_SUCH_CLAMP_POSITION, reason, index=index)
        known = self._channel.offsets.clamp
        if index and index not in known:
            listed = ", ".join(map(str, known)) or "none"
            reason = f"the machine file has no clamp position {index} (P-CLMP-00001: {listed})"
            raise self._refusal(command, NO_SUCH_CLAMP_POSITION, reason, index=index)
        self.clamp_index = index

    def require_index(self, command: str, index: int) -> None:
        first = 0 if self._channel.offsets.g53 else 1
        if not first <= index <= LAST_OFFSET:
            why = "" if index else "; G53 selects no offset (P-ZERO-00001)"
            reason = f"index = {index} is not within {first} ... {LAST_OFFSET}{why}"
            raise self._refusal(command, NO_SUCH_OFFSET, reason, index=index)

    def place(self, command: str, axis: str) -> int:
        """Place of an axis by its name in programs. Raises CncError 22031."""
        place = self._channel.axis_index.get(axis)
        if place is None:
            known = ", ".join(self._channel.axes)
            close = did_you_mean(nearest(axis.upper(), self._channel.axes, cutoff=0.5))
            raise self._refusal(command, NO_SUCH_AXIS, f"'{axis}' is no axis of the channel ({known}){close}")
        return place

    def give(self, coordinates: Coordinates) -> None:
        """To the state in which MDI texts start: it counts as soon as an offset is selected next."""
        coordinates.changes, coordinates.clamp_index = self.changes, self.clamp_index
        coordinates.lasting().clamp = self._channel.offsets.clamp.get(self.clamp_index, ())
        self._stale = True

    def _refusal(self, command: str, number: int, reason: str, **values: Value) -> CncError:
        where = f"channel {self._unit}: {command} refused"
        return CncError(number, reason, "nothing was changed", where=where, **values)

    # what is shown

    def begin(self, cycle: int, state: ModalState) -> None:
        """A program starts with these."""
        self.reach(cycle, 0, offset_report(self._channel, state))

    def rest(self, cycle: int, state: ModalState) -> None:
        """No program runs: those with which an MDI text would start."""
        if self._stale:
            self.begin(cycle, state)
            self._stale = False

    def reach(self, cycle: int, line: int, report: OffsetReport) -> None:
        """The path has reached a block that changes them."""
        self._stale = True
        if report == self._shown and self.changes == self._shown_changes:
            return
        self._shown, self._shown_changes, self._kinematics = report, self.changes, report.kinematics
        linear, none = matrix([report.matrix[row : row + 3] for row in (0, 3, 6)]), not any(report.shift)
        same = none and linear == IDENTITY
        plane = None if report.kinematics is None else report.kinematics.plane
        main = main_axes(self._channel.main, plane)
        self._frame = None if same else Frame(linear, report.shift, main)
        self._news.append(self._message(cycle, line, report))

    def news(self) -> list[ChannelOffsets]:
        """What has changed since it was asked last."""
        news, self._news = self._news, []
        return news

    def programmed(self, position: Sequence[float]) -> list[float]:
        """A machine position as programs name it now; radii also where `shown` has diameters."""
        if self._kinematics is not None:
            position = self._kinematics.forward(tuple(position))
        return list(position if self._frame is None else self._frame.to_programmed(position))

    def shown(self, position: Sequence[float]) -> list[float]:
        """A machine position as it is displayed: the facing axis in diameters with G51, if P-CHAN-00256 wants that."""
        programmed = self.programmed(position)
        if self._shown is not None and self._shown.diameter >= 0:
            programmed[self._shown.diameter] *= 2.0
        return programmed

    def _message(self, cycle: int, line: int, report: OffsetReport) -> ChannelOffsets:
        channel, changes, places = self._channel, self.changes, range(len(self._channel.axes))
        changed = sorted(changes.values.keys() | changes.inactive.keys())
        inactive = [inactive_axes(channel, changes, index) for index in changed]
        return ChannelOffsets(
            cycle=cycle,
            line=line,
            axes=list(channel.axes),
            zero_index=report.zero_index,
            zero_name=channel.offsets.names.get(report.zero_index, ""),
            zero_offset=list(report.zero),
            reference_offset=list(report.added),
            preset=list(report.preset),
            clamp_index=report.clamp_index,
            clamp_offset=list(report.clamp),
            tool_offset=list(report.tool),
            scale=list(report.scale),
            mirrored=list(report.mirrored),
            rotated=report.angle is not None,
            rotation_angle=report.angle or 0.0,
            systems=[*([report.kinematics.name] if report.kinematics is not None else []), *report.systems],
            machine_coordinates=report.machine,
            matrix=list(report.matrix),
            shift=list(report.shift),
            origin=[] if report.kinematics is None else list(report.kinematics.origin),
            default_index=default_offset(channel, changes),
            changed_indices=changed,
            changed_offsets=[value for index in changed for value in offset_values(channel, changes, index)],
            changed_inactive=[place in axes for axes in inactive for place in places],
        )


def below(state: Coordinates, place: int) -> float:
    """What clamp position and tool add to an axis, outside #MCS."""
    lasting = state.outside or state
    return sum(offsets[place] for offsets in (lasting.clamp, lasting.tool) if offsets)

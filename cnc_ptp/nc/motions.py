"""Motions of a block: builders for G00, G01 (straight), G02, G03 (circular) and G04 (dwell), named in the G table.

Each takes (channel, state, block, code), reads the block's words, updates feed and radius in the state and returns the
motion with an absolute target, or None if the block goes nowhere. The interpreter sets the position in the state.
"""

from typing import NamedTuple

from cnc_ptp.errors import Value
from cnc_ptp.nc import arcs, faults, feeds, turning
from cnc_ptp.nc.canonical import CircularMove, Dwell, LinearMove, number
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.spindles import current_main


class Plane(NamedTuple):
    """Main plane: first and second axis, and the words for the centre along them."""

    axes: tuple[str, str]
    centre_words: tuple[str, str]


PLANES = {
    17: Plane(("X", "Y"), ("I", "J")),
    18: Plane(("Z", "X"), ("K", "I")),
    19: Plane(("Y", "Z"), ("J", "K")),
}


CARTESIAN_PLANE = 17
"""That of the two axes of a kinematics, the centre of an arc is given by I and J."""


def target_of(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> list[float] | None:
    """Target of all axes (G90 absolute, G91 relative), None if the block names no axis; takes F into the state."""
    target: list[float] | None = None
    axis_index = channel.axis_index
    position = state.programmed
    unit = state.coordinates.unit
    for word, value in block.words.items():
        index = axis_index.get(word)
        if index is not None:
            if target is None:
                target = list(position)
            if unit != 1.0 and is_length(channel, state, word):
                value *= unit
            target[index] = value if state.absolute else position[index] + value
        elif word == "F":
            if value < 0.0:
                raise faults.FEED_NEGATIVE.at(block.source, block.source.column("F"), value=number(value))
            feeds.note(state, value)
        elif word not in channel.vocabulary.function_words and word not in code.words:
            if any(word in other.words for other in block.codes):
                continue
            raise _unused(channel, block, code, word)
    if target is not None and state.turning.diameter is not None:
        turning.take_diameter(channel, state, block, target)
    return target


def is_length(channel: Channel, state: ModalState, axis: str) -> bool:
    """Its words are lengths: it is linear, or the C axis behind a kinematics (#FACE, #CYL)."""
    return axis not in channel.rotary or (state.coordinates.kinematics is not None and axis == channel.table.c_axis)


def _unused(channel: Channel, block: NcBlock, code: GCode, word: str) -> faults.ProgramError:
    column = block.source.column(word)
    if word[0] not in channel.vocabulary.axis_letters:
        return faults.WORD_NOT_USED.at(block.source, column, word=word, g=code.name)
    return faults.AXIS_UNKNOWN.at(block.source, column, word=word, known=", ".join(channel.axes))


def rapid(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> LinearMove | None:
    """G00: straight to the target at rapid speed."""
    target = target_of(channel, state, block, code)
    return None if target is None else LinearMove(tuple(target), True, 0.0)


def straight(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> LinearMove | None:
    """G01: straight to the target at the feed."""
    target = target_of(channel, state, block, code)
    if target is None:
        return None
    feeds.require_feed(state, block, code)
    return LinearMove(tuple(target), False, state.feed)


def circular(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> CircularMove | None:
    """G02, G03: arc in the active plane by centre (I, J, K) or radius (R, kept until the next R).

    Target equal to the start: full circle. The axes outside the plane move linearly alongside.
    """
    target = target_of(channel, state, block, code)
    words = block.words
    given = [word for word in "IJK" if word in words]
    if "R" in words:
        if given:
            raise faults.CENTRE_AND_RADIUS.at(block.source, block.source.column(given[0]), word=given[0])
        state.radius = words["R"] * state.coordinates.unit
    if target is None and not given:
        return None
    feeds.require_feed(state, block, code)
    arc = _Arc(channel, state, block, code, target or list(state.programmed))
    return arc.by_centre(given) if given else arc.by_radius()


class _Arc:
    """One arc while it is being resolved: start and target in the plane, both as points."""

    def __init__(self, channel: Channel, state: ModalState, block: NcBlock, code: GCode, target: list[float]) -> None:
        self.channel, self.state, self.block, self.code, self.target = channel, state, block, code, target
        self.plane = PLANES[state.plane] if state.coordinates.kinematics is None else PLANES[CARTESIAN_PLANE]
        self.indices = self._indices()
        first, second = self.indices
        self.start = (state.programmed[first], state.programmed[second])
        self.end = (target[first], target[second])
        self.full = arcs.distance(self.start, self.end) < arcs.RESOLUTION

    def _indices(self) -> tuple[int, int]:
        kinematics = self.state.coordinates.kinematics
        if kinematics is not None:
            return kinematics.plane
        first, second = (self.channel.axis_index.get(axis) for axis in self.plane.axes)
        if first is None or second is None:
            needed, known = " and ".join(self.plane.axes), ", ".join(self.channel.axes)
            raise self._fault(faults.PLANE_AXIS_MISSING, g=f"G{self.state.plane}", needed=needed, known=known)
        return first, second

    def _fault(self, fault: faults.Fault, place: str = "", **values: Value) -> faults.ProgramError:
        return fault.at(self.block.source, self.block.source.column(place or self.code.name), **values)

    def by_centre(self, given: list[str]) -> CircularMove:
        """Centre from I, J, K: relative to the start (G162) or absolute (G161); a missing word is 0."""
        for word in given:
            if word not in self.plane.centre_words:
                kinematics = self.state.coordinates.kinematics
                g = f"G{self.state.plane}" if kinematics is None else kinematics.name
                plane = "".join([self.channel.axes[index] for index in self.indices])
                raise self._fault(faults.CENTRE_NOT_IN_PLANE, word, word=word, g=g, plane=plane)
        unit = self.state.coordinates.unit
        first, second = (self.block.words.get(word, 0.0) * unit for word in self.plane.centre_words)
        if not self.state.centre_absolute:
            first, second = first + self.start[0], second + self.start[1]
        if arcs.distance((first, second), self.start) < arcs.RESOLUTION:
            raise self._fault(faults.RADIUS_ZERO, given[0])
        if self.full:
            return self._full_circle((first, second))
        return self._corrected((first, second), given[0])

    def _full_circle(self, centre: arcs.Point) -> CircularMove:
        first, second = self.indices
        self.target[first], self.target[second] = self.start
        sweep = -360.0 if self.code.number == 2 else 360.0
        return self._move(centre, arcs.distance(centre, self.start), sweep)

    def _corrected(self, centre: arcs.Point, word: str) -> CircularMove:
        """Centre correction G165: the centre moves until both radii are equal, within P-CHAN-00059 and P-CHAN-00060."""
        moved = arcs.correct_centre(self.start, self.end, centre)
        limit = min(self.channel.centre_offset, self.channel.centre_offset_ratio * moved.radius)
        if moved.offset > limit + 1e-9:
            raise self._radii_differ(centre, moved, limit, word)
        return self._arc(moved.centre, moved.radius)

    def _radii_differ(
        self, centre: arcs.Point, moved: arcs.CorrectedCentre, limit: float, word: str
    ) -> faults.ProgramError:
        at_start, at_target = arcs.distance(centre, self.start), arcs.distance(centre, self.end)
        return self._fault(
            faults.RADII_DIFFER,
            word,
            start=number(at_start),
            target=number(at_target),
            difference=number(abs(at_start - at_target)),
            offset=number(moved.offset),
            limit=number(limit),
            absolute=number(self.channel.centre_offset),
            percent=number(self.channel.centre_offset_ratio * 100.0),
            radius=number(moved.radius),
        )

    def by_radius(self) -> CircularMove:
        """Centre from the last R; the sign chooses the arc below or above 180 degrees."""
        radius = self.state.radius
        word = "R" if "R" in self.block.words else ""
        if radius == 0.0 and not word:
            words = ", ".join(self.plane.centre_words)
            raise self._fault(faults.ARC_WITHOUT_CENTRE, g=self.code.name, words=words)
        if abs(radius) < arcs.RESOLUTION:
            raise self._fault(faults.RADIUS_ZERO, word)
        if self.full:
            raise self._fault(faults.FULL_CIRCLE_BY_RADIUS, word)
        found = arcs.centre_from_radius(self.start, self.end, radius, self.code.number == 2)
        if found is None:
            chord, limit = number(arcs.distance(self.start, self.end)), number(2.0 * abs(radius))
            raise self._fault(faults.RADIUS_TOO_SMALL, word, radius=number(radius), chord=chord, limit=limit)
        return self._arc(*found)

    def _arc(self, centre: arcs.Point, radius: float) -> CircularMove:
        return self._move(centre, radius, arcs.swept_angle(self.start, self.end, centre, self.code.number == 2))

    def _move(self, centre: arcs.Point, radius: float, sweep: float) -> CircularMove:
        return CircularMove(tuple(self.target), centre, self.indices, radius, sweep, self.state.feed)


def dwell(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> Dwell:
    """G04, alone in its block: seconds as a number without a letter, by the first main axis or F; revolutions by S."""
    duration_words = ["F", "S", *channel.axes[:1]]
    times = {word: value for word, value in block.words.items() if word in duration_words}
    others = [word for word in block.words if word not in times]
    others += [m.name for m in block.m] + [words.name for words in [*block.spindles, *block.controls]]
    others += [other.name for other in block.codes if other is not code]
    others += list(times)[1:]
    if others:
        raise faults.DWELL_NOT_ALONE.at(block.source, block.source.column(others[0]), word=others[0])
    if block.direct is not None and times:
        word = next(iter(times))
        raise faults.DWELL_TWICE.at(block.source, block.source.column(word), word=word)
    if block.direct is None and not times:
        raise faults.DWELL_MISSING.at(block.source, block.source.column(code.name))
    seconds = block.direct if block.direct is not None else _seconds(channel, state, block, times)
    if seconds < 0.0:
        raise faults.DWELL_NEGATIVE.at(block.source, block.source.column(code.name), value=number(seconds))
    return Dwell(seconds)


def _seconds(channel: Channel, state: ModalState, block: NcBlock, times: dict[str, float]) -> float:
    word, value = next(iter(times.items()))
    if word != "S":
        return value
    speed = state.speeds.get(current_main(channel, state).key, 0.0) if channel.table.spindles else 0.0
    if speed <= 0.0:
        main = channel.table.main_name
        raise faults.DWELL_WITHOUT_SPEED.at(block.source, block.source.column("S"), spindle=main)
    return value / speed * 60.0

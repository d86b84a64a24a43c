"""The stage between the interpreter's blocks and the canonical stream that compensates the radius of the tool.

It takes the motions as they lie in the machine, with offsets, mirror, rotation and scale in them: the radius of a tool
is no length of the drawing, so a scale must not change it, an offset that changes on the contour moves what is cut from
there on, and left becomes right where the plane is mirrored. What programs read are the programmed positions, since the
interpreter has passed them already. Blocks without motion in the plane stay at their place behind the motion before
them.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from typing import Final

from cnc_ptp.nc import faults as nc_faults
from cnc_ptp.nc.awaited import awaits_path
from cnc_ptp.nc.block_search import BlockSearch
from cnc_ptp.nc.canonical import (
    BEGIN,
    BUSY,
    CanonicalBlock,
    CircularMove,
    FeedPerTurn,
    HomeAxes,
    KinematicsChange,
    LanguageWarning,
    LinearMove,
    Motion,
    Source,
    SpindleAxis,
    number,
)
from cnc_ptp.nc.coordinates.limits import check_limits
from cnc_ptp.nc.coordinates.placement import PLANE_AXES
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.feeds import INVERSE, TIME
from cnc_ptp.nc.measuring import measures
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel
from cnc_ptp.nc.radius import radius_faults as faults
from cnc_ptp.nc.radius.contour_path import ArcTooSmall, ContourPath, Element, TooNarrow
from cnc_ptp.nc.radius.entries import Entry
from cnc_ptp.nc.radius.shapes import Arc, Line, Point, Shape, distance
from cnc_ptp.nc.radius.tool_radius import CENTRE, radius_of, tip_of, tool_of
from cnc_ptp.nc.radius.working_plane import WorkingPlane, working_plane
from cnc_ptp.nc.recovery import Recovery
from cnc_ptp.nc.tools.tool_state import NO_TOOL

NO_LENGTH: Final = 1e-9
"""mm: a shorter motion in the plane is none."""

CheckMotion = Callable[[tuple[float, ...], LinearMove | CircularMove, Source], None]
"""Refuses a motion from a position that leaves the limits of the axes."""


class RadiusCompensation:
    """Compensates the blocks of one program; `here` is where the tool is behind the last one."""

    def __init__(
        self,
        channel: Channel,
        state: ModalState,
        check: CheckMotion,
        search: BlockSearch | None,
        source: Source,
        recovery: Recovery | None = None,
    ) -> None:
        """`search` that is going on; `source` of the program; `recovery`: takes errors of G41 without a tool."""
        self._channel, self._state, self._check = channel, state, check
        self._search, self._recovery = search, recovery
        self._source = source
        """Of the last block with compensation."""
        self._here = state.position
        self._side = 0
        """Left (1) or right (-1) of the contour in the plane; 0: the tool is not beside one."""
        self._plane = WorkingPlane((0, 1))
        self._radius = 0.0
        self._tip = CENTRE
        self._entries: deque[Entry] = deque()
        """Blocks that wait, the motion to the contour first if it does."""
        self._others = 0
        """Blocks without motion in the plane behind the last one with it."""
        self._path: ContourPath | None = None
        self._approaches = False
        """The motion to the contour waits for the first element, which says where it ends."""

    def over(self, stream: Iterator[CanonicalBlock]) -> Iterator[CanonicalBlock]:
        """The blocks of a program with compensated motions. Raises ProgramError."""
        state = self._state
        while True:
            before = state.position
            block = next(stream, None)
            if block is None:
                break
            if block is BUSY or not state.radius_compensation.on:
                yield block
                continue
            self._source = self._source if block is BEGIN else block.source
            if block.stop != "end":
                yield from self._take(block, before)
                continue
            if block.motion is not None:
                yield from self._take(block._replace(stop=""), before)
                block = CanonicalBlock(block.source, (), None, "end", calls=block.calls)
            yield from self._ended(block)
        if state.radius_compensation.on:
            yield from self._ended(CanonicalBlock(self._source, (), None, ""))

    def _ended(self, block: CanonicalBlock) -> Iterator[CanonicalBlock]:
        """The end of the program or MDI text: the last element ends as if G40 came behind it."""
        yield from self._finish_contour()
        self._side = 0
        before = self._state.radius_compensation
        self._state.radius_compensation = before._replace(side=0, engaged=False)
        if before.side:
            text = f"the tool radius is still compensated ({before.code}) at the end of the program"
            block = block._replace(functions=(*block.functions, LanguageWarning(faults.STILL_ON, text)))
        if block.functions or block.stop:
            yield block

    def _take(self, block: CanonicalBlock, before: tuple[float, ...]) -> Iterator[CanonicalBlock]:
        if awaits_path(block):
            raise self._at(faults.NOT_WHILE, block, what=wait_of(block))
        if block.motion is not None and self._state.feed_mode in (TIME, INVERSE):
            raise self._at(faults.NOT_WHILE, block, what="a feed by time (G93)")
        if isinstance(block.motion, LinearMove) and block.motion.thread is not None:
            raise self._at(faults.NOT_WHILE, block, what="a thread (G33, G34, G35)")
        entry = Entry(block, self._state.coordinates.limits, contour_feed=self._state.radius_compensation.contour_feed)
        if not self._side:
            yield from self._before_contour(entry, before)
        elif not self._state.radius_compensation.side:
            yield from self._behind_contour(entry, before)
        elif not self._in_plane(block, before):
            yield from self._put_beside(entry)
        elif self._path is None:
            yield from self._begin_contour(entry)
        elif self._effective_side() != self._side:
            yield from self._finish_contour()
            self._approach(entry, faults.SIDE_ARC)
        elif (moved := self._moved(block.motion, before)) is not None:
            yield from self._add_element(entry, moved)
        else:
            yield from self._put_beside(entry)

    # to the contour and from it

    def _before_contour(self, entry: Entry, before: tuple[float, ...]) -> Iterator[CanonicalBlock]:
        self._here = before
        block, motion = entry.block, entry.block.motion
        if not isinstance(motion, (LinearMove, CircularMove)):
            yield block
        elif self._names_plane(block):
            yield from self._begin_contour(entry)
        else:
            yield from self._carried_out(entry, motion)

    def _begin_contour(self, entry: Entry) -> Iterator[CanonicalBlock]:
        """Behind an error a check continues as with G40: no contour of this G41 or G42 can be checked."""
        try:
            self._engage(entry.block)
        except ProgramError as error:
            if self._recovery is None:
                raise
            self._recovery.of_block(error, entry.block)
            self._side = 0
            self._state.radius_compensation = self._state.radius_compensation._replace(side=0, engaged=False)
            yield entry.block
            return
        self._approach(entry, faults.APPROACH_ARC)

    def _engage(self, block: CanonicalBlock) -> None:
        """Takes plane and tool, which stay until the departure. Raises ProgramError."""
        state, code = self._state, self._state.radius_compensation.code
        names = self._plane_names
        first, second = (self._channel.axis_index.get(name) for name in names)
        if first is None or second is None:
            known = ", ".join(self._channel.axes)
            needed = " and ".join(names)
            raise self._at(nc_faults.PLANE_AXIS_MISSING, block, g=self._plane_code, needed=needed, known=known)
        plane = working_plane(state.frame, first, second)
        if plane is None:
            raise self._at(faults.SCALED_PLANE, block, g=code)
        tool = tool_of(state)
        if not radius_of(tool) and (tool is NO_TOOL or not self._channel.tools.present):
            raise self._at(faults.NO_RADIUS, block, g=code)
        self._plane, self._radius, self._tip = plane, radius_of(tool), tip_of(tool)
        if plane.directions is not None and self._tip != CENTRE:
            raise self._at(faults.TILTED_TIP, block, g=code)
        if state.coordinates.kinematics is not None and self._tip != CENTRE:
            raise self._at(faults.CARTESIAN_TIP, block, g=code, command=self._plane_code)
        state.radius_compensation = state.radius_compensation._replace(engaged=True)

    def _approach(self, entry: Entry, fault: nc_faults.Fault) -> None:
        """The motion to the contour ends beside the start of the next element, at right angles to it."""
        if not isinstance(entry.block.motion, LinearMove):
            raise self._at(fault, entry.block, g=self._state.radius_compensation.code)
        self._side = self._effective_side()
        self._path = ContourPath(self._side * abs(self._radius), self._channel.radius.look_ahead)
        self._entries.append(entry)
        self._others, self._approaches = 0, True

    def _behind_contour(self, entry: Entry, before: tuple[float, ...]) -> Iterator[CanonicalBlock]:
        """G40 is programmed: the next motion in the plane leads from the contour to its programmed end."""
        yield from self._finish_contour()
        block = entry.block
        if not self._in_plane(block, before):
            yield from self._beside(entry)
            return
        if not isinstance(block.motion, LinearMove):
            raise self._at(faults.DEPARTURE_ARC, block)
        self._side = 0
        self._state.radius_compensation = self._state.radius_compensation._replace(engaged=False)
        yield from self._carried_out(entry, block.motion)

    # along the contour

    def _effective_side(self) -> int:
        state = self._state
        side = state.radius_compensation.side * self._plane.handedness(state.frame)
        return -side if self._radius < 0.0 else side

    def _in_plane(self, block: CanonicalBlock, before: tuple[float, ...]) -> bool:
        return self._names_plane(block) or self._moved(block.motion, before) is not None

    def _names_plane(self, block: CanonicalBlock) -> bool:
        """An arc, or a straight line whose words name an axis of the plane."""
        if isinstance(block.motion, CircularMove):
            return True
        return isinstance(block.motion, LinearMove) and any(name in block.source.names for name in self._plane_names)

    @property
    def _plane_names(self) -> tuple[str, str]:
        """Of the axes of the plane: that of G17 to G19, or of #FACE and #CYL."""
        kinematics = self._state.coordinates.kinematics
        if kinematics is None:
            return PLANE_AXES[self._state.plane]
        first, second = kinematics.plane
        return self._channel.axes[first], self._channel.axes[second]

    @property
    def _plane_code(self) -> str:
        """What selects the plane, for errors."""
        kinematics = self._state.coordinates.kinematics
        return f"G{self._state.plane}" if kinematics is None else kinematics.name

    def _moved(self, motion: Motion | None, before: tuple[float, ...]) -> Shape | None:
        """What a motion is in the plane; None if it does not move there."""
        if not isinstance(motion, (LinearMove, CircularMove)):
            return None
        if isinstance(motion, LinearMove):
            ends = self._plane.coordinates(before), self._plane.coordinates(motion.target)
            if distance(*ends) < NO_LENGTH:
                return None
        return self._plane.shape(before, motion)

    def _add_element(self, entry: Entry, shape: Shape) -> Iterator[CanonicalBlock]:
        assert self._path is not None
        entry.element, self._others = True, 0
        self._entries.append(entry)
        motion = entry.block.motion
        rapid = isinstance(motion, LinearMove) and motion.rapid
        try:
            self._path.add(Element(shape, entry, rapid or self._state.radius_compensation.by_lines))
        except ArcTooSmall:
            assert isinstance(shape, Arc)
            values = {"tool": number(abs(self._radius)), "radius": number(shape.radius)}
            raise self._at(faults.ARC_TOO_SMALL, entry.block, **values) from None
        except TooNarrow as fault:
            raise self._narrow(fault) from None
        yield from self._hand_out(all_known=False)

    def _put_beside(self, entry: Entry) -> Iterator[CanonicalBlock]:
        """A block without motion in the plane: at once if nothing waits before it."""
        self._others += 1
        limit = self._channel.radius.other_blocks
        if self._others > limit:
            raise self._at(faults.OTHER_BLOCKS, entry.block, count=self._others, g=self._plane_code, limit=limit)
        if self._entries:
            self._entries.append(entry)
        else:
            yield from self._beside(entry)

    def _finish_contour(self) -> Iterator[CanonicalBlock]:
        """The last element ends at its end, where nothing cuts it. Raises ProgramError without an element."""
        if self._approaches:
            raise self._at(faults.NO_ELEMENT, self._entries[0].block, g=self._plane_code)
        if self._path is not None:
            yield from self._hand_out(all_known=True)
            self._path = None

    def _hand_out(self, *, all_known: bool) -> Iterator[CanonicalBlock]:
        """What will not change."""
        assert self._path is not None
        if self._approaches:
            self._approaches = False
            entry = self._entries.popleft()
            assert isinstance(entry.block.motion, LinearMove)
            target = self._placed(self._path.start, entry.block.motion.target)
            yield from self._carried_out(entry, entry.block.motion._replace(target=target))
            yield from self._others_first()
        try:
            for entry, shape, own in self._path.finished(all_known=all_known):
                yield from self._before(entry)
                if own:
                    self._entries.popleft()
                yield from self._along(entry, shape, own)
                yield from self._others_first()
        except TooNarrow as fault:
            raise self._narrow(fault) from None
        if all_known:
            yield from self._before(None)

    def _others_first(self) -> Iterator[CanonicalBlock]:
        """The blocks without motion in the plane that are next."""
        while self._entries and not self._entries[0].element:
            yield from self._beside(self._entries.popleft())

    def _before(self, entry: Entry | None) -> Iterator[CanonicalBlock]:
        """All that waits before an element; the elements among it have vanished."""
        while self._entries and self._entries[0] is not entry:
            yield from self._beside(self._entries.popleft())

    # blocks

    def _placed(self, point: Point, beside: tuple[float, ...]) -> tuple[float, ...]:
        """Where the axes are with the centre of the tool at a point of the plane."""
        return self._plane.position((point[0] + self._tip[0], point[1] + self._tip[1]), beside)

    def _beside(self, entry: Entry) -> Iterator[CanonicalBlock]:
        """A block without motion in the plane: the tool stays where it is there."""
        block, motion = entry.block, entry.block.motion
        if block is BEGIN:
            assert self._search is not None
            self._search.position = self._here
            yield BEGIN
            return
        if entry.element:
            yield from without_motion(block)
        elif isinstance(motion, LinearMove):
            target = self._plane.position(self._plane.coordinates(self._here), motion.target)
            yield from self._carried_out(entry, motion._replace(target=target))
        else:
            yield block

    def _along(self, entry: Entry, shape: Shape, own: bool) -> Iterator[CanonicalBlock]:
        """A piece of the path: the motion of an element, or one of the corner before it."""
        motion = entry.block.motion
        assert isinstance(motion, (LinearMove, CircularMove))
        target = self._placed(shape.end, motion.target if own else self._here)
        if own and isinstance(motion, LinearMove):
            yield from self._carried_out(entry, motion._replace(target=target))
            return
        transition = motion.transition if own else motion.transition._replace(exact=False)
        common = motion.slope, motion.full_override, transition
        if isinstance(shape, Line):
            rapid = isinstance(motion, LinearMove) and motion.rapid
            made: LinearMove | CircularMove = LinearMove(target, rapid, motion.feed, *common)
        else:
            centre = shape.centre[0] + self._tip[0], shape.centre[1] + self._tip[1]
            feed = self._feed(entry, shape) if own else motion.feed
            sweep, plane = math.degrees(shape.sweep), self._plane
            made = CircularMove(target, centre, plane.axes, shape.radius, sweep, feed, *common, plane.directions)
        made = made._replace(per_turn=_per_turn(motion, made.feed), kinematics=motion.kinematics)
        if not own:
            entry = Entry(CanonicalBlock(entry.block.source, (), None, "", calls=entry.block.calls), entry.limits)
        yield from self._carried_out(entry, made)

    def _feed(self, entry: Entry, shape: Arc) -> float:
        """Of the centre on an arc: as programmed, or with G11 so that the contour has it."""
        motion = entry.block.motion
        assert isinstance(motion, CircularMove)
        return motion.feed * shape.radius / motion.radius if entry.contour_feed else motion.feed

    def _carried_out(self, entry: Entry, motion: LinearMove | CircularMove) -> Iterator[CanonicalBlock]:
        """The block with its compensated motion, which leads on from here. Raises ProgramError beyond a limit."""
        block = entry.block
        if isinstance(motion, LinearMove) and math.dist(motion.target, self._here) < NO_LENGTH:
            yield from without_motion(block)
            return
        try:
            self._check(self._here, motion, block.source)
            if entry.limits:
                check_limits(self._channel, entry.limits, self._here, motion, block.source)
        except ProgramError as error:
            error.calls = list(block.calls)
            raise
        self._here = motion.target
        yield block._replace(motion=motion)

    # errors

    def _at(self, fault: nc_faults.Fault, block: CanonicalBlock, **values: str | int | float) -> ProgramError:
        error = fault.at(block.source, column_of(block), **values)
        error.calls = list(block.calls)
        return error

    def _narrow(self, fault: TooNarrow) -> ProgramError:
        tool, other = number(abs(self._radius)), fault.second.block.source
        text = other.text.strip()
        if fault.apart is not None:
            apart = number(round(fault.apart, 3))
            return self._at(faults.TOO_NARROW, fault.first.block, tool=tool, apart=apart, line=other.line, text=text)
        count = self._channel.radius.look_ahead
        return self._at(faults.NO_CROSSING, fault.first.block, tool=tool, line=other.line, text=text, count=count)


def _per_turn(motion: LinearMove | CircularMove, feed: float) -> FeedPerTurn | None:
    """G95 of a motion, for a piece of its path with another feed."""
    link = motion.per_turn
    return link if link is None or feed == motion.feed else link._replace(feed=link.feed * feed / motion.feed)


def without_motion(block: CanonicalBlock) -> Iterator[CanonicalBlock]:
    """What is left of a block that goes nowhere."""
    if block.functions or block.stop or block.offsets is not None:
        yield block._replace(motion=None)


def wait_of(block: CanonicalBlock) -> str:
    """Why the interpreter must wait for the path behind a block."""
    if isinstance(block.motion, HomeAxes):
        return "homing"
    for function in block.functions:
        if isinstance(function, SpindleAxis):
            return "#CAX"
        if isinstance(function, KinematicsChange):
            return "the end of #FACE or #CYL" if function.kinematics is None else function.kinematics.name
    return "a measuring run" if measures(block.motion) else "reading what only the run knows"


def column_of(block: CanonicalBlock) -> int:
    """Of the first G code, else the first word of a block."""
    source = block.source
    code = next((name for name in source.names if name.startswith("G")), "")
    return source.column(code) if code else (source.columns[0] if source.columns else 1)

"""One NC block with the modal state -> a canonical block: its codes, functions, motion; veto of its target."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from cnc_ptp.nc import c_axis, tapping, transformations, turning
from cnc_ptp.nc.arcs import extreme_points
from cnc_ptp.nc.awaited import changes_axes
from cnc_ptp.nc.canonical import (
    CanonicalBlock,
    CircularMove,
    Function,
    HomeAxes,
    LinearMove,
    Motion,
    Source,
)
from cnc_ptp.nc.contour import THROUGH
from cnc_ptp.nc.controls import bracketed_controls
from cnc_ptp.nc.coordinates.limits import check_limits
from cnc_ptp.nc.coordinates.placement import leave_frame, place, refresh
from cnc_ptp.nc.coordinates.report import offset_report
from cnc_ptp.nc.feeds import timed
from cnc_ptp.nc.functions import block_functions
from cnc_ptp.nc.machine_points import machine_points
from cnc_ptp.nc.measuring import placed
from cnc_ptp.nc.modal_state import ModalState, Step
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.spindle_links import end_of_links
from cnc_ptp.nc.thread_cutting import end_thread, note_functions, note_motion, take_offset, with_speed
from cnc_ptp.nc.tools.compensation import compensating_move, tool_words
from cnc_ptp.nc.transitions import through_point
from cnc_ptp.nc.vocabulary import FULL_OVERRIDE

CheckTarget = Callable[[tuple[float, ...], Source], None]
"""Raises to refuse a motion: it gets its target and, for an arc, the points where an axis turns back."""


class BlockResolver:
    """Resolves block after block; `state` is that behind the last one."""

    def __init__(self, channel: Channel, state: ModalState, check_target: CheckTarget | None) -> None:
        self.channel, self.state, self._check_target = channel, state, check_target

    def resolve(self, block: NcBlock, calls: tuple[str, ...]) -> CanonicalBlock | None:
        """None for a block without function, motion or stop. Raises ProgramError.

        `calls`: from where its subroutine was called.
        """
        if block.command is not None:
            return self._of_command(block, calls)
        state = self.state
        path = self._select(block)
        control, moves = self._prepare(block, path)
        motion = self._programmed_motion(block, path, moves=moves)
        functions = self._functions(block, path, control)
        if motion is not None:
            if isinstance(motion, LinearMove) and motion.thread is not None:
                motion = with_speed(self.channel, state, block, motion, motion.thread)
            motion = self.moved(block, motion)
            note_motion(state, motion)
        state.once = None
        stop = block.flow if block.flow != "return" else ""
        if stop:
            end_thread(state)
        if stop == "end":
            self._require_speed(None)
            functions += end_of_links(state)
        if motion is None and not functions and not stop:
            return None
        return CanonicalBlock(block.source, functions, motion, stop, calls=calls)

    def _of_command(self, block: NcBlock, calls: tuple[str, ...]) -> CanonicalBlock | None:
        """A command that starts with #."""
        assert block.command is not None
        taken = self.state.c_axis
        functions = block.command.run(self.channel, self.state, block, block.command)
        if taken:
            c_axis.check_functions(self.channel, self.state, block, functions)
        return CanonicalBlock(block.source, functions, None, "", calls=calls) if functions else None

    # codes

    def _select(self, block: NcBlock) -> GCode:
        """Changes the modal state by the G codes of the block; the path function that it has then."""
        path: GCode | None = None
        modal = -1
        state = self.state
        for code in block.codes:
            if code.motion is not None:
                if code.modal:
                    modal = code.number
                if path is None or not code.modal:
                    path = code
            if code.select is not None:
                code.select(state)
        if modal >= 0:
            state.path = modal
        return self.channel.vocabulary.paths[state.path] if path is None else path

    def _prepare(self, block: NcBlock, path: GCode) -> tuple[tuple[Function, ...], bool]:
        """Coordinates by the G codes of the block; functions of these codes, and whether they leave it its motion."""
        channel, state = self.channel, self.state
        if channel.table.c_axis:
            c_axis.check_words(channel, state, block, path)
        functions: tuple[Function, ...] = ()
        moves = True
        for code in block.codes:
            if code.prepare is not None:
                code.prepare(channel, state, block, code)
            elif code.function is not None:
                functions += code.function(channel, state, block, code)
                moves = moves and not code.takes_axes
        if block.values is not None:
            take_offset(channel, state, block)
        return functions, moves

    # functions

    def _functions(self, block: NcBlock, path: GCode, control: tuple[Function, ...]) -> tuple[Function, ...]:
        """Those of the words of the block, then `control`, those of its codes, and its brackets."""
        channel, state = self.channel, self.state
        functions: tuple[Function, ...] = ()
        if path.number in tapping.CODES:
            functions = tapping.functions(channel, state, block, path)
        elif turning.concerns(state, block):
            functions = turning.functions(channel, state, block)
            note_functions(channel, state, functions)
        elif block.functions and (path.spindle or not path.own_words):
            functions = block_functions(channel, state, block)
            note_functions(channel, state, functions)
        if control or block.controls:
            functions += control + bracketed_controls(channel, state, block, functions)
        if state.c_axis:
            c_axis.check_functions(channel, state, block, functions)
        return functions

    def _require_speed(self, motion: Motion | None) -> None:
        """M3 without a speed is an error at the first machining motion, and when the program ends without one."""
        rapid = isinstance(motion, LinearMove) and motion.rapid
        if not rapid:
            for error in self.state.spindle.speedless.values():
                raise error

    # motion

    def _programmed_motion(self, block: NcBlock, path: GCode, *, moves: bool) -> Motion | None:
        """In programmed coordinates, after the tool of the block; `moves`: no code has taken its axis words."""
        channel, state = self.channel, self.state
        before = state.programmed
        selected = block.functions and (path.spindle or not path.own_words) and tool_words(channel, state, block)
        if state.machine_words:
            state.machine_words, state.following = False, iter(())
            leave_frame(state)
        if selected and channel.tools.at_once and not (moves and path.words):
            return self._with_new_tool(block, path if moves else None, before)
        if moves and (block.words or path.own_words) and path.motion is not None:
            return path.motion(channel, state, block, path)
        return None

    def _with_new_tool(self, block: NcBlock, path: GCode | None, before: tuple[float, ...]) -> Motion | None:
        """P-CHAN-00100: axes without a word keep their programmed position from `before`, so they make up for the tool.

        Not with arcs, whose axes make up for it with their next absolute word.
        """
        state = self.state
        seen, state.programmed = state.programmed, before
        motion = None if path is None or path.motion is None else path.motion(self.channel, state, block, path)
        motion = motion or compensating_move(state)
        state.programmed = seen
        return motion

    def moved(self, block: NcBlock, motion: Motion) -> Motion | None:
        """A motion in machine coordinates, checked; the state is at its end then. None if it goes nowhere.

        Where the radius of the tool is compensated, it is the compensated motion that is checked, and left out.
        """
        if not isinstance(motion, (LinearMove, CircularMove)):
            return motion
        channel, state = self.channel, self.state
        programmed, compensated = motion.target, state.radius_compensation.on
        motion = timed(channel, state, block, programmed, place(channel, state, block, motion))
        if isinstance(motion, LinearMove) and motion.measures:
            motion = placed(motion, state.position, block)
            if state.c_axis:
                c_axis.check_motion(channel, block, motion)
        elif motion.target == state.position and not isinstance(motion, CircularMove) and not compensated:
            state.programmed = programmed
            return None
        if state.coordinates.kinematics is not None:
            motion = motion._replace(kinematics=state.coordinates.kinematics)
        if not compensated:
            self.check_move(state.position, motion, block.source)
            if state.coordinates.limits:
                check_limits(channel, state.coordinates.limits, state.position, motion, block.source)
        motion = self._with_modes(block, motion, programmed)
        if state.spindle.speedless:
            self._require_speed(motion)
        state.position, state.programmed = motion.target, programmed
        if state.turning.speed:
            turning.follow(channel, state, motion)
        return motion

    def _with_modes(
        self, block: NcBlock, motion: LinearMove | CircularMove, programmed: tuple[float, ...]
    ) -> LinearMove | CircularMove:
        """How the path is run: #SLOPE, its transition to the next block, G166."""
        state = self.state
        if state.slope:
            motion = motion._replace(slope=state.slope)
        transition = state.once or state.transition
        if transition is not THROUGH and not ends_on_its_own(motion):
            motion = motion._replace(transition=through_point(self.channel, state, block, transition, programmed))
        if block.codes and any(code.number == FULL_OVERRIDE for code in block.codes):
            motion = motion._replace(full_override=True)
        return motion

    def check_move(self, start: tuple[float, ...], motion: LinearMove | CircularMove, source: Source) -> None:
        """Soft limits of the axes, and the way to a Cartesian target (#FACE, #CYL). Raises ProgramError."""
        points: list[tuple[float, ...]] = []
        check_target = self._check_target
        if motion.kinematics is not None:
            points = machine_points(start, motion, source)
        if check_target is None:
            return
        if motion.kinematics is None:
            points = [*extreme_points(start, motion)] if isinstance(motion, CircularMove) else []
            points.append(motion.target)
        for point in points:
            check_target(point, source)

    # further blocks

    def further(
        self, block: NcBlock, first: CanonicalBlock | None, steps: Iterator[Step], calls: tuple[str, ...]
    ) -> Iterator[CanonicalBlock]:
        """A block and its further motions (cycles, G28); what stops the program comes behind the last one."""
        stop = "" if first is None else first.stop
        if first is not None and (first.functions or first.motion is not None):
            yield self.reported(first._replace(stop=""))
        for step in steps:
            if step.machine:
                leave_frame(self.state)
            motion = None if step.motion is None else self.moved(block, step.motion)
            if motion is not None or step.functions:
                yield self.reported(CanonicalBlock(block.source, step.functions, motion, "", calls=calls))
        self.refresh()
        if stop:
            yield self.reported(CanonicalBlock(block.source, (), None, stop, calls=calls))

    def reported(self, block: CanonicalBlock) -> CanonicalBlock:
        """The block with the offsets, if they have changed since the last one."""
        if self.state.reported:
            return block
        self.state.reported = True
        return block._replace(offsets=offset_report(self.channel, self.state))

    # what the run has changed

    def take_position(self, block: CanonicalBlock, position: tuple[float, ...]) -> None:
        """The set positions of the axes behind a homing, or a block that has changed which axes there are."""
        if isinstance(block.motion, HomeAxes) or changes_axes(block):
            transformations.place(self.channel, self.state, position)

    def take_measured(self, position: tuple[float, ...], touched: tuple[float, ...] | None) -> tuple[float, ...]:
        """Behind a measuring run: where the axes stand; the measured point as programs name it."""
        self.state.position = position
        self.refresh()
        point = touched or position
        return point if self.state.frame is None else self.state.frame.to_programmed(point)

    def refresh(self) -> None:
        """The programmed position follows from that of the axes; no offset has changed."""
        reported = self.state.reported
        refresh(self.channel, self.state)
        self.state.reported = reported


def ends_on_its_own(motion: Motion) -> bool:
    """A measuring run or tapping: no transition of the program changes its end."""
    return isinstance(motion, LinearMove) and (bool(motion.measures) or motion.tap is not None)

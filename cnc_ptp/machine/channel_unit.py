"""The NC channel: runs canonical blocks one after the other, interpolates the path, waits for spindles and PLC.

What happens in one block of cycles: `step` looks at what axes and spindles reported, sends the functions that came up,
then `_fill` makes rows cycle by cycle: from the path interpolator while a motion runs, standing ones while it waits.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from copy import deepcopy
from enum import Enum, auto
from typing import ClassVar, NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.machine.blocks import (
    AxisBlock,
    AxisStateCode,
    Block,
    ChannelBlock,
    ChannelStateCode,
    CycleTick,
    Severity,
    SpindleBlock,
)
from cnc_ptp.machine.function_output import FunctionOutput, Outputs, Wait
from cnc_ptp.machine.program_check import ProgramCheck
from cnc_ptp.machine.unit import UPSTREAM_LOST, Unit
from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, Dwell, LinearMove, Source
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.program import ModalState, Program
from cnc_ptp.parameters import AxisParameters, ChannelParameters, SpindleParameters
from cnc_ptp.path.geometry import Arc, AxisLimits, AxisState, Line
from cnc_ptp.path.interpolator import PathInterpolator

NO_PROGRAM = 22003
NOT_NOW = 22004
AXIS_NOT_READY = 22005
BAD_OVERRIDE = 22006
NOTHING_TO_ACKNOWLEDGE = 22007
STILL_MOVING = 22008
NO_TEXT = 22009
MEMBER_IN_ERROR = 22012

C = ChannelStateCode
NO_SOURCE = Source("", 0, 0, "")


class Phase(Enum):
    """Where the channel is within its program."""

    IDLE = auto()
    NEXT = auto()
    WAIT_BEFORE = auto()
    MOTION = auto()
    WAIT_AFTER = auto()
    STOPPED = auto()
    RAMP_DOWN = auto()


class Row(NamedTuple):
    """One cycle of the channel: the state of each axis, then the fields of ChannelState."""

    axes: tuple[AxisState, ...]
    line: int
    block_number: int
    path_velocity: float
    programmed_feed: float
    override_percent: float
    distance_to_go: float
    state: int
    error_id: int


class ChannelUnit(Unit):
    """One NC channel with its path axes and spindles."""

    kind: ClassVar[str] = "channel"

    def __init__(
        self,
        parameters: ChannelParameters,
        *,
        axes: Mapping[str, AxisParameters],
        spindles: Mapping[str, SpindleParameters],
        cycle_time: float,
    ) -> None:
        """`axes` and `spindles` of the machine by node name, `cycle_time` in s."""
        super().__init__(parameters.name)
        self._parameters = parameters
        self._cycle_time = cycle_time
        self._axis_nodes = [axis.node for axis in parameters.axes]
        own = [axes[node] for node in self._axis_nodes]
        self._feed_limits = [AxisLimits(a.max_velocity, a.acceleration, a.deceleration, a.jerk) for a in own]
        self._rapid_limits = [AxisLimits(a.rapid_velocity, a.acceleration, a.deceleration, a.jerk) for a in own]
        self._path_axes = sum(1 for axis in parameters.axes if axis.name in ("X", "Y", "Z")) or len(own)
        self._check = ProgramCheck(parameters, axes, spindles)
        self._functions = FunctionOutput(parameters)
        self._interpolator = PathInterpolator()
        self._program: Program | None = None
        self._modal = ModalState()
        self._blocks: list[CanonicalBlock] = []
        self._next_block = 0
        self._block: CanonicalBlock | None = None
        self._source = NO_SOURCE
        self._feed = 0.0
        self._phase = Phase.IDLE
        self._just_started = False
        self._owns_axes = False
        """A program ran at the begin of the block before: its last setpoint is the first of this block."""
        self._position = tuple(a.start_position for a in own)
        self._ready = {a.name: a.powered_at_start for a in own}
        self._states: tuple[AxisState, ...] = standing(self._position)
        self._element: Line | Arc | None = None
        self._path_velocity = 0.0
        self._distance_to_go = 0.0
        self._outputs = Outputs()
        self._unsent: list[Wait] = []
        self._waits: list[Wait] = []
        self._waits_after: list[Wait] = []
        self._open_requests: set[int] = set()
        self._feedback: Mapping[str, Block] = {}
        self._override_percent = 100.0
        self._feed_hold = False
        self._single_block = False
        self._optional_stop = False
        self._error_id = 0

    # commands

    def do_load(self, cycle: int, *, program: str, text: str | None = None) -> None:
        """Takes over a program (syntax is checked here, everything else at the start). Raises ProgramError, 22004, 22009."""
        self._require_idle("load")
        if text is None:
            self._refuse("load", NO_TEXT, f"no text came with program '{program}'")
        self._program = parse_program(text or "", program)
        self._source = NO_SOURCE

    def do_start(self, cycle: int) -> None:
        """Starts the program, or goes on after M00 or in single block. The whole program is interpreted before it starts."""
        if self._phase is Phase.STOPPED:
            self._phase = Phase.NEXT
            return
        self._require_idle("start")
        if self._program is None:
            self._refuse("start", NO_PROGRAM, "no program is loaded")
        else:
            self._begin("start", self._program, ModalState())

    def do_mdi(self, cycle: int, *, text: str) -> None:
        """Executes NC text at once; modal states are kept from one such text to the next."""
        self._require_idle("mdi")
        self._begin("mdi", parse_program(text, "mdi", mdi=True), deepcopy(self._modal))

    def do_feed_hold(self, cycle: int, *, on: bool) -> None:
        """Feed hold: the path goes to velocity 0 on its ramp, and on again when it is taken away."""
        self._feed_hold = on
        self._apply_override()

    def do_set_override(self, cycle: int, *, percent: float) -> None:
        """Path override, 0 … P-CHAN-00056 %; acts on feed and rapid."""
        limit = self._parameters.max_override_percent
        if not 0.0 <= percent <= limit:
            self._refuse(
                "set_override", BAD_OVERRIDE, f"percent = {percent} is not within 0 ... {limit:g} (P-CHAN-00056)"
            )
        self._override_percent = float(percent)
        self._apply_override()

    def do_single_block(self, cycle: int, *, on: bool) -> None:
        """Single block: the channel stops after each block until `start`."""
        self._single_block = on

    def do_optional_stop(self, cycle: int, *, on: bool) -> None:
        """Makes M01 a stop like M00 (off by default)."""
        self._optional_stop = on

    def do_reset(self, cycle: int) -> None:
        """Aborts the program on the path ramp, stops its spindles, clears the error; refused while an error ramp runs (22008)."""
        if self._error_id:
            if self._phase is Phase.RAMP_DOWN:
                self._refuse("reset", STILL_MOVING, "the path still moves on its error ramp; wait for standstill")
            self._error_id = 0
            self._phase = Phase.IDLE
        elif self._phase is not Phase.IDLE:
            self._ramp_down()

    def do_acknowledge(self, cycle: int, *, id: int) -> None:
        """The PLC's answer to a handshake request."""
        if id not in self._open_requests:
            waiting = ", ".join(map(str, sorted(self._open_requests))) or "none"
            self._refuse("acknowledge", NOTHING_TO_ACKNOWLEDGE, f"no request {id} waits (waiting: {waiting})")
        self._open_requests.discard(id)

    def do_upstream_lost(self, cycle: int, *, source: str) -> None:
        """The watchdog: PLC, clock, an axis or a spindle has sent nothing in time; the path stops."""
        self._fault(cycle, UPSTREAM_LOST, f"no block of '{source}' came within the watchdog time")

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, Block]) -> ChannelBlock:
        """Computes one block; `inputs` holds the blocks before of the channel's axes and spindles.

        The first row is the state that the block before has led to, so that commands act from exactly there; one row more
        than the block has leads on to the next one.
        """
        first_cycle, count = tick
        self._read_feedback(first_cycle, inputs)
        outputs = self._send_outputs(first_cycle)
        active = self._owns_axes
        self._owns_axes = self._phase is not Phase.IDLE
        rows = [self._row()]
        self._fill(rows, first_cycle, count + 1)
        return self._channel_block(tick, rows[:count], outputs, path_active=active or self._owns_axes)

    def _channel_block(self, tick: CycleTick, rows: list[Row], outputs: Outputs, *, path_active: bool) -> ChannelBlock:
        axes, *columns = zip(*rows, strict=True)
        by_axis = [state for axis in zip(*axes, strict=True) for state in axis]
        position, velocity, acceleration, jerk = map(list, zip(*by_axis, strict=True)) if by_axis else ([], [], [], [])
        return ChannelBlock(
            *tick,
            path_active,
            self._axis_nodes,
            position,
            velocity,
            acceleration,
            jerk,
            **dict(zip(Row._fields[1:], map(list, columns), strict=True)),
            done=self._phase is Phase.IDLE and not self._owns_axes,
            blocks_done=self._next_block,
            blocks_total=len(self._blocks),
            commands=outputs.commands,
            requests=outputs.requests,
        )

    def _fill(self, rows: list[Row], first_cycle: int, wanted: int) -> None:
        """Adds rows up to `wanted`: the path's while a motion runs, standing ones while nothing can go on."""
        while len(rows) < wanted:
            if self._phase in (Phase.MOTION, Phase.RAMP_DOWN):
                self._follow_path(rows, wanted)
            elif not self._go_on(first_cycle):
                self._interpolator.step(1, self._cycle_time)
                rows.append(self._row())

    def _follow_path(self, rows: list[Row], wanted: int) -> None:
        """Rows of the running motion; it ends early when the motion does, at the exact instant inside a cycle."""
        missing = wanted - len(rows)
        path_rows = self._interpolator.step(missing, self._cycle_time)
        element = self._element
        for s, v, a, j, _ in path_rows:
            if element is not None:
                self._states = element.evaluate(s, v, a, j)
                self._path_velocity, self._distance_to_go = v, element.length - s
            rows.append(self._row())
        ended = len(path_rows) < missing
        if ended and element is not None:
            self._states = standing(element.target)
        if self._phase is Phase.RAMP_DOWN and (ended or self._interpolator.stopped):
            self._end_program()
        elif ended:
            self._end_of_motion()

    def _row(self) -> Row:
        return Row(
            self._states,
            self._source.line,
            self._source.block_number,
            self._path_velocity,
            self._feed,
            self._override_percent,
            self._distance_to_go,
            int(self._state_code()),
            self._error_id,
        )

    def _state_code(self) -> ChannelStateCode:
        if self._error_id:
            return C.ERROR
        if self._phase is Phase.MOTION and self._element is not None:
            held = self._interpolator.factor == 0.0 and self._path_velocity == 0.0
            return C.HOLD if held else C.RUNNING
        if self._phase is Phase.IDLE:
            return C.IDLE if self._program is None else C.READY
        return PHASE_STATES[self._phase]

    # the sequence of a program

    def _begin(self, command: str, program: Program, modal: ModalState) -> None:
        for node, ready in self._ready.items():
            if not ready:
                self._refuse(command, AXIS_NOT_READY, f"axis {node} does not stand ready")
        blocks = self._check.blocks(program, self._position, modal)
        self._modal = modal
        self._blocks = blocks
        self._next_block = 0
        self._phase = Phase.NEXT
        self._just_started = True

    def _go_on(self, first_cycle: int) -> bool:
        """One step forward between motions; False when the path has to wait."""
        if self._phase is Phase.NEXT:
            self._begin_block()
            return True
        if self._phase not in (Phase.WAIT_BEFORE, Phase.WAIT_AFTER):
            return False
        self._waits = [
            wait for wait in self._waits if not wait.fulfilled(first_cycle, self._feedback, self._open_requests)
        ]
        if self._waits:
            return False
        if self._phase is Phase.WAIT_BEFORE:
            self._start_motion()
        else:
            self._end_block()
        return True

    def _begin_block(self) -> None:
        if self._next_block >= len(self._blocks):
            self._end_program()
            return
        self._block = block = self._blocks[self._next_block]
        self._source = block.source
        outputs = self._functions.of_block(block, after_motion=False)
        self._queue(outputs)
        self._waits, self._waits_after = outputs.waits_before, outputs.waits_after
        self._phase = Phase.WAIT_BEFORE

    def _start_motion(self) -> None:
        """Plans the motion of the block and hands it to the interpolator."""
        motion = self._block.motion if self._block else None
        if motion is None:
            self._end_of_motion()
            return
        self._phase = Phase.MOTION
        if isinstance(motion, Dwell):
            self._element = None
            self._interpolator.dwell(motion.seconds)
            return
        element = self._make_element(motion)
        rapid = isinstance(motion, LinearMove) and motion.rapid
        axis_limits = self._rapid_limits if rapid else self._feed_limits
        override_max = 1.0 if rapid else self._parameters.max_override_percent / 100.0
        limits = element.limits(math.inf if rapid else motion.feed, axis_limits, override_max)
        self._feed = limits.velocity if rapid else motion.feed
        self._interpolator.start(element, limits, self._feed)
        self._element = element

    def _make_element(self, motion: LinearMove | CircularMove) -> Line | Arc:
        start = [state[0] for state in self._states]
        if isinstance(motion, LinearMove):
            return Line(start, motion.target, self._path_axes)
        return Arc(start, motion.target, motion.center, motion.plane, motion.radius, motion.sweep, self._path_axes)

    def _end_of_motion(self) -> None:
        self._element = None
        self._path_velocity = self._distance_to_go = 0.0
        outputs = self._functions.of_block(self._block, after_motion=True) if self._block else Outputs()
        self._queue(outputs)
        self._waits = self._waits_after + outputs.waits_after
        self._phase = Phase.WAIT_AFTER

    def _end_block(self) -> None:
        stop = self._block.stop if self._block else ""
        self._next_block += 1
        if stop == "end":
            self._end_program()
        elif self._single_block or stop == "M00" or (stop == "M01" and self._optional_stop):
            self._phase = Phase.STOPPED
        else:
            self._phase = Phase.NEXT

    def _end_program(self) -> None:
        """The program is through or was aborted; the axes stand where they are."""
        aborted = self._phase is Phase.RAMP_DOWN
        self._position = tuple(state[0] for state in self._states)
        self._states = standing(self._position)
        self._element = None
        self._block = None
        self._feed = self._path_velocity = self._distance_to_go = 0.0
        self._waits, self._waits_after = [], []
        self._open_requests.clear()
        self._phase = Phase.IDLE
        if aborted:
            self._outputs = Outputs(commands=self._functions.stop_spindles())

    # functions, override, faults

    def _queue(self, outputs: Outputs) -> None:
        """Functions go out with the next block; the path waits for them if their synchronisation type says so."""
        self._outputs.commands += outputs.commands
        self._outputs.requests += outputs.requests
        self._unsent += outputs.waits_before + outputs.waits_after
        self._open_requests |= {request.id for request in outputs.requests if request.acknowledge_needed}

    def _send_outputs(self, first_cycle: int) -> Outputs:
        outputs, self._outputs = self._outputs, Outputs()
        for request in outputs.requests:
            request.cycle = first_cycle
        for wait in self._unsent:
            wait.sent_cycle = first_cycle
        self._unsent = []
        return outputs

    def _apply_override(self) -> None:
        factor = 0.0 if self._feed_hold else self._override_percent / 100.0
        self._interpolator.set_velocity_factor(factor)

    def _read_feedback(self, first_cycle: int, inputs: Mapping[str, Block]) -> None:
        """Takes over what axes and spindles reported for the block before."""
        self._feedback = inputs
        axes = {node: block for node in self._axis_nodes if isinstance(block := inputs.get(node), AxisBlock)}
        if not self._owns_axes:
            self._take_positions(first_cycle, axes)
        self._just_started = False
        if self._phase is Phase.IDLE:
            return
        for node, block in inputs.items():
            if isinstance(block, (AxisBlock, SpindleBlock)) and block.error_id[-1] and not self._error_id:
                self._fault(first_cycle, MEMBER_IN_ERROR, f"{node} is in error P-ERR-{block.error_id[-1]}")

    def _take_positions(self, first_cycle: int, axes: Mapping[str, AxisBlock]) -> None:
        if len(axes) < len(self._axis_nodes):
            return
        position = tuple(axes[node].set_position[-1] for node in self._axis_nodes)
        self._ready = {node: block.state[-1] == AxisStateCode.STANDSTILL for node, block in axes.items()}
        if self._just_started and (position != self._position or not all(self._ready.values())):
            self._fault(first_cycle, AXIS_NOT_READY, "an axis moved or was switched off while the program was started")
        self._position = position
        self._states = standing(position)

    def _fault(self, cycle: int, error_id: int, reason: str) -> None:
        """Error reaction: the path ramps down, the program is aborted, its spindles stop; state ERROR until reset."""
        if self._error_id:
            return
        self._error_id = error_id
        effect = (
            "nothing moves" if self._phase is Phase.IDLE else "the path stops on its ramp and the program is aborted"
        )
        line = self._source.line if self._phase is not Phase.IDLE else 0
        self.event(cycle, Severity.ERROR, error_id, f"channel {self.name}: {reason}; {effect}", line)
        self._ramp_down()

    def _ramp_down(self) -> None:
        moving = self._phase is Phase.MOTION and self._element is not None
        if self._phase is Phase.IDLE:
            return
        self._phase = Phase.RAMP_DOWN
        if moving:
            self._interpolator.stop()
        else:
            self._end_program()

    def _require_idle(self, command: str) -> None:
        if self._error_id:
            self._refuse(command, NOT_NOW, f"the channel is in error P-ERR-{self._error_id}; reset it first")
        if self._phase is not Phase.IDLE or self._owns_axes:
            self._refuse(command, NOT_NOW, f"a program is running (line {self._source.line})")

    def _refuse(self, command: str, error_id: int, reason: str) -> None:
        raise CncError(error_id, f"channel {self.name}: {command} refused: {reason}; nothing was changed")


PHASE_STATES = {
    Phase.NEXT: C.RUNNING,
    Phase.MOTION: C.WAITING,
    Phase.WAIT_BEFORE: C.WAITING,
    Phase.WAIT_AFTER: C.WAITING,
    Phase.STOPPED: C.STOPPED,
    Phase.RAMP_DOWN: C.STOPPING,
}
"""State shown in each phase; MOTION without an element is a dwell."""


def standing(position: tuple[float, ...]) -> tuple[AxisState, ...]:
    """States of axes that stand at `position` (mm)."""
    return tuple((value, 0.0, 0.0, 0.0) for value in position)

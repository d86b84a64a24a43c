"""From NC text to the list of blocks that a channel will run: interpreted and vetoed before anything moves."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial
from math import inf
from typing import NamedTuple

from cnc_ptp.axis.faults import CHANNEL_HAS_IT, HOMING_DISABLED, SOFT_LIMIT_NEGATIVE, SOFT_LIMIT_POSITIVE
from cnc_ptp.axis.parameter_commands import OF_THE_PATH
from cnc_ptp.channel.control_functions import place_of
from cnc_ptp.channel.program_start import ProgramStart
from cnc_ptp.channel.thread_reading import ThreadReading
from cnc_ptp.control.commands import NO_FRICTION_COMPENSATION
from cnc_ptp.errors import CncError, Value
from cnc_ptp.nc.awaited import awaits_path
from cnc_ptp.nc.canonical import (
    BUSY,
    AuxiliaryFunction,
    CanonicalBlock,
    CircularMove,
    CompensationSwitch,
    Function,
    HomeAxes,
    LinearMove,
    MachineData,
    Source,
    SpindleCommand,
    SpindleFunction,
    Thread,
)
from cnc_ptp.nc.check import CheckBlock, check
from cnc_ptp.nc.contour import POS, path_defaults
from cnc_ptp.nc.coordinates.codes import initial_state
from cnc_ptp.nc.coordinates.coordinates import NO_CHANGES, OffsetChanges
from cnc_ptp.nc.coordinates.limits import moving_axes, require_within
from cnc_ptp.nc.expressions.values import Values, Variable, copies
from cnc_ptp.nc.faults import AXIS_UNKNOWN, M_NOT_THERE, ProgramError
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.measuring import measures
from cnc_ptp.nc.modal_state import FacingAxis, ModalState, Pair, Pairs
from cnc_ptp.nc.parser import NO_FILES
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import Limits, Spindle, SpindleTable, TurningAxes, Vocabulary
from cnc_ptp.nc.program_origin import Origin, read_origin
from cnc_ptp.nc.program_text import ProgramText
from cnc_ptp.nc.radius.radius_state import radius_settings
from cnc_ptp.nc.vocabularies import VOCABULARIES
from cnc_ptp.parameters import (
    AxisParameters,
    ChannelParameters,
    ChannelSpindle,
    MachineParameters,
    OffsetTables,
    SpindleParameters,
    catalogue,
)
from cnc_ptp.parameters.check.runtime_change import possible_change
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.parameters.view.homing_view import DISABLED
from cnc_ptp.path.thread.thread_check import require_velocity, thread_settings
from cnc_ptp.path.thread.thread_geometry import slopes_and_bends
from cnc_ptp.protocol.blocks import CycleBlock, SpindleBlock
from cnc_ptp.spindle.faults import NO_POSITION_VALUE, SENSORLESS

NO_MEASURING_AXIS = 50059
NO_ENCODER = 22081
NOT_REFERENCED = 22034
NO_CHANNEL = 26112


class ProgramState(NamedTuple):
    """What a program changes while it is interpreted."""

    modal: ModalState
    values: Values

    def copy(self) -> ProgramState:
        modal = self.modal.copy()
        return ProgramState(modal, self.values.copy(modal))

    def same_as(self, other: ProgramState) -> bool:
        """Whether a program would have the same blocks from both."""
        return self.modal == other.modal and self.values.same_as(other.values)


class KnownBlocks(NamedTuple):
    """What is known of a program before it starts.

    blocks     its blocks, as far as they are kept
    complete   these are all; else it is interpreted again while it runs
    total      their number; None if it depends on what only the run knows
    """

    blocks: list[CanonicalBlock]
    complete: bool
    total: int | None


class ProgramCheck:
    """Checks a program against a machine: soft limits, speeds that the spindles reach, M functions it knows."""

    def __init__(
        self,
        channel: ChannelParameters,
        axes: Mapping[str, AxisParameters],
        spindles: Mapping[str, SpindleParameters],
    ) -> None:
        """`axes` and `spindles` of the machine by node name."""
        self._channel = channel
        self._axes = [axes[axis.node] for axis in channel.axes]
        self._own_names = tuple(axis.name for axis in channel.axes)
        """Of the axes that have a node; the C axis, which is a spindle, comes behind them."""
        self._axis_names = channel.path_axes
        self._spindles = spindle_table(channel, spindles)
        self._nodes = {spindle.name: spindle.node for spindle in channel.spindles}
        self._units = spindles
        spindles_on_path = len(self._axis_names) - len(self._axes)
        references = [axis.homing.reference_position for axis in self._axes]
        limits = [(axis.soft_limit_negative, axis.soft_limit_positive) for axis in self._axes]
        self.vocabulary = VOCABULARIES[channel.dialect]
        """That of the machine file."""
        self.cycles = channel.cycles
        turning = turning_axes(channel, self._axes)
        rotary = [axis.name for axis in channel.axes if axes[axis.node].rotary]
        self.nc = plain_channel(self._axis_names, self._spindles, self.vocabulary, rotary)._replace(
            centre_offset=channel.circle_center_tolerance,
            centre_offset_ratio=channel.circle_center_ratio,
            offsets=own_offsets(channel, turning),
            soft_limits=tuple(limits + [(-inf, inf)] * spindles_on_path),
            tools=channel.tool_table,
            path=path_defaults(channel),
            references=tuple(references + [0.0] * spindles_on_path),
            radius=radius_settings(channel),
            turning=turning,
            limits=Limits(channel.call_depth, channel.repeats),
        )
        """The channel as the interpreter knows it."""
        self._threads = thread_settings(channel, self._axes, 0.0)
        self.block_skip = 0
        """Bit n - 1: blocks with /n are skipped."""

    @classmethod
    def of_first_channel(cls, machine: MachineParameters, file: str) -> ProgramCheck:
        """For the first channel of a machine. Raises CncError 26112 when it has none to run `file`."""
        if not machine.channels:
            raise CncError(NO_CHANNEL, f"the machine has no channel to run {file}; nothing was started")
        return cls(next(iter(machine.channels.values())), machine.axes, machine.spindles)

    @property
    def checked_text(self) -> int:
        """P-CHAN-90005: characters up to which a program is held in memory."""
        return self._channel.checked_text

    def errors(
        self,
        text: str | ProgramText,
        file: str,
        files: Mapping[str, str] = NO_FILES,
        vocabulary: Vocabulary | None = None,
    ) -> list[ProgramError]:
        """Syntax and modal errors of a program, as if it were started from the start positions; as `check`."""
        return check(
            text,
            file,
            self.nc._replace(vocabulary=vocabulary or self.vocabulary),
            start=self.start,
            check_target=partial(self.check_target, unlimited=self._names(self.unreferenced_at_start)),
            check_blocks=self._block_check,
            files=files,
            cycles=self.cycles,
        )

    def _block_check(self) -> CheckBlock:
        """What the machine does not have, block after block; threads up to a homing: then no position is known."""
        missing, homed = self._names(self.unreferenced_at_start), False
        threads = self._thread_reading(self.start, missing)

        def check_block(block: CanonicalBlock | None) -> None:
            nonlocal homed
            if block is None:
                threads.finish()
                return
            motion, before = block.motion, threads.here
            homed = homed or isinstance(motion, HomeAxes)
            try:
                self._require_block(block, missing)
                if isinstance(motion, LinearMove) and motion.thread is not None and not homed:
                    self._require_thread(before, motion, motion.thread, block.source)
            except ProgramError:
                threads.leave_out(block)
                raise
            if not homed:
                threads.take(block)

        return check_block

    @property
    def axis_names(self) -> tuple[str, ...]:
        """As programs name them, in the order of the channel."""
        return self._axis_names

    @property
    def start(self) -> tuple[float, ...]:
        """Start positions of the channel's axes, mm."""
        return (*[axis.start_position for axis in self._axes], *[0.0] * (len(self._axis_names) - len(self._axes)))

    def state(
        self,
        feedback: Mapping[str, CycleBlock],
        links: Mapping[int, Pairs],
        shared: dict[str, Variable],
        offsets: OffsetChanges = NO_CHANGES,
        clamp_index: int = 0,
    ) -> ProgramState:
        """The state in which programs start: gears as spindles report them, the rest as it is.

        `offsets`: what was changed of zero offsets, `clamp_index`: the clamp position.
        """
        modal = initial_state(self.nc, offsets, clamp_index)
        modal.spindle.gears = self.gears(feedback)
        modal.spindle.links = dict(links)
        values = Values(self.nc, modal)
        values.shared = copies(shared)
        values.begin_program()
        return ProgramState(modal, values)

    def gears(self, feedback: Mapping[str, CycleBlock]) -> dict[str, int]:
        """Gear stages of the spindles that are not in the one of their start-up, by name."""
        reported = {}
        for spindle in self._spindles.spindles:
            block = feedback.get(self._nodes[spindle.key])
            if isinstance(block, SpindleBlock) and block.gear[-1] != spindle.gear:
                reported[spindle.key] = block.gear[-1]
        return reported

    def parse(self, text: str, file: str, files: Mapping[str, str] = NO_FILES, dialect: str | None = None) -> Program:
        """A program that is loaded; beyond P-CHAN-90005 it is read while it runs. Raises its first syntax error."""
        vocabulary = self.vocabulary if dialect is None else VOCABULARIES[dialect]
        streamed = len(text) > self._channel.checked_text
        return read_origin(Origin(text, file, files, self.cycles, vocabulary, streamed))

    def parse_manual(
        self, text: str, files: Mapping[str, str], vocabulary: Vocabulary, loaded: Program | None
    ) -> Program:
        """Manual blocks, which may also call what the program `loaded` may call. Raises their first syntax error."""
        return read_origin(Origin(text, "mdi", files, self.cycles, vocabulary, False, True, loaded))

    def blocks(self, program: Program, start: Sequence[float]) -> list[CanonicalBlock]:
        """The blocks of a program that is started from the initial state, as far as they are known before it runs."""
        return self.known_ahead(program, start, self.state({}, {}, {})).blocks

    def known_ahead(
        self, program: Program, start: Sequence[float], state: ProgramState, begin: ProgramStart | None = None
    ) -> KnownBlocks:
        """`known_blocks` before the machine runs: others may still home its axes."""
        return self.known_blocks(program, start, state, self.unreferenced_at_start, begin, required=False)

    def known_blocks(
        self,
        program: Program,
        start: Sequence[float],
        state: ProgramState,
        unreferenced: Collection[str] = (),
        begin: ProgramStart | None = None,
        *,
        required: bool = True,
    ) -> KnownBlocks:
        """Interprets a program from `start` (mm, in the channel's order of axes) before anything moves.

        All of it, up to a homing or a line that reads what only the run knows; `begin`: not from its beginning. Of a
        program that is read while it runs nothing but the way to `begin`.
        `unreferenced`: nodes of axes without soft limits, which it must not move before it homes them if that is
        `required` (P-MACH-00061). Raises ProgramError and the errors of ProgramStart; then `state` is void.
        """
        blocks: list[CanonicalBlock] = []
        total = 0
        if program.streamed and begin is None:
            return KnownBlocks(blocks, False, None)
        threads = self._thread_reading(start, self._names(unreferenced))
        for block in self.running(program, start, state, unreferenced, begin, required=required):
            if block is BUSY:
                continue
            if program.streamed:
                return KnownBlocks(blocks, False, None)
            total += 1
            threads.take(block)
            if len(blocks) < self._channel.known_blocks:
                blocks.append(block)
            if awaits_path(block):
                threads.finish()
                return KnownBlocks(blocks, False, None)
        threads.finish()
        return KnownBlocks(blocks, total == len(blocks), total)

    def _thread_reading(self, start: Sequence[float], unlimited: Collection[str]) -> ThreadReading:
        """Axes in `unlimited` have no soft limits."""
        pairs = zip(self._axis_names, self.nc.soft_limits, strict=True)
        limits = [(-inf, inf) if name in unlimited else limit for name, limit in pairs]
        return ThreadReading(self._threads, limits, start)

    def running(
        self,
        program: Program,
        start: Sequence[float],
        state: ProgramState,
        unreferenced: Collection[str] = (),
        begin: ProgramStart | None = None,
        *,
        required: bool = True,
    ) -> Iterator[CanonicalBlock]:
        """The blocks one by one, also BUSY and those with WaitForPath. Raises as `known_blocks`."""
        missing = self._names(unreferenced)
        stream = self._interpreted(program, start, state, begin, missing, required=required)
        if begin is None:
            return stream

        def check(target: tuple[float, ...], source: Source) -> None:
            self.check_target(target, source, missing)
            limits = state.modal.coordinates.limits or {}
            require_within(self.nc, limits, [target], moving_axes(tuple(start), target), source)

        return begin.blocks(stream, tuple(start), self._axis_names, state.modal, check)

    def _interpreted(
        self,
        program: Program,
        start: Sequence[float],
        state: ProgramState,
        begin: ProgramStart | None,
        missing: set[str],
        *,
        required: bool,
    ) -> Iterator[CanonicalBlock]:
        """`missing`: names of axes that are not referenced; homing takes them out."""
        stream = interpret(
            program,
            tuple(start),
            self.nc,
            state=state.modal,
            values=state.values,
            check_target=partial(self.check_target, unlimited=missing),
            block_skip=self.block_skip,
            runs=True,
            search=None if begin is None else begin.search,
        )
        position = tuple(start)
        for block in stream:
            self._require_block(block, missing)
            if missing and required and isinstance(block.motion, (LinearMove, CircularMove)):
                self._require_references(position, block.motion, block.source, missing)
            if isinstance(block.motion, LinearMove) and block.motion.thread is not None:
                self._require_thread(position, block.motion, block.motion.thread, block.source)
            if isinstance(block.motion, (LinearMove, CircularMove)):
                position = block.motion.target
            yield block
            if (isinstance(block.motion, HomeAxes) or measures(block.motion)) and state.values.position:
                position = state.values.position

    def _require_block(self, block: CanonicalBlock, missing: set[str]) -> None:
        """Raises ProgramError for what the machine does not have; axes that the block homes are no longer `missing`."""
        for function in block.functions:
            self._function(function, block.source)
        if isinstance(block.motion, LinearMove):
            self._require_measuring_axes(block.motion, block.source)
        if isinstance(block.motion, (LinearMove, CircularMove)) and block.motion.kinematics is None:
            contour = block.motion.transition.contour
            if contour is not None and contour.mode == POS:
                self.check_target(contour.point, block.source, missing)
        if isinstance(block.motion, HomeAxes):
            missing.difference_update(self._homed(block.motion, block.source))

    def _names(self, nodes: Collection[str]) -> set[str]:
        """Names in programs of the axes with these nodes."""
        return {name for name, axis in zip(self._own_names, self._axes, strict=True) if axis.name in nodes}

    @property
    def unreferenced_at_start(self) -> list[str]:
        """Nodes of the axes that are not referenced when the machine starts."""
        return [axis.name for axis in self._axes if not axis.referenced_at_start]

    def _homed(self, motion: HomeAxes, source: Source) -> set[str]:
        """The axes of G74. Raises ProgramError 60313 for one that cannot be homed."""
        homed = {name for group in motion.groups for name in group}
        for name, axis in zip(self._own_names, self._axes, strict=True):
            if name in homed and axis.homing.kind == DISABLED:
                text = f"axis {name} cannot be homed (P-AXIS-00299 = DISABLED)"
                raise ProgramError(HOMING_DISABLED, text, source, source.column(name))
        return homed

    def _require_measuring_axes(self, motion: LinearMove, source: Source) -> None:
        """Raises ProgramError 50059 for a measuring run of an axis that may not take part (P-AXIS-00118)."""
        for place in motion.measures:
            name = self._own_names[place]
            if not self._axes[place].probe.measures:
                able = [other for other, axis in zip(self._own_names, self._axes, strict=True) if axis.probe.measures]
                text = f"axis {name} cannot measure (P-AXIS-00118); axes that can: {', '.join(able) or 'none'}"
                raise ProgramError(NO_MEASURING_AXIS, text, source, source.column(name))

    def _require_references(
        self,
        start: tuple[float, ...],
        motion: LinearMove | CircularMove,
        source: Source,
        missing: Collection[str],
    ) -> None:
        """Raises ProgramError 22034 for a motion of an axis in `missing`."""
        for index, (name, axis) in enumerate(zip(self._own_names, self._axes, strict=True)):
            turns = isinstance(motion, CircularMove) and motion.turns(index)
            if axis.homing.required and name in missing and (turns or motion.target[index] != start[index]):
                text = f"axis {name} is not referenced (P-MACH-00061); G74 {name}1 first"
                raise ProgramError(NOT_REFERENCED, text, source, source.column(name))

    def _require_thread(self, start: tuple[float, ...], motion: LinearMove, thread: Thread, source: Source) -> None:
        """Raises ProgramError 21667 for a spindle without encoder, 22082 for axes that cannot follow its speed."""
        spindle, column = self._units.get(self._nodes[thread.spindle]), source.column("G33")
        if spindle is None or not spindle.has_position:
            why = f"spindle {thread.spindle} has no actual position (P-AXIS-00320, P-SIM-00050)"
            raise ProgramError(NO_ENCODER, f"{why} and cannot lead a thread (G33)", source, column)
        slopes, bends = slopes_and_bends(start, motion.target, thread)
        fastest = [max(abs(m), abs(m + c * thread.angle)) for m, c in zip(slopes, bends, strict=True)]
        try:
            require_velocity(self._threads, fastest, motion, abs(thread.speed))
        except CncError as error:
            raise ProgramError(error.number, error.reason, source, column, **error.values) from None

    def check_target(self, target: tuple[float, ...], source: Source, unlimited: Collection[str] = ()) -> None:
        """Raises ProgramError 120002 / 120003 for a point (mm) beyond a soft limit; `unlimited` axes have none."""
        for name, axis, position in zip(self._own_names, self._axes, target, strict=False):  # C has none
            unit = "deg" if axis.rotary else "mm"
            if axis.soft_limit_negative <= position <= axis.soft_limit_positive or name in unlimited:
                continue
            if position > axis.soft_limit_positive:
                limit = f"positive soft limit {axis.soft_limit_positive:g} {unit} (P-AXIS-00178)"
                text = f"axis {name}: {position:g} {unit} lies beyond the {limit}"
                raise ProgramError(SOFT_LIMIT_POSITIVE, text, source, 1, **beyond(axis, position))
            limit = f"negative soft limit {axis.soft_limit_negative:g} {unit} (P-AXIS-00177)"
            text = f"axis {name}: {position:g} {unit} lies beyond the {limit}"
            raise ProgramError(SOFT_LIMIT_NEGATIVE, text, source, 1, **beyond(axis, position))

    def _function(self, function: Function, source: Source) -> None:
        if isinstance(function, (SpindleFunction, SpindleCommand)):
            self._position_known(function, source)
        if isinstance(function, MachineData):
            self._machine_data(function, source)
        elif isinstance(function, CompensationSwitch):
            self._compensation(function, source)
        elif not isinstance(function, AuxiliaryFunction):
            return
        elif function.letter == "M" and function.number not in self._channel.m_functions:
            known = ", ".join(f"M{number}" for number in self._channel.m_functions)
            column = source.column(f"M{function.number}")
            raise M_NOT_THERE.at(source, column, word=f"M{function.number:02d}", known=known)

    def _compensation(self, function: CompensationSwitch, source: Source) -> None:
        """Raises ProgramError 70495 when friction compensation is switched on for an axis that does not permit it."""
        axis = self._axes[self._own_names.index(function.axis)]
        if function.on and not axis.control.friction.permitted:
            reason = "friction compensation is not activated (P-AXIS-00522 lr_param.frict_comp = 0)"
            text = f"axis {function.axis}: {reason}"
            raise ProgramError(NO_FRICTION_COMPENSATION, text, source, source.column(function.axis))

    def _machine_data(self, function: MachineData, source: Source) -> None:
        """Raises ProgramError 20797 for a number that no axis has, 23095, 23096, 23100, 110641."""
        place, column = place_of(self._channel, function.axis), source.place_of(function.parameter)
        if place < 0:
            known = ", ".join(f"{axis.number} ({axis.name})" for axis in self._channel.axes)
            raise AXIS_UNKNOWN.at(source, source.place_of(f"={function.axis} "), word=function.axis, known=known)
        own = self._axes[place].raw
        if own is None:
            return
        try:
            declaration = possible_change(own, function.parameter, function.value)[0]
        except CncError as error:
            raise ProgramError(error.number, f"axis {function.axis}: {error.reason}", source, column) from None
        if declaration.id in OF_THE_PATH:
            reason = f"{declaration.id} ({declaration.name}) cannot be written at run time, the channel has it, too"
            raise ProgramError(CHANNEL_HAS_IT, f"axis {function.axis}: {reason}", source, column)

    def _position_known(self, function: SpindleFunction | SpindleCommand, source: Source) -> None:
        """Vetoes M19 and G74 of a spindle without actual position (TF5200 spindle 2.2.4)."""
        spindle = self._units.get(self._nodes[function.spindle])
        if spindle is None or spindle.has_position:
            return
        why = f"spindle {function.spindle} has no actual position (P-AXIS-00320, P-SIM-00050) and cannot be"
        if isinstance(function, SpindleFunction) and function.m == 19:
            raise ProgramError(SENSORLESS, f"{why} positioned", source, 1)
        if isinstance(function, SpindleCommand) and function.command == "home":
            raise ProgramError(NO_POSITION_VALUE, f"{why} homed", source, 1)


def beyond(axis: AxisParameters, position: float) -> dict[str, Value]:
    """The numbers of a position beyond a soft limit, by name."""
    limit = axis.soft_limit_positive if position > axis.soft_limit_positive else axis.soft_limit_negative
    return {"angle" if axis.rotary else "position": position, "limit": limit}


def turning_axes(channel: ChannelParameters, axes: Sequence[AxisParameters]) -> TurningAxes:
    """The facing axes of a channel, whose axes these are in its order."""
    facing = [
        FacingAxis(index, axis.diameter_absolute, axis.diameter_relative)
        for index, axis in enumerate(axes)
        if axis.facing
    ]
    shown, feet = channel.shows_diameter, channel.cutting_speed_in_feet
    return TurningAxes(tuple(facing), shown, feet, channel.offsets_in_diameters)


def own_offsets(channel: ChannelParameters, turning: TurningAxes) -> OffsetTables:
    """The offsets of the machine file, with radii in zero offsets of a facing axis."""

    def radii(values: Sequence[float]) -> tuple[float, ...]:
        return tuple([value * turning.offset_factor(place) for place, value in enumerate(values)])

    return channel.offsets._replace(zero={index: radii(values) for index, values in channel.offsets.zero.items()})


def spindle_table(channel: ChannelParameters, spindles: Mapping[str, SpindleParameters]) -> SpindleTable:
    """The spindles of a channel as its programs see them, the main spindle first."""
    ordered = sorted(channel.spindles, key=lambda spindle: spindle.name != channel.main_spindle)
    table = tuple(_spindle(spindle, spindles.get(spindle.node)) for spindle in ordered)
    groups = catalogue().arrays["koppel_gruppe"].size
    coupled = tuple(Pair(slave, master) for slave, master in channel.coupled)
    main = channel.main_spindle or "S"
    return SpindleTable(
        table, main, channel.gear_change, coupled, groups, channel.pitch_tolerance, channel.c_axis, channel.face_kind
    )


def _spindle(spindle: ChannelSpindle, unit: SpindleParameters | None) -> Spindle:
    return Spindle(
        key=spindle.name,
        own_name=spindle.own_name or spindle.name,
        number=spindle.number,
        ranges=spindle.ranges,
        from_top=spindle.from_top,
        automatic=spindle.automatic,
        gear=unit.gear if unit else 1,
        plc_control=spindle.plc_control,
        limits=speed_limits(unit) if unit else (),
        positioned=unit is not None and unit.has_position,
        path_gear=unit.path_gear if unit else 0,
    )


def speed_limits(unit: SpindleParameters) -> tuple[float, ...]:
    """Largest speed of each gear stage, rpm; without limit for stages without a record."""
    gears = unit.gears
    return tuple(
        gears[stage].max_speed / DEG_S_PER_RPM if stage in gears else inf for stage in range(1, max(gears) + 1)
    )

"""Blocks -> canonical stream: modal state, calls and returns, block skip, veto of targets; check of a whole program."""

from collections.abc import Callable, Collection, Iterator, Mapping

from cnc_ptp.nc import c_axis, tapping, transformations, turning
from cnc_ptp.nc.arcs import extreme_points
from cnc_ptp.nc.block_search import BlockSearch
from cnc_ptp.nc.canonical import (
    BEGIN,
    BUSY,
    CanonicalBlock,
    CircularMove,
    Function,
    HomeAxes,
    KinematicsChange,
    LinearMove,
    Motion,
    Source,
    SpindleAxis,
    Timer,
    WaitForPath,
)
from cnc_ptp.nc.contour import THROUGH
from cnc_ptp.nc.controls import bracketed_controls
from cnc_ptp.nc.coordinates.codes import initial_state, select_offset
from cnc_ptp.nc.coordinates.limits import check_limits
from cnc_ptp.nc.coordinates.placement import leave_frame, place, refresh
from cnc_ptp.nc.coordinates.report import offset_report
from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.feeds import timed
from cnc_ptp.nc.flow.execution import COMPUTES, FOUND, PAUSE, Execution, Limits, with_calls
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.functions import block_functions
from cnc_ptp.nc.machine_points import machine_points
from cnc_ptp.nc.measuring import Touch, measures, placed, results
from cnc_ptp.nc.parser import NO_FILES, parse_all
from cnc_ptp.nc.program import (
    NO_TURNING_AXES,
    Channel,
    GCode,
    ModalState,
    NcBlock,
    SpindleTable,
    Step,
    TurningAxes,
    Vocabulary,
)
from cnc_ptp.nc.program_text import ProgramText
from cnc_ptp.nc.radius.compensation import RadiusCompensation
from cnc_ptp.nc.radius.radius_state import DEFAULT_SETTINGS, RadiusSettings
from cnc_ptp.nc.recovery import Recovery
from cnc_ptp.nc.spindle_links import end_of_links
from cnc_ptp.nc.spindles import spindle_table
from cnc_ptp.nc.thread_cutting import end_thread, note_functions, note_motion, take_offset, with_speed
from cnc_ptp.nc.tools.compensation import compensating_move, tool_words
from cnc_ptp.nc.tools.tool_state import NOT_WRITTEN
from cnc_ptp.nc.transitions import through_point
from cnc_ptp.nc.vocabulary import FULL_OVERRIDE, TWINCAT
from cnc_ptp.parameters import NO_OFFSET_TABLES, NO_TOOLS, OffsetTables, ToolTable

CENTRE_OFFSET = 2.0
"""Default of P-CHAN-00059 mittelpkt_diff: 20000 in 0.1 µm; mm."""

CENTRE_OFFSET_RATIO = 0.05
"""Default of P-CHAN-00060 mittelpkt_faktor: 50 in 0.1 %; share of the radius."""

LIMITS = Limits()

CheckTarget = Callable[[tuple[float, ...], Source], None]
CheckBlock = Callable[[CanonicalBlock | None], None]
"""Raises ProgramError for a block that the machine cannot carry out; None comes behind the last one."""


def interpret(
    program: Program,
    start: tuple[float, ...],
    axes: tuple[str, ...],
    spindles: tuple[str, ...] | SpindleTable = ("S",),
    *,
    state: ModalState | None = None,
    check_target: CheckTarget | None = None,
    centre_offset: float = CENTRE_OFFSET,
    centre_offset_ratio: float = CENTRE_OFFSET_RATIO,
    rotary: Collection[str] = (),
    offsets: OffsetTables = NO_OFFSET_TABLES,
    soft_limits: tuple[tuple[float, float], ...] = (),
    tools: ToolTable = NO_TOOLS,
    radius: RadiusSettings = DEFAULT_SETTINGS,
    references: tuple[float, ...] = (),
    block_skip: int = 0,
    turning_axes: TurningAxes = NO_TURNING_AXES,
    limits: Limits = LIMITS,
    values: Values | None = None,
    runs: bool = False,
    search: BlockSearch | None = None,
    recovery: Recovery | None = None,
) -> Iterator[CanonicalBlock]:
    """Canonical blocks of a program, one by one, from the position `start` (mm, in the order of `axes`).

    `spindles`: the first is the main spindle (DIN words M3, S1000); names are enough where gears and links are not
    needed.
    `state`: modal state to continue from and to carry on (MDI); None begins with the initial state.
    `check_target(target, source)` is called before a move is handed out, with its target and, for an arc, with the
    points where an axis turns back; it raises to refuse the move.
    `centre_offset` (mm, P-CHAN-00059), `centre_offset_ratio` (P-CHAN-00060 / 1000): how far the centre of an arc may be
    corrected, the smaller of both limits counts. `rotary`: axes in deg. `offsets` and `tools` of the machine, `radius`:
    how that of tools is compensated, `soft_limits` of its axes for V.A., `references` for G28, `turning_axes` for G51
    and G96.
    `block_skip`: bit n - 1 skips blocks with /n (`/` is /1).
    Blocks without function, motion or stop give nothing, nor does a move to the present position; offsets that they
    change come with the next block, those at the end with one of their own.
    `runs`: while the blocks are executed; then WaitForPath comes before what only the run knows, when `values` must get
    it, and BUSY in long computations. Otherwise such a line is the error 21438.
    `values`: parameters and variables to continue with, of the same `state`.
    `search`: a place; BEGIN comes in place of a block when it is reached, before its line is executed.
    `recovery`: takes the errors, of which it decides whether the next block follows, in place of raising them.
    Raises ProgramError; state and values are then undefined, so MDI continues with copies taken before.
    """
    index = {axis: position for position, axis in enumerate(axes)}
    table, ratio = spindle_table(spindles), centre_offset_ratio
    words, turns = program.vocabulary, frozenset(rotary).union([table.c_axis] if table.c_axis else [])
    channel = Channel(
        axes,
        index,
        table,
        centre_offset,
        ratio,
        words,
        turns,
        offsets,
        soft_limits,
        tools,
        references=references,
        radius=radius,
        turning=turning_axes,
    )
    state = initial_state(channel) if state is None else state
    state.position = tuple(start)
    state.tool.written = NOT_WRITTEN
    end_thread(state)
    state.c_axis = ""
    transformations.restore(state)
    refresh(channel, state)
    state.reported = True
    if words.first_offset and not state.coordinates.own.zero_index:
        select_offset(channel, state, words.first_offset)
    if values is None:
        values = Values(channel, state)
    else:
        values.channel, values.state = channel, state
    execution = Execution(program, values, limits=limits, block_skip=block_skip, search=search)

    def check_motion(start: tuple[float, ...], motion: LinearMove | CircularMove, source: Source) -> None:
        _check_move(start, motion, source, check_target)

    compensation = RadiusCompensation(channel, state, check_motion, awaits_path, search, program.main.source)
    yield from compensation.over(_programmed(execution, check_target, recovery, runs=runs))


def _programmed(
    execution: Execution, check_target: CheckTarget | None, recovery: Recovery | None, *, runs: bool
) -> Iterator[CanonicalBlock]:
    """The blocks with the motions that are programmed, whatever the radius of the tool."""
    values = execution.values
    channel, state = values.channel, values.state
    source = execution.program.main.source
    before: ModalState | None = None
    goes_on = True
    while goes_on:
        try:
            while (block := execution.next_block()) is not None:
                if block is COMPUTES:
                    if runs:
                        yield BUSY
                    continue
                if block is FOUND:
                    yield BEGIN
                    continue
                if block is PAUSE:
                    if not runs:
                        raise expression_faults.ONLY_WHILE_RUNNING.at(values.source)
                    yield CanonicalBlock(values.source, (WaitForPath(True),), None, "", calls=execution.calls)
                    continue
                source = block.source
                if recovery is not None:
                    before = state.copy()
                canonical = _resolve(channel, state, block, check_target, execution.calls)
                motion = None if canonical is None else canonical.motion
                execution.moved = isinstance(motion, (LinearMove, CircularMove))
                if state.following is not None:
                    steps, state.following = state.following, None
                    yield from _followed(channel, state, block, canonical, steps, check_target, execution.calls)
                elif canonical is not None:
                    yield _reported(channel, state, canonical)
                    if (isinstance(motion, HomeAxes) or changes_axes(canonical)) and values.position:
                        transformations.place(channel, state, values.position)
                if isinstance(motion, LinearMove) and motion.measures and values.touch is not None:
                    _take_measured(channel, values, motion, values.touch)
                before = None
            if not state.reported:
                yield _with_offsets(channel, state, CanonicalBlock(source, (), None, ""))
            transformations.restore(state)
            goes_on = False
        except ProgramError as error:
            error = with_calls(error, execution)
            if recovery is None:
                raise error from None
            goes_on = recovery.go_on(error, execution, state, before)
            before = None
    if recovery is not None:
        recovery.finish(execution)


def _take_measured(channel: Channel, values: Values, motion: LinearMove, touch: Touch) -> None:
    """Behind a measuring run: where the axes stand, and what it has measured."""
    state = values.state
    reported, state.position = state.reported, values.position
    refresh(channel, state)
    state.reported = reported
    point = touch.position or state.position
    programmed = point if state.frame is None else state.frame.to_programmed(point)
    values.measured = results(motion, touch, programmed, values.measured)


def _with_offsets(channel: Channel, state: ModalState, block: CanonicalBlock) -> CanonicalBlock:
    state.reported = True
    return block._replace(offsets=offset_report(channel, state))


def _resolve(
    channel: Channel,
    state: ModalState,
    block: NcBlock,
    check_target: CheckTarget | None,
    calls: tuple[str, ...],
) -> CanonicalBlock | None:
    """One block with the modal state: selects its G codes, builds motion and functions, moves the position."""
    if block.command is not None:
        taken = state.c_axis
        commanded = block.command.run(channel, state, block, block.command)
        if taken:
            c_axis.check_functions(channel, state, block, commanded)
        return CanonicalBlock(block.source, commanded, None, "", calls=calls) if commanded else None
    path: GCode | None = None
    modal = -1
    control: tuple[Function, ...] = ()
    moves = True
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
    if path is None:
        path = channel.vocabulary.paths[state.path]
    if channel.table.c_axis:
        c_axis.check_words(channel, state, block, path)
    for code in block.codes:
        if code.prepare is not None:
            code.prepare(channel, state, block, code)
        elif code.function is not None:
            control += code.function(channel, state, block, code)
            moves = moves and not code.takes_axes
    if block.values is not None:
        take_offset(channel, state, block)
    before = state.programmed
    selected = block.functions and (path.spindle or not path.own_words) and tool_words(channel, state, block)
    if state.machine_words:
        state.machine_words, state.following = False, iter(())
        leave_frame(state)
    motion: Motion | None = None
    if selected and channel.tools.at_once and not (moves and path.words):
        motion, moves = _with_new_tool(channel, state, block, path if moves else None, before), False
    if moves and (block.words or path.own_words) and path.motion is not None:
        motion = path.motion(channel, state, block, path)
    functions: tuple[Function, ...] = ()
    if path.number in tapping.CODES:
        functions = tapping.functions(channel, state, block, path)
    elif turning.concerns(state, block):
        functions = turning.functions(channel, state, block)
    elif block.functions and (path.spindle or not path.own_words):
        functions = block_functions(channel, state, block)
        note_functions(channel, state, block, functions)
    if control or block.controls:
        functions += control + bracketed_controls(channel, state, block, functions)
    if state.c_axis:
        c_axis.check_functions(channel, state, block, functions)
    if motion is not None:
        if isinstance(motion, LinearMove) and motion.thread is not None:
            motion = with_speed(channel, state, block, motion, motion.thread)
        motion = _moved(channel, state, block, motion, check_target)
        note_motion(state, motion)
    state.once = None
    stop = block.flow if block.flow != "return" else ""
    if stop:
        end_thread(state)
    if stop == "end":
        _require_speed(state, None)
        functions += end_of_links(state)
    if motion is None and not functions and not stop:
        return None
    return CanonicalBlock(block.source, functions, motion, stop, calls=calls)


def _moved(
    channel: Channel, state: ModalState, block: NcBlock, motion: Motion, check_target: CheckTarget | None
) -> Motion | None:
    """A motion in machine coordinates, checked; the state is at its end then. None if it goes nowhere.

    Where the radius of the tool is compensated, it is the compensated motion that is checked, and left out.
    """
    if not isinstance(motion, (LinearMove, CircularMove)):
        return motion
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
        _check_move(state.position, motion, block.source, check_target)
        if state.coordinates.limits:
            check_limits(channel, state.coordinates.limits, state.position, motion, block.source)
    if state.slope:
        motion = motion._replace(slope=state.slope)
    transition = state.once or state.transition
    if transition is not THROUGH and not ends_on_its_own(motion):
        motion = motion._replace(transition=through_point(channel, state, block, transition, programmed))
    if block.codes and any(code.number == FULL_OVERRIDE for code in block.codes):
        motion = motion._replace(full_override=True)
    if state.spindle.speedless:
        _require_speed(state, motion)
    state.position, state.programmed = motion.target, programmed
    if state.turning.speed:
        turning.follow(channel, state, motion)
    return motion


def ends_on_its_own(motion: Motion) -> bool:
    """A measuring run or tapping: no transition of the program changes its end."""
    return isinstance(motion, LinearMove) and (bool(motion.measures) or motion.tap is not None)


def _followed(
    channel: Channel,
    state: ModalState,
    block: NcBlock,
    first: CanonicalBlock | None,
    steps: Iterator[Step],
    check_target: CheckTarget | None,
    calls: tuple[str, ...],
) -> Iterator[CanonicalBlock]:
    """A block and its further motions (cycles, G28); what stops the program comes behind the last one."""
    stop = "" if first is None else first.stop
    if first is not None and (first.functions or first.motion is not None):
        yield _reported(channel, state, first._replace(stop=""))
    for step in steps:
        if step.machine:
            leave_frame(state)
        motion = None if step.motion is None else _moved(channel, state, block, step.motion, check_target)
        if motion is not None or step.functions:
            yield _reported(channel, state, CanonicalBlock(block.source, step.functions, motion, "", calls=calls))
    reported = state.reported
    refresh(channel, state)
    state.reported = reported
    if stop:
        yield _reported(channel, state, CanonicalBlock(block.source, (), None, stop, calls=calls))


def _reported(channel: Channel, state: ModalState, block: CanonicalBlock) -> CanonicalBlock:
    return block if state.reported else _with_offsets(channel, state, block)


def _with_new_tool(
    channel: Channel, state: ModalState, block: NcBlock, path: GCode | None, before: tuple[float, ...]
) -> Motion | None:
    """P-CHAN-00100: axes without a word keep their programmed position from `before`, so they make up for the tool.

    Not with arcs, whose axes make up for it with their next absolute word.
    """
    seen, state.programmed = state.programmed, before
    motion = None if path is None or path.motion is None else path.motion(channel, state, block, path)
    motion = motion or compensating_move(state)
    state.programmed = seen
    return motion


def awaits_path(block: CanonicalBlock) -> bool:
    """Behind this block the interpreter needs what only the run knows."""
    return isinstance(block.motion, HomeAxes) or measures(block.motion) or changes_axes(block) or reads_the_run(block)


def changes_axes(block: CanonicalBlock) -> bool:
    """Behind this block the path has other axes (#CAX, #FACE), which stand where only the run knows."""
    return any(isinstance(function, (SpindleAxis, KinematicsChange)) for function in block.functions)


def reads_the_run(block: CanonicalBlock) -> bool:
    """The line behind this block reads what only the run knows."""
    for function in block.functions:
        if isinstance(function, WaitForPath) and function.awaited:
            return True
        if isinstance(function, Timer) and function.action == "READ":
            return True
    return False


def _require_speed(state: ModalState, motion: Motion | None) -> None:
    """M3 without a speed is an error at the first machining motion, and when the program ends without one."""
    rapid = isinstance(motion, LinearMove) and motion.rapid
    if not rapid:
        for error in state.spindle.speedless.values():
            raise error


def _check_move(
    start: tuple[float, ...], motion: LinearMove | CircularMove, source: Source, check_target: CheckTarget | None
) -> None:
    """Soft limits of the axes, and the way to a Cartesian target (#FACE, #CYL)."""
    points: list[tuple[float, ...]] = []
    if motion.kinematics is not None:
        points = machine_points(start, motion, source)
    elif check_target is None:
        return
    elif isinstance(motion, CircularMove):
        points = [*extreme_points(start, motion), motion.target]
    else:
        points = [motion.target]
    for point in points if check_target is not None else ():
        assert check_target is not None
        check_target(point, source)


def _check_block(check_block: CheckBlock, block: CanonicalBlock | None, recovery: Recovery | None) -> None:
    """Without `recovery` the error of a block comes out."""
    try:
        check_block(block)
    except ProgramError as error:
        if recovery is None:
            raise
        recovery.of_block(error, block)


def check(
    text: str | ProgramText,
    file: str,
    axes: tuple[str, ...],
    spindles: tuple[str, ...] | SpindleTable = ("S",),
    *,
    start: tuple[float, ...] | None = None,
    check_target: CheckTarget | None = None,
    check_blocks: Callable[[], CheckBlock] | None = None,
    centre_offset: float = CENTRE_OFFSET,
    centre_offset_ratio: float = CENTRE_OFFSET_RATIO,
    rotary: Collection[str] = (),
    tools: ToolTable = NO_TOOLS,
    radius: RadiusSettings = DEFAULT_SETTINGS,
    references: tuple[float, ...] = (),
    files: Mapping[str, str] = NO_FILES,
    cycles: Mapping[str, str] = NO_FILES,
    offsets: OffsetTables = NO_OFFSET_TABLES,
    soft_limits: tuple[tuple[float, float], ...] = (),
    turning_axes: TurningAxes = NO_TURNING_AXES,
    limits: Limits = LIMITS,
    vocabulary: Vocabulary = TWINCAT,
) -> list[ProgramError]:
    """All syntax errors of a program (one per line) and its modal errors, one per line, in the order of the lines.

    The modal check runs the program from `start` (default 0); if there is an error once more, to continue behind it as
    Recovery says, which takes a copy of the state for each block. It ends at
    a line that reads what only the run knows, since everything after that would be a guess; so are targets after G74.
    #ERROR that stops the program is an error. `check_blocks` gives a new check for each time that the program is run.
    An error that `check_target` raises comes out as it is, unless it is a ProgramError.
    """
    program, errors = parse_all(text, file, files=files, cycles=cycles, vocabulary=vocabulary)
    begin = (0.0,) * len(axes) if start is None else start
    recovery, recovers, homed = Recovery(errors), False, False

    def check_known(target: tuple[float, ...], source: Source) -> None:
        if check_target is not None and not homed:
            try:
                check_target(target, source)
            except ProgramError as error:
                if not recovers:
                    raise
                recovery.note(error)

    for recovers in (False, True):
        recovery, homed = Recovery(errors), False
        blocks = interpret(
            program,
            begin,
            axes,
            spindles,
            check_target=check_known,
            centre_offset=centre_offset,
            centre_offset_ratio=centre_offset_ratio,
            rotary=rotary,
            offsets=offsets,
            soft_limits=soft_limits,
            tools=tools,
            radius=radius,
            references=references,
            turning_axes=turning_axes,
            limits=limits,
            runs=True,
            recovery=recovery if recovers else None,
        )
        failed = False
        check_block = None if check_blocks is None else check_blocks()
        try:
            for block in blocks:
                recovery.ordered(block)
                if check_block is not None:
                    _check_block(check_block, block, recovery if recovers else None)
                homed = homed or isinstance(block.motion, HomeAxes)
                if reads_the_run(block):
                    break
            if check_block is not None:
                _check_block(check_block, None, recovery if recovers else None)
        except ProgramError as error:
            failed = True
            if recovers:
                recovery.ends_with(error)
        if not failed:
            break
    found = [*errors, *recovery.errors]
    recovery.mark(found)
    return sorted(found, key=lambda error: (error.file != file, error.file, error.line))

"""Blocks -> canonical stream: from one block to the next, through faults that a check leaves out, to the end."""

from collections.abc import Iterator

from cnc_ptp.nc import transformations
from cnc_ptp.nc.awaited import awaits_path
from cnc_ptp.nc.block_resolver import BlockResolver, CheckTarget
from cnc_ptp.nc.block_search import BlockSearch
from cnc_ptp.nc.canonical import BEGIN, BUSY, CanonicalBlock, CircularMove, LinearMove, WaitForPath
from cnc_ptp.nc.coordinates.codes import initial_state, select_offset
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.execution import COMPUTES, FOUND, PAUSE, Execution, with_calls
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.measuring import results
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel
from cnc_ptp.nc.radius.compensation import RadiusCompensation
from cnc_ptp.nc.recovery import Recovery
from cnc_ptp.nc.thread_cutting import end_thread
from cnc_ptp.nc.tools.tool_state import NOT_WRITTEN


def interpret(
    program: Program,
    start: tuple[float, ...],
    channel: Channel,
    *,
    state: ModalState | None = None,
    values: Values | None = None,
    check_target: CheckTarget | None = None,
    block_skip: int = 0,
    runs: bool = False,
    search: BlockSearch | None = None,
    recovery: Recovery | None = None,
) -> Iterator[CanonicalBlock]:
    """Canonical blocks of a program, one by one, from the position `start` (mm, in the order of the axes).

    `channel`: what stays the same while the program is interpreted; the vocabulary is that of the program.
    `state`: modal state to continue from and to carry on (MDI); None begins with the initial state. `values`:
    parameters and variables to continue with, of the same `state`.
    `check_target(target, source)` is called before a move is handed out, with its target and, for an arc, with the
    points where an axis turns back; it raises to refuse the move.
    `block_skip`: bit n - 1 skips blocks with /n (`/` is /1).
    Blocks without function, motion or stop give nothing, nor does a move to the present position; offsets that they
    change come with the next block, those at the end with one of their own.
    `runs`: while the blocks are executed; then WaitForPath comes before what only the run knows, when `values` must get
    it, and BUSY in long computations. Otherwise such a line is the error 21438.
    `search`: a place; BEGIN comes in place of a block when it is reached, before its line is executed.
    `recovery`: takes the errors, of which it decides whether the next block follows, in place of raising them.
    Raises ProgramError; state and values are then undefined, so MDI continues with copies taken before.
    """
    channel = channel._replace(vocabulary=program.vocabulary)
    state = initial_state(channel) if state is None else state
    _begin(channel, state, start)
    if values is None:
        values = Values(channel, state)
    else:
        values.channel, values.state = channel, state
    execution = Execution(program, values, limits=channel.limits, block_skip=block_skip, search=search)
    resolver = BlockResolver(channel, state, check_target)
    compensation = RadiusCompensation(channel, state, resolver.check_move, search, program.main.source, recovery)
    yield from compensation.over(_programmed(execution, resolver, recovery, runs=runs))


def _begin(channel: Channel, state: ModalState, start: tuple[float, ...]) -> None:
    """The axes stand at `start`; what ends with a program has ended."""
    state.position = tuple(start)
    state.tool.written = NOT_WRITTEN
    end_thread(state)
    state.c_axis = ""
    transformations.restore(state)
    refresh(channel, state)
    state.reported = True
    first_offset = channel.vocabulary.first_offset
    if first_offset and not state.coordinates.own.zero_index:
        select_offset(channel, state, first_offset)


def _programmed(
    execution: Execution, resolver: BlockResolver, recovery: Recovery | None, *, runs: bool
) -> Iterator[CanonicalBlock]:
    """The blocks with the motions that are programmed, whatever the radius of the tool."""
    values, state = execution.values, resolver.state
    source = execution.program.main.source
    before: ModalState | None = None
    goes_on = True
    while goes_on:
        try:
            while (block := execution.next_block()) is not None:
                if block is COMPUTES or block is FOUND or block is PAUSE:
                    if block is not COMPUTES or runs:
                        yield BUSY if block is COMPUTES else BEGIN if block is FOUND else _wait(execution, runs=runs)
                    continue
                source = block.source
                if recovery is not None:
                    before = state.copy()
                canonical = resolver.resolve(block, execution.calls)
                motion = None if canonical is None else canonical.motion
                execution.moved = isinstance(motion, (LinearMove, CircularMove))
                execution.blocks = 0 if canonical is None else 1
                if state.following is not None:
                    steps, state.following = state.following, None
                    for further in resolver.further(block, canonical, steps, execution.calls):
                        execution.blocks += 1
                        yield further
                elif canonical is not None:
                    yield resolver.reported(canonical)
                    if awaits_path(canonical):
                        execution.forget()
                        _take_run(canonical, values, resolver)
                before = None
            if not state.reported:
                yield resolver.reported(CanonicalBlock(source, (), None, ""))
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


def _wait(execution: Execution, *, runs: bool) -> CanonicalBlock:
    """The path must stand before the next line. Raises ProgramError 21438 if there is none."""
    source = execution.values.source
    if not runs:
        raise expression_faults.ONLY_WHILE_RUNNING.at(source)
    return CanonicalBlock(source, (WaitForPath(True),), None, "", calls=execution.calls)


def _take_run(block: CanonicalBlock, values: Values, resolver: BlockResolver) -> None:
    """What only the run knows, if the block was carried out: where the axes are, the results of a measuring run."""
    if not values.position:
        return
    motion, touch = block.motion, values.touch
    if not isinstance(motion, LinearMove):
        resolver.take_position(block, values.position)
    elif motion.measures and touch is not None:
        programmed = resolver.take_measured(values.position, touch.position)
        values.measured = results(motion, touch, programmed, values.measured)

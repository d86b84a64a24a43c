"""The program of a channel, what was interpreted of it ahead of its start, and what programs leave to the next one."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

from cnc_ptp.channel.block_stream import BlockStream
from cnc_ptp.channel.listed_blocks import ListedBlocks, ProgramBegin
from cnc_ptp.channel.offset_memory import OffsetMemory
from cnc_ptp.channel.program_check import KnownBlocks, ProgramCheck, ProgramState
from cnc_ptp.channel.program_start import ProgramStart
from cnc_ptp.channel.program_times import BlockTimes, block_times
from cnc_ptp.channel.running_blocks import RunningBlocks
from cnc_ptp.channel.time_estimate import TimeEstimate
from cnc_ptp.nc.expressions.values import Variable
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.modal_state import Pairs
from cnc_ptp.nc.program import Vocabulary
from cnc_ptp.nc.vocabularies import VOCABULARIES
from cnc_ptp.protocol.blocks import CycleBlock

Position = tuple[float, ...]


class PreparedProgram(NamedTuple):
    """A program that was interpreted ahead of its load, from the position `start` and the state `before`.

    `block_skip`: the levels that were skipped; `times` of its motions.
    """

    text: str
    files: dict[str, str]
    program: Program
    start: Position
    before: ProgramState
    at_end: ProgramState
    known: KnownBlocks
    times: BlockTimes
    block_skip: int

    def is_of(self, text: str, files: Mapping[str, str], file: str, vocabulary: Vocabulary) -> bool:
        """Whether a load with these arguments means this program."""
        same = (self.text, self.files, self.program.file) == (text, files, file)
        return same and self.program.vocabulary is vocabulary


class StartedProgram(NamedTuple):
    """The blocks of a program that starts, their times, and the state in which it begins."""

    stream: BlockStream
    times: BlockTimes
    before: ProgramState


class ProgramMemory:
    """What a channel keeps from one program to the next.

    loaded      the program, None before the first load
    vocabulary  that of the last load; manual blocks are read in it
    state       in which an MDI text starts: that of the previous one, if it was carried out in full
    manual      what was started last is an MDI text
    """

    def __init__(
        self, check: ProgramCheck, offsets: OffsetMemory, estimate: TimeEstimate, blocks_per_cycle: int
    ) -> None:
        """`blocks_per_cycle` of a program that is interpreted while it runs."""
        self._check, self._offsets, self._estimate = check, offsets, estimate
        self._blocks_per_cycle = blocks_per_cycle
        self._links: dict[int, Pairs] = {}
        """Coupling groups that programs have defined; they are kept for the next one, as V.S. is."""
        self._shared: dict[str, Variable] = {}
        self._prepared: PreparedProgram | None = None
        self._at_end: ProgramState | None = None
        self.loaded: Program | None = None
        self.vocabulary = check.vocabulary
        self.state = check.state({}, {}, {})
        self.manual = False

    def initial_state(self, feedback: Mapping[str, CycleBlock]) -> ProgramState:
        """The state in which a program starts."""
        return self._check.state(feedback, self._links, self._shared, self._offsets.changes, self._offsets.clamp_index)

    def manual_state(self, feedback: Mapping[str, CycleBlock]) -> ProgramState:
        """The state in which an MDI text starts."""
        state = self.state.copy()
        state.modal.spindle.gears = self._check.gears(feedback)
        return state

    def prepare(
        self,
        program: str,
        text: str,
        files: Mapping[str, str],
        dialect: str | None,
        start: Position,
        feedback: Mapping[str, CycleBlock],
    ) -> None:
        """See ChannelUnit."""
        parsed = self._check.parse(text, program, files, dialect)
        if parsed.streamed:
            return
        state = self.initial_state(feedback)
        before = state.copy()
        known = self._check.known_ahead(parsed, start, state)
        times = block_times(self._estimate, known.blocks, start, known.total)
        skip = self._check.block_skip
        self._prepared = PreparedProgram(text, dict(files), parsed, start, before, state, known, times, skip)

    def load(self, program: str, text: str, files: Mapping[str, str], dialect: str | None) -> None:
        """Takes over a program. Raises ProgramError for its syntax."""
        prepared = self._prepared
        vocabulary = self._check.vocabulary if dialect is None else VOCABULARIES[dialect]
        if prepared is not None and prepared.is_of(text, files, program, vocabulary):
            self.loaded = prepared.program
        else:
            self.loaded = self._check.parse(text, program, files, dialect)
        if vocabulary is not self.vocabulary:
            self.vocabulary, self.state = vocabulary, self.initial_state({})

    def parse_manual(self, text: str, files: Mapping[str, str]) -> Program:
        """An MDI text. Raises ProgramError."""
        return self._check.parse_manual(text, files, self.vocabulary, self.loaded)

    def start(
        self,
        program: Program,
        start: Position,
        state: ProgramState,
        unreferenced: Collection[str],
        begin: ProgramStart | None,
        *,
        manual: bool,
    ) -> StartedProgram:
        """The blocks of a program from a position and state; `begin`: not from its beginning.

        Raises ProgramError and the errors of ProgramStart; then nothing has changed.
        """
        before = state.copy()
        ready = None if unreferenced or begin is not None or manual else self._ready(program, start, state)
        if ready is not None:
            known, state, times = ready.known, ready.at_end, ready.times
        else:
            known = self._check.known_blocks(program, start, state, unreferenced, begin)
            times = block_times(self._estimate, known.blocks, start, known.total)
        point = None if begin is None else begin.point
        if known.complete:
            skip = self._check.block_skip
            begins = ProgramBegin(self._check, program, start, before, tuple(unreferenced), point, skip)
            stream = BlockStream(ListedBlocks(begins, known.blocks), known.total)
        else:
            state = before
            blocks = RunningBlocks(self._check, program, start, state, tuple(unreferenced), point)
            place = program.place if program.streamed else None
            stream = BlockStream(blocks, known.total, self._blocks_per_cycle, place)
        self._links = state.modal.spindle.links
        self.state = self.initial_state({})
        self._at_end, self.manual = state, manual
        return StartedProgram(stream, times, before)

    def _ready(self, program: Program, start: Position, state: ProgramState) -> PreparedProgram | None:
        """What was interpreted ahead, if that was from the present positions and state, and within all soft limits."""
        ready = self._prepared
        if ready is None or ready.program is not program or not ready.before.same_as(state):
            return None
        same_way = ready.start == start and ready.block_skip == self._check.block_skip
        same_way = same_way and not self._check.unreferenced_at_start
        return ready if same_way else None

    def finish(self) -> None:
        """The program has been carried out in full: what it leaves counts from now on."""
        if self._at_end is None:
            return
        ended, self._at_end = self._at_end, None
        self._shared, self._offsets.changes = ended.values.shared, ended.modal.coordinates.changes
        self.state = ended if self.manual else self.initial_state({})

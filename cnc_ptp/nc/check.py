"""Check of a whole program: all its errors, in the order of the lines."""

from collections.abc import Callable, Mapping

from cnc_ptp.nc.awaited import reads_the_run
from cnc_ptp.nc.block_resolver import CheckTarget
from cnc_ptp.nc.canonical import CanonicalBlock, HomeAxes, Source
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.execution import ENDLESS
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import NO_FILES, parse_all
from cnc_ptp.nc.program import Channel
from cnc_ptp.nc.program_text import ProgramText
from cnc_ptp.nc.recovery import Recovery

CheckBlock = Callable[[CanonicalBlock | None], None]
"""Raises ProgramError for a block that the machine cannot carry out; None comes behind the last one."""


def check(
    text: str | ProgramText,
    file: str,
    channel: Channel,
    *,
    start: tuple[float, ...] | None = None,
    check_target: CheckTarget | None = None,
    check_blocks: Callable[[], CheckBlock] | None = None,
    files: Mapping[str, str] = NO_FILES,
    cycles: Mapping[str, str] = NO_FILES,
) -> list[ProgramError]:
    """All syntax errors of a program (one per line) and its modal errors, one per line, in the order of the lines.

    It is read in the vocabulary of the `channel`.
    The modal check runs the program from `start` (default 0); if there is an error once more, to continue behind it as
    Recovery says, which takes a copy of the state for each block. It ends at
    a line that reads what only the run knows, since everything after that would be a guess; so are targets after G74.
    #ERROR that stops the program is an error. `check_blocks` gives a new check for each time that the program is run.
    An error that `check_target` raises comes out as it is, unless it is a ProgramError.
    """
    program, errors = parse_all(text, file, files=files, cycles=cycles, vocabulary=channel.vocabulary)
    begin = (0.0,) * len(channel.axes) if start is None else start
    for recovers in (False, True):
        run = CheckRun(program, errors, channel, check_target, check_blocks, recovers=recovers)
        if run.over(begin):
            break
    found = [*errors, *run.recovery.errors]
    run.recovery.mark(found)
    return sorted(found, key=lambda error: (error.file != file, error.file, error.line))


class CheckRun:
    """The modal check runs the program once: up to its first error, or (`recovers`) to collect all of them."""

    def __init__(
        self,
        program: Program,
        known: list[ProgramError],
        channel: Channel,
        check_target: CheckTarget | None,
        check_blocks: Callable[[], CheckBlock] | None,
        *,
        recovers: bool,
    ) -> None:
        """`known`: the syntax errors of the program."""
        self.recovery = Recovery(known)
        self._program, self._channel, self._recovers = program, channel, recovers
        self._check_target = check_target
        self._check_block = None if check_blocks is None else check_blocks()
        self._homed = False

    def over(self, start: tuple[float, ...]) -> bool:
        """Runs it; whether no more is to be found than what `recovery` has then."""
        recovery = self.recovery if self._recovers else None
        blocks = interpret(
            self._program, start, self._channel, check_target=self._check_known, runs=True, recovery=recovery
        )
        try:
            for block in blocks:
                self.recovery.ordered(block)
                self._check(block)
                self._homed = self._homed or isinstance(block.motion, HomeAxes)
                if reads_the_run(block):
                    break
            self._check(None)
        except ProgramError as error:
            if not self._recovers and error.number not in ENDLESS:
                return False
            self.recovery.ends_with(error)
        return True

    def _check(self, block: CanonicalBlock | None) -> None:
        """What the machine says to the block."""
        if self._check_block is None:
            return
        try:
            self._check_block(block)
        except ProgramError as error:
            if not self._recovers:
                raise
            self.recovery.of_block(error, block)

    def _check_known(self, target: tuple[float, ...], source: Source) -> None:
        """Where the axes are behind a homing is not known."""
        if self._check_target is None or self._homed:
            return
        try:
            self._check_target(target, source)
        except ProgramError as error:
            if not self._recovers:
                raise
            self.recovery.note(error)

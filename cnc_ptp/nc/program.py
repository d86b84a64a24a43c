"""Types between parser and interpreter: the rows of the vocabulary, the parsed blocks and the modal state."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from cnc_ptp.nc.canonical import CompensationSwitch, Function, Motion, Source, SpindleFeedforward
from cnc_ptp.nc.faults import ProgramError


class GCode(NamedTuple):
    """A row of the G table.

    `group`: of one group only one code may stand in a block. `select` changes the modal state. `motion` makes the code
    a path function: it builds the motion of a block, and of the blocks after it if `modal`. `words` are the words that
    this motion uses besides axes and F; `own_words`: it reads all words of its block by itself (dwell). `function`
    makes functions of the block; with `takes_axes` they use the axis words, so that the block has no motion.
    """

    number: int
    group: str
    select: "Callable[[ModalState], None] | None" = None
    motion: "Callable[[Channel, ModalState, Block, GCode], Motion | None] | None" = None
    modal: bool = True
    words: frozenset[str] = frozenset()
    own_words: bool = False
    function: "Callable[[Channel, ModalState, Block, GCode], tuple[Function, ...]] | None" = None
    takes_axes: bool = False

    @property
    def name(self) -> str:
        """As printed in programs and errors: G01, G161."""
        return f"G{self.number:02d}"


class MCode(NamedTuple):
    """A row of the M table: `flow` is "", "M00", "M01", "end" or "return"; `handler` gives the canonical function."""

    number: int
    group: str
    flow: str
    handler: "Callable[[Channel, ModalState, Block, MCode], Function] | None"

    @property
    def name(self) -> str:
        """As printed in programs and errors: M03, M130."""
        return f"M{self.number:02d}"


class SpindleWords(NamedTuple):
    """Words for one spindle by its name: `S2[M3 REV1000]` or `S2=1000`; speed in rpm."""

    name: str
    m: int | None
    speed_rpm: float | None


class Block(NamedTuple):
    """One program line in words, not yet interpreted.

    `words` holds the numbers by word (X, Y1, F, I, S, T ...), `direct` a number without a word (G04 5.5), `call` the
    subroutine, `flow` what the block does to the order of execution (see MCode), `skip` the bit of its skip level (0:
    never skipped), `functions` whether it has any M, S, T, D; `error` is set for a line with a syntax error, which is
    raised when it is reached; `controls` holds brackets with feedforward and COMP.
    """

    source: Source
    codes: tuple[GCode, ...]
    words: dict[str, float]
    m: tuple[MCode, ...] = ()
    spindles: tuple[SpindleWords, ...] = ()
    direct: float | None = None
    call: str = ""
    flow: str = ""
    skip: int = 0
    functions: bool = False
    error: ProgramError | None = None
    controls: tuple[SpindleFeedforward | CompensationSwitch, ...] = ()


class Program(NamedTuple):
    """A parsed file: the main program's blocks and those of its subroutines by upper-case name."""

    file: str
    name: str
    main: tuple[Block, ...]
    subroutines: dict[str, tuple[Block, ...]]


class Channel(NamedTuple):
    """What is constant while a program is interpreted: axes, spindles (main spindle first), arc limits (mm, ratio)."""

    axes: tuple[str, ...]
    axis_index: dict[str, int]
    spindles: tuple[str, ...]
    centre_offset: float
    centre_offset_ratio: float


@dataclass(slots=True)
class ModalState:
    """What one block leaves to the next: mm, mm/s, rpm; the defaults are the initial state of a program.

    `path`, `plane`: numbers of the active G codes; `radius`: last R (mm, signed, 0.0 none); `speeds`: S by spindle.
    """

    position: tuple[float, ...] = ()
    path: int = 0
    plane: int = 17
    absolute: bool = True
    centre_absolute: bool = False
    feed: float = 0.0
    radius: float = 0.0
    speeds: dict[str, float] = field(default_factory=dict)

    def copy(self) -> "ModalState":
        """An independent copy, so that a refused MDI line can leave the state as it was."""
        return replace(self, speeds=dict(self.speeds))

"""Types between parser and interpreter: the rows of the vocabulary, the parsed blocks, the constants of a channel."""

import re
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from cnc_ptp.nc.canonical import CompensationSwitch, Function, Motion, Source, SpindleFeedforward, code_name
from cnc_ptp.nc.contour import PATH_DEFAULTS, PathDefaults
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.modal_state import FacingAxis, ModalState, Pairs
from cnc_ptp.nc.radius.radius_state import DEFAULT_SETTINGS, RadiusSettings
from cnc_ptp.parameters import NO_OFFSET_TABLES, NO_TOOLS, OffsetTables, ToolTable

MAX_M: Final = 999


class GCode(NamedTuple):
    """A row of the G table.

    `group`: only one code of a group may be in a block. `select` changes the modal state. `motion` makes the code
    a path function: it builds the motion of a block, and of the blocks after it if `modal`. `words` are the words that
    this motion uses besides axes and F; `own_words`: it reads all words of its block itself (dwell). `function`
    makes functions of the block; with `takes_axes` they use the axis words, so that the block has no motion.
    `spindle`: the code makes a function of a spindle (G74, G167), besides its effect on the path. `prepare` changes
    the coordinates before the motion of its block; `valued`: it takes a value (G159=2). `later`: what it stands for is
    not built yet, so it is refused when the program is read. `minor`: digit behind the point (G54.1). `bare`: one that
    takes a value may stand without (G196).
    """

    number: int
    group: str
    select: "Callable[[ModalState], None] | None" = None
    motion: "Callable[[Channel, ModalState, NcBlock, GCode], Motion | None] | None" = None
    modal: bool = True
    words: frozenset[str] = frozenset()
    own_words: bool = False
    function: "Callable[[Channel, ModalState, NcBlock, GCode], tuple[Function, ...]] | None" = None
    takes_axes: bool = False
    spindle: bool = False
    prepare: "Callable[[Channel, ModalState, NcBlock, GCode], None] | None" = None
    valued: bool = False
    later: str = ""
    minor: int = 0
    bare: bool = False

    @property
    def key(self) -> float:
        """The number as it is written: 54.1 is `number` 54, `minor` 1."""
        return float(f"{self.number}.{self.minor}")

    @property
    def is_plain(self) -> bool:
        """A line with this code may be read by the fast method."""
        return not (self.spindle or self.valued or self.later)

    @property
    def name(self) -> str:
        """As printed in programs and errors: G01, G161, G54.1."""
        name = code_name("G", self.number)
        return f"{name}.{self.minor}" if self.minor else name


class MCode(NamedTuple):
    """A row of the M table: `flow` is "", "M00", "M01", "end" or "return"; `handler` gives the canonical function.

    It is None if the function is made of several words of the block (spindles).
    """

    number: int
    group: str
    flow: str
    handler: "Callable[[Channel, ModalState, NcBlock, MCode], Function] | None"

    @property
    def name(self) -> str:
        """As printed in programs and errors: M03, M130."""
        return code_name("M", self.number)


class Vocabulary:
    """The tables of one language: `twincat` is nc/vocabulary.py, `iso` nc/iso/vocabulary.py.

    g_codes         rows by number (54.1)
    m_codes         rows of M functions with a meaning of their own; those without go to the PLC
    paths           rows of the modal path functions, by the number that ModalState.path holds
    axis_letters    with which names of axes begin
    value_words     letters with a number and a meaning of their own
    function_words  those of them that are functions for spindles and PLC
    words           letters of words that are no codes
    plain_codes     G codes whose lines the fast method may read, by number
    plain_names     their names
    plain_words     `words` without those that need the careful one
    first_offset    zero offset that is on at the start, 0: none

    `decides`: pattern of what may decide which lines follow, or about values, in capitals without comments.
    """

    def __init__(
        self,
        name: str,
        g_codes: "Sequence[GCode]",
        m_codes: "Sequence[MCode]",
        *,
        axis_letters: frozenset[str],
        value_words: frozenset[str],
        function_words: frozenset[str],
        free_m: "Callable[[Channel, ModalState, NcBlock, MCode], Function]",
        decides: str,
        without_comments: "Callable[[Source], str]",
        careful_words: frozenset[str] = frozenset(),
        further_paths: "Sequence[GCode]" = (),
        first_offset: int = 0,
    ) -> None:
        self.name = name
        self.g_codes = {code.key: code for code in g_codes}
        self.m_codes = {code.number: code for code in m_codes}
        self.paths = {
            code.number: code for code in (*further_paths, *g_codes) if code.motion is not None and code.modal
        }
        self.axis_letters, self.value_words, self.function_words = axis_letters, value_words, function_words
        self.plain_codes = {number: code for number, code in self.g_codes.items() if code.is_plain}
        self.plain_names = {code.key: code.name for code in self.plain_codes.values()}
        self.words = value_words | axis_letters
        self.plain_words = self.words - careful_words
        self.first_offset = first_offset
        self._free_m = free_m
        self._decides = re.compile(decides, re.ASCII)
        self._without_comments = without_comments

    def m_code(self, number: int) -> "MCode | None":
        """Row of an M function: its own, that of a free function, or None if there is no such function.

        M40 to M45 are free functions too, as long as P-CHAN-00052 does not make them select gears.
        """
        known = self.m_codes.get(number)
        if known is not None or not 0 <= number <= MAX_M:
            return known
        return MCode(number, f"M{number}", "", self._free_m)

    def may_decide(self, source: Source) -> bool:
        """Whether a line that cannot be read may decide which lines follow, or about values."""
        try:
            text = self._without_comments(source)
        except ProgramError:
            text = source.text.upper()
        return self._decides.search(text) is not None


class SpindleWords(NamedTuple):
    """Words for one spindle by its name: `S2[M3 REV1000]`, `S2=1000` or `S.POS=90`; speed in rpm, position in deg.

    `m` is 3, 4, 5 or None, with `positioning` (M19) the direction. `functions` are free M functions for the spindle,
    `din` says that the words are outside of brackets.
    """

    name: str
    m: int | None
    speed_rpm: float | None
    position_deg: float | None = None
    positioning: bool = False
    homing: bool = False
    full_override: bool = False
    default_dynamics: bool = False
    functions: tuple[int, ...] = ()
    din: bool = False


class Spindle(NamedTuple):
    """A spindle of the channel: `key` is its name in the canonical stream, the one that programs use at start-up.

    own_name      what programs call it while it is not the main spindle (P-CHAN-00007)
    number        logical axis number, 0 if none
    ranges        (lowest, highest) speed of each gear stage, rpm; (0, 0) for stages without (P-CHAN-00058, 00055)
    from_top      the search for a gear starts at the highest stage (P-CHAN-00074)
    automatic     the speed selects the gear (P-CHAN-00004)
    gear          stage at start-up, from 1
    plc_control   the PLC moves it through the channel's interface (P-CHAN-00069)
    limits        largest speed of each gear stage, rpm (P-AXIS-00212); stages beyond the last entry have none
    positioned    it has an actual position, so that it can be an axis of the path
    path_gear     gear stage as an axis of the path (P-AXIS-00052), 0: any
    """

    key: str
    own_name: str
    number: int = 0
    ranges: tuple[tuple[float, float], ...] = ()
    from_top: bool = False
    automatic: bool = False
    gear: int = 1
    plc_control: bool = False
    limits: tuple[float, ...] = ()
    positioned: bool = True
    path_gear: int = 0


class SpindleTable(NamedTuple):
    """The spindles of a channel, at start-up the first is the main spindle.

    `main_name`: what programs call whichever spindle is the main one (P-CHAN-00053). `gear_change`: M40 to M45 change
    its gear (P-CHAN-00052). `default_link`: coupling group 0 (P-CHAN-00037, 00038); `link_groups`: number of groups.
    `pitch_tolerance`: ratio by which F / S of G63 may differ from a programmed pitch (P-CHAN-90020).
    `c_axis`: name of the main spindle as the last axis of the path, "" if it does not become one (P-CHAN-00010);
    `face_kind`: kind of machine for #FACE (P-CHAN-00008).
    """

    spindles: tuple[Spindle, ...]
    main_name: str
    gear_change: bool = False
    default_link: Pairs = ()
    link_groups: int = 4
    pitch_tolerance: float = 0.001
    c_axis: str = ""
    face_kind: int = 0


class NcBlock(NamedTuple):
    """The words of a program line, with numbers for all of them, not yet interpreted.

    `words` holds the numbers by word (X, Y1, F, I, S, T ...), `direct` a number without a word (G04 5.5), `flow` what
    the block does to the order of execution (see MCode), `functions` is true if it has any M, S, T, D; `controls` holds
    brackets with feedforward and COMP, `values` those of codes that have one (G159=2).
    """

    source: Source
    codes: tuple[GCode, ...]
    words: dict[str, float]
    m: tuple[MCode, ...] = ()
    spindles: tuple[SpindleWords, ...] = ()
    direct: float | None = None
    flow: str = ""
    functions: bool = False
    controls: tuple[SpindleFeedforward | CompensationSwitch, ...] = ()
    command: "HashCommand | None" = None
    values: dict[str, float] | None = None


class HashCommand(NamedTuple):
    """A command that starts with #, alone in its block: name, arguments in brackets (None without), their column."""

    name: str
    arguments: tuple[str, ...] | None
    column: int
    run: "Callable[[Channel, ModalState, NcBlock, HashCommand], tuple[Function, ...]]"


class TurningAxes(NamedTuple):
    """Facing axes of a channel, and its settings of turning.

    shown    G51 shows the facing axis in diameters (P-CHAN-00256)
    feet     S of G96 is in ft/min with G70 (P-CHAN-00360)
    doubled  its zero offsets and G92 are given as diameters (P-CHAN-00091); inside they are radii
    """

    facing: tuple[FacingAxis, ...] = ()
    shown: bool = False
    feet: bool = False
    doubled: bool = False

    def offset_factor(self, place: int) -> float:
        """That makes the offset of an axis of one as it is given."""
        return 0.5 if self.doubled and any(axis.place == place for axis in self.facing) else 1.0


NO_TURNING_AXES: Final = TurningAxes()


CENTRE_OFFSET: Final = 2.0
"""Default of P-CHAN-00059 mittelpkt_diff: 20000 in 0.1 µm; mm."""
CENTRE_OFFSET_RATIO: Final = 0.05
"""Default of P-CHAN-00060 mittelpkt_faktor: 50 in 0.1 %; share of the radius."""


class Limits(NamedTuple):
    """`call_depth`: subroutines within each other; `repeats`: jumps back and calls in all, blocks of repeated lines."""

    call_depth: int = 20
    repeats: int = 1_000_000


LIMITS: Final = Limits()


class Channel(NamedTuple):
    """All that stays the same while a program is interpreted: axes, spindles, vocabulary, settings of the machine.

    rotary        axes in deg
    centre_offset, centre_offset_ratio  how far the centre of an arc may be corrected, mm and share of the radius
                  (P-CHAN-00059, P-CHAN-00060 / 1000); the smaller of both limits counts
    offsets       zero offsets and clamp positions of the machine file
    soft_limits   lowest and highest position of each axis, empty for none
    path          how the path goes from block to block at the start
    references    position of the reference point of each axis (P-AXIS-00152), empty for 0
    radius        how the radius of tools is compensated
    turning       facing axes, and what the machine has for turning
    limits        of calls and repeated lines
    """

    axes: tuple[str, ...]
    axis_index: dict[str, int]
    table: SpindleTable
    vocabulary: Vocabulary
    rotary: frozenset[str] = frozenset()
    centre_offset: float = CENTRE_OFFSET
    centre_offset_ratio: float = CENTRE_OFFSET_RATIO
    offsets: OffsetTables = NO_OFFSET_TABLES
    soft_limits: tuple[tuple[float, float], ...] = ()
    tools: ToolTable = NO_TOOLS
    path: PathDefaults = PATH_DEFAULTS
    references: tuple[float, ...] = ()
    radius: RadiusSettings = DEFAULT_SETTINGS
    turning: TurningAxes = NO_TURNING_AXES
    limits: Limits = LIMITS

    @property
    def main(self) -> tuple[int, int, int]:
        """Places of X, Y and Z, -1 for one that is not there."""
        x, y, z = (self.axis_index.get(name, -1) for name in "XYZ")
        return x, y, z

    @property
    def t_selects(self) -> bool:
        """T selects compensation data too (P-CHAN-00014); not in the vocabulary iso, which has no D."""
        return self.tools.with_t and "D" in self.vocabulary.function_words

"""The canonical stream: the commands of an NC program with every modal state resolved.

Positions are absolute, in mm (deg for rotary axes), one value for each axis of the channel in its order; feeds in mm/s.
All types are immutable and cheap to create (one of each per program block).

Functions of a block are in the order T, D, main spindle (gear first), other spindles, other M, H, in whatever order
the line has them; then feedforward and compensations. When they are output and who waits for them (before the motion,
after it, at the next G01) is decided at run time by their synchronisation type (P-CHAN-00041, 00043, 00045, 00047,
00049, 00081), which the language does not know. M00, M01 and the program end are in `stop` and act when motion and
functions have finished.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

from cnc_ptp.kinematics.kinematics import Kinematics
from cnc_ptp.nc.contour import THROUGH, Transition


class Source(NamedTuple):
    """The source of a block: file, line (1-based), block number (N word, 0 if none) and the line's text.

    `names`: its words (X, S2, S.POS) and codes (G01, M03), also those in brackets; `columns`: where they begin, from 1.
    """

    file: str
    line: int
    block_number: int
    text: str
    names: Sequence[str] = ()
    columns: Sequence[int] = ()

    def column(self, word: str, *, last: bool = False) -> int:
        """Column of a word or code; of several, the first or the last one; 1 if it is not in the line."""
        name = code_name(word[0], int(word[1:])) if word[:1] in CODES and word[1:].isdecimal() else word
        found = [self.columns[index] for index, other in enumerate(self.names) if other == name]
        return found[-1 if last else 0] if found else 1

    def place_of(self, text: str) -> int:
        """Column of a part of the line that is no word; 1 if it is not in the line."""
        return self.text.upper().find(text.upper()) + 1 or 1


CODES = ("G", "M")


def code_name(letter: str, number: int) -> str:
    """As printed in programs and errors: G01, M130."""
    return f"{letter}{number:02d}"


NO_PART: Final = 1e-12
"""A smaller part of a direction is rounding."""
STEP, TRAPEZ, SIN2 = "STEP", "TRAPEZ", "SIN2"
"""Slopes (#SLOPE): the acceleration along the path steps, is a trapezium with limited jerk, or has sin² ramps."""
AVAILABLE_SLOPES = (STEP, TRAPEZ, SIN2)
SLOPES = {0: STEP, 1: TRAPEZ, 2: SIN2, 3: "HSC"}
"""The slope for each value of P-CHAN-00071."""


class Tap(NamedTuple):
    """A spindle that is an axis of the path: how far it turns for each mm of it, with its sign (G63, G331, G332)."""

    spindle: str
    degrees_per_mm: float


class Thread(NamedTuple):
    """G33, G34, G35: the move follows the angle of a spindle that turns, by its canonical name.

    angle    by which the spindle turns during the move, deg, > 0
    lead     mm for one revolution along the axis at the place `axis`, as programmed; at the start of the move
    offset   deg from the zero passage of the spindle to the start of the thread
    change   of the lead with each revolution, mm
    speed    of the spindle as far as the program knows it, deg/s, signed; 0.0: not known
    retract  place of an axis and its way, mm, if the thread is broken off; None: as the machine file says
    """

    spindle: str
    angle: float
    lead: float
    axis: int
    offset: float = 0.0
    speed: float = 0.0
    change: float = 0.0
    retract: tuple[int, float] | None = None


class FeedPerTurn(NamedTuple):
    """The path goes `feed` mm in each turn of a spindle, as fast as it really turns (G95)."""

    spindle: str
    feed: float


class LinearMove(NamedTuple):
    """Straight move of all axes to `target` (mm); `feed` in mm/s along the path, 0.0 when `rapid`.

    `slope` of its acceleration, "" is that of P-CHAN-00071; `full_override`: G166, the override has no effect;
    `transition` to the next motion; `measures`: places of the axes of a measuring run, which the signal of the probe
    ends; `tap`: the spindle that turns with it; `thread`: a spindle leads the move, `feed` is what its speed amounts to
    (0.0: not known); `per_turn`: of G95, `feed` is that at the commanded speed; `kinematics`: makes machine positions
    of the Cartesian target.
    """

    target: tuple[float, ...]
    rapid: bool
    feed: float
    slope: str = ""
    full_override: bool = False
    transition: Transition = THROUGH
    measures: tuple[int, ...] = ()
    tap: Tap | None = None
    thread: Thread | None = None
    per_turn: FeedPerTurn | None = None
    kinematics: Kinematics | None = None


def led_by_spindle(motion: object) -> bool:
    """A motion of G33, G34, G35."""
    return isinstance(motion, LinearMove) and motion.thread is not None


Direction = tuple[float, ...]
"""A unit vector, one value for each axis of the channel."""


class CircularMove(NamedTuple):
    """Arc or full circle in a plane; every other axis moves linearly alongside (helix).

    `plane` holds the axis indices (first, second), `center` is absolute in that plane (mm), `radius` in mm,
    `sweep` in degrees, positive from the first towards the second axis (G03), 0 < |sweep| <= 360; `feed` in mm/s;
    `slope`, `full_override`, `transition`, `per_turn` and `kinematics` as in LinearMove.
    `directions`: in a coordinate system that is tilted, where the two axes of the plane point in the machine; `center`
    is then along them. They are at right angles to each other and to the linear motion of X, Y and Z.
    """

    target: tuple[float, ...]
    center: tuple[float, float]
    plane: tuple[int, int]
    radius: float
    sweep: float
    feed: float
    slope: str = ""
    full_override: bool = False
    transition: Transition = THROUGH
    directions: tuple[Direction, Direction] | None = None
    per_turn: FeedPerTurn | None = None
    kinematics: Kinematics | None = None

    def turns(self, axis: int) -> bool:
        """Whether the axis with this index takes part in the circle."""
        if self.directions is None:
            return axis in self.plane
        return any(abs(direction[axis]) > NO_PART for direction in self.directions)


class Dwell(NamedTuple):
    """G04: the path dwells for `seconds`."""

    seconds: float


class HomeAxes(NamedTuple):
    """G74: the axes of a group home at the same time, group after group; afterwards they are where they stand."""

    groups: tuple[tuple[str, ...], ...]


class SpindleFunction(NamedTuple):
    """A function of one spindle: `m` is 3 (clockwise), 4 (counter-clockwise), 5 (stop), 19 (positioning) or None.

    With M3 and M4 `speed_rpm` is always given (the programmed or the stored speed), with M5 never, since a speed with
    M5 is only stored for the next M3 or M4. None is a new speed alone, or, without a speed, G167 alone.
    M19 goes to `position_deg`, in the programmed `direction` ("cw", "ccw", "" for none), with the programmed or the
    stored speed, without any with that of P-AXIS-00209. `full_override`: G167, the external override has no effect.
    Spindles have the name here that they have at start-up, whatever #MAIN SPINDLE says.
    """

    spindle: str
    m: int | None
    speed_rpm: float | None
    position_deg: float | None = None
    direction: str = ""
    full_override: bool = False


class SpindleCommand(NamedTuple):
    """A spindle function without speed or position: `command` is "home" (G74) or "reset_limits"."""

    spindle: str
    command: str


class GearChange(NamedTuple):
    """The gear stage (1 to 6) that the functions after it need; no effect if the spindle is in it."""

    spindle: str
    stage: int


class CuttingSpeed(NamedTuple):
    """G96: the speed of a spindle follows the facing axis, so that the cutting speed is `speed` mm/s; 0.0 ends it.

    `max_rpm` of G196, 0.0 without; `axis`: place of the facing axis in the channel.
    """

    spindle: str
    speed: float
    max_rpm: float = 0.0
    axis: int = 0


class SpindleLink(NamedTuple):
    """Synchronous operation of two spindles starts or ends; functions of the master are in the stream for both.

    The slave turns `num` / `den` times as fast as the master, and as far.
    """

    slave: str
    master: str
    on: bool
    num: float = 1.0
    den: float = 1.0


class SpindleAxis(NamedTuple):
    """#CAX: the spindle becomes the last axis of the path where it stands; #CAX OFF: it is a spindle again."""

    spindle: str
    on: bool


class KinematicsChange(NamedTuple):
    """#FACE, #CYL: positions behind it are those of the kinematics; None: of the axes again. The path stands."""

    kinematics: Kinematics | None


class ExplicitSynchronisation(NamedTuple):
    """#EXPL SYN: the path waits for all functions of type MVS_SLP before it."""


class WaitForPath(NamedTuple):
    """#FLUSH: the path stands. `awaited`: the interpreter needs the actual positions of that instant."""

    awaited: bool = False


class Timer(NamedTuple):
    """#TIMER: START, STOP, READ or CLEAR of a timer, when the path reaches the block."""

    action: str
    number: int


class Message(NamedTuple):
    """#MSG: a text for the operator."""

    text: str


class OrderedError(NamedTuple):
    """#ERROR: a warning, or (`severe`) an error that stops the program."""

    id: int
    severe: bool
    text: str


class LanguageWarning(NamedTuple):
    """A warning of the interpreter when the path reaches the block."""

    number: int
    text: str


class AuxiliaryFunction(NamedTuple):
    """A function for the PLC or the tool management: letter "M", "T", "D" or "H"; with the `spindle` of S2[M8].

    `value`: what M52=-345 and H5=2 pass to the PLC.
    """

    letter: str
    number: int
    spindle: str = ""
    value: float = 0.0


class AxisFeedforward(NamedTuple):
    """G135 (`on`), G137 (not `on`) and G136 of a block for the channel's axes; None: the selection is kept.

    `weights`: percent by axis; the axes that are not named keep theirs.
    """

    on: bool | None
    weights: tuple[tuple[str, float], ...]


class SpindleFeedforward(NamedTuple):
    """The same for one spindle; `weight` in percent, None: it is kept."""

    spindle: str
    on: bool | None
    weight: float | None

    @property
    def name(self) -> str:
        """The spindle as programmed."""
        return self.spindle


class CompensationSwitch(NamedTuple):
    """`X[COMP ON FRICT]`: switches compensations of an axis on or off."""

    axis: str
    on: bool
    kinds: tuple[str, ...]

    @property
    def name(self) -> str:
        """The axis as programmed."""
        return self.axis


class MachineData(NamedTuple):
    """#MACHINE DATA: another value of a parameter of an axis, by P number or name, in the unit of its list."""

    axis: str
    """Its name in programs, or its logical number."""
    parameter: str
    value: float


ControlFunction = AxisFeedforward | SpindleFeedforward | CompensationSwitch | MachineData
"""Functions for position controllers."""
Function = (
    SpindleFunction
    | SpindleCommand
    | GearChange
    | CuttingSpeed
    | SpindleLink
    | SpindleAxis
    | KinematicsChange
    | ExplicitSynchronisation
    | WaitForPath
    | Timer
    | Message
    | OrderedError
    | LanguageWarning
    | AuxiliaryFunction
    | ControlFunction
)
Motion = LinearMove | CircularMove | Dwell | HomeAxes


class OffsetReport(NamedTuple):
    """All that lies between programmed and machine positions: mm, deg, one value for each axis of the channel.

    machine = shift + matrix · programmed for X, Y, Z (matrix row by row), shift + programmed for the other axes.
    `zero_index`: 0 is G53, 1 G54; `scale` of #SCALE, `mirrored` by G21 to G23, `angle` of #ROTATION or None;
    `systems`: #ACS and #CS that are on, the outermost first; `machine`: #MCS is on; `diameter`: place of the axis that
    is shown in diameters (G51, P-CHAN-00256), -1 none; `kinematics`: what follows behind these offsets (#FACE, #CYL).
    """

    zero_index: int
    zero: tuple[float, ...]
    added: tuple[float, ...]
    preset: tuple[float, ...]
    clamp_index: int
    clamp: tuple[float, ...]
    tool: tuple[float, ...]
    scale: tuple[float, ...]
    mirrored: tuple[bool, ...]
    angle: float | None
    systems: tuple[str, ...]
    machine: bool
    matrix: tuple[float, ...]
    shift: tuple[float, ...]
    diameter: int = -1
    kinematics: Kinematics | None = None


class CanonicalBlock(NamedTuple):
    """One program block with something to do; `stop` is "", "M00", "M01" or "end" (M02, M30).

    `offsets` that count from here on, when they have changed. `calls`: from where its subroutine was called, the
    innermost first: "part.nc line 12".
    """

    source: Source
    functions: tuple[Function, ...]
    motion: Motion | None
    stop: str
    offsets: OffsetReport | None = None
    calls: tuple[str, ...] = ()


BUSY: Final = CanonicalBlock(Source("", 0, 0, ""), (), None, "")
"""In place of a block: the interpreter has executed many lines without one, and continues when it is asked again."""
BEGIN: Final = CanonicalBlock(Source("", 0, 0, ""), (), None, "")
"""In place of a block: the place that was looked for (BlockSearch) is reached; what follows is to be carried out."""


def number(value: float) -> str:
    """Shortest text of a number with at most 6 decimals, without a negative zero."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
